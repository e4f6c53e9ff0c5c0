// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/joints/warping.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace imomushi {

namespace {

// 1, x, y and the shapes.
constexpr int kAll = 3 + Warping::kMax;

void polynomials(double x, double y, double* p) {
    const double xx = x * x, yy = y * y, r = xx + yy, difference = xx - yy, xy = x * y;
    p[0] = 1.0, p[1] = x, p[2] = y;
    p[3] = r, p[4] = difference, p[5] = xy;
    p[6] = r * x, p[7] = r * y;
    p[8] = r * r, p[9] = r * difference, p[10] = r * xy;
    p[11] = x * (xx - 3.0 * yy), p[12] = y * (3.0 * xx - yy), p[13] = xx * xx - 6.0 * xx * yy + yy * yy, p[14] = xy * difference;
}

/// Of what is left of a shape beside those before it, over the shape, both squared: the vertices of the face cannot tell it from those. Circles leave a
/// few hundredths, ellipses five times as long as wide a thousandth.
constexpr double kDependent = 1e-5;

// Gauss and Legendre on 0...1, exact up to degree 9: one degree is for the shrinking width of a triangle.
constexpr std::array<double, 5> kAbscissa = {0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332};
constexpr std::array<double, 5> kWeight = {0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683, 0.118463442528095};

// Shapes by name: radial ones, and pairs of cosine and sine of a multiple of the angle.
enum Shape { kR2, kC2, kS2, kR2X, kR2Y, kR4, kR2C2, kR2S2, kC3, kS3, kC4, kS4 };
constexpr double kHalf = 0.70710678118654752;  // of two terms, so that a unit moves the face as far as one

struct Column {
    int count;
    std::array<WarpTerm, 2> terms;
};
constexpr Column along(int shape, int axis) { return {1, {{{shape, axis, 1.0}, {shape, axis, 0.0}}}}; }
constexpr Column plane(int x, double sign, int y) { return {2, {{{x, 0, kHalf}, {y, 1, sign * kHalf}}}}; }
// Pure shapes, not mixtures: the best twelve mixtures for cylinders halve the error there, but make it a third larger on other bodies.
constexpr std::array<Column, 3 * Warping::kMax> kColumns = {
    plane(kC2, 1, kS2),     plane(kS2, -1, kC2),     along(kR2, 2),           along(kR2X, 2),         along(kR2Y, 2),          along(kC2, 2),
    along(kS2, 2),          along(kR2, 0),           along(kR2, 1),           plane(kC2, -1, kS2),    plane(kS2, 1, kC2),      plane(kR2X, 1, kR2Y),
    plane(kR2Y, -1, kR2X),  plane(kR2C2, 1, kR2S2),  plane(kR2S2, -1, kR2C2), along(kR4, 2),          plane(kR2X, -1, kR2Y),   plane(kR2Y, 1, kR2X),
    plane(kC3, 1, kS3),     plane(kS3, -1, kC3),     plane(kC3, -1, kS3),     plane(kS3, 1, kC3),     along(kR2C2, 2),         along(kR2S2, 2),
    plane(kC4, -1, kS4),    plane(kS4, 1, kC4),      along(kC4, 2),           along(kS4, 2),          along(kR4, 0),           along(kR4, 1),
    plane(kC4, 1, kS4),     plane(kS4, -1, kC4),     plane(kR2C2, -1, kR2S2), plane(kR2S2, 1, kR2C2), along(kC3, 2),           along(kS3, 2)};

}  // namespace

std::span<const WarpTerm> warpColumn(int i) {
    const Column& column = kColumns[static_cast<std::size_t>(i)];
    return {column.terms.data(), static_cast<std::size_t>(column.count)};
}

int warpShapes(int columns) {
    int shapes = 0;
    for (int i = 0; i < columns; ++i)
        for (const WarpTerm& term : warpColumn(i)) shapes = std::max(shapes, term.shape + 1);
    return shapes;
}

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
    double area = 0.0, second = 0.0;
    for (const auto& p : areaPoints(body, face)) {
        area += p.weight;
        second += p.weight * p.local.head<2>().squaredNorm();
    }
    if (!(area > 0.0) || !(second > 0.0)) return;
    unit_ = std::sqrt(0.5 * second / area);
    // Means of products of all polynomials, in units, linear on each triangle.
    Eigen::Matrix<double, kAll, kAll> moments = Eigen::Matrix<double, kAll, kAll>::Zero();
    for (const auto t : face.triangles) {
        Eigen::Matrix<double, kAll, 3> value;
        std::array<Vec3, 3> corner;
        for (int c = 0; c < 3; ++c) {
            corner[static_cast<std::size_t>(c)] = face.frame.toLocal(body.vertices.row(body.triangles(t, c)).transpose());
            polynomials(corner[static_cast<std::size_t>(c)].x() / unit_, corner[static_cast<std::size_t>(c)].y() / unit_, value.col(c).data());
        }
        const Eigen::Matrix<double, kAll, 1> sum = value.rowwise().sum();
        const double share = (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm() / (24.0 * area);
        moments += share * (value * value.transpose() + sum * sum.transpose());
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
