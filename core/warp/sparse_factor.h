// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace imomushi {

struct SparseEntry {
    std::int32_t row, column;
    double value;
};

/// L D L^T of a sparse symmetric positive definite matrix with a minimum-degree order, kept in single precision for many solves of three right-hand
/// sides at once. The factorisation itself is in double precision.
class SparseFactor {
public:
    SparseFactor() = default;
    /// size: of the matrix; entries: of the whole of it, those at the same place add up. Empty: not positive definite to rounding.
    static std::optional<SparseFactor> build(int size, const std::vector<SparseEntry>& entries);

    /// Where each row comes in the order of elimination.
    [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
    /// Replaces b (size() vectors in the order of elimination, 16-byte aligned) by the solution. Does not allocate.
    void solve(Eigen::Vector4f* b) const;
    [[nodiscard]] std::size_t entries() const { return values_.size() + inverse_.size(); }
    [[nodiscard]] std::size_t bytes() const {
        return (values_.size() + inverse_.size()) * sizeof(float) + rows_.size() * sizeof(std::int32_t) + panels_.size() * sizeof(Panel);
    }

private:
    // Columns of L that follow each other and have the same rows below: their part of a vector is read and written once for all.
    static constexpr int kPanel = 4;
    struct Panel {
        std::int32_t column = 0, width = 0;
        std::int32_t firstRow = 0, rows = 0;  // in rows_: those below the last column
        std::int64_t firstValue = 0;          // in values_: the triangle row by row, then each row
    };
    template <int width>
    void forward(const Panel& panel, Eigen::Vector4f* b) const;
    template <int width>
    void backward(const Panel& panel, Eigen::Vector4f* b) const;

    std::vector<std::int32_t> order_, rows_;
    std::vector<Panel> panels_;
    std::vector<float> values_, inverse_;  // of L, of D
};

/// Solves one such system in double precision. Empty: not positive definite to rounding.
std::optional<Eigen::VectorXd> solveSparse(const std::vector<SparseEntry>& entries, const Eigen::VectorXd& right);

}  // namespace imomushi
