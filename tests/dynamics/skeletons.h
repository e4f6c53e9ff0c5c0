// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <random>

#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Bones of one length along x.
inline Skeleton boneChain(int bones, double length = 1.0) {
    Skeleton s;
    for (int i = 0; i <= bones; ++i) s.points.emplace_back(i * length, 0, 0);
    for (int i = 0; i < bones; ++i) s.bones.push_back({i, i + 1, i - 1, length});
    return s;
}

/// A body bone and `arms` arms of `bones` bones from its lower end, which is joint point 1.
inline Skeleton boneOctopus(int arms, int bones) {
    Skeleton s;
    s.points = {Vec3(0, 1, 0), Vec3(0, 0, 0)};
    s.bones.push_back({0, 1, -1, 1.0});
    for (int a = 0; a < arms; ++a) {
        int at = 1, parent = 0;
        const double angle = 2 * M_PI * a / arms;
        const Vec3 out(std::cos(angle), -0.3, std::sin(angle));
        for (int i = 1; i <= bones; ++i) {
            s.points.push_back(0.6 * i * out);
            const int point = static_cast<int>(s.points.size()) - 1;
            s.bones.push_back({at, point, parent, (s.points[point] - s.points[at]).norm()});
            at = point;
            parent = static_cast<int>(s.bones.size()) - 1;
        }
    }
    return s;
}

/// A random tree whose bones leave one another at random angles.
inline Skeleton randomTree(std::mt19937& random, int bones) {
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    Skeleton s;
    s.points.emplace_back(0, 0, 0);
    for (int b = 0; b < bones; ++b) {
        const int at = static_cast<int>(random() % s.points.size());
        const double x = d(random), y = d(random), z = d(random);
        const Vec3 out = Vec3(x, y, z) + Vec3(0, 0, 0.01);
        s.points.push_back(s.points[at] + out.normalized() * (0.55 + 0.45 * d(random)));
        s.bones.push_back({at, b + 1, -1, (s.points[b + 1] - s.points[at]).norm()});
    }
    return s;
}

}  // namespace imomushi
