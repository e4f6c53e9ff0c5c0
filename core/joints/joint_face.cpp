// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/joints/joint_face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/base/finite.h"
#include "core/base/union_find.h"
#include "core/joints/carried_face.h"
#include "core/mesh/closest_point.h"
#include "core/mesh/edge_key.h"
#include "core/mesh/surface_distance.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"

namespace imomushi {

FaceFrame faceFrame(const Vec3& origin, const Vec3& z) {
    // Two global axes are equally far from the normal when their cosines differ by less; then the earlier one gives x.
    constexpr double kAxisTie = 1e-6;
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(z[k]) < std::abs(z[axis]) - kAxisTie) axis = k;
    const Vec3 e = Vec3::Unit(axis);
    const Vec3 x = (e - z.dot(e) * z).normalized();
    FaceFrame frame;
    frame.origin = origin;
    frame.axes << x, z.cross(x), z;
    return frame;
}

namespace {

/// Triangles of a plane face may lean this far from it: the contract's 10 degrees.
const double kPlaneCosine = std::cos(10.0 * std::numbers::pi / 180.0);
/// A patch that leaves its own plane farther than this part of its size has no sensible frame.
constexpr double kLargestBulge = 0.5;
/// The area vector of a patch over its area: below, it folds back on itself and has no outward side.
constexpr double kLeastOutward = 0.3;
/// The same for discs, which may go over a tip.
constexpr double kLeastOutwardOfDisc = 0.02;

/// The connected patches (over shared edges) of the chosen triangles, each ascending.
std::vector<std::vector<std::int32_t>> patches(const TriangleMesh& body, const std::vector<std::int32_t>& chosen) {
    UnionFind sets(chosen.size());
    std::unordered_map<std::uint64_t, std::int32_t> firstAt;
    for (std::size_t i = 0; i < chosen.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const auto [place, fresh] =
                firstAt.try_emplace(edgeKey(body.triangles(chosen[i], c), body.triangles(chosen[i], (c + 1) % 3)), static_cast<std::int32_t>(i));
            if (!fresh) sets.unite(static_cast<std::int32_t>(i), place->second);
        }
    std::vector<std::vector<std::int32_t>> result;
    std::unordered_map<std::int32_t, std::size_t> indexOf;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const auto [place, fresh] = indexOf.try_emplace(sets.find(static_cast<std::int32_t>(i)), result.size());
        if (fresh) result.emplace_back();
        result[place->second].push_back(chosen[i]);
    }
    return result;
}

/// Whether a connected patch is a disc: without holes, and not closed around anything (Euler's characteristic is 1).
bool isDisc(const TriangleMesh& body, const std::vector<std::int32_t>& patch) {
    std::unordered_set<std::int32_t> vertices;
    std::unordered_set<std::uint64_t> edges;
    for (const std::int32_t t : patch)
        for (int c = 0; c < 3; ++c) {
            vertices.insert(body.triangles(t, c));
            edges.insert(edgeKey(body.triangles(t, c), body.triangles(t, (c + 1) % 3)));
        }
    return vertices.size() + patch.size() == edges.size() + 1;
}

