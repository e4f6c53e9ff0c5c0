// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/prepared_surface.h"

#include <string>
#include <utility>

#include "core/base/finite.h"
#include "core/mesh/bounds.h"

namespace imomushi {
Result<void> checkTriangles(const TriangleMesh& mesh, std::span<const std::int32_t> part) {
    if (mesh.triangles.rows() == 0) return fail("empty-mesh", "The mesh has no triangles: choose a file with a mesh.");
    if (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= mesh.vertices.rows() ||
        (!part.empty() && part.size() != static_cast<std::size_t>(mesh.triangles.rows())))
        return fail("bad-index", "Triangles refer to vertices that do not exist: export the mesh again.");
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) {
        const std::int32_t v = mesh.triangles.data()[i];
        if (!allFinite(mesh.vertices.row(v)))
            return fail("non-finite", "Vertex " + std::to_string(v) + " has a coordinate that is not a finite number: repair the mesh in the program that made it.");
        if (mesh.vertices.row(v).cwiseAbs().maxCoeff() > kMaxImportedCoordinate)
            return fail("non-finite", "The mesh has coordinates that are too large to compute with: scale it down in the program that made it.");
    }
    return {};
}

RawSurface rawSurface(const TriangleMesh& mesh, std::span<const std::int32_t> part) {
    RawSurface raw;
    raw.mesh.body.triangles = mesh.triangles;
    raw.mesh.body.vertices = Points::Zero(mesh.vertices.rows(), 3);
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) {  // others may hold anything
        const std::int32_t v = mesh.triangles.data()[i];
        raw.mesh.body.vertices.row(v) = mesh.vertices.row(v);
    }
    raw.part.assign(part.begin(), part.end());
    return raw;
}

PreparedSurface prepareSurface(const TriangleMesh& render, std::span<const std::int32_t> part) {
    MendSurface s(rawSurface(render, part));
    dropUnused(s);
    s.dropCollapsed();
    weldVertices(s);
    dropUseless(s);
    PreparedSurface out;
    out.sameShape = !separateNonManifold(s);
    windConsistently(s);
    const std::size_t before = s.faces.size();
    capHoles(s);
    closeHoles(s);
    out.sameShape = out.sameShape && s.faces.size() == before;

    std::vector<std::int32_t> number(static_cast<std::size_t>(s.points.rows()), -1);
    for (const MendFace& f : s.faces)
        for (const std::int32_t v : f.v) number[at(v)] = 0;
    std::int32_t vertices = 0;
    for (std::int32_t& n : number)
        if (n == 0) n = vertices++;
    out.mesh.vertices.resize(vertices, 3);
    for (std::size_t v = 0; v < number.size(); ++v)
        if (number[v] >= 0) out.mesh.vertices.row(number[v]) = s.points.row(static_cast<Eigen::Index>(v));
    out.mesh.triangles.resize(static_cast<Eigen::Index>(s.faces.size()), 3);
    out.vertexOf.assign(static_cast<std::size_t>(render.vertices.rows()), -1);
    for (std::size_t f = 0; f < s.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t v = number[at(s.faces[f].v[k])];
            out.mesh.triangles(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = v;
            if (s.faces[f].r[k] < 0) continue;
            std::int32_t& known = out.vertexOf[at(s.faces[f].r[k])];
            if (known < 0) known = v;
        }
    out.issues = std::move(s.issues);
    return out;
}

}  // namespace imomushi
