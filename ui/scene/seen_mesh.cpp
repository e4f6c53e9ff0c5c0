// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/seen_mesh.h"

#include <algorithm>
#include <map>

#include "core/character/deform_input.h"
#include "core/document/character_input.h"

namespace imomushi {

namespace {

/// The rows `which` of a matrix that has a row per render vertex; nothing of one that is empty.
template <class Matrix>
Matrix rowsOf(const Matrix& all, const std::vector<std::int32_t>& which, Eigen::Index count) {
    Matrix out(all.rows() == count ? static_cast<Eigen::Index>(which.size()) : 0, all.cols());
    for (Eigen::Index i = 0; i < out.rows(); ++i) out.row(i) = all.row(which[static_cast<std::size_t>(i)]);
    return out;
}

/// The numbers of `used`, ascending and once, and per entry of `used` its place among them. `count`: of all there are.
std::vector<std::int32_t> compact(Triangles& used, Eigen::Index count) {
    std::vector<std::int32_t> place(static_cast<std::size_t>(count), -1), kept;
    for (Eigen::Index i = 0; i < used.size(); ++i) place[static_cast<std::size_t>(used.data()[i])] = 0;
    for (std::size_t v = 0; v < place.size(); ++v)
        if (place[v] == 0) {
            place[v] = static_cast<std::int32_t>(kept.size());
            kept.push_back(static_cast<std::int32_t>(v));
        }
    for (Eigen::Index i = 0; i < used.size(); ++i) used.data()[i] = place[static_cast<std::size_t>(used.data()[i])];
    return kept;
}

Triangles rowsOf(const Triangles& all, const std::vector<std::int32_t>& which) {
    Triangles out(static_cast<Eigen::Index>(which.size()), 3);
    for (std::size_t i = 0; i < which.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = all.row(which[i]);
    return out;
}

void fill(RenderPart& part, const ElementMesh& whole) {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body.triangles = rowsOf(whole.body.triangles, part.triangles);
    part.vertices = compact(mesh->body.triangles, whole.body.vertices.rows());
    mesh->body.vertices = rowsOf(whole.body.vertices, part.vertices, whole.body.vertices.rows());

    const RenderMesh& from = whole.renderMesh;
    RenderMesh& to = mesh->renderMesh;
    const auto count = static_cast<Eigen::Index>(from.bodyVertex.size());
    if (from.triangles.rows() == whole.body.triangles.rows() && count > 0) {
        to.triangles = rowsOf(from.triangles, part.triangles);
        const auto corners = compact(to.triangles, count);
        for (const std::int32_t r : corners) {
            const auto at = std::lower_bound(part.vertices.begin(), part.vertices.end(), from.bodyVertex[static_cast<std::size_t>(r)]);
            to.bodyVertex.push_back(static_cast<std::int32_t>(at - part.vertices.begin()));
        }
        to.normals = rowsOf(from.normals, corners, count);
        to.texCoords = rowsOf(from.texCoords, corners, count);
        to.colors = rowsOf(from.colors, corners, count);
        if (from.material.size() == static_cast<std::size_t>(from.triangles.rows()))
            for (const std::int32_t t : part.triangles) to.material.push_back(from.material[static_cast<std::size_t>(t)]);
        to.materials = from.materials;
    }
    part.mesh = std::move(mesh);
}

}  // namespace

PartId SeenMesh::elementOf(std::int32_t triangle) const {
    const auto& corners = model().mesh.body.triangles;
    const PartId a = elementOfVertex(corners(triangle, 0)), b = elementOfVertex(corners(triangle, 1)), c = elementOfVertex(corners(triangle, 2));
    return b == c ? b : a;
}

std::vector<SeenMesh> seenMeshes(const Session& session, const DeformInput* drawnFrom) {
    std::vector<SeenMesh> all;
    Character* character = session.character();
    const CharacterPlan& plan = session.plan();
    for (const auto& [id, source] : session.document().characters) {
        SeenMesh seen;
        seen.source = source;
        const auto at = character ? std::find(plan.characters.begin(), plan.characters.end(), id) : plan.characters.end();
        if (at != plan.characters.end()) {
            seen.index = static_cast<int>(at - plan.characters.begin());
            const auto index = static_cast<std::size_t>(seen.index);
            if (!drawnFrom || !drawnFrom->external(drawnFrom->meshes[index])) seen.surface = character->renderSurface(seen.index);
            seen.embedded = character->input().renderMeshes[index];
            seen.elements = plan.elements;
        } else {
            seen.elements = session.document().elementsOf(id);
        }
        if (!seen.elements.empty()) all.push_back(std::move(seen));
    }
    return all;
}

std::vector<RenderPart> renderParts(const SeenMesh& seen, const std::vector<RenderPart>& known) {
    std::map<PartId, RenderPart> parts;
    for (std::int32_t t = 0; t < seen.model().mesh.body.triangles.rows(); ++t) parts[seen.elementOf(t)].triangles.push_back(t);
    std::vector<RenderPart> out;
    for (auto& [element, part] : parts) {
        part.element = element;
        const auto before = std::find_if(known.begin(), known.end(), [id = element](const RenderPart& k) { return k.element == id; });
        if (before != known.end() && before->triangles == part.triangles)
            out.push_back(*before);
        else
            fill(out.emplace_back(std::move(part)), seen.model().mesh);
    }
    return out;
}

}  // namespace imomushi
