// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/flesh_clearance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

// Of raise(): flesh that turns as its point is lifted comes to rest within a few rounds.
constexpr int kRounds = 8;

}  // namespace

FleshClearance::FleshClearance(const Skeleton& skeleton) : shownAt_(skeleton.points), lift_(skeleton.points.size(), 0.0), all_(skeleton.points.size(), 1) {
    for (const auto& b : skeleton.bones) bones_.push_back({b.start, b.end});
}

void FleshClearance::see(std::span<const FleshPoint> flesh, const std::vector<Vec3>& points, double part) {
    for (Bone& b : bones_) {
        const Vec3 along = points[static_cast<std::size_t>(b.end)] - points[static_cast<std::size_t>(b.start)];
        const double length = along.norm();
        b.turned.setIdentity();
        if (length > 0.0) b.turned = minimalRotation(b.shown, along / length).toRotationMatrix(), b.shown = along / length;
    }
    const bool known = flesh_.size() == flesh.size() && part < 1.0;
    if (!known) flesh_.assign(flesh.begin(), flesh.end());
    for (std::size_t i = 0; known && i < flesh_.size(); ++i) {
        Vec3& offset = flesh_[i].offset;
        if (flesh_[i].bone >= 0) offset = bones_[static_cast<std::size_t>(flesh_[i].bone)].turned * offset;
        offset += part * (flesh[i].offset - offset);
    }
    shownAt_ = points;
}

void FleshClearance::find(const std::vector<Vec3>& points, const Plane& plane, const std::vector<char>& alone, std::vector<double>& clearance) {
    for (Bone& b : bones_) {
        const Vec3 along = points[static_cast<std::size_t>(b.end)] - points[static_cast<std::size_t>(b.start)];
        const double length = along.norm();
        b.normal = length > 0.0 ? Vec3(minimalRotation(b.shown, along / length).conjugate() * plane.normal()) : plane.normal();
    }
    std::fill(clearance.begin(), clearance.end(), 0.0);
    for (const FleshPoint& f : flesh_) {
        const auto i = static_cast<std::size_t>(f.point);
        const double below = -f.offset.dot(f.bone < 0 ? plane.normal() : bones_[static_cast<std::size_t>(f.bone)].normal);
        double wanted = below;
        // It turns about the other end of its bone as its point alone moves, and so moves farther.
        if (alone[i] && f.lever > 0.0) {
            const double height = plane.height(points[i]);
            wanted = height + (below - height) / (1.0 + f.lever);
        }
        clearance[i] = std::max(clearance[i], wanted);
    }
}

void FleshClearance::raise(std::vector<Vec3>& points, const Plane& plane, std::vector<double>& clearance) {
    std::fill(lift_.begin(), lift_.end(), 0.0);
    for (int round = 0; round < kRounds; ++round) {
        find(points, plane, all_, clearance);
        bool moved = false;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double wanted = std::max(0.0, lift_[i] + clearance[i] - plane.height(points[i]));
            if (wanted == lift_[i]) continue;
            points[i] += (wanted - lift_[i]) * plane.normal();
            lift_[i] = wanted;
            moved = true;
        }
        if (!moved) break;
    }
    for (std::size_t i = 0; i < points.size(); ++i)
        if (lift_[i] > 0.0) clearance[i] = std::max(plane.height(points[i]), 0.0);
}

double FleshClearance::depth(const Plane& plane) const {
    double lowest = 0.0;
    for (const FleshPoint& f : flesh_) lowest = std::min(lowest, plane.height(shownAt_[static_cast<std::size_t>(f.point)] + f.offset));
    return -lowest;
}

}  // namespace imomushi
