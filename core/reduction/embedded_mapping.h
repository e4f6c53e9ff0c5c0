// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/mesh/triangle_frame.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {

/// Carries what the surface of a body does to points that are embedded in it: vertices of render meshes, on it, beside it or inside.
///
/// A point x follows a point p of the surface. With the corners x_i of p's triangle, barycentric coordinates b_i, displacements u_i and displacement
/// gradients G_i (DisplayMapping),
///
///     u(x) = sum_i b_i ( u_i + 1/2 (1 - h) G_i (p - x_i) + (1 - w) G_i (x - p) ) + w (L - 1) (x - p)
///
/// h is the share of p's corners that joint faces hold. L is the linear part of the motion of the joint face nearest to p; w is 1 on that face and fades to 0
/// over kBand times |x - p| from it. So two elements move points beside their joint in the same way: p follows the face on both sides, and so does x - p.
/// Exact for rigid motions, and away from joint faces for constant strain without traction on the surface.
///
/// In deformed positions, where F_i = 1 + G_i may turn by far:  x' = sum_i ( b_i x_i' + F_i c_i ) + w L (x - p),
/// c_i = b_i ( 1/2 (1 - h) (p - x_i) + (1 - w) (x - p) ).
///
/// p is the nearest point of the surface that is seen. If a normal is given, p is the nearest point on triangles that face its way, unless that is more than kReach times as far or
/// deeper than kDeep: so a point takes the right side of a thin wall. Points deep inside follow the nearest surface with its gradient, whichever way it faces. Faces
/// inside joints are not seen.
class EmbeddedMapping {
public:
    static constexpr double kReach = 3.0;
    static constexpr double kDeep = 0.05;  ///< diagonals of the body
    static constexpr double kBand = 2.0;

    struct Input {
        const TriangleMesh* body = nullptr;
        std::span<const JointFace> faces;
        std::span<const char> covered;          ///< per face: not 0 = inside a joint, not seen
        const Points* points = nullptr;         ///< #P x 3, m
        const Points* normals = nullptr;        ///< #P x 3, any length, zero: not known; null or 0 x 3: none are
        std::span<const std::int32_t> place;    ///< per point: the earlier point whose p it takes, or itself; empty: all their own
        double nu = 0.45;                       ///< 0...0.5
        int threads = 1;                        ///< changes no byte
    };
    /// Errors: "bad-value" (sizes, numbers, or a body without a surface that is seen).
    static Result<EmbeddedMapping> build(const Input& input);

    [[nodiscard]] std::size_t size() const { return places_.size(); }  ///< #P

    /// w (x - p) of a point, at rest: what moves with L.
    struct JointPart {
        std::int32_t point = 0;
        int face = 0;
        Vec3 offset = Vec3::Zero();  ///< m
    };
    /// Ascending by point; of points without such a part: none.
    [[nodiscard]] const std::vector<JointPart>& jointParts() const { return jointParts_; }

    /// b_i of a corner that a joint face holds.
    struct HeldPart {
        std::int32_t point = 0, vertex = 0;  ///< of the body
        double weight = 0.0;
    };
    [[nodiscard]] const std::vector<HeldPart>& heldParts() const { return heldParts_; }  ///< ascending by point

    /// u(x) without w (L - 1) (x - p), 3 #P x g. displacement: 3 * #body vertices x g, xyz per vertex, held ones included.
    [[nodiscard]] Eigen::MatrixXd apply(const Eigen::MatrixXd& displacement, int threads) const;

    /// The same in the steps of a frame, which neither allocate nor fail; each over a range, after the step before it is done. Displacements give u(x), deformed
    /// positions x', both without w L (x - p). values: #body vertices x 3.
    enum class Values { Displacements, Positions };
    struct Gradients {
        std::vector<Eigen::Matrix3d> ofTriangle, ofVertex;
    };
    [[nodiscard]] Gradients gradients() const;
    [[nodiscard]] std::size_t triangles() const { return triangles_.size(); }
    [[nodiscard]] std::size_t vertices() const { return vertices_.size(); }
    template <class Scalar>
    void findTriangles(Values kind, const Scalar* values, std::size_t begin, std::size_t end, Gradients& to) const;
    void findVertices(std::size_t begin, std::size_t end, Gradients& to) const;
    template <class Scalar>
    [[nodiscard]] Vec3 at(std::size_t point, const Scalar* values, const Gradients& gradients) const;

    [[nodiscard]] std::size_t bytes() const;

private:
    struct Place {
        std::array<std::int32_t, 3> corner{}, gradient{};  // body vertices; indices into vertices_
        Vec3 weight = Vec3::Zero();                        // b
        std::array<Vec3, 3> offset{};                      // c, m
    };
    struct Triangle {
        std::array<std::int32_t, 3> corner{};
        TriangleFrame frame;
    };
    std::vector<Place> places_;
    std::vector<JointPart> jointParts_;
    std::vector<HeldPart> heldParts_;
    std::vector<Triangle> triangles_;      // free ones around corners of places
    std::vector<std::int32_t> vertices_;   // corners of places
    std::vector<std::int32_t> around_;     // per entry of vertices_: indices into triangles_
    std::vector<std::uint32_t> firstAround_;
    std::size_t bodyVertices_ = 0;
    double stretch_ = 0.0;                 // nu / (1 - nu)
};

}  // namespace imomushi
