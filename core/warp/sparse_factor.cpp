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
    const auto nests = [&](int j) {  // column j has the next one and its rows
        return rows[j].size() == rows[j + 1].size() + 1 && rows[j][0] == j + 1 && std::equal(rows[j].begin() + 1, rows[j].end(), rows[j + 1].begin());
    };
    for (int j = 0; j < size;) {
        Panel panel{j, 1, static_cast<std::int32_t>(out.rows_.size()), 0, static_cast<std::int64_t>(out.values_.size())};
        while (panel.width < kPanel && j + panel.width < size && nests(j + panel.width - 1)) ++panel.width;
        const auto& below = rows[j + panel.width - 1];
        panel.rows = static_cast<std::int32_t>(below.size());
        out.rows_.insert(out.rows_.end(), below.begin(), below.end());
        for (int r = 1; r < panel.width; ++r)
            for (int c = 0; c < r; ++c) out.values_.push_back(values[j + c][r - c - 1]);
        for (std::size_t r = 0; r < below.size(); ++r)
            for (int c = 0; c < panel.width; ++c) out.values_.push_back(values[j + c][r + static_cast<std::size_t>(panel.width - c - 1)]);
        out.panels_.push_back(panel);
        j += panel.width;
    }
    return out;
}

template <int width>
void SparseFactor::forward(const Panel& panel, Eigen::Vector4f* b) const {
    const float* value = values_.data() + panel.firstValue;
    std::array<Eigen::Vector4f, width> x;
    for (int c = 0; c < width; ++c) {
        x[c] = b[panel.column + c];
        for (int k = 0; k < c; ++k) x[c] -= *value++ * x[k];
        b[panel.column + c] = x[c];
    }
    const std::int32_t* row = rows_.data() + panel.firstRow;
    for (std::int32_t r = 0; r < panel.rows; ++r, value += width) {
        Eigen::Vector4f sum = b[row[r]];
        for (int c = 0; c < width; ++c) sum -= value[c] * x[c];
        b[row[r]] = sum;
    }
}

template <int width>
void SparseFactor::backward(const Panel& panel, Eigen::Vector4f* b) const {
    constexpr int kTriangle = width * (width - 1) / 2;
    const float* triangle = values_.data() + panel.firstValue;
    const float* value = triangle + kTriangle;
    std::array<Eigen::Vector4f, width> x;
    for (int c = 0; c < width; ++c) x[c] = inverse_[panel.column + c] * b[panel.column + c];
    const std::int32_t* row = rows_.data() + panel.firstRow;
    for (std::int32_t r = 0; r < panel.rows; ++r, value += width) {
        const Eigen::Vector4f below = b[row[r]];
        for (int c = 0; c < width; ++c) x[c] -= value[c] * below;
    }
    for (int c = width; c-- > 0;) {
        for (int r = c + 1; r < width; ++r) x[c] -= triangle[r * (r - 1) / 2 + c] * x[r];
        b[panel.column + c] = x[c];
    }
}

void SparseFactor::solve(Eigen::Vector4f* b) const {
    using Step = void (SparseFactor::*)(const Panel&, Eigen::Vector4f*) const;
    static constexpr Step kForward[kPanel] = {&SparseFactor::forward<1>, &SparseFactor::forward<2>, &SparseFactor::forward<3>, &SparseFactor::forward<4>};
    static constexpr Step kBackward[kPanel] = {&SparseFactor::backward<1>, &SparseFactor::backward<2>, &SparseFactor::backward<3>, &SparseFactor::backward<4>};
    for (const Panel& panel : panels_) (this->*kForward[panel.width - 1])(panel, b);
    for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) (this->*kBackward[panel->width - 1])(*panel, b);
}

std::optional<Eigen::VectorXd> solveSparse(const std::vector<SparseEntry>& entries, const Eigen::VectorXd& right) {
    if (right.size() == 0) return right;
    const Factor factor(matrixOf(right.size(), entries));
    if (factor.info() != Eigen::Success) return {};
    return Eigen::VectorXd(factor.solve(right));
}

}  // namespace imomushi
