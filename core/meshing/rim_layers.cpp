// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/rim_layers.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/mesh/solid_angle.h"
#include "core/mesh/topology.h"
#include "core/meshing/mesh_pieces.h"

namespace imomushi {
namespace {

/// Height over longest side below which a triangle is not cut any further: the thinnest of three strips is 27 times as thin, and triangles beyond
/// 1:1000 or so make the equations ill-conditioned without being needed.
constexpr double kThin = 0.01;

/// How the distance of the strips from the edge grows.
constexpr double kExponent = 3.0;

using EdgeKey = std::array<std::int32_t, 2>;
EdgeKey keyOf(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

bool thin(const TriangleMesh& mesh, std::int32_t t) {
    double longest = 0.0;
    for (int c = 0; c < 3; ++c)
        longest = std::max(longest, (mesh.vertices.row(mesh.triangles(t, c)) - mesh.vertices.row(mesh.triangles(t, (c + 1) % 3))).squaredNorm());
    return areaVector(mesh, t).norm() < (1.0 - kTie) * kThin * longest;
}

/// Ascending.
std::vector<EdgeKey> singularEdges(const SolverMesh& mesh, const std::vector<std::int32_t>& face) {
    std::vector<EdgeKey> out;
    const EdgeTable edges(mesh.mesh.triangles);
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() != 2) continue;
        const std::int32_t s = uses[0].triangle, t = uses[1].triangle;
        const std::int32_t sFace = face[static_cast<std::size_t>(s)], tFace = face[static_cast<std::size_t>(t)];
        if (sFace == tFace && sFace >= 0) continue;
        if (thin(mesh.mesh, s) || thin(mesh.mesh, t)) continue;
        const double angle = std::numbers::pi - edgeBend(mesh.mesh, uses);
        if (angle > (sFace != tFace ? kMixedAngle : kReentrantAngle) + kTie) out.push_back({uses[0].low, uses[0].high});
    }
    return out;
}

/// Cuts triangles until each has at most two corners on singular edges, and two only at the ends of one such edge.
void separate(MeshPieces& pieces, const std::vector<EdgeKey>& singular, const std::vector<char>& onSingular) {
    const auto on = [&](std::int32_t v) { return static_cast<std::size_t>(v) < onSingular.size() && onSingular[static_cast<std::size_t>(v)]; };
    const auto isSingular = [&](std::int32_t a, std::int32_t b) { return std::binary_search(singular.begin(), singular.end(), keyOf(a, b)); };
    // Triangles all whose sides are singular first: their sides cannot be halved.
    std::vector<std::array<std::int32_t, 3>> corners;
    std::vector<std::int32_t> face;
    corners.swap(pieces.corners);
    face.swap(pieces.face);
    for (std::size_t t = 0; t < corners.size(); ++t) {
        const auto [a, b, c] = corners[t];
        if (isSingular(a, b) && isSingular(b, c) && isSingular(c, a)) {
            const std::int32_t middle = pieces.add({a, b, c}, {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0});
            pieces.triangle(a, b, middle, face[t]);
            pieces.triangle(b, c, middle, face[t]);
            pieces.triangle(c, a, middle, face[t]);
        } else {
            pieces.triangle(a, b, c, face[t]);
        }
    }
    // Then halve every other side between two of those corners.
    const EdgeTable edges(pieces.table());
    std::vector<std::int32_t> middle(static_cast<std::size_t>(edges.size()), -1);
    for (int e = 0; e < edges.size(); ++e) {
        const EdgeUse& use = edges.uses(e)[0];
        if (on(use.low) && on(use.high) && !isSingular(use.low, use.high))
            middle[static_cast<std::size_t>(e)] = pieces.add({use.low, use.high, use.low}, {0.5, 0.5, 0.0});
    }
    corners.clear();
    face.clear();
    corners.swap(pieces.corners);
    face.swap(pieces.face);
    for (std::size_t t = 0; t < corners.size(); ++t) {
        std::array<std::int32_t, 3> m{};
        for (std::size_t c = 0; c < 3; ++c) m[c] = middle[static_cast<std::size_t>(edges.edgeOf(static_cast<std::int32_t>(t), static_cast<int>(c)))];
        pieces.halved(corners[t], m, face[t]);
    }
}

}  // namespace

