// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/io/gltf_file_reader.h"
#include "core/io/rig_builder.h"

namespace imomushi {

/// Gives the animations of a glTF file to `rig`. `rigNode`: per node of the file its index there, -1: none. An animation that is damaged is left out and told in `scene`.
void readGltfClips(GltfFileReader& file, const std::vector<int>& rigNode, RigBuilder& rig, RawScene& scene);

}  // namespace imomushi