/// The face of a connected patch of triangles. `curved`: as far from a plane as it likes to be.
Result<JointFace> faceOf(const TriangleMesh& body, std::vector<std::int32_t> triangles, bool curved = false) {
    JointFace face;
    std::sort(triangles.begin(), triangles.end());
    face.triangles = std::move(triangles);
    for (const std::int32_t t : face.triangles)
        for (int c = 0; c < 3; ++c) face.vertices.push_back(body.triangles(t, c));
    std::sort(face.vertices.begin(), face.vertices.end());
    face.vertices.erase(std::unique(face.vertices.begin(), face.vertices.end()), face.vertices.end());

    // Relative to one of its own points, so that a face far from the world's origin loses no digits.
    const Vec3 near = body.vertices.row(face.vertices.front());
    Vec3 outward = Vec3::Zero(), moment = Vec3::Zero();
    double area = 0.0;
    for (const std::int32_t t : face.triangles) {
        const Vec3 twice = areaVector(body, t);
        Vec3 centre = Vec3::Zero();
        for (int c = 0; c < 3; ++c) centre += (body.vertices.row(body.triangles(t, c)).transpose() - near) / 3.0;
        const double a = 0.5 * twice.norm();
        outward += 0.5 * twice;
        moment += a * centre;
        area += a;
    }
    if (!(area > 0.0)) return fail("no-patch", "The patch has no area; choose triangles that are not degenerate.");
    if (!(outward.norm() > (curved ? kLeastOutwardOfDisc : kLeastOutward) * area))
        return fail("not-planar", "The patch bends too far to have one outward side; choose a flatter one.");
    face.area = area;
    face.frame = faceFrame(near + moment / area, outward.normalized());
    for (const std::int32_t v : face.vertices) {
        const Vec3 p = face.frame.toLocal(body.vertices.row(v).transpose());
        face.size = std::max(face.size, p.norm());
        face.planarityError = std::max(face.planarityError, std::abs(p.z()));
    }
    if (!curved && face.planarityError > kLargestBulge * face.size)
        return fail("not-planar", "The patch leaves its plane by more than half of its size; choose a flatter one.");
    return face;
}

/// The corners of the triangle lie within `tolerance` of a plane, and it leans no farther from its normal.
bool liesInPlane(const TriangleMesh& body, std::int32_t t, const Vec3& origin, const Vec3& normal, double tolerance, double cosine) {
    const auto near = [&](int c) { return std::abs(normal.dot(body.vertices.row(body.triangles(t, c)).transpose() - origin)) <= tolerance; };
    const auto faces = [&] {
        const Vec3 twice = areaVector(body, t);
        return twice.dot(normal) >= cosine * twice.norm();
    };
    return near(0) && near(1) && near(2) && faces();
}

}  // namespace

Result<JointFace> jointFaceByPlane(const TriangleMesh& body, const Vec3& origin, const Vec3& normal, double tolerance) {
    if (!allFinite(origin) || !allFinite(normal) || !(normal.norm() > 0.0))
        return fail("bad-value", "The plane needs a finite origin and a normal that is not zero.");
    if (!(tolerance >= 0.0) || !std::isfinite(tolerance))
        return fail("bad-value", "The tolerance must be a finite number of at least 0.");
    const Vec3 n = normal.stableNormalized();
    std::vector<std::int32_t> inPlane;
    for (std::int32_t t = 0; t < body.triangles.rows(); ++t)
        if (liesInPlane(body, t, origin, n, tolerance, kPlaneCosine)) inPlane.push_back(t);
    auto found = patches(body, inPlane);
    if (found.empty())
        return fail("no-patch",
                    "No triangle that faces along the normal lies in the plane; move the plane, turn its normal outward or raise "
                    "the tolerance.");
    const auto area = [&](const std::vector<std::int32_t>& patch) {
        double sum = 0.0;
        for (const std::int32_t t : patch) sum += areaVector(body, t).norm();
        return sum;
    };
    return faceOf(body, std::move(*std::max_element(found.begin(), found.end(), [&](const auto& a, const auto& b) { return area(a) < area(b); })));
}

Result<JointFace> jointFaceByTriangles(const TriangleMesh& body, std::vector<std::int32_t> triangles) {
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    if (triangles.empty()) return fail("no-patch", "The face has no triangle; name at least one.");
    if (triangles.front() < 0 || triangles.back() >= body.triangles.rows())
        return fail("bad-index", "A triangle of the face does not exist; the element has " + std::to_string(body.triangles.rows()) + " triangles.");
    if (patches(body, triangles).size() > 1) return fail("not-connected", "The triangles do not hang together by their sides; make a face of each patch.");
    return faceOf(body, std::move(triangles));
}

