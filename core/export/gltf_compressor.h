// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/base/result.h"

namespace imomushi {

/// A .glb file as writeGltf() makes it, with what accessors read compressed by meshoptimizer (EXT_meshopt_compression, which readers then must know), without loss. Pictures and what
/// would not become shorter stay as they are. Each compressed view is read back. Errors: "not-readable" (it is not what it was).
Result<std::string> compressGlb(const std::string& glb);

}  // namespace imomushi
