// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/base/decompositions.h"
#include "core/meshing/appendages.h"

namespace imomushi {
namespace {

/// How strain fades with the distance from where it enters, in widths: 1 / 5.4 in a round rod, 1 / 2.7 in a flat one of the same perimeter.
constexpr double kDecay = 0.25;
/// Least share of the spread in one direction that a rotation can be told by.
constexpr double kFlatSupport = 1e-9;

Eigen::Matrix<double, 3, 6> rigidAt(const Vec3& arm) {
    Eigen::Matrix<double, 3, 6> out;
    out.leftCols<3>().setIdentity();
    for (int axis = 0; axis < 3; ++axis) out.col(3 + axis) = Vec3::Unit(axis).cross(arm);
    return out;
}

}  // namespace

Eigen::MatrixXd TrimmedBody::onBody(const Points& body, const Eigen::MatrixXd& displacement) const {
    Eigen::MatrixXd out(body.size(), displacement.cols());
    for (std::size_t v = 0; v < bodyVertex.size(); ++v)
        if (bodyVertex[v] >= 0) out.middleRows<3>(3 * bodyVertex[v]) = displacement.middleRows<3>(3 * static_cast<Eigen::Index>(v));
    for (const Appendage& one : appendages) {
        const auto n = static_cast<Eigen::Index>(one.support.size());
        const auto where = [&](Eigen::Index i) -> Vec3 { return mesh.vertices.row(one.support[static_cast<std::size_t>(i)]).transpose(); };
        // Each vertex of the support counts by its share of the cap's area.
        const Vec3 origin = where(n - 1);
        Eigen::VectorXd weight = Eigen::VectorXd::Zero(n);
        for (Eigen::Index i = 0; i + 1 < n; ++i) {
            const Eigen::Index next = (i + 1) % (n - 1);
            const double area = (where(i) - origin).cross(where(next) - origin).norm();
            for (const Eigen::Index corner : {i, next, n - 1}) weight[corner] += area;
        }
        weight /= weight.sum();
        Eigen::MatrixXd R(3 * n, 6), around(3 * n, displacement.cols());
        for (Eigen::Index i = 0; i < n; ++i) {
            R.middleRows<3>(3 * i) = rigidAt((where(i) - origin) / one.width);
            around.middleRows<3>(3 * i) = displacement.middleRows<3>(3 * one.support[static_cast<std::size_t>(i)]);
        }
        Eigen::MatrixXd weighed = R;
        for (Eigen::Index i = 0; i < n; ++i) weighed.middleRows<3>(3 * i) *= weight[i];
        const auto spread = eigenpairsOf(Eigen::Matrix<double, 6, 6>(weighed.transpose() * R));
        const Eigen::Matrix<double, 6, 1> inverse = spread.values.cwiseMax(kFlatSupport).cwiseInverse();
        const Eigen::MatrixXd motion = spread.vectors * (inverse.asDiagonal() * (spread.vectors.transpose() * (weighed.transpose() * around)));
        around -= R * motion;
        for (const std::int32_t v : one.dropped) {
            const Vec3 x = body.row(v).transpose();
            double nearest = std::numeric_limits<double>::infinity();
            Eigen::VectorXd share(n - 1);
            for (Eigen::Index i = 0; i + 1 < n; ++i) {
                const double d = (x - where(i)).norm() / one.width;
                nearest = std::min(nearest, d);
                share[i] = weight[i] / (d * d * d * d);
            }
            share *= std::exp(-nearest / kDecay) / share.sum();
            auto row = out.middleRows<3>(3 * v);
            row = rigidAt((x - origin) / one.width) * motion;
            for (Eigen::Index i = 0; i + 1 < n; ++i) row += share[i] * around.middleRows<3>(3 * i);
        }
    }
    return out;
}

}  // namespace imomushi
