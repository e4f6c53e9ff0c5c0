// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/build_result.h"

#include <numeric>

#include "core/base/finite.h"
#include "core/mesh/bounds.h"
#include "core/mesh/render_vertices.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"

namespace imomushi {
namespace {

constexpr std::size_t kMaxPlaces = 1000;  // that an issue shows

double metres(Unit unit) {
    switch (unit) {
        case Unit::Millimetre: return 1e-3;
        case Unit::Centimetre: return 1e-2;
        case Unit::AsInFile:
        case Unit::Metre: break;
    }
    return 1.0;
}

template <class M>
void turnZUp(M& m) {  // (x, y, z) -> (x, z, -y)
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
        const auto y = m(i, 1);
        m(i, 1) = m(i, 2);
        m(i, 2) = -y;
    }
}

Result<void> checkFinite(const RawScene& scene, const std::string& quoted) {
    const TriangleMesh& body = scene.surface.mesh.body;
    std::vector<char> used(static_cast<std::size_t>(body.vertices.rows()), 0);
    for (Eigen::Index i = 0; i < body.triangles.size(); ++i) used[static_cast<std::size_t>(body.triangles.data()[i])] = 1;
    std::size_t bad = 0;
    const std::string* first = nullptr;
    for (const auto& [vertex, where] : scene.nonFinite)
        if (used[static_cast<std::size_t>(vertex)] && bad++ == 0) first = &where;
    if (bad == 0) return {};
    return fail("non-finite", quoted + " has " + (bad == 1 ? "a vertex" : std::to_string(bad) + " vertices") +
                                  " with a coordinate that is not a finite number" + (first->empty() ? "" : (bad == 1 ? " (" : " (the first: ") + *first + ")") +
                                  ": repair the mesh in the program that made it.");
}

/// Unit and axes, and what every answer says of its file.
template <class Answer>
Result<void> place(RawScene& scene, const ImportRequest& request, const std::string& quoted, Answer& answer) {
    ElementMesh& mesh = scene.surface.mesh;
    answer.format = scene.format;
    answer.issues = std::move(scene.issues);
    answer.metresPerUnit = request.unit == Unit::AsInFile ? scene.metresPerUnit : metres(request.unit);
    if (mesh.body.vertices.rows() > 0 && !(mesh.body.vertices.cwiseAbs().maxCoeff() * answer.metresPerUnit <= kMaxCoordinate))
        return fail("too-far", quoted + " reaches farther than 1e9 m from the origin: choose a smaller unit, or scale the mesh down in the program that made it.");
    if (answer.metresPerUnit != 1.0) mesh.body.vertices *= answer.metresPerUnit;
    for (MorphTarget& target : scene.morphs) target.deltas *= static_cast<float>(answer.metresPerUnit);
    answer.zUpConverted = request.up == UpAxis::AsInFile ? scene.zUp : request.up == UpAxis::Z;
    if (answer.zUpConverted) {
        turnZUp(mesh.body.vertices);
        turnZUp(mesh.renderMesh.normals);
        for (MorphTarget& target : scene.morphs) turnZUp(target.deltas);
    }
    return {};
}

/// Unit and axes as a matrix.
Eigen::Matrix4d placeInScene(double metresPerUnit, bool zUp) {
    Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
    if (zUp) place.topLeftCorner<3, 3>() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    place.topLeftCorner<3, 3>() *= metresPerUnit;
    return place;
}

/// Some writers give normals of length 0: those of the body replace them.
void replaceZeroNormals(ElementMesh& mesh) {
    RenderMesh& render = mesh.renderMesh;
    Points smooth;
    for (Eigen::Index r = 0; r < render.normals.rows(); ++r) {
        if (render.normals.row(r).squaredNorm() > 0.25f) continue;
        if (smooth.rows() == 0) smooth = vertexNormals(mesh.body);
        render.normals.row(r) = smooth.row(render.bodyVertex[static_cast<std::size_t>(r)]).cast<float>();
    }
}

/// Only the coordinates that are not finite change, of vertices in no triangle: all others keep their number and their bits.
void replaceNonFinite(RawScene& scene) {
    if (scene.nonFinite.empty()) return;
    MeshIssue issue;
    issue.severity = Severity::Warning;
    issue.code = "non-finite";
    issue.count = static_cast<int>(scene.nonFinite.size());
    issue.fixed = true;
    issue.text = counted(scene.nonFinite.size(), "vertex that belongs to no triangle has a coordinate that is not a finite number, which was",
                         "vertices that belong to no triangle have coordinates that are not finite numbers, which were") +
                 " set to 0.";
    for (const auto& [vertex, where] : scene.nonFinite) {
        for (int k = 0; k < 3; ++k)
            if (double& x = scene.surface.mesh.body.vertices(vertex, k); !isFinite(x)) x = 0.0;
        if (issue.vertices.size() < kMaxPlaces) issue.vertices.push_back(vertex);
    }
    scene.issues.push_back(std::move(issue));
}

/// Files that give each triangle its own corners: those at the same place of one part become the first of them. Every vertex is in use.
void weldCorners(RawScene& scene) {
    TriangleMesh& mesh = scene.surface.mesh.body;
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
    std::vector<std::int32_t> part(vertices, 0);
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) part[static_cast<std::size_t>(mesh.triangles.data()[i])] = scene.surface.part[static_cast<std::size_t>(i / 3)];
    const std::vector<std::int32_t> standsFor = weldExact(mesh.vertices, std::vector<char>(vertices, 1), part);
    std::vector<std::int32_t> number(vertices);
    std::int32_t kept = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
        const auto first = static_cast<std::size_t>(standsFor[v]);
        if (first != v) {
            number[v] = number[first];
            continue;
        }
        mesh.vertices.row(kept) = mesh.vertices.row(static_cast<Eigen::Index>(v)).eval();
        number[v] = kept++;
    }
    mesh.vertices.conservativeResize(kept, 3);
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) mesh.triangles.data()[i] = number[static_cast<std::size_t>(mesh.triangles.data()[i])];
}

