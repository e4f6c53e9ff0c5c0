// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/block_cholesky.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Vector3d;

BlockCholesky::BlockCholesky(int n, const std::vector<std::pair<int, int>>& pairs) : position_(n, -1) {
    std::vector<std::set<int>> graph(n);
    for (const auto& [i, j] : pairs)
        if (i != j) graph[i].insert(j), graph[j].insert(i);

    std::vector<std::vector<int>> column;
    for (int k = 0; k < n; ++k) {
        int next = -1;
        for (int i = 0; i < n; ++i)
            if (position_[i] < 0 && (next < 0 || graph[i].size() < graph[next].size())) next = i;
        position_[next] = k;
        order_.push_back(next);
        column.emplace_back(graph[next].begin(), graph[next].end());
        for (const int a : graph[next]) {
            graph[a].erase(next);
            for (const int b : graph[next])
                if (a != b) graph[a].insert(b);
        }
    }
    first_.push_back(0);
    for (auto& rows : column) {
        for (int& r : rows) r = position_[r];
        std::sort(rows.begin(), rows.end());
        rows_.insert(rows_.end(), rows.begin(), rows.end());
        first_.push_back(static_cast<int>(rows_.size()));
    }
    diagonal_.resize(n);
    below_.resize(rows_.size());
    scaled_.resize(rows_.size());
    for (int k = 0; k < n; ++k)
        for (int a = first_[k]; a < first_[k + 1]; ++a)
            for (int b = first_[k]; b < a; ++b) target_.push_back(slot(rows_[a], rows_[b]));
}

int BlockCholesky::slot(int row, int column) const {
    const auto begin = rows_.begin() + first_[column], end = rows_.begin() + first_[column + 1];
    const auto found = std::lower_bound(begin, end, row);
    assert(found != end && *found == row);
    return static_cast<int>(found - rows_.begin());
}

void BlockCholesky::setZero() {
    for (auto& m : diagonal_) m.setZero();
    for (auto& m : below_) m.setZero();
}

void BlockCholesky::add(int i, int j, const Matrix3d& block) {
    const int a = position_[i], b = position_[j];
    if (a == b)
        diagonal_[a] += block;
    else if (a > b)
        below_[slot(a, b)] += block;
    else
        below_[slot(b, a)] += block.transpose();
}

namespace {

// Replaces a symmetric positive definite matrix by its inverse, by way of its Cholesky factor.
bool invert(Matrix3d& m) {
    const double scale = m(0, 0) + m(1, 1) + m(2, 2);
    const double least = scale * 1e-15;
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
    Matrix3d inverse = Matrix3d::Zero();  // of the factor
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

bool BlockCholesky::factorise() {
    std::size_t update = 0;
    for (std::size_t k = 0; k < diagonal_.size(); ++k) {
        if (!invert(diagonal_[k])) return false;
        for (int a = first_[k]; a < first_[k + 1]; ++a) {
            scaled_[a].noalias() = below_[a] * diagonal_[k];
            for (int b = first_[k]; b < a; ++b)
                below_[target_[update++]].noalias() -= scaled_[a] * below_[b].transpose();
            diagonal_[rows_[a]].noalias() -= scaled_[a] * below_[a].transpose();
        }
    }
    return true;
}

void BlockCholesky::solve(std::span<Vector3d> b) const {
    const int n = static_cast<int>(diagonal_.size());
    for (int k = 0; k < n; ++k)
        for (int a = first_[k]; a < first_[k + 1]; ++a) b[order_[rows_[a]]].noalias() -= scaled_[a] * b[order_[k]];
    for (int k = n - 1; k >= 0; --k) {
        Vector3d x = diagonal_[k] * b[order_[k]];
        for (int a = first_[k]; a < first_[k + 1]; ++a) x.noalias() -= scaled_[a].transpose() * b[order_[rows_[a]]];
        b[order_[k]] = x;
    }
}

}  // namespace imomushi
