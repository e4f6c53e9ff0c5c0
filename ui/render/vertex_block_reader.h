// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "core/character/deform_input.h"

namespace imomushi::render {

/// Reads the free vertices of an element out of the blocks in which the processor keeps them (VertexBlocks), in any number format.
class VertexBlockReader {
public:
    explicit VertexBlockReader(const DeformInput::Element& element)
        : element_(element), blocks_(element.blocks), columns_(static_cast<std::size_t>(blocks_.columns)), pairs_((columns_ + 1) / 2) {}

    /// Where a vertex is: its block, and the lane of its x.
    struct Place {
        std::size_t block, lane;
    };
    /// body(i-th free vertex, its place)
    template <class Body>
    void forEachFreeVertex(const Body& body) const {
        std::size_t block = 0;
        for (std::size_t i = 0; i < element_.free.size(); ++i) {
            const std::int32_t v = element_.free[i];
            while (v >= blocks_.first[block] + kVertexBlock) ++block;
            body(i, Place{block, static_cast<std::size_t>(v - blocks_.first[block])});
        }
    }
    /// m
    [[nodiscard]] Eigen::Vector3f rest(const Place& at) const {
        const float* x = blocks_.rest + at.block * 3 * kVertexBlock + at.lane;
        return {x[0], x[kVertexBlock], x[2 * kVertexBlock]};
    }
    /// Entry of A' (without the scale of its mode).
    [[nodiscard]] float response(const Place& at, std::size_t mode, std::size_t axis) const {
        constexpr std::size_t kStride = 3 * kVertexBlock;
        const std::size_t lane = at.lane + axis * kVertexBlock;
        switch (blocks_.format) {
            case ResponseFormat::Float: return static_cast<const float*>(blocks_.response)[(at.block * columns_ + mode) * kStride + lane];
            case ResponseFormat::Half: return static_cast<float>(static_cast<const Eigen::half*>(blocks_.response)[(at.block * columns_ + mode) * kStride + lane]);
            case ResponseFormat::Int16:
                return static_cast<const std::int16_t*>(blocks_.response)[2 * ((at.block * pairs_ + mode / 2) * kStride + lane) + mode % 2];
        }
        return 0.0f;
    }
    [[nodiscard]] std::size_t modes() const { return columns_; }

private:
    const DeformInput::Element& element_;
    const VertexBlocks& blocks_;
    const std::size_t columns_, pairs_;
};

}  // namespace imomushi::render
