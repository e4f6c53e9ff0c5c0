// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/plane.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

/// A point of the flesh that the ground may meet.
struct FleshPoint {
    int point = -1;               ///< the joint point that moves it most
    int bone = -1;                ///< that it turns with, one that ends at `point`; -1: it does not turn
    double lever = 0.0;           ///< how far it lies beyond that end of the bone at rest, over the length of the bone, >= 0
    Vec3 offset = Vec3::Zero();   ///< m, world, from the joint point, as it was shown last, without dents
};

/// How deep the flesh of an element is in the ground as it is shown, dents and all.
struct FleshDepth {
    int point = -1;      ///< a joint point that moves it
    double depth = 0.0;  ///< m; 0 or less: above it
};

/// How far joint points must stay above a plane so that the flesh around them does, from where that was shown last: until it is shown again, it turns with its
/// bone. So it is right where nothing moves, and a frame late where flesh moves by itself; a point that follows it approaches that place and never swings about it.
class FleshClearance {
public:
    explicit FleshClearance(const Skeleton& skeleton);

    /// Flesh as it was shown with joint points at these places, best by joint point and bone. Allocates where there is more of it than ever before.
    /// part: how much of what flesh did by itself is taken over, 0...1.
    void see(std::span<const FleshPoint> flesh, const std::vector<Vec3>& points, double part = 1.0);

    /// Per joint point, m, >= 0: its height where the lowest of its flesh touches the plane. alone: where a point follows its flesh, which turns with it. 0: there is no flesh.
    void find(const std::vector<Vec3>& points, const Plane& plane, const std::vector<char>& alone, std::vector<double>& clearance);
    /// Lifts points until their flesh touches the plane, and gives the clearance that keeps it there; 0 for points so high that none of their flesh may reach it.
    void raise(std::vector<Vec3>& points, const Plane& plane, std::vector<double>& clearance);
    /// m: how far the deepest flesh was below the plane when it was shown, >= 0.
    [[nodiscard]] double depth(const Plane& plane) const;

private:
    struct Bone {
        int start = -1, end = -1;
        Vec3 shown = Vec3::UnitX();   // its direction when flesh was shown
        Vec3 normal = Vec3::UnitY();  // of the plane, turned back from now to then
        Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();  // since it was shown before
    };
    /// Flesh of one joint point that turns with one bone, side by side.
    struct Run {
        int point = -1, bone = -1;
        Eigen::Index first = 0, count = 0;
        double reach = 0.0;  // m: no offset is longer
    };
    void order(std::span<const FleshPoint> flesh);
    void findNormals(const std::vector<Vec3>& points, const Plane& plane);
    /// The height of the joint point of a run where its lowest flesh touches the plane. height: of that point now. alone: see find().
    [[nodiscard]] double clearanceOf(const Run& run, const Plane& plane, double height, bool alone);

    std::vector<Bone> bones_;
    std::vector<Run> runs_;
    Eigen::Index flesh_ = 0;  // so many, of the rows below
    Eigen::Matrix<double, Eigen::Dynamic, 3> offsets_;  // m, world
    Eigen::ArrayXd alone_;    // 1 / (1 + lever): how much of its way is left where its point follows it
    Eigen::ArrayXd heights_;  // m, over the joint point
    std::vector<Vec3> shownAt_;      // per joint point
    std::vector<double> lift_;       // per joint point, m
};

}  // namespace imomushi
