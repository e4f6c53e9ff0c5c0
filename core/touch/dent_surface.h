// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/touch/touch_surface.h"

namespace imomushi {

/// The force of a finger tip, and where it presses: what its patches are too wide for. Rest pose, m, along the element rest axes. All numbers 0: none.
struct Dent {
    static constexpr int kNumbers = 14;

    Vec3 force = Vec3::Zero();  ///< over the shear modulus, m^2
    Vec3 centre = Vec3::Zero();
    Vec3 normal = Vec3::Zero();       ///< outward
    double radius = 0.0;              ///< of the contact; 0: none
    Vec3 patchCentre = Vec3::Zero();  ///< of what its patches press
    double patchRadius = 0.0;

    bool operator==(const Dent&) const = default;
    [[nodiscard]] bool active() const { return radius > 0.0 && !force.isZero(0.0); }
    /// The numbers in this order.
    void put(double* to) const;
    void take(const double* from);
    /// Between two, the first at `part` 0, the second at 1: one that comes or goes stays in its place.
    static Dent between(const Dent& a, const Dent& b, double part);
};

/// Dents under finger tips that are smaller than patches: the answer of a half-space (Boussinesq, Cerruti) to the pressure of a smooth sphere (Hertz: that of
/// half an ellipsoid), less its answer to such a pressure with the middle and the mean square radius of what the patches press. The two have the same force, so
/// the difference fades with the third power of the distance; it goes to zero beyond kReach radii of the patches, towards joint faces, and where the surface
/// faces away. Off the plane, distances are straight ones. There are no columns: a frame looks at blocks of vertices near a dent. Built once; nothing else
/// allocates.
class DentSurface {
public:
    static constexpr double kReach = 2.5;

    /// `surface`: of this mesh and these faces; nu: Poisson's ratio; first: the blocks of the frame, as those of TouchBlocks.
    DentSurface(const ElementMesh& mesh, std::span<const JointFace> faces, std::shared_ptr<const TouchSurface> surface, double nu,
                std::span<const std::int32_t> first);

    /// A dent at that point, without force, as wide as its patches with these shares of the force.
    [[nodiscard]] Dent at(const TouchSurface::Point& point, const Eigen::VectorXd& weights) const;
    /// m: a contact with a smaller radius would fall between the vertices there.
    [[nodiscard]] double narrowest(const TouchSurface::Point& point) const;
    /// Normal displacement at the middle of a contact per unit of force, times the radius of the contact: 3/8 (1 - nu).
    [[nodiscard]] double depth() const;
    /// Displacement of a vertex per force of the dent, 1/m.
    [[nodiscard]] Eigen::Matrix3d compliance(const Dent& dent, std::int32_t vertex) const;
    /// Adds the displacements by the dents to blocks [begin, end) of `local`, as TouchBlocks::add().
    void add(std::span<const Dent> dents, std::size_t begin, std::size_t end, float* local) const;
    [[nodiscard]] std::size_t bytes() const;

private:
    std::shared_ptr<const TouchSurface> surface_;
    double nu_ = 0.45;
    std::vector<float> clear_;  // per vertex: 0 on joint faces and where nothing moves ... 1
    Points centres_;            // of patches
    Eigen::VectorXd spread_;    // of patches: mean squared distance from the centre, m^2
    // Per block: x y z, normal, clear, each of all its vertices; and a ball around those that move.
    std::vector<float, Eigen::aligned_allocator<float>> blocks_;
    std::vector<Eigen::Vector4f> balls_;  // centre and radius, < 0: none
};

}  // namespace imomushi
