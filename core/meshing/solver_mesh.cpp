// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/solver_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <queue>
#include <string>
#include <tuple>
#include <unordered_map>

#include "core/mesh/edge_key.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/meshing/mesh_pieces.h"
#include "core/meshing/solver_mesh_setting.h"

namespace imomushi {
namespace {

using Corner = std::array<std::int32_t, 3>;

/// An edge in the order that decides which edge of a triangle is its longest: both triangles of an edge must agree, also where
/// lengths are equal, or the search for a common longest edge would run in circles.
struct Edge {
    std::int64_t length;  ///< grade() of its square in units of the body's size
    std::int32_t low, high;
    auto operator<=>(const Edge&) const = default;
};

class Bisection {
public:
    Bisection(const TriangleMesh& body, std::vector<std::int32_t> labels) : labels_(std::move(labels)) {
        for (Eigen::Index v = 0; v < body.vertices.rows(); ++v) points_.push_back(body.vertices.row(v));
        for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
            corners_.push_back({body.triangles(t, 0), body.triangles(t, 1), body.triangles(t, 2)});
            for (int c = 0; c < 3; ++c) attach(static_cast<std::int32_t>(t), c);
        }
        squaredSize_ = (body.vertices.colwise().maxCoeff() - body.vertices.colwise().minCoeff()).squaredNorm();
    }

    [[nodiscard]] std::int32_t triangles() const { return static_cast<std::int32_t>(corners_.size()); }
    [[nodiscard]] const Corner& corner(std::int32_t t) const { return corners_[static_cast<std::size_t>(t)]; }
    [[nodiscard]] const Vec3& point(std::int32_t v) const { return points_[static_cast<std::size_t>(v)]; }

    [[nodiscard]] Edge longest(std::int32_t t) const {
        const Corner& c = corner(t);
        return std::max({edge(c[0], c[1]), edge(c[1], c[2]), edge(c[2], c[0])});
    }

    /// The first of the splits that bisecting triangle t takes. Adds one vertex, in the middle of the edge that it returns.
    Edge splitTowards(std::int32_t t) {
        Edge e = longest(t);
        for (std::int32_t at = t;;) {
            at = across(at, e);
            if (at < 0) break;
            const Edge longer = longest(at);
            if (longer == e) break;
            e = longer;
        }
        split(e);
        return e;
    }

    [[nodiscard]] std::int32_t vertices() const { return static_cast<std::int32_t>(points_.size()); }
    /// The triangles that the last split made or changed.
    [[nodiscard]] const std::vector<std::int32_t>& changed() const { return changed_; }

    SolverMesh result(std::size_t faces) const {
        SolverMesh out;
        out.mesh.vertices.resize(static_cast<Eigen::Index>(points_.size()), 3);
        for (std::size_t v = 0; v < points_.size(); ++v) out.mesh.vertices.row(static_cast<Eigen::Index>(v)) = points_[v].transpose();
        out.mesh.triangles.resize(static_cast<Eigen::Index>(corners_.size()), 3);
        out.origin = origin_;
        for (std::size_t t = 0; t < corners_.size(); ++t)
            for (int c = 0; c < 3; ++c) out.mesh.triangles(static_cast<Eigen::Index>(t), c) = corners_[t][static_cast<std::size_t>(c)];
        out.faces = patchesOf(out.mesh.triangles, labels_, faces);
        return out;
    }

private:
    [[nodiscard]] Edge edge(std::int32_t a, std::int32_t b) const {
        return {grade((point(a) - point(b)).squaredNorm() / squaredSize_), std::min(a, b), std::max(a, b)};
    }
    [[nodiscard]] std::int32_t across(std::int32_t t, const Edge& e) const {
        const auto& pair = neighbours_.at(edgeKey(e.low, e.high));
        return pair[0] == t ? pair[1] : pair[0];
    }
    void attach(std::int32_t t, int c) {
        const Corner& k = corner(t);
        auto& pair = neighbours_.try_emplace(edgeKey(k[static_cast<std::size_t>(c)], k[static_cast<std::size_t>((c + 1) % 3)]),
                                             std::array<std::int32_t, 2>{-1, -1})
                         .first->second;
        (pair[0] < 0 ? pair[0] : pair[1]) = t;
    }
    void replace(std::int32_t a, std::int32_t b, std::int32_t from, std::int32_t to) {
        auto& pair = neighbours_.at(edgeKey(a, b));
        (pair[0] == from ? pair[0] : pair[1]) = to;
    }

