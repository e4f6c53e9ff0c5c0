// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "core/body/cut.h"
#include "core/joints/joint_face.h"
#include "core/mesh/bounds.h"
#include "core/mesh/health.h"
#include "core/mesh/topology.h"

namespace imomushi {

inline double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

inline bool sameBytes(const BodyPiece& a, const BodyPiece& b) {
    return a.body.vertices.rows() == b.body.vertices.rows() && a.body.triangles.rows() == b.body.triangles.rows() && a.body.vertices == b.body.vertices &&
           a.body.triangles == b.body.triangles && a.source == b.source && a.sourceTriangle == b.sourceTriangle;
}

/// What every accepted set of cuts must keep, and the smallest angle of its caps in degrees.
inline double checkPieces(const TriangleMesh& body, std::span<const CutPlane> cuts, const std::vector<BodyPiece>& pieces) {
    const double size = diagonalOf(body.vertices), whole = enclosedVolume(body.vertices, body.triangles);
    std::vector<double> shortest(static_cast<std::size_t>(body.vertices.rows()), HUGE_VAL);  // edge at each vertex
    bool degenerateBefore = false;
    for (std::int32_t f = 0; f < body.triangles.rows(); ++f) {
        degenerateBefore = degenerateBefore || degenerate(body, f);
        for (int k = 0; k < 3; ++k) {
            const std::int32_t a = body.triangles(f, k), b = body.triangles(f, (k + 1) % 3);
            const double length = (body.vertices.row(a) - body.vertices.row(b)).norm();
            for (const std::int32_t v : {a, b}) shortest[static_cast<std::size_t>(v)] = std::min(shortest[static_cast<std::size_t>(v)], length);
        }
    }
    double volume = 0.0, smallest = 180.0;
    std::map<std::pair<int, bool>, std::pair<const BodyPiece*, const BodyPiece::Cap*>> caps;
    for (const BodyPiece& piece : pieces) {
        const MeshFacts facts = meshFacts(piece.body);
        CHECK(facts.outward);
        volume += enclosedVolume(piece.body.vertices, piece.body.triangles);
        REQUIRE(piece.source.size() == static_cast<std::size_t>(piece.body.vertices.rows()));
        REQUIRE(piece.sourceTriangle.size() == static_cast<std::size_t>(piece.body.triangles.rows()));
        double moved = 0.0;  // in edges
        for (std::size_t v = 0; v < piece.source.size(); ++v)
            if (const std::int32_t from = piece.source[v]; from >= 0)
                moved = std::max(
                    moved, (piece.body.vertices.row(static_cast<Eigen::Index>(v)) - body.vertices.row(from)).norm() / shortest[static_cast<std::size_t>(from)]);
        CHECK(moved <= 2.5 * kSnap * (1.0 + 1e-9));
        if (!degenerateBefore)
            for (std::int32_t f = 0; f < piece.body.triangles.rows(); ++f)
                if (degenerate(piece.body, f)) FAIL_CHECK("triangle " << f << " on " << piece.sourceTriangle[static_cast<std::size_t>(f)] << " is flat");
        for (const BodyPiece::Cap& cap : piece.caps) {
            CHECK(caps.insert({{cap.cut, cap.front}, {&piece, &cap}}).second);
            smallest = std::min(smallest, degrees(cap.smallestAngle));
        }
    }
    CHECK(std::abs(volume - whole) <= 1e-9 * whole);
    REQUIRE(caps.size() == 2 * cuts.size());
    for (int c = 0; c < static_cast<int>(cuts.size()); ++c) {
        const auto [front, frontCap] = caps.at({c, true});
        const auto [back, backCap] = caps.at({c, false});
        const Vec3 n = cuts[static_cast<std::size_t>(c)].normal.stableNormalized(), o = cuts[static_cast<std::size_t>(c)].origin;
        REQUIRE(frontCap->vertices.size() == backCap->vertices.size());
        REQUIRE(frontCap->triangles.size() == backCap->triangles.size());
        double gap = 0.0, bulge = 0.0;
        for (std::size_t i = 0; i < frontCap->vertices.size(); ++i) {
            gap = std::max(gap, (front->body.vertices.row(frontCap->vertices[i]) - back->body.vertices.row(backCap->vertices[i])).norm());
            bulge = std::max(bulge, std::abs(n.dot(front->body.vertices.row(frontCap->vertices[i]).transpose() - o)));
        }
        CHECK(gap == 0.0);
        CHECK(bulge <= 1e-10 * size);
        for (const auto& [piece, cap, outward] : {std::tuple(front, frontCap, Vec3(-n)), std::tuple(back, backCap, n)}) {
            const auto face = jointFaceByVertices(piece->body, cap->vertices);
            REQUIRE(face.has_value());
            CHECK(face->frame.axes.col(2).dot(outward) > 1.0 - 1e-9);
            for (const std::int32_t t : cap->triangles) CHECK(piece->sourceTriangle[static_cast<std::size_t>(t)] == -1);
        }
    }
    return smallest;
}

}  // namespace imomushi
