// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/joints/seam.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "core/mesh/closest_point.h"
#include "core/mesh/triangle_tree.h"

namespace imomushi {

namespace {

/// Of distances between points, relative to their coordinates; many times as much.
constexpr double kRounding = 1e-13;

Vec3 row(const Points& points, std::int32_t i) { return points.row(i).transpose(); }

double weldDistance(const FaceOnBody& a, const FaceOnBody& b) { return kWeldDistance * std::max(a.face->size, b.face->size); }

void addSeamPoints(const FaceOnBody& from, const FaceOnBody& to, bool ofFirst,
                   const std::unordered_map<std::int32_t, std::int32_t>& welded, std::vector<SeamPoint>& seam) {
    std::unordered_map<std::int32_t, std::int32_t> triangleAt;
    for (const std::int32_t t : to.face->triangles)
        for (int k = 0; k < 3; ++k) triangleAt.emplace(to.body->triangles(t, k), t);
    const double besideLimit = 10 * weldDistance(from, to);
    if (to.face->triangles.empty()) return;
    std::optional<TriangleTree> tree;  // where all vertices are welded none is needed
    for (const std::int32_t v : from.face->vertices) {
        SeamPoint point;
        point.ofFirst = ofFirst;
        point.vertex = v;
        const Vec3 p = row(from.body->vertices, v);
        if (const auto pair = welded.find(v); pair != welded.end() && triangleAt.contains(pair->second)) {
            point.triangle = triangleAt.at(pair->second);
            for (int k = 0; k < 3; ++k) point.weights[k] = to.body->triangles(point.triangle, k) == pair->second ? 1.0 : 0.0;
            point.distance = (p - row(to.body->vertices, pair->second)).norm();
        } else {
            // Whatever is nearer than some triangle lies within its distance: the tree only leaves out what cannot be nearest.
            point.distance = std::numeric_limits<double>::max();
            Vec3 nearest = p;
            const auto offer = [&](std::int32_t t) {
                const Vec3 a = row(to.body->vertices, to.body->triangles(t, 0));
                const Vec3 b = row(to.body->vertices, to.body->triangles(t, 1));
                const Vec3 c = row(to.body->vertices, to.body->triangles(t, 2));
                const ClosestOnTriangle closest = closestOnTriangle(b - a, c - a, p - a, p - b, p - c);
                const Vec3 w = closest.inside ? Vec3(closest.weights / (closest.weights[0] + closest.weights[1] + closest.weights[2])) : closest.weights;
                const Vec3 q = w[0] * a + w[1] * b + w[2] * c;
                const double distance = (p - q).norm();
                if (distance < point.distance || (distance == point.distance && t < point.triangle)) {
                    point.distance = distance;
                    point.triangle = t;
                    point.weights = w;
                    nearest = q;
                }
            };
            if (!tree) tree.emplace(*to.body, to.face->triangles);
            offer(tree->nearest(p).triangle);
            const double rounding = kRounding * std::max(p.cwiseAbs().maxCoeff(), nearest.cwiseAbs().maxCoeff());
            for (const std::int32_t t : tree->within(p, point.distance + rounding)) offer(t);
            if (point.triangle < 0) continue;
            const Vec3 normal = to.face->frame.axes.col(2);
            const Vec3 offset = p - nearest;
            point.beside = (offset - offset.dot(normal) * normal).norm() > besideLimit;
        }
        seam.push_back(point);
    }
}

/// Unit normal of the surface at a vertex without the triangles of the face; zero where nothing else meets there.
std::unordered_map<std::int32_t, Vec3> rimNormals(const FaceOnBody& face, const Points& positions) {
    const auto& triangles = face.body->triangles;
    std::unordered_map<std::int32_t, Vec3> normals;
    const auto held = [&](std::int32_t v) { return std::binary_search(face.face->vertices.begin(), face.face->vertices.end(), v); };
    for (std::int32_t t = 0; t < triangles.rows(); ++t) {
        if (std::binary_search(face.face->triangles.begin(), face.face->triangles.end(), t)) continue;
        if (!held(triangles(t, 0)) && !held(triangles(t, 1)) && !held(triangles(t, 2))) continue;
        const Vec3 a = row(positions, triangles(t, 0)), b = row(positions, triangles(t, 1)), c = row(positions, triangles(t, 2));
        const Vec3 normal = (b - a).cross(c - a);  // weighted by area
        for (int k = 0; k < 3; ++k)
            if (held(triangles(t, k))) normals.try_emplace(triangles(t, k), Vec3::Zero()).first->second += normal;
    }
    for (auto& [v, n] : normals)
        if (const double length = n.norm(); length > 0) n /= length;
    return normals;
}

}  // namespace

std::vector<std::pair<std::int32_t, std::int32_t>> weldedVertices(const FaceOnBody& a, const FaceOnBody& b) {
    const double limit = weldDistance(a, b);
    // Along an axis in the plane of the face few vertices share a coordinate, so the window below is short.
    const Vec3 axis = b.face->frame.axes.col(0) + 0.618 * b.face->frame.axes.col(1);
    std::vector<std::pair<double, std::int32_t>> sorted;
    for (const std::int32_t v : b.face->vertices) sorted.emplace_back(axis.dot(row(b.body->vertices, v)), v);
    std::sort(sorted.begin(), sorted.end());
    std::vector<bool> taken(sorted.size(), false);
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    for (const std::int32_t v : a.face->vertices) {
        const Vec3 p = row(a.body->vertices, v);
        const double along = axis.dot(p);
        auto at = std::lower_bound(sorted.begin(), sorted.end(), std::pair(along - 2 * limit, std::int32_t{-1}));
        double best = limit;
        auto nearest = sorted.end();
        for (; at != sorted.end() && at->first <= along + 2 * limit; ++at) {
            const double distance = (row(b.body->vertices, at->second) - p).norm();
            if (distance <= best && !taken[static_cast<std::size_t>(at - sorted.begin())]) {
                best = distance;
                nearest = at;
            }
        }
        if (nearest == sorted.end()) continue;
        taken[static_cast<std::size_t>(nearest - sorted.begin())] = true;
        pairs.emplace_back(v, nearest->second);
    }
    return pairs;
}

std::vector<SeamPoint> seamPoints(const FaceOnBody& a, const FaceOnBody& b) {
    std::unordered_map<std::int32_t, std::int32_t> toB, toA;
    for (const auto& [p, q] : weldedVertices(a, b)) {
        toB.emplace(p, q);
        toA.emplace(q, p);
    }
    std::vector<SeamPoint> seam;
    addSeamPoints(a, b, true, toB, seam);
    addSeamPoints(b, a, false, toA, seam);
    return seam;
}

double seamGap(const std::vector<SeamPoint>& seam, const TriangleMesh& bodyA, const Points& a, const TriangleMesh& bodyB,
               const Points& b) {
    double gap = 0.0;
    for (const SeamPoint& s : seam) {
        if (s.beside) continue;
        const Points& own = s.ofFirst ? a : b;
        const Points& other = s.ofFirst ? b : a;
        const Triangles& triangles = (s.ofFirst ? bodyB : bodyA).triangles;
        Vec3 q = Vec3::Zero();
        for (int k = 0; k < 3; ++k) q += s.weights[k] * row(other, triangles(s.triangle, k));
        gap = std::max(gap, (row(own, s.vertex) - q).norm());
    }
    return gap;
}

double seamCrease(const FaceOnBody& faceA, const Points& a, const FaceOnBody& faceB, const Points& b) {
    const auto normalsA = rimNormals(faceA, a);
    const auto normalsB = rimNormals(faceB, b);
    struct RimVertex {
        Vec3 place;
        const Vec3* normal;
    };
    std::vector<RimVertex> rimB;
    for (const std::int32_t w : faceB.face->vertices)
        if (const auto found = normalsB.find(w); found != normalsB.end()) rimB.push_back({row(faceB.body->vertices, w), &found->second});
    double crease = 0.0;
    for (const std::int32_t v : faceA.face->vertices) {
        const auto normalA = normalsA.find(v);
        if (normalA == normalsA.end()) continue;
        const Vec3 p = row(faceA.body->vertices, v);
        double best = std::numeric_limits<double>::max();
        const Vec3* normal = nullptr;
        for (const RimVertex& w : rimB) {
            const double distance = (w.place - p).squaredNorm();
            if (distance < best) {
                best = distance;
                normal = w.normal;
            }
        }
        if (normal) crease = std::max(crease, std::atan2(normalA->second.cross(*normal).norm(), normalA->second.dot(*normal)));
    }
    return crease;
}

}  // namespace imomushi
