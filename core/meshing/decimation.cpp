// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/decimation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/finite.h"
#include "core/base/index.h"
#include "core/mesh/bounds.h"
#include "core/mesh/cgal/intersections.h"
#include "core/meshing/edge_collapse.h"

namespace imomushi {
namespace {

using Index = std::int32_t;

/// How often the edges of triangles that intersect others are halved. After that they are shorter than 1/4000 of what they were.
constexpr int kRounds = 12;

/// Intersections that are looked at in one round.
constexpr std::size_t kPairs = 100000;

TriangleMesh meshOf(const LabelledSurface& surface) {
    TriangleMesh mesh;
    mesh.vertices.resize(static_cast<Eigen::Index>(surface.points.size()), 3);
    mesh.triangles.resize(static_cast<Eigen::Index>(surface.corners.size()), 3);
    for (std::size_t v = 0; v < surface.points.size(); ++v) mesh.vertices.row(static_cast<Eigen::Index>(v)) = surface.points[v].transpose();
    for (std::size_t t = 0; t < surface.corners.size(); ++t)
        for (int c = 0; c < 3; ++c) mesh.triangles(static_cast<Eigen::Index>(t), c) = surface.corners[t][static_cast<std::size_t>(c)];
    return mesh;
}

/// The edge of equal equilateral triangles, two per vertex, that cover the surface.
double uniformEdge(const LabelledSurface& surface, int vertices) {
    double area = 0.0;
    for (const auto& [a, b, c] : surface.corners)
        area += 0.5 * (surface.points[at(b)] - surface.points[at(a)]).cross(surface.points[at(c)] - surface.points[at(a)]).norm();
    return std::sqrt(2.0 * area / (std::sqrt(3.0) * vertices));
}

double volumeOf(const LabelledSurface& surface) {
    double volume = 0.0;
    for (const auto& [a, b, c] : surface.corners) volume += surface.points[at(a)].dot(surface.points[at(b)].cross(surface.points[at(c)])) / 6.0;
    return volume;
}

/// Whether those triangles of `surface` that were collapsed into the marked vertices intersect themselves.
bool intersectsAt(const LabelledSurface& surface, const std::vector<Index>& number, const std::vector<char>& marked,
                  const Progress& progress) {
    LabelledSurface part;
    part.points = surface.points;
    for (const auto& k : surface.corners)
        if (marked[at(number[at(k[0])])] || marked[at(number[at(k[1])])] || marked[at(number[at(k[2])])]) part.corners.push_back(k);
    return !selfIntersections(meshOf(part), 1, progress).empty();
}

}  // namespace

Result<DecimatedBody> decimate(const TriangleMesh& body, std::span<const JointFace> faces, int vertices, const Progress& progress,
                               std::span<const double> rimTolerance, std::span<const double> longest, double most) {
    const std::string count = std::to_string(body.vertices.rows());
    if (vertices < 4) return fail("bad-value", "A closed surface has at least 4 vertices; choose a larger number.");
    if (vertices > body.vertices.rows())
        return fail("too-many-vertices", "The body has only " + count + " vertices, and decimating cannot make that " + std::to_string(vertices) +
                                             "; use \"refined:" + std::to_string(vertices) + "\" or a smaller number.");
    if (!allFinite(body.vertices))
        return fail("bad-value", "The body has vertices that are not numbers; repair it first.");
    const Bounds bounds = boundsOf(body.vertices);
    const Vec3 middle = 0.5 * bounds.low + 0.5 * bounds.high;
    const double diagonal = bounds.diagonal();
    if (!(diagonal > 0.0) || !std::isfinite(diagonal)) return fail("bad-value", "The body has no size; repair it first.");

    LabelledSurface start;
    start.points.reserve(at(static_cast<Index>(body.vertices.rows())));
    for (Index v = 0; v < body.vertices.rows(); ++v) {
        start.points.emplace_back((body.vertices.row(v).transpose() - middle) / diagonal);
        start.place.push_back(v);
    }
    if (progress.cancelled()) return fail(kCancelled, "Decimating was cancelled.");
    start.corners.reserve(at(static_cast<Index>(body.triangles.rows())));
    for (Index t = 0; t < body.triangles.rows(); ++t) {
        for (int c = 0; c < 3; ++c)
            if (body.triangles(t, c) < 0 || body.triangles(t, c) >= body.vertices.rows())
                return fail("bad-value", "A triangle of the body names a vertex that does not exist; repair it first.");
        start.corners.push_back({body.triangles(t, 0), body.triangles(t, 1), body.triangles(t, 2)});
    }
    start.label.assign(start.corners.size(), -1);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const Index t : faces[f].triangles) start.label[at(t)] = static_cast<Index>(f);

