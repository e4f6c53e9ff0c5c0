// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"

/// Closed, outward-oriented test bodies with the patches a joint face would sit on.
namespace imomushi::shapes {

/// A patch of a body's surface: vertices ascending, and all triangles whose corners are among them.
struct Patch {
    std::vector<std::int32_t> vertices;
    std::vector<std::int32_t> triangles;
};

/// A body; `ends` are its two flat ends (first: the lower one along its axis), empty where it has none.
struct Body {
    TriangleMesh mesh;
    std::vector<Patch> ends;
};

namespace detail {
inline TriangleMesh meshOf(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& corners) {
    TriangleMesh mesh;
    mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
    mesh.triangles.resize(static_cast<Eigen::Index>(corners.size()), 3);
    for (std::size_t i = 0; i < points.size(); ++i) mesh.vertices.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
    for (std::size_t f = 0; f < corners.size(); ++f)
        for (int c = 0; c < 3; ++c) mesh.triangles(static_cast<Eigen::Index>(f), c) = corners[f][static_cast<std::size_t>(c)];
    return mesh;
}
}  // namespace detail

/// All vertices with inside(vertex), and the triangles that have all corners among them.
template <class Inside>
Patch patchWhere(const TriangleMesh& mesh, Inside inside) {
    Patch patch;
    std::vector<char> in(static_cast<std::size_t>(mesh.vertices.rows()));
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
        if ((in[static_cast<std::size_t>(v)] = inside(Vec3(mesh.vertices.row(v).transpose()))))
            patch.vertices.push_back(static_cast<std::int32_t>(v));
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f)
        if (in[static_cast<std::size_t>(mesh.triangles(f, 0))] && in[static_cast<std::size_t>(mesh.triangles(f, 1))] &&
            in[static_cast<std::size_t>(mesh.triangles(f, 2))])
            patch.triangles.push_back(static_cast<std::int32_t>(f));
    return patch;
}

