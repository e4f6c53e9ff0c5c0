// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace imomushi::samples {

double smallestAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto angle = [](const Vec3& u, const Vec3& v) { return std::atan2(u.cross(v).norm(), u.dot(v)); };
    return std::min({angle(b - a, c - a), angle(c - b, a - b), angle(a - c, b - c)});
}

namespace {

using Edge = std::pair<int, int>;
using Size = std::function<double(const Vec3&)>;

class Remesher {
public:
    Remesher(Mesh mesh, int fixed, const Shape& shape, Size size) : m_(std::move(mesh)), fixed_(fixed), shape_(shape), size_(std::move(size)) {}

    void run(int rounds) {
        for (int i = 0; i < rounds; ++i) {
            for (int k = 0; k < 6 && split(4.0 / 3, -1) > 0; ++k) {}
            for (int k = 0; k < 6 && collapse(4.0 / 5, -1) > 0; ++k) {}
            settle(3);
        }
    }
    /// Flips and smooths only.
    void settle(int rounds) {
        for (int i = 0; i < rounds; ++i) {
            for (int k = 0; k < 6 && flip() > 0; ++k) {}
            smooth();
        }
    }
    /// One vertex more or fewer at a time.
    void reach(int vertices) {
        for (int guard = 0; count() != vertices && guard < 2000; ++guard) {
            const int done = count() < vertices ? split(0.0, 1) : collapse(9.0, 1);
            settle(2);
            if (done == 0) break;
        }
        settle(20);
        while (splitFixed() > 0) settle(5);
    }
    [[nodiscard]] int count() const { return int(m_.points.size()); }
    [[nodiscard]] Mesh mesh() const { return m_; }

private:
    struct Sides {
        int triangle[2] = {-1, -1};
        int opposite[2] = {-1, -1};
    };
    std::map<Edge, Sides> edges() const {
        std::map<Edge, Sides> all;
        for (int t = 0; t < int(m_.triangles.size()); ++t)
            for (int k = 0; k < 3; ++k) {
                const int a = m_.triangles[t][k], b = m_.triangles[t][(k + 1) % 3];
                auto& s = all[{std::min(a, b), std::max(a, b)}];
                const int side = a < b ? 0 : 1;
                s.triangle[side] = t;
                s.opposite[side] = m_.triangles[t][(k + 2) % 3];
            }
        return all;
    }
    std::vector<std::vector<int>> around() const {
        std::vector<std::vector<int>> rings(m_.points.size());
        for (int t = 0; t < int(m_.triangles.size()); ++t)
            for (int v : m_.triangles[t]) rings[v].push_back(t);
        return rings;
    }
    [[nodiscard]] bool isFixed(int v) const { return v < fixed_; }
    /// Twice the area, along the normal.
    [[nodiscard]] Vec3 area(int a, int b, int c) const { return (m_.points[b] - m_.points[a]).cross(m_.points[c] - m_.points[a]); }
    /// Two triangles look to about the same side.
    static bool agree(const Vec3& m, const Vec3& n, double least) {
        const double length = m.norm() * n.norm();
        return length > 1e-16 && m.dot(n) > least * length;
    }
    [[nodiscard]] double relativeLength(int a, int b) const {
        return (m_.points[a] - m_.points[b]).norm() / size_((m_.points[a] + m_.points[b]) / 2);
    }

    int splitFixed() { return split(1e9, -1); }

    /// Splits edges longer than `limit` sizes, longest first, and every inner edge between fixed points. At most `most` (-1: all).
    int split(double limit, int most) {
        const auto all = edges();
        std::vector<std::pair<double, Edge>> order;
        for (const auto& [e, s] : all) {
            if (s.triangle[0] < 0 || s.triangle[1] < 0) continue;
            const double l = isFixed(e.first) && isFixed(e.second) ? 1e9 : relativeLength(e.first, e.second);
            if (l > limit) order.push_back({-l, e});
        }
        std::sort(order.begin(), order.end());
        std::set<int> touched;
        int done = 0;
        for (const auto& [l, e] : order) {
            if (done == most) break;
            const Sides& s = all.at(e);
            if (touched.count(s.triangle[0]) || touched.count(s.triangle[1])) continue;
            const int v = int(m_.points.size());
            m_.points.push_back(project(shape_, (m_.points[e.first] + m_.points[e.second]) / 2));
            for (int side = 0; side < 2; ++side) {
                auto& t = m_.triangles[s.triangle[side]];
                auto second = t;
                std::replace(t.begin(), t.end(), e.second, v);
                std::replace(second.begin(), second.end(), e.first, v);
                m_.triangles.push_back(second);
                touched.insert(s.triangle[side]);
            }
            ++done;
        }
        return done;
    }

