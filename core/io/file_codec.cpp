// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/file_codec.h"

#include <algorithm>
#include <cmath>

#include "core/base/finite.h"
#include "core/mesh/bounds.h"

namespace imomushi {
namespace {

/// Whether all are in [0, end).
bool inRange(const std::vector<std::int32_t>& indices, Eigen::Index end) {
    return std::all_of(indices.begin(), indices.end(), [&](std::int32_t i) { return i >= 0 && i < end; });
}

bool inRange(const Triangles& t, Eigen::Index end) { return t.rows() == 0 || (t.minCoeff() >= 0 && t.maxCoeff() < end); }

/// `triangles`, `vertices`: how many there are to refer to.
bool inRange(const std::vector<MeshIssue>& issues, Eigen::Index triangles, Eigen::Index vertices) {
    return std::all_of(issues.begin(), issues.end(), [&](const MeshIssue& i) { return inRange(i.triangles, triangles) && inRange(i.vertices, vertices); });
}

bool usable(const RenderMesh& render, const TriangleMesh& body) {
    const auto renderVertices = static_cast<Eigen::Index>(render.bodyVertex.size());
    const auto fits = [&](Eigen::Index rows) { return rows == 0 || rows == renderVertices; };
    bool good = inRange(render.bodyVertex, body.vertices.rows()) && render.triangles.rows() == body.triangles.rows() &&
                inRange(render.triangles, renderVertices) && fits(render.normals.rows()) && fits(render.texCoords.rows()) && fits(render.colors.rows()) &&
                allFinite(render.normals) && allFinite(render.texCoords) && allFinite(render.colors) &&
                (render.material.empty() || static_cast<Eigen::Index>(render.material.size()) == body.triangles.rows()) &&
                inRange(render.material, static_cast<Eigen::Index>(render.materials.size()));
    for (const Material& m : render.materials)
        good = good && allFinite(m.baseColor) && std::isfinite(m.metallic) && std::isfinite(m.roughness) && m.baseColorTexture >= -1 &&
               m.baseColorTexture < static_cast<int>(render.textures.size());
    for (Eigen::Index i = 0; good && i < render.triangles.size(); ++i)
        good = render.bodyVertex[static_cast<std::size_t>(render.triangles.data()[i])] == body.triangles.data()[i];
    return good;
}

bool usable(const ElementMesh& mesh) {
    const TriangleMesh& body = mesh.body;
    return body.triangles.rows() > 0 && allFinite(body.vertices) && inRange(body.triangles, body.vertices.rows()) &&
           body.vertices.cwiseAbs().maxCoeff() <= kMaxCoordinate && usable(mesh.renderMesh, body);
}

bool scaled(double metresPerUnit) { return isFinite(metresPerUnit) && metresPerUnit > 0.0; }

}  // namespace

bool sound(const ImportResult& result) {
    for (const ImportedBody& body : result.bodies) {
        const TriangleMesh& mesh = body.mesh.body;
        if (!usable(body.mesh) || !inRange(body.issues, mesh.triangles.rows(), mesh.vertices.rows()) || body.components < 1) return false;
        if (!body.closed) continue;
        const MeshFacts facts = meshFacts(mesh);
        if (!facts.closed || !facts.outward) return false;
    }
    return !result.bodies.empty() && inRange(result.issues, 0, 0) && scaled(result.metresPerUnit);
}

bool sound(const CharacterFile& file) {
    const RenderModel& model = file.renderModel;
    const TriangleMesh& mesh = model.mesh.body;
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
    const bool empty = file.rig && vertices == 0 && mesh.triangles.rows() == 0;  // bones may come without a mesh
    return (empty ? usable(model.mesh.renderMesh, mesh) : usable(model.mesh)) && checkMorphs(model.morphs, vertices).empty() &&
           static_cast<Eigen::Index>(model.part.size()) == mesh.triangles.rows() && inRange(model.part, static_cast<Eigen::Index>(model.parts.size())) &&
           inRange(file.issues, mesh.triangles.rows(), mesh.vertices.rows()) && (!file.rig || checkRig(*file.rig, vertices).empty()) && scaled(file.metresPerUnit);
}

}  // namespace imomushi
