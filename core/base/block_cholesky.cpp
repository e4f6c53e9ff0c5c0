// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/block_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

namespace imomushi {

namespace {

// Replaces a symmetric positive definite matrix by its inverse, from its Cholesky factor. False: not positive definite to rounding.
bool invert(Eigen::Matrix3d& m) {
    constexpr double kRounding = 1e-15;  // of the trace
    const double least = (m(0, 0) + m(1, 1) + m(2, 2)) * kRounding;
    if (!(m(0, 0) > least)) return false;
    const double l00 = std::sqrt(m(0, 0));
    const double l10 = m(1, 0) / l00, l20 = m(2, 0) / l00;
    const double d1 = m(1, 1) - l10 * l10;
    if (!(d1 > least)) return false;
    const double l11 = std::sqrt(d1);
    const double l21 = (m(2, 1) - l20 * l10) / l11;
    const double d2 = m(2, 2) - l20 * l20 - l21 * l21;
    if (!(d2 > least)) return false;
    const double l22 = std::sqrt(d2);
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  // of the factor
    inverse(0, 0) = 1.0 / l00;
    inverse(1, 1) = 1.0 / l11;
    inverse(2, 2) = 1.0 / l22;
    inverse(1, 0) = -l10 * inverse(0, 0) * inverse(1, 1);
    inverse(2, 1) = -l21 * inverse(1, 1) * inverse(2, 2);
    inverse(2, 0) = -(l20 * inverse(0, 0) + l21 * inverse(1, 0)) * inverse(2, 2);
    m.noalias() = inverse.transpose() * inverse;
    return true;
}

}  // namespace

template <int blockSize>
BlockCholesky<blockSize>::BlockCholesky(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& pairs) : position_(sizes.size(), -1) {
    const int n = static_cast<int>(sizes.size());
    std::vector<std::set<int>> graph(n);
    for (const auto& [i, j] : pairs)
        if (i != j) graph[i].insert(j), graph[j].insert(i);

    std::vector<std::vector<int>> columns;
    for (int k = 0; k < n; ++k) {
        int next = -1;
        for (int i = 0; i < n; ++i)
            if (position_[i] < 0 && (next < 0 || graph[i].size() < graph[next].size())) next = i;
        position_[next] = k;
        order_.push_back(next);
        columns.emplace_back(graph[next].begin(), graph[next].end());
        for (const int a : graph[next]) {
            graph[a].erase(next);
            for (const int b : graph[next])
                if (a != b) graph[a].insert(b);
        }
    }
    first_.push_back(0);
    for (int k = 0; k < n; ++k) {
        const int size = sizes[order_[k]];
        diagonal_.emplace_back(Block::Zero(size, size));
        for (int& row : columns[k]) row = position_[row];
        std::sort(columns[k].begin(), columns[k].end());
        rows_.insert(rows_.end(), columns[k].begin(), columns[k].end());
        for (const int row : columns[k]) below_.emplace_back(Block::Zero(sizes[order_[row]], size));
        first_.push_back(static_cast<int>(rows_.size()));
    }
    if constexpr (blockSize == 3) scaled_ = below_;
    for (int k = 0; k < n; ++k)
        for (int a = first_[k]; a < first_[k + 1]; ++a)
            for (int b = first_[k]; b < a; ++b) target_.push_back(slot(rows_[a], rows_[b]));
}

template <int blockSize>
int BlockCholesky<blockSize>::slot(int row, int column) const {
    const auto begin = rows_.begin() + first_[column], end = rows_.begin() + first_[column + 1];
    const auto found = std::lower_bound(begin, end, row);
    assert(found != end && *found == row);
    return static_cast<int>(found - rows_.begin());
}

template <int blockSize>
const std::vector<typename BlockCholesky<blockSize>::Block>& BlockCholesky<blockSize>::lower() const {
    if constexpr (blockSize == 3)
        return scaled_;
    else
        return below_;
}

template <int blockSize>
void BlockCholesky<blockSize>::setZero() {
    for (auto& m : diagonal_) m.setZero();
    for (auto& m : below_) m.setZero();
}

template <int blockSize>
typename BlockCholesky<blockSize>::Block& BlockCholesky<blockSize>::block(int i, int j, bool& transposed) {
    const int a = position_[i], b = position_[j];
    transposed = a < b;
    return a == b ? diagonal_[a] : below_[slot(std::max(a, b), std::min(a, b))];
}

template <int blockSize>
void BlockCholesky<blockSize>::add(int i, int j, const Block& block) {
    const int a = position_[i], b = position_[j];
    if (a == b)
        diagonal_[a] += block;
    else if (a > b)
        below_[slot(a, b)] += block;
    else
        below_[slot(b, a)] += block.transpose();
}

template <int blockSize>
bool BlockCholesky<blockSize>::factorise() {
    std::size_t update = 0;
    for (std::size_t k = 0; k < diagonal_.size(); ++k) {
        const int begin = first_[k], end = first_[k + 1];
        Block& pivot = diagonal_[k];
        if constexpr (blockSize == 3) {
            if (!invert(pivot)) return false;
        } else {
            if (pivot.rows() == 0) {
                update += static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(end - begin - 1) / 2;
                continue;
            }
            Eigen::Ref<Block> inPlace(pivot);
            if (Eigen::LLT<Eigen::Ref<Block>>(inPlace).info() != Eigen::Success) return false;
        }
        for (int a = begin; a < end; ++a) {
            if constexpr (blockSize == 3)
                scaled_[a].noalias() = below_[a] * pivot;
            else
                pivot.template triangularView<Eigen::Lower>().transpose().template solveInPlace<Eigen::OnTheRight>(below_[a]);
            const Block& left = lower()[a];
            for (int b = begin; b < a; ++b) below_[target_[update++]].noalias() -= left * below_[b].transpose();
            diagonal_[rows_[a]].noalias() -= left * below_[a].transpose();
        }
    }
    return true;
}

template <int blockSize>
void BlockCholesky<blockSize>::solve(std::span<Vector> b) const {
    const int n = static_cast<int>(diagonal_.size());
    for (int k = 0; k < n; ++k) {
        Vector& x = b[order_[k]];
        if constexpr (blockSize != 3) diagonal_[k].template triangularView<Eigen::Lower>().solveInPlace(x);
        for (int a = first_[k]; a < first_[k + 1]; ++a) b[order_[rows_[a]]].noalias() -= lower()[a] * x;
    }
    for (int k = n - 1; k >= 0; --k) {
        Vector& x = b[order_[k]];
        if constexpr (blockSize == 3) x = (diagonal_[k] * x).eval();
        for (int a = first_[k]; a < first_[k + 1]; ++a) x.noalias() -= lower()[a].transpose() * b[order_[rows_[a]]];
        if constexpr (blockSize != 3) diagonal_[k].template triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    }
}

template class BlockCholesky<3>;
template class BlockCholesky<Eigen::Dynamic>;

}  // namespace imomushi
