// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Integrals over one flat triangle seen from a collocation point x, in closed form: three logarithms and one arc tangent, nothing
/// singular or nearly singular is left. Symbols: y on the triangle, r = y - x, R = |r|, n its unit normal (counter-clockwise corners),
/// N_a the linear hat function of corner a, b_e = 4 N_a N_b the bubble of the edge from corner a to b (edges in the order 01, 12, 20). Any unit
/// of length (m below); x may lie on a corner or inside an edge.
/// Sources: Wilton, Rao, Glisson et al., IEEE Trans. Antennas Propag. 32 (1984) 276; Graglia, ibid. 41 (1993) 1448;
/// van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125 (solid angle).
struct TriangleIntegrals {
    double solidAngle = 0.0;                  ///< Om = int d(1/R)/dn dS; -4 pi over a closed surface around x
    Vec3 doubleLayer = Vec3::Zero();          ///< D_a = int N_a d(1/R)/dn dS, per corner a
    Vec3 doubleLayerBubble = Vec3::Zero();    ///< int b_e d(1/R)/dn dS, per edge e
    double singleLayer = 0.0;                 ///< I0 = int 1/R dS, m
    Eigen::Matrix3d kelvin;                   ///< S = int r r^T / R^3 dS, m
    Vec3 singleLayerLinear = Vec3::Zero();    ///< int N_a / R dS, m
    std::array<Eigen::Matrix3d, 3> kelvinLinear;  ///< int N_a r r^T / R^3 dS, m
    Vec3 singleLayerGradient = Vec3::Zero();  ///< int r / R dS, m^2
};

/// The reference: one pair, written as the formulas read.
TriangleIntegrals triangleIntegrals(const Vec3& x, const std::array<Vec3, 3>& corners);

/// The blocks of H and G (H u = G t, shear modulus 1) that one pair contributes to the columns of the three corners and, for H, of the three
/// edge bubbles, without the free term. The strongly singular traction kernel is integrated by parts with surface derivatives (Kupradze 1979; Guenter), which is valid on a closed
/// surface for a continuous u:
///   H_a = D_a / (4 pi) I + 1 / (8 pi (1 - nu)) [(1 - 2 nu) I0 I + S] (g_a n^T - n g_a^T),  g_a = surface gradient of N_a
///   G_a = 1 / (16 pi (1 - nu)) [(3 - 4 nu) I int N_a / R + int N_a r r^T / R^3]
/// and for a bubble, whose gradient 4 (N_a g_b + N_b g_a) is linear, the same with N_a inside the integrals that stand before each g_b.
struct PairBlocks {
    std::array<Eigen::Matrix3d, 3> h;
    std::array<Eigen::Matrix3d, 3> bubble;
    std::array<Eigen::Matrix3d, 3> g;
};
PairBlocks pairBlocks(const Vec3& x, const std::array<Vec3, 3>& corners, double nu);

/// What loads contribute to the right side of H u = G t + ... at x, by one triangle (shear modulus 1):
///   force     int U b dV over the body, for a uniform force b per volume, as its part of the surface. With U = 1/(8 pi) [lap R I - grad grad R / (2 (1 - nu))]
///             (Galerkin) and the divergence theorem: 1/(8 pi) [(n . L) I - n L^T / (2 (1 - nu))], L = int r / R dS. Times b. m^2
///   pressure  int U n dS, the tractions of a unit pressure that pushes the triangle outwards: 1/(16 pi (1 - nu)) [(3 - 4 nu) I0 I + S] n. m
struct LoadBlocks {
    Eigen::Matrix3d force = Eigen::Matrix3d::Zero();
    Vec3 pressure = Vec3::Zero();
};
LoadBlocks loadBlocks(const Vec3& x, const std::array<Vec3, 3>& corners, double nu);

/// Triangles laid out for vector instructions (structure of arrays, padded to whole vectors with triangles that contribute nothing).
class TriangleBatch {
public:
    static constexpr std::size_t kPad = 8;  ///< lanes of the widest vector used

    /// Where the integrals of each triangle are added: block columns of its corners, of its edge bubbles (empty: no bubbles), and of the tractions at its corners (empty: no tractions).
    /// A column that nobody reads takes what is not wanted.
    struct Columns {
        std::vector<std::array<std::int32_t, 3>> corner, bubble, traction;
    };

    TriangleBatch() = default;
    /// Triangles `which` of `mesh`, one entry of `columns` each.
    TriangleBatch(const TriangleMesh& mesh, std::span<const std::int32_t> which, const Columns& columns);
    /// Without bubbles, columns given per vertex; `traction` may be empty.
    TriangleBatch(const TriangleMesh& mesh, std::span<const std::int32_t> which, std::span<const std::int32_t> corner,
                  std::span<const std::int32_t> traction = {});

    [[nodiscard]] std::size_t paddedSize() const { return size_; }
    [[nodiscard]] bool hasBubbles() const { return !bubble_.empty(); }

    enum Field { kCorner = 0, kNormal = 9, kTangent = 12, kLength = 21, kHeight = 24, kTwiceArea = 27, kFields = 28 };
    /// Corners (3 x xyz), unit normal, unit tangents of the edges 01 12 20, their lengths, length / twice the area, twice the area.
    [[nodiscard]] const double* field(int f) const { return data_.data() + static_cast<std::size_t>(f) * size_; }
    [[nodiscard]] const std::int32_t* corner(int c) const { return corner_.data() + static_cast<std::size_t>(c) * size_; }
    [[nodiscard]] const std::int32_t* bubble(int e) const { return bubble_.data() + static_cast<std::size_t>(e) * size_; }
    [[nodiscard]] const std::int32_t* traction(int c) const { return traction_.data() + static_cast<std::size_t>(c) * size_; }

private:
    void layOut(const TriangleMesh& mesh, std::span<const std::int32_t> which);

    std::size_t size_ = 0;
    std::vector<double> data_;
    std::vector<std::int32_t> corner_, bubble_, traction_;
};

/// Adds the blocks of pairBlocks() of collocation point x and all triangles of the batch: h + 9 * column (3 x 3, row-major) for corners and, where
/// the batch has them, bubbles, and to g likewise unless g is null (a batch with bubbles has no G). Lengths are of order one: x inside an edge is
/// met within 1e-14. Returns the sum of D_a over the batch. Vector instructions are chosen at run time (Highway).
double addBlocks(const TriangleBatch& batch, const Vec3& x, double nu, double* h, double* g);

/// The sum of loadBlocks() over the batch.
LoadBlocks sumLoads(const TriangleBatch& batch, const Vec3& x, double nu);

}  // namespace imomushi
