// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/joints/warping.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace imomushi {

namespace {

// 1, x, y and the shapes.
constexpr int kAll = 3 + Warping::kMost;

void polynomials(double x, double y, double* p) {
    const double xx = x * x, yy = y * y, r = xx + yy, difference = xx - yy, xy = x * y;
    p[0] = 1.0, p[1] = x, p[2] = y;
    p[3] = r, p[4] = difference, p[5] = xy;
    p[6] = r * x, p[7] = r * y, p[8] = x * (xx - 3.0 * yy), p[9] = y * (3.0 * xx - yy);
    p[10] = r * r, p[11] = r * difference, p[12] = r * xy, p[13] = xx * xx - 6.0 * xx * yy + yy * yy, p[14] = xy * difference;
}

/// Of what is left of a shape beside those before it, over the shape: a face that is a line has no more shapes.
constexpr double kDependent = 1e-10;

// Gauss and Legendre on 0...1, exact up to degree 9: one degree is for the shrinking width of a triangle.
constexpr std::array<double, 5> kAbscissa = {0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332};
constexpr std::array<double, 5> kWeight = {0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683, 0.118463442528095};

}  // namespace

std::vector<AreaPoint> areaPoints(const TriangleMesh& body, const JointFace& face) {
    std::vector<AreaPoint> points;
    for (const auto t : face.triangles) {
        const auto corner = [&](int c) { return face.frame.toLocal(body.vertices.row(body.triangles(t, c)).transpose()); };
        const Vec3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
        const double area = ab.cross(ac).norm();  // twice the area, that of the square before it is collapsed
        for (std::size_t i = 0; i < kAbscissa.size(); ++i)
            for (std::size_t k = 0; k < kAbscissa.size(); ++k) {
                const double s = kAbscissa[i], t2 = (1.0 - s) * kAbscissa[k];
                points.push_back({a + s * ab + t2 * ac, area * (1.0 - s) * kWeight[i] * kWeight[k]});
            }
    }
    return points;
}

Warping::Warping(const TriangleMesh& body, const JointFace& face, int count) : count_(count) {
    coefficients_.assign(static_cast<std::size_t>(count_) * kAll, 0.0);
    if (count_ == 0) return;
    const auto points = areaPoints(body, face);
    double area = 0.0, second = 0.0;
    for (const auto& p : points) {
        area += p.weight;
        second += p.weight * p.local.head<2>().squaredNorm();
    }
    if (!(area > 0.0) || !(second > 0.0)) return;
    unit_ = std::sqrt(0.5 * second / area);
    // Moments of all polynomials, in units; the mean is the area integral over the area.
    Eigen::Matrix<double, kAll, kAll> moments = Eigen::Matrix<double, kAll, kAll>::Zero();
    for (const auto& p : points) {
        Eigen::Matrix<double, kAll, 1> value;
        polynomials(p.local.x() / unit_, p.local.y() / unit_, value.data());
        moments += p.weight / area * value * value.transpose();
    }
    // Gram and Schmidt, twice each for full accuracy.
    const int n = 3 + count_;
    Eigen::Matrix<double, kAll, kAll> basis = Eigen::Matrix<double, kAll, kAll>::Identity();
    for (int k = 0; k < n; ++k) {
        auto own = basis.col(k);
        const double whole = own.dot(moments * own);
        for (int pass = 0; pass < 2; ++pass)
            for (int i = 0; i < k; ++i) own -= basis.col(i).dot(moments * own) * basis.col(i);
        const double left = own.dot(moments * own);
        if (left > kDependent * whole)
            own /= std::sqrt(left);
        else
            own.setZero();
    }
    for (int k = 0; k < count_; ++k)
        for (int i = 0; i < kAll; ++i) coefficients_[static_cast<std::size_t>(k * kAll + i)] = unit_ * basis(i, 3 + k);
}

void Warping::at(double x, double y, double* values) const {
    if (!(unit_ > 0.0)) {
        for (int k = 0; k < count_; ++k) values[k] = 0.0;
        return;
    }
    std::array<double, kAll> p;
    polynomials(x / unit_, y / unit_, p.data());
    for (int k = 0; k < count_; ++k) {
        double sum = 0.0;
        const double* c = coefficients_.data() + static_cast<std::ptrdiff_t>(k) * kAll;
        for (int i = 0; i <= 3 + k; ++i) sum += c[i] * p[static_cast<std::size_t>(i)];
        values[k] = sum;
    }
}

}  // namespace imomushi
