// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <map>

#include "core/document/project_rows.h"
#include "core/document/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kElementTables = R"(
CREATE TABLE meshes (id INTEGER PRIMARY KEY, vertices BLOB, triangles BLOB, render_body_vertices BLOB, render_triangles BLOB,
    normals BLOB, tex_coords BLOB, colors BLOB, triangle_materials BLOB);
CREATE TABLE materials (mesh INTEGER, position INTEGER, name TEXT, base_color BLOB, metallic REAL, roughness REAL, texture INTEGER,
    PRIMARY KEY (mesh, position));
CREATE TABLE textures (mesh INTEGER, position INTEGER, name TEXT, mime_type TEXT, bytes BLOB, PRIMARY KEY (mesh, position));
CREATE TABLE elements (id INTEGER PRIMARY KEY, name TEXT, mesh INTEGER, nu REAL, stiffness REAL, density REAL, color BLOB, visible INTEGER,
    locked INTEGER, solver_mesh TEXT, joint_planes INTEGER);
CREATE TABLE issues (element INTEGER, position INTEGER, severity INTEGER, code TEXT, text TEXT, count INTEGER, fixed INTEGER,
    triangles BLOB, vertices BLOB, PRIMARY KEY (element, position));
CREATE TABLE faces (element INTEGER, position INTEGER, name TEXT, vertices BLOB, triangles BLOB, frame BLOB, area REAL, size REAL,
    planarity_error REAL, PRIMARY KEY (element, position));
)";

