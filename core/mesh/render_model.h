// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/model_parts.h"

namespace imomushi {

/// Of RenderModel alone: a place for its named parts. A copy begins empty, since the copy may be changed.
struct KeptParts {
    KeptParts() = default;
    KeptParts(const KeptParts&) noexcept {}
    KeptParts& operator=(const KeptParts&) noexcept {
        kept.store(nullptr);
        return *this;
    }
    std::atomic<std::shared_ptr<const ModelParts>> kept;
};

/// What is seen of a whole character: the file's own vertices, triangles, parts, materials and texture coordinates, in the order of the file. Open, non-manifold,
/// self-intersecting: anything goes, since a body moves it. Never changed after import.
struct RenderModel {
    ElementMesh mesh;                 ///< its `body` is the file's vertices (finite) and triangles (indices in range), closed or not
    std::vector<std::int32_t> part;   ///< #F into parts
    std::vector<std::string> parts;   ///< names by the file's objects or nodes; UTF-8, not empty, not unique

    /// Made when first asked for and kept with this object, which must not change afterwards. Any thread may ask.
    [[nodiscard]] const ModelParts& namedParts() const;
    mutable KeptParts parts_ = {};    ///< use namedParts()
};

}  // namespace imomushi
