// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/io/gltf_file_reader.h"
#include "core/io/raw_scene.h"

namespace imomushi {

/// What a scene calls the things that a VRM file numbers. Empty or -1: the scene does not have it.
struct VrmNames {
    std::function<int(std::size_t node)> bone;                                   ///< of the rig
    std::function<std::string(std::size_t node)> part;                           ///< that is its mesh
    std::function<std::string(std::size_t node, std::size_t target)> morph;
    std::function<std::string(std::size_t material)> material;
};

/// VRM 0.x or 1.0, by the extensions of the root: a VRM file is a GLB file that has one of them.
enum class Vrm { None, Zero, One };
Vrm vrmOf(const GltfFileReader& file);

/// Nodes that are bones whatever skins say: humanoid ones and those that swing.
std::vector<std::size_t> vrmNodes(const GltfFileReader& file);

/// Sets rig.roles, and rig.avatar to a JSON object of:
///   version: "0.x" or "1.0"; meta: as VRMC_vrm 1.0 has it, and the picture that it names as thumbnail: {mimeType, data}, in base64; original: of 0.x, the texts of its own meta, which say the licence
///   expressions: [{name, preset, isBinary, overrideBlink, overrideLookAt, overrideMouth, morphs: [{target, weight}], colors: [{material, type, targetValue}],
///     textures: [{material, scale, offset}]}], names of presets as in 1.0
///   lookAt: as in 1.0; firstPerson: [{part, type}]
///   springBone: as VRMC_springBone 1.0 has it with the name of a bone, "bone", for each node
/// What does not fit is left out and told, like what has no effect here.
void readVrm(GltfFileReader& file, const VrmNames& names, Rig& rig, RawScene& scene);

}  // namespace imomushi