/// Files often say for each corner again what its vertex looks like: equal render vertices become one, the first. Without attributes there is one for each vertex.
void shareRenderVertices(ElementMesh& mesh) {
    RenderMesh& render = mesh.renderMesh;
    if (render.triangles.rows() == 0) {
        render.triangles = mesh.body.triangles;
        render.bodyVertex.resize(static_cast<std::size_t>(mesh.body.vertices.rows()));
        std::iota(render.bodyVertex.begin(), render.bodyVertex.end(), 0);
        return;
    }
    RenderVertices shared(render);
    std::vector<std::int32_t> number(render.bodyVertex.size());
    for (std::size_t r = 0; r < number.size(); ++r) number[r] = shared.add(render.bodyVertex[r], static_cast<std::int32_t>(r));
    shared.write(render);
    for (Eigen::Index i = 0; i < render.triangles.size(); ++i) render.triangles.data()[i] = number[static_cast<std::size_t>(render.triangles.data()[i])];
}

/// The parts that have triangles, in the order of the file.
void takeParts(RawScene& scene, const std::string& stem, RenderModel& model) {
    std::vector<std::int32_t> number(scene.partNames.size(), -1);
    for (const std::int32_t p : scene.surface.part) number[static_cast<std::size_t>(p)] = 0;
    for (std::size_t p = 0; p < number.size(); ++p) {
        if (number[p] < 0) continue;
        number[p] = static_cast<std::int32_t>(model.parts.size());
        model.parts.push_back(cleanName(scene.partNames[p], stem));
    }
    model.part = std::move(scene.surface.part);
    for (std::int32_t& p : model.part) p = number[static_cast<std::size_t>(p)];
}

}  // namespace

Result<RawScene> readScene(const SourceFile& file, SceneUse use) {
    const std::string format = formatOf(file.path);
    if (format == "obj") return readObj(file);
    if (format == "ply") return readPly(file);
    if (format == "stl") return readStl(file);
    if (format == "gltf" || format == "glb") return readGltf(file, use);
    if (!format.empty()) return readByAssimp(file, format, use);
    return fail("unknown-format", file.quoted() + " is of no kind that can be read: OBJ, PLY, STL, glTF, GLB, VRM, FBX and DAE can.");
}

