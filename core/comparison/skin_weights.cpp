// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/skin_weights.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/clock.h"
#include "core/base/finite.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/mesh/winding_number.h"

namespace imomushi {

namespace {

/// Length of a ramp in diameters of the body at the joint: shorter ramps pinch in a bend, longer ones bend much of the limb.
constexpr double kRampDiameters = 1.12;
/// This part of a ramp at each end is rounded, so that weights have no kink.
constexpr double kRounded = 0.1;
/// Factor of H. Baran and Popovic have 1 and name .22, where the heat on the surface spreads as it would in the volume; with .3 the skins of a bent
/// cylinder lose as much volume as with the automatic weights of Blender, or a little less (tests/bench/deformers.cpp).
constexpr double kHeat = 0.3;
/// Bones whose distance is within this of the nearest one, relative, get the same heat.
constexpr double kSameDistance = 1e-4;
/// A line of sight keeps this far from the surface, relative to its length, but for its ends, and meets the surface at this slope.
constexpr double kSight = 1e-3, kSightStart = 0.05, kGrazing = 0.05;
/// Of the sum of weights that a vertex outside all ramps would have.
constexpr double kMinSum = 1e-12;
constexpr double kResidual = 1e-6;
/// Cotangents of angles below a tenth of a degree would swamp all others.
constexpr double kMaxCotangent = 573.0;

Vec3 nearestOnBone(const Skeleton& skeleton, int b, const Vec3& p) {
    const Vec3 &from = skeleton.points[skeleton.bones[b].start], &to = skeleton.points[skeleton.bones[b].end];
    const Vec3 along = to - from;
    return from + std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
}

Result<void> check(const WeldedSurface& body, const Skeleton& skeleton) {
    if (body.vertices.rows() == 0) return fail("too-small", "There is no surface to cover: import an element first.");
    if (skeleton.bones.empty()) return fail("no-bone", "There is no bone for the skin to follow: add bones first.");
    if (!allFinite(body.vertices)) return fail("bad-value", "A vertex is not a number: repair the mesh.");
    for (const auto& b : skeleton.bones)
        if (!allFinite(skeleton.points[b.start]) || !allFinite(skeleton.points[b.end]) || !((skeleton.points[b.end] - skeleton.points[b.start]).norm() > 0.0))
            return fail("bad-value", "A bone has no length: place its ends apart.");
    return {};
}

/// The largest of the weights of a vertex.
void keepMost(std::vector<std::pair<double, int>>& all, SkinWeights::Vertex& vertex, double& dropped) {
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
    const std::size_t kept = std::min<std::size_t>(all.size(), SkinWeights::kMax);
    double total = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        total += all[i].first;
        if (i < kept) sum += all[i].first;
    }
    dropped = std::max(dropped, 1.0 - sum / total);
    for (std::size_t i = 0; i < SkinWeights::kMax; ++i) {
        vertex.bone[i] = i < kept ? all[i].second : all[0].second;
        vertex.weight[i] = i < kept ? static_cast<float>(all[i].first / sum) : 0.0f;
    }
}

/// Copies weights to the vertices inside joints, from the nearest vertex that is seen.
void spread(const WeldedSurface& body, SkinWeights& weights) {
    for (std::size_t v = 0; v < weights.vertices.size(); ++v) weights.vertices[v] = weights.vertices[static_cast<std::size_t>(body.weightOf[v])];
}

/// From 0 at 0 to 1 at 1: a straight ramp with rounded ends, which is less steep than a cubic one.
double roundedRamp(double x) {
    if (x > 0.5) return 1.0 - roundedRamp(1.0 - x);
    if (x <= 0.0) return 0.0;
    return x < kRounded ? x * x / (2.0 * kRounded * (1.0 - kRounded)) : (x - 0.5 * kRounded) / (1.0 - kRounded);
}

/// Whether nothing lies between a place inside the body and a vertex with that normal: spheres that touch the surface are followed along the line.
bool sees(const TriangleTree& surface, const Vec3& from, const Vec3& vertex, const Vec3& normal) {
    const Vec3 line = vertex - from;
    const double length = line.norm();
    if (!(length > 0.0)) return false;
    const double slope = line.dot(normal) / length;
    if (slope < kGrazing) return false;  // from outside, or along the surface
    for (double at = 0.0; at < (1.0 - kSight) * length;) {
        const double free = std::sqrt(surface.nearest(from + at / length * line).squaredDistance);
        // At the end the surface comes nearer as the vertex does; at the start a bone may end on it.
        const double close = std::min(kSight * length, 0.1 * slope * (length - at));
        if (at > kSightStart * length && free < close) return false;
        at += std::max(free, 2.0 * close);
    }
    return true;
}

}  // namespace

