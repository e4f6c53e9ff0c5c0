// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/mesh/mesh.h"

namespace imomushi {

/// An axis-aligned bounding box.
struct Box {
    Vec3 low, high;
};

/// A large square matrix whose entries are computed when they are asked for, with three rows and three columns per node. The rows of a node are taken
/// at a collocation point; its columns integrate over a piece of the surface around that point. All functions are called from several threads at once
/// and throw nothing but std::bad_alloc.
class BlockSource {
public:
    /// Some columns, prepared once to compute many of their rows.
    class Columns {
    public:
        virtual ~Columns() = default;
        /// Fills `out`, 3 #rowNodes x 3 #columns by columns without gaps.
        virtual void rows(std::span<const std::int32_t> rowNodes, double* out) const = 0;
    };

    virtual ~BlockSource() = default;
    [[nodiscard]] virtual std::int32_t nodes() const = 0;
    /// The collocation point of a node.
    [[nodiscard]] virtual Vec3 position(std::int32_t node) const = 0;
    /// Bounds of what the columns of a node integrate over. Outside of this box entries are smooth functions of the collocation point.
    [[nodiscard]] virtual Box support(std::int32_t node) const = 0;
    [[nodiscard]] virtual std::unique_ptr<Columns> columns(std::span<const std::int32_t> columnNodes) const = 0;
};

}  // namespace imomushi