Result<ImportResult> buildResult(RawScene scene, const ImportRequest& request, const Progress& progress) {
    const std::string quoted = quotedName(request.path);
    ElementMesh& mesh = scene.surface.mesh;
    if (mesh.body.triangles.rows() == 0) return fail("empty-mesh", quoted + " has no triangles: choose a file with a mesh.");
    if (auto finite = checkFinite(scene, quoted); !finite) return tl::unexpected(finite.error());
    for (const auto& [vertex, where] : scene.nonFinite) mesh.body.vertices.row(vertex).setZero();  // in no triangle

    ImportResult result;
    if (auto placed = place(scene, request, quoted, result); !placed) return tl::unexpected(placed.error());

    progress.report("mend", 0.3);
    std::string stem = cleanName(request.path.stem().string(), "mesh");
    const std::vector<std::string> names = std::move(scene.partNames);
    MendResult mended = mend(std::move(scene.surface), request.split);
    if (mended.bodies.empty()) return fail("empty-mesh", quoted + " has no triangle with an area: choose a file with a mesh.");
    for (MendedBody& from : mended.bodies) {
        ImportedBody& body = result.bodies.emplace_back();
        const bool ofOnePart = request.split || names.size() == 1;
        body.name = ofOnePart && static_cast<std::size_t>(from.part) < names.size() ? cleanName(names[static_cast<std::size_t>(from.part)], stem) : stem;
        body.mesh = std::move(from.mesh);
        body.issues = std::move(from.issues);
        body.components = from.components;
        body.closed = from.closed;
        replaceZeroNormals(body.mesh);
    }
    auto& issues = result.bodies.size() == 1 ? result.bodies.front().issues : result.issues;
    issues.insert(issues.begin(), mended.mended.begin(), mended.mended.end());
    return result;
}

Result<CharacterFile> buildCharacter(RawScene scene, const ImportRequest& request, const Progress& progress) {
    const std::string quoted = quotedName(request.path);
    ElementMesh& mesh = scene.surface.mesh;
    if (mesh.body.triangles.rows() == 0 && !scene.rig) return fail("empty-mesh", quoted + " has no triangles: choose a file with a mesh.");
    if (auto finite = checkFinite(scene, quoted); !finite) return tl::unexpected(finite.error());
    replaceNonFinite(scene);
    CharacterFile file;
    if (auto placed = place(scene, request, quoted, file); !placed) return tl::unexpected(placed.error());
    if (scene.rig) {
        file.rig = std::move(scene.rig);
        placeRig(*file.rig, placeInScene(file.metresPerUnit, file.zUpConverted));
        if (const std::string fault = checkRig(*file.rig, static_cast<std::size_t>(mesh.body.vertices.rows())); !fault.empty())
            return fail("non-finite", quoted + " has bones that cannot be computed with (" + fault + "): scale the scene down in the program that made it.");
        if (mesh.body.triangles.rows() == 0 && !request.bonesSuffice)
            return fail("empty-mesh", quoted + " holds bones but no mesh: choose a file with a mesh, and bring these bones or clips to it afterwards.");
        if (mesh.body.triangles.rows() == 0) return file;
    }
    progress.report("check", 0.5);
    if (scene.format == "stl") weldCorners(scene);
    bool area = false;
    for (std::int32_t f = 0; !area && f < mesh.body.triangles.rows(); ++f) area = !degenerate(mesh.body, f);
    if (!area) return fail("empty-mesh", quoted + " has no triangle with an area: choose a file with a mesh.");
    shareRenderVertices(mesh);
    replaceZeroNormals(mesh);
    takeParts(scene, cleanName(request.path.stem().string(), "mesh"), file.renderModel);
    file.renderModel.mesh = std::move(mesh);
    file.renderModel.morphs = std::move(scene.morphs);
    if (const std::string fault = checkMorphs(file.renderModel.morphs, static_cast<std::size_t>(file.renderModel.mesh.body.vertices.rows())); !fault.empty())
        return fail("non-finite", quoted + " has morph targets that cannot be computed with (" + fault + "): scale the scene down in the program that made it.");
    return file;
}

}  // namespace imomushi
