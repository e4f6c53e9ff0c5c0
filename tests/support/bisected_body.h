// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/meshing/solver_mesh.h"
#include "tests/support/reference_case.h"

namespace imomushi {

/// The same polyhedron with at least `vertices` vertices, the new ones after the others. `freeVertices` stay as they are.
inline void bisect(ReferenceBody& body, int vertices) {
    const TriangleMesh& mesh = body.mesh->body;
    std::vector<std::int32_t> label(static_cast<std::size_t>(mesh.triangles.rows()), -1);
    for (std::size_t f = 0; f < body.faces.size(); ++f)
        for (const std::int32_t t : body.faces[f].triangles) label[static_cast<std::size_t>(t)] = static_cast<std::int32_t>(f);
    SolverMesh fine = plainSolverMesh(mesh, body.faces);
    for (double edge = body.diagonal(); fine.mesh.vertices.rows() < vertices; edge *= 0.97)
        fine = bisectedTo(mesh, label, body.faces.size(), std::vector<double>(static_cast<std::size_t>(mesh.vertices.rows()), edge));
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const std::string name = body.faces[f].name;
        body.faces[f] = jointFaceByVertices(fine.mesh, fine.faces[f].vertices).value();
        body.faces[f].name = name;
    }
    body.mesh = std::make_shared<ElementMesh>(ElementMesh{fine.mesh, {}});
}

}  // namespace imomushi
