// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>

#include "core/session/document_edit.h"

namespace imomushi {

/// Where parts go: x -> linear * x + shift, m; a rotation or a reflection, times a scale.
struct Placing {
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();  ///< scale times a rotation or a reflection
    Vec3 shift = Vec3::Zero();
    double scale = 1.0;  ///< > 0

    /// The mirror image in the plane across `axis` (0...2) at `at`, m. Exact but for one rounding of that coordinate.
    static Placing mirror(int axis, double at);
    /// Scaled and turned about a point, then shifted, m. Without both an exact shift.
    static Placing about(const Vec3& centre, const Eigen::Quaterniond& rotation, double scale, const Vec3& shift);
    [[nodiscard]] bool turns() const { return linear != Eigen::Matrix3d::Identity(); }
    [[nodiscard]] bool moves() const { return turns() || shift != Vec3::Zero(); }
    [[nodiscard]] bool mirrors() const;
    [[nodiscard]] bool keepsShape() const { return scale == 1.0; }
    /// What a rotation from rest becomes, of what keeps its sides.
    [[nodiscard]] Eigen::Quaterniond rotation(const Eigen::Quaterniond& q) const {
        const Vec3 axis = linear / scale * q.vec();
        return Eigen::Quaterniond(q.w(), axis.x(), axis.y(), axis.z()).normalized();
    }
    [[nodiscard]] Vec3 point(const Vec3& p) const { return turns() ? Vec3(linear * p + shift) : Vec3(p + shift); }
    [[nodiscard]] CutPlane plane(const CutPlane& plane) const { return {point(plane.origin), linear / scale * plane.normal}; }
    /// Triangles of mirror images are turned round, so that they still face outward: their second and third corners are exchanged.
    [[nodiscard]] TriangleMesh mesh(const TriangleMesh& mesh) const;
    [[nodiscard]] ElementMesh mesh(const ElementMesh& mesh) const;
    [[nodiscard]] JointFace face(const JointFace& face) const;
};

Element placed(const Element& element, const Placing& placing);
/// Shares mesh and body where it stays.
CharacterSource placed(const CharacterSource& character, const Placing& placing);

/// Gives an element of this document its place, and its response with it, turned or mirrored: one does not depend on where a body stands, but on its size. `known`: of the
/// element as it stood, null: it has none.
void placeElement(DocumentEdit& edit, PartId id, const Placing& placing, const StoredResponse* known);

}  // namespace imomushi