    std::vector<double> tolerance;
    for (std::size_t f = 0; f < faces.size(); ++f) tolerance.push_back(rimTolerance.empty() ? 0.0 : rimTolerance[f] * std::sqrt(faces[f].area) / diagonal);
    std::vector<double> size(longest.begin(), longest.end());
    for (double& length : size) length /= diagonal;
    const double uniform = uniformEdge(start, vertices);
    constexpr double kUnlimited = std::numeric_limits<double>::infinity();
    std::vector<double> limit(start.points.size(), kUnlimited);
    LabelledSurface surface;
    for (int round = 0;; ++round) {
        std::vector<Index> number;
        {
            EdgeCollapse collapse(start, limit, uniform, tolerance, size);
            const bool connected = collapse.connect(progress);
            if (progress.cancelled()) return fail(kCancelled, "Decimating was cancelled.");
            if (!connected) return fail("not-closed", "The body is not closed, or touches itself at an edge or a vertex; repair it first.");
            if (!collapse.run(vertices, progress)) return fail(kCancelled, "Decimating was cancelled.");
            surface = collapse.result(number);
        }
        const auto pairs = selfIntersections(meshOf(surface), kPairs, progress);
        if (progress.cancelled()) return fail(kCancelled, "Decimating was cancelled.");
        if (pairs.empty()) break;
        std::vector<char> marked(surface.points.size(), 0);
        std::vector<double> shorter(surface.points.size(), kUnlimited);
        for (const auto& [s, t] : pairs) {
            double side = 0.0;
            for (const Index f : {s, t})
                for (std::size_t c = 0; c < 3; ++c)
                    side = std::max(side, (surface.points[at(surface.corners[at(f)][c])] - surface.points[at(surface.corners[at(f)][(c + 1) % 3])]).norm());
            for (const Index f : {s, t})
                for (const Index v : surface.corners[at(f)]) {
                    marked[at(v)] = 1;
                    shorter[at(v)] = std::min(shorter[at(v)], 0.5 * side);
                }
        }
        const bool before = intersectsAt(start, number, marked, progress);
        if (progress.cancelled()) return fail(kCancelled, "Decimating was cancelled.");
        if (round == kRounds || before)
            return fail("self-intersecting", "The body intersects itself or nearly does, so that no body of fewer vertices near it is free of that; "
                                             "repair it, or use \"as-is\".");
        for (std::size_t v = 0; v < limit.size(); ++v) limit[v] = std::min(limit[v], shorter[at(number[v])]);
    }
    if (static_cast<double>(surface.points.size()) > most * vertices)
        return fail("too-few-vertices", "The body cannot be decimated to " + std::to_string(vertices) +
                                            " vertices without moving the rims of its joint faces or letting thin walls touch; the smallest is about \"decimated:" +
                                            std::to_string(surface.points.size()) + "\".");

    DecimatedBody out;
    out.mesh = meshOf(surface);
    out.bodyVertex = surface.place;
    for (std::size_t v = 0; v < surface.points.size(); ++v) {
        const auto row = static_cast<Eigen::Index>(v);
        out.mesh.vertices.row(row) = (middle + diagonal * surface.points[v]).transpose();
        if (surface.place[v] >= 0) out.mesh.vertices.row(row) = body.vertices.row(surface.place[v]);
    }
    out.faces.assign(faces.begin(), faces.end());
    for (JointFace& face : out.faces) face.vertices.clear(), face.triangles.clear();
    for (std::size_t t = 0; t < surface.corners.size(); ++t) {
        if (surface.label[t] < 0) continue;
        JointFace& face = out.faces[at(surface.label[t])];
        face.triangles.push_back(static_cast<Index>(t));
        face.vertices.insert(face.vertices.end(), surface.corners[t].begin(), surface.corners[t].end());
    }
    for (JointFace& face : out.faces) {
        std::sort(face.vertices.begin(), face.vertices.end());
        face.vertices.erase(std::unique(face.vertices.begin(), face.vertices.end()), face.vertices.end());
    }
    const double before = volumeOf(start);
    out.volumeError = before != 0.0 ? volumeOf(surface) / before - 1.0 : 0.0;
    return out;
}

}  // namespace imomushi
