// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/export/gltf_file.h"
#include "core/mesh/rig.h"

namespace imomushi {

/// The rig of the avatar of a scene: the only one with humanoid bones. Errors: "not-an-avatar": there is none, there are several, or one lacks bones that VRM 1.0 wants.
Result<const Rig*> avatarOf(const std::vector<const Rig*>& rigs);

/// Where a file has the things of an avatar. -1: it has them not.
struct VrmPlaces {
    std::function<int(int bone)> node;
    std::function<std::vector<int>(const std::string& part)> parts;  ///< nodes; parts may have one name
    std::vector<int> meshNodes;                                      ///< all nodes with meshes
};

/// Adds what VRM 1.0 wants: VRMC_vrm with the humanoid bones, licence, expressions, first person and look-at that the avatar came with, and VRMC_springBone. Expressions find
/// their targets by names in the meshes of `file`, where these are already. What has no node in it is left out.
void addAvatar(const Rig& rig, const VrmPlaces& places, GltfFile& file);

}  // namespace imomushi
