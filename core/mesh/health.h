// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

enum class Severity { Info, Warning, Error };

/// One thing found on a mesh. Codes: "unwelded", "open", "non-manifold-edge", "non-manifold-vertex", "inverted", "mixed-winding", "degenerate",
/// "duplicate-triangle", "self-intersection", "components", "non-finite", "unused-vertex", "huge", "tiny", "far-from-origin", "not-triangles", ...
struct MeshIssue {
    Severity severity = Severity::Warning;
    std::string code;
    std::string text;   ///< one English sentence: what it is and what to do
    int count = 0;      ///< how many places
    bool fixed = false; ///< mended on import
    std::vector<std::int32_t> triangles;  ///< up to 1000 places to show, body triangles
    std::vector<std::int32_t> vertices;   ///< up to 1000 places to show, body vertices
};

/// "1 vertex", "2 vertices": a count in the text of an issue.
std::string counted(std::size_t n, const char* one, const char* many);

/// Adds "left-out" where a worker left out steps of the operation that is done (core/worker/worker.h), because it crashed or did not end there.
void sayLeftOut(std::vector<MeshIssue>& issues);

/// Combinatorial and geometric facts of a surface.
struct MeshFacts {
    bool closed = false;    ///< every edge has exactly two triangles, consistently oriented, manifold at vertices
    bool outward = false;   ///< closed and of positive volume
    int components = 0;
    double volume = 0.0;    ///< m^3, signed
    double area = 0.0;      ///< m^2
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< bounding box, m
    [[nodiscard]] double diagonal() const { return (high - low).norm(); }
};

MeshFacts meshFacts(const TriangleMesh& mesh);

/// All issues of a body as it is; changes nothing. Any indices and numbers will do.
std::vector<MeshIssue> checkMesh(const TriangleMesh& mesh);

}  // namespace imomushi
