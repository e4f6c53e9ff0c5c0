// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <unordered_set>

#include "core/body/prepared_surface.h"
#include "core/base/index.h"
#include "core/mesh/cgal/fill_hole.h"
#include "core/mesh/edge_key.h"

namespace imomushi {
namespace {

/// Largest caps relative to the surface that they close, as in capHoles(): a sheet would be closed by its own mirror image, 1.
constexpr double kLargestCap = 0.75;


double capArea(const Points& points, const std::vector<std::array<std::int32_t, 3>>& cap) {
    double area = 0.0;
    for (const auto& t : cap) {
        const Vec3 a = points.row(t[0]), b = points.row(t[1]), c = points.row(t[2]);
        area += 0.5 * (b - a).cross(c - a).norm();
    }
    return area;
}

}  // namespace

void closeHoles(MendSurface& s) {
    const Triangles triangles = s.triangles();
    const EdgeTable edges(triangles);
    const auto loops = boundaryLoops(edges);
    if (loops.empty()) return;
    int count = 0;
    const std::vector<std::int32_t> component = edgeComponents(triangles, edges, count);
    std::vector<double> area(at(count), 0.0), covered(at(count), 0.0);
    const TriangleMesh all{s.points, triangles};
    for (std::int32_t f = 0; f < triangles.rows(); ++f) area[at(component[at(f)])] += 0.5 * areaVector(all, f).norm();
    std::unordered_set<std::uint64_t> known;
    std::vector<std::int32_t> componentOf(static_cast<std::size_t>(s.points.rows()), -1), faceOf(componentOf.size(), -1);
    for (std::int32_t f = 0; f < triangles.rows(); ++f)
        for (int k = 0; k < 3; ++k) {
            known.insert(edgeKey(triangles(f, k), triangles(f, (k + 1) % 3)));
            componentOf[at(triangles(f, k))] = component[at(f)];
            faceOf[at(triangles(f, k))] = f;
        }
    std::vector<Vec3> middles;
    std::size_t closed = 0;
    for (const auto& loop : loops) {
        const auto n = static_cast<std::int32_t>(loop.size());
        if (n < 3) continue;
        Points polygon(n + 1, 3);
        for (std::int32_t i = 0; i < n; ++i) polygon.row(i) = s.points.row(loop[at(i)]);
        polygon.row(n) = polygon.topRows(n).colwise().mean();
        auto cap = triangulateHole(polygon.topRows(n));
        bool taken = cap.size() != loop.size() - 2;
        for (const auto& t : cap)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t a = t[k], b = t[(k + 1) % 3];
                const bool rim = (a + 1) % n == b || (b + 1) % n == a;
                taken = taken || (!rim && known.contains(edgeKey(loop[at(a)], loop[at(b)])));
            }
        if (taken) {  // a chord would be an edge of more than two triangles: a fan around a new vertex has none
            cap.clear();
            for (std::int32_t i = 0; i < n; ++i) cap.push_back({i, (i + 1) % n, n});
        }
        const std::size_t c = at(componentOf[at(loop[0])]);
        const double more = capArea(polygon, cap);
        if (covered[c] + more > kLargestCap * area[c]) continue;
        covered[c] += more;
        ++closed;
        const auto middle = static_cast<std::int32_t>(s.points.rows() + static_cast<Eigen::Index>(middles.size()));
        if (taken) middles.emplace_back(polygon.row(n));
        const MendFace& beside = s.faces[at(faceOf[at(loop[0])])];
        MendFace face;
        face.material = beside.material;
        face.part = beside.part;
        face.r = {-1, -1, -1};
        for (const auto& t : cap) {
            for (std::size_t k = 0; k < 3; ++k) face.v[k] = t[k] < n ? loop[at(t[k])] : middle;
            for (std::size_t k = 0; k < 3; ++k) known.insert(edgeKey(face.v[k], face.v[(k + 1) % 3]));
            s.faces.push_back(face);
        }
    }
    const Eigen::Index first = s.points.rows();
    s.points.conservativeResize(first + static_cast<Eigen::Index>(middles.size()), 3);
    for (std::size_t i = 0; i < middles.size(); ++i) s.points.row(first + static_cast<Eigen::Index>(i)) = middles[i].transpose();
    if (closed > 0) s.say("open", counted(closed, "hole was", "holes were") + " closed with a cap.", closed);
}

}  // namespace imomushi
