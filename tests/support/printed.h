// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace imomushi {

/// What a command of the shell writes to its standard output; empty where it does not run.
inline std::string printed(const std::string& command) {
    std::string out;
    if (FILE* pipe = ::popen(command.c_str(), "r")) {
        std::array<char, 256> buffer{};
        while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe)) out += buffer.data();
        ::pclose(pipe);
    }
    return out;
}

}  // namespace imomushi
