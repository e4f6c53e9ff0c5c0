// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/winding_number.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace imomushi {
namespace {

double halfSolidAngle(const TriangleMesh& mesh, std::int32_t f, const Vec3& point) {
    const Vec3 a = mesh.vertices.row(mesh.triangles(f, 0)).transpose() - point;
    const Vec3 b = mesh.vertices.row(mesh.triangles(f, 1)).transpose() - point;
    const Vec3 c = mesh.vertices.row(mesh.triangles(f, 2)).transpose() - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    const double y = a.dot(b.cross(c));
    const double x = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    return y != 0.0 || x != 0.0 ? std::atan2(y, x) : 0.0;
}

}  // namespace

double windingNumber(const TriangleMesh& mesh, const Vec3& point) {
    double sum = 0.0;
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) sum += halfSolidAngle(mesh, f, point);
    return sum / (2.0 * std::numbers::pi);
}

double windingNumber(const TriangleMesh& mesh, std::span<const std::int32_t> triangles, const Vec3& point) {
    double sum = 0.0;
    for (const std::int32_t f : triangles) sum += halfSolidAngle(mesh, f, point);
    return sum / (2.0 * std::numbers::pi);
}

}  // namespace imomushi
