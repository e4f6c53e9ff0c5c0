// SPDX-License-Identifier: GPL-3.0-or-later
#include "element.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>

namespace imomushi::samples {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Vec3 toFloat(const Vec3& p) { return p.cast<float>().cast<double>(); }

/// Two axes that with n make a right-handed frame.
std::pair<Vec3, Vec3> across(const Vec3& n) {
    const Vec3 u = (std::abs(n.y()) < 0.9 ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitX())).cross(n).normalized();
    return {u, n.cross(u)};
}

/// Triangulates a set of directions on the sphere: their convex hull, outward.
std::vector<std::array<int, 3>> triangulateDirections(const std::vector<Vec3>& directions) {
    std::vector<Point> points;
    std::map<std::array<double, 3>, int> index;
    unsigned state = 1;
    for (const Vec3& d : directions) {
        Vec3 q = d;
        for (int k = 0; k < 3; ++k) {  // rings of discs are cocircular: a little noise makes the triangulation unique
            state = state * 1664525u + 1013904223u;
            q[k] += 1e-7 * (double(state >> 8) / double(1u << 24) - 0.5);
        }
        q.normalize();
        index[{q.x(), q.y(), q.z()}] = int(points.size());
        points.emplace_back(q.x(), q.y(), q.z());
    }
    CGAL::Surface_mesh<Point> hull;
    CGAL::convex_hull_3(points.begin(), points.end(), hull);
    std::vector<std::array<int, 3>> triangles;
    for (auto f : hull.faces()) {
        std::array<int, 3> t{};
        int k = 0;
        for (auto v : CGAL::vertices_around_face(hull.halfedge(f), hull)) {
            const Point& p = hull.point(v);
            t[k++ % 3] = index.at({p.x(), p.y(), p.z()});
        }
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        triangles.push_back(t);
    }
    std::sort(triangles.begin(), triangles.end());  // the hull is unique, the order in which CGAL finds it is not
    return triangles;
}

}  // namespace

Disc meshDisc(const JointSpec& joint, const Shape& shape) {
    const Vec3 n = joint.normal.normalized();
    const auto [u, w] = across(n);
    Disc disc;
    disc.rim = joint.rim;
    auto& points = disc.mesh.points;
    std::vector<double> radius(joint.rim);
    std::vector<std::vector<int>> rings;
    const auto radiusAt = [&](double turn) {  // turn in rim steps
        const int i = int(std::floor(turn)), m = joint.rim;
        const double t = turn - i;
        return radius[(i % m + m) % m] * (1 - t) + radius[((i + 1) % m + m) % m] * t;
    };
    const auto direction = [&](double turn) {
        const double a = 2 * M_PI * turn / joint.rim;
        return Vec3(std::cos(a) * u + std::sin(a) * w);
    };
    rings.emplace_back();
    for (int i = 0; i < joint.rim; ++i) {
        radius[i] = hit(shape, joint.centre, direction(i), 10.0);
        if (radius[i] >= 10.0) throw std::runtime_error("A joint plane leaves the shape.");
        rings.back().push_back(int(points.size()));
        points.push_back(joint.centre + radius[i] * direction(i));
    }
    const double depth = double(joint.rings.size()) + (joint.rings.back() == 1 ? 0.0 : 0.6);
    for (std::size_t r = 0; r < joint.rings.size(); ++r) {
        const int count = joint.rings[r];
        const double fraction = 1.0 - double(r + 1) / depth;
        rings.emplace_back();
        for (int i = 0; i < count; ++i) {
            const double turn = (i + 0.5 * double((r + 1) % 2)) * joint.rim / count;
            rings.back().push_back(int(points.size()));
            points.push_back(joint.centre + (count == 1 ? 0.0 : fraction * radiusAt(turn)) * direction(turn));
        }
    }
    // Stitch ring to ring, always by the shorter diagonal.
    auto& triangles = disc.mesh.triangles;
    for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
        const auto &outer = rings[r], &inner = rings[r + 1];
        const std::size_t no = outer.size(), ni = inner.size();
        if (ni == 1) {
            for (std::size_t i = 0; i < no; ++i) triangles.push_back({outer[i], outer[(i + 1) % no], inner[0]});
            continue;
        }
        std::size_t i = 0, j = 0;
        for (std::size_t k = 1; k < ni; ++k)
            if ((points[inner[k]] - points[outer[0]]).norm() < (points[inner[j]] - points[outer[0]]).norm()) j = k;
        for (std::size_t a = 0, b = 0; a < no || b < ni;) {
            const int o = outer[i % no], o1 = outer[(i + 1) % no], q = inner[j % ni], q1 = inner[(j + 1) % ni];
            const bool outerStep = b == ni || (a < no && (points[o1] - points[q]).norm() <= (points[q1] - points[o]).norm());
            if (outerStep) {
                triangles.push_back({o, o1, q});
                ++i, ++a;
            } else {
                triangles.push_back({o, q1, q});
                ++j, ++b;
            }
        }
    }
    for (std::size_t i = 1; i + 1 < rings.back().size(); ++i) triangles.push_back({rings.back()[0], rings.back()[i], rings.back()[i + 1]});
    for (int pass = 0; pass < 20; ++pass) {
        std::vector<Vec3> sum(points.size(), Vec3::Zero());
        std::vector<double> weight(points.size(), 0);
        for (const auto& t : triangles) {
            const Vec3 centre = (points[t[0]] + points[t[1]] + points[t[2]]) / 3;
            const double area = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm();
            for (int v : t) sum[v] += area * centre, weight[v] += area;
        }
        for (std::size_t v = joint.rim; v < points.size(); ++v) points[v] = 0.5 * (points[v] + sum[v] / weight[v]);
    }
    for (Vec3& p : points) p = toFloat(p);
    return disc;
}

