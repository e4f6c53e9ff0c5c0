// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/body_follows.h"

#include <algorithm>
#include <vector>

namespace imomushi {

namespace {

/// Skeleton::Bone::upright of a bone with half of the character on either side, over the length of all its bones. Ends that are dragged by a fifth of the height then turn the trunk by 2 to 12
/// degrees, and bones stretch by a percent of their length more (tests/document/first_touch_test.cpp); four times less, and it leans by up to 18.
constexpr double kUpright = 0.045;

}  // namespace

void letBodyFollow(Skeleton& skeleton, double amount) {
    const std::size_t count = skeleton.bones.size();
    std::vector<std::vector<std::size_t>> at(skeleton.points.size());  // bones of each joint point
    for (std::size_t b = 0; b < count; ++b) {
        at[static_cast<std::size_t>(skeleton.bones[b].start)].push_back(b);
        at[static_cast<std::size_t>(skeleton.bones[b].end)].push_back(b);
    }
    // The length of the bones that hang on a joint point, without `bone` and what lies beyond it.
    std::vector<std::pair<int, std::size_t>> open;
    const auto hanging = [&](int point, std::size_t bone) {
        double length = 0.0;
        open.assign(1, {point, bone});
        while (!open.empty()) {
            const auto [here, from] = open.back();
            open.pop_back();
            for (const std::size_t b : at[static_cast<std::size_t>(here)]) {
                if (b == from) continue;
                length += skeleton.bones[b].length;
                open.emplace_back(skeleton.bones[b].start == here ? skeleton.bones[b].end : skeleton.bones[b].start, b);
            }
        }
        return length;
    };
    for (std::size_t b = 0; b < count; ++b) {
        auto& bone = skeleton.bones[b];
        const double before = hanging(bone.start, b), beyond = hanging(bone.end, b), all = before + bone.length + beyond;
        const double share = 2.0 * (std::min(before, beyond) + 0.5 * bone.length) / all;  // 1: as much on either side
        bone.upright = amount * kUpright * all * share * share;
    }
}

}  // namespace imomushi
