// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
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

/// A shape of the file that vertices go towards: weight times delta is added to their places at rest. The shape that came in is that of `atRest`.
struct MorphTarget {
    std::string name;                    ///< UTF-8, not empty, unique in the model
    double atRest = 0.0;                 ///< its weight in the shape of RenderModel::mesh
    std::vector<std::int32_t> vertices;  ///< of RenderModel::mesh.body that it moves, ascending
    Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> deltas;  ///< #vertices x 3, m per unit of weight
};

/// Why morph targets cannot be used with that many vertices: names that are empty or used twice, indices out of range or order, numbers that are not finite or too large. Empty: they can.
std::string checkMorphs(const std::vector<MorphTarget>& morphs, std::size_t vertices);

/// Limits of what is kept of a file; more is left out with a word to the artist.
inline constexpr std::size_t kMostMorphs = 1024, kMostMorphDeltas = std::size_t{1} << 25;  ///< targets; vertices of all together
inline constexpr double kLargestMorphWeight = 1e6;

/// What is seen of a whole character: the file's own vertices, triangles, parts, materials and texture coordinates, in the order of the file. Open, non-manifold,
/// self-intersecting: anything goes, since a body moves it. Never changed after import.
struct RenderModel {
    ElementMesh mesh;                 ///< its `body` is the file's vertices (finite) and triangles (indices in range), closed or not
    std::vector<std::int32_t> part;   ///< #F into parts
    std::vector<std::string> parts;   ///< names by the file's objects or nodes; UTF-8, not empty, not unique
    std::vector<MorphTarget> morphs = {};  ///< in the order of the file

    /// The vertices of the file are those of another one, bit for bit: what is said of one by its number is true of the other.
    [[nodiscard]] bool sameVertices(const RenderModel& other) const;
    /// Made when first asked for and kept with this object, which must not change afterwards. Any thread may ask.
    [[nodiscard]] const ModelParts& namedParts() const;
    [[nodiscard]] int morphIndex(std::string_view name) const;  ///< -1: no such target
    mutable KeptParts parts_ = {};    ///< use namedParts()
};

}  // namespace imomushi
