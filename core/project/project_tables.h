// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>

#include "core/document/document.h"
#include "core/mesh/rig.h"
#include "core/project/sqlite.h"

// The tables of a project file, in groups: each group is created, written, read and checked in the file project_<group>.cpp. Readers trust nothing and
// throw DatabaseError with what is wrong; writers throw it when a number is not finite or a text is larger than SQLite holds.

namespace imomushi {

/// Rows of meshes with their materials and textures: of elements, then of the render meshes of characters. What shares a mesh shares its row.
using MeshIds = std::map<const ElementMesh*, int>;
using ReadMeshes = std::map<std::int64_t, std::shared_ptr<ElementMesh>>;
MeshIds writeMeshes(Database& db, const Document& document);
ReadMeshes readMeshes(Database& db);

/// The columns of an issue from "severity" on. `mesh`: where it was found.
MeshIssue readIssue(RowReader& row, const TriangleMesh& mesh);

/// Elements, issues and joint faces; creates the tables of meshes too.
void createElementTables(Database& db);
void writeElements(Database& db, const Document& document, const MeshIds& meshes);
void readElements(Database& db, Document& document, const ReadMeshes& meshes);

/// Characters with their bodies and cuts, and what elements are of them. Reads after the elements and bones.
void createCharacterTables(Database& db);
void writeCharacters(Database& db, const Document& document, const MeshIds& meshes);
void readCharacters(Database& db, Document& document, const ReadMeshes& meshes);

/// Joints, bones, held endpoints and the pose. Reads after the elements.
void createSkeletonTables(Database& db);
void writeSkeleton(Database& db, const Document& document);
void readSkeleton(Database& db, Document& document);

/// Handles and where they were taken. Reads after the skeleton.
void createHandleTables(Database& db);
void writeHandles(Database& db, const Document& document);
void readHandles(Database& db, Document& document);

/// Attached parts of characters and how they are turned. Reads after the characters.
void createAttachmentTables(Database& db);
void writeAttachments(Database& db, const Document& document);
void readAttachments(Database& db, Document& document);

/// Skeletons of characters. Reads after the characters.
void createRigTables(Database& db);
void writeRigs(Database& db, const Document& document);
void readRigs(Database& db, Document& document);

/// Morph targets of characters and their weights. Reads after the characters.
void createMorphTables(Database& db);
void writeMorphs(Database& db, const Document& document);
void readMorphs(Database& db, Document& document);

void createTakeTables(Database& db);
void writeTakes(Database& db, const Document& document);
/// keep false: checks the frames and keeps none.
void readTakes(Database& db, Document& document, bool keep);

/// Reads after the elements.
void createEffectTables(Database& db);
void writeEffects(Database& db, const Document& document);
void readEffects(Database& db, Document& document);

}  // namespace imomushi
