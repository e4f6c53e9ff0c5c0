// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStringList>

#include "core/body/body.h"
#include "core/body/repair.h"
#include "core/document/document.h"

namespace imomushi {

/// "exact", "mended", "wrapped", translated.
QString bodyKindText(BodyKind how);
/// "Weld", "Fill", ...: what a button says that does it.
QString repairText(RepairAction action);
/// 0.0123 -> "1.2 % of the diagonal"
QString diagonalShareText(double share);
/// How a body was made and how far it is from what is seen, a line each.
QStringList bodyLines(const Body& body);
/// Vertices of all that is seen: of meshes of characters, and of elements of their own.
long long verticesOf(const Document& document);

}  // namespace imomushi