    /// Puts a vertex in the middle of an edge that is the longest of all its triangles.
    void split(const Edge& e) {
        const auto middle = static_cast<std::int32_t>(points_.size());
        points_.push_back(0.5 * (point(e.low) + point(e.high)));
        origin_.push_back({{e.low, e.high, e.low}, {0.5, 0.5, 0.0}});
        changed_.clear();
        const auto pair = neighbours_.at(edgeKey(e.low, e.high));
        neighbours_.erase(edgeKey(e.low, e.high));
        for (const std::int32_t t : pair) {
            if (t < 0) continue;
            Corner& k = corners_[static_cast<std::size_t>(t)];
            std::size_t c = 0;
            while (edgeKey(k[c], k[(c + 1) % 3]) != edgeKey(e.low, e.high)) ++c;
            const std::int32_t a = k[c], b = k[(c + 1) % 3], apex = k[(c + 2) % 3];
            const auto half = static_cast<std::int32_t>(corners_.size());
            k = {a, middle, apex};
            corners_.push_back({middle, b, apex});
            changed_.push_back(t);
            changed_.push_back(half);
            labels_.push_back(labels_[static_cast<std::size_t>(t)]);
            replace(b, apex, t, half);
            for (const auto& [p, q, owner] : {std::tuple{a, middle, t}, {middle, b, half}, {middle, apex, t}, {middle, apex, half}}) {
                auto& entry = neighbours_.try_emplace(edgeKey(p, q), std::array<std::int32_t, 2>{-1, -1}).first->second;
                (entry[0] < 0 ? entry[0] : entry[1]) = owner;
            }
        }
    }

    double squaredSize_ = 1.0;
    std::vector<Vec3> points_;
    std::vector<Corner> corners_;
    std::vector<std::int32_t> labels_;  ///< joint face of each triangle, -1: free
    std::vector<SolverMesh::Origin> origin_;
    std::vector<std::int32_t> changed_;
    std::unordered_map<std::uint64_t, std::array<std::int32_t, 2>> neighbours_;
};

std::vector<std::int32_t> labelsOf(const TriangleMesh& body, std::span<const JointFace> faces) {
    std::vector<std::int32_t> labels(static_cast<std::size_t>(body.triangles.rows()), -1);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const std::int32_t t : faces[f].triangles) labels[static_cast<std::size_t>(t)] = static_cast<std::int32_t>(f);
    return labels;
}

/// Surfaces that meet at less than this from flat are one smooth surface drawn with triangles: refining at their edges would refine everywhere.
constexpr double kSharp = std::numbers::pi / 6.0;

/// Away from a singular edge the wanted size may be this times the distance from it.
constexpr double kSizeGrading = 0.6;

std::vector<SingularEdge> singularEdgesOf(const TriangleMesh& body, const std::vector<std::int32_t>& labels) {
    std::vector<SingularEdge> out;
    const EdgeTable edges(body.triangles);
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() != 2) continue;
        const std::int32_t s = uses[0].triangle, t = uses[1].triangle;
        const auto sFace = labels[static_cast<std::size_t>(s)], tFace = labels[static_cast<std::size_t>(t)];
        bool singular = sFace != tFace;
        if (!singular && sFace < 0) {
            const Vec3 m = areaVector(body, s), n = areaVector(body, t);
            const Vec3 apex = body.vertices.row(body.triangles(t, (uses[1].corner + 2) % 3)) - body.vertices.row(uses[1].low);
            singular = m.dot(apex) > 0.0 && m.dot(n) < (std::cos(kSharp) - kTie) * m.norm() * n.norm();
        }
        if (singular) out.push_back({uses[0].low, uses[0].high, std::max(sFace, tFace)});
    }
    return out;
}

