// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/storage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <set>

#include "core/document/character_input.h"
#include "core/document/names.h"
#include "core/document/sqlite.h"
#include "core/document/version.h"
#include "core/io/atomic_file.h"

namespace imomushi {

namespace {

constexpr const char* kTables = R"(
CREATE TABLE info (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE settings (basis TEXT, format TEXT, threads INTEGER, next_id INTEGER);
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
CREATE TABLE joints (id INTEGER PRIMARY KEY);
CREATE TABLE joint_faces (joint INTEGER, position INTEGER, element INTEGER, face TEXT, PRIMARY KEY (joint, position));
CREATE TABLE bones (id INTEGER PRIMARY KEY, name TEXT, element INTEGER, parent INTEGER, roll REAL, min_stretch REAL, max_stretch REAL,
    start_kind TEXT, start_part INTEGER, start_name TEXT, start_point BLOB, end_kind TEXT, end_part INTEGER, end_name TEXT, end_point BLOB);
CREATE TABLE held (bone INTEGER, at_end INTEGER, pinned INTEGER, target BLOB, roll REAL, from_roll REAL, from_point BLOB, seconds REAL,
    elapsed REAL, PRIMARY KEY (bone, at_end));
CREATE TABLE pose (points BLOB, frames BLOB, rolls BLOB);
CREATE TABLE responses (id INTEGER PRIMARY KEY, key BLOB, shape BLOB, free_vertices BLOB, bases BLOB, response BLOB, stiffness BLOB,
    tractions BLOB, loads BLOB, load_forces BLOB,
    residual REAL, rcond REAL, peak_bytes INTEGER, asymmetry REAL, negative_energy REAL, solver_vertices INTEGER, solver_nodes INTEGER,
    decimated INTEGER, error REAL, mapping_error REAL, shape_error REAL);
CREATE TABLE element_responses (element INTEGER PRIMARY KEY, response INTEGER);
CREATE TABLE touch_responses (response INTEGER PRIMARY KEY, centres BLOB, reach REAL, first BLOB, patches BLOB, weights BLOB, displacement BLOB,
    forces BLOB, compliance BLOB, probes BLOB, gradients BLOB, asymmetry REAL, negative_energy REAL);
CREATE TABLE takes (id INTEGER PRIMARY KEY, name TEXT, times BLOB, bones BLOB, points INTEGER, pose_first BLOB, pose_varying BLOB, pose_values BLOB,
    elements BLOB, element_sizes BLOB, joints INTEGER, warping INTEGER, nodes INTEGER, shape_first BLOB, shape_varying BLOB, shape_values BLOB);
CREATE TABLE take_targets (take INTEGER, position INTEGER, time REAL, bone INTEGER, at_end INTEGER, held INTEGER, pinned INTEGER, target BLOB, roll REAL,
    PRIMARY KEY (take, position));
CREATE TABLE effects (effect TEXT PRIMARY KEY, enabled INTEGER);
CREATE TABLE effect_elements (effect TEXT, element INTEGER, PRIMARY KEY (effect, element));
CREATE TABLE effect_settings (effect TEXT, property TEXT, x REAL, y REAL, z REAL, PRIMARY KEY (effect, property));
)";

constexpr std::size_t kMostTouchPatches = 100'000;
constexpr int kMostFaceVertices = 1'000'000;  // of all faces of an element
constexpr double kLargestCoordinate = 1e9;  // as in commands
constexpr std::int64_t kMaxId = std::int64_t{1} << 53;

void require(bool ok, const char* what) {
    if (!ok) throw DatabaseError(what);
}

std::string utf8(std::string text) {
    require(isUtf8(text), "a text is not UTF-8");
    return text;
}

bool ascendingWithin(const std::vector<std::int32_t>& values, Eigen::Index count) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i] < (i ? values[i - 1] + std::int64_t{1} : 0) || values[i] >= count) return false;
    return true;
}

template <class Values>
bool within(const Values& values, Eigen::Index count) {
    return std::all_of(values.data(), values.data() + values.size(), [&](auto v) { return v >= 0 && v < count; });
}

template <class Values>
bool finite(const Values& values) {
    return std::all_of(values.data(), values.data() + values.size(), [](auto x) { return isFinite(x); });
}

template <class Values>
bool coordinates(const Values& values) {
    return finite(values) && std::all_of(values.data(), values.data() + values.size(), [](auto x) { return std::abs(x) <= kLargestCoordinate; });
}

// ---- writing -------------------------------------------------------------------------------------------------------

void writeMeshes(Database& db, const Document& document, std::map<const ElementMesh*, int>& ids) {
    RowWriter meshes(db, "INSERT INTO meshes VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, element] : document.elements) {
        const ElementMesh& mesh = *element->mesh;
        const int meshId = static_cast<int>(ids.size()) + 1;
        if (!ids.emplace(&mesh, meshId).second) continue;
        const Look& look = mesh.look;
        meshes.row(meshId, mesh.body.vertices, mesh.body.triangles, look.bodyVertex, look.triangles, look.normals, look.texCoords, look.colors,
                   look.material);
    }
    std::map<int, const ElementMesh*> ordered;
    for (const auto& [mesh, id] : ids) ordered.emplace(id, mesh);
    RowWriter materials(db, "INSERT INTO materials VALUES (?,?,?,?,?,?,?)");
    for (const auto& [id, mesh] : ordered)
        for (std::size_t i = 0; i < mesh->look.materials.size(); ++i) {
            const Material& m = mesh->look.materials[i];
            materials.row(id, i, m.name, m.baseColor, m.metallic, m.roughness, m.baseColorTexture);
        }
    RowWriter textures(db, "INSERT INTO textures VALUES (?,?,?,?,?)");
    for (const auto& [id, mesh] : ordered)
        for (std::size_t i = 0; i < mesh->look.textures.size(); ++i) {
            const Texture& t = mesh->look.textures[i];
            textures.row(id, i, t.name, t.mimeType, t.bytes);
        }
}

