// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/surface_study.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <unordered_map>

#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {
namespace {

/// The way over the surface over the way through the air, from which on a wall in front is across a gap. A wedge of 33 degrees has it.
constexpr double kDetour = 3.5;
/// Vertices that the way over the surface may visit: a fine mesh whose walls are that far apart has a gap.
constexpr std::size_t kVisits = 4000;
/// Rays look along the normal and this far to four sides of it.
constexpr double kTilt = 1.0;
/// Starts of rays before the surface, in diagonals: above rounding.
constexpr double kStart = 1e-9;
constexpr std::int32_t kLeaf = 4;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

/// Distances over the edges of a surface.
class Ways {
public:
    explicit Ways(const TriangleMesh& mesh) : mesh_(mesh), corners_(mesh) {}

    /// Whether a way of at most `longest` leads from a point in triangle f to a point in triangle g.
    bool reach(std::int32_t f, const Vec3& from, std::int32_t g, const Vec3& to, double longest) const {
        for (int k = 0; k < 9; ++k)  // neighbours, whose corners may be far away
            if (mesh_.triangles(f, k % 3) == mesh_.triangles(g, k / 3)) return true;
        using Entry = std::pair<double, std::int32_t>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        std::unordered_map<std::int32_t, double> best;
        const auto offer = [&](std::int32_t v, double d) {
            if (d + (mesh_.vertices.row(v).transpose() - to).norm() > longest) return;
            const auto [it, fresh] = best.try_emplace(v, d);
            if (!fresh && it->second <= d) return;
            it->second = d;
            queue.emplace(d, v);
        };
        for (int k = 0; k < 3; ++k) offer(mesh_.triangles(f, k), (mesh_.vertices.row(mesh_.triangles(f, k)).transpose() - from).norm());
        for (std::size_t visits = 0; !queue.empty() && visits < kVisits; ++visits) {
            const auto [d, v] = queue.top();
            queue.pop();
            if (d > best[v]) continue;
            for (int k = 0; k < 3; ++k)
                if (mesh_.triangles(g, k) == v && d + (mesh_.vertices.row(v).transpose() - to).norm() <= longest) return true;
            for (const std::int32_t c : corners_.at(v))
                for (int k = 1; k < 3; ++k) {
                    const std::int32_t w = mesh_.triangles(c / 3, (c % 3 + k) % 3);
                    offer(w, d + (mesh_.vertices.row(w) - mesh_.vertices.row(v)).norm());
                }
        }
        return false;
    }

private:
    const TriangleMesh& mesh_;
    VertexCorners corners_;
};

}  // namespace

std::vector<SurfaceSample> studySurface(const TriangleMesh& mesh, const RayTree& rays, int samples, double reach, const Progress& progress) {
    std::vector<SurfaceSample> out;
    const double whole = surfaceArea(mesh);
    if (!(whole > 0.0)) return out;
    const Ways ways(mesh);
    const TriangleTree near(mesh);
    double passed = 0.0;
    int taken = 0;
    for (std::int32_t f = 0; f < mesh.triangles.rows() && taken < samples; ++f) {
        const Vec3 twice = areaVector(mesh, f);
        const double length = twice.norm();
        passed += 0.5 * length;
        if (!(length > 0.0)) continue;
        const Vec3 a = mesh.vertices.row(mesh.triangles(f, 0)), b = mesh.vertices.row(mesh.triangles(f, 1)), c = mesh.vertices.row(mesh.triangles(f, 2));
        const Vec3 n = twice / length;
        const Vec3 side = n.unitOrthogonal(), other = n.cross(side);
        for (; taken < samples && (taken + 0.5) * whole <= passed * samples; ++taken) {
            if (progress.cancelled()) return out;
            // Places in the triangle by a sequence that fills it evenly (Roberts 2018, with the plastic number).
            double u = std::fmod(0.5 + 0.7548776662466927 * (taken + 1), 1.0), v = std::fmod(0.5 + 0.5698402909980532 * (taken + 1), 1.0);
            if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
            SurfaceSample sample;
            sample.point = a + u * (b - a) + v * (c - a);
            sample.normal = n;
            for (int ray = 0; ray < 5; ++ray) {
                const std::array<Vec3, 5> tilts{Vec3::Zero(), side, Vec3(-side), other, Vec3(-other)};
                const Vec3 across = (n + kTilt * tilts[static_cast<std::size_t>(ray)]).normalized();
                const RayTree::Hit hit = rays.first(sample.point + kStart * across, across, std::min(reach, sample.gap), f);
                if (hit.triangle < 0 || areaVector(mesh, hit.triangle).dot(across) >= 0.0 || hit.distance <= kStart) continue;
                if (ways.reach(f, sample.point, hit.triangle, sample.point + hit.distance * across, kDetour * hit.distance)) {
                    sample.crease = std::min(sample.crease, hit.distance);
                } else {
                    sample.gap = hit.distance;
                    sample.across = across;
                }
            }
            if (std::isfinite(sample.gap))
                sample.width = std::clamp(2.0 * std::sqrt(near.nearest(sample.point + 0.5 * sample.gap * sample.across).squaredDistance), 0.5 * sample.gap, sample.gap);
            const RayTree::Hit back = rays.first(sample.point - kStart * n, -n, reach, f);
            if (back.triangle >= 0 && areaVector(mesh, back.triangle).dot(n) < 0.0) sample.thickness = back.distance;
            out.push_back(sample);
        }
    }
    return out;
}