Result<JointFace> jointFaceByVertices(const TriangleMesh& body, const std::vector<std::int32_t>& vertices) {
    std::vector<bool> named(static_cast<std::size_t>(body.vertices.rows()), false);
    for (const std::int32_t v : vertices) {
        if (v < 0 || v >= body.vertices.rows())
            return fail("bad-index", "Vertex " + std::to_string(v) + " does not exist; the element has " +
                                         std::to_string(body.vertices.rows()) + " vertices.");
        named[static_cast<std::size_t>(v)] = true;
    }
    std::vector<std::int32_t> chosen;
    std::vector<bool> used(named.size(), false);
    for (std::int32_t t = 0; t < body.triangles.rows(); ++t) {
        const auto is = [&](int c) { return named[static_cast<std::size_t>(body.triangles(t, c))]; };
        if (!is(0) || !is(1) || !is(2)) continue;
        chosen.push_back(t);
        for (int c = 0; c < 3; ++c) used[static_cast<std::size_t>(body.triangles(t, c))] = true;
    }
    if (chosen.empty())
        return fail("no-patch", "The vertices enclose no triangle; name all corners of the triangles of the face.");
    for (const std::int32_t v : vertices)
        if (!used[static_cast<std::size_t>(v)])
            return fail("not-connected", "Vertex " + std::to_string(v) +
                                             " belongs to no triangle of the face; name its neighbours too or leave it out.");
    auto found = patches(body, chosen);
    if (found.size() > 1)
        return fail("not-connected", "The vertices form " + std::to_string(found.size()) +
                                         " separate patches; make one joint face of each.");
    return faceOf(body, std::move(found.front()));
}

Result<JointFace> jointFaceBySeed(const TriangleMesh& body, const EdgeTable& edges, std::int32_t seed, double angle, double tolerance) {
    if (seed < 0 || seed >= body.triangles.rows())
        return fail("bad-index", "Triangle " + std::to_string(seed) + " does not exist.");
    const Vec3 n = areaVector(body, seed).stableNormalized();
    const Vec3 origin = body.vertices.row(body.triangles(seed, 0));
    if (!(n.norm() > 0.5)) return fail("no-patch", "The triangle has no area; choose another one.");
    const double cosine = std::cos(std::clamp(angle, 0.0, std::numbers::pi));
    std::vector<std::int32_t> patch{seed};
    std::vector<char> seen(static_cast<std::size_t>(body.triangles.rows()), 0);
    seen[static_cast<std::size_t>(seed)] = 1;
    for (std::size_t i = 0; i < patch.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const int edge = edges.edgeOf(patch[i], c);
            if (edge < 0) continue;
            for (const EdgeUse& use : edges.uses(edge))
                if (!std::exchange(seen[static_cast<std::size_t>(use.triangle)], char(1)) && liesInPlane(body, use.triangle, origin, n, tolerance, cosine)) patch.push_back(use.triangle);
        }
    return faceOf(body, std::move(patch));
}

SurfacePoint nearestOnSurface(const TriangleMesh& body, const Vec3& point) {
    SurfacePoint best;
    best.distance = std::numeric_limits<double>::infinity();
    for (std::int32_t t = 0; t < body.triangles.rows(); ++t) {
        const auto corner = [&](int c) -> Vec3 { return body.vertices.row(body.triangles(t, c)).transpose(); };
        const Vec3 a = corner(0), b = corner(1), c = corner(2);
        ClosestOnTriangle closest = closestOnTriangle(b - a, c - a, point - a, point - b, point - c);
        if (const double sum = closest.weights.sum(); sum > 0.0) closest.weights /= sum;
        const Vec3 at = closest.weights[0] * a + closest.weights[1] * b + closest.weights[2] * c;
        const double distance = (at - point).norm();
        if (!(distance < best.distance)) continue;
        best = {t, at, distance};
    }
    return best;
}