Result<SkinWeights> rampWeights(const WeldedSurface& body, const Skeleton& skeleton, double length) {
    if (auto ok = check(body, skeleton); !ok) return tl::unexpected(ok.error());
    if (!std::isfinite(length) || length < 0.0) return fail("bad-value", "The length of a ramp is negative: choose 0 or more metres.");
    const auto start = Clock::now();
    const int bones = static_cast<int>(skeleton.bones.size());
    std::vector<double> ramp(skeleton.points.size(), length);
    if (length == 0.0)
        for (std::size_t p = 0; p < ramp.size(); ++p) {
            double nearest = std::numeric_limits<double>::infinity();
            for (Eigen::Index t = 0; t < body.triangles.size(); ++t)
                nearest = std::min(nearest, (body.vertices.row(body.triangles.data()[t]).transpose() - skeleton.points[p]).norm());
            ramp[p] = 2.0 * kRampDiameters * nearest;
        }
    const auto away = [&](int b, int point) -> Vec3 {
        const auto& bone = skeleton.bones[b];
        const Vec3 d = skeleton.points[bone.end] - skeleton.points[bone.start];
        return (bone.start == point ? d : Vec3(-d)).normalized();
    };
    struct Meeting {
        int other, point;
        Vec3 normal;  // towards the bone itself
    };
    std::vector<std::vector<Meeting>> meetings(skeleton.bones.size());
    for (int b = 0; b < bones; ++b)
        for (const int point : {skeleton.bones[b].start, skeleton.bones[b].end})
            for (int c = 0; c < bones; ++c) {
                if (c == b || (skeleton.bones[c].start != point && skeleton.bones[c].end != point)) continue;
                const Vec3 normal = away(b, point) - away(c, point);
                if (normal.norm() > 1e-6) meetings[b].push_back({c, point, normal.normalized()});
            }
    SkinWeights out;
    out.vertices.resize(static_cast<std::size_t>(body.vertices.rows()));
    std::vector<std::pair<double, int>> all;
    for (std::size_t v = 0; v < out.vertices.size(); ++v) {
        if (body.weightOf[v] != static_cast<std::int32_t>(v)) continue;
        const Vec3 p = body.vertices.row(static_cast<Eigen::Index>(v)).transpose();
        int nearest = 0;
        double distance = std::numeric_limits<double>::infinity();
        for (int b = 0; b < bones; ++b) {
            const double d = (nearestOnBone(skeleton, b, p) - p).norm();
            if (d < distance) distance = d, nearest = b;
        }
        const auto belongs = [&](int b) {
            double part = 1.0;
            for (const auto& m : meetings[b]) {
                const double s = (p - skeleton.points[m.point]).dot(m.normal);
                part *= ramp[m.point] > 0.0 ? roundedRamp(0.5 + s / ramp[m.point]) : s >= 0.0 ? 1.0 : 0.0;
            }
            return part;
        };
        all.clear();
        double sum = 0.0;
        const auto add = [&](int b) {
            if (std::any_of(all.begin(), all.end(), [b](const auto& w) { return w.second == b; })) return;
            all.emplace_back(belongs(b), b);
            sum += all.back().first;
        };
        add(nearest);
        for (const auto& m : meetings[nearest]) add(m.other);
        if (sum < kMinSum) all = {{1.0, nearest}};
        keepMost(all, out.vertices[v], out.dropped);
    }
    spread(body, out);
    out.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return out;
}

