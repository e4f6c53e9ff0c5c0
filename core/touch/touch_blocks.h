// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/reduction/element_response.h"

namespace imomushi {

/// The displacement of touch as the frame adds it: blocks of vertices that follow each other in the body's order, x of all, y of all, z of all,
/// single precision. Only patches that are pressed are read. Copies share the response and have weights of their own.
class TouchBlocks {
public:
    static constexpr int kBlock = 16;  ///< vertices of a block

    TouchBlocks() = default;
    /// first: per block its first body vertex (blocks may overlap; vertices without a response stay at rest).
    TouchBlocks(const ElementResponse& response, std::span<const std::int32_t> first);

    /// The forces of the patches (TouchContact::patchForces()). Does not allocate.
    void weigh(const Eigen::VectorXd& patchForces);
    [[nodiscard]] bool idle() const { return active_ == 0; }
    [[nodiscard]] int activeColumns() const { return active_; }

    /// Adds the displacement to blocks [begin, end) of `local` (3 kBlock per block, m), which is aligned to 16 bytes. Blocks are independent: threads
    /// share them.
    void add(std::size_t begin, std::size_t end, float* local) const;

    [[nodiscard]] std::size_t count() const { return columns_ > 0 ? data_->size() / (static_cast<std::size_t>(columns_) * 3 * kBlock) : 0; }
    [[nodiscard]] std::size_t bytes() const { return data_ ? data_->size() * sizeof(float) : 0; }

private:
    using Data = std::vector<float, Eigen::aligned_allocator<float>>;
    int columns_ = 0, active_ = 0;
    std::shared_ptr<const Data> data_;  // per block, per column, 3 kBlock
    std::vector<std::int32_t> which_;   // columns that are active, active_ of them
    std::vector<float> weights_;        // theirs
};

}  // namespace imomushi