    /// Collapses edges shorter than `limit` sizes, shortest first.
    int collapse(double limit, int most) {
        const auto all = edges();
        auto rings = around();
        std::vector<std::pair<double, Edge>> order;
        for (const auto& [e, s] : all) {
            if (isFixed(e.first) && isFixed(e.second)) continue;
            const double l = relativeLength(e.first, e.second);
            if (l < limit) order.push_back({l, e});
        }
        std::sort(order.begin(), order.end());
        std::vector<char> touched(m_.points.size(), 0);
        std::vector<int> gone;
        std::vector<char> dead(m_.triangles.size(), 0);
        const auto neighbours = [&](int v) {
            std::set<int> n;
            for (int t : rings[v])
                for (int w : m_.triangles[t])
                    if (w != v) n.insert(w);
            return n;
        };
        for (const auto& [l, e] : order) {
            if (int(gone.size()) == most) break;
            const int keep = isFixed(e.first) ? e.first : e.second, drop = isFixed(e.first) ? e.second : e.first;
            if (isFixed(drop)) continue;
            const auto nk = neighbours(keep), nd = neighbours(drop);
            std::vector<int> common;
            std::set_intersection(nk.begin(), nk.end(), nd.begin(), nd.end(), std::back_inserter(common));
            if (common.size() != 2) continue;
            bool good = !touched[keep] && !touched[drop];
            for (int w : nk) good = good && !touched[w];
            for (int w : nd) good = good && !touched[w];
            for (int w : common) good = good && rings[w].size() > 4;
            const Vec3 p = isFixed(keep) ? m_.points[keep] : project(shape_, (m_.points[keep] + m_.points[drop]) / 2);
            for (int w : nd)
                if (w != keep) {
                    const double r = (m_.points[w] - p).norm() / size_((m_.points[w] + p) / 2);
                    good = good && (most == 1 || r < 1.4) && !(isFixed(keep) && isFixed(w) && !nk.count(w));
                }
            for (int v : {keep, drop})
                for (int t : rings[v]) {
                    if (!good) break;
                    const auto& c = m_.triangles[t];
                    if (std::count(c.begin(), c.end(), keep) && std::count(c.begin(), c.end(), drop)) continue;
                    Vec3 q[3];
                    for (int k = 0; k < 3; ++k) q[k] = c[k] == v ? p : m_.points[c[k]];
                    good = agree((q[1] - q[0]).cross(q[2] - q[0]), area(c[0], c[1], c[2]), 0.5) && smallestAngle(q[0], q[1], q[2]) > 0.15;
                }
            if (!good) continue;
            m_.points[keep] = p;
            for (int t : rings[drop]) {
                auto& c = m_.triangles[t];
                if (std::count(c.begin(), c.end(), keep))
                    dead[t] = 1;
                else
                    std::replace(c.begin(), c.end(), drop, keep);
            }
            for (int w : nk) touched[w] = 1;
            for (int w : nd) touched[w] = 1;
            touched[keep] = touched[drop] = 1;
            gone.push_back(drop);
        }
        if (gone.empty()) return 0;
        std::vector<int> renumber(m_.points.size(), 0);
        for (int v : gone) renumber[v] = -1;
        std::vector<Vec3> points;
        for (std::size_t v = 0; v < m_.points.size(); ++v)
            if (renumber[v] == 0) {
                renumber[v] = int(points.size());
                points.push_back(m_.points[v]);
            }
        std::vector<std::array<int, 3>> triangles;
        for (std::size_t t = 0; t < m_.triangles.size(); ++t)
            if (!dead[t]) {
                auto c = m_.triangles[t];
                for (int& v : c) v = renumber[v];
                triangles.push_back(c);
            }
        m_ = {std::move(points), std::move(triangles)};
        return int(gone.size());
    }

