// SPDX-License-Identifier: GPL-3.0-or-later
// Johnson, Contact Mechanics (1985), sections 3.2, 3.6 and 3.7. With the pressure q of total 1 on a disc, three functions of the distance r from its middle make
// all displacements of the surface: the potential A = integral of q / |x - y|, the slope G of the integral of q |x - y| over r, and the part of the force within
// r over r^2, E.
#include "core/touch/dent_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/mesh/surface_distance.h"
#include "core/mesh/topology.h"
#include "core/touch/touch_blocks.h"

namespace imomushi {
namespace {

constexpr int kLanes = TouchBlocks::kBlock;
constexpr std::size_t kOfBlock = 7 * kLanes;
/// Mean squared distance from the middle of half an ellipsoid, in squared radii.
constexpr double kSpread = 0.4;
/// Within this many radii of the patches all of the difference is added, from there on to DentSurface::kReach less and less.
constexpr double kWhole = 1.5;
/// A surface that is turned by more than acos(kTurned) moves less than by all, one that is turned by 90 degrees not at all.
constexpr double kTurned = 0.5;
/// Dents fade towards joint faces, from this many reaches of a patch on.
constexpr double kFadesFrom = 0.5;

/// From 0 at 0 to 1 at 1.
template <class T>
T smooth(const T& x) {
    return x * x * (3 - 2 * x);
}

/// Correctly rounded, unlike Eigen's, which differs from one processor to another.
template <class T, int N>
Eigen::Array<T, N, 1> root(const Eigen::Array<T, N, 1>& x) {
    Eigen::Array<T, N, 1> out;
    for (int i = 0; i < N; ++i) out[i] = std::sqrt(x[i]);
    return out;
}

/// Of the sphere of radius `a`, at squared distances `square`. Outside of the contact A and G are polynomials of q = sqrt(1 - a^2 / r^2), which miss the closed
/// forms, of arc sines, by less than 3e-5.
template <class Array>
struct Potentials {
    Array A, G, E;
    Potentials(const Array& square, typename Array::Scalar a) {
        using T = typename Array::Scalar;
        const T edge = a * a, at = T(3.0 * std::numbers::pi / 8.0) / a;
        const Array far = square.max(edge), inverse = far.inverse(), length = root(inverse), x = (square / edge).min(T(1));
        const Array q = root(Array((T(1) - edge * inverse).max(T(0)))), y = root(Array(T(1) - x));
        const auto outside = square > edge;
        const Array farA = T(1.17809725) +
                           q * (T(-0.00069974) +
                                q * (T(-0.57121969) + q * (T(0.8587692) + q * (T(-0.79094648) + q * (T(0.42570224) - T(0.09970278) * q)))));
        const Array farG = T(0.88357293) + q * (T(-0.00074864) + q * (T(0.15716571) + q * (T(-0.04625408) + T(0.00626407) * q)));
        A = outside.select(farA * length, at * (T(2) - x));
        G = outside.select(farG * length, at * (T(1) - T(0.25) * x));
        E = outside.select(inverse, (T(1) + y + y * y) / ((T(1) + y) * edge));
    }
};

template <class Array>
struct Moved {
    Array x, y, z;
};
/// Displacement by a dent of vertices with these places and normals; `clear`: the part of it that each follows.
template <class Array>
Moved<Array> displacement(const Dent& dent, double nu, const Moved<Array>& place, const Moved<Array>& normal, const Array& clear) {
    using T = typename Array::Scalar;
    using V = Eigen::Matrix<T, 3, 1>;
    const V centre = dent.centre.cast<T>(), n = dent.normal.cast<T>(), wide = dent.patchCentre.cast<T>(), force = dent.force.cast<T>();
    const T into = n.dot(force);
    const V along = force - into * n;
    Moved<Array> out{Array::Zero(), Array::Zero(), Array::Zero()};
    const auto add = [&](const V& middle, T radius, T sign) {
        Array dx = place.x - middle.x(), dy = place.y - middle.y(), dz = place.z - middle.z();
        const Array square = dx.square() + dy.square() + dz.square();
        const Potentials<Array> by(square, radius);
        const Array above = n.x() * dx + n.y() * dy + n.z() * dz;
        dx -= above * n.x();
        dy -= above * n.y();
        dz -= above * n.z();
        const T whole = sign / T(2.0 * std::numbers::pi), part = T(0.5 - nu) * whole;
        // Along the plane: (1 - nu) A f + nu (G towards and from the middle, A - G across) of f, and what the force into the plane draws in.
        const Array dot = along.x() * dx + along.y() * dy + along.z() * dz, flat = dx.square() + dy.square() + dz.square();
        const Array across = whole * (T(1 - nu) * by.A + T(nu) * (by.A - by.G));
        const Array radial =
            (flat > T(0)).select(whole * T(nu) * (by.G + by.G - by.A) * dot / flat.max(std::numeric_limits<T>::min()), Array::Zero()) +
            part * into * by.E;
        const Array up = whole * T(1 - nu) * into * by.A - part * dot * by.E;
        out.x += across * along.x() + radial * dx + up * n.x();
        out.y += across * along.y() + radial * dy + up * n.y();
        out.z += across * along.z() + radial * dz + up * n.z();
    };
    add(centre, static_cast<T>(dent.radius), T(1));
    add(wide, static_cast<T>(dent.patchRadius), T(-1));
    const Array far = root(Array((place.x - centre.x()).square() + (place.y - centre.y()).square() + (place.z - centre.z()).square())) /
                      static_cast<T>(dent.patchRadius);
    const Array near = ((T(DentSurface::kReach) - far) / T(DentSurface::kReach - kWhole)).max(T(0)).min(T(1));
    const Array faces = ((n.x() * normal.x + n.y() * normal.y + n.z() * normal.z) / T(kTurned)).max(T(0)).min(T(1));
    const Array share = clear * smooth(near) * smooth(faces);
    out.x *= share;
    out.y *= share;
    out.z *= share;
    return out;
}

}  // namespace

void Dent::put(double* to) const {
    for (const Vec3* v : {&force, &centre, &normal, &patchCentre}) to = std::copy_n(v->data(), 3, to);
    *to++ = radius;
    *to = patchRadius;
}

void Dent::take(const double* from) {
    for (Vec3* v : {&force, &centre, &normal, &patchCentre}) {
        std::copy_n(from, 3, v->data());
        from += 3;
    }
    radius = *from++;
    patchRadius = *from;
}

Dent Dent::between(const Dent& a, const Dent& b, double part) {
    Dent out = a.radius > 0.0 ? a : b;
    out.force = a.force + part * (b.force - a.force);
    if (!(a.radius > 0.0) || !(b.radius > 0.0)) return out;
    out.centre += part * (b.centre - a.centre);
    out.normal = (a.normal + part * (b.normal - a.normal)).normalized();
    out.radius += part * (b.radius - a.radius);
    out.patchCentre += part * (b.patchCentre - a.patchCentre);
    out.patchRadius += part * (b.patchRadius - a.patchRadius);
    return out;
}

DentSurface::DentSurface(const ElementMesh& mesh, std::span<const JointFace> faces, std::shared_ptr<const TouchSurface> surface, double nu,
                         std::span<const std::int32_t> first)
    : surface_(std::move(surface)), nu_(nu) {
    const TriangleMesh& body = mesh.body;
    const TouchPatches& patches = surface_->touch().patches;
    const auto vertices = static_cast<std::size_t>(body.vertices.rows());

    clear_.assign(vertices, 1.0f);
    std::vector<SurfaceSource> held;
    for (const JointFace& face : faces)
        for (const std::int32_t v : face.vertices) held.emplace_back(v, 0.0);
    const double fades = kFadesFrom * patches.reach;
    if (fades > 0.0)
        SurfaceDistance(body).spread(
            std::span<const SurfaceSource>(held), fades, [](std::int32_t, double) { return true; },
            [&](std::int32_t v, double d) { clear_[static_cast<std::size_t>(v)] = static_cast<float>(smooth(d / fades)); });
    for (std::size_t v = 0; v < vertices; ++v)
        if (surface_->row(static_cast<std::int32_t>(v)) < 0 || patches.first[v] == patches.first[v + 1]) clear_[v] = 0.0f;

    // Moments of the weights of patches over the surface, in which they are linear, from those of its corners.
    const auto count = static_cast<Eigen::Index>(patches.count());
    centres_ = Points::Zero(count, 3);
    spread_ = Eigen::VectorXd::Zero(count);
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(count);
    Eigen::VectorXd share = Eigen::VectorXd::Zero(body.vertices.rows());
    for (std::int32_t f = 0; f < body.triangles.rows(); ++f)
        for (int c = 0; c < 3 && surface_->touchable()[static_cast<std::size_t>(f)]; ++c)
            share[body.triangles(f, c)] += areaVector(body, f).norm() / 6.0;
    const auto each = [&](const auto& visit) {
        for (std::size_t v = 0; v < vertices; ++v)
            for (auto i = static_cast<std::size_t>(patches.first[v]); i < static_cast<std::size_t>(patches.first[v + 1]); ++i)
                visit(static_cast<Eigen::Index>(patches.patch[i]),
                      share[static_cast<Eigen::Index>(v)] * static_cast<double>(patches.weight[i]),
                      body.vertices.row(static_cast<Eigen::Index>(v)));
    };
    each([&](Eigen::Index p, double w, const auto& x) {
        whole[p] += w;
        centres_.row(p) += w * x;
    });
    for (Eigen::Index p = 0; p < count; ++p) {
        if (whole[p] > 0.0)
            centres_.row(p) /= whole[p];
        else
            centres_.row(p) = body.vertices.row(patches.centre[static_cast<std::size_t>(p)]);
    }
    each([&](Eigen::Index p, double w, const auto& x) {
        if (whole[p] > 0.0) spread_[p] += w / whole[p] * (x - centres_.row(p)).squaredNorm();
    });

    blocks_.assign(first.size() * kOfBlock, 0.0f);
    balls_.assign(first.size(), Eigen::Vector4f(0, 0, 0, -1));
    for (std::size_t b = 0; b < first.size(); ++b) {
        Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (int lane = 0; lane < kLanes; ++lane) {
            const std::int32_t v = first[b] + lane;
            if (v >= static_cast<std::int32_t>(vertices)) break;
            const Vec3 at = surface_->vertex(v), normal = surface_->normal(v);
            float* to = blocks_.data() + b * kOfBlock + lane;
            for (int axis = 0; axis < 3; ++axis) {
                to[axis * kLanes] = static_cast<float>(at[axis]);
                to[(3 + axis) * kLanes] = static_cast<float>(normal[axis]);
            }
            to[6 * kLanes] = clear_[static_cast<std::size_t>(v)];
            if (!(clear_[static_cast<std::size_t>(v)] > 0.0f)) continue;
            low = low.cwiseMin(at);
            high = high.cwiseMax(at);
        }
        if ((low.array() <= high.array()).all())
            balls_[b] << (0.5 * (low + high)).cast<float>(), static_cast<float>(0.5 * (high - low).norm());
    }
}

Dent DentSurface::at(const TouchSurface::Point& point, const Eigen::VectorXd& weights) const {
    Dent out;
    const auto corner = surface_->corners(point.triangle);
    for (std::size_t c = 0; c < 3; ++c) {
        out.centre += point.barycentric[static_cast<Eigen::Index>(c)] * surface_->vertex(corner[c]);
        out.normal += point.barycentric[static_cast<Eigen::Index>(c)] * surface_->normal(corner[c]);
    }
    out.normal.normalize();
    out.patchCentre = centres_.transpose() * weights;
    double spread = 0.0;
    for (Eigen::Index p = 0; p < weights.size(); ++p)
        if (weights[p] > 0.0) spread += weights[p] * (spread_[p] + (centres_.row(p).transpose() - out.patchCentre).squaredNorm());
    out.patchRadius = std::sqrt(spread / kSpread);
    return out;
}

double DentSurface::narrowest(const TouchSurface::Point& point) const {
    const auto corner = surface_->corners(point.triangle);
    double longest = 0.0;
    for (std::size_t c = 0; c < 3; ++c)
        longest = std::max(longest, (surface_->vertex(corner[c]) - surface_->vertex(corner[(c + 1) % 3])).norm());
    return longest;
}

double DentSurface::depth() const { return 3.0 / 8.0 * (1.0 - nu_); }

Eigen::Matrix3d DentSurface::compliance(const Dent& dent, std::int32_t vertex) const {
    const double clear = static_cast<double>(clear_[static_cast<std::size_t>(vertex)]);
    const Vec3 at = surface_->vertex(vertex), normal = surface_->normal(vertex);
    if (!(clear > 0.0) || (at - dent.centre).squaredNorm() >= kReach * kReach * dent.patchRadius * dent.patchRadius)
        return Eigen::Matrix3d::Zero();
    using One = Eigen::Array<double, 1, 1>;
    const auto one = [](const Vec3& v) { return Moved<One>{One(v.x()), One(v.y()), One(v.z())}; };
    Eigen::Matrix3d out;
    Dent unit = dent;
    for (int axis = 0; axis < 3; ++axis) {
        unit.force = Vec3::Unit(axis);
        const auto moved = displacement<One>(unit, nu_, one(at), one(normal), One(clear));
        out.col(axis) << moved.x, moved.y, moved.z;
    }
    return out;
}

void DentSurface::add(std::span<const Dent> dents, std::size_t begin, std::size_t end, float* local) const {
    using Lanes = Eigen::Array<float, kLanes, 1>;
    for (const Dent& dent : dents) {
        if (!dent.active()) continue;
        const Eigen::Vector3f centre = dent.centre.cast<float>();
        const auto reach = static_cast<float>(kReach * dent.patchRadius);
        for (std::size_t b = begin; b < end; ++b) {
            const Eigen::Vector4f& ball = balls_[b];
            const float within = reach + ball.w();
            if (ball.w() < 0.0f || (ball.head<3>() - centre).squaredNorm() >= within * within) continue;
            const float* from = blocks_.data() + b * kOfBlock;
            const auto lanes = [&](int row) -> Lanes { return Eigen::Map<const Lanes, Eigen::Aligned16>(from + row * kLanes); };
            const auto moved = displacement<Lanes>(dent, nu_, {lanes(0), lanes(1), lanes(2)}, {lanes(3), lanes(4), lanes(5)}, lanes(6));
            float* to = local + b * 3 * kLanes;
            Eigen::Map<Lanes, Eigen::Aligned16>(to) += moved.x;
            Eigen::Map<Lanes, Eigen::Aligned16>(to + kLanes) += moved.y;
            Eigen::Map<Lanes, Eigen::Aligned16>(to + 2 * kLanes) += moved.z;
        }
    }
}

std::size_t DentSurface::bytes() const {
    return sizeof(float) * (clear_.size() + blocks_.size()) + sizeof(double) * static_cast<std::size_t>(centres_.size() + spread_.size()) +
           sizeof(Eigen::Vector4f) * balls_.size();
}

}  // namespace imomushi
