// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <array>
#include <unordered_map>
#include <utility>

#include "core/mesh/cgal/fill_hole.h"
#include "core/mesh/edge_key.h"
#include "core/mesh/mend_surface.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

/// Largest cap relative to the surface it closes. A hemisphere needs 0.5; a sheet would be closed by its own mirror image, 1.
constexpr double kLargestCap = 0.75;

/// Render vertices of a cap: as those on the rim, with normals of the cap.
std::vector<std::int32_t> renderCap(MendSurface& s, const std::vector<std::int32_t>& loop, const std::vector<std::array<std::int32_t, 3>>& cap,
                                    const std::vector<std::int32_t>& rim) {
    Points normals = Points::Zero(static_cast<Eigen::Index>(loop.size()), 3);
    for (const auto& t : cap) {
        const Vec3 a = s.points.row(loop[at(t[0])]), b = s.points.row(loop[at(t[1])]), c = s.points.row(loop[at(t[2])]);
        for (const std::int32_t k : t) normals.row(k) += (b - a).cross(c - a).transpose();
    }
    std::vector<std::int32_t> render(loop.size());
    const Eigen::Index first = s.renderMesh.normals.rows();
    const auto extra = static_cast<Eigen::Index>(loop.size());
    s.renderMesh.normals.conservativeResize(first + extra, 3);
    if (s.renderMesh.texCoords.rows() > 0) s.renderMesh.texCoords.conservativeResize(first + extra, 2);
    if (s.renderMesh.colors.rows() > 0) s.renderMesh.colors.conservativeResize(first + extra, 4);
    for (Eigen::Index i = 0; i < extra; ++i) {
        const double n = normals.row(i).norm();
        s.renderMesh.normals.row(first + i) =
            n > 0.0 ? Eigen::RowVector3f((normals.row(i) / n).cast<float>()) : Eigen::RowVector3f(s.renderMesh.normals.row(rim[static_cast<std::size_t>(i)]));
        if (s.renderMesh.texCoords.rows() > 0) s.renderMesh.texCoords.row(first + i) = s.renderMesh.texCoords.row(rim[static_cast<std::size_t>(i)]).eval();
        if (s.renderMesh.colors.rows() > 0) s.renderMesh.colors.row(first + i) = s.renderMesh.colors.row(rim[static_cast<std::size_t>(i)]).eval();
        render[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(first + i);
    }
    return render;
}

}  // namespace

void capHoles(MendSurface& s) {
    Triangles triangles = s.triangles();
    EdgeTable edges(triangles);
    const auto loops = boundaryLoops(edges);
    if (loops.empty()) return;
    const Attempt closing("caps over holes");
    if (!closing) return;
    int count = 0;
    const std::vector<std::int32_t> component = edgeComponents(triangles, edges, count);
    std::vector<double> area(at(count), 0.0), capArea(at(count), 0.0);
    const auto doubleArea = [&](const std::array<std::int32_t, 3>& t) -> Vec3 {
        const Vec3 a = s.points.row(t[0]);
        return (s.points.row(t[1]).transpose() - a).cross(s.points.row(t[2]).transpose() - a);
    };
    for (std::size_t f = 0; f < s.faces.size(); ++f) area[at(component[f])] += doubleArea(s.faces[f].v).norm();
    // The triangle at each open side, by the direction in which a cap runs along it.
    std::unordered_map<std::uint64_t, std::pair<std::int32_t, std::int8_t>> sideAt;
    for (int e = 0; e < edges.size(); ++e)
        if (const auto uses = edges.uses(e); uses.size() == 1)
            sideAt[uses[0].forward ? sideKey(uses[0].high, uses[0].low) : sideKey(uses[0].low, uses[0].high)] = {uses[0].triangle, uses[0].corner};

    const std::size_t before = s.faces.size();
    std::vector<std::int32_t> capOf;  // per added face: the component it closes
    std::vector<int> capsOf(at(count), 0);
    for (const auto& loop : loops) {
        if (loop.size() < 3) continue;
        Points polygon(static_cast<Eigen::Index>(loop.size()), 3);
        for (std::size_t i = 0; i < loop.size(); ++i) polygon.row(static_cast<Eigen::Index>(i)) = s.points.row(loop[i]);
        const auto cap = triangulateHole(polygon);
        if (cap.size() != loop.size() - 2) continue;
        const auto [neighbour, firstCorner] = sideAt.at(sideKey(loop[0], loop[1]));
        const std::int32_t c = component[at(neighbour)];
        std::vector<std::int32_t> render(loop.size());
        for (std::size_t i = 0; i < loop.size(); ++i) {
            // The side runs from loop[i+1] to loop[i] in its triangle: loop[i] is the corner after.
            const auto [f, k] = sideAt.at(sideKey(loop[i], loop[(i + 1) % loop.size()]));
            render[i] = s.faces[at(f)].r[static_cast<std::size_t>((k + 1) % 3)];
        }
        if (s.renderMesh.normals.rows() > 0) render = renderCap(s, loop, cap, render);
        for (const auto& t : cap) {
            MendFace face;
            for (std::size_t k = 0; k < 3; ++k) {
                face.v[k] = loop[at(t[k])];
                face.r[k] = render[at(t[k])];
            }
            face.material = s.faces[at(neighbour)].material;
            face.part = s.faces[at(neighbour)].part;
            capArea[at(c)] += doubleArea(face.v).norm();
            s.faces.push_back(face);
            capOf.push_back(c);
        }
        ++capsOf[at(c)];
    }
    if (s.faces.size() == before) return;
    triangles = s.triangles();
    edges = EdgeTable(triangles);
    int newCount = 0;
    const std::vector<std::int32_t> newComponent = edgeComponents(triangles, edges, newCount);
    const std::vector<char> sound = soundComponents(triangles, edges, newComponent, newCount);
    std::vector<char> keep(at(count), 1);
    for (std::size_t i = 0; i < capOf.size(); ++i) {
        const auto c = at(capOf[i]);
        if (!sound[at(newComponent[before + i])] || capArea[c] > kLargestCap * area[c]) keep[c] = 0;
    }
    std::size_t i = 0, holes = 0;
    std::erase_if(s.faces, [&](const MendFace&) {
        const std::size_t f = i++;
        return f >= before && !keep[at(capOf[f - before])];
    });
    for (std::size_t c = 0; c < capsOf.size(); ++c)
        if (keep[c]) holes += at(capsOf[c]);
    if (holes > 0) s.say("open", counted(holes, "hole was", "holes were") + " closed with a cap.", holes);
}

}  // namespace imomushi
