// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/decompositions.h"

#include <doctest/doctest.h>

#include <random>

using namespace imomushi;

namespace {

Eigen::MatrixXd randomMatrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
    std::mt19937 engine(seed);
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return 2.0 * static_cast<double>(engine()) / 4294967296.0 - 1.0; });
}

}  // namespace

TEST_CASE("decompositions: the shortest rotation brings one direction to the other by the angle between them, opposite and nearly opposite ones too") {
    const Vec3 from(0.3, -0.5, 0.8);
    const Vec3 across = from.unitOrthogonal();
    for (const double length : {1e-150, 1.0, 1e150})
        for (const double angle : {0.0, 1e-9, 1.0, 3.0, 3.14, 3.1415926, 3.14159265358979}) {
            CAPTURE(length);
            CAPTURE(angle);
            const Vec3 to = std::cos(angle) * from.normalized() + std::sin(angle) * across;
            const Eigen::Quaterniond turn = shortestRotation(length * from, to);
            CHECK(std::abs(turn.norm() - 1.0) < 1e-9);
            // Near half a turn the sum of the directions has few digits left.
            CHECK((turn * from.normalized() - to).norm() < 1e-7);
            CHECK(std::abs(turn.angularDistance(Eigen::Quaterniond::Identity()) - angle) < 1e-6);
        }
}

TEST_CASE("decompositions: eigenpairs solve their equation, of one matrix and of two") {
    const Eigen::MatrixXd r = randomMatrix(9, 9, 1), a = r + r.transpose(), b = r * r.transpose() + Eigen::MatrixXd::Identity(9, 9);
    const auto one = eigenpairsOf(a);
    REQUIRE(one.converged);
    CHECK((a * one.vectors - one.vectors * one.values.asDiagonal()).norm() < 1e-13 * a.norm());
    CHECK((one.values.tail(8) - one.values.head(8)).minCoeff() >= 0.0);
    const auto two = eigenpairsOf(a, b);
    REQUIRE(two.converged);
    CHECK((a * two.vectors - b * two.vectors * two.values.asDiagonal()).norm() < 1e-12 * a.norm());
    CHECK((two.vectors.transpose() * b * two.vectors - Eigen::MatrixXd::Identity(9, 9)).norm() < 1e-12);
}

TEST_CASE("decompositions: least squares of dependent columns leave what is across them, and take the shortest answer") {
    Eigen::MatrixXd m = randomMatrix(12, 4, 2);
    m.col(3) = m.col(0) - m.col(1);
    const Eigen::VectorXd right = randomMatrix(12, 1, 3);
    const Eigen::VectorXd x = leastSquares(m, right);
    CHECK((m.transpose() * (m * x - right)).norm() < 1e-13 * right.norm() * m.norm());
    CHECK(std::abs(x[0] - x[1] - x[3]) < 1e-13 * x.norm());  // nothing along (1, -1, 0, -1), which m maps to zero
    CHECK((leastSquares(m, Eigen::MatrixXd(right)) - x).norm() < 1e-13 * x.norm());
}

TEST_CASE("decompositions: the nearest motion finds a rotation and a shift again, never a mirror image") {
    const Eigen::Matrix3Xd from = randomMatrix(3, 20, 4);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0, Vec3(1.0, 2.0, -2.0).normalized()));
    const Vec3 shift(3.0, -1.0, 0.5);
    const Eigen::Matrix4d motion = nearestMotion(from, (turn.toRotationMatrix() * from).colwise() + shift);
    CHECK((motion.topLeftCorner<3, 3>() - turn.toRotationMatrix()).norm() < 1e-13);
    CHECK((motion.topRightCorner<3, 1>() - shift).norm() < 1e-13);
    Eigen::Matrix3Xd mirrored = from;
    mirrored.row(0) *= -1.0;
    CHECK(std::abs(nearestMotion(from, mirrored).topLeftCorner<3, 3>().determinant() - 1.0) < 1e-13);
}