    /// Delaunay flips.
    int flip() {
        const auto all = edges();
        std::set<int> touched;
        std::set<Edge> made;
        int done = 0;
        const auto& p = m_.points;
        for (const auto& [e, s] : all) {
            if (s.triangle[0] < 0 || s.triangle[1] < 0) continue;
            if (touched.count(s.triangle[0]) || touched.count(s.triangle[1])) continue;
            const int a = e.first, b = e.second, c = s.opposite[0], d = s.opposite[1];
            const Edge across{std::min(c, d), std::max(c, d)};
            if ((isFixed(c) && isFixed(d)) || all.count(across) || made.count(across)) continue;
            const auto angle = [&](int at) {
                const Vec3 u = p[a] - p[at], v = p[b] - p[at];
                return std::atan2(u.cross(v).norm(), u.dot(v));
            };
            if (angle(c) + angle(d) < M_PI + 1e-6) continue;
            const Vec3 out = area(a, b, c) + area(b, a, d);
            if (!agree(area(c, a, d), out, 0.4) || !agree(area(c, d, b), out, 0.4)) continue;
            m_.triangles[s.triangle[0]] = {c, a, d};
            m_.triangles[s.triangle[1]] = {c, d, b};
            touched.insert({s.triangle[0], s.triangle[1]});
            made.insert(across);
            ++done;
        }
        return done;
    }

    /// Moves points within the surface towards the centroids of their triangles, weighted by area over wanted area.
    void smooth() {
        std::vector<Vec3> sum(m_.points.size(), Vec3::Zero());
        std::vector<double> weight(m_.points.size(), 0.0);
        for (const auto& t : m_.triangles) {
            const Vec3 &a = m_.points[t[0]], &b = m_.points[t[1]], &c = m_.points[t[2]], centre = (a + b + c) / 3;
            const double h = size_(centre), w = (b - a).cross(c - a).norm() / (h * h);
            for (int v : t) {
                sum[v] += w * centre;
                weight[v] += w;
            }
        }
        const auto rings = around();
        for (int v = fixed_; v < count(); ++v) {
            if (weight[v] <= 0) continue;
            Vec3 step = 0.6 * (sum[v] / weight[v] - m_.points[v]);
            const Vec3 n = normal(shape_, m_.points[v]);
            step -= n * n.dot(step);
            const Vec3 before = m_.points[v], after = project(shape_, before + step);
            for (int t : rings[v]) {
                const auto& c = m_.triangles[t];
                m_.points[v] = before;
                const Vec3 was = area(c[0], c[1], c[2]);
                m_.points[v] = after;
                if (!agree(area(c[0], c[1], c[2]), was, 0.3)) {
                    m_.points[v] = before;
                    break;
                }
            }
        }
    }

    Mesh m_;
    int fixed_;
    const Shape& shape_;
    Size size_;
};

}  // namespace

Mesh remesh(const Mesh& start, int fixed, const Shape& shape, const std::function<double(const Vec3&)>& size, int vertices) {
    double scale = 1.0;
    constexpr int kTries = 5;
    Mesh from = start;
    for (int attempt = 0;; ++attempt) {
        Remesher work(from, fixed, shape, [&](const Vec3& p) { return scale * size(p); });
        work.run(attempt == 0 ? 12 : 6);
        const int n = work.count();
        if (vertices > 0 && n != vertices && attempt < kTries && std::abs(n - vertices) > 3) {
            scale *= std::sqrt(double(std::max(n - fixed, 1)) / std::max(vertices - fixed, 1));
            from = work.mesh();
            continue;
        }
        work.settle(20);
        work.reach(vertices > 0 ? vertices : n);
        return work.mesh();
    }
}

}  // namespace imomushi::samples