/// The same, as triangles without area.
TriangleMesh singularSegments(const TriangleMesh& body, const std::vector<std::int32_t>& labels) {
    const std::vector<SingularEdge> found = singularEdgesOf(body, labels);
    TriangleMesh segments;
    segments.vertices = body.vertices;
    segments.triangles.resize(static_cast<Eigen::Index>(found.size()), 3);
    for (std::size_t i = 0; i < found.size(); ++i) segments.triangles.row(static_cast<Eigen::Index>(i)) << found[i].low, found[i].high, found[i].high;
    return segments;
}

}  // namespace

std::vector<SingularEdge> singularEdges(const SolverMesh& mesh) { return singularEdgesOf(mesh.mesh, MeshPieces(mesh).face); }

std::vector<SolverMesh::Patch> patchesOf(const Triangles& triangles, std::span<const std::int32_t> face, std::size_t count) {
    std::vector<SolverMesh::Patch> out(count);
    for (std::int32_t t = 0; t < triangles.rows(); ++t) {
        if (face[static_cast<std::size_t>(t)] < 0) continue;
        auto& patch = out[static_cast<std::size_t>(face[static_cast<std::size_t>(t)])];
        patch.triangles.push_back(t);
        for (int c = 0; c < 3; ++c) patch.vertices.push_back(triangles(t, c));
    }
    for (auto& patch : out) {
        std::sort(patch.vertices.begin(), patch.vertices.end());
        patch.vertices.erase(std::unique(patch.vertices.begin(), patch.vertices.end()), patch.vertices.end());
    }
    return out;
}

SolverMesh plainSolverMesh(const TriangleMesh& body, std::span<const JointFace> faces) {
    return {body, patchesOf(body.triangles, labelsOf(body, faces), faces.size()), {}, {}};
}

SolverMesh halvedAtBubbles(const SolverMesh& mesh) {
    MeshPieces pieces(mesh);
    std::vector<std::array<std::int32_t, 3>> corners;
    std::vector<std::int32_t> face;
    corners.swap(pieces.corners);
    face.swap(pieces.face);
    const EdgeTable edges(mesh.mesh.triangles);
    std::vector<std::int32_t> middle(static_cast<std::size_t>(edges.size()), -1);
    std::size_t next = 0;  // both lists ascend
    for (int e = 0; e < edges.size() && next < mesh.bubbles.size(); ++e) {
        const EdgeUse& use = edges.uses(e)[0];
        if (mesh.bubbles[next] != std::array<std::int32_t, 2>{use.low, use.high}) continue;
        middle[static_cast<std::size_t>(e)] = pieces.add({use.low, use.high, use.low}, {0.5, 0.5, 0.0});
        ++next;
    }
    for (std::size_t t = 0; t < corners.size(); ++t) {
        std::array<std::int32_t, 3> m{};
        for (std::size_t c = 0; c < 3; ++c) m[c] = middle[static_cast<std::size_t>(edges.edgeOf(static_cast<std::int32_t>(t), static_cast<int>(c)))];
        pieces.halved(corners[t], m, face[t]);
    }
    return pieces.joined(mesh.faces.size());
}