/// An axis-parallel box of nx x ny x nz cells, two triangles per cell side. Ends: z = low and z = high.
inline Body box(const Vec3& low, const Vec3& high, int nx, int ny, int nz) {
    const std::array<int, 3> n{nx, ny, nz};
    std::map<std::array<int, 3>, int> index;
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> corners;
    const auto vertex = [&](const std::array<int, 3>& at) {
        const auto [it, fresh] = index.try_emplace(at, static_cast<int>(points.size()));
        if (fresh) {
            Vec3 p;
            for (int k = 0; k < 3; ++k) {
                const auto i = static_cast<std::size_t>(k);
                p[k] = at[i] == n[i] ? high[k] : low[k] + (high[k] - low[k]) * at[i] / n[i];
            }
            points.push_back(p);
        }
        return it->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
        for (int side = 0; side < 2; ++side)
            for (int i = 0; i < n[b]; ++i)
                for (int j = 0; j < n[c]; ++j) {
                    const auto at = [&](int di, int dj) {
                        std::array<int, 3> p{};
                        p[axis] = side ? n[axis] : 0;
                        p[b] = i + di;
                        p[c] = j + dj;
                        return vertex(p);
                    };
                    std::array<int, 4> q{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
                    if (!side) std::swap(q[1], q[3]);
                    if ((i + j) % 2) {
                        corners.push_back({q[0], q[1], q[2]});
                        corners.push_back({q[0], q[2], q[3]});
                    } else {
                        corners.push_back({q[0], q[1], q[3]});
                        corners.push_back({q[1], q[2], q[3]});
                    }
                }
    }
    Body body{detail::meshOf(points, corners), {}};
    for (const double z : {low.z(), high.z()})
        body.ends.push_back(patchWhere(body.mesh, [z](const Vec3& p) { return p.z() == z; }));
    return body;
}

/// A bar of the given side (x, y in [-side/2, side/2]) and length (z from 0), n cells per side, cells as cubic as possible.
inline Body bar(int n, double length = 3.0, double side = 1.0) {
    const int along = std::max(2, static_cast<int>(std::lround(n * length / side)));
    return box(Vec3(-side / 2, -side / 2, 0.0), Vec3(side / 2, side / 2, length), n, n, along);
}

/// A cylinder about z from 0 to length: `around` vertices per ring, `along` rows of cells, caps of about square cells that end in a
/// centre vertex. 2 + around * (along - 1 + 2 * capRings) vertices, capRings = max(1, around / 6).
inline Body cylinder(double radius, double length, int around, int along) {
    const int capRings = std::max(1, around / 6);
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> corners;
    const auto ring = [&](double r, double z) {
        const int first = static_cast<int>(points.size());
        for (int i = 0; i < around; ++i) {
            const double t = 2.0 * std::numbers::pi * i / around;
            points.emplace_back(r * std::cos(t), r * std::sin(t), z);
        }
        return first;
    };
    const auto strip = [&](int below, int above) {  // outward when `above` follows `below` counter-clockwise
        for (int i = 0; i < around; ++i) {
            const int j = (i + 1) % around;
            if (i % 2) {
                corners.push_back({below + i, below + j, above + j});
                corners.push_back({below + i, above + j, above + i});
            } else {
                corners.push_back({below + i, below + j, above + i});
                corners.push_back({below + j, above + j, above + i});
            }
        }
    };
    const auto fan = [&](int centre, int first, bool up) {
        for (int i = 0; i < around; ++i) {
            const int j = (i + 1) % around;
            corners.push_back(up ? std::array<int, 3>{centre, first + i, first + j} : std::array<int, 3>{centre, first + j, first + i});
        }
    };
    points.emplace_back(0.0, 0.0, 0.0);
    int last = -1;
    for (int k = 1; k <= capRings; ++k) {
        const int next = ring(radius * k / capRings, 0.0);
        if (k == 1)
            fan(0, next, false);
        else
            strip(last, next);
        last = next;
    }
    for (int k = 1; k <= along; ++k) {
        const int next = ring(radius, k == along ? length : length * k / along);
        strip(last, next);
        last = next;
    }
    for (int k = capRings - 1; k >= 1; --k) {
        const int next = ring(radius * k / capRings, length);
        strip(last, next);
        last = next;
    }
    points.emplace_back(0.0, 0.0, length);
    fan(static_cast<int>(points.size()) - 1, last, true);
    Body body{detail::meshOf(points, corners), {}};
    for (const double z : {0.0, length})
        body.ends.push_back(patchWhere(body.mesh, [z](const Vec3& p) { return p.z() == z; }));
    return body;
}

/// An icosahedron subdivided `levels` times, on the sphere about the origin: 10 * 4^levels + 2 vertices. No ends.
inline Body sphere(double radius, int levels) {
    const double g = std::numbers::phi;
    std::vector<Vec3> points{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g},
                             {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<std::array<int, 3>> corners{{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                            {11, 10, 2}, {10, 7, 6}, {7, 1, 8}, {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8},
                                            {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middle;
        std::vector<std::array<int, 3>> finer;
        const auto between = [&](int a, int b) {
            const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
            if (fresh) {
                const Vec3 p = points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)];
                points.push_back(p.normalized() * points[0].norm());
            }
            return it->second;
        };
        for (const auto& [a, b, c] : corners) {
            const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
            finer.push_back({a, ab, ca});
            finer.push_back({ab, b, bc});
            finer.push_back({ca, bc, c});
            finer.push_back({ab, bc, ca});
        }
        corners = std::move(finer);
    }
    for (Vec3& p : points) p *= radius / p.norm();
    return Body{detail::meshOf(points, corners), {}};
}

/// A torus about z: `around` x `across` vertices. No ends.
inline Body torus(double radius, double tubeRadius, int around, int across) {
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> corners;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const double t = 2.0 * std::numbers::pi * i / around, s = 2.0 * std::numbers::pi * j / across;
            const double r = radius + tubeRadius * std::cos(s);
            points.emplace_back(r * std::cos(t), r * std::sin(t), tubeRadius * std::sin(s));
            const int i1 = (i + 1) % around, j1 = (j + 1) % across;
            corners.push_back({i * across + j, i1 * across + j, i1 * across + j1});
            corners.push_back({i * across + j, i1 * across + j1, i * across + j1});
        }
    return Body{detail::meshOf(points, corners), {}};
}

/// The body moved by x -> linear * x + shift (positive determinant).
inline Body moved(Body body, const Eigen::Matrix3d& linear, const Vec3& shift = Vec3::Zero()) {
    body.mesh.vertices = ((body.mesh.vertices * linear.transpose()).rowwise() + shift.transpose()).eval();
    return body;
}

/// The same body inside out: every triangle flipped.
inline Body inverted(Body body) {
    body.mesh.triangles.col(1).swap(body.mesh.triangles.col(2));
    return body;
}

}  // namespace imomushi::shapes
