// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/volume_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "core/elasticity/boundary_problem.h"
#include "core/elasticity/tetrahedral_mesh.h"
#include "core/mesh/topology.h"
#include "core/mesh/vertex_corners.h"
#include "core/meshing/short_edges.h"

namespace imomushi {
namespace {

/// Vertices of draft and best; default has SolverMeshSetting::kVolumeVertices.
constexpr int kDraftVolume = 600, kBestVolume = 5000;
/// So many vertices more for each handle after so many: rims need their own.
constexpr int kPerHandle = 40, kUsualHandles = 4;
/// Edges at a rim over the radius of its face, for kRimVertices vertices; with fewer they are longer, as edges elsewhere are.
constexpr double kRimEdge = 0.15, kRimVertices = 2500.0, kFinestRim = 0.05, kCoarsestRim = 0.4;
constexpr std::size_t kRimFaces = 6;  // up to so many
/// The same of bodies without handles, see VolumeDetail::rim, and what the coarser level has in their place. With quadratic displacement on tetrahedra the error of pieces comes from
/// their rims: small edges there, and only there, give the same error as small ones everywhere with a third to half of the tetrahedra and a fraction of the factor. Against kBestRim, root
/// mean square over joint modes: drafts 1.1 to 3.9 %, default 0.2 to 0.9 % on 15 pieces of two characters; a torso of low polygons 2.4 %.
constexpr double kDraftRim = 0.2, kDefaultRim = 0.05, kBestRim = 0.03, kCoarserRim = 1.7;
/// What is left of the difference from the coarser level, see volumeErrorLeft(): with edges of one size, measured on six bodies with handles; and with small edges at rims alone, a little
/// more than the mean of thirteen bodies at three Poisson ratios: 0.6 to 1.2 by default (tests/elasticity/reference_test.cpp).
/// Drafts, whose tetrahedra grow faster than those of their coarser level, leave more.
constexpr double kVolumeErrorLeft = 0.65, kRimErrorLeft = 1.3, kDraftErrorLeft = 1.45;
/// With edges of one size a decimated body of fewer vertices loses shape on both levels alike, which their difference does not see: by this power.
constexpr double kKeepShape = 2500.0, kShapeLost = 0.25;
/// Nodes of such a body, about: for each edge of a rim, and for each vertex of the surface. Fitted to five pieces.
constexpr double kNodesPerRimEdge = 48.0, kNodesPerVertex = 4.0;
/// Edges at re-entrant creases are at most so many times VolumeDetail::rim, over the mean edge of a surface of as many vertices as were asked for.
constexpr double kCreaseOverRim = 10.0;
/// VolumeDetail::growth and crease of drafts: against .7 and .5 a third of the nodes less for errors of 3.2 instead of 2.6 % in the mean, 6.3 instead of 8.1 % at most (sixteen bodies).
constexpr double kDraftGrowth = 1.0, kDraftCrease = 1.0;
/// Longest edges of the surface and inside, over the mean edge of a surface of so many vertices: edges of decimated ones vary. Triangles of coarse bodies are bisected to it.
constexpr double kLongestEdge = 2.0;
/// The same where only rims have small edges.
constexpr double kLongestEdgeOffRims = 6.0;
/// Triangles are bisected where they are longer than this times the wanted size.
constexpr double kBisected = 1.4;
/// Edges at a new vertex may be as long as this part of what its place asks for, even where the mean of the two ends that it lies between, both at rims, is far less. With 1 bodies of few vertices get so
/// few that three reference bodies miss their bounds by up to a seventh.
constexpr double kBetweenRims = 0.5;
/// A body is not decimated for less.
constexpr double kWorthIt = 0.8;
/// One that has more than so many times the vertices that were asked for is decimated as far as its rims allow. What cannot be decimated at all is filled as it is: boundary elements
/// on as many vertices would take far longer.
constexpr int kAtMostTimes = 4;
/// A needle has an edge shorter than this part of the longest ones at both of its ends.
constexpr double kNeedle = 0.05;
/// Sine of the angle between its edge and the triangles at one of its ends, at most (17 degrees).
constexpr double kWithin = 0.3;
constexpr const char* kNoFilling = "no-filling";
/// Steps of the grid across a body, see OnGrid: 2^34. Much finer than what TetGen takes for a plane (1e-8 of an edge), much coarser than rounding.
constexpr double kGridSteps = 17'179'869'184.0;
/// Nodes of draft, default and best at most, about: where rims are long for the area of their faces, as at the ends of a plate, edges at them are longer.
constexpr double kDraftNodesMost = 20'000.0, kDefaultNodesMost = 80'000.0, kBestNodesMost = 250'000.0;

/// A body in a box of size 1, its vertices on a grid. Where edges are as long as others, bisection and TetGen decide by the last bit of coordinates; on the grid equal bodies of any
/// size and at any place get the same tetrahedra.
struct OnGrid {
    Vec3 from;
    double size;  // m
    explicit OnGrid(const Points& vertices) : from(vertices.colwise().minCoeff()), size((vertices.colwise().maxCoeff().transpose() - from).maxCoeff()) {}
    [[nodiscard]] Points of(const Points& vertices) const {
        return (((vertices.rowwise() - from.transpose()) * (kGridSteps / size)).array().round() / kGridSteps).matrix();
    }
    /// Of a mesh that was bisected and filled on the grid: the surface where it is exactly, and what is inside.
    void back(const Points& exact, SolverMesh& mesh, TetrahedralMesh& filling) const {
        Points& surface = mesh.mesh.vertices;
        surface.topRows(exact.rows()) = exact;
        for (std::size_t i = 0; i < mesh.origin.size(); ++i) {
            const SolverMesh::Origin& o = mesh.origin[i];
            surface.row(exact.rows() + static_cast<Eigen::Index>(i)) = o.share[0] * surface.row(o.of[0]) + o.share[1] * surface.row(o.of[1]) + o.share[2] * surface.row(o.of[2]);
        }
        filling.vertices = ((filling.vertices * size).rowwise() + from.transpose()).eval();
        filling.vertices.topRows(surface.rows()) = surface;
    }
};

/// Sizes of edges around the rims of `mesh`.
TetrahedronSizes sizesFor(const SolverMesh& mesh, const VolumeDetail& detail) {
    TetrahedronSizes out;
    double area = 0.0;
    for (std::int32_t t = 0; t < mesh.mesh.triangles.rows(); ++t) area += 0.5 * areaVector(mesh.mesh, t).norm();
    std::vector<double> radius;  // of a disc of each face's area
    for (const SolverMesh::Patch& face : mesh.faces) {
        double held = 0.0;
        for (const std::int32_t t : face.triangles) held += 0.5 * areaVector(mesh.mesh, t).norm();
        radius.push_back(std::sqrt(held / std::numbers::pi));
    }
    const double mean = std::sqrt(2.0 * area / (std::numbers::sqrt3 * detail.vertices));
    // Many rims share the vertices.
    const double share = static_cast<double>(std::max<std::size_t>(kRimFaces, mesh.faces.size())) / static_cast<double>(kRimFaces);
    const double rim = detail.rim > 0.0 ? detail.rim : std::clamp(kRimEdge * std::sqrt(share * kRimVertices / detail.vertices), kFinestRim, kCoarsestRim);
    out.growth = detail.growth;
    out.most = (detail.rim > 0.0 ? kLongestEdgeOffRims : kLongestEdge) * mean;
    const auto along = [&](std::int32_t a, std::int32_t b, double least) {
        const Vec3 from = mesh.mesh.vertices.row(a).transpose(), to = mesh.mesh.vertices.row(b).transpose();
        const int count = std::max(1, static_cast<int>(std::ceil((to - from).norm() / least)));
        for (int i = 0; i < count; ++i) out.points.push_back({from + (i + 0.5) / count * (to - from), least});
    };
    const std::vector<SingularEdge> singular = singularEdges(mesh);
    for (const auto& [a, b, face] : singular)
        if (face >= 0) along(a, b, std::min(out.most, rim * radius[static_cast<std::size_t>(face)]));
    if (detail.rim > 0.0)
        for (const auto& [a, b, face] : singular)
            if (face < 0) along(a, b, std::min(out.most, std::min(detail.crease, kCreaseOverRim * detail.rim) * mean));
    return out;
}

/// About the nodes around rims of faces, with edges of `rim`, see VolumeDetail.
double nodesAtRims(std::span<const JointFace> faces, const TriangleMesh& body, double rim) {
    double edges = 0.0;
    for (const JointFace& face : faces) {
        std::set<std::array<std::int32_t, 2>> outline;  // edges that one triangle of the face has
        for (const std::int32_t t : face.triangles)
            for (int c = 0; c < 3; ++c) {
                const std::int32_t a = body.triangles(t, c), b = body.triangles(t, (c + 1) % 3);
                if (outline.erase({b, a}) == 0) outline.insert({a, b});
            }
        double length = 0.0;
        for (const auto& [a, b] : outline) length += (body.vertices.row(a) - body.vertices.row(b)).norm();
        if (face.area > 0.0) edges += length / (rim * std::sqrt(face.area / std::numbers::pi));
    }
    return kNodesPerRimEdge * edges;
}

/// Cuts the surface of `out` to the wanted sizes and fills it with tetrahedra. Errors: "no-filling", "cancelled", "too-large".
Result<TetrahedralMesh> filled(SolvedBody& out, const VolumeDetail& detail, const Progress& progress) {
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    const Points exact = out.mesh.mesh.vertices;
    const OnGrid grid(exact);
    SolverMesh onGrid = out.mesh;
    onGrid.mesh.vertices = grid.of(exact);
    const TetrahedronSizes wanted = sizesFor(onGrid, detail);
    Result<TetrahedralMesh> filling = tl::make_unexpected(Error{});
    // TetGen breaks down on some surfaces, or leaves a flat tetrahedron, and seldom on the same one cut a little finer: a fin of tests/data/reference was one.
    for (const double part : {1.0, 0.85, 0.7}) {
        TetrahedronSizes sizes = wanted;
        sizes.most *= part;
        for (auto& point : sizes.points) point.size *= part;
        std::vector<double> longest(static_cast<std::size_t>(onGrid.mesh.vertices.rows()));
        for (std::size_t v = 0; v < longest.size(); ++v) longest[v] = kBisected * sizes.at(onGrid.mesh.vertices.row(static_cast<Eigen::Index>(v)).transpose());
        if (progress.cancelled()) return cancelled();
        const SolverMesh bisected = bisectedTo(onGrid.mesh, facesOfTriangles(onGrid), onGrid.faces.size(), std::move(longest),
                                               [&](const Vec3& place) { return kBetweenRims * kBisected * sizes.at(place); });
        SolverMesh fine = withoutShortEdges(bisected);
        if (progress.cancelled()) return cancelled();
        filling = fillWithTetrahedra(fine.mesh, sizes, progress);
        if (!filling && filling.error().code == kNoFilling) continue;
        if (!filling) break;
        grid.back(exact, fine, *filling);
        if (anyFlat(*filling)) {  // edges as short as the steps of the grid
            filling = fail(kNoFilling, "The body cannot be filled with tetrahedra: some of its edges are too short; repair it.");
            continue;
        }
        fine.origin.insert(fine.origin.begin(), out.mesh.origin.begin(), out.mesh.origin.end());
        fine.bubbles = longFreeEdges(fine, 0.0);
        out.mesh = std::move(fine);
        break;
    }
    return filling;
}

/// The number of vertices that a mesh has without its needles: one less for each edge that is short beside those around it and runs along the surface at one of its ends, so that its
/// collapse costs no shape. Edges across thin walls are short, too, but run across it at both.
int withoutNeedles(const TriangleMesh& mesh) {
    const EdgeTable edges(mesh.triangles);
    const VertexCorners corners(mesh);
    const auto along = [&](int e) -> Vec3 { return (mesh.vertices.row(edges.uses(e)[0].high) - mesh.vertices.row(edges.uses(e)[0].low)).transpose(); };
    std::vector<double> longest(static_cast<std::size_t>(mesh.vertices.rows()), 0.0);
    for (int e = 0; e < edges.size(); ++e)
        for (const std::int32_t v : {edges.uses(e)[0].low, edges.uses(e)[0].high}) longest[static_cast<std::size_t>(v)] = std::max(longest[static_cast<std::size_t>(v)], along(e).norm());
    int needles = 0;
    for (int e = 0; e < edges.size(); ++e) {
        const Vec3 edge = along(e);
        const double length = edge.norm();
        const std::int32_t a = edges.uses(e)[0].low, b = edges.uses(e)[0].high;
        if (!(length < kNeedle * std::min(longest[static_cast<std::size_t>(a)], longest[static_cast<std::size_t>(b)]))) continue;
        const auto within = [&](std::int32_t v) {
            return std::ranges::all_of(corners.at(v), [&](std::int32_t corner) {
                const Vec3 area = areaVector(mesh, corner / 3);
                return std::abs(area.dot(edge)) <= kWithin * area.norm() * length;
            });
        };
        needles += within(a) || within(b);
    }
    return static_cast<int>(mesh.vertices.rows()) - needles;
}

}  // namespace

VolumeDetail volumeDetail(const TriangleMesh& body, std::span<const JointFace> faces, const SolverMeshSetting& setting) {
    using Kind = SolverMeshSetting::Kind;
    if (setting.kind == Kind::Volume) return {setting.count > 0 ? setting.count : SolverMeshSetting::kVolumeVertices, 0.0};
    if (setting.kind == Kind::AsIs || setting.kind == Kind::Refined) {
        const int vertices = std::max(setting.count, static_cast<int>(body.vertices.rows()));
        if (vertices > BoundaryProblem::kUsualNodes) return {vertices, 0.0, true};
    }
    const auto handles = static_cast<int>(std::count_if(faces.begin(), faces.end(), [](const JointFace& face) { return face.disc.has_value(); }));
    const int more = kPerHandle * std::max(0, handles - kUsualHandles);
    const auto made = [&](int vertices, double rim, double nodes, double growth = VolumeDetail().growth, double crease = VolumeDetail().crease) -> VolumeDetail {
        // Handles lie on smooth surfaces, where more than the rims needs small edges.
        if (handles > 0) return {vertices + more, 0.0};
        return {vertices, std::max(rim, rim * nodesAtRims(faces, body, rim) / nodes), false, growth, crease};
    };
    switch (setting.kind) {
        case Kind::Draft: return made(kDraftVolume, kDraftRim, kDraftNodesMost, kDraftGrowth, kDraftCrease);
        case Kind::Default: return made(SolverMeshSetting::kVolumeVertices, kDefaultRim, kDefaultNodesMost);
        case Kind::Best: return made(kBestVolume, kBestRim, kBestNodesMost);
        default: return {};
    }
}

int volumeNodes(const TriangleMesh& body, std::span<const JointFace> faces, const VolumeDetail& detail) {
    // Measured on a penguin: 6,330 nodes from 600 vertices, 26,300 from 2500, 53,700 from 5,004; on an egg 33,000 from 2500.
    if (detail.rim <= 0.0) return 11 * detail.vertices;
    return static_cast<int>(nodesAtRims(faces, body, detail.rim) + kNodesPerVertex * std::min<double>(detail.vertices, static_cast<double>(body.vertices.rows())));
}

double volumeErrorLeft(const SolvedBody& fine) {
    if (fine.detail.rim > 0.0) return fine.detail.growth > VolumeDetail().growth ? kDraftErrorLeft : kRimErrorLeft;
    return fine.decimated ? kVolumeErrorLeft * std::pow(std::max(1.0, kKeepShape / fine.detail.vertices), kShapeLost) : kVolumeErrorLeft;
}

VolumeDetail coarserVolume(const VolumeDetail& detail, bool decimated) {
    // On one surface the levels differ by their tetrahedra alone. Without small edges at rims it is the surface that has the edges.
    return {std::max(detail.vertices / 3, SolverMeshSetting::kFewest), kCoarserRim * detail.rim, detail.rim > 0.0 && !decimated};
}

Result<SolvedBody> volumeBody(const BodySurface& surface, const VolumeDetail& detail, const Progress& progress, int mostVertices) {
    const int vertices = detail.vertices;
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    const auto own = static_cast<int>(surface.triangles().vertices.rows());
    std::optional<SolvedBody> out;
    if (!detail.onItself && vertices < kWorthIt * own) {
        const double most = own > kAtMostTimes * vertices ? kAsFewAsRimsAllow : kAboutAsMany;
        if (auto small = onDecimated(surface, vertices, progress, kOutlineEdge, most); small && static_cast<double>(small->mesh.mesh.vertices.rows()) < kWorthIt * own) out = std::move(*small);
        if (progress.cancelled()) return cancelled();
    }
    // Where cuts pass close by vertices, and where surfaces were united, bodies have needles, which TetGen fills with many tetrahedra, flat ones among them.
    if (const bool asItIs = detail.onItself && detail.rim <= 0.0; !out && !asItIs)
        if (const int fewer = withoutNeedles(surface.triangles()); fewer < own)
            if (auto clean = onDecimated(surface, fewer, progress)) out = std::move(*clean);
    if ((out ? static_cast<int>(out->mesh.mesh.vertices.rows()) : own) > mostVertices) return fail(kNoFilling, "The body cannot be decimated that far.");
    if (!out) out = onItself(surface.mesh, surface);
    auto filling = filled(*out, detail, progress);
    if (progress.cancelled()) return cancelled();
    if (!filling) return tl::make_unexpected(filling.error());
    out->filling = std::make_shared<const TetrahedralMesh>(std::move(*filling));
    out->detail = detail;
    return std::move(*out);
}

}  // namespace imomushi
