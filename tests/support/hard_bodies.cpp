// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/hard_bodies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "tests/support/shapes.h"

namespace imomushi::hard {

Section grid(const std::vector<double>& xs, const std::vector<double>& ys, const std::function<bool(int, int)>& inside) {
    Section section;
    std::map<std::pair<int, int>, int> index;
    const auto point = [&](int i, int j) {
        const auto [it, fresh] = index.try_emplace({i, j}, static_cast<int>(section.points.size()));
        if (fresh) section.points.emplace_back(xs[static_cast<std::size_t>(i)], ys[static_cast<std::size_t>(j)]);
        return it->second;
    };
    for (int i = 0; i + 1 < static_cast<int>(xs.size()); ++i)
        for (int j = 0; j + 1 < static_cast<int>(ys.size()); ++j) {
            if (!inside(i, j)) continue;
            const std::array<int, 4> q{point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)};
            if ((i + j) % 2) {
                section.triangles.push_back({q[0], q[1], q[2]});
                section.triangles.push_back({q[0], q[2], q[3]});
            } else {
                section.triangles.push_back({q[0], q[1], q[3]});
                section.triangles.push_back({q[1], q[2], q[3]});
            }
        }
    return section;
}

Section grid(const std::vector<double>& xs, const std::vector<double>& ys) {
    return grid(xs, ys, [](int, int) { return true; });
}

std::vector<double> steps(double low, double high, int count) {
    std::vector<double> out;
    for (int i = 0; i <= count; ++i) out.push_back(i == count ? high : low + (high - low) * i / count);
    return out;
}

std::vector<double> with(std::vector<double> values, std::initializer_list<double> more) {
    values.insert(values.end(), more);
    std::sort(values.begin(), values.end());
    return values;
}

TriangleMesh prism(const Section& section, const std::vector<double>& zs) {
    std::set<std::pair<int, int>> directed;
    for (const auto& t : section.triangles)
        for (std::size_t k = 0; k < 3; ++k) directed.insert({t[k], t[(k + 1) % 3]});
    std::vector<std::pair<int, int>> rim;
    for (const auto& [a, b] : directed)
        if (!directed.contains({b, a})) rim.emplace_back(a, b);
    std::vector<char> onRim(section.points.size());
    for (const auto& [a, b] : rim) onRim[static_cast<std::size_t>(a)] = 1;

    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> corners;
    const int layers = static_cast<int>(zs.size());
    std::vector<std::vector<int>> at(zs.size(), std::vector<int>(section.points.size(), -1));
    for (int k = 0; k < layers; ++k)
        for (std::size_t i = 0; i < section.points.size(); ++i) {
            if (k > 0 && k + 1 < layers && !onRim[i]) continue;
            at[static_cast<std::size_t>(k)][i] = static_cast<int>(points.size());
            points.emplace_back(section.points[i].x(), section.points[i].y(), zs[static_cast<std::size_t>(k)]);
        }
    for (const auto& t : section.triangles) {
        const auto vertex = [&](int layer, std::size_t c) { return at[static_cast<std::size_t>(layer)][static_cast<std::size_t>(t[c])]; };
        corners.push_back({vertex(0, 0), vertex(0, 2), vertex(0, 1)});
        corners.push_back({vertex(layers - 1, 0), vertex(layers - 1, 1), vertex(layers - 1, 2)});
    }
    for (int k = 0; k + 1 < layers; ++k)
        for (std::size_t e = 0; e < rim.size(); ++e) {
            const auto a = static_cast<std::size_t>(rim[e].first), b = static_cast<std::size_t>(rim[e].second), low = static_cast<std::size_t>(k);
            const std::array<int, 4> q{at[low][a], at[low][b], at[low + 1][b], at[low + 1][a]};
            // Diagonals by place, so that neighbouring bodies with more rings share them where they share cells.
            if ((k + rim[e].first) % 2) {
                corners.push_back({q[0], q[1], q[2]});
                corners.push_back({q[0], q[2], q[3]});
            } else {
                corners.push_back({q[0], q[1], q[3]});
                corners.push_back({q[1], q[2], q[3]});
            }
        }
    return shapes::detail::meshOf(points, corners);
}

TriangleMesh both(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh mesh;
    mesh.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    mesh.vertices << a.vertices, b.vertices;
    mesh.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    mesh.triangles << a.triangles, (b.triangles.array() + static_cast<std::int32_t>(a.vertices.rows())).matrix();
    return mesh;
}

