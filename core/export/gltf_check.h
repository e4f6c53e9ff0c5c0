// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/export/gltf_writer.h"

namespace imomushi {

/// Reads a .glb file as other programs do and compares where its animations have the vertices with the character, at ten frames of each clip at most.
/// `checked`: frames. Errors: "not-readable", "cancelled".
Result<ExportError> checkGltf(const std::string& bytes, const GltfContent& content, Motion& motion, int& checked, const Progress& progress);

}  // namespace imomushi
