// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace imomushi::samples {

Mesh surfaceOf(const Shape& shape, const Vec3& low, const Vec3& high, double step) {
    const Eigen::Vector3i n = ((high - low) / step).array().ceil().cast<int>() + 1;
    const auto index = [&](int x, int y, int z) { return (z * n.y() + y) * n.x() + x; };
    const auto place = [&](int i) { return Vec3(low + step * Vec3(i % n.x(), i / n.x() % n.y(), i / (n.x() * n.y()))); };
    std::vector<double> value(static_cast<std::size_t>(n.x()) * n.y() * n.z());
    for (std::size_t i = 0; i < value.size(); ++i) value[i] = shape(place(int(i)));

    Mesh mesh;
    std::map<std::pair<int, int>, int> onEdge;
    const auto between = [&](int in, int out) {
        const auto [it, fresh] = onEdge.try_emplace(std::minmax(in, out), int(mesh.points.size()));
        if (fresh) {
            // Off the corners, so that no triangle is a point.
            const double t = std::clamp(value[in] / (value[in] - value[out]), 0.05, 0.95);
            mesh.points.push_back(place(in) + t * (place(out) - place(in)));
        }
        return it->second;
    };
    const auto add = [&](std::array<int, 3> t, const Vec3& out) {
        const auto& p = mesh.points;
        if ((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(out) < 0) std::swap(t[1], t[2]);
        mesh.triangles.push_back(t);
    };
    // Six tetrahedra around the diagonal of each cell, the same in all cells (Kuhn).
    constexpr int kWays[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int z = 0; z + 1 < n.z(); ++z)
        for (int y = 0; y + 1 < n.y(); ++y)
            for (int x = 0; x + 1 < n.x(); ++x)
                for (const auto& way : kWays) {
                    std::vector<int> in, out;
                    Eigen::Vector3i corner(x, y, z);
                    for (int k = 0; k < 4; ++k) {
                        const int i = index(corner.x(), corner.y(), corner.z());
                        (value[i] < 0 ? in : out).push_back(i);
                        if (k < 3) ++corner[way[k]];
                    }
                    if (in.empty() || out.empty()) continue;
                    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
                    for (int i : in) from += place(i) / double(in.size());
                    for (int i : out) to += place(i) / double(out.size());
                    if (in.size() == 1) add({between(in[0], out[0]), between(in[0], out[1]), between(in[0], out[2])}, to - from);
                    if (out.size() == 1) add({between(in[0], out[0]), between(in[1], out[0]), between(in[2], out[0])}, to - from);
                    if (in.size() == 2) {
                        const int a = between(in[0], out[0]), b = between(in[0], out[1]), c = between(in[1], out[1]), d = between(in[1], out[0]);
                        add({a, b, c}, to - from);
                        add({a, c, d}, to - from);
                    }
                }
    return mesh;
}

}  // namespace imomushi::samples