Result<JointFace> jointFaceByDisc(const TriangleMesh& body, std::int32_t seed, const Vec3& point, double radius) {
    if (seed < 0 || seed >= body.triangles.rows()) return fail("bad-index", "Triangle " + std::to_string(seed) + " does not exist.");
    if (!allFinite(point) || !(radius > 0.0) || !std::isfinite(radius)) return fail("bad-value", "A disc needs a finite point and a radius above 0.");
    SurfaceDistance surface(body);
    std::vector<SurfaceSource> sources;
    for (int c = 0; c < 3; ++c) {
        const std::int32_t v = body.triangles(seed, c);
        sources.emplace_back(v, (body.vertices.row(v).transpose() - point).norm());
    }
    std::vector<std::int32_t> near;
    std::unordered_set<std::int32_t> within;
    surface.spread(
        sources, radius, [](std::int32_t, double) { return true; },
        [&](std::int32_t v, double) {
            within.insert(v);
            for (const std::int32_t corner : surface.corners().at(v)) near.push_back(corner / 3);
        });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    std::erase_if(near, [&](std::int32_t t) {
        for (int c = 0; c < 3; ++c)
            if (!within.contains(body.triangles(t, c))) return true;
        return false;
    });
    std::vector<std::int32_t> disc;
    for (auto& patch : patches(body, near))
        if (std::binary_search(patch.begin(), patch.end(), seed)) disc = std::move(patch);
    if (disc.size() < kFewestDiscTriangles) {
        const auto nearest = std::min_element(sources.begin(), sources.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
        disc.clear();
        for (const std::int32_t corner : surface.corners().at(nearest->first)) disc.push_back(corner / 3);
    }
    if (!isDisc(body, disc)) return fail("not-a-disc", "The patch closes around a limb or has a hole: choose a smaller radius.");
    return faceOf(body, std::move(disc), true);
}

Result<JointFace> refoundFace(const TriangleMesh& was, const JointFace& face, const TriangleMesh& body) {
    constexpr double kPlaneTolerance = 1e-4;  // of the diagonal, as in a face by plane
    constexpr double kMoved = 0.25;           // of its size: a patch in the plane whose middle lies farther away is another one
    constexpr double kAway = 0.5;             // of its size: triangles farther from the face are none of it
    constexpr double kAreas = 4.0;            // a patch so many times as large or small is another one
    const Vec3 origin = face.frame.origin, z = face.frame.axes.col(2);
    const auto alike = [&](const JointFace& found) { return found.area <= kAreas * face.area && face.area <= kAreas * found.area; };
    if (face.flat()) {
        const double diagonal = (body.vertices.colwise().maxCoeff() - body.vertices.colwise().minCoeff()).norm();
        if (auto found = jointFaceByPlane(body, origin, z, kPlaneTolerance * diagonal); found && alike(*found) && (found->frame.origin - origin).norm() <= kMoved * face.size) return found;
    }
    const TriangleTree tree(was);
    std::vector<std::int32_t> chosen;
    for (std::int32_t t = 0; t < body.triangles.rows(); ++t) {
        Vec3 middle = Vec3::Zero();
        for (int c = 0; c < 3; ++c) middle += body.vertices.row(body.triangles(t, c)).transpose() / 3.0;
        if (!((middle - origin).norm() <= (1.0 + kAway) * face.size)) continue;
        const auto hit = tree.nearest(middle);
        if (hit.triangle >= 0 && std::binary_search(face.triangles.begin(), face.triangles.end(), hit.triangle) && hit.squaredDistance <= kAway * kAway * face.size * face.size &&
            areaVector(body, t).dot(areaVector(was, hit.triangle)) > 0.0)
            chosen.push_back(t);
    }
    auto found = patches(body, chosen);
    const auto largest = std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (largest != found.end())
        if (auto made = faceOf(body, std::move(*largest), !face.flat()); made && alike(*made)) return made;
    return fail("face-lost", "Nothing of about its size lies where it was.");
}

int overlappingFace(std::span<const JointFace> faces, const JointFace& face) {
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const auto& other = faces[i].vertices;
        std::size_t a = 0, b = 0;  // both ascend
        while (a < other.size() && b < face.vertices.size()) {
            if (other[a] == face.vertices[b]) return static_cast<int>(i);
            ++(other[a] < face.vertices[b] ? a : b);
        }
    }
    return -1;
}

}  // namespace imomushi
