// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/solved_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/mesh/topology.h"
#include "core/meshing/body_surface.h"
#include "core/meshing/mesh_pieces.h"
#include "core/meshing/rim_layers.h"
#include "core/meshing/volume_body.h"

namespace imomushi {
namespace {

/// Nodes up to which the default solves on the body itself: about four seconds on two cores.
constexpr int kMaxNodes = 3500;
/// The same of the best one: about a minute, and 5 GB.
constexpr int kMaxNodesOfBest = 7000;
/// Discretisations that the default tries, the best first: strips at singular edges, bubbles on edges of at least `straight` times the mean length, and the
/// largest number of nodes up to which it is taken. Bubbles are given up before strips: on a body of eight faces, fewer bubbles cost 0.1 % of accuracy, one
/// strip instead of two 1 %.
struct Detail {
    int strips;
    double straight;
    int nodes;
};
constexpr Detail kDetails[] = {{3, 0.5, 3000}, {2, 0.5, kMaxNodes}, {2, 0.8, kMaxNodes}, {2, 1.2, kMaxNodes}};
/// Bodies of fewer vertices are refined first: few triangles cannot bend smoothly, whatever the order of their displacement.
constexpr int kFewestVertices = 350, kFewestVerticesOfBest = 700;
/// A decimated default body: with its strips and bubbles it has about 3000 nodes.
constexpr int kDecimatedVertices = 650;
/// The same of one with handles, the most that leave room for bubbles on edges of kSparse times the mean length: limbs that are held at their tips bend. A move of a
/// penguin's wing was wrong by 24 % at 650 vertices, by 9 % at 900; a cat, which has more rims, gets worse where its bubbles become fewer.
constexpr int kDecimatedVerticesWithHandles[] = {900, 775, kDecimatedVertices};
constexpr double kSparse = 0.8;
/// A draft has strips at its rims up to as many nodes: half a second on two cores.
constexpr int kDraftNodes = 1000;
/// A decimated body with more than this share of the nodes is not used.
constexpr double kWorthDecimating = 0.9;
/// Edges shorter than this times the mean edge get no bubble (quadratic displacement): the displacement is almost linear along them. For a decimated body, and for the setting "best".
constexpr double kStraight = 0.5, kStraightOfBest = 0.25;
/// A body has thin walls where at least kThinShare of its surface is of triangles longer than kThinWall times the wall behind them. Both sides of such a wall
/// must be refined alike: otherwise the bending of a plate is wrong by 0.3 % (unrefined 0.1 %) at a ratio of 5, and by 2 % (0.2 %) at 25 (measured).
constexpr double kThinWall = 2.5, kThinShare = 0.5;
/// The condition number of the equations with quadratic displacement grows as the cube of this ratio, to 1e8 here: more than single-precision factors solve.
constexpr double kExtremeWall = 150.0, kExtremeShare = 0.05;
constexpr std::int32_t kWallSamples = 250;  // triangles
/// Part of the error that strips and bubbles leave, see coarserLevel(); and what strips leave alone: 0.45 of the largest error of a cylinder, 0.51 of a body of three faces.
constexpr double kErrorLeft = 0.1, kErrorLeftByStrips = 0.5;
constexpr const char* kTooIncompressible = "Tetrahedra take a Poisson ratio up to 0.49; boundary elements took their place.";
/// A plain mesh is compared with one of at most this share of its vertices.
constexpr double kCoarserShare = 1.0 / 3.0;

double meanEdge(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
        for (int c = 0; c < 3; ++c) sum += (mesh.vertices.row(mesh.triangles(t, c)) - mesh.vertices.row(mesh.triangles(t, (c + 1) % 3))).norm();
    return sum / static_cast<double>(3 * mesh.triangles.rows());
}

/// Adds strips and bubbles.
void addDetail(SolvedBody& body, int layers, double straight) {
    body.plain = std::move(body.mesh);
    body.mesh = withLayers(body.plain, layers);
    body.mesh.bubbles = longFreeEdges(body.mesh, straight * meanEdge(body.plain.mesh));
}

/// What bubbles leave of the error of linear displacement, 0...1: an edge of length h is wrong by h^2, on an area of h^2.
double linearPart(const SolverMesh& mesh) {
    std::vector<char> held(static_cast<std::size_t>(mesh.mesh.triangles.rows()));
    for (const SolverMesh::Patch& face : mesh.faces)
        for (const std::int32_t t : face.triangles) held[static_cast<std::size_t>(t)] = 1;
    const EdgeTable edges(mesh.mesh.triangles);
    double all = 0.0, linear = 0.0;
    std::size_t next = 0;  // both lists ascend
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        const std::int32_t low = uses[0].low, high = uses[0].high;
        const bool bubble = next < mesh.bubbles.size() && mesh.bubbles[next] == std::array<std::int32_t, 2>{low, high};
        if (bubble) ++next;
        if (std::any_of(uses.begin(), uses.end(), [&](const EdgeUse& use) { return held[static_cast<std::size_t>(use.triangle)] != 0; })) continue;
        const double wrong = std::pow((mesh.mesh.vertices.row(low) - mesh.mesh.vertices.row(high)).squaredNorm(), 3.0);
        all += wrong;
        if (!bubble) linear += wrong;
    }
    return all > 0.0 ? std::sqrt(linear / all) : 0.0;
}

/// Distance from the centroid of triangle t along its inner normal to where the ray leaves the body. Infinite where it does not.
double wallThickness(const TriangleMesh& body, std::int32_t t) {
    const auto corner = [&](std::int32_t f, int c) -> Vec3 { return body.vertices.row(body.triangles(f, c)).transpose(); };
    const Vec3 from = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0, direction = -areaVector(body, t).normalized();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::int32_t f = 0; f < body.triangles.rows(); ++f) {
        // Möller and Trumbore 1997.
        const Vec3 a = corner(f, 0), ab = corner(f, 1) - a, ac = corner(f, 2) - a, side = direction.cross(ac);
        const double determinant = ab.dot(side);
        if (f == t || !(determinant < -kTie * areaVector(body, f).norm())) continue;  // only from within, and not along the triangle
        const Vec3 out = from - a, across = out.cross(ab);
        const double u = out.dot(side) / determinant, v = direction.dot(across) / determinant, distance = ac.dot(across) / determinant;
        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0) nearest = std::min(nearest, distance);
    }
    return nearest;
}

