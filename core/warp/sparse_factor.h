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

/// L D L^T of a sparse symmetric positive definite matrix in minimum-degree order. Eigen (SimplicialLDLT) factorises once in double precision; the factors are
/// kept in single precision, in supernodes, for solves of three right-hand sides at once. Eigen's own solve() would keep double precision, take one column
/// of L at a time and allocate a permuted copy per frame.
class SparseFactor {
public:
    SparseFactor() = default;
    /// size: of the matrix; entries: of the whole of it, those at the same place add up. Empty: not positive definite to rounding.
    static std::optional<SparseFactor> build(int size, const std::vector<SparseEntry>& entries);

    /// Position of each row in the elimination order.
    [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
    /// Replaces b (size() vectors in the order of elimination, 16-byte aligned) by the solution. Does not allocate.
    void solve(Eigen::Vector4f* b) const;
    [[nodiscard]] std::size_t entries() const { return values_.size() + inverse_.size(); }
    [[nodiscard]] std::size_t bytes() const {
        return (values_.size() + inverse_.size()) * sizeof(float) + rows_.size() * sizeof(std::int32_t) + supernodes_.size() * sizeof(Supernode);
    }

private:
    // Supernode: consecutive columns of L with the same rows below, for which a vector is read and written once.
    static constexpr int kMaxWidth = 4;
    struct Supernode {
        std::int32_t column = 0, width = 0;
        std::int32_t firstRow = 0, rows = 0;  // in rows_: those below the last column
        std::int64_t firstValue = 0;          // in values_: the triangle below the diagonal row by row, then the rows
    };
    template <int width>
    void forward(const Supernode& node, Eigen::Vector4f* b) const;
    template <int width>
    void backward(const Supernode& node, Eigen::Vector4f* b) const;

    std::vector<std::int32_t> order_, rows_;
    std::vector<Supernode> supernodes_;
    std::vector<float> values_, inverse_;  // of L, of D
};

/// Solves one such system in double precision, once. Empty: not positive definite to rounding.
std::optional<Eigen::VectorXd> solveSparse(const std::vector<SparseEntry>& entries, const Eigen::VectorXd& right);

}  // namespace imomushi
