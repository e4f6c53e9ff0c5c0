// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/scaled_body.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/decompositions.h"
#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"

namespace imomushi {
namespace {

/// Diagonals: far below what limbs go by, far above rounding.
constexpr double kGrid = 0x1p-24;
/// A body has more to one side of its middle where the third moment is more than this part of what it could be; a vertex lies off the middle beyond this part of the mean distance.
constexpr double kSkew = 1e-5, kOffMiddle = 0.1;

TriangleMesh largestShell(const TriangleMesh& body) {
    int count = 0;
    const std::vector<std::int32_t> component = edgeComponents(body.triangles, EdgeTable(body.triangles), count);
    if (count < 2) return body;
    std::vector<double> volume(static_cast<std::size_t>(count), 0.0);
    for (Eigen::Index f = 0; f < body.triangles.rows(); ++f) {
        const auto p = [&](int k) { return Vec3(body.vertices.row(body.triangles(f, k)).transpose()); };
        volume[static_cast<std::size_t>(component[static_cast<std::size_t>(f)])] += p(0).dot(p(1).cross(p(2))) / 6.0;
    }
    const auto largest = static_cast<std::int32_t>(std::max_element(volume.begin(), volume.end()) - volume.begin());
    TriangleMesh out;
    std::vector<std::int32_t> number(static_cast<std::size_t>(body.vertices.rows()), -1);
    std::vector<Eigen::Index> faces, vertices;
    for (Eigen::Index f = 0; f < body.triangles.rows(); ++f)
        if (component[static_cast<std::size_t>(f)] == largest) faces.push_back(f);
    out.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t i = 0; i < faces.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            std::int32_t& n = number[static_cast<std::size_t>(body.triangles(faces[i], k))];
            if (n < 0) {
                n = static_cast<std::int32_t>(vertices.size());
                vertices.push_back(body.triangles(faces[i], k));
            }
            out.triangles(static_cast<Eigen::Index>(i), k) = n;
        }
    out.vertices = body.vertices(vertices, Eigen::indexing::all);
    return out;
}

/// The principal axes of a surface, to which side it has more to it first; where it has as much on both sides, the side of the first vertex that lies off the middle.
Eigen::Matrix3d axesOf(const TriangleMesh& mesh) {
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
    std::vector<double> weight(vertices, 0.0);
    double whole = 0.0;
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
        const auto p = [&](int k) { return Vec3(mesh.vertices.row(mesh.triangles(f, k)).transpose()); };
        const double area = (p(1) - p(0)).cross(p(2) - p(0)).norm();
        for (int k = 0; k < 3; ++k) weight[static_cast<std::size_t>(mesh.triangles(f, k))] += area;
        whole += 3.0 * area;
    }
    Vec3 middle = Vec3::Zero();
    for (std::size_t v = 0; v < vertices; ++v) middle += weight[v] / whole * vertexPlace(mesh.vertices, static_cast<Eigen::Index>(v));
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (std::size_t v = 0; v < vertices; ++v) {
        const Vec3 p = vertexPlace(mesh.vertices, static_cast<Eigen::Index>(v)) - middle;
        spread += weight[v] / whole * p * p.transpose();
    }
    Eigen::Matrix3d axes = eigenpairsOf(spread).vectors;
    for (int k = 0; k < 3; ++k) {
        double skew = 0.0, size = 0.0, first = 0.0;
        for (std::size_t v = 0; v < vertices; ++v) {
            const double x = axes.col(k).dot(vertexPlace(mesh.vertices, static_cast<Eigen::Index>(v)) - middle);
            skew += weight[v] / whole * x * x * x;
            size += weight[v] / whole * std::abs(x * x * x);
        }
        const double aside = kOffMiddle * std::cbrt(size);
        for (std::size_t v = 0; v < vertices && first == 0.0; ++v)
            if (const double x = axes.col(k).dot(vertexPlace(mesh.vertices, static_cast<Eigen::Index>(v)) - middle); std::abs(x) > aside) first = x;
        if ((std::abs(skew) > kSkew * size ? skew : first) < 0.0) axes.col(k) = -axes.col(k);
    }
    return axes;
}

}  // namespace

ScaledBody scaledBody(const TriangleMesh& body) {
    ScaledBody out;
    out.mesh = largestShell(body);
    Points& vertices = out.mesh.vertices;
    out.axes = axesOf(out.mesh);
    vertices = (vertices * out.axes).eval();
    if (out.axes.determinant() < 0.0) out.mesh.triangles.col(1).swap(out.mesh.triangles.col(2));
    for (auto t : out.mesh.triangles.rowwise()) {  // the same whichever way files of mirrored ones go round
        int first = 0;
        t.minCoeff(&first);
        t = Eigen::RowVector3i(t[first], t[(first + 1) % 3], t[(first + 2) % 3]).eval();
    }
    const Bounds box = boundsOf(vertices);
    const Vec3 middle = box.low + 0.5 * box.size();
    out.centre = out.axes * middle;
    out.diagonal = box.diagonal();
    vertices = (vertices.rowwise() - middle.transpose()) / out.diagonal;
    vertices = (vertices.array() / kGrid).round() * kGrid;
    return out;
}

}  // namespace imomushi
