// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/test_motion.h"

#include <cmath>

namespace imomushi {

TestMotion::TestMotion(const Skeleton& skeleton) {
    std::vector<int> uses(skeleton.points.size(), 0);
    for (const auto& b : skeleton.bones) {
        ++uses[b.start], ++uses[b.end];
        amplitude_ += 0.3 * b.length / static_cast<double>(skeleton.bones.size());
    }
    for (std::size_t p = 0; p < uses.size(); ++p)
        if (uses[p] == 1) goals.push_back({static_cast<int>(p), skeleton.points[p]}), rest_.push_back(skeleton.points[p]);
}

void TestMotion::move(double t) {
    for (std::size_t i = 1; i < goals.size(); ++i)
        goals[i].target = rest_[i] + amplitude_ * Vec3(std::sin(t + static_cast<double>(i)), std::sin(0.7 * t), std::sin(0.31 * t));
}

}  // namespace imomushi