SolverMesh withLayers(const SolverMesh& mesh, int layers) {
    assert(layers >= 1 && layers <= 8);
    MeshPieces pieces(mesh);
    const std::vector<EdgeKey> singular = singularEdges(mesh, pieces.face);
    if (layers == 1 || singular.empty()) return mesh;
    std::vector<char> onSingular(pieces.points.size());
    for (const EdgeKey& e : singular) onSingular[static_cast<std::size_t>(e[0])] = onSingular[static_cast<std::size_t>(e[1])] = 1;
    separate(pieces, singular, onSingular);

    // Every side from a singular edge outwards is cut at the same shares of its length, so that strips of neighbours meet.
    const EdgeTable edges(pieces.table());
    onSingular.resize(pieces.points.size());
    std::vector<std::int32_t> firstCut(static_cast<std::size_t>(edges.size()), -1);
    for (int e = 0; e < edges.size(); ++e) {
        const EdgeUse& use = edges.uses(e)[0];
        if (onSingular[static_cast<std::size_t>(use.low)] == onSingular[static_cast<std::size_t>(use.high)]) continue;
        const bool outwards = onSingular[static_cast<std::size_t>(use.low)] != 0;
        const std::int32_t from = outwards ? use.low : use.high, to = outwards ? use.high : use.low;
        for (int i = 1; i < layers; ++i) {
            const double share = std::pow(static_cast<double>(i) / layers, kExponent);
            const std::int32_t v = pieces.add({from, to, from}, {1.0 - share, share, 0.0});
            if (i == 1) firstCut[static_cast<std::size_t>(e)] = v;
        }
    }
    std::vector<std::array<std::int32_t, 3>> corners;
    std::vector<std::int32_t> face;
    corners.swap(pieces.corners);
    face.swap(pieces.face);
    for (std::size_t t = 0; t < corners.size(); ++t) {
        const auto& k = corners[t];
        const auto on = [&](std::size_t c) { return onSingular[static_cast<std::size_t>(k[c % 3])] != 0; };
        const auto cutOf = [&](std::size_t side) { return firstCut[static_cast<std::size_t>(edges.edgeOf(static_cast<std::int32_t>(t), static_cast<int>(side % 3)))]; };
        const int count = on(0) + on(1) + on(2);
        std::size_t c = 0;
        if (count == 1) {  // strips around a corner
            while (!on(c)) ++c;
            const std::int32_t left = cutOf(c), right = cutOf(c + 2);
            pieces.triangle(k[c], left, right, face[t]);
            for (int i = 1; i < layers - 1; ++i) pieces.quad(left + i - 1, left + i, right + i, right + i - 1, face[t]);
            pieces.quad(left + layers - 2, k[(c + 1) % 3], k[(c + 2) % 3], right + layers - 2, face[t]);
        } else if (count == 2) {  // strips along a side
            while (on(c)) ++c;
            const std::int32_t left = cutOf(c), right = cutOf(c + 2);  // on the sides from the free corner to the next and from the one before
            pieces.quad(k[(c + 1) % 3], k[(c + 2) % 3], right, left, face[t]);
            for (int i = 1; i < layers - 1; ++i) pieces.quad(left + i - 1, right + i - 1, right + i, left + i, face[t]);
            pieces.triangle(left + layers - 2, right + layers - 2, k[c], face[t]);
        } else {
            pieces.triangle(k[0], k[1], k[2], face[t]);
        }
    }

    return pieces.joined(mesh.faces.size());
}

}  // namespace imomushi
