// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/warp/bend_warp_tables.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/finite.h"
#include "core/base/union_find.h"
#include "core/mesh/bounds.h"
#include "core/mesh/triangle_tree.h"
#include "core/warp/bend_warp.h"

namespace imomushi {

using Eigen::Vector4f;

namespace {

constexpr int kBlock = BendWarp::kBlock;
// A triangle flatter than this (twice its area over its longest side squared) says nothing about rotations; it only follows, this softly.
constexpr double kSliver = 1e-4, kSliverStiffness = 1e-3;
// Linear elasticity has a stress singularity along the rim of a rigid face, which a large bend would show as a crease. Triangles within this many face sizes
// (at most this part of the way to the next face) therefore take the rotation and stretch of the face instead: wholly within kFollowWholly of the band,
// then less and less.
constexpr double kBand = 2.0, kBandShare = 0.5, kFollowWholly = 0.2;
// Where neighbouring triangles cannot all have the shapes that they should, least squares spreads the misfit by stiffness. Triangles within this many face
// sizes are stiffer, up to kStiffness times at the rim, so that the misfit goes where nobody sees a crease, away from the face; compliance (1 / stiffness)
// grows with distance to the power of 1.5.
constexpr double kStiffBand = 0.8, kStiffness = 50.0;
// The inflation falls off towards faces over this many times the size of the largest one.
constexpr double kInflationRange = 0.5;
// Contact with the plane of a face concerns vertices within kContactInside face sizes of its middle, fading to none at kContactOutside. A vertex stops before
// it crosses the plane: it is slowed down once it is nearer than half of its distance at rest, or than half of kContactDepth face sizes if that is less.
constexpr double kContactInside = 1.0, kContactOutside = 1.5, kContactDepth = 0.25;
// Vertices that are this close to the plane at rest, in sizes of the face, lie beside it, not before it.
constexpr double kMinDepth = 1e-4;
// Of every vertex; that of a vertex among good triangles is about 4.
constexpr double kMinStiffness = 1e-7;

// 1 below 0, 0 above 1.
double fade(double x) {
    const double t = std::clamp(x, 0.0, 1.0);
    return 1.0 - t * t * (3.0 - 2.0 * t);
}

// How much a triangle follows a face at this part of the band: wholly beside it, where the response is singular, then falling fast at first, so that
// the curvature which it takes from there spreads evenly.
double followShare(double x) {
    const double from = x * (1.0 - fade(x / kFollowWholly));
    return std::pow(1.0 - std::min(1.0, from), 3);
}

// Of the middle of each triangle, per face, m.
std::vector<std::vector<double>> distanceToFaces(const TriangleMesh& body, const std::vector<JointFace>& faces) {
    std::vector<std::vector<double>> out;
    for (const auto& face : faces) {
        auto& list = out.emplace_back(static_cast<std::size_t>(body.triangles.rows()), 0.0);
        const TriangleTree tree(body, face.triangles);
        for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
            Vec3 middle = Vec3::Zero();
            for (int c = 0; c < 3; ++c) middle += body.vertices.row(body.triangles(t, c)).transpose() / 3.0;
            list[t] = std::sqrt(tree.nearest(middle).squaredDistance);
        }
    }
    return out;
}

/// How a point keeps away from the plane of a face.
struct NearPlane {
    double depth = 0.0, weight = 0.0;  // where it is slowed down, m; 0: it is not
};
NearPlane nearPlane(const JointFace& face, const Vec3& point) {
    const Vec3 p = face.frame.toLocal(point) / std::max(face.size, 1e-30);
    const double depth = -p.z(), aside = p.head<2>().norm();
    const double weight = fade((aside - kContactInside) / (kContactOutside - kContactInside)) * fade(depth - 1.0);
    if (!(depth > kMinDepth && weight > 0.0)) return {};
    return {0.5 * std::min(depth, kContactDepth) * face.size, weight};
}

// A triangle that counts; see WarpBatch.
struct ElasticTriangle {
    std::array<std::int32_t, 3> v;
    float c11, c12, c22;
};

std::vector<WarpBatch> batchesOf(const std::vector<ElasticTriangle>& triangles) {
    std::vector<WarpBatch> out((triangles.size() + kWarpBatch - 1) / kWarpBatch, WarpBatch{});
    for (std::size_t i = 0; i < out.size() * kWarpBatch; ++i) {
        const ElasticTriangle& t = triangles[std::min(i, triangles.size() - 1)];
        const std::size_t lane = i % kWarpBatch;
        auto& batch = out[i / kWarpBatch];
        for (std::size_t c = 0; c < 3; ++c) batch.corner[c][lane] = 4 * t.v[c];
        if (i < triangles.size()) batch.c11[lane] = t.c11, batch.c12[lane] = t.c12, batch.c22[lane] = t.c22;
    }
    return out;
}

using Corners = std::array<std::int32_t, 3>;

std::vector<SurfaceBatch> batchesOf(const std::vector<Corners>& surface) {
    std::vector<SurfaceBatch> out((surface.size() + kWarpBatch - 1) / kWarpBatch, SurfaceBatch{});
    for (std::size_t i = 0; i < surface.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) out[i / kWarpBatch].corner[c][i % kWarpBatch] = 4 * surface[i][c];
    return out;
}

void findNeighbors(const std::vector<Corners>& surface, BendWarpTables& s) {
    std::vector<std::array<std::int32_t, 2>> edges;
    for (const auto& t : surface)
        for (std::size_t c = 0; c < 3; ++c) edges.push_back({t[c], t[(c + 1) % 3]}), edges.push_back({t[(c + 1) % 3], t[c]});
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    s.neighbors.reserve(edges.size());
    s.firstNeighbor.assign(static_cast<std::size_t>(s.vertices) + 1, 0);
    for (const auto& e : edges) {
        s.neighbors.push_back(e[1]);
        ++s.firstNeighbor[static_cast<std::size_t>(e[0]) + 1];
    }
    for (std::size_t i = 1; i < s.firstNeighbor.size(); ++i) s.firstNeighbor[i] += s.firstNeighbor[i - 1];
}

bool fits(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response,
          std::span<const std::int32_t> blocks) {
    const auto vertices = body.vertices.rows();
    if (!allFinite(body.vertices) ||
        (body.triangles.size() > 0 && (body.triangles.minCoeff() < 0 || body.triangles.maxCoeff() >= vertices)))
        return false;
    if (response.bases.size() != faces.size() || response.firstColumn.size() != faces.size() + 1) return false;
    std::vector<char> seen(static_cast<std::size_t>(vertices), 0);
    std::size_t count = response.freeVertices.size();
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (response.firstColumn[f + 1] - response.firstColumn[f] != response.bases[f].columns()) return false;
        for (const auto v : faces[f].vertices)
            if (v < 0 || v >= vertices || seen[v]++) return false;
        count += faces[f].vertices.size();
    }
    std::size_t block = 0;
    for (const auto v : response.freeVertices) {
        if (v < 0 || v >= vertices || seen[v]++) return false;
        while (block < blocks.size() && blocks[block] + BendWarp::kBlock <= v) ++block;
        if (block == blocks.size() || blocks[block] > v) return false;
    }
    return count == static_cast<std::size_t>(vertices) &&
           response.response.rows() == 3 * static_cast<Eigen::Index>(response.freeVertices.size()) &&
           response.response.cols() == response.columns() && allFinite(response.response);
}

}  // namespace

