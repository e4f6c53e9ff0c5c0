// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/render_vertices.h"

#include <bit>

namespace imomushi {
namespace {

constexpr std::size_t kTexCoord = 3, kColor = 5;  // where they begin in the bits of a key

template <class Row>
void put(std::array<std::uint32_t, 9>& bits, std::size_t at, const Row& row) {
    for (Eigen::Index c = 0; c < row.size(); ++c) bits[at + static_cast<std::size_t>(c)] = std::bit_cast<std::uint32_t>(row[c]);
}

}  // namespace

std::size_t RenderVertices::KeyHash::operator()(const Key& key) const {
    std::uint64_t h = static_cast<std::uint64_t>(key.body) * 0x9e3779b97f4a7c15ULL;
    for (const std::uint32_t b : key.bits) h = (h ^ b) * 0xff51afd7ed558ccdULL, h ^= h >> 32;
    return h;
}

std::int32_t RenderVertices::add(std::int32_t body, std::int32_t r, bool flipped) {
    Key key{body, {}};
    if (from_.normals.rows() > 0) put(key.bits, 0, flipped ? Eigen::RowVector3f(-from_.normals.row(r)) : Eigen::RowVector3f(from_.normals.row(r)));
    if (from_.texCoords.rows() > 0) put(key.bits, kTexCoord, from_.texCoords.row(r));
    if (from_.colors.rows() > 0) put(key.bits, kColor, from_.colors.row(r));
    const auto [it, added] = known_.emplace(key, static_cast<std::int32_t>(keys_.size()));
    if (added) keys_.push_back(key);
    return it->second;
}

void RenderVertices::write(RenderMesh& to) const {
    const bool normals = from_.normals.rows() > 0, texCoords = from_.texCoords.rows() > 0, colors = from_.colors.rows() > 0;
    const auto n = static_cast<Eigen::Index>(keys_.size());
    to.bodyVertex.resize(keys_.size());
    if (normals) to.normals.resize(n, 3);
    if (texCoords) to.texCoords.resize(n, 2);
    if (colors) to.colors.resize(n, 4);
    for (Eigen::Index r = 0; r < n; ++r) {
        const Key& key = keys_[static_cast<std::size_t>(r)];
        to.bodyVertex[static_cast<std::size_t>(r)] = key.body;
        const auto value = [&](std::size_t at, Eigen::Index c) { return std::bit_cast<float>(key.bits[at + static_cast<std::size_t>(c)]); };
        for (Eigen::Index c = 0; normals && c < 3; ++c) to.normals(r, c) = value(0, c);
        for (Eigen::Index c = 0; texCoords && c < 2; ++c) to.texCoords(r, c) = value(kTexCoord, c);
        for (Eigen::Index c = 0; colors && c < 4; ++c) to.colors(r, c) = value(kColor, c);
    }
}

}  // namespace imomushi