Mesh meshElement(const CharacterSpec& character, int element, const std::vector<Disc>& discs) {
    const ElementSpec& spec = character.elements[element];
    const Shape& shape = character.shape;
    // All points of the discs first (rims before insides), then directions that see the free surface.
    struct Cap {
        const Disc* disc;
        Vec3 normal;     // outward for this element
        Vec3 centre;
        bool reversed;
        std::vector<int> index;  // of the disc's points here
    };
    std::vector<Cap> caps;
    std::vector<Vec3> rimPoints, innerPoints;
    for (std::size_t j = 0; j < character.joints.size(); ++j) {
        const JointSpec& joint = character.joints[j];
        if (joint.a != element && joint.b != element) continue;
        const bool reversed = joint.b == element;
        caps.push_back({&discs[j], reversed ? Vec3(-joint.normal.normalized()) : Vec3(joint.normal.normalized()), joint.centre, reversed, {}});
    }
    for (Cap& cap : caps)
        for (int i = 0; i < cap.disc->rim; ++i) {
            cap.index.push_back(int(rimPoints.size()));
            rimPoints.push_back(cap.disc->mesh.points[i]);
        }
    const int rim = int(rimPoints.size());
    for (Cap& cap : caps)
        for (std::size_t i = cap.disc->rim; i < cap.disc->mesh.points.size(); ++i) {
            cap.index.push_back(rim + int(innerPoints.size()));
            innerPoints.push_back(cap.disc->mesh.points[i]);
        }
    std::vector<Vec3> points = rimPoints, directions;
    points.insert(points.end(), innerPoints.begin(), innerPoints.end());
    for (const Vec3& p : points) directions.push_back((p - spec.centre).normalized());
    const int held = int(points.size());

    constexpr int kRays = 4000;
    for (int i = 0; i < kRays; ++i) {  // Fibonacci sphere
        const double z = 1 - (2 * i + 1.0) / kRays, a = M_PI * (3 - std::sqrt(5.0)) * i, s = std::sqrt(1 - z * z);
        const Vec3 d(s * std::cos(a), s * std::sin(a), z);
        bool open = true;
        for (const Cap& cap : caps) {
            const double slope = d.dot(cap.normal);
            if (slope <= 1e-6) continue;
            const Vec3 q = spec.centre + d * ((cap.centre - spec.centre).dot(cap.normal) / slope);
            bool inside = true;
            for (int k = 0; k < cap.disc->rim && inside; ++k) {
                const Vec3 a0 = cap.disc->mesh.points[k], a1 = cap.disc->mesh.points[(k + 1) % cap.disc->rim];
                inside = (cap.reversed ? -1.0 : 1.0) * (a1 - a0).cross(cap.normal).dot(a0 - q) >= 0;
            }
            if (inside) open = false;
        }
        // Nor so near to a rim edge that the triangulation would miss it.
        for (const Cap& cap : caps)
            for (int k = 0; k < cap.disc->rim && open; ++k) {
                const Vec3 &a0 = directions[cap.index[k]], &a1 = directions[cap.index[(k + 1) % cap.disc->rim]];
                open = (d - ((a0 + a1) / 2).normalized()).norm() > 0.6 * (a1 - a0).norm();
            }
        if (!open) continue;
        const double t = hit(shape, spec.centre, d, 10.0);
        if (t >= 10.0) throw std::runtime_error(spec.name + " is open.");
        directions.push_back(d);
        points.push_back(spec.centre + t * d);
    }

    // The free surface: what the directions span outside the discs.
    std::vector<int> capOf(points.size(), -1);
    for (std::size_t c = 0; c < caps.size(); ++c)
        for (int v : caps[c].index) capOf[v] = int(c);
    Mesh free;
    free.points.assign(points.begin(), points.begin() + rim);
    free.points.insert(free.points.end(), points.begin() + held, points.end());
    const int inner = held - rim;
    for (const auto& t : triangulateDirections(directions)) {
        if (capOf[t[0]] >= 0 && capOf[t[0]] == capOf[t[1]] && capOf[t[1]] == capOf[t[2]]) continue;
        std::array<int, 3> moved{};
        for (int k = 0; k < 3; ++k) {
            if (t[k] >= rim && t[k] < held) throw std::runtime_error(spec.name + ": a disc is not seen whole from the centre.");
            moved[k] = t[k] < rim ? t[k] : t[k] - inner;
        }
        free.triangles.push_back(moved);
    }
    int vertices = spec.vertices;
    if (vertices > 0) vertices -= inner;
    free = remesh(free, rim, shape, character.size, vertices);

    // Together: rims and free surface, then the insides of the discs.
    Mesh whole = free;
    for (int v = rim; v < int(whole.points.size()); ++v) whole.points[v] = toFloat(whole.points[v]);
    const int offset = int(whole.points.size()) - rim;
    whole.points.insert(whole.points.end(), innerPoints.begin(), innerPoints.end());
    for (const Cap& cap : caps)
        for (auto t : cap.disc->mesh.triangles) {
            if (cap.reversed) std::swap(t[1], t[2]);
            for (int& v : t) v = cap.index[v] < rim ? cap.index[v] : cap.index[v] + offset;
            whole.triangles.push_back(t);
        }
    std::map<std::pair<int, int>, int> halfEdges;
    for (const auto& t : whole.triangles)
        for (int k = 0; k < 3; ++k) ++halfEdges[{t[k], t[(k + 1) % 3]}];
    for (const auto& [e, n] : halfEdges)
        if (n != 1 || !halfEdges.count({e.second, e.first})) {
            const Vec3 &a = whole.points[e.first];
            throw std::runtime_error(spec.name + " is not closed at " + std::to_string(a.x()) + " " + std::to_string(a.y()) + " " + std::to_string(a.z()));
        }
    return whole;
}

}  // namespace imomushi::samples
