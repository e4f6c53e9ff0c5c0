// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/disc_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/mesh/surface_distance.h"
#include "core/mesh/topology.h"
#include "core/meshing/mesh_pieces.h"

namespace imomushi {
namespace {

using Index = std::int32_t;

/// Distances are known to this many radii, and triangles are as small as at the outline to so many; beyond, edges may grow by kGrowth of the distance.
constexpr double kKnown = 3.0, kFine = 1.2, kGrowth = 0.5;
/// Two outlines, or an outline and another face, keep this many radii apart: some triangles.
constexpr double kApart = 1.2;
/// A face that reaches farther than this many radii is what a coarse mesh has instead of a disc.
constexpr double kBeyond = 1.05;
/// Where an outline crosses an edge nearer to an end than this part of it, it goes through the end: no slivers.
constexpr double kSnap = 0.15;

/// Distance along the surface of every vertex from a point of it, infinite beyond `reach`.
std::vector<double> distancesFrom(const TriangleMesh& mesh, const Vec3& point, double reach) {
    std::vector<double> out(static_cast<std::size_t>(mesh.vertices.rows()), SurfaceDistance::kFar);
    const SurfacePoint place = nearestOnSurface(mesh, point);
    std::vector<SurfaceSource> sources;
    for (int c = 0; c < 3; ++c) {
        const Index v = mesh.triangles(place.triangle, c);
        sources.emplace_back(v, (mesh.vertices.row(v).transpose() - place.point).norm());
    }
    SurfaceDistance(mesh).spread(
        sources, reach, [](Index, double) { return true; }, [&](Index v, double d) { out[static_cast<std::size_t>(v)] = d; });
    return out;
}

std::vector<Index> labelsOf(const TriangleMesh& body, std::span<const JointFace> faces, const std::vector<char>& exact) {
    std::vector<Index> out(static_cast<std::size_t>(body.triangles.rows()), -1);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const Index t : faces[f].triangles)
            if (!exact[f]) out[static_cast<std::size_t>(t)] = static_cast<Index>(f);
    return out;
}

/// Which discs can be met: those whose triangles lie in them and that keep apart from all others.
std::vector<char> fitting(const TriangleMesh& body, std::span<const JointFace> faces, const std::vector<std::vector<double>>& distance) {
    std::vector<char> out(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (!faces[f].disc) continue;
        const double radius = faces[f].disc->radius;
        const auto of = [&](Index v) { return distance[f][static_cast<std::size_t>(v)]; };
        out[f] = faces[f].triangles.size() >= kFewestDiscTriangles && std::all_of(faces[f].vertices.begin(), faces[f].vertices.end(), [&](Index v) { return of(v) <= kBeyond * radius; });
        for (std::size_t g = 0; g < faces.size() && out[f]; ++g)
            if (g != f) out[f] = std::none_of(faces[g].vertices.begin(), faces[g].vertices.end(), [&](Index v) { return of(v) <= kApart * radius; });
    }
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (std::size_t g = f + 1; g < faces.size(); ++g) {
            if (!faces[f].disc || !faces[g].disc) continue;
            bool near = false;
            for (Eigen::Index v = 0; v < body.vertices.rows() && !near; ++v)
                near = distance[f][static_cast<std::size_t>(v)] <= kApart * faces[f].disc->radius && distance[g][static_cast<std::size_t>(v)] <= kApart * faces[g].disc->radius;
            if (near) out[f] = out[g] = 0;
        }
    return out;
}

/// Share of the way from a to b at which the distance is `radius`: along a straight edge from a source in a plane with it.
double crossing(double length, double da, double db, double radius) {
    const double along = (da * da - db * db + length * length) / (2.0 * length), below = std::max(0.0, da * da - along * along);
    const double share = (along + std::sqrt(std::max(0.0, radius * radius - below))) / length;
    return share > 0.0 && share < 1.0 ? share : std::clamp((radius - da) / (db - da), 0.0, 1.0);
}

/// One attempt to cut all `exact` discs out. The faces that could not be.
std::vector<std::size_t> cut(const TriangleMesh& body, std::span<const JointFace> faces, const std::vector<char>& exact, const std::vector<std::vector<double>>& nearBody, SolverMesh& out) {
    std::vector<double> longest(static_cast<std::size_t>(body.vertices.rows()), std::numeric_limits<double>::infinity());
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (std::size_t v = 0; v < longest.size() && exact[f]; ++v) {
            const double radius = faces[f].disc->radius, d = nearBody[f][v];
            if (d < SurfaceDistance::kFar) longest[v] = std::min(longest[v], kDiscEdge * radius + kGrowth * std::max(0.0, d - kFine * radius));
        }
    const SolverMesh fine = bisectedTo(body, labelsOf(body, faces, exact), faces.size(), std::move(longest));
    const EdgeTable edges(fine.mesh.triangles);
    const auto count = static_cast<std::size_t>(fine.mesh.vertices.rows());

    enum class Side : char { Out, In, Rim };
    std::vector<Side> side(count, Side::Out);
    std::vector<Index> disc(count, -1), nearest(faces.size(), -1);
    std::vector<double> distance(count, SurfaceDistance::kFar);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (!exact[f]) continue;
        const double radius = faces[f].disc->radius;
        std::vector<double> d = distancesFrom(fine.mesh, faces[f].disc->point, kApart * radius);
        for (const Index v : faces[f].vertices) d[static_cast<std::size_t>(v)] = std::min(d[static_cast<std::size_t>(v)], radius);
        double least = SurfaceDistance::kFar;
        for (std::size_t v = 0; v < count; ++v) {
            if (!(d[v] < SurfaceDistance::kFar)) continue;
            disc[v] = static_cast<Index>(f);
            distance[v] = d[v];
            side[v] = d[v] < radius ? Side::In : d[v] > radius ? Side::Out : Side::Rim;
            if (d[v] < least) least = d[v], nearest[f] = static_cast<Index>(v);
        }
    }
    // Of every edge across an outline, with its inner end first.
    const auto across = [&](int e, auto&& visit) {
        const EdgeUse& use = edges.uses(e)[0];
        Index a = use.low, b = use.high;
        if (side[static_cast<std::size_t>(a)] == Side::Out) std::swap(a, b);
        if (side[static_cast<std::size_t>(a)] != Side::In || side[static_cast<std::size_t>(b)] != Side::Out) return;
        const double length = (fine.mesh.vertices.row(a) - fine.mesh.vertices.row(b)).norm(), radius = faces[static_cast<std::size_t>(disc[static_cast<std::size_t>(a)])].disc->radius;
        const double da = distance[static_cast<std::size_t>(a)], db = distance[static_cast<std::size_t>(b)];
        visit(a, b, db < SurfaceDistance::kFar ? crossing(length, da, db, radius) : std::min(1.0, (radius - da) / length));
    };
    for (int e = 0; e < edges.size(); ++e)
        across(e, [&](Index a, Index b, double share) {
            if (share < kSnap) side[static_cast<std::size_t>(a)] = Side::Rim;
            if (share > 1.0 - kSnap) {
                side[static_cast<std::size_t>(b)] = Side::Rim;
                disc[static_cast<std::size_t>(b)] = disc[static_cast<std::size_t>(a)];
            }
        });
    MeshPieces pieces(fine);
    std::vector<std::array<Index, 3>> corners;
    std::vector<Index> face;
    corners.swap(pieces.corners);
    face.swap(pieces.face);
    std::vector<Index> middle(static_cast<std::size_t>(edges.size()), -1);
    for (int e = 0; e < edges.size(); ++e)
        across(e, [&](Index a, Index b, double share) {
            middle[static_cast<std::size_t>(e)] = pieces.add({a, b, a}, {1.0 - share, share, 0.0});
            side.push_back(Side::Rim);
            disc.push_back(disc[static_cast<std::size_t>(a)]);
        });
    for (std::size_t t = 0; t < corners.size(); ++t) {
        std::array<Index, 3> m{};
        for (std::size_t c = 0; c < 3; ++c) m[c] = middle[static_cast<std::size_t>(edges.edgeOf(static_cast<Index>(t), static_cast<int>(c)))];
        pieces.halved(corners[t], m, face[t]);
    }

