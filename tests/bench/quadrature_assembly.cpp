// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/quadrature_assembly.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/elasticity/kernels.h"

namespace imomushi {
namespace {

struct Point {
    double hat1, hat2, weight;  ///< weight 1 in all
};

std::vector<Point> sevenPoints(int parts) {
    const double root = std::sqrt(15.0);
    const double a = (6.0 - root) / 21.0, b = (6.0 + root) / 21.0, wa = (155.0 - root) / 1200.0, wb = (155.0 + root) / 1200.0;
    const std::array<Point, 7> rule{{{1.0 / 3.0, 1.0 / 3.0, 9.0 / 40.0},
                                     {a, a, wa},
                                     {1 - 2 * a, a, wa},
                                     {a, 1 - 2 * a, wa},
                                     {b, b, wb},
                                     {1 - 2 * b, b, wb},
                                     {b, 1 - 2 * b, wb}}};
    std::vector<Point> points;
    const double step = 1.0 / parts;
    for (int i = 0; i < parts; ++i)
        for (int j = 0; i + j < parts; ++j)
            for (const Point& p : rule) {
                points.push_back({(i + p.hat1) * step, (j + p.hat2) * step, p.weight * step * step});
                if (i + j + 1 < parts) points.push_back({(i + 1 - p.hat1) * step, (j + 1 - p.hat2) * step, p.weight * step * step});
            }
    return points;
}

/// Gauss points of (0, 1): five on each of `parts` equal parts, and their weights.
std::vector<std::array<double, 2>> gauss(int parts) {
    const std::array<std::array<double, 2>, 5> five{{{-0.9061798459386640, 0.2369268850561891},
                                                     {-0.5384693101056831, 0.4786286704993665},
                                                     {0.0, 0.5688888888888889},
                                                     {0.5384693101056831, 0.4786286704993665},
                                                     {0.9061798459386640, 0.2369268850561891}}};
    std::vector<std::array<double, 2>> points;
    for (int i = 0; i < parts; ++i)
        for (const auto& p : five) points.push_back({(i + 0.5 * (1.0 + p[0])) / parts, 0.5 * p[1] / parts});
    return points;
}

struct Triangle {
    std::array<Vec3, 3> corner;
    Vec3 centre, normal;
    double area = 0.0, longest = 0.0;
    bool held = false;
};

/// Kelvin's kernels for shear modulus 1, times `weight`: 3 x 3 by rows; r from the collocation point, n the normal.
class Kernels {
public:
    explicit Kernels(double nu)
        : nu_(nu),
          tractionScale_(-1.0 / (8.0 * std::numbers::pi * (1.0 - nu))),
          displacementScale_(1.0 / (16.0 * std::numbers::pi * (1.0 - nu))) {}

    void traction(const Vec3& r, const Vec3& n, double weight, double* t) const {
        const double inverse = 1.0 / std::sqrt(r.squaredNorm());
        const double scale = weight * tractionScale_ * inverse * inverse;
        const Vec3 e = inverse * r;
        const double slope = e.dot(n), c = 1.0 - 2.0 * nu_;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                t[3 * i + j] = scale * (slope * ((i == j ? c : 0.0) + 3.0 * e[i] * e[j]) + c * (n[i] * e[j] - n[j] * e[i]));
    }

    void displacement(const Vec3& r, double weight, double* u) const {
        const double inverse = 1.0 / std::sqrt(r.squaredNorm());
        const double scale = weight * displacementScale_ * inverse;
        const Vec3 e = inverse * r;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) u[3 * i + j] = scale * ((i == j ? 3.0 - 4.0 * nu_ : 0.0) + e[i] * e[j]);
    }

private:
    double nu_, tractionScale_, displacementScale_;
};

void add(const double* block, double factor, double* sum) {
    for (int k = 0; k < 9; ++k) sum[k] += factor * block[k];
}

/// Makes the block of vertex v in its own row such that all blocks of the row add up to nothing.
void closeRow(double* h, std::size_t vertices, std::int32_t v) {
    std::array<double, 9> sum{};
    double* own = h + 9 * static_cast<std::size_t>(v);
    std::fill(own, own + 9, 0.0);
    for (std::size_t j = 0; j < vertices; ++j) add(h + 9 * j, 1.0, sum.data());
    for (std::size_t k = 0; k < 9; ++k) own[k] = -sum[k];
}

AssembledRows emptyRows(const TriangleMesh& mesh, std::size_t rows) {
    const std::size_t size = rows * 9 * static_cast<std::size_t>(mesh.vertices.rows());
    return {std::vector<double>(size), std::vector<double>(size)};
}

}  // namespace

