// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/body_follows.h"

#include <algorithm>
#include <vector>

namespace imomushi {

namespace {

/// Skeleton::Bone::upright of a bone with half of the character on either side, over the length of all its bones. Ends that are dragged by a fifth of the height then turn the trunk by 2 to 12
/// degrees, and bones stretch by a percent of their length more (tests/document/first_touch_test.cpp); four times less, and it leans by up to 18.
constexpr double kUpright = 0.045;
/// So many bones that meet in an element make a frame.
constexpr std::size_t kFrame = 3;

}  // namespace

void letBodyFollow(Skeleton& skeleton, double amount, std::span<const int> elementOf) {
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
    const auto goesOn = [&](std::size_t b, int from) {
        const auto& bone = skeleton.bones[b];
        return at[static_cast<std::size_t>(bone.start == from ? bone.end : bone.start)].size() > 1;
    };
    for (std::size_t b = 0; b < count; ++b) {
        auto& bone = skeleton.bones[b];
        const double before = hanging(bone.start, b), beyond = hanging(bone.end, b), all = before + bone.length + beyond;
        const double share = 2.0 * (std::min(before, beyond) + 0.5 * bone.length) / all;  // 1: as much on either side
        bone.upright = amount * kUpright * all * share * share;
    }
    std::vector<std::size_t> frame;
    for (std::size_t p = 0; p < at.size() && !elementOf.empty(); ++p) {
        double all = 0.0, most = 0.0;  // lengths of what hangs here
        for (const std::size_t b : at[p]) {
            const auto& bone = skeleton.bones[b];
            const double branch = bone.length + hanging(bone.start == static_cast<int>(p) ? bone.end : bone.start, b);
            all += branch;
            most = std::max(most, branch);
        }
        const double share = std::min(1.0, 2.0 * (1.0 - most / all));
        for (const std::size_t b : at[p]) {
            frame.clear();
            for (const std::size_t other : at[p])
                if (elementOf[other] >= 0 && elementOf[other] == elementOf[b] && goesOn(other, static_cast<int>(p))) frame.push_back(other);
            if (frame.size() < kFrame || std::find(frame.begin(), frame.end(), b) == frame.end()) continue;
            skeleton.bones[b].upright = std::max(skeleton.bones[b].upright, amount * kUpright * all * share * share);
        }
    }
}

}  // namespace imomushi
