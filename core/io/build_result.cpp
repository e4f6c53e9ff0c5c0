// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/build_result.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"

namespace imomushi {
namespace {

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

}  // namespace

Result<RawScene> readScene(const SourceFile& file) {
    const std::string format = formatOf(file.path);
    if (format == "obj") return readObj(file);
    if (format == "ply") return readPly(file);
    if (format == "stl") return readStl(file);
    if (format == "gltf" || format == "glb") return readGltf(file);
    if (!format.empty()) return readByAssimp(file, format);
    return fail("unknown-format", file.quoted() + " is of no kind that can be read: OBJ, PLY, STL, glTF, GLB, FBX and DAE can.");
}

Result<ImportResult> buildResult(RawScene scene, const ImportRequest& request, const Progress& progress) {
    const std::string quoted = quotedName(request.path);
    ElementMesh& mesh = scene.surface.mesh;
    if (mesh.body.triangles.rows() == 0) return fail("empty-mesh", quoted + " has no triangles: choose a file with a mesh.");
    if (auto finite = checkFinite(scene, quoted); !finite) return tl::unexpected(finite.error());
    for (const auto& [vertex, where] : scene.nonFinite) mesh.body.vertices.row(vertex).setZero();  // in no triangle

    ImportResult result;
    result.format = scene.format;
    result.issues = std::move(scene.issues);
    result.metresPerUnit = request.unit == Unit::AsInFile ? scene.metresPerUnit : metres(request.unit);
    if (mesh.body.vertices.cwiseAbs().maxCoeff() > kMaxImportedCoordinate / std::max(1.0, result.metresPerUnit))
        return fail("non-finite", quoted + " has coordinates that are too large to compute with: scale the mesh down in the program that made it.");
    if (result.metresPerUnit != 1.0) mesh.body.vertices *= result.metresPerUnit;
    result.zUpConverted = request.up == UpAxis::AsInFile ? scene.zUp : request.up == UpAxis::Z;
    if (result.zUpConverted) {
        turnZUp(mesh.body.vertices);
        turnZUp(mesh.renderMesh.normals);
    }

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

}  // namespace imomushi
