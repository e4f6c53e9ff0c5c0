// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/joints/joint_face.h"
#include "core/joints/warping.h"

namespace imomushi {

/// Where the points of a joint face are, relative to their rest, in the frame of the face: p -> linear * p + shift, p = (x, y, z)
/// with z = 0 on a flat face. At rest linear = I and shift = 0.
struct JointMap {
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
    Vec3 shift = Vec3::Zero();
};

/// Eq. (5) of Watanabe et al. (FIT 2006). Angles in radians, dz in metres along the outward normal.
struct PaperParameters {
    double a = 1.0, b = 1.0, theta1 = 0.0, theta2 = 0.0, dz = 0.0;
};

/// The joint map of eq. (5), exactly: in-plane stretch a at theta1 (which rises by theta2) and b across it, shift dz.
/// The third column of `linear` (used by faces that are not flat) is the unit normal of the displaced plane.
JointMap jointMap(const PaperParameters& p);

/// Numbers are stored in files: new kinds come last.
enum class BasisKind { Paper, Affine, Full, Modes };

/// Which joint modes the faces of a character have. One of every kind but Modes is that kind.
struct BasisChoice {
    BasisKind kind = BasisKind::Affine;
    int modes = 0;  ///< warping columns per face, 1...kMaxModes, of Modes; else 0

    static constexpr int kMaxModes = 3 * Warping::kMax;
    constexpr BasisChoice() = default;
    constexpr BasisChoice(BasisKind k, int count = 0) : kind(k), modes(count) {}  // a kind is a choice
    bool operator==(const BasisChoice&) const = default;
};

/// The joint modes of one face: displacement of a face point = sum of columns times v, where v = 0 at rest.
/// Columns of paper and affine in this order, in the frame of the face (u = displacement of the point (x, y, z)):
///   0 ux = x     1 ux = y, uy = x     2 uy = y     3 uz = x     4 uz = y     5 uz = 1          (paper, eq. (5))
///   6 ux = 1     7 uy = 1     8 ux = -y, uy = x                                                (affine adds these)
///   then, on faces that are not flat, three more: ux = z, uy = z, uz = z
/// Columns of modes: those of affine, then those of warpColumn(), as far as the count goes.
/// Columns of full: the displacement (m) of each vertex of the face, 3 i + axis for the i-th one, linear on the triangles in between.
struct FaceBasis {
    BasisKind kind = BasisKind::Affine;
    bool flat = true;  ///< of the others
    int vertices = 0;  ///< of the face, in full; else 0
    int modes = 0;     ///< warping columns, in modes; else 0
    Warping warping;   ///< of warpShapes(modes) shapes

    /// The basis of `choice` on a face of `body`.
    static FaceBasis on(const TriangleMesh& body, const JointFace& face, const BasisChoice& choice);
    [[nodiscard]] BasisChoice choice() const { return {kind, modes}; }

    /// Those before the warping; all, where there is none.
    [[nodiscard]] int plainColumns() const { return kind == BasisKind::Full ? 3 * vertices : (kind == BasisKind::Paper ? 6 : 9) + (flat ? 0 : 3); }
    [[nodiscard]] int columns() const { return plainColumns() + modes; }
    bool operator==(const FaceBasis&) const = default;

    /// 3 x columns(): the displacement of the local point p, in face axes. Not of full, which knows vertices only.
    [[nodiscard]] Eigen::Matrix<double, 3, Eigen::Dynamic> at(const Vec3& p) const;
    /// The same for the i-th vertex of the face, whose rest position is p, in any basis.
    [[nodiscard]] Eigen::Matrix<double, 3, Eigen::Dynamic> at(const Vec3& p, int i) const;

    /// The coefficients of `map`; what the basis cannot say is left out. `lost`: the largest relative size of what was left out
    /// (twist as an angle in radians; in-plane shift relative to `size`, the size of the face in metres), 0 when nothing was.
    void coefficients(const JointMap& map, double size, double* v, double& lost) const;  ///< not of full
    /// In any basis. `rest`: localVertices() of the face.
    void coefficients(const JointMap& map, const Points& rest, double size, double* v, double& lost) const;
};

/// The vertices of a face at rest in its own axes, #vertices x 3.
Points localVertices(const TriangleMesh& body, const JointFace& face);

/// "paper", "affine", "full", "modes:12" (any count 1...36 in decimal digits). Errors: "bad-value" with the names there are.
Result<BasisChoice> parseBasis(const std::string& name);
/// What parseBasis() reads back to the same choice.
std::string basisName(const BasisChoice& choice);

}  // namespace imomushi
