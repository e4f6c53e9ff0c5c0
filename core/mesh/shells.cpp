// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/shells.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/winding_number.h"

namespace imomushi {
namespace {

constexpr int kSamples = 7;  // vertices of the inner shell that are tested; its box is tested first

bool liesIn(const TriangleMesh& mesh, const Shells::Shell& inner, const Shells::Shell& outer) {
    const std::size_t n = inner.triangles.size();
    for (int i = 0; i < kSamples; ++i) {
        const std::int32_t f = inner.triangles[n * static_cast<std::size_t>(i) / kSamples];
        const Vec3 p = mesh.vertices.row(mesh.triangles(f, i % 3));
        if (std::abs(windingNumber(mesh, outer.triangles, p)) < 0.5) return false;
    }
    return true;
}

}  // namespace

Shells findShells(const TriangleMesh& mesh, const std::vector<std::int32_t>& component, int count) {
    Shells result;
    auto& shells = result.shells;
    shells.resize(static_cast<std::size_t>(count));
    std::vector<Vec3> low(shells.size(), Vec3::Constant(HUGE_VAL)), high(shells.size(), Vec3::Constant(-HUGE_VAL));
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
        if (component[static_cast<std::size_t>(f)] < 0) continue;
        const auto s = static_cast<std::size_t>(component[static_cast<std::size_t>(f)]);
        shells[s].triangles.push_back(f);
        for (int k = 0; k < 3; ++k) {
            low[s] = low[s].cwiseMin(mesh.vertices.row(mesh.triangles(f, k)).transpose());
            high[s] = high[s].cwiseMax(mesh.vertices.row(mesh.triangles(f, k)).transpose());
        }
    }
    for (std::size_t s = 0; s < shells.size(); ++s) {
        const Vec3 centre = low[s] + (high[s] - low[s]) / 2;
        for (const std::int32_t f : shells[s].triangles) {
            const Vec3 a = mesh.vertices.row(mesh.triangles(f, 0)).transpose() - centre;
            const Vec3 b = mesh.vertices.row(mesh.triangles(f, 1)).transpose() - centre;
            const Vec3 c = mesh.vertices.row(mesh.triangles(f, 2)).transpose() - centre;
            shells[s].volume += a.dot(b.cross(c)) / 6.0;
        }
    }
    std::vector<std::vector<int>> around(shells.size());
    for (std::size_t i = 0; i < shells.size(); ++i)
        for (std::size_t o = 0; o < shells.size(); ++o) {
            if (i == o || (low[i].array() < low[o].array()).any() || (high[i].array() > high[o].array()).any()) continue;
            if (low[i] == low[o] && high[i] == high[o]) continue;
            if (liesIn(mesh, shells[i], shells[o])) around[i].push_back(static_cast<int>(o));
        }
    for (std::size_t i = 0; i < shells.size(); ++i) {
        shells[i].depth = static_cast<int>(around[i].size());
        for (const int o : around[i])
            if (shells[i].parent < 0 || around[static_cast<std::size_t>(o)].size() > around[static_cast<std::size_t>(shells[i].parent)].size())
                shells[i].parent = o;
    }
    return result;
}

}  // namespace imomushi
