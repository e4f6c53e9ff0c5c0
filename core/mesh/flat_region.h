// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/mesh/mesh.h"

namespace imomushi {

/// Whether a part of a surface is flat and large beside the rest, so that it may be meant as a joint face: elements that were modelled as such have one, creatures do not. Triangles
/// of one plane count together, wherever they are; the answer does not depend on size and place of the mesh. False for a mesh without area.
bool hasFlatRegion(const TriangleMesh& mesh);

}  // namespace imomushi
