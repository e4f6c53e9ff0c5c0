// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStringList>

#include "core/body/body.h"

namespace imomushi {

/// "exact", "mended", "wrapped", translated.
QString bodyKindText(BodyKind how);
/// 0.0123 -> "1.2 % of the diagonal"
QString diagonalShareText(double share);
/// How a body was made and how far it is from what is seen, a line each.
QStringList bodyLines(const Body& body);

}  // namespace imomushi