/// Thickness of the walls relative to their triangles, from a sample of them.
enum class Walls { Thick, Thin, Extreme };
Walls wallsOf(const TriangleMesh& body) {
    double thin = 0.0, extreme = 0.0, all = 0.0;
    const auto step = static_cast<std::int32_t>(1 + body.triangles.rows() / kWallSamples);
    for (std::int32_t t = 0; t < body.triangles.rows(); t += step) {
        double longest = 0.0;
        for (int c = 0; c < 3; ++c) longest = std::max(longest, (body.vertices.row(body.triangles(t, c)) - body.vertices.row(body.triangles(t, (c + 1) % 3))).norm());
        const double area = areaVector(body, t).norm(), ratio = longest / wallThickness(body, t);
        all += area;
        if (ratio > kThinWall) thin += area;
        if (ratio > kExtremeWall) extreme += area;
    }
    if (extreme >= kExtremeShare * all) return Walls::Extreme;
    return thin >= kThinShare * all ? Walls::Thin : Walls::Thick;
}

/// The body with at least `fewest` vertices. One of thin walls stays as it is: were the two sides of a wall refined unlike, their small errors would no longer
/// cancel and bend it.
Result<SolverMesh> refinedWhereCoarse(const BodySurface& surface, int fewest, bool thin) {
    if (thin || surface.triangles().vertices.rows() >= fewest) return surface.mesh;
    auto fine = refinedSolverMesh(surface.triangles(), surface.faces, fewest);
    if (fine) fine->origin.insert(fine->origin.begin(), surface.mesh.origin.begin(), surface.mesh.origin.end());
    return fine;
}

/// Decimation would save less than it takes.
bool asItIsForDraft(const TriangleMesh& body) { return body.vertices.rows() <= 2 * SolverMeshSetting::kDraftVertices; }

/// Strips and quadratic displacement, as much as fits.
SolvedBody quadratic(const SolvedBody& plain, bool thin) {
    SolvedBody out;
    for (const Detail& detail : kDetails) {
        out = plain;
        addDetail(out, detail.strips, thin ? 0.0 : detail.straight);  // straight edges would stiffen a thin wall
        if (out.nodes() <= detail.nodes) break;
    }
    return out;
}

/// On the body itself; nothing where the body alone is too large.
Result<std::optional<SolvedBody>> quadraticOnItself(const BodySurface& surface) {
    if (surface.triangles().vertices.rows() > kMaxNodes) return std::nullopt;
    const Walls walls = wallsOf(surface.triangles());
    if (walls == Walls::Extreme) return onItself(surface.mesh, surface);
    auto base = refinedWhereCoarse(surface, kFewestVertices, walls == Walls::Thin);
    if (!base) return tl::make_unexpected(base.error());
    return quadratic(onItself(std::move(*base), surface), walls == Walls::Thin);
}