    out = pieces.joined(faces.size());
    const EdgeTable after(out.mesh.triangles);
    const VertexCorners around(out.mesh);
    std::vector<std::size_t> failed;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (!exact[f]) continue;
        // What hangs together with the middle and has no corner outside.
        const auto within = [&](Index t) {
            for (int c = 0; c < 3; ++c) {
                const auto v = static_cast<std::size_t>(out.mesh.triangles(t, c));
                if (disc[v] != static_cast<Index>(f) || side[v] == Side::Out) return false;
            }
            return pieces.face[static_cast<std::size_t>(t)] < 0;
        };
        std::vector<Index> open;
        std::size_t triangles = 0, vertices = 0, sides = 0;
        for (const Index corner : around.at(nearest[f]))
            if (open.empty() && within(corner / 3)) open.push_back(corner / 3), pieces.face[static_cast<std::size_t>(corner / 3)] = static_cast<Index>(f);
        std::vector<char> has(static_cast<std::size_t>(out.mesh.vertices.rows())), hasEdge(static_cast<std::size_t>(after.size()));
        for (; triangles < open.size(); ++triangles)
            for (int c = 0; c < 3; ++c) {
                const Index t = open[triangles];
                char& vertex = has[static_cast<std::size_t>(out.mesh.triangles(t, c))];
                vertices += std::exchange(vertex, 1) ? 0 : 1;
                char& edge = hasEdge[static_cast<std::size_t>(after.edgeOf(t, c))];
                sides += std::exchange(edge, 1) ? 0 : 1;
                for (const EdgeUse& use : after.uses(after.edgeOf(t, c)))
                    if (within(use.triangle)) open.push_back(use.triangle), pieces.face[static_cast<std::size_t>(use.triangle)] = static_cast<Index>(f);
            }
        // A disc by Euler's characteristic, and what the document holds is held.
        const bool all = std::all_of(faces[f].vertices.begin(), faces[f].vertices.end(), [&](Index v) { return has[static_cast<std::size_t>(v)] != 0; });
        if (vertices + triangles != sides + 1 || !all) failed.push_back(f);
    }
    out.faces = patchesOf(out.mesh.triangles, pieces.face, faces.size());
    return failed;
}

}  // namespace

