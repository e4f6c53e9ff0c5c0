// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <map>

#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kElementTables = R"(
CREATE TABLE meshes (id INTEGER PRIMARY KEY, vertices BLOB, triangles BLOB, render_body_vertices BLOB, render_triangles BLOB,
    normals BLOB, tex_coords BLOB, colors BLOB, triangle_materials BLOB);
CREATE TABLE materials (mesh INTEGER, position INTEGER, name TEXT, base_color BLOB, metallic REAL, roughness REAL, texture INTEGER,
    PRIMARY KEY (mesh, position));
CREATE TABLE textures (mesh INTEGER, position INTEGER, name TEXT, mime_type TEXT, bytes BLOB, PRIMARY KEY (mesh, position));
CREATE TABLE elements (id INTEGER PRIMARY KEY, name TEXT, mesh INTEGER, nu REAL, stiffness REAL, density REAL, damping REAL, color BLOB, visible INTEGER,
    locked INTEGER, solver_mesh TEXT, joint_planes INTEGER);
CREATE TABLE issues (element INTEGER, position INTEGER, severity INTEGER, code TEXT, text TEXT, count INTEGER, fixed INTEGER,
    triangles BLOB, vertices BLOB, PRIMARY KEY (element, position));
CREATE TABLE faces (element INTEGER, position INTEGER, name TEXT, vertices BLOB, triangles BLOB, frame BLOB, area REAL, size REAL,
    planarity_error REAL, visible INTEGER, locked INTEGER, PRIMARY KEY (element, position));
)";

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

MeshIssue readIssue(RowReader& row, const TriangleMesh& mesh) {
    MeshIssue issue;
    readColumns(row, Within{issue.severity, Severity::Info, Severity::Error}, issue.code, issue.text, Within{issue.count, 0, std::numeric_limits<int>::max()},
                issue.fixed, issue.triangles, issue.vertices);
    require(allWithin(issue.triangles, mesh.triangles.rows()) && allWithin(issue.vertices, mesh.vertices.rows()), "the place of an issue is out of range");
    return issue;
}

void createElementTables(Database& db) { db.run(kElementTables); }

void writeElements(Database& db, const Document& document, const MeshIds& meshIds) {
    RowWriter elements(db, "INSERT INTO elements VALUES (?,?,?,?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, e] : document.elements)
        elements.row(id, e->name, meshIds.at(e->mesh.get()), e->nu, e->stiffness, e->density, e->damping, e->color, e->visible, e->locked, solverMeshName(e->solverMesh),
                     static_cast<int>(e->jointPlanes));
    RowWriter issues(db, "INSERT INTO issues VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, e] : document.elements)
        for (std::size_t i = 0; i < e->issues.size(); ++i) {
            const MeshIssue& issue = e->issues[i];
            issues.row(id, i, static_cast<int>(issue.severity), issue.code, issue.text, issue.count, issue.fixed, issue.triangles, issue.vertices);
        }
    RowWriter faces(db, "INSERT INTO faces VALUES (?,?,?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, e] : document.elements)
        for (std::size_t i = 0; i < e->faces.size(); ++i) {
            const JointFace& f = e->faces[i];
            Eigen::Matrix<double, 3, 4> frame;
            frame << f.frame.origin, f.frame.axes;
            faces.row(id, i, f.name, f.vertices, f.triangles, frame, f.area, f.size, f.planarityError, f.visible, f.locked);
        }
}

void readElements(Database& db, Document& document, const ReadMeshes& meshes) {
    std::map<PartId, Element> read;
    RowReader elements(db, "SELECT * FROM elements ORDER BY id");
    while (elements.next()) {
        Element e;
        e.id = readId(elements);
        e.name = elements.text();
        const auto mesh = meshes.find(elements.integer());
        require(mesh != meshes.end(), "a mesh is missing");
        require(mesh->second->body.vertices.rows() >= 4 && mesh->second->body.triangles.rows() >= 4, "a mesh is empty");
        e.mesh = mesh->second;
        readColumns(elements, Within{e.nu, 0.0, 0.5}, Within{e.stiffness, 1e-6, 1e6}, Within{e.density, 1e-3, 1e6}, Within{e.damping, 0.0, Element::kMaxDamping});
        const auto color = elements.array<float>(3);
        require(color.size() == 3 && allFinite(color) && std::all_of(color.begin(), color.end(), [](float c) { return c >= 0.0f && c <= 1.0f; }), "a colour is broken");
        e.color = Eigen::Vector3f(color[0], color[1], color[2]);
        readColumns(elements, e.visible, e.locked);
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
        e.issues.push_back(readIssue(issues, e.mesh->body));
    }
    RowReader faces(db, "SELECT * FROM faces ORDER BY element, position");
    while (faces.next()) {
        Element& e = elementAt(readId(faces));
        readPosition(faces, e.faces.size());
        JointFace f;
        f.name = faces.text();
        require(checkNameText(f.name).has_value(), "a name is broken");
        readColumns(faces, f.vertices, f.triangles);
        const auto frame = faces.array<double>(12);
        require(frame.size() == 12, "the frame of a joint face is broken");
        f.frame.origin = Vec3(frame[0], frame[1], frame[2]);
        for (int k = 0; k < 9; ++k) f.frame.axes(k % 3, k / 3) = frame[static_cast<std::size_t>(3 + k)];
        readColumns(faces, f.area, Within{f.size, 0.0, kMaxCoordinate}, Within{f.planarityError, 0.0, kMaxCoordinate}, f.visible, f.locked);
        checkFace(f, e);
        e.faces.push_back(std::move(f));
    }
    for (auto& [part, element] : read) {
        require(checkNewName(document, element.name).has_value(), "a name is broken or used twice");
        document.elements.emplace(part, std::make_shared<const Element>(std::move(element)));
    }
}

}  // namespace imomushi
