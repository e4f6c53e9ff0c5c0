// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/io/gltf_file_reader.h"
#include "core/io/rig_builder.h"

namespace imomushi {

/// Gives the animations of a glTF file to `rig`. `rigNode`: per node of the file its index there, -1: none. `morphs`: per node the names of the morph targets of its mesh, empty: left out.
/// An animation that is damaged is left out and told in `scene`.
void readGltfClips(GltfFileReader& file, const std::vector<int>& rigNode, const std::map<std::size_t, std::vector<std::string>>& morphs, RigBuilder& rig, RawScene& scene);

}  // namespace imomushi
