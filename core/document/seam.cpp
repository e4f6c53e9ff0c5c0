// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/seam.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

namespace imomushi {

namespace {

Vec3 row(const Points& points, std::int32_t i) { return points.row(i).transpose(); }

double weldDistance(const FaceOnBody& a, const FaceOnBody& b) { return kWeldDistance * std::max(a.face->size, b.face->size); }

/// Barycentric weights of the point of triangle (a, b, c) that is nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
Vec3 nearestWeights(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    const Vec3 bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        const double t = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
        return {1 - t, t, 0};
    }
    const Vec3 cp = p - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        const double t = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
        return {1 - t, 0, t};
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const double length = (d4 - d3) + (d5 - d6);
        const double t = length > 0 ? (d4 - d3) / length : 0;
        return {0, 1 - t, t};
    }
    const double sum = va + vb + vc;
    return {va / sum, vb / sum, vc / sum};
}

void addSeamPoints(const FaceOnBody& from, const FaceOnBody& to, bool ofFirst,
                   const std::unordered_map<std::int32_t, std::int32_t>& welded, std::vector<SeamPoint>& seam) {
    std::unordered_map<std::int32_t, std::int32_t> triangleAt;
    for (const std::int32_t t : to.face->triangles)
        for (int k = 0; k < 3; ++k) triangleAt.emplace(to.body->triangles(t, k), t);
    const double besideLimit = 10 * weldDistance(from, to);
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
            point.distance = std::numeric_limits<double>::max();
            Vec3 nearest = p;
            for (const std::int32_t t : to.face->triangles) {
                const Vec3 a = row(to.body->vertices, to.body->triangles(t, 0));
                const Vec3 b = row(to.body->vertices, to.body->triangles(t, 1));
                const Vec3 c = row(to.body->vertices, to.body->triangles(t, 2));
                const Vec3 w = nearestWeights(p, a, b, c);
                const Vec3 q = w[0] * a + w[1] * b + w[2] * c;
                const double distance = (p - q).norm();
                if (distance < point.distance) {
                    point.distance = distance;
                    point.triangle = t;
                    point.weights = w;
                    nearest = q;
                }
            }
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
    double crease = 0.0;
    for (const std::int32_t v : faceA.face->vertices) {
        const auto normalA = normalsA.find(v);
        if (normalA == normalsA.end()) continue;
        const Vec3 p = row(faceA.body->vertices, v);
        double best = std::numeric_limits<double>::max();
        const Vec3* normal = nullptr;
        for (const std::int32_t w : faceB.face->vertices) {
            const auto normalB = normalsB.find(w);
            if (normalB == normalsB.end()) continue;
            const double distance = (row(faceB.body->vertices, w) - p).squaredNorm();
            if (distance < best) {
                best = distance;
                normal = &normalB->second;
            }
        }
        if (normal) crease = std::max(crease, std::atan2(normalA->second.cross(*normal).norm(), normalA->second.dot(*normal)));
    }
    return crease;
}

double windingNumber(const TriangleMesh& body, const Vec3& point) {
    double solid = 0.0;
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        const Vec3 a = row(body.vertices, body.triangles(t, 0)) - point;
        const Vec3 b = row(body.vertices, body.triangles(t, 1)) - point;
        const Vec3 c = row(body.vertices, body.triangles(t, 2)) - point;
        const double la = a.norm(), lb = b.norm(), lc = c.norm();
        const double determinant = a.dot(b.cross(c));
        const double rest = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        if (determinant != 0.0 || rest != 0.0) solid += 2.0 * std::atan2(determinant, rest);  // van Oosterom & Strackee 1983
    }
    return solid / (4.0 * std::numbers::pi);
}

}  // namespace imomushi