Result<std::shared_ptr<const BendWarpTables>> BendWarpTables::build(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response,
                                                                    double nu, std::span<const std::int32_t> blocks, const Vec3& middle,
                                                                    const Progress& progress) {
    if (body.vertices.rows() <= CoarseBody::kCarriedFrom || !fits(body, faces, response, blocks)) return buildWhole(body, faces, response, nu, blocks, middle, progress);
    const auto start = std::chrono::steady_clock::now();
    const auto coarse = CoarseBody::build(body, faces, response, nu, progress);
    if (!coarse) return buildWhole(body, faces, response, nu, blocks, middle, progress);
    std::vector<std::int32_t> ofCoarse;
    for (const auto v : coarse->response.freeVertices)
        if (ofCoarse.empty() || v >= ofCoarse.back() + kBlock) ofCoarse.push_back(v);
    auto tables = buildWhole(coarse->mesh, coarse->faces, coarse->response, nu, ofCoarse, middle, progress);
    if (!tables) return tl::unexpected(tables.error());
    auto& out = **tables;
    auto& carrier = *coarse->carrier;
    std::size_t block = 0;
    for (const auto v : response.freeVertices) {
        while (blocks[block] + kBlock <= v) ++block;
        carrier.slot.push_back(static_cast<std::int64_t>(block) * 3 * kBlock + (v - blocks[block]));
    }
    // Vertices that are seen stop before the plane, not those that carry them.
    for (auto& list : out.contacts) list.clear();
    for (std::size_t i = 0; i < response.freeVertices.size(); ++i)
        for (std::size_t f = 0; f < faces.size(); ++f)
            if (const auto near = nearPlane(faces[f], body.vertices.row(response.freeVertices[i]).transpose()); near.weight > 0.0)
                carrier.contacts.push_back({static_cast<std::int32_t>(i), static_cast<int>(f), static_cast<float>(near.depth), static_cast<float>(near.weight)});
    out.carrier = coarse->carrier;
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::shared_ptr<const BendWarpTables>(std::move(*tables));
}