Result<SolvedBody> byDefault(const BodySurface& surface, const Progress& progress) {
    auto own = quadraticOnItself(surface);
    if (!own) return tl::make_unexpected(own.error());
    if (*own && (*own)->nodes() <= kMaxNodes) return std::move(**own);
    Result<SolvedBody> small = SolvedBody();
    for (const int vertices : surface.discs.any() ? std::span(kDecimatedVerticesWithHandles) : std::span(&kDecimatedVertices, 1)) {
        small = onDecimated(surface, vertices, progress);
        if (progress.cancelled()) return fail(kCancelled, "The precompute was cancelled.");
        if (!small || !surface.discs.any()) break;
        SolvedBody tried = *small;
        addDetail(tried, 2, kSparse);
        if (tried.nodes() <= kMaxNodes) break;
    }
    if (small) {
        // Bodies with handles are smooth creatures, on which creases would take more strips than there is room for.
        if (surface.discs.any())
            small = quadratic(*small, false);
        else
            addDetail(*small, 3, kStraight);
        // Rims keep their vertices, so that with many of them decimation saves too little for its error.
        if (!*own || small->nodes() < kWorthDecimating * (*own)->nodes()) return small;
        return std::move(**own);
    }
    // Decimation fails on dense rims and on bodies that intersect themselves: linear displacement then, less accurate but as cheap.
    SolvedBody linear = onItself({}, surface);
    linear.plain = surface.mesh;
    linear.mesh = withLayers(linear.plain, 2);
    return linear;
}

Result<SolvedBody> draft(const BodySurface& surface, const Progress& progress) {
    SolvedBody out = onItself(surface.mesh, surface);
    const bool discs = surface.discs.any();
    if (discs ? surface.triangles().vertices.rows() > kDraftNodes : !asItIsForDraft(surface.triangles())) {
        auto small = onDecimated(surface, discs ? kDraftNodes : SolverMeshSetting::kDraftVertices, progress, kOutlineEdgeOfDraft, kAsFewAsRimsAllow);
        if (progress.cancelled()) return fail(kCancelled, "The precompute was cancelled.");
        if (small && small->mesh.mesh.vertices.rows() < surface.triangles().vertices.rows()) out = std::move(*small);
    }
    if (discs) return out;  // small triangles all over bend limbs better than strips do
    // Rims are where a coarse mesh is wrong most.
    if (SolverMesh layered = withLayers(out.mesh, 2); layered.mesh.vertices.rows() <= kDraftNodes) {
        out.plain = std::move(out.mesh);
        out.mesh = std::move(layered);
    }
    return out;
}

Result<SolvedBody> byBoundary(const TriangleMesh& body, std::span<const JointFace> faces, const SolverMeshSetting& setting, const Progress& progress) {
    switch (setting.kind) {
        case SolverMeshSetting::Kind::AsIs:
            break;
        case SolverMeshSetting::Kind::Draft:
            return draft(BodySurface(body, faces), progress);
        case SolverMeshSetting::Kind::Refined: {
            auto fine = refinedSolverMesh(body, faces, setting.count);
            if (!fine) return tl::make_unexpected(fine.error());
            return asItIs(body, faces, std::move(*fine));
        }
        case SolverMeshSetting::Kind::Decimated: {
            auto small = onDecimated(BodySurface(body, faces), setting.count, progress);
            if (small) addDetail(*small, 2, kStraight);
            return small;
        }
        case SolverMeshSetting::Kind::Volume:  // where it cannot be filled
        case SolverMeshSetting::Kind::Default:
            return byDefault(BodySurface(body, faces), progress);
        case SolverMeshSetting::Kind::Best: {
            const BodySurface surface(body, faces);
            const Walls walls = wallsOf(surface.triangles());
            if (walls == Walls::Extreme) return onItself(surface.mesh, surface);
            const bool thin = walls == Walls::Thin;
            auto base = refinedWhereCoarse(surface, kFewestVerticesOfBest, thin);
            if (!base) return tl::make_unexpected(base.error());
            SolvedBody out = onItself(std::move(*base), surface);
            addDetail(out, 3, thin ? 0.0 : kStraightOfBest);
            if (out.nodes() > kMaxNodesOfBest) return byDefault(surface, progress);
            return out;
        }
    }
    return asItIs(body, faces, plainSolverMesh(body, faces));
}

}  // namespace

Result<SolvedBody> solvedBody(const TriangleMesh& body, std::span<const JointFace> faces, const SolverMeshSetting& setting, const Progress& progress, bool fill) {
    if (faces.empty()) return asItIs(body, faces, plainSolverMesh(body, faces));
    std::string noFilling;
    if (const VolumeDetail detail = volumeDetail(body, faces, setting); detail.vertices > 0) {
        if (fill) {
            auto filled = volumeBody(BodySurface(body, faces), detail, progress);
            // Only what is wrong with the surface itself is a reason to go another way: a worker that was killed or reached a limit is none.
            if (filled || filled.error().code != "no-filling") return filled;
            noFilling = filled.error().message;
        } else {
            noFilling = kTooIncompressible;
        }
    }
    auto out = byBoundary(body, faces, setting, progress);
    if (out) out->noFilling = std::move(noFilling);
    return out;
}