std::vector<JointFace> DiscMesh::faces(std::span<const JointFace> ofBody) const {
    std::vector<JointFace> out(ofBody.begin(), ofBody.end());
    for (std::size_t f = 0; f < out.size(); ++f) {
        out[f].vertices = mesh.faces[f].vertices;
        out[f].triangles = mesh.faces[f].triangles;
    }
    return out;
}

DiscMesh discMesh(const TriangleMesh& body, std::span<const JointFace> faces) {
    DiscMesh out;
    out.exact.assign(faces.size(), 0);
    if (std::none_of(faces.begin(), faces.end(), [](const JointFace& face) { return face.disc.has_value(); })) return out;
    std::vector<std::vector<double>> distance(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f)
        if (faces[f].disc) distance[f] = distancesFrom(body, faces[f].disc->point, kKnown * faces[f].disc->radius);
    out.exact = fitting(body, faces, distance);
    while (out.any()) {
        const auto failed = cut(body, faces, out.exact, distance, out.mesh);
        if (failed.empty()) break;
        for (const std::size_t f : failed) out.exact[f] = 0;
    }
    if (!out.any()) {
        out.mesh = {};
        return out;
    }
    std::vector<char> held(static_cast<std::size_t>(body.vertices.rows()));
    for (const JointFace& face : faces)
        for (const Index v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const Index v : out.mesh.faces[f].vertices)
            if (v < body.vertices.rows() && !held[static_cast<std::size_t>(v)]) out.inside.push_back({v, static_cast<Index>(f)});
    std::sort(out.inside.begin(), out.inside.end(), [](const DiscMesh::Inside& a, const DiscMesh::Inside& b) { return a.vertex < b.vertex; });
    return out;
}

}  // namespace imomushi
