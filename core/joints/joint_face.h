// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {

class EdgeTable;

/// The local frame of a joint face at rest: origin = area centroid of the patch, z = outward normal of the element there,
/// x = the global axis least aligned with z (ties within 1e-6: x before y before z) projected into the plane, y = z cross x.
struct FaceFrame {
    Vec3 origin = Vec3::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns x, y, z

    [[nodiscard]] Vec3 toLocal(const Vec3& world) const { return axes.transpose() * (world - origin); }
    [[nodiscard]] Vec3 toWorld(const Vec3& local) const { return origin + axes * local; }
};

/// What lies within `radius` (m) of `point` along a surface, wherever its triangles end.
struct SurfaceDisc {
    Vec3 point = Vec3::Zero();  ///< m, on the body
    double radius = 0.0;
};

/// A patch of an element's surface, fixed to a joint.
struct JointFace {
    std::string name;
    std::vector<std::int32_t> vertices;   ///< body vertices, ascending
    std::vector<std::int32_t> triangles;  ///< body triangles, ascending; connected
    FaceFrame frame;
    double area = 0.0;            ///< m^2
    double size = 0.0;            ///< m, largest distance of a vertex from the origin of the frame
    double planarityError = 0.0;  ///< m, largest |z| of a vertex in the frame
    bool visible = true;          ///< false: not drawn and not picked in the viewport
    bool locked = false;          ///< not picked there
    /// Flat to rounding or artist's tolerance. A face that is not flat gets three more columns in every basis (FaceBasis).
    [[nodiscard]] bool flat() const { return planarityError <= kFlatTolerance * size; }
    static constexpr double kFlatTolerance = 1e-3;
    /// Of a handle, where its response is made: what is held; `triangles` are those that lie in it. None: `triangles` are.
    std::optional<SurfaceDisc> disc;
    /// Made anew, it is still the same face to the artist.
    void takeNameFrom(const JointFace& was) { name = was.name, visible = was.visible, locked = was.locked; }
};

/// The largest connected patch of triangles with all corners within `tolerance` (metres) of the plane through `origin` with
/// outward `normal` (any length), and normals within 10 degrees of it.
/// Errors: "no-patch" (nothing lies in the plane), "bad-value".
Result<JointFace> jointFaceByPlane(const TriangleMesh& body, const Vec3& origin, const Vec3& normal, double tolerance);

/// The patch of the triangles whose corners are all in `vertices`.
/// Errors: "no-patch", "bad-index", "not-connected", "not-planar" (farther from its plane than half of its size: no frame).
Result<JointFace> jointFaceByVertices(const TriangleMesh& body, const std::vector<std::int32_t>& vertices);

/// The patch of these triangles alone. Errors: those of jointFaceByVertices().
Result<JointFace> jointFaceByTriangles(const TriangleMesh& body, std::vector<std::int32_t> triangles);

/// The flat region around triangle `seed`: grows over neighbours whose normals stay within `angle` radians of the seed's and whose
/// corners stay within `tolerance` metres of its plane. `edges`: of the body. What a click of the face tool selects.
Result<JointFace> jointFaceBySeed(const TriangleMesh& body, const EdgeTable& edges, std::int32_t seed, double angle, double tolerance);

/// A place on the surface of a body.
struct SurfacePoint {
    std::int32_t triangle = -1;  ///< -1: the body has none
    Vec3 point = Vec3::Zero();   ///< m, on that triangle
    double distance = 0.0;       ///< m, from what was asked for
};
/// The place nearest to `point`; of equally near triangles the first.
SurfacePoint nearestOnSurface(const TriangleMesh& body, const Vec3& point);

/// A patch with fewer triangles than this holds its flesh by hardly more than a point, and says little of how it is turned.
inline constexpr std::size_t kFewestDiscTriangles = 6;

/// The disc about a point of triangle `seed`: the triangles within `radius` (m) of it along the surface (SurfaceDistance), as far as they are connected with the
/// seed; where these are fewer than kFewestDiscTriangles, all at the nearest vertex instead. It need not be flat, not nearly; z of its frame is the
/// mean normal. Errors: "bad-index", "bad-value", "no-patch" (no area), "not-a-disc" (it closes around a limb, or has holes), "not-planar" (no outward side).
Result<JointFace> jointFaceByDisc(const TriangleMesh& body, std::int32_t seed, const Vec3& point, double radius);

/// The first of `faces` that shares a vertex with `face`, -1: none. Two faces of an element must not: a ring of free triangles lies between them.
int overlappingFace(std::span<const JointFace> faces, const JointFace& face);

}  // namespace imomushi