Result<std::shared_ptr<BendWarpTables>> BendWarpTables::buildWhole(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response,
                                                                   double nu, std::span<const std::int32_t> blocks, const Vec3& middle,
                                                                   const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    if (!fits(body, faces, response, blocks) || !allFinite(middle) || !(nu >= 0.0 && nu <= 0.5))
        return fail("bad-value", "The response of an element belongs to another mesh or other joint faces; precompute again.");
    progress.report("warp", 0.0);
    auto made = std::make_shared<BendWarpTables>();
    auto& s = *made;
    const auto n = static_cast<std::size_t>(body.vertices.rows());
    s.vertices = static_cast<int>(n);
    s.nu = nu;
    s.middle = middle;
    s.faces = faces;
    s.bases = response.bases;
    s.firstColumn = response.firstColumn;
    s.size = diagonalOf(body.vertices);
    if (!(s.size > 0.0)) s.size = 1.0;
    s.origin = middle;
    if (!faces.empty()) {
        s.origin.setZero();
        for (const auto& face : faces) s.origin += face.frame.origin / static_cast<double>(faces.size());
    }

    // Which vertices are solved for.
    std::vector<char> kind(n, 0);  // 0 solved, 1 one of a floating shell, 2 held
    for (const auto& face : faces)
        for (const auto v : face.vertices) kind[v] = 2;
    UnionFind shells(n);
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t)
        for (int c = 0; c < 2; ++c) shells.unite(body.triangles(t, c), body.triangles(t, c + 1));
    std::vector<char> holds(n, 0);
    for (std::size_t v = 0; v < n; ++v)
        if (kind[v] == 2) holds[shells.find(static_cast<std::int32_t>(v))] = 1;
    for (std::size_t v = 0; v < n; ++v)
        if (shells.find(static_cast<std::int32_t>(v)) == static_cast<std::int32_t>(v) && !holds[v]) kind[v] = 1;

    // The surface's stiffness: of each triangle, the integral of gradient times gradient.
    const Points points = (body.vertices.rowwise() - s.origin.transpose()) / s.size;
    const auto point = [&](std::int32_t v) -> Vec3 { return points.row(v).transpose(); };
    std::vector<std::int32_t> row(n, -1);
    for (std::size_t v = 0; v < n; ++v)
        if (kind[v] == 0) row[v] = s.solved++;
    std::vector<char> counts;
    std::vector<SparseEntry> entries;
    Eigen::VectorXd area = Eigen::VectorXd::Zero(s.solved);
    Points outward = Points::Zero(static_cast<Eigen::Index>(n), 3);
    const auto distances = distanceToFaces(body, faces);
    std::vector<double> bands;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        double nearest = kBand * faces[f].size;
        for (std::size_t o = 0; o < faces.size(); ++o)
            if (o != f) nearest = std::min(nearest, kBandShare * (faces[o].frame.origin - faces[f].frame.origin).norm());
        bands.push_back(std::max(nearest, 1e-6 * s.size));
    }
    std::vector<Corners> surface;
    std::vector<ElasticTriangle> triangles;
    std::vector<std::vector<float>> parts(faces.size());  // of triangles, that follow each face
    for (Eigen::Index k = 0; k < body.triangles.rows(); ++k) {
        const std::array<std::int32_t, 3> v{body.triangles(k, 0), body.triangles(k, 1), body.triangles(k, 2)};
        const Vec3 e1 = point(v[1]) - point(v[0]), e2 = point(v[2]) - point(v[0]), normal = e1.cross(e2);
        const double longest = std::max({e1.squaredNorm(), e2.squaredNorm(), (e1 - e2).squaredNorm()}), twice = normal.norm();
        const bool sliver = !(twice > kSliver * longest) || !(longest > 1e-16);
        double stiffer = 1.0;
        for (std::size_t f = 0; f < faces.size(); ++f)
            stiffer = std::max(
                stiffer, 1.0 / (1.0 / kStiffness + (1.0 - 1.0 / kStiffness) *
                                                       std::pow(std::min(1.0, distances[f][k] / (kStiffBand / kBand * bands[f])), 1.5)));
        const double over = stiffer * (sliver ? kSliverStiffness / std::max(longest, 1e-30) : 0.5 / twice);
        const double c11 = over * e2.squaredNorm(), c12 = -over * e1.dot(e2), c22 = over * e1.squaredNorm();
        const double c[3][3] = {{c11 + 2.0 * c12 + c22, -c11 - c12, -c12 - c22}, {-c11 - c12, c11, c12}, {-c12 - c22, c12, c22}};
        for (int i = 0; i < 3; ++i) {
            outward.row(v[i]) += normal.transpose() / 6.0;
            if (row[v[i]] < 0) continue;
            area[row[v[i]]] += twice / 6.0;
            for (int j = 0; j < 3; ++j)
                if (row[v[j]] >= 0) entries.push_back({row[v[i]], row[v[j]], c[i][j]});
        }
        s.volume += point(v[0]).dot(point(v[1]).cross(point(v[2]))) / 6.0;
        surface.push_back(v);
        if (sliver || (kind[v[0]] == 2 && kind[v[1]] == 2 && kind[v[2]] == 2)) continue;
        double sum = 0.0;
        for (std::size_t f = 0; f < faces.size(); ++f) sum += followShare(distances[f][k] / bands[f]);
        for (std::size_t f = 0; f < faces.size(); ++f) parts[f].push_back(static_cast<float>(followShare(distances[f][k] / bands[f]) / std::max(1.0, sum)));
        triangles.push_back({v, static_cast<float>(c11), static_cast<float>(c12), static_cast<float>(c22)});
    }
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    progress.report("warp", 0.2);
    // Vertices of slivers alone hang on this, and rounding of the others is far below.
    for (int i = 0; i < s.solved; ++i) entries.push_back({i, i, kMinStiffness});
    auto factor = SparseFactor::build(s.solved, entries);
    if (!factor)
        return fail("bad-value", "The triangles of an element are too extreme to warp it; mend its mesh or leave the bend warp off.");
    s.factor = std::move(*factor);
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    progress.report("warp", 0.6);

    // The order of elimination, then the others; held ones in the order of their faces.
    std::vector<std::int32_t> index(n, -1);
    for (std::size_t v = 0; v < n; ++v)
        if (row[v] >= 0) index[v] = s.factor.order()[row[v]];
    s.free = s.solved;
    for (std::size_t v = 0; v < n; ++v)
        if (kind[v] == 1) index[v] = s.free++;
    for (const auto& face : faces)
        for (const auto v : face.vertices) {
            s.held.push_back(v);
            s.indexOfHeld.push_back(index[v] = s.free + static_cast<std::int32_t>(s.indexOfHeld.size()));
        }
    for (auto& t : surface)
        for (auto& v : t) v = index[v];
    findNeighbors(surface, s);
    s.surface = batchesOf(surface);
    for (auto& t : triangles)
        for (auto& v : t.v) v = index[v];
    s.triangles = batchesOf(triangles);
    for (std::size_t first = 0; first < triangles.size(); first += kWarpBatch)
        for (std::size_t f = 0; f < faces.size(); ++f) {
            FollowBatch batch{static_cast<std::int32_t>(first / kWarpBatch), static_cast<std::int32_t>(f), {}};
            const auto from = parts[f].begin() + static_cast<std::ptrdiff_t>(first);
            std::copy(from, std::min(from + kWarpBatch, parts[f].end()), batch.part);
            if (std::any_of(batch.part, batch.part + kWarpBatch, [](float part) { return part > 0.0f; })) s.follow.push_back(batch);
        }
    s.rest.assign(n, Vector4f::Zero());
    for (std::size_t v = 0; v < n; ++v) s.rest[index[v]].head<3>() = point(static_cast<std::int32_t>(v)).cast<float>();

    // Inflation: (L + area / range^2) x = area.
    double range = 0.0;
    for (const auto& face : faces) range = std::max(range, kInflationRange * face.size / s.size);
    if (s.volume > 1e-9 && range > 1e-6) {
        for (int i = 0; i < s.solved; ++i) entries.push_back({i, i, area[i] / (range * range)});
        const auto x = solveSparse(entries, area);
        if (const double most = x ? x->maxCoeff() : 0.0; most > 0.0) {
            s.inflation.assign(n, 0.0f);
            for (std::size_t v = 0; v < n; ++v)
                if (row[v] >= 0 && holds[shells.find(static_cast<std::int32_t>(v))])
                    s.inflation[index[v]] = static_cast<float>(std::max(0.0, (*x)[row[v]] / most));
        }
    }
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    progress.report("warp", 0.8);

    // Responses.
    const Eigen::Index columns = response.columns();
    s.response.resize(3 * s.free, columns);
    s.slot.assign(s.free, 0);
    s.volumeChange = Eigen::VectorXd::Zero(columns);
    std::size_t block = 0;
    for (std::size_t i = 0; i < response.freeVertices.size(); ++i) {
        const auto v = response.freeVertices[i];
        while (blocks[block] + kBlock <= v) ++block;
        s.slot[index[v]] = static_cast<std::int64_t>(block) * 3 * kBlock + (v - blocks[block]);
        const auto rows = response.response.middleRows<3>(3 * static_cast<Eigen::Index>(i)) / s.size;
        s.response.middleRows<3>(3 * index[v]) = rows.cast<float>();
        s.volumeChange += rows.transpose() * outward.row(v).transpose();
    }
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const auto& frame = faces[f].frame;
        s.restOfFace.push_back(localVertices(body, faces[f]));
        Eigen::MatrixXf table(3 * s.restOfFace[f].rows(), response.bases[f].columns());
        for (Eigen::Index i = 0; i < s.restOfFace[f].rows(); ++i) {
            const Eigen::MatrixXd at = frame.axes * response.bases[f].at(s.restOfFace[f].row(i).transpose(), static_cast<int>(i)) / s.size;
            table.middleRows<3>(3 * i) = at.cast<float>();
            s.volumeChange.segment(response.firstColumn[f], at.cols()) += at.transpose() * outward.row(faces[f].vertices[i]).transpose();
        }
        s.heldColumns.push_back(std::move(table));
    }

    // Shells that nobody holds.
    std::vector<int> shellOf(n, -1);
    for (std::size_t v = 0; v < n; ++v)
        if (const auto root = shells.find(static_cast<std::int32_t>(v)); !holds[root]) {
            if (shellOf[root] < 0) shellOf[root] = static_cast<int>(s.floating.size()), s.floating.emplace_back();
            s.floating[shellOf[root]].vertices.push_back(index[v]);
        }
    std::vector<std::int32_t> bodyVertex(n);
    for (std::size_t v = 0; v < n; ++v) bodyVertex[index[v]] = static_cast<std::int32_t>(v);
    std::vector<std::vector<ElasticTriangle>> ofShell(s.floating.size());
    for (const auto& t : triangles)
        if (const auto shell = shellOf[shells.find(bodyVertex[t.v[0]])]; shell >= 0) ofShell[shell].push_back(t);
    for (std::size_t i = 0; i < ofShell.size(); ++i) {
        s.floating[i].batches = batchesOf(ofShell[i]);
        s.floating[i].triangles = ofShell[i].size();
    }

    for (const auto& face : faces) {
        auto& list = s.contacts.emplace_back();
        for (const auto v : response.freeVertices) {
            const auto near = nearPlane(face, body.vertices.row(v).transpose());
            if (near.weight > 0.0) list.push_back({index[v], static_cast<float>(near.depth / s.size), static_cast<float>(near.weight)});
        }
    }

    s.indexOf = std::move(index);
    s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return made;
}

}  // namespace imomushi