/// The rows of all meshes; answers their ids.
std::map<const ElementMesh*, int> writeMeshes(Database& db, const Document& document) {
    std::map<const ElementMesh*, int> ids;
    RowWriter meshes(db, "INSERT INTO meshes VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, element] : document.elements) {
        const ElementMesh& mesh = *element->mesh;
        const int meshId = static_cast<int>(ids.size()) + 1;
        if (!ids.emplace(&mesh, meshId).second) continue;
        const RenderMesh& render = mesh.renderMesh;
        meshes.row(meshId, mesh.body.vertices, mesh.body.triangles, render.bodyVertex, render.triangles, render.normals, render.texCoords, render.colors,
                   render.material);
    }
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

std::map<std::int64_t, std::shared_ptr<ElementMesh>> readMeshes(Database& db) {
    std::map<std::int64_t, std::shared_ptr<ElementMesh>> meshes;
    RowReader rows(db, "SELECT * FROM meshes ORDER BY id");
    while (rows.next()) {
        const std::int64_t meshId = rows.integer();
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body.vertices = rows.matrix<Points>();
        mesh->body.triangles = rows.matrix<Triangles>();
        RenderMesh& render = mesh->renderMesh;
        render.bodyVertex = rows.array<std::int32_t>();
        render.triangles = rows.matrix<Triangles>();
        render.normals = rows.matrix<decltype(render.normals)>();
        render.texCoords = rows.matrix<decltype(render.texCoords)>();
        render.colors = rows.matrix<decltype(render.colors)>();
        render.material = rows.array<std::int32_t>();
        const Eigen::Index bodyCount = mesh->body.vertices.rows(), renderCount = static_cast<Eigen::Index>(render.bodyVertex.size());
        require(bodyCount >= 4 && mesh->body.triangles.rows() >= 4, "a mesh is empty");
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
        m.metallic = static_cast<float>(materials.real(-1e6, 1e6));
        m.roughness = static_cast<float>(materials.real(-1e6, 1e6));
        m.baseColorTexture = static_cast<int>(materials.integer(-1, 1 << 20));
        render.materials.push_back(std::move(m));
    }
    RowReader textures(db, "SELECT * FROM textures ORDER BY mesh, position");
    while (textures.next()) {
        RenderMesh& render = meshAt(textures.integer());
        readPosition(textures, render.textures.size());
        Texture t;
        t.name = readUtf8(textures);
        t.mimeType = readUtf8(textures);
        t.bytes = textures.array<std::uint8_t>();
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

void checkFace(const JointFace& face, const Element& element) {
    const TriangleMesh& body = element.mesh->body;
    require(face.vertices.size() >= 3 && ascendingWithin(face.vertices, body.vertices.rows()), "the vertices of a joint face are broken");
    require(!face.triangles.empty() && ascendingWithin(face.triangles, body.triangles.rows()), "the triangles of a joint face are broken");
    for (const std::int32_t t : face.triangles)
        for (int k = 0; k < 3; ++k)
            require(std::binary_search(face.vertices.begin(), face.vertices.end(), body.triangles(t, k)), "a joint face lacks a corner");
    require(allCoordinates(face.frame.origin) && allCoordinates(face.frame.axes), "the frame of a joint face is broken");
    require((face.frame.axes.transpose() * face.frame.axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
                face.frame.axes.determinant() > 0,
            "the frame of a joint face is no frame");
    require(face.area > 0 && face.size > 0 && face.planarityError >= 0, "the size of a joint face is broken");
    for (const JointFace& other : element.faces) {
        require(other.name != face.name, "two joint faces have one name");
        std::vector<std::int32_t> shared;
        std::set_intersection(other.vertices.begin(), other.vertices.end(), face.vertices.begin(), face.vertices.end(), std::back_inserter(shared));
        require(shared.empty(), "two joint faces share a vertex");
    }
}

}  // namespace

void createElementTables(Database& db) { db.run(kElementTables); }

void writeElements(Database& db, const Document& document) {
    const auto meshIds = writeMeshes(db, document);
    RowWriter elements(db, "INSERT INTO elements VALUES (?,?,?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, e] : document.elements)
        elements.row(id, e->name, meshIds.at(e->mesh.get()), e->nu, e->stiffness, e->density, e->color, e->visible, e->locked, solverMeshName(e->solverMesh),
                     static_cast<int>(e->jointPlanes));
    RowWriter issues(db, "INSERT INTO issues VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, e] : document.elements)
        for (std::size_t i = 0; i < e->issues.size(); ++i) {
            const MeshIssue& issue = e->issues[i];
            issues.row(id, i, static_cast<int>(issue.severity), issue.code, issue.text, issue.count, issue.fixed, issue.triangles, issue.vertices);
        }
    RowWriter faces(db, "INSERT INTO faces VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, e] : document.elements)
        for (std::size_t i = 0; i < e->faces.size(); ++i) {
            const JointFace& f = e->faces[i];
            Eigen::Matrix<double, 3, 4> frame;
            frame << f.frame.origin, f.frame.axes;
            faces.row(id, i, f.name, f.vertices, f.triangles, frame, f.area, f.size, f.planarityError);
        }
}

void readElements(Database& db, Document& document) {
    const auto meshes = readMeshes(db);
    std::map<PartId, Element> read;
    RowReader elements(db, "SELECT * FROM elements ORDER BY id");
    while (elements.next()) {
        Element e;
        e.id = readId(elements);
        e.name = elements.text();
        const auto mesh = meshes.find(elements.integer());
        require(mesh != meshes.end(), "a mesh is missing");
        e.mesh = mesh->second;
        e.nu = elements.real(0.0, 0.5);
        e.stiffness = elements.real(1e-6, 1e6);
        e.density = elements.real(1e-3, 1e6);
        const auto color = elements.array<float>(3);
        require(color.size() == 3 && allFinite(color) && std::all_of(color.begin(), color.end(), [](float c) { return c >= 0.0f && c <= 1.0f; }), "a colour is broken");
        e.color = Eigen::Vector3f(color[0], color[1], color[2]);
        e.visible = elements.boolean();
        e.locked = elements.boolean();
        const auto solverMesh = parseSolverMesh(elements.text());
        require(solverMesh.has_value(), "a solver mesh is unknown");
        e.solverMesh = *solverMesh;
        e.jointPlanes = static_cast<Element::JointPlanes>(elements.integer(0, 2));
        read.emplace(e.id, std::move(e));
    }
    const auto elementAt = [&](PartId part) -> Element& {
        const auto found = read.find(part);
        require(found != read.end(), "an element is missing");
        return found->second;
    };
    RowReader issues(db, "SELECT * FROM issues ORDER BY element, position");
    while (issues.next()) {
        Element& e = elementAt(readId(issues));
        readPosition(issues, e.issues.size());
        MeshIssue issue;
        issue.severity = static_cast<Severity>(issues.integer(0, 2));
        issue.code = readUtf8(issues);
        issue.text = readUtf8(issues);
        issue.count = static_cast<int>(issues.integer(0, std::numeric_limits<int>::max()));
        issue.fixed = issues.boolean();
        issue.triangles = issues.array<std::int32_t>();
        issue.vertices = issues.array<std::int32_t>();
        require(allWithin(issue.triangles, e.mesh->body.triangles.rows()) && allWithin(issue.vertices, e.mesh->body.vertices.rows()), "the place of an issue is out of range");
        e.issues.push_back(std::move(issue));
    }
    RowReader faces(db, "SELECT * FROM faces ORDER BY element, position");
    while (faces.next()) {
        Element& e = elementAt(readId(faces));
        readPosition(faces, e.faces.size());
        JointFace f;
        f.name = faces.text();
        require(checkNameText(f.name).has_value(), "a name is broken");
        f.vertices = faces.array<std::int32_t>();
        f.triangles = faces.array<std::int32_t>();
        const auto frame = faces.array<double>(12);
        require(frame.size() == 12, "the frame of a joint face is broken");
        f.frame.origin = Vec3(frame[0], frame[1], frame[2]);
        for (int k = 0; k < 9; ++k) f.frame.axes(k % 3, k / 3) = frame[static_cast<std::size_t>(3 + k)];
        f.area = faces.real();
        f.size = faces.real(0.0, kMaxCoordinate);
        f.planarityError = faces.real(0.0, kMaxCoordinate);
        checkFace(f, e);
        e.faces.push_back(std::move(f));
    }
    for (auto& [part, element] : read) {
        require(checkNewName(document, element.name).has_value(), "a name is broken or used twice");
        document.elements.emplace(part, std::make_shared<const Element>(std::move(element)));
    }
}

}  // namespace imomushi