TriangleMesh pierced(const TriangleMesh& mesh, int step, const Vec3& weights) {
    TriangleMesh out = mesh;
    const Eigen::Index count = (mesh.triangles.rows() + step - 1) / step;
    out.vertices.conservativeResize(mesh.vertices.rows() + count, 3);
    out.triangles.conservativeResize(mesh.triangles.rows() + 2 * count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::Index f = i * step;
        const auto v = static_cast<std::int32_t>(mesh.vertices.rows() + i);
        const Eigen::RowVector3i t = mesh.triangles.row(f);
        // From the first corner on, so that a point very near to it keeps its distance.
        const Eigen::RowVector3d a = mesh.vertices.row(t[0]);
        out.vertices.row(v) = a + weights[1] * (mesh.vertices.row(t[1]) - a) + weights[2] * (mesh.vertices.row(t[2]) - a);
        out.triangles.row(f) << t[0], t[1], v;
        out.triangles.row(mesh.triangles.rows() + 2 * i) << t[1], t[2], v;
        out.triangles.row(mesh.triangles.rows() + 2 * i + 1) << t[2], t[0], v;
    }
    return out;
}

TriangleMesh refined(const TriangleMesh& mesh) {
    std::vector<Vec3> points;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) points.emplace_back(mesh.vertices.row(v).transpose());
    std::vector<std::array<int, 3>> corners;
    std::map<std::pair<int, int>, int> middle;
    const auto between = [&](int a, int b) {
        const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
        if (fresh) points.push_back(0.5 * (points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]));
        return it->second;
    };
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
        const int a = mesh.triangles(f, 0), b = mesh.triangles(f, 1), c = mesh.triangles(f, 2);
        const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
        corners.insert(corners.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return shapes::detail::meshOf(points, corners);
}

TriangleMesh apart(const TriangleMesh& mesh, double jitter) {
    TriangleMesh out;
    out.vertices.resize(3 * mesh.triangles.rows(), 3);
    out.triangles.resize(mesh.triangles.rows(), 3);
    unsigned state = 1;
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) {
        out.vertices.row(i) = mesh.vertices.row(mesh.triangles.data()[i]);
        for (int k = 0; k < 3; ++k) {
            state = state * 1664525u + 1013904223u;
            out.vertices(i, k) += jitter * (static_cast<double>(state >> 8) / (1 << 23) - 1.0);
        }
        out.triangles.data()[i] = static_cast<std::int32_t>(i);
    }
    return out;
}

TriangleMesh plainBar() { return prism(grid(steps(-0.5, 0.5, 3), steps(-0.5, 0.5, 3)), steps(0.0, 3.0, 9)); }

TriangleMesh moved(TriangleMesh mesh, double scale, const Vec3& shift) {
    mesh.vertices = ((scale * mesh.vertices).rowwise() + shift.transpose()).eval();
    return mesh;
}

Hub hub() {
    constexpr int kSides = 8, kAcross = 3, kAround = kSides * kAcross, kUp = 3;
    constexpr double kHeight = 0.8;
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> corners;
    const double half = std::tan(std::numbers::pi / kSides);
    const auto onSide = [&](int i) {  // of apothem 1, counter-clockwise seen from +y
        const double along = -half + 2.0 * half * (i % kAcross) / kAcross, turn = 2.0 * std::numbers::pi * (i / kAcross) / kSides;
        const Eigen::Vector2d p(1.0, along);
        return Eigen::Vector2d(std::cos(turn) * p.x() - std::sin(turn) * p.y(), std::sin(turn) * p.x() + std::cos(turn) * p.y());
    };
    const auto ring = [&](double radius, double y) {
        const int first = static_cast<int>(points.size());
        for (int i = 0; i < kAround; ++i) {
            const Eigen::Vector2d p = radius * onSide(i);
            points.emplace_back(p.y(), y, p.x());
        }
        return first;
    };
    const auto strip = [&](int below, int above) {
        for (int i = 0; i < kAround; ++i) {
            const int j = (i + 1) % kAround;
            if ((i % kAcross) % 2) {
                corners.push_back({below + i, below + j, above + j});
                corners.push_back({below + i, above + j, above + i});
            } else {
                corners.push_back({below + i, below + j, above + i});
                corners.push_back({below + j, above + j, above + i});
            }
        }
    };
    points.emplace_back(0.0, 0.0, 0.0);
    std::vector<int> rings{ring(0.6, 0.0)};
    for (int k = 0; k <= kUp; ++k) rings.push_back(ring(1.0, kHeight * k / kUp));
    rings.push_back(ring(0.6, kHeight));
    points.emplace_back(0.0, kHeight, 0.0);
    for (std::size_t k = 0; k + 1 < rings.size(); ++k) strip(rings[k], rings[k + 1]);
    for (int i = 0; i < kAround; ++i) {
        const int j = (i + 1) % kAround;
        corners.push_back({0, rings.front() + j, rings.front() + i});
        corners.push_back({static_cast<int>(points.size()) - 1, rings.back() + i, rings.back() + j});
    }
    Hub out{shapes::detail::meshOf(points, corners), {}};
    for (int side = 0; side < kSides; ++side) {
        std::vector<std::int32_t> face;
        for (const std::size_t k : {2u, 3u})
            for (const int i : {1, 2}) face.push_back(rings[k] + kAcross * side + i);
        out.faces.push_back(face);
    }
    return out;
}

}  // namespace imomushi::hard
