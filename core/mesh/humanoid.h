// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/rig.h"

namespace imomushi {

/// The name of a bone as programs agree on it: without the prefix of a rig ("mixamorig:", "Bip01 "), spaces and signs, in lower case. The side of the body is kept.
std::string plainBoneName(std::string_view name);

/// What the bones are of a human: as the file says, else by their names as Mixamo, VRoid, Biped, Rigify and VRM give them. A role whose bone cannot be told from the names is left out.
std::vector<RigRole> humanRoles(const Rig& rig);

}  // namespace imomushi
