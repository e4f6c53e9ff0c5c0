// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdlib.h>

#include <string>
#include <utility>

#include "tests/support/folder.h"

namespace imomushi {

/// A new, empty home for this process and all that it starts: settings, caches and data of whoever runs the tests are neither read nor changed.
class OwnHome {
public:
    OwnHome() {
        ::setenv("HOME", folder_.path().c_str(), 1);
        for (const auto& [variable, name] : kFolders) ::setenv(variable, folder_.file(name).c_str(), 1);
    }

    /// Every folder that programs keep things of their user in lies in here, as far as the environment says.
    [[nodiscard]] bool holdsAll() const {
        const auto inside = [this](const char* variable) {
            const char* value = ::getenv(variable);
            return value && std::string(value).starts_with(folder_.path().string());
        };
        bool all = inside("HOME");
        for (const auto& [variable, name] : kFolders) all = all && inside(variable);
        return all;
    }
    [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }

private:
    static constexpr std::pair<const char*, const char*> kFolders[] = {
        {"XDG_CONFIG_HOME", "config"}, {"XDG_CACHE_HOME", "cache"}, {"XDG_DATA_HOME", "data"}, {"XDG_STATE_HOME", "state"}};
    TestFolder folder_{"imomushi-home"};
};

/// That of this test program, made by main().
inline const OwnHome& ownHome() {
    static const OwnHome home;
    return home;
}

}  // namespace imomushi