AssembledRows assembleByQuadrature(const TriangleMesh& mesh, const std::vector<std::int32_t>& held, const std::vector<std::int32_t>& rows,
                                   double nu, const Quadrature& quadrature, int threads) {
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
    std::vector<Triangle> triangles(static_cast<std::size_t>(mesh.triangles.rows()));
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        Triangle& triangle = triangles[t];
        for (std::size_t c = 0; c < 3; ++c)
            triangle.corner[c] = mesh.vertices.row(mesh.triangles(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(c))).transpose();
        const Vec3 areaNormal = (triangle.corner[1] - triangle.corner[0]).cross(triangle.corner[2] - triangle.corner[0]);
        triangle.area = 0.5 * areaNormal.norm();
        triangle.normal = areaNormal.normalized();
        triangle.centre = (triangle.corner[0] + triangle.corner[1] + triangle.corner[2]) / 3.0;
        for (std::size_t c = 0; c < 3; ++c)
            triangle.longest = std::max(triangle.longest, (triangle.corner[c] - triangle.corner[(c + 1) % 3]).norm());
    }
    for (const std::int32_t t : held) triangles[static_cast<std::size_t>(t)].held = true;
    const std::vector<Point> far = sevenPoints(quadrature.far), near = sevenPoints(quadrature.near);
    const auto line = gauss(quadrature.singularParts);
    const Kernels kernels(nu);
    AssembledRows out = emptyRows(mesh, rows.size());
    parallelFor(threads, rows.size(), 4, [&](std::size_t begin, std::size_t end) {
        std::array<double, 9> block{};
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 x = mesh.vertices.row(rows[i]).transpose();
            double* h = out.h.data() + i * 9 * vertices;
            double* g = out.g.data() + i * 9 * vertices;
            for (std::size_t t = 0; t < triangles.size(); ++t) {
                const Triangle& triangle = triangles[t];
                std::array<std::size_t, 3> corner{};
                int own = -1;
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::int32_t v = mesh.triangles(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(c));
                    corner[c] = 9 * static_cast<std::size_t>(v);
                    if (v == rows[i]) own = static_cast<int>(c);
                }
                if (own < 0) {
                    const Vec3 from = triangle.corner[0] - x, side1 = triangle.corner[1] - triangle.corner[0],
                               side2 = triangle.corner[2] - triangle.corner[0];
                    const double reach = quadrature.reach * triangle.longest;
                    for (const Point& p : (triangle.centre - x).squaredNorm() < reach * reach ? near : far) {
                        const Vec3 r = from + p.hat1 * side1 + p.hat2 * side2;
                        const double hat0 = 1.0 - p.hat1 - p.hat2;
                        kernels.traction(r, triangle.normal, p.weight * triangle.area, block.data());
                        add(block.data(), hat0, h + corner[0]);
                        add(block.data(), p.hat1, h + corner[1]);
                        add(block.data(), p.hat2, h + corner[2]);
                        if (!triangle.held) continue;
                        kernels.displacement(r, p.weight * triangle.area, block.data());
                        add(block.data(), hat0, g + corner[0]);
                        add(block.data(), p.hat1, g + corner[1]);
                        add(block.data(), p.hat2, g + corner[2]);
                    }
                } else {
                    // y = x + s (side1 + t (side2 - side1)): the area s ds dt cancels 1/R, and the hats of the other corners, which vanish
                    // like s, the other 1/R of the traction kernel. The block of x itself comes from the sum of the row.
                    const auto a = static_cast<std::size_t>(own), b = (a + 1) % 3, c = (a + 2) % 3;
                    const Vec3 side1 = triangle.corner[b] - x, side2 = triangle.corner[c] - x;
                    for (const auto& s : line)
                        for (const auto& u : line) {
                            const Vec3 r = s[0] * (side1 + u[0] * (side2 - side1));
                            const double weight = 2.0 * triangle.area * s[0] * s[1] * u[1];
                            kernels.traction(r, triangle.normal, weight, block.data());
                            add(block.data(), s[0] * (1.0 - u[0]), h + corner[b]);
                            add(block.data(), s[0] * u[0], h + corner[c]);
                            if (!triangle.held) continue;
                            kernels.displacement(r, weight, block.data());
                            add(block.data(), 1.0 - s[0], g + corner[a]);
                            add(block.data(), s[0] * (1.0 - u[0]), g + corner[b]);
                            add(block.data(), s[0] * u[0], g + corner[c]);
                        }
                }
            }
            closeRow(h, vertices, rows[i]);
        }
    });
    return out;
}

AssembledRows assembleInClosedForm(const TriangleMesh& mesh, const std::vector<std::int32_t>& held, const std::vector<std::int32_t>& rows,
                                   double nu, int threads) {
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
    std::vector<std::int32_t> columns(vertices), free;
    for (std::size_t v = 0; v < vertices; ++v) columns[v] = static_cast<std::int32_t>(v);
    std::vector<char> isHeld(static_cast<std::size_t>(mesh.triangles.rows()));
    for (const std::int32_t t : held) isHeld[static_cast<std::size_t>(t)] = 1;
    for (std::size_t t = 0; t < isHeld.size(); ++t)
        if (!isHeld[t]) free.push_back(static_cast<std::int32_t>(t));
    const TriangleBatch freeBatch(mesh, free, columns), heldBatch(mesh, held, columns, columns);
    AssembledRows out = emptyRows(mesh, rows.size());
    parallelFor(threads, rows.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 x = mesh.vertices.row(rows[i]).transpose();
            double* h = out.h.data() + i * 9 * vertices;
            addBlocks(freeBatch, x, nu, h, nullptr);
            addBlocks(heldBatch, x, nu, h, out.g.data() + i * 9 * vertices);
            closeRow(h, vertices, rows[i]);
        }
    });
    return out;
}

}  // namespace imomushi
