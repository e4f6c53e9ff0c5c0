// SPDX-License-Identifier: GPL-3.0-or-later

#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

MeshIds writeMeshes(Database& db, const Document& document) {
    MeshIds ids;
    RowWriter meshes(db, "INSERT INTO meshes VALUES (?,?,?,?,?,?,?,?,?)");
    const auto write = [&](const ElementMesh& mesh) {
        const int meshId = static_cast<int>(ids.size()) + 1;
        if (!ids.emplace(&mesh, meshId).second) return;
        const RenderMesh& render = mesh.renderMesh;
        meshes.row(meshId, mesh.body.vertices, mesh.body.triangles, render.bodyVertex, render.triangles, render.normals, render.texCoords, render.colors,
                   render.material);
    };
    for (const auto& [id, element] : document.elements) write(*element->mesh);
    for (const auto& [id, character] : document.characters) write(character->model->mesh);
    std::map<int, const ElementMesh*> ordered;
    for (const auto& [mesh, id] : ids) ordered.emplace(id, mesh);
    RowWriter materials(db, "INSERT INTO materials VALUES (?,?,?,?,?,?,?)");
    for (const auto& [id, mesh] : ordered)
        for (std::size_t i = 0; i < mesh->renderMesh.materials.size(); ++i) {
            const Material& m = mesh->renderMesh.materials[i];
            materials.row(id, i, m.name, m.baseColor, m.metallic, m.roughness, m.baseColorTexture);
        }
    RowWriter textures(db, "INSERT INTO textures VALUES (?,?,?,?,?)");
    for (const auto& [id, mesh] : ordered)
        for (std::size_t i = 0; i < mesh->renderMesh.textures.size(); ++i) {
            const Texture& t = mesh->renderMesh.textures[i];
            textures.row(id, i, t.name, t.mimeType, t.bytes);
        }
    return ids;
}

ReadMeshes readMeshes(Database& db) {
    ReadMeshes meshes;
    RowReader rows(db, "SELECT * FROM meshes ORDER BY id");
    while (rows.next()) {
        const std::int64_t meshId = rows.integer();
        auto mesh = std::make_shared<ElementMesh>();
        RenderMesh& render = mesh->renderMesh;
        readColumns(rows, mesh->body.vertices, mesh->body.triangles, render.bodyVertex, render.triangles, render.normals, render.texCoords, render.colors,
                    render.material);
        const Eigen::Index bodyCount = mesh->body.vertices.rows(), renderCount = static_cast<Eigen::Index>(render.bodyVertex.size());
        require(bodyCount >= 1 && mesh->body.triangles.rows() >= 1, "a mesh is empty");
        require(allCoordinates(mesh->body.vertices), "a vertex is out of range");
        require(allWithin(mesh->body.triangles, bodyCount), "a triangle names a vertex that is not there");
        require(allWithin(render.bodyVertex, bodyCount) && allWithin(render.triangles, renderCount), "a render vertex is out of range");
        require(render.triangles.rows() == 0 || render.triangles.rows() == mesh->body.triangles.rows(), "the look of a mesh has other triangles than its body");
        for (const Eigen::Index attribute : {render.normals.rows(), render.texCoords.rows(), render.colors.rows()})
            require(attribute == 0 || attribute == renderCount, "an attribute has a broken size");
        require(allFinite(render.normals) && allFinite(render.texCoords) && allFinite(render.colors), "an attribute is not finite");
        require(render.material.empty() || static_cast<Eigen::Index>(render.material.size()) == render.triangles.rows(), "the materials of a mesh have a broken size");
        meshes.emplace(meshId, std::move(mesh));
    }
    const auto meshAt = [&](std::int64_t meshId) -> RenderMesh& {
        const auto found = meshes.find(meshId);
        require(found != meshes.end(), "a mesh is missing");
        return found->second->renderMesh;
    };
    RowReader materials(db, "SELECT * FROM materials ORDER BY mesh, position");
    while (materials.next()) {
        RenderMesh& render = meshAt(materials.integer());
        readPosition(materials, render.materials.size());
        Material m;
        m.name = readUtf8(materials);
        const auto color = materials.array<float>(4);
        require(color.size() == 4 && allFinite(color), "a colour is broken");
        m.baseColor = Eigen::Vector4f(color[0], color[1], color[2], color[3]);
        readColumns(materials, Within{m.metallic, -1e6f, 1e6f}, Within{m.roughness, -1e6f, 1e6f}, Within{m.baseColorTexture, -1, 1 << 20});
        render.materials.push_back(std::move(m));
    }
    RowReader textures(db, "SELECT * FROM textures ORDER BY mesh, position");
    while (textures.next()) {
        RenderMesh& render = meshAt(textures.integer());
        readPosition(textures, render.textures.size());
        Texture t;
        readColumns(textures, t.name, t.mimeType, t.bytes);
        render.textures.push_back(std::move(t));
    }
    for (const auto& [meshId, mesh] : meshes) {
        const RenderMesh& render = mesh->renderMesh;
        for (const std::int32_t m : render.material)
            require(m >= -1 && m < static_cast<std::int64_t>(render.materials.size()), "a triangle names a material that is not there");
        for (const Material& m : render.materials)
            require(m.baseColorTexture < static_cast<std::int64_t>(render.textures.size()), "a material names a texture that is not there");
    }
    return meshes;
}

}  // namespace imomushi
