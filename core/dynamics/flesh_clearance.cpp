// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/flesh_clearance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

// Of raise(): flesh that turns as its point is lifted comes to rest within a few rounds.
constexpr int kRounds = 8;

}  // namespace

FleshClearance::FleshClearance(const Skeleton& skeleton) : shownAt_(skeleton.points), lift_(skeleton.points.size(), 0.0) {
    for (const auto& b : skeleton.bones) bones_.push_back({b.start, b.end});
}

void FleshClearance::order(std::span<const FleshPoint> flesh) {
    flesh_ = static_cast<Eigen::Index>(flesh.size());
    if (flesh_ > offsets_.rows()) {
        offsets_.resize(flesh_, 3);
        alone_.resize(flesh_);
        heights_.resize(flesh_);
        runs_.reserve(flesh.size());
    }
    runs_.clear();
    for (Eigen::Index i = 0; i < flesh_; ++i) {
        const FleshPoint& f = flesh[static_cast<std::size_t>(i)];
        if (runs_.empty() || runs_.back().point != f.point || runs_.back().bone != f.bone) runs_.push_back({f.point, f.bone, i});
        ++runs_.back().count;
        offsets_.row(i) = f.offset.transpose();
        alone_[i] = 1.0 / (1.0 + std::max(0.0, f.lever));
    }
}

void FleshClearance::see(std::span<const FleshPoint> flesh, const std::vector<Vec3>& points, double part) {
    for (Bone& b : bones_) {
        const Vec3 along = points[static_cast<std::size_t>(b.end)] - points[static_cast<std::size_t>(b.start)];
        const double length = along.norm();
        b.turned.setIdentity();
        if (length > 0.0) b.turned = minimalRotation(b.shown, along / length).toRotationMatrix(), b.shown = along / length;
    }
    if (flesh_ == static_cast<Eigen::Index>(flesh.size()) && part < 1.0) {
        for (const Run& run : runs_)
            for (Eigen::Index i = run.first; i < run.first + run.count; ++i) {
                Vec3 offset = offsets_.row(i).transpose();
                if (run.bone >= 0) offset = bones_[static_cast<std::size_t>(run.bone)].turned * offset;
                offsets_.row(i) = (offset + part * (flesh[static_cast<std::size_t>(i)].offset - offset)).transpose();
            }
    } else {
        order(flesh);
    }
    for (Run& run : runs_) run.reach = std::sqrt(offsets_.middleRows(run.first, run.count).rowwise().squaredNorm().maxCoeff());
    shownAt_ = points;
}

void FleshClearance::findNormals(const std::vector<Vec3>& points, const Plane& plane) {
    for (Bone& b : bones_) {
        const Vec3 along = points[static_cast<std::size_t>(b.end)] - points[static_cast<std::size_t>(b.start)];
        const double length = along.norm();
        b.normal = length > 0.0 ? Vec3(minimalRotation(b.shown, along / length).conjugate() * plane.normal()) : plane.normal();
    }
}

double FleshClearance::clearanceOf(const Run& run, const Plane& plane, double height, bool alone) {
    const Vec3& n = run.bone < 0 ? plane.normal() : bones_[static_cast<std::size_t>(run.bone)].normal;
    const auto of = [&](int axis) { return offsets_.col(axis).segment(run.first, run.count).array(); };
    auto heights = heights_.segment(run.first, run.count);
    heights = n.x() * of(0) + n.y() * of(1) + n.z() * of(2);
    // It turns about the other end of its bone as its point alone moves, and so moves farther.
    if (alone) return height - ((heights + height) * alone_.segment(run.first, run.count)).minCoeff();
    return -heights.minCoeff();
}

void FleshClearance::find(const std::vector<Vec3>& points, const Plane& plane, const std::vector<char>& alone, std::vector<double>& clearance) {
    findNormals(points, plane);
    std::fill(clearance.begin(), clearance.end(), 0.0);
    for (const Run& run : runs_) {
        const auto i = static_cast<std::size_t>(run.point);
        clearance[i] = std::max(clearance[i], clearanceOf(run, plane, plane.height(points[i]), alone[i] != 0));
    }
}

void FleshClearance::raise(std::vector<Vec3>& points, const Plane& plane, std::vector<double>& clearance) {
    std::fill(lift_.begin(), lift_.end(), 0.0);
    for (int round = 0; round < kRounds; ++round) {
        findNormals(points, plane);
        std::fill(clearance.begin(), clearance.end(), 0.0);
        for (const Run& run : runs_) {
            const auto i = static_cast<std::size_t>(run.point);
            const double height = plane.height(points[i]);
            // Not even straight down does it reach the plane.
            if (lift_[i] == 0.0 && height > run.reach) continue;
            clearance[i] = std::max(clearance[i], clearanceOf(run, plane, height, true));
        }
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
    for (const Run& run : runs_) {
        const double height = plane.height(shownAt_[static_cast<std::size_t>(run.point)]);
        if (height - run.reach < lowest) lowest = std::min(lowest, height + offsets_.middleRows(run.first, run.count).lazyProduct(plane.normal()).minCoeff());
    }
    return -lowest;
}

}  // namespace imomushi
