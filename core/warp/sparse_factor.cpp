// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/warp/sparse_factor.h"

#include <Eigen/SparseCholesky>

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
    out.first_.push_back(0);
    if (size == 0) return out;
    Factor factor(matrixOf(size, entries));
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return {};
    const auto& order = factor.permutationP().indices();
    out.order_.assign(order.data(), order.data() + order.size());
    const Matrix& lower = factor.matrixL().nestedExpression();
    for (int j = 0; j < size; ++j) {
        for (Matrix::InnerIterator it(lower, j); it; ++it)
            if (it.row() > j) {
                out.rows_.push_back(static_cast<std::int32_t>(it.row()));
                out.values_.push_back(static_cast<float>(it.value()));
            }
        out.first_.push_back(static_cast<std::int32_t>(out.rows_.size()));
        out.inverse_.push_back(static_cast<float>(1.0 / factor.vectorD()[j]));
    }
    return out;
}

void SparseFactor::solve(Eigen::Vector4f* b) const {
    const auto size = static_cast<std::int32_t>(inverse_.size());
    for (std::int32_t j = 0; j < size; ++j) {
        const Eigen::Vector4f x = b[j];
        for (std::int32_t k = first_[j]; k < first_[j + 1]; ++k) b[rows_[k]] -= values_[k] * x;
    }
    for (std::int32_t j = size - 1; j >= 0; --j) {
        Eigen::Vector4f x = inverse_[j] * b[j];
        for (std::int32_t k = first_[j]; k < first_[j + 1]; ++k) x -= values_[k] * b[rows_[k]];
        b[j] = x;
    }
}

std::optional<Eigen::VectorXd> solveSparse(const std::vector<SparseEntry>& entries, const Eigen::VectorXd& right) {
    if (right.size() == 0) return right;
    const Factor factor(matrixOf(right.size(), entries));
    if (factor.info() != Eigen::Success) return {};
    return Eigen::VectorXd(factor.solve(right));
}

}  // namespace imomushi
