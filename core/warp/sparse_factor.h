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
        return values_.size() * (sizeof(float) + sizeof(std::int32_t)) + inverse_.size() * (sizeof(float) + sizeof(std::int32_t));
    }

private:
    std::vector<std::int32_t> order_, first_, rows_;  // columns of L below the diagonal
    std::vector<float> values_, inverse_;             // of L, of D
};

/// Solves one such system in double precision. Empty: not positive definite to rounding.
std::optional<Eigen::VectorXd> solveSparse(const std::vector<SparseEntry>& entries, const Eigen::VectorXd& right);

}  // namespace imomushi
