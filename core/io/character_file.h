// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/io/import.h"
#include "core/mesh/render_model.h"
#include "core/mesh/rig.h"

namespace imomushi {

/// A file read as one whole character: its surface as it is, for a body to move.
struct CharacterFile {
    std::string format;             ///< "obj", "ply", "stl", "glb", "gltf", "fbx", "dae"
    double metresPerUnit = 1.0;     ///< scale that was applied
    bool zUpConverted = false;
    RenderModel renderModel;        ///< without triangles where the file brings bones alone
    std::optional<Rig> rig;         ///< the skeleton of the file, or its clips that weigh morph targets; none: it has neither
    std::vector<MeshIssue> issues;  ///< of the file; places are triangles and vertices of the render model's `mesh.body`
};

/// Reads a mesh file as a whole character, as importFile() in a worker and within the same limits. Nothing is mended: all triangles come, degenerate and duplicate
/// ones too, and the vertices with the file's own coordinates after unit and axes, in this order:
/// - OBJ, PLY: as in the file, with those that no triangle uses. Polygons are cut into triangles at their place.
/// - STL: a vertex per place and solid, in the order in which they first appear.
/// - glTF: nodes depth first, primitives in their order, vertices in the order of their accessor, which comes again for each primitive that refers to it; transformations
///   of nodes applied. A skin is posed by the file's joints, a vertex that they move by rounding alone stays as it is in the file. Points and lines are left out.
/// - FBX, DAE: nodes depth first, the vertices of their meshes as assimp gives them (one per corner of a polygon), transformations of nodes applied.
/// Bones are the joints of skins (glTF, FBX, DAE), with the file's animations of them; see RigBuilder for nodes that move parts without a skin. A file of bones without a mesh
/// comes as its rig alone, where `request.bonesSuffice`. Morph targets of glTF, FBX and DAE come with their names; the shape at rest has the file's own weights. Those of one name and weight are
/// one, whichever meshes they are of; clips weigh them by their names.
/// Triangles of mirrored nodes are turned over, so that they face as in the file. A coordinate that is not finite, of a vertex that no triangle uses, becomes 0 and an issue.
/// `request.split` has no meaning. Errors: as importFile(); "empty-mesh" also where all triangles are degenerate().
Result<CharacterFile> importCharacter(const ImportRequest& request, const Progress& progress);

}  // namespace imomushi
