// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/mesh/triangle_tree.h"
#include "core/reduction/element_response.h"

namespace imomushi {

/// The surface of one element as fingers feel it: where it can be touched, and which patches (TouchResponse) a finger presses there. The same in all frames.
class TouchSurface {
public:
    static constexpr int kMaxSpread = 8;  ///< no finger is wider than this many smoothings of its patches, see weigh()

    /// `response` was made with ResponseInput::touch. Errors: "bad-value" (a response without patches, or of another mesh).
    static Result<std::shared_ptr<const TouchSurface>> build(const ElementMesh& mesh, std::span<const JointFace> faces,
                                                             std::shared_ptr<const ElementResponse> response);

    /// A point of the surface that can be touched.
    struct Point {
        std::int32_t triangle = -1;  ///< of the body; -1: none
        Vec3 barycentric = Vec3::Zero();
        double distance = 0.0;  ///< m, from what was asked for
    };
    /// The nearest one to a place in the rest pose; with a direction, among those whose surface faces it (where a ray from outside came from: minus
    /// the ray).
    [[nodiscard]] Point nearest(const Vec3& rest) const;
    [[nodiscard]] Point nearestFacing(const Vec3& rest, const Vec3& direction) const;
    /// It is a point of the surface outside of joint faces and cavities.
    [[nodiscard]] bool canTouch(const Point& point) const;

    /// Which patches a finger of this radius (m) presses, and how much of its force each takes: `weights`, #patches, sum 1. `next`: memory for as many.
    /// Does not allocate.
    void weigh(const Point& point, double radius, Eigen::VectorXd& weights, Eigen::VectorXd& next) const;
    /// m: radius of the smallest finger.
    [[nodiscard]] double narrowest() const;

    [[nodiscard]] const TouchResponse& touch() const { return response_->touch; }
    /// Per triangle of the body, 1: it can be touched.
    [[nodiscard]] const std::vector<char>& touchable() const { return touchable_; }
    [[nodiscard]] std::array<std::int32_t, 3> corners(std::int32_t triangle) const;
    [[nodiscard]] Vec3 vertex(std::int32_t v) const { return body_.vertices.row(v).transpose(); }   ///< at rest, m
    [[nodiscard]] Vec3 normal(std::int32_t v) const { return normals_.row(v).transpose(); }         ///< at rest
    /// The first row of a body vertex in TouchResponse::displacement, -1: it does not move.
    [[nodiscard]] std::int32_t row(std::int32_t v) const { return row_[static_cast<std::size_t>(v)]; }
    /// Per patch: the largest displacement of any vertex per force, m / m^2.
    [[nodiscard]] const Eigen::VectorXd& largestDisplacement() const { return largest_; }
    [[nodiscard]] double size() const { return size_; }  ///< of the element: the diagonal of its box, m
    [[nodiscard]] std::size_t bytes() const;

private:
    TouchSurface(const ElementMesh& mesh, std::span<const JointFace> faces, std::shared_ptr<const ElementResponse> response);
    void findOverlap(const std::vector<std::int32_t>& triangles);

    std::shared_ptr<const ElementResponse> response_;
    TriangleMesh body_;
    Points normals_;
    std::vector<std::int32_t> row_;  // per body vertex
    std::vector<char> touchable_;    // per triangle
    std::unique_ptr<TriangleTree> tree_;
    Eigen::MatrixXd overlap_;  // P x P, rows add up to 1: how patches share places
    Eigen::VectorXd largest_;
    double size_ = 1.0;
};

}  // namespace imomushi
