// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <vector>

#include "core/mesh/mesh.h"

/// The bodies of tests/support/hard_cases.h, from plane sections.
namespace imomushi::hard {

/// A plane region, triangles counter-clockwise.
struct Section {
    std::vector<Eigen::Vector2d> points;
    std::vector<std::array<int, 3>> triangles;
};

/// The cells (i, j) of a grid for which `inside` holds, two triangles each; only points of such cells.
Section grid(const std::vector<double>& xs, const std::vector<double>& ys, const std::function<bool(int, int)>& inside);
Section grid(const std::vector<double>& xs, const std::vector<double>& ys);
std::vector<double> steps(double low, double high, int count);
std::vector<double> with(std::vector<double> values, std::initializer_list<double> more);
/// The prism of a section along z, with rings of vertices at `zs`. Uniaxial tension is an exact solution of it, whatever its section.
TriangleMesh prism(const Section& section, const std::vector<double>& zs);
/// Both in one mesh, vertices of the first first.
TriangleMesh both(const TriangleMesh& a, const TriangleMesh& b);
/// Every `step`th triangle is cut in three at the point of these weights: the same polyhedron.
TriangleMesh pierced(const TriangleMesh& mesh, int step, const Vec3& weights);
/// Each triangle in four: the same polyhedron.
TriangleMesh refined(const TriangleMesh& mesh);
/// Triangles with vertices of their own, each moved by up to `jitter`, as a careless exporter writes seams.
TriangleMesh apart(const TriangleMesh& mesh, double jitter);
/// The bar that other bodies are compared with: 1 x 1 x 3 from z = 0, cells of 1/3.
TriangleMesh plainBar();
TriangleMesh moved(TriangleMesh mesh, double scale, const Vec3& shift);
/// A prism with an eight-fold axis along y; the middle of each side is a joint face.
struct Hub {
    TriangleMesh mesh;
    std::vector<std::vector<std::int32_t>> faces;
};
Hub hub();

}  // namespace imomushi::hard
