// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/reduction/element_response.h"

namespace imomushi {

/// How a joint face lies in the moving frame of its element: x -> linear * x + shift, element rest axes, m.
struct FaceMotion {
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
    Vec3 shift = Vec3::Zero();
    /// The rotation in `linear`. Its sign says which way round: q turns by 2 acos(w), 0...360 degrees, so that motion is smooth through 180.
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

struct BendWarpTables;

/// The shape of one element under large motions of its joint faces (the manual's model, "Large motion"): the linear response A' v, read as rotations and stretches of
/// the triangles instead of displacements. To second order in the motion it is the linear response.
///
///   1  v is the logarithm of the motions of the faces: rotation vectors, logarithmic stretches.
///   2  What two faces stretch along the line between them is done to the whole body first, with the contraction across it of a free bar. The rest
///      of A' v is carried along.
///   3  Its gradient on each triangle gives a rotation vector w and a strain e (the normal follows from the free surface: no shear there). The
///      target of the triangle is R(w) exp(e) of itself; large strains are softened, and rotations with them. Towards a face, triangles
///      take its rotation and stretch instead (but not its twist): two bodies that meet smoothly at rest go on doing so when their joint bends,
///      where linear elasticity has a singular crease along a rigid rim.
///   4  Vertices follow by least squares over the surface, with a prefactorised system; rotations are fitted to the result and it is solved again
///      (Sorkine & Alexa 2007), which spreads what w and e cannot agree on. Where the response is no longer small by any measure (surfaces of twice their length and more),
///      what it says of single triangles is noise: vertices there are smoothed.
///   5  An inflation restores the volume, to what the linear response says it is: exp(its relative change) of the volume at rest.
///   6  Near a face nothing crosses the plane of the face: it lays itself against it, as flesh against the neighbour's. What that presses in, step 5 lets out elsewhere.
///
/// Faces of a joint should keep their shape, or warp little: what a bend of 90 degrees or more warps by linear elasticity is too much.
/// Bodies of more than 12,000 vertices are worked on a coarse body of 6,000, which carries them smoothly (coarse_body.h); where there is no such body, as they are.
/// A frame takes about 25 (27,000 vertices) to 75 times (2,000) as long as the product A' v, and five times its memory (tests/bench/bend_warp.cpp).
/// Built once, then evaluate() is the per-frame job of one thread: it neither allocates, locks nor fails.
class BendWarp {
public:
    /// Vertices that follow each other in the body's order, kept as x of all, y of all, z of all: as in ResponseBlocks.
    static constexpr int kBlock = 16;

    /// body: closed, finite. nu: Poisson ratio. blocks: first body vertex of each block of the result, ascending; each holds kBlock of them; all free
    /// vertices are in one. Positions of the result are about `middle`. Bodies of several shells and of slivers work; faces may be none.
    /// Errors: "bad-value" when the response belongs to another body or other faces; "cancelled".
    static Result<BendWarp> build(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response, double nu,
                                  std::span<const std::int32_t> blocks, const Vec3& middle, const Progress& progress);
    /// On tables that others may share (BendWarpTables::build(), which build() is short for).
    explicit BendWarp(std::shared_ptr<const BendWarpTables> tables);
    BendWarp(BendWarp&&) noexcept;
    BendWarp& operator=(BendWarp&&) noexcept;
    ~BendWarp();

    /// Body vertices of all faces, in the order of the faces and of their vertices.
    [[nodiscard]] const std::vector<std::int32_t>& heldVertices() const;

    /// motions: one per face. warping: what v has beyond the motions of the faces, g entries (zeros, or the warping columns of a face in its own axes
    /// as if it had not moved). held: where heldVertices() are in the frame of the element, #held x 3, m. All finite.
    /// local: positions of free vertices, in blocks; other entries are left alone. Finite for any finite input, also for collapsed and mirrored
    /// faces.
    void evaluate(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping, const Points& held, float* local);

    /// evaluate() in two steps for several threads: solve() on one; then carry() on any, for all of 0...carried() - 1 in pieces. 0 are carried: solve() is all.
    void solve(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping, const Points& held, float* local);
    void carry(std::size_t begin, std::size_t end, float* local) const;
    [[nodiscard]] std::size_t carried() const;

    struct Cost {
        double seconds = 0.0;    ///< wall time of build()
        std::size_t bytes = 0;   ///< that a frame reads and writes
        std::size_t factor = 0;  ///< entries of the prefactorised system
    };
    [[nodiscard]] Cost cost() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
