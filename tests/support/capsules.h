// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"

/// Characters of capsules that flow into each other, closed by construction: marching tetrahedra over their distances.
namespace imomushi::capsules {

struct Capsule {
    Vec3 from, to;
    double radius = 0.1, tipRadius = 0.1;  ///< m, at both ends
};

/// Negative inside; capsules nearer to each other than `blend` (m) are rounded where they meet.
inline double distanceTo(const std::vector<Capsule>& body, const Vec3& p, double blend) {
    double nearest = 1e9;
    for (const Capsule& c : body) {
        const Vec3 side = c.to - c.from;
        const double t = std::clamp(side.dot(p - c.from) / std::max(side.squaredNorm(), 1e-12), 0.0, 1.0);
        const double d = (p - c.from - t * side).norm() - (c.radius + t * (c.tipRadius - c.radius));
        const double h = std::max(blend - std::abs(nearest - d), 0.0) / blend;
        nearest = std::min(nearest, d) - 0.25 * h * h * blend;
    }
    return nearest;
}

/// Their surface, with edges of about `cell` (m).
inline TriangleMesh surface(const std::vector<Capsule>& body, double cell, double blend = 0.05) {
    Vec3 low = Vec3::Constant(1e9), high = -low;
    for (const Capsule& c : body)
        for (const Vec3& p : {c.from, c.to}) {
            const Vec3 r = Vec3::Constant(std::max(c.radius, c.tipRadius) + blend + 2.0 * cell);
            low = low.cwiseMin(p - r);
            high = high.cwiseMax(p + r);
        }
    std::array<int, 3> n{};
    for (int k = 0; k < 3; ++k) n[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil((high[k] - low[k]) / cell)) + 1;
    const auto number = [&](int x, int y, int z) { return (z * n[1] + y) * n[0] + x; };
    const auto place = [&](int i) { return Vec3(low + cell * Vec3(i % n[0], (i / n[0]) % n[1], i / (n[0] * n[1]))); };
    std::vector<double> value(static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]));
    for (std::size_t i = 0; i < value.size(); ++i) {
        value[i] = distanceTo(body, place(static_cast<int>(i)), blend);
        if (std::abs(value[i]) < 0.02 * cell) value[i] = value[i] < 0.0 ? -0.02 * cell : 0.02 * cell;  // no slivers
    }
    const auto at = [&](int i) { return value[static_cast<std::size_t>(i)]; };
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> corners;
    std::map<std::pair<int, int>, int> known;
    const auto crossing = [&](int a, int b) {
        const auto [found, fresh] = known.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
        if (fresh) points.push_back(place(a) + at(a) / (at(a) - at(b)) * (place(b) - place(a)));
        return found->second;
    };
    const auto add = [&](int a, int b, int c, const Vec3& out) {
        const auto p = [&](int i) { return points[static_cast<std::size_t>(i)]; };
        const Vec3 u = p(b) - p(a), v = p(c) - p(a);
        const Vec3 normal(u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(), u.x() * v.y() - u.y() * v.x());
        corners.push_back(normal.dot(out) > 0.0 ? std::array{a, b, c} : std::array{a, c, b});
    };
    const std::array<std::array<int, 3>, 6> orders{{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (int z = 0; z + 1 < n[2]; ++z)
        for (int y = 0; y + 1 < n[1]; ++y)
            for (int x = 0; x + 1 < n[0]; ++x)
                for (const auto& order : orders) {
                    std::array<int, 3> step{x, y, z};
                    std::array<int, 4> tet{number(x, y, z)};
                    for (std::size_t k = 0; k < 3; ++k) {
                        ++step[static_cast<std::size_t>(order[k])];
                        tet[k + 1] = number(step[0], step[1], step[2]);
                    }
                    std::vector<int> in, out;
                    for (const int i : tet) (at(i) < 0.0 ? in : out).push_back(i);
                    if (in.empty() || out.empty()) continue;
                    Vec3 outward = Vec3::Zero();
                    for (const int i : out) outward += place(i) / static_cast<double>(out.size());
                    for (const int i : in) outward -= place(i) / static_cast<double>(in.size());
                    if (in.size() == 2) {
                        const int a = crossing(in[0], out[0]), b = crossing(in[0], out[1]), c = crossing(in[1], out[1]), d = crossing(in[1], out[0]);
                        add(a, b, c, outward);
                        add(a, c, d, outward);
                    } else {
                        const auto& one = in.size() == 1 ? in : out;
                        const auto& three = in.size() == 1 ? out : in;
                        add(crossing(one[0], three[0]), crossing(one[0], three[1]), crossing(one[0], three[2]), outward);
                    }
                }
    TriangleMesh mesh;
    mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
    mesh.triangles.resize(static_cast<Eigen::Index>(corners.size()), 3);
    for (std::size_t i = 0; i < points.size(); ++i) mesh.vertices.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
    for (std::size_t f = 0; f < corners.size(); ++f)
        for (int k = 0; k < 3; ++k) mesh.triangles(static_cast<Eigen::Index>(f), k) = corners[f][static_cast<std::size_t>(k)];
    return mesh;
}

/// Five arms of length 1 m in the plane y = 0, tapering from .16 to .08 m.
inline TriangleMesh starfish() {
    std::vector<Capsule> body{{Vec3(0, 0, 0), Vec3(0, 0, 1e-3), 0.25, 0.25}};
    for (int k = 0; k < 5; ++k) {
        const double a = 2.0 * std::numbers::pi * k / 5.0;
        body.push_back({Vec3(0, 0, 0), Vec3(std::sin(a), 0, std::cos(a)), 0.16, 0.08});
    }
    return surface(body, 0.06);
}

/// A tube of radius .15 m along a wave, 6.5 m long.
inline TriangleMesh snake() {
    std::vector<Capsule> body;
    for (int k = 0; k < 40; ++k) {
        const auto at = [](double z) { return Vec3(0.4 * std::sin(1.5 * z), 0.15, z); };
        body.push_back({at(0.15 * k - 3.0), at(0.15 * (k + 1) - 3.0), 0.15, 0.15});
    }
    return surface(body, 0.07, 0.01);
}

/// A trunk along z, four legs to the ground at y = 0, a neck with a head, a tail. Mirrored by x = 0.
inline TriangleMesh animal() {
    std::vector<Capsule> body{{Vec3(0, 1.0, -0.6), Vec3(0, 1.0, 0.6), 0.25, 0.25},
                              {Vec3(0, 1.1, 0.7), Vec3(0, 1.6, 1.0), 0.12, 0.12},
                              {Vec3(0, 1.65, 1.0), Vec3(0, 1.6, 1.35), 0.19, 0.12},
                              {Vec3(0, 1.1, -0.7), Vec3(0, 1.5, -1.5), 0.09, 0.06}};
    for (const double x : {-0.22, 0.22})
        for (const double z : {-0.55, 0.55}) body.push_back({Vec3(x, 0.95, z), Vec3(x, 0.1, z), 0.13, 0.1});
    return surface(body, 0.06);
}

}  // namespace imomushi::capsules