Result<SkinWeights> automaticWeights(const WeldedSurface& body, const Skeleton& skeleton, const Progress& progress) {
    if (auto ok = check(body, skeleton); !ok) return tl::unexpected(ok.error());
    const auto cancelled = [] { return fail(kCancelled, "The skin was cancelled."); };
    const auto start = Clock::now();
    const int bones = static_cast<int>(skeleton.bones.size());
    const auto& triangles = body.triangles;

    // Only vertices of the surface are unknown.
    std::vector<std::int32_t> unknown(static_cast<std::size_t>(body.vertices.rows()), -1), vertexOf;
    for (Eigen::Index i = 0; i < triangles.size(); ++i) unknown[triangles.data()[i]] = 0;
    for (std::size_t v = 0; v < unknown.size(); ++v)
        if (unknown[v] == 0) {
            unknown[v] = static_cast<std::int32_t>(vertexOf.size());
            vertexOf.push_back(static_cast<std::int32_t>(v));
        }
    const auto n = static_cast<Eigen::Index>(vertexOf.size());
    if (n == 0) return fail("too-small", "There is no surface to cover: import an element first.");
    const TriangleMesh mesh{body.vertices, triangles};
    const Points normals = vertexNormals(mesh);
    const TriangleTree surface(mesh);

    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd area = Eigen::VectorXd::Zero(n), heat = Eigen::VectorXd::Zero(n);
    for (Eigen::Index t = 0; t < triangles.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const auto i = unknown[triangles(t, c)], j = unknown[triangles(t, (c + 1) % 3)], k = unknown[triangles(t, (c + 2) % 3)];
            const Vec3 a = body.vertices.row(triangles(t, c)).transpose(), b = body.vertices.row(triangles(t, (c + 1) % 3)).transpose(),
                       o = body.vertices.row(triangles(t, (c + 2) % 3)).transpose();
            const double cross = (a - o).cross(b - o).norm();
            area[k] += cross / 6.0;
            if (i == j || !(cross > 0.0)) continue;
            // Not below zero: the matrix stays one of positive weights on slivers too.
            const double w = 0.5 * std::clamp((a - o).dot(b - o) / cross, 0.0, kMaxCotangent);
            entries.emplace_back(i, i, w);
            entries.emplace_back(j, j, w);
            entries.emplace_back(i, j, -w);
            entries.emplace_back(j, i, -w);
        }
    SkinWeights out;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, bones);
    std::vector<int> warmBones;  // a bone beside the body heats nothing
    for (int b = 0; b < bones; ++b)
        if (std::abs(windingNumber(mesh, 0.5 * (skeleton.points[skeleton.bones[b].start] + skeleton.points[skeleton.bones[b].end]))) > 0.5) warmBones.push_back(b);
    std::vector<std::pair<double, int>> near(warmBones.size());
    for (Eigen::Index i = 0; i < n; ++i) {
        if (i % 256 == 0 && progress.cancelled()) return cancelled();
        const Vec3 p = body.vertices.row(vertexOf[i]).transpose(), normal = normals.row(vertexOf[i]).transpose();
        for (std::size_t k = 0; k < near.size(); ++k) near[k] = {(nearestOnBone(skeleton, warmBones[k], p) - p).norm(), warmBones[k]};
        std::sort(near.begin(), near.end());
        double nearest = -1.0;
        std::vector<int> seen;
        for (const auto& [distance, b] : near) {
            if (nearest >= 0.0 && distance > nearest * (1.0 + kSameDistance)) break;
            const Vec3 q = nearestOnBone(skeleton, b, p);
            if (!sees(surface, q, p, normal)) continue;
            if (nearest < 0.0) nearest = distance;
            seen.push_back(b);
        }
        if (seen.empty()) {
            ++out.unseen;
            continue;
        }
        heat[i] = kHeat * static_cast<double>(seen.size()) / (nearest * nearest);
        for (const int b : seen) right(i, b) = heat[i] * area[i] / static_cast<double>(seen.size());
    }
    // Every part of the surface needs a vertex that is heated, or nothing says which bone it follows.
    int parts = 0;
    const EdgeTable edges(triangles);
    const auto part = edgeComponents(triangles, edges, parts);
    std::vector<char> warm(static_cast<std::size_t>(parts), 0);
    for (Eigen::Index t = 0; t < triangles.rows(); ++t)
        for (int c = 0; c < 3; ++c) warm[part[t]] = static_cast<char>(warm[part[t]] | (heat[unknown[triangles(t, c)]] > 0.0));
    if (std::find(warm.begin(), warm.end(), 0) != warm.end())
        return fail("no-heat", "A part of the surface sees no bone from inside: let bones run through it, or use ramp weights.");

    for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(i, i, std::max(heat[i] * area[i], std::numeric_limits<double>::min()));
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
    if (progress.cancelled()) return cancelled();
    if (factor.info() != Eigen::Success) return fail("not-solved", "The heat of bones was not found: repair triangles without area, or use ramp weights.");
    const Eigen::MatrixXd solution = factor.solve(right);
    out.residual = (matrix * solution - right).norm() / right.norm();
    if (!allFinite(solution) || !(out.residual < kResidual))
        return fail("not-solved", "The heat of bones was not found: repair triangles without area, or use ramp weights.");

    out.vertices.resize(static_cast<std::size_t>(body.vertices.rows()));
    std::vector<std::pair<double, int>> all;
    for (Eigen::Index i = 0; i < n; ++i) {
        all.clear();
        for (int b = 0; b < bones; ++b)
            if (solution(i, b) > 1e-6) all.emplace_back(solution(i, b), b);  // rounding
        if (all.empty()) all.emplace_back(1.0, 0);
        keepMost(all, out.vertices[static_cast<std::size_t>(vertexOf[i])], out.dropped);
    }
    spread(body, out);
    out.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return out;
}

}  // namespace imomushi