SolvedSize solvedSize(const TriangleMesh& body, std::span<const JointFace> faces, const SolverMeshSetting& setting, bool fill) {
    const auto vertices = static_cast<int>(body.vertices.rows());
    if (VolumeDetail detail = volumeDetail(body, faces, setting); detail.vertices > 0 && fill) {
        if (detail.rim <= 0.0 && !detail.onItself) detail.vertices = std::min(vertices + vertices / 2, detail.vertices);  // coarse bodies are refined
        return {volumeNodes(body, faces, detail), 2 * detail.vertices, volumeNodes(body, faces, coarserVolume(detail, true)), true};
    }
    if (setting.kind == SolverMeshSetting::Kind::Draft && !asItIsForDraft(body)) return {kDraftNodes, 2 * kDraftNodes, SolverMeshSetting::kDraftVertices};
    if (setting.kind == SolverMeshSetting::Kind::AsIs) return {vertices, static_cast<int>(body.triangles.rows()), vertices / 3};
    if (setting.kind == SolverMeshSetting::Kind::Refined) {
        const int count = std::max(vertices, setting.count);
        return {count, 2 * count, std::max(count / 3, std::min(vertices, count))};
    }
    // Cutting a body of so many vertices takes a fraction of a second.
    constexpr int kQuick = 20'000;
    if (vertices <= kQuick || (setting.kind == SolverMeshSetting::Kind::Default && vertices <= kMaxNodes))
        if (const auto made = solvedBody(body, faces, setting, {}, false))
            return {made->nodes(), static_cast<int>(made->mesh.mesh.triangles.rows()), static_cast<int>(made->plain.mesh.vertices.rows())};
    // Strips and bubbles make about five nodes of a vertex: measured on bodies of 500 to 100 000 vertices.
    const int plain = setting.kind == SolverMeshSetting::Kind::Default ? std::min(vertices, kDecimatedVertices)
                      : setting.kind == SolverMeshSetting::Kind::Decimated ? std::min(vertices, setting.count)
                                                                           : vertices;
    return {5 * plain, 4 * plain, plain};
}

Result<CoarserLevel> coarserLevel(const TriangleMesh& body, std::span<const JointFace> faces, const SolvedBody& fine, const Progress& progress) {
    CoarserLevel out;
    if (fine.filling) {
        const BodySurface surface(body, faces);
        const auto most = static_cast<int>(fine.mesh.mesh.vertices.rows());
        VolumeDetail detail = coarserVolume(fine.detail, fine.decimated);
        auto coarse = volumeBody(surface, detail, progress, most);
        // A body that cannot be decimated that far would be filled as it is, with several times the nodes. Longer edges at rims alone make it coarser, too.
        if (!coarse && coarse.error().code == "no-filling") {
            detail.vertices = fine.detail.vertices, detail.growth = fine.detail.growth, detail.crease = fine.detail.crease;
            coarse = volumeBody(surface, detail, progress, most);
        }
        if (!coarse) return tl::make_unexpected(coarse.error());
        out.body = std::move(*coarse);
        out.share = volumeErrorLeft(fine);
        return out;
    }
    if (fine.plain.mesh.vertices.rows() > 0) {
        out.share = std::max(kErrorLeft, kErrorLeftByStrips * linearPart(fine.mesh));
        out.body = fine;
        out.body.mesh = std::move(out.body.plain);
        out.body.plain = {};
        return out;
    }
    const auto vertices = static_cast<double>(fine.mesh.mesh.vertices.rows());
    if (kCoarserShare * vertices >= static_cast<double>(body.vertices.rows())) {
        out.body = asItIs(body, faces, plainSolverMesh(body, faces));
    } else {
        std::vector<JointFace> triangles(faces.begin(), faces.end());
        for (JointFace& face : triangles) face.disc.reset();  // as those are solved that have no coarser level of their own
        auto small = onDecimated(BodySurface(body, triangles), static_cast<int>(kCoarserShare * vertices), progress);
        if (!small) return tl::make_unexpected(small.error());
        out.body = std::move(*small);
    }
    out.share = 1.0 / (std::sqrt(vertices / static_cast<double>(out.body.mesh.mesh.vertices.rows())) - 1.0);
    return out;
}

}  // namespace imomushi
