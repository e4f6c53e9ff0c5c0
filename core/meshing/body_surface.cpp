// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/body_surface.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "core/mesh/topology.h"
#include "core/meshing/decimation.h"
#include "core/meshing/mesh_pieces.h"

namespace imomushi {
namespace {

/// How far the outline of a decimated disc may leave the disc's, in square roots of its area.
constexpr double kOutlineTolerance = 0.02;
/// Round rims of decimated bodies become polygons of about fifty sides, whose area is 0.2 % less.
constexpr double kRimTolerance = 1e-3;

/// The wanted edges at the outlines of discs, per vertex of the surface, as decimate() takes them.
std::vector<double> outlineEdges(const BodySurface& surface, double inRadii) {
    std::vector<double> out(static_cast<std::size_t>(surface.triangles().vertices.rows()), std::numeric_limits<double>::infinity());
    const std::vector<std::int32_t> face = facesOfTriangles(surface.mesh);
    const EdgeTable edges(surface.triangles().triangles);
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        const std::int32_t f = face[static_cast<std::size_t>(uses[0].triangle)], g = face[static_cast<std::size_t>(uses[1].triangle)];
        if (f == g || !surface.discs.exact[static_cast<std::size_t>(std::max(f, g))]) continue;
        for (const std::int32_t v : {uses[0].low, uses[0].high})
            out[static_cast<std::size_t>(v)] = inRadii * surface.ofBody[static_cast<std::size_t>(std::max(f, g))].disc->radius;
    }
    return out;
}

}  // namespace

BodySurface::BodySurface(const TriangleMesh& whole, std::span<const JointFace> bodyFaces) : discs(discMesh(whole, bodyFaces)), body(whole), ofBody(bodyFaces) {
    faces = discs.any() ? discs.faces(bodyFaces) : std::vector<JointFace>(bodyFaces.begin(), bodyFaces.end());
    mesh = discs.any() ? std::move(discs.mesh) : plainSolverMesh(body, bodyFaces);
}

std::vector<std::int32_t> facesOfTriangles(const SolverMesh& mesh) {
    std::vector<std::int32_t> face(static_cast<std::size_t>(mesh.mesh.triangles.rows()), -1);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        for (const std::int32_t t : mesh.faces[f].triangles) face[static_cast<std::size_t>(t)] = static_cast<std::int32_t>(f);
    return face;
}

std::vector<std::array<std::int32_t, 2>> longFreeEdges(const SolverMesh& mesh, double length) {
    const std::vector<std::int32_t> face = facesOfTriangles(mesh);
    const EdgeTable edges(mesh.mesh.triangles);
    std::vector<std::array<std::int32_t, 2>> out;
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        const bool held = std::any_of(uses.begin(), uses.end(), [&](const EdgeUse& u) { return face[static_cast<std::size_t>(u.triangle)] >= 0; });
        if (!held && (mesh.mesh.vertices.row(uses[0].low) - mesh.mesh.vertices.row(uses[0].high)).norm() >= (1.0 - kTie) * length)
            out.push_back({uses[0].low, uses[0].high});
    }
    return out;
}

SolvedBody asItIs(const TriangleMesh& body, std::span<const JointFace> faces, SolverMesh mesh) {
    SolvedBody out;
    out.mesh = std::move(mesh);
    out.faces.assign(faces.begin(), faces.end());
    out.bodyVertex.resize(static_cast<std::size_t>(body.vertices.rows()));
    std::iota(out.bodyVertex.begin(), out.bodyVertex.end(), 0);
    return out;
}

SolvedBody onItself(SolverMesh mesh, const BodySurface& surface) {
    SolvedBody out = asItIs(surface.body, surface.ofBody, std::move(mesh));
    out.inside = surface.discs.inside;
    return out;
}

Result<SolvedBody> onDecimated(const BodySurface& surface, int vertices, const Progress& progress, double outlineEdge, double most) {
    const TriangleMesh& mesh = surface.triangles();
    std::vector<double> tolerance(surface.faces.size(), kRimTolerance), longest;
    if (surface.discs.any()) {
        longest = outlineEdges(surface, outlineEdge);
        for (std::size_t f = 0; f < tolerance.size(); ++f)
            if (surface.discs.exact[f]) tolerance[f] = kOutlineTolerance;
    }
    auto small = decimate(mesh, surface.faces, vertices, progress, tolerance, longest, most);
    if (!small) return tl::make_unexpected(small.error());
    SolvedBody out;
    out.mesh = plainSolverMesh(small->mesh, small->faces);
    out.faces = std::move(small->faces);
    out.decimated = true;
    out.volumeError = small->volumeError;
    out.bodyVertex = std::move(small->bodyVertex);
    for (std::int32_t& v : out.bodyVertex)
        if (v >= surface.body.vertices.rows()) v = -1;
    out.inside = surface.discs.inside;
    return out;
}

}  // namespace imomushi