SizeField::SizeField(std::vector<Source> sources, double coarsest, double growth, double around) : coarsest_(coarsest), growth_(growth), around_(around) {
    // From the finest on: those that a finer one already answers for are left out.
    std::stable_sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) { return a.size < b.size; });
    std::unordered_map<std::int64_t, std::vector<std::int32_t>> cells;
    const double cell = std::max(coarsest / growth, 1e-6);  // no source reaches farther
    const auto key = [&](const Vec3& p, int dx, int dy, int dz) {
        const auto part = [&](double x, int d) { return (static_cast<std::int64_t>(std::floor(x / cell)) + d) & 0x1fffff; };
        return part(p.x(), dx) << 42 | part(p.y(), dy) << 21 | part(p.z(), dz);
    };
    for (const Source& s : sources) {
        if (s.size >= coarsest) continue;
        bool needed = true;
        for (int dx = -1; dx <= 1 && needed; ++dx)
            for (int dy = -1; dy <= 1 && needed; ++dy)
                for (int dz = -1; dz <= 1 && needed; ++dz)
                    if (const auto near = cells.find(key(s.point, dx, dy, dz)); near != cells.end())
                        needed = std::none_of(near->second.begin(), near->second.end(), [&](std::int32_t i) {
                            return sources_[index(i)].size + growth * (sources_[index(i)].point - s.point).norm() <= 1.1 * s.size;
                        });
        if (!needed) continue;
        cells[key(s.point, 0, 0, 0)].push_back(static_cast<std::int32_t>(sources_.size()));
        sources_.push_back(s);
    }
    if (!sources_.empty()) grow(0, static_cast<std::int32_t>(sources_.size()));
}

std::int32_t SizeField::grow(std::int32_t begin, std::int32_t end) {
    const auto self = static_cast<std::int32_t>(nodes_.size());
    Node node;
    node.begin = begin, node.end = end;
    node.low = Vec3::Constant(std::numeric_limits<double>::max());
    node.high = -node.low;
    node.size = std::numeric_limits<double>::max();
    for (std::int32_t i = begin; i < end; ++i) {
        node.low = node.low.cwiseMin(sources_[index(i)].point);
        node.high = node.high.cwiseMax(sources_[index(i)].point);
        node.size = std::min(node.size, sources_[index(i)].size);
    }
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return self;
    Eigen::Index axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const std::int32_t half = begin + (end - begin) / 2;
    std::stable_sort(sources_.begin() + begin, sources_.begin() + end, [&](const Source& a, const Source& b) { return a.point[axis] < b.point[axis]; });
    grow(begin, half);
    const std::int32_t right = grow(half, end);
    nodes_[index(self)].right = right;
    return self;
}

double SizeField::at(const Vec3& point) const {
    double best = coarsest_;
    if (nodes_.empty()) return best;
    std::array<std::int32_t, 64> open{};  // halving 2^31 sources cannot go deeper
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
        const std::int32_t n = open[--count];
        const Node& node = nodes_[static_cast<std::size_t>(n)];
        if (node.size + growth_ * std::max(0.0, (node.low - point).cwiseMax(point - node.high).cwiseMax(0.0).norm() - around_) >= best) continue;
        if (node.right >= 0) {
            open[count++] = node.right;
            open[count++] = n + 1;
            continue;
        }
        for (std::int32_t i = node.begin; i < node.end; ++i)
            best = std::min(best, sources_[static_cast<std::size_t>(i)].size +
                                      growth_ * std::max(0.0, (sources_[static_cast<std::size_t>(i)].point - point).norm() - around_));
    }
    return best;
}

}  // namespace imomushi