void writeElements(Database& db, const Document& document, const std::map<const ElementMesh*, int>& meshIds) {
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

struct PlaceRow {
    std::string kind, name;
    PartId part = 0;
    Vec3 point = Vec3::Zero();
};

PlaceRow placeRow(const Bone::Place& place) {
    if (const auto* face = std::get_if<FaceRef>(&place)) return {"face", face->face, face->element, Vec3::Zero()};
    if (const auto* end = std::get_if<EndpointRef>(&place)) return {"bone", end->atEnd ? "end" : "start", end->bone, Vec3::Zero()};
    return {"point", "", 0, std::get<Vec3>(place)};
}

void writeSkeleton(Database& db, const Document& document) {
    RowWriter joints(db, "INSERT INTO joints VALUES (?)");
    for (const auto& [id, joint] : document.joints) joints.row(id);
    RowWriter jointFaces(db, "INSERT INTO joint_faces VALUES (?,?,?,?)");
    for (const auto& [id, joint] : document.joints)
        for (std::size_t i = 0; i < joint->faces.size(); ++i) jointFaces.row(id, i, joint->faces[i].element, joint->faces[i].face);
    RowWriter bones(db, "INSERT INTO bones VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, bone] : document.bones) {
        const PlaceRow s = placeRow(bone->start), e = placeRow(bone->end);
        bones.row(id, bone->name, bone->element, bone->parent, bone->roll, bone->minStretch, bone->maxStretch, s.kind, s.part, s.name, s.point,
                  e.kind, e.part, e.name, e.point);
    }
    RowWriter held(db, "INSERT INTO held VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [end, h] : document.held)
        held.row(end.bone, end.atEnd, h.pinned, h.target, h.roll, h.fromRoll, h.from, h.seconds, h.elapsed);
    std::vector<double> points, frames;
    for (const Vec3& p : document.pose.points) points.insert(points.end(), p.data(), p.data() + 3);
    for (const auto& q : document.pose.frames) frames.insert(frames.end(), q.coeffs().data(), q.coeffs().data() + 4);
    RowWriter pose(db, "INSERT INTO pose VALUES (?,?,?)");
    pose.row(points, frames, document.pose.roll);
}

void writeResponses(Database& db, const Project& project) {
    // Times are left out: the same work gives the same file.
    std::map<ContentKey, int> ids;
    RowWriter responses(db, "INSERT INTO responses VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    for (const auto& [element, r] : project.responses) {
        const int id = static_cast<int>(ids.size()) + 1;
        if (!ids.emplace(r.key, id).second) continue;
        const ElementResponse& a = *r.response;
        std::vector<std::int32_t> bases;
        // What a basis has besides its kind: the number of vertices, or whether the face is flat and twice the number of warping modes.
        for (const FaceBasis& basis : a.bases)
            bases.insert(bases.end(), {static_cast<std::int32_t>(basis.kind), basis.kind == BasisKind::Full ? basis.vertices : basis.flat + 2 * basis.modes});
        responses.row(id, std::vector{r.key.high, r.key.low}, std::vector{r.shape.high, r.shape.low}, a.freeVertices, bases, a.response, a.stiffness, a.tractions, a.loads, a.loadForces,
                      a.quality.solve.residual, a.quality.solve.rcond, a.quality.solve.peakBytes, a.quality.asymmetry, a.quality.negativeEnergy,
                      a.quality.solverVertices, a.quality.solverNodes, a.quality.decimated, a.quality.error, a.quality.mappingError, a.quality.shapeError);
    }
    RowWriter touches(db, "INSERT INTO touch_responses VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)");
    std::set<ContentKey> written;
    for (const auto& [element, r] : project.responses) {
        const TouchResponse& t = r.response->touch;
        if (t.patches.count() == 0 || !written.insert(r.key).second) continue;
        touches.row(ids.at(r.key), t.patches.centre, t.patches.reach, t.patches.first, t.patches.patch, t.patches.weight, t.displacement, t.forces, t.compliance, t.probes,
                    t.gradients, t.asymmetry, t.negativeEnergy);
    }
    RowWriter uses(db, "INSERT INTO element_responses VALUES (?,?)");
    for (const auto& [element, r] : project.responses) uses.row(element, ids.at(r.key));
}

// ---- reading -------------------------------------------------------------------------------------------------------

PartId id(RowReader& row) { return static_cast<PartId>(row.integer(1, kMaxId)); }
PartId idOrNone(RowReader& row) { return static_cast<PartId>(row.integer(0, kMaxId)); }

Vec3 point(RowReader& row) {
    const auto v = row.array<double>(3);
    require(v.size() == 3 && coordinates(v), "a point is out of range");
    return {v[0], v[1], v[2]};
}

std::map<std::int64_t, std::shared_ptr<ElementMesh>> readMeshes(Database& db) {
    std::map<std::int64_t, std::shared_ptr<ElementMesh>> meshes;
    RowReader rows(db, "SELECT * FROM meshes ORDER BY id");
    while (rows.next()) {
        const std::int64_t meshId = rows.integer();
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body.vertices = rows.matrix<Points>();
        mesh->body.triangles = rows.matrix<Triangles>();
        Look& look = mesh->look;
        look.bodyVertex = rows.array<std::int32_t>();
        look.triangles = rows.matrix<Triangles>();
        look.normals = rows.matrix<decltype(look.normals)>();
        look.texCoords = rows.matrix<decltype(look.texCoords)>();
        look.colors = rows.matrix<decltype(look.colors)>();
        look.material = rows.array<std::int32_t>();
        const Eigen::Index bodyCount = mesh->body.vertices.rows(), renderCount = static_cast<Eigen::Index>(look.bodyVertex.size());
        require(bodyCount >= 4 && mesh->body.triangles.rows() >= 4, "a mesh is empty");
        require(coordinates(mesh->body.vertices), "a vertex is out of range");
        require(within(mesh->body.triangles, bodyCount), "a triangle names a vertex that is not there");
        require(within(look.bodyVertex, bodyCount) && within(look.triangles, renderCount), "a render vertex is out of range");
        require(look.triangles.rows() == 0 || look.triangles.rows() == mesh->body.triangles.rows(), "the look of a mesh has other triangles than its body");
        for (const Eigen::Index attribute : {look.normals.rows(), look.texCoords.rows(), look.colors.rows()})
            require(attribute == 0 || attribute == renderCount, "an attribute has a broken size");
        require(finite(look.normals) && finite(look.texCoords) && finite(look.colors), "an attribute is not finite");
        require(look.material.empty() || static_cast<Eigen::Index>(look.material.size()) == look.triangles.rows(), "the materials of a mesh have a broken size");
        meshes.emplace(meshId, std::move(mesh));
    }
    const auto meshAt = [&](std::int64_t meshId) -> Look& {
        const auto found = meshes.find(meshId);
        require(found != meshes.end(), "a mesh is missing");
        return found->second->look;
    };
    RowReader materials(db, "SELECT * FROM materials ORDER BY mesh, position");
    while (materials.next()) {
        Look& look = meshAt(materials.integer());
        materials.integer(static_cast<std::int64_t>(look.materials.size()), static_cast<std::int64_t>(look.materials.size()));
        Material m;
        m.name = utf8(materials.text());
        const auto color = materials.array<float>(4);
        require(color.size() == 4 && finite(color), "a colour is broken");
        m.baseColor = Eigen::Vector4f(color[0], color[1], color[2], color[3]);
        m.metallic = static_cast<float>(materials.real(-1e6, 1e6));
        m.roughness = static_cast<float>(materials.real(-1e6, 1e6));
        m.baseColorTexture = static_cast<int>(materials.integer(-1, 1 << 20));
        look.materials.push_back(std::move(m));
    }
    RowReader textures(db, "SELECT * FROM textures ORDER BY mesh, position");
    while (textures.next()) {
        Look& look = meshAt(textures.integer());
        textures.integer(static_cast<std::int64_t>(look.textures.size()), static_cast<std::int64_t>(look.textures.size()));
        Texture t;
        t.name = utf8(textures.text());
        t.mimeType = utf8(textures.text());
        t.bytes = textures.array<std::uint8_t>();
        look.textures.push_back(std::move(t));
    }
    for (const auto& [meshId, mesh] : meshes) {
        const Look& look = mesh->look;
        for (const std::int32_t m : look.material)
            require(m >= -1 && m < static_cast<std::int64_t>(look.materials.size()), "a triangle names a material that is not there");
        for (const Material& m : look.materials)
            require(m.baseColorTexture < static_cast<std::int64_t>(look.textures.size()), "a material names a texture that is not there");
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
    require(coordinates(face.frame.origin) && coordinates(face.frame.axes), "the frame of a joint face is broken");
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

void readElements(Database& db, Document& document) {
    const auto meshes = readMeshes(db);
    std::map<PartId, Element> read;
    RowReader elements(db, "SELECT * FROM elements ORDER BY id");
    while (elements.next()) {
        Element e;
        e.id = id(elements);
        e.name = elements.text();
        const auto mesh = meshes.find(elements.integer());
        require(mesh != meshes.end(), "a mesh is missing");
        e.mesh = mesh->second;
        e.nu = elements.real(0.0, 0.5);
        e.stiffness = elements.real(1e-6, 1e6);
        e.density = elements.real(1e-3, 1e6);
        const auto color = elements.array<float>(3);
        require(color.size() == 3 && finite(color) && std::all_of(color.begin(), color.end(), [](float c) { return c >= 0.0f && c <= 1.0f; }), "a colour is broken");
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
        Element& e = elementAt(id(issues));
        issues.integer(static_cast<std::int64_t>(e.issues.size()), static_cast<std::int64_t>(e.issues.size()));
        MeshIssue issue;
        issue.severity = static_cast<Severity>(issues.integer(0, 2));
        issue.code = utf8(issues.text());
        issue.text = utf8(issues.text());
        issue.count = static_cast<int>(issues.integer(0, std::numeric_limits<int>::max()));
        issue.fixed = issues.boolean();
        issue.triangles = issues.array<std::int32_t>();
        issue.vertices = issues.array<std::int32_t>();
        require(within(issue.triangles, e.mesh->body.triangles.rows()) && within(issue.vertices, e.mesh->body.vertices.rows()), "the place of an issue is out of range");
        e.issues.push_back(std::move(issue));
    }
    RowReader faces(db, "SELECT * FROM faces ORDER BY element, position");
    while (faces.next()) {
        Element& e = elementAt(id(faces));
        faces.integer(static_cast<std::int64_t>(e.faces.size()), static_cast<std::int64_t>(e.faces.size()));
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
        f.size = faces.real(0.0, kLargestCoordinate);
        f.planarityError = faces.real(0.0, kLargestCoordinate);
        checkFace(f, e);
        e.faces.push_back(std::move(f));
    }
    for (auto& [part, element] : read) {
        require(checkNewName(document, element.name).has_value(), "a name is broken or used twice");
        document.elements.emplace(part, std::make_shared<const Element>(std::move(element)));
    }
}

Bone::Place readPlace(RowReader& rows) {
    const std::string kind = rows.text();
    const PartId part = idOrNone(rows);
    const std::string name = rows.text();
    const Vec3 at = point(rows);
    if (kind == "face") return FaceRef{part, name};
    if (kind == "point") return at;
    require(kind == "bone" && (name == "start" || name == "end"), "the end of a bone is broken");
    return EndpointRef{part, name == "end"};
}

void readSkeleton(Database& db, Document& document) {
    std::map<PartId, Joint> joints;
    RowReader jointRows(db, "SELECT * FROM joints ORDER BY id");
    while (jointRows.next()) {
        const PartId part = id(jointRows);
        joints[part].id = part;
    }
    std::set<FaceRef> joined;
    RowReader faceRows(db, "SELECT * FROM joint_faces ORDER BY joint, position");
    while (faceRows.next()) {
        const auto joint = joints.find(id(faceRows));
        require(joint != joints.end(), "a joint is missing");
        auto& faces = joint->second.faces;
        faceRows.integer(static_cast<std::int64_t>(faces.size()), static_cast<std::int64_t>(faces.size()));
        FaceRef face;
        face.element = id(faceRows);
        face.face = faceRows.text();
        const auto element = document.elements.find(face.element);
        require(element != document.elements.end() && element->second->faceIndex(face.face) >= 0, "a joint names a face that is not there");
        require(joined.insert(face).second, "a face is in two joints");
        faces.push_back(std::move(face));
    }
    for (auto& [part, joint] : joints) {
        require(joint.faces.size() >= 2, "a joint has fewer than two faces");
        document.joints.emplace(part, std::make_shared<const Joint>(std::move(joint)));
    }

    RowReader bones(db, "SELECT * FROM bones ORDER BY id");
    while (bones.next()) {
        Bone bone;
        bone.id = id(bones);
        bone.name = bones.text();
        bone.element = idOrNone(bones);
        bone.parent = idOrNone(bones);
        bone.roll = bones.real(-1e6, 1e6);
        bone.minStretch = bones.real(0.01, 1.0);
        bone.maxStretch = bones.real(1.0, 100.0);
        bone.start = readPlace(bones);
        bone.end = readPlace(bones);
        require(checkNewName(document, bone.name).has_value(), "a name is broken or used twice");
        require(bone.element == 0 || document.elements.contains(bone.element), "a bone runs through an element that is not there");
        document.bones.emplace(bone.id, std::make_shared<const Bone>(std::move(bone)));
    }
    for (const auto& [part, bone] : document.bones) require(bone->parent == 0 || document.bones.contains(bone->parent), "the parent of a bone is missing");
    const auto plan = planCharacter(document);
    if (!plan) throw DatabaseError(plan.error().message);

    RowReader held(db, "SELECT * FROM held ORDER BY bone, at_end");
    while (held.next()) {
        EndpointRef end;
        end.bone = id(held);
        end.atEnd = held.boolean();
        Held h;
        h.pinned = held.boolean();
        h.target = point(held);
        h.roll = held.optionalReal();
        require(!h.roll || std::abs(*h.roll) <= 1e6, "a roll is out of range");
        h.fromRoll = held.real(-1e9, 1e9);
        h.from = point(held);
        h.seconds = held.real(0.0, 1e6);
        h.elapsed = held.real(0.0, 1e6);
        require(document.bones.contains(end.bone), "a held endpoint is missing");
        document.held.emplace(end, h);
    }
    RowReader pose(db, "SELECT * FROM pose");
    require(pose.next(), "the pose is missing");
    const auto points = pose.array<double>(3), frames = pose.array<double>(4);
    document.pose.roll = pose.array<double>();
    const Skeleton& skeleton = plan->input.skeleton;
    if (!points.empty() || !frames.empty() || !document.pose.roll.empty()) {
        require(points.size() == 3 * skeleton.points.size() && frames.size() == 4 * skeleton.bones.size() &&
                    document.pose.roll.size() == skeleton.points.size(),
                "the pose belongs to another skeleton");
        require(coordinates(points) && coordinates(frames) && coordinates(document.pose.roll), "the pose is out of range");
    }
    for (std::size_t i = 0; i < points.size(); i += 3) document.pose.points.emplace_back(points[i], points[i + 1], points[i + 2]);
    for (std::size_t i = 0; i < frames.size(); i += 4) {
        const Eigen::Quaterniond q(frames[i + 3], frames[i], frames[i + 1], frames[i + 2]);
        require(std::abs(q.norm() - 1.0) < 1e-6, "the pose holds no rotation");
        document.pose.frames.push_back(q);
    }
}

ContentKey key(RowReader& rows) {
    const auto halves = rows.array<std::uint64_t>(2);
    require(halves.size() == 2, "a key is broken");
    return {halves[0], halves[1]};
}

/// Where fingers press, of a response with these free vertices and g columns.
TouchResponse readTouch(RowReader& rows, const std::vector<std::int32_t>& freeVertices, std::size_t g) {
    TouchResponse t;
    t.patches.centre = rows.array<std::int32_t>();
    t.patches.reach = rows.real(0.0, kLargestCoordinate);
    t.patches.first = rows.array<std::int32_t>();
    t.patches.patch = rows.array<std::int32_t>();
    t.patches.weight = rows.array<float>();
    const auto displacement = rows.array<float>();
    const auto forces = rows.array<double>(), compliance = rows.array<double>();
    t.probes = rows.array<std::int32_t>();
    const auto gradients = rows.array<float>();
    t.asymmetry = rows.real();
    t.negativeEnergy = rows.real();
    const std::size_t count = t.patches.centre.size(), columns = 3 * count;
    require(count >= 1 && count <= kMostTouchPatches && !t.patches.first.empty(), "touch is broken");
    const auto vertices = static_cast<std::int64_t>(t.patches.first.size()) - 1;
    const auto within = [](const std::vector<std::int32_t>& of, std::int64_t end) { return std::all_of(of.begin(), of.end(), [&](std::int32_t i) { return i >= 0 && i < end; }); };
    require(t.patches.first.front() == 0 && std::is_sorted(t.patches.first.begin(), t.patches.first.end()) &&
                static_cast<std::size_t>(t.patches.first.back()) == t.patches.patch.size() && t.patches.weight.size() == t.patches.patch.size(),
            "touch is broken");
    require(within(t.patches.centre, vertices) && within(t.patches.patch, static_cast<std::int64_t>(count)) && within(t.probes, vertices) && within(freeVertices, vertices),
            "touch names what is not there");
    require(std::all_of(t.patches.weight.begin(), t.patches.weight.end(), [](float w) { return std::isfinite(w) && w >= 0.0f && w <= 1.0f; }), "touch has a broken weight");
    require(displacement.size() == 3 * freeVertices.size() * columns && forces.size() == g * columns && compliance.size() == columns * columns &&
                gradients.size() == 9 * t.probes.size() * columns,
            "touch has a broken size");
    const auto finiteFloats = [](const std::vector<float>& of) { return std::all_of(of.begin(), of.end(), [](float x) { return std::isfinite(x); }); };
    require(finiteFloats(displacement) && finite(forces) && finite(compliance) && finiteFloats(gradients), "touch is not finite");
    const auto put = [&](const auto& from, auto& to, std::size_t height) {
        to.resize(static_cast<Eigen::Index>(height), static_cast<Eigen::Index>(columns));
        std::copy(from.begin(), from.end(), to.data());
    };
    put(displacement, t.displacement, 3 * freeVertices.size());
    put(forces, t.forces, g);
    put(compliance, t.compliance, columns);
    put(gradients, t.gradients, 9 * t.probes.size());
    return t;
}

void readResponses(Database& db, Project& project, bool withTouch) {
    std::map<std::int64_t, Project::Response> read;
    const auto touchOf = [&](std::int64_t response, const ElementResponse& of) {
        RowReader rows(db, ("SELECT * FROM touch_responses WHERE response=" + std::to_string(response)).c_str());
        if (!rows.next()) return TouchResponse{};
        rows.integer();
        return readTouch(rows, of.freeVertices, static_cast<std::size_t>(of.columns()));
    };
    std::map<std::int64_t, std::shared_ptr<ElementResponse>> warped;  // those that miss the warping of their faces
    RowReader rows(db, "SELECT * FROM responses ORDER BY id");
    while (rows.next()) {
        const std::int64_t responseId = rows.integer();
        Project::Response r;
        r.key = key(rows);
        r.shape = key(rows);
        auto a = std::make_shared<ElementResponse>();
        a->freeVertices = rows.array<std::int32_t>();
        require(ascendingWithin(a->freeVertices, std::numeric_limits<std::int32_t>::max()), "a response is broken");
        const auto bases = rows.array<std::int32_t>(2);
        a->firstColumn.push_back(0);
        for (std::size_t i = 0; i < bases.size(); i += 2) {
            require(bases[i] >= 0 && bases[i] <= static_cast<std::int32_t>(BasisKind::Modes) && bases[i + 1] >= 0, "a basis is unknown");
            FaceBasis basis;
            basis.kind = static_cast<BasisKind>(bases[i]);
            if (basis.kind == BasisKind::Full) {
                require(bases[i + 1] <= kMostFaceVertices, "a basis is unknown");
                basis.vertices = bases[i + 1];
            } else {
                basis.flat = bases[i + 1] % 2 == 1;
                basis.modes = bases[i + 1] / 2;
                require(basis.kind == BasisKind::Modes ? basis.modes >= 1 && basis.modes <= BasisChoice::kMostModes : basis.modes == 0, "a basis is unknown");
            }
            a->bases.push_back(std::move(basis));
            require(static_cast<std::int64_t>(a->firstColumn.back()) + a->bases.back().columns() <= 3 * kMostFaceVertices, "a basis is too large");
            a->firstColumn.push_back(a->firstColumn.back() + a->bases.back().columns());
        }
        const auto g = static_cast<std::size_t>(a->columns());
        const auto values = rows.array<double>(), stiffness = rows.array<double>(), tractions = rows.array<double>(), loads = rows.array<double>(),
                   loadForces = rows.array<double>();
        require(values.size() == 3 * a->freeVertices.size() * g && stiffness.size() == g * g, "a response has a broken size");
        require(tractions.empty() || tractions.size() == g * g, "a response has a broken size");
        require(loads.empty() ? loadForces.empty() : loads.size() == 12 * a->freeVertices.size() && loadForces.size() == 4 * g, "a response has a broken size");
        require(finite(values) && finite(stiffness) && finite(tractions) && finite(loads) && finite(loadForces), "a response is not finite");
        a->response = Eigen::Map<const Eigen::MatrixXd>(values.data(), 3 * static_cast<Eigen::Index>(a->freeVertices.size()), static_cast<Eigen::Index>(g));
        const auto matrix = [](const std::vector<double>& from, std::size_t columns) -> Eigen::MatrixXd {
            return Eigen::Map<const Eigen::MatrixXd>(from.data(), static_cast<Eigen::Index>(from.size() / columns), static_cast<Eigen::Index>(columns));
        };
        a->stiffness = Eigen::Map<const Eigen::MatrixXd>(stiffness.data(), static_cast<Eigen::Index>(g), static_cast<Eigen::Index>(g));
        if (!tractions.empty()) a->tractions = matrix(tractions, g);
        if (!loads.empty()) {
            a->loads = matrix(loads, 4);
            a->loadForces = matrix(loadForces, 4);
        }
        a->quality.solve.residual = rows.real();
        a->quality.solve.rcond = rows.real();
        a->quality.solve.peakBytes = static_cast<std::size_t>(rows.integer(0, std::numeric_limits<std::int64_t>::max()));
        a->quality.asymmetry = rows.real();
        a->quality.negativeEnergy = rows.real();
        a->quality.solverVertices = static_cast<int>(rows.integer(0, std::numeric_limits<int>::max()));
        a->quality.solverNodes = static_cast<int>(rows.integer(0, std::numeric_limits<int>::max()));
        a->quality.decimated = rows.boolean();
        a->quality.error = rows.real();
        a->quality.mappingError = rows.real();
        a->quality.shapeError = rows.real();
        if (!a->bases.empty() && a->bases[0].kind == BasisKind::Modes) warped.emplace(responseId, a);
        if (withTouch) a->touch = touchOf(responseId, *a);
        r.response = std::move(a);
        read.emplace(responseId, std::move(r));
    }
    RowReader uses(db, "SELECT * FROM element_responses ORDER BY element");
    while (uses.next()) {
        const PartId element = id(uses);
        const auto response = read.find(uses.integer());
        require(project.document.elements.contains(element) && response != read.end(), "a response belongs to nothing");
        if (const auto found = warped.find(response->first); found != warped.end()) {
            const Element& of = *project.document.elements.at(element);
            auto& bases = found->second->bases;
            require(bases.size() == of.faces.size(), "a response belongs to other joint faces");
            for (std::size_t f = 0; f < bases.size(); ++f) bases[f].warping = FaceBasis::on(of.mesh->body, of.faces[f], bases[f].choice()).warping;
            warped.erase(found);  // elements that share a response are the same
        }
        project.responses.emplace(element, response->second);
    }
}

// ---- takes ---------------------------------------------------------------------------------------------------------

void writeTakes(Database& db, const Document& document) {
    RowWriter takes(db, "INSERT INTO takes VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"), targets(db, "INSERT INTO take_targets VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, take] : document.takes) {
        std::vector<PartId> bones;
        for (const Take::Bone& b : take->bones) bones.insert(bones.end(), {b.bone, static_cast<PartId>(b.start), static_cast<PartId>(b.end)});
        std::vector<std::int32_t> sizes;
        for (const auto& e : take->layout.elements) sizes.insert(sizes.end(), {e.weights, e.forces});
        takes.row(id, take->name, take->times, bones, take->points, take->poses.first(), take->poses.varying(), take->poses.values(), take->elements, sizes,
                  take->layout.joints, take->layout.warping, take->layout.nodes, take->shapes.first(), take->shapes.varying(), take->shapes.values());
        for (std::size_t i = 0; i < take->targets.size(); ++i) {
            const Take::Target& t = take->targets[i];
            targets.row(id, i, t.time, t.bone, t.atEnd, t.held, t.pinned, t.to, t.roll);
        }
    }
}

/// Of `frames` frames; `rotations`: where in each the quaternions are.
FrameNumbers readFrames(RowReader& rows, std::size_t width, std::size_t frames, const std::vector<std::size_t>& rotations) {
    auto first = rows.array<double>();
    auto varying = rows.array<std::int32_t>();
    auto values = rows.array<double>();
    require(first.size() == width && ascendingWithin(varying, static_cast<Eigen::Index>(width)) && values.size() == frames * varying.size(), "a take has a broken size");
    require(coordinates(first) && coordinates(values), "a take is out of range");
    FrameNumbers numbers(std::move(first), std::move(varying), std::move(values));
    std::vector<double> row(width);
    for (std::size_t f = 0; f < frames; ++f) {
        numbers.at(f, row.data());
        for (const std::size_t q : rotations)
            require(std::abs(Eigen::Map<const Eigen::Vector4d>(row.data() + q).norm() - 1.0) < 1e-6, "a take holds no rotation");
    }
    return numbers;
}

void readTakes(Database& db, Document& document) {
    constexpr std::int64_t kMostParts = 1'000'000;
    std::map<PartId, std::shared_ptr<Take>> read;
    RowReader rows(db, "SELECT * FROM takes ORDER BY id");
    while (rows.next()) {
        auto take = std::make_shared<Take>();
        take->id = id(rows);
        take->name = rows.text();
        require(checkNameText(take->name).has_value() && !document.takeNamed(take->name), "the name of a take is broken or used twice");
        take->times = rows.array<double>();
        const std::size_t frames = take->times.size();
        require(frames > 0 && coordinates(take->times) && take->times[0] == 0.0 && std::adjacent_find(take->times.begin(), take->times.end(), std::greater_equal<>()) == take->times.end(),
                "the times of a take are broken");
        const auto bones = rows.array<PartId>(3);
        take->points = static_cast<int>(rows.integer(0, kMostParts));
        for (std::size_t i = 0; i < bones.size(); i += 3) {
            require(bones[i + 1] < static_cast<PartId>(take->points) && bones[i + 2] < static_cast<PartId>(take->points), "the bones of a take are broken");
            take->bones.push_back({bones[i], static_cast<int>(bones[i + 1]), static_cast<int>(bones[i + 2])});
        }
        std::vector<std::size_t> rotations;
        const auto points = static_cast<std::size_t>(take->points);
        for (std::size_t b = 0; b < take->bones.size(); ++b) rotations.push_back(3 * points + 4 * b);
        take->poses = readFrames(rows, 4 * points + 4 * take->bones.size(), frames, rotations);
        take->elements = rows.array<PartId>();
        const auto sizes = rows.array<std::int32_t>(2);
        require(sizes.size() == 2 * take->elements.size(), "the elements of a take are broken");
        std::int64_t numbers = 0;
        for (std::size_t i = 0; i < sizes.size(); i += 2) {
            require(sizes[i] >= 0 && sizes[i] <= kMostParts && sizes[i + 1] >= 0 && sizes[i + 1] <= kMostParts, "the elements of a take are broken");
            numbers += ShapeLayout::kFrame + sizes[i] + sizes[i + 1];
            take->layout.elements.push_back({sizes[i], sizes[i + 1]});
        }
        take->layout.joints = static_cast<int>(rows.integer(0, kMostParts));
        take->layout.warping = static_cast<int>(rows.integer(0, Warping::kMost));
        take->layout.nodes = static_cast<int>(rows.integer(0, kMostParts));
        require(numbers + 64 * kMostParts < std::numeric_limits<int>::max(), "a take is too large");
        rotations.clear();
        for (std::size_t e = 0, at = 0; e < take->layout.elements.size(); ++e) {
            rotations.push_back(at);
            at += static_cast<std::size_t>(ShapeLayout::kFrame + take->layout.elements[e].weights + take->layout.elements[e].forces);
        }
        for (int j = 0; j < take->layout.joints; ++j) rotations.push_back(static_cast<std::size_t>(take->layout.joint(j)));
        take->shapes = readFrames(rows, static_cast<std::size_t>(take->layout.size()), frames, rotations);
        read.emplace(take->id, take);
        document.takes.emplace(take->id, std::move(take));
    }
    RowReader targets(db, "SELECT * FROM take_targets ORDER BY take, position");
    while (targets.next()) {
        const auto take = read.find(id(targets));
        require(take != read.end(), "a target belongs to no take");
        auto& list = take->second->targets;
        targets.integer(static_cast<std::int64_t>(list.size()), static_cast<std::int64_t>(list.size()));
        Take::Target t;
        t.time = targets.real(0.0, kLargestCoordinate);
        t.bone = id(targets);
        t.atEnd = targets.boolean();
        t.held = targets.boolean();
        t.pinned = targets.boolean();
        t.to = point(targets);
        t.roll = targets.optionalReal();
        require(!t.roll || std::abs(*t.roll) <= 1e6, "a roll is out of range");
        list.push_back(t);
    }
}

void writeEffects(Database& db, const Document& document) {
    RowWriter effects(db, "INSERT INTO effects VALUES (?,?)"), elements(db, "INSERT INTO effect_elements VALUES (?,?)"),
        settings(db, "INSERT INTO effect_settings VALUES (?,?,?,?,?)");
    for (std::size_t k = 0; k < kEffects; ++k) {
        const Effect& effect = document.effects[static_cast<EffectKind>(k)];
        const std::string name(kEffectNames[k]);
        effects.row(name, effect.enabled);
        const double* at = effect.values.data();
        for (const EffectProperty& p : effectProperties(static_cast<EffectKind>(k))) {
            settings.row(name, std::string(p.name), at[0], p.size == 3 ? at[1] : 0.0, p.size == 3 ? at[2] : 0.0);
            at += p.size;
        }
        for (const PartId element : effect.elements) elements.row(name, element);
    }
}

void readEffects(Database& db, Document& document) {
    const auto kindOf = [](RowReader& rows) {
        const auto kind = effectNamed(rows.text());
        require(kind.has_value(), "an effect is unknown");
        return *kind;
    };
    RowReader effects(db, "SELECT * FROM effects");
    while (effects.next()) {
        const EffectKind kind = kindOf(effects);
        document.effects[kind].enabled = effects.boolean();
    }
    RowReader settings(db, "SELECT * FROM effect_settings");
    while (settings.next()) {
        const EffectKind kind = kindOf(settings);
        const std::string name = settings.text();
        const auto properties = effectProperties(kind);
        const auto property = std::find_if(properties.begin(), properties.end(), [&](const EffectProperty& p) { return p.name == name; });
        require(property != properties.end(), "a setting of an effect is unknown");
        for (int i = 0; i < property->size; ++i)
            document.effects[kind].values[static_cast<std::size_t>(Effects::place(kind, name) + i)] = settings.real(property->low, property->high);
    }
    RowReader elements(db, "SELECT * FROM effect_elements");
    while (elements.next()) {
        const EffectKind kind = kindOf(elements);
        const PartId element = id(elements);
        require(isOfElements(kind) && document.elements.contains(element), "an effect is on an element that is not there");
        document.effects[kind].elements.insert(element);
    }
}

Project readProject(Database& db, std::int64_t version) {
    Project project;
    Document& document = project.document;
    RowReader settings(db, "SELECT * FROM settings");
    require(settings.next(), "the settings are missing");
    const auto basis = parseBasis(settings.text());
    require(basis.has_value(), "the basis is unknown");
    document.settings.basis = *basis;
    const auto format = responseFormat(settings.text());
    require(format.has_value(), "the format is unknown");
    document.settings.format = *format;
    document.settings.threads = static_cast<int>(settings.integer(0, 1024));
    document.nextId = id(settings);
    readElements(db, document);
    readSkeleton(db, document);
    if (version >= 3) readResponses(db, project, version >= 4);  // older ones are of older solvers
    if (version >= 4) readEffects(db, document);
    if (version >= 5) readTakes(db, document);
    std::set<PartId> ids;
    const auto unique = [&](PartId part) { require(part < document.nextId && ids.insert(part).second, "an id is used twice"); };
    for (const auto& [part, element] : document.elements) unique(part);
    for (const auto& [part, joint] : document.joints) unique(part);
    for (const auto& [part, bone] : document.bones) unique(part);
    for (const auto& [part, take] : document.takes) unique(part);
    return project;
}

}  // namespace

Result<void> saveProject(const std::filesystem::path& path, const Project& project) {
    try {
        Database db;
        db.run("PRAGMA page_size=4096");
        db.run(("PRAGMA application_id=" + std::to_string(kProjectApplicationId)).c_str());
        db.run(("PRAGMA user_version=" + std::to_string(kProjectVersion)).c_str());
        db.run("BEGIN");
        db.run(kTables);
        const Document& document = project.document;
        {
            RowWriter settings(db, "INSERT INTO settings VALUES (?,?,?,?)");
            settings.row(basisName(document.settings.basis), formatName(document.settings.format), document.settings.threads, document.nextId);
        }
        std::map<const ElementMesh*, int> meshIds;
        writeMeshes(db, document, meshIds);
        writeElements(db, document, meshIds);
        writeSkeleton(db, document);
        writeResponses(db, project);
        writeEffects(db, document);
        writeTakes(db, document);
        {
            const std::string digest = db.digest(projectTables(kProjectVersion));
            RowWriter info(db, "INSERT INTO info VALUES (?,?)");
            info.row("program", std::string("imomushi ") + kVersion);
            info.row("digest", digest);
        }
        db.run("COMMIT");
        return writeFileAtomically(path, db.file());
    } catch (const DatabaseError& error) {
        return fail("not-writable", std::string("The project could not be written (") + error.what() + "): nothing was changed on the disk.");
    }
}

Result<Project> openProject(const std::filesystem::path& path) {
    const std::string name = "\"" + path.string() + "\"";
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return fail("file-not-found", "There is no file " + name + ": check its path.");
    if (!std::filesystem::is_regular_file(path, error)) return fail("not-readable", name + " is not a file: choose a .imomushi file.");
    std::vector<char> bytes;
    {
        std::ifstream file(path, std::ios::binary | std::ios::ate);
        const auto size = file ? static_cast<std::streamoff>(file.tellg()) : -1;
        if (size < 0) return fail("not-readable", name + " cannot be read: check its permissions.");
        bytes.resize(static_cast<std::size_t>(size));
        file.seekg(0);
        if (!file.read(bytes.data(), size)) return fail("not-readable", name + " cannot be read: check its disk.");
    }
    const auto notAProject = [&] { return fail("not-a-project", name + " is not an Imomushi project: choose a .imomushi file."); };
    constexpr std::string_view kMagic("SQLite format 3\0", 16);
    if (bytes.size() < 100 || std::string_view(bytes.data(), 16) != kMagic) return notAProject();
    try {
        Database db(std::move(bytes));
        if (db.number("PRAGMA application_id") != kProjectApplicationId) return notAProject();
        const std::int64_t version = db.number("PRAGMA user_version");
        if (version > kProjectVersion)
            return fail("newer-version", name + " was written by a newer version of Imomushi (format " + std::to_string(version) + ", this program knows " +
                                             std::to_string(kProjectVersion) + "): update the program.");
        require(version >= 1, "its version is unknown");
        RowReader info(db, "SELECT value FROM info WHERE name='digest'");
        require(info.next() && info.text() == db.digest(projectTables(version)), "its content does not match its digest");
        return readProject(db, version);
    } catch (const DatabaseError& reason) {
        return fail("damaged", name + " is damaged (" + reason.what() + "): open an earlier version of it.");
    }
}

}  // namespace imomushi
