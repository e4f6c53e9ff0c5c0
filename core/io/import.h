// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/health.h"
#include "core/mesh/mesh.h"

namespace imomushi {

enum class Unit { AsInFile, Millimetre, Centimetre, Metre };
enum class UpAxis { AsInFile, Y, Z };

struct ImportRequest {
    std::filesystem::path path;
    Unit unit = Unit::AsInFile;  ///< AsInFile: FBX and glTF carry their unit; others are metres
    UpAxis up = UpAxis::AsInFile;
    bool split = false;          ///< one body per connected component
    bool bonesSuffice = false;   ///< of importCharacter(): a file of bones without a mesh is no error
};

/// One body out of a file: mended where it could be, with everything that was found told in `issues`.
struct ImportedBody {
    std::string name;  ///< of the node, object or file; UTF-8, not empty, not unique
    ElementMesh mesh;  ///< recentred never: coordinates as in the file after unit and axes
    std::vector<MeshIssue> issues;
    int components = 1;
    bool closed = false;  ///< closed, manifold, outward: usable as an element
};

struct ImportResult {
    std::string format;      ///< "obj", "ply", "stl", "glb", "gltf", "fbx", "dae"
    double metresPerUnit = 1.0;  ///< scale that was applied
    bool zUpConverted = false;
    std::vector<ImportedBody> bodies;
    std::vector<MeshIssue> issues;   ///< of the file as a whole (dropped data, unsupported parts)
};

/// Reads a mesh file in a worker (core/worker/worker.h) with limits of memory, processor and wall time; survives anything that the reader does.
/// Welds, orients, mends and checks (core/mesh/health.h).
/// Errors: "file-not-found", "not-readable", "unknown-format", "bad-file" (with what is wrong and where), "non-finite", "too-far" (beyond 1e9 m,
/// which no project could hold), "empty-mesh", "too-large", and those of askWorker(). A body that is readable but not usable as an element is no error here: `closed` is false.
Result<ImportResult> importFile(const ImportRequest& request, const Progress& progress);

}  // namespace imomushi
