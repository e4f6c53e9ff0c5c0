// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace imomushi {

/// Lines that leave a sample that was opened with its flesh and bones alone, whatever it opens with: without effects, with a trunk that leans as it likes and, of the figure, a pelvis that is
/// pinned. For tests and benches of one thing.
inline std::vector<nlohmann::ordered_json> plainLines(const std::string& sample) {
    const bool stands = sample == "figure" || sample == "dragon";
    std::vector<nlohmann::ordered_json> lines;
    for (const char* effect : {"bend-warp", "smooth-joints", "end-stretch", "bone-dynamics"}) lines.push_back({{"do", "disable"}, {"effect", effect}});
    lines.push_back({{"do", "set"}, {"target", "bone-dynamics"}, {"property", "air-damping"}, {"value", 0}});
    if (stands) {
        lines.push_back({{"do", "disable"}, {"effect", "ground"}});
        lines.push_back({{"do", "set"}, {"target", "character"}, {"property", "body-follows"}, {"value", 0}});
    }
    if (sample == "figure") lines.push_back({{"do", "pin"}, {"endpoint", "spine-bone/start"}});
    return lines;
}

}  // namespace imomushi
