// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/block_cholesky.h"

#include <doctest/doctest.h>

#include <random>
#include <utility>
#include <vector>

using namespace imomushi;

namespace {

/// Random blocks on the pattern of a tree with one cycle and a dominant diagonal: the largest error of a solution.
template <int blockSize>
double errorOfSolution(const std::vector<int>& sizes) {
    std::mt19937 random(1);
    const auto number = [&] { return std::uniform_real_distribution<double>(-2.0, 2.0)(random); };
    const int n = static_cast<int>(sizes.size());
    std::vector<std::pair<int, int>> pairs;
    for (int i = 1; i < n; ++i) pairs.emplace_back(i, (i - 1) / 2);
    pairs.emplace_back(n - 1, 3);
    std::vector<int> first{0};
    for (const int size : sizes) first.push_back(first.back() + size);

    using Cholesky = BlockCholesky<blockSize>;
    Cholesky system(sizes, pairs);
    system.setZero();
    Eigen::MatrixXd dense = 20.0 * Eigen::MatrixXd::Identity(first.back(), first.back());
    for (int i = 0; i < n; ++i) system.add(i, i, 20.0 * Cholesky::Block::Identity(sizes[i], sizes[i]));
    for (const auto& [i, j] : pairs) {
        const Eigen::MatrixXd m = Eigen::MatrixXd::NullaryExpr(sizes[i], sizes[j], number);
        system.add(i, j, m);
        dense.block(first[i], first[j], sizes[i], sizes[j]) += m;
        dense.block(first[j], first[i], sizes[j], sizes[i]) += m.transpose();
    }
    const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(first.back(), number), right = dense * x;
    std::vector<typename Cholesky::Vector> b;
    for (int i = 0; i < n; ++i) b.emplace_back(right.segment(first[i], sizes[i]));
    REQUIRE(system.factorise());
    system.solve(b);
    double error = 0.0;
    for (int i = 0; i < n; ++i)
        if (sizes[i] > 0) error = std::max(error, (b[i] - x.segment(first[i], sizes[i])).norm());
    return error;
}

}  // namespace

TEST_CASE("block Cholesky: solves a random positive definite system with the pattern of a tree") {
    CHECK(errorOfSolution<3>(std::vector<int>(12, 3)) < 1e-12);
    CHECK(errorOfSolution<Eigen::Dynamic>({3, 5, 4, 3, 0, 6, 3, 1, 2, 5, 4, 3}) < 1e-12);
}

TEST_CASE("block Cholesky: a matrix that is not positive definite is refused") {
    BlockCholesky<3> three({3, 3}, {{0, 1}});
    three.setZero();
    three.add(0, 0, Eigen::Matrix3d::Identity());
    three.add(1, 1, -Eigen::Matrix3d::Identity());
    CHECK_FALSE(three.factorise());
    BlockCholesky<Eigen::Dynamic> any({2, 1}, {{0, 1}});
    any.setZero();
    any.add(0, 0, Eigen::Matrix2d::Identity());
    any.add(1, 1, Eigen::MatrixXd::Constant(1, 1, -1.0));
    CHECK_FALSE(any.factorise());
}