Result<SolverMesh> refinedSolverMesh(const TriangleMesh& body, std::span<const JointFace> faces, int vertices) {
    if (vertices < body.vertices.rows())
        return fail("too-few-vertices", "The body has " + std::to_string(body.vertices.rows()) + " vertices, and refining cannot make that " +
                                            std::to_string(vertices) + "; use \"decimated:" + std::to_string(vertices) + "\" or a larger number.");
    if (vertices > SolverMeshSetting::kMax)
        return fail("bad-value", "A solver mesh has at most " + std::to_string(SolverMeshSetting::kMax) + " vertices; choose a smaller number.");
    const double area = surfaceArea(body);
    if (!(area > 0.0)) return fail("bad-value", "The body has no surface to refine; repair it first.");

    std::vector<std::int32_t> labels = labelsOf(body, faces);
    const TriangleMesh singular = singularSegments(body, labels);
    std::optional<TriangleTree> nearestEdge;
    if (singular.triangles.rows() > 0) nearestEdge.emplace(singular);

    // The edge of equal equilateral triangles, two per vertex, that cover the surface.
    const double uniform = std::sqrt(2.0 * area / (std::sqrt(3.0) * vertices));
    Bisection mesh(body, std::move(labels));
    std::vector<double> wanted;  // per vertex, relative to the size elsewhere
    const auto addWanted = [&](std::int32_t v) {
        double relative = 1.0;
        if (nearestEdge) relative = kSizeGrading * std::sqrt(nearestEdge->nearest(mesh.point(v)).squaredDistance) / uniform;
        wanted.push_back(std::clamp(relative, kFinestRefined, 1.0));
    };
    for (std::int32_t v = 0; v < mesh.vertices(); ++v) addWanted(v);

    struct Entry {
        std::int64_t excess;  // grade() of the longest edge over the wanted size, squared
        std::int32_t triangle;
        Edge longest;         // as it was when the entry was made; a triangle that has changed since has an entry of its own
        // Of equal ones in a scattered order: where the vertices do not suffice for all of them, the rest lies everywhere rather than in one half.
        [[nodiscard]] std::uint32_t turn() const { return static_cast<std::uint32_t>(triangle) * 2654435769u; }  // Knuth's golden ratio: one to one
        bool operator<(const Entry& o) const { return excess < o.excess || (excess == o.excess && turn() > o.turn()); }
    };
    std::priority_queue<Entry> queue;
    const auto push = [&](std::int32_t t) {
        double size = 1.0;
        for (const std::int32_t v : mesh.corner(t)) size = std::min(size, wanted[static_cast<std::size_t>(v)]);
        const Edge longest = mesh.longest(t);
        queue.push({longest.length - grade(size * size), t, longest});
    };
    for (std::int32_t t = 0; t < mesh.triangles(); ++t) push(t);
    while (mesh.vertices() < vertices && !queue.empty()) {
        const Entry top = queue.top();
        if (mesh.longest(top.triangle) != top.longest) {
            queue.pop();
            continue;
        }
        mesh.splitTowards(top.triangle);  // where that is another edge, the entry stays for the next round
        addWanted(mesh.vertices() - 1);
        for (const std::int32_t t : mesh.changed()) push(t);
    }
    return mesh.result(faces.size());
}

SolverMesh bisectedTo(const TriangleMesh& body, std::vector<std::int32_t> face, std::size_t count, std::vector<double> longest, const std::function<double(const Vec3&)>& between) {
    Bisection mesh(body, std::move(face));
    const auto tooLong = [&](std::int32_t t) {
        const Edge e = mesh.longest(t);
        double wanted = std::numeric_limits<double>::infinity();
        for (const std::int32_t v : mesh.corner(t)) wanted = std::min(wanted, longest[static_cast<std::size_t>(v)]);
        return (mesh.point(e.low) - mesh.point(e.high)).norm() > (1.0 + kTie) * wanted;
    };
    std::vector<std::int32_t> open;
    for (std::int32_t t = mesh.triangles() - 1; t >= 0; --t)
        if (tooLong(t)) open.push_back(t);
    while (!open.empty()) {
        const std::int32_t t = open.back();
        if (!tooLong(t)) {
            open.pop_back();
            continue;
        }
        const Edge halved = mesh.splitTowards(t);
        const double mean = 0.5 * (longest[static_cast<std::size_t>(halved.low)] + longest[static_cast<std::size_t>(halved.high)]);
        longest.push_back(between ? std::max(mean, between(mesh.point(mesh.vertices() - 1))) : mean);
        for (const std::int32_t changed : mesh.changed())
            if (changed != t && tooLong(changed)) open.push_back(changed);
    }
    return mesh.result(count);
}

}  // namespace imomushi
