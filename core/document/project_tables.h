// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/document.h"
#include "core/document/sqlite.h"

// The tables of a project file, in groups: each group is created, written, read and checked in the file project_<group>.cpp. Readers trust nothing and
// throw DatabaseError with what is wrong; writers throw it when a number is not finite or a value is larger than SQLite holds.

namespace imomushi {

/// Meshes with their materials and textures, elements, issues and joint faces. Elements that share a mesh share its row.
void createElementTables(Database& db);
void writeElements(Database& db, const Document& document);
void readElements(Database& db, Document& document);

/// Joints, bones, held endpoints and the pose. Reads after the elements.
void createSkeletonTables(Database& db);
void writeSkeleton(Database& db, const Document& document);
void readSkeleton(Database& db, Document& document);

/// Handles and where they were taken. Reads after the skeleton.
void createHandleTables(Database& db);
void writeHandles(Database& db, const Document& document);
void readHandles(Database& db, Document& document);

void createTakeTables(Database& db);
void writeTakes(Database& db, const Document& document);
void readTakes(Database& db, Document& document);

/// Reads after the elements.
void createEffectTables(Database& db);
void writeEffects(Database& db, const Document& document);
void readEffects(Database& db, Document& document);

}  // namespace imomushi
