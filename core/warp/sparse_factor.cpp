// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/warp/sparse_factor.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>

namespace imomushi {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

Matrix matrixOf(Eigen::Index size, const std::vector<SparseEntry>& entries) {
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(entries.size());
    for (const auto& e : entries) triplets.emplace_back(e.row, e.column, e.value);
    Matrix m(size, size);
    m.setFromTriplets(triplets.begin(), triplets.end());
    return m;
}

using Factor = Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::AMDOrdering<int>>;

}  // namespace

std::optional<SparseFactor> SparseFactor::build(int size, const std::vector<SparseEntry>& entries) {
    SparseFactor out;
    if (size == 0) return out;
    Factor factor(matrixOf(size, entries));
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return {};
    const auto& order = factor.permutationP().indices();
    out.order_.assign(order.data(), order.data() + order.size());
    const Matrix& lower = factor.matrixL().nestedExpression();
    std::vector<std::vector<std::int32_t>> rows(static_cast<std::size_t>(size));  // of each column, below the diagonal
    std::vector<std::vector<float>> values(rows.size());
    for (int j = 0; j < size; ++j) {
        for (Matrix::InnerIterator it(lower, j); it; ++it)
            if (it.row() > j) {
                rows[j].push_back(static_cast<std::int32_t>(it.row()));
                values[j].push_back(static_cast<float>(it.value()));
            }
        out.inverse_.push_back(static_cast<float>(1.0 / factor.vectorD()[j]));
    }
    const auto nests = [&](int j) {  // column j has the rows of the next column and the next column itself
        return rows[j].size() == rows[j + 1].size() + 1 && rows[j][0] == j + 1 && std::equal(rows[j].begin() + 1, rows[j].end(), rows[j + 1].begin());
    };
    for (int j = 0; j < size;) {
        Supernode node{j, 1, static_cast<std::int32_t>(out.rows_.size()), 0, static_cast<std::int64_t>(out.values_.size())};
        while (node.width < kMaxWidth && j + node.width < size && nests(j + node.width - 1)) ++node.width;
        const auto& below = rows[j + node.width - 1];
        node.rows = static_cast<std::int32_t>(below.size());
        out.rows_.insert(out.rows_.end(), below.begin(), below.end());
        for (int r = 1; r < node.width; ++r)
            for (int c = 0; c < r; ++c) out.values_.push_back(values[j + c][r - c - 1]);
        for (std::size_t r = 0; r < below.size(); ++r)
            for (int c = 0; c < node.width; ++c) out.values_.push_back(values[j + c][r + static_cast<std::size_t>(node.width - c - 1)]);
        out.supernodes_.push_back(node);
        j += node.width;
    }
    return out;
}

template <int width>
void SparseFactor::forward(const Supernode& node, Eigen::Vector4f* b) const {
    const float* value = values_.data() + node.firstValue;
    std::array<Eigen::Vector4f, width> x;
    for (int c = 0; c < width; ++c) {
        x[c] = b[node.column + c];
        for (int k = 0; k < c; ++k) x[c] -= *value++ * x[k];
        b[node.column + c] = x[c];
    }
    const std::int32_t* row = rows_.data() + node.firstRow;
    for (std::int32_t r = 0; r < node.rows; ++r, value += width) {
        Eigen::Vector4f sum = b[row[r]];
        for (int c = 0; c < width; ++c) sum -= value[c] * x[c];
        b[row[r]] = sum;
    }
}

template <int width>
void SparseFactor::backward(const Supernode& node, Eigen::Vector4f* b) const {
    constexpr int kTriangle = width * (width - 1) / 2;
    const float* triangle = values_.data() + node.firstValue;
    const float* value = triangle + kTriangle;
    std::array<Eigen::Vector4f, width> x;
    for (int c = 0; c < width; ++c) x[c] = inverse_[node.column + c] * b[node.column + c];
    const std::int32_t* row = rows_.data() + node.firstRow;
    for (std::int32_t r = 0; r < node.rows; ++r, value += width) {
        const Eigen::Vector4f below = b[row[r]];
        for (int c = 0; c < width; ++c) x[c] -= value[c] * below;
    }
    for (int c = width; c-- > 0;) {
        for (int r = c + 1; r < width; ++r) x[c] -= triangle[r * (r - 1) / 2 + c] * x[r];
        b[node.column + c] = x[c];
    }
}

void SparseFactor::solve(Eigen::Vector4f* b) const {
    using Step = void (SparseFactor::*)(const Supernode&, Eigen::Vector4f*) const;
    static constexpr Step kForward[kMaxWidth] = {&SparseFactor::forward<1>, &SparseFactor::forward<2>, &SparseFactor::forward<3>, &SparseFactor::forward<4>};
    static constexpr Step kBackward[kMaxWidth] = {&SparseFactor::backward<1>, &SparseFactor::backward<2>, &SparseFactor::backward<3>, &SparseFactor::backward<4>};
    for (const Supernode& node : supernodes_) (this->*kForward[node.width - 1])(node, b);
    for (auto node = supernodes_.rbegin(); node != supernodes_.rend(); ++node) (this->*kBackward[node->width - 1])(*node, b);
}

std::optional<Eigen::VectorXd> solveSparse(const std::vector<SparseEntry>& entries, const Eigen::VectorXd& right) {
    if (right.size() == 0) return right;
    const Factor factor(matrixOf(right.size(), entries));
    if (factor.info() != Eigen::Success) return {};
    return Eigen::VectorXd(factor.solve(right));
}

}  // namespace imomushi
