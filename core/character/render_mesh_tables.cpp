// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/render_mesh_tables.h"

#include <algorithm>
#include <numeric>

#include "core/character/normal_stencils.h"
#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"

namespace imomushi {

namespace {

constexpr std::size_t kVerticesOfPiece = 2048;

/// Per vertex the one that stands for its smoothing group.
std::vector<std::int32_t> smoothingGroups(const EmbeddedMesh& mesh, const Points& rest) {
    const std::size_t count = mesh.vertices.size();
    const auto place = weldExact(rest, std::vector<char>(count, 1), {});
    const bool given = mesh.normals.rows() > 0;
    const Points normals = given ? Points(mesh.normals.cast<double>().rowwise().normalized()) : vertexNormals({rest, mesh.triangles});
    const double same = given ? RenderMeshTables::kSameNormal : RenderMeshTables::kCrease;
    std::vector<std::int32_t> order(count), group(count);
    std::iota(order.begin(), order.end(), 0);
    const auto placeOf = [&place](std::int32_t v) { return place[static_cast<std::size_t>(v)]; };
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return placeOf(a) < placeOf(b); });
    std::vector<std::int32_t> groups;  // of one place: they are few, as no two have the same normal
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t v = order[i];
        if (i == 0 || placeOf(v) != placeOf(order[i - 1])) groups.clear();
        const bool any = normals.row(v).squaredNorm() == 0.0;  // it has no area, or no normal in the file
        const auto found = std::find_if(groups.begin(), groups.end(), [&](std::int32_t g) { return any || normals.row(g).dot(normals.row(v)) >= same; });
        group[static_cast<std::size_t>(v)] = found == groups.end() ? groups.emplace_back(v) : *found;
    }
    return group;
}

}  // namespace

std::int32_t elementVertex(const EmbeddedMesh::Vertex& vertex, const ElementRuntime& runtime) {
    if (vertex.onBody) return vertex.index;
    const auto& points = *runtime.input.embedded;
    const auto i = static_cast<std::size_t>(vertex.index);
    if (i < points.bodyVertex.size() && points.bodyVertex[i] >= 0) return points.bodyVertex[i];
    return static_cast<std::int32_t>(runtime.embedded->first + i);
}

std::shared_ptr<const RenderMeshTables> RenderMeshTables::build(std::shared_ptr<const EmbeddedMesh> given,
                                                                std::span<const std::shared_ptr<const ElementRuntime>> runtimes) {
    auto made = std::make_shared<RenderMeshTables>();
    RenderMeshTables& out = *made;
    out.mesh = std::move(given);
    const EmbeddedMesh& mesh = *out.mesh;
    const std::size_t count = mesh.vertices.size();
    out.rest.resize(static_cast<Eigen::Index>(count), 3);
    std::vector<char> used(runtimes.size(), 0);
    for (std::size_t i = 0; i < count; ++i) {
        const auto& v = mesh.vertices[i];
        const auto& runtime = *runtimes[static_cast<std::size_t>(v.element)];
        const Points& from = v.onBody ? runtime.input.mesh->body.vertices : runtime.input.embedded->rest;
        out.rest.row(static_cast<Eigen::Index>(i)) = from.row(v.index);
        used[static_cast<std::size_t>(v.element)] = 1;
        const std::int32_t at = elementVertex(v, runtime);
        const bool goesOn = !out.runs.empty() && out.runs.back().element == v.element && out.runs.back().from + out.runs.back().count == at &&
                            out.runs.back().count < static_cast<std::int32_t>(kVerticesOfPiece);
        if (goesOn)
            ++out.runs.back().count;
        else
            out.runs.push_back({static_cast<std::int32_t>(i), v.element, at, 1});
    }
    for (std::size_t e = 0; e < used.size(); ++e)
        if (used[e]) {
            out.elements.push_back(static_cast<std::int32_t>(e));
            out.sources_.push_back({runtimes[e]->input.mesh, runtimes[e]->input.embedded});
        }
    if (count == 0) return made;

    const double diagonal = diagonalOf(out.rest);
    out.scale = diagonal > 0.0 ? 1.0 / diagonal : 1.0;
    const auto group = smoothingGroups(mesh, out.rest);
    std::vector<std::int32_t> corners(mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size());
    for (auto& c : corners) c = group[static_cast<std::size_t>(c)];
    out.stencils = normalStencils(out.rest, corners, out.scale);
    for (std::size_t i = 0; i < count; ++i) out.stencils[i] = out.stencils[static_cast<std::size_t>(group[i])];
    if (mesh.morphs() > 0) out.morphs = MorphTables::build(mesh, out.rest, out.stencils);
    for (std::size_t begin = 0; begin < count; begin += kVerticesOfPiece) {
        NormalPiece piece{begin, std::min(begin + kVerticesOfPiece, count), {}};
        for (std::size_t i = begin; i < piece.end; ++i) {
            const auto& s = out.stencils[i];
            for (const auto v : {static_cast<std::int32_t>(i), s.a, s.b, s.c, s.d}) {
                const std::int32_t element = mesh.vertices[static_cast<std::size_t>(v)].element;
                const auto at = std::lower_bound(piece.elements.begin(), piece.elements.end(), element);
                if (at == piece.elements.end() || *at != element) piece.elements.insert(at, element);
            }
        }
        out.normalPieces.push_back(std::move(piece));
    }
    return made;
}

bool RenderMeshTables::fits(const std::shared_ptr<const EmbeddedMesh>& other, std::span<const std::shared_ptr<const ElementRuntime>> runtimes) const {
    if (mesh != other) return false;
    for (std::size_t i = 0; i < elements.size(); ++i) {
        const auto e = static_cast<std::size_t>(elements[i]);
        if (e >= runtimes.size() || !(sources_[i] == Source{runtimes[e]->input.mesh, runtimes[e]->input.embedded})) return false;
    }
    return true;
}

}  // namespace imomushi
