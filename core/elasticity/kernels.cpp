// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/kernels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace imomushi {

/// Where x is nearer to the inside of an edge than this share of its distance from the far corner, it lies on it: coordinates are rounded.
constexpr double kOnEdge = 1e-14;

TriangleIntegrals triangleIntegrals(const Vec3& x, const std::array<Vec3, 3>& corners) {
    const std::array<Vec3, 3> r{corners[0] - x, corners[1] - x, corners[2] - x};
    const std::array<double, 3> R{r[0].norm(), r[1].norm(), r[2].norm()};
    const Vec3 areaNormal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double twiceArea = areaNormal.norm();
    const Vec3 n = areaNormal / twiceArea;
    const Eigen::Matrix3d P = Eigen::Matrix3d::Identity() - n * n.transpose();
    const auto nearest = static_cast<std::size_t>(std::min_element(R.begin(), R.end()) - R.begin());
    double w = -r[nearest].dot(n);  // signed height of x above the plane; exactly 0 on a corner
    const double farthest = *std::max_element(R.begin(), R.end());

    // Per edge, along its unit tangent e: integrals of 1/R, s/R and s^2/R, and where the edge lies in the plane.
    std::array<Vec3, 3> e, m;
    std::array<double, 3> length{}, t0{}, E0{}, E1{}, E2{}, J{};
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3;
        e[a] = corners[b] - corners[a];
        length[a] = e[a].norm();
        e[a] /= length[a];
        m[a] = e[a].cross(n);
        t0[a] = (R[a] < R[b] ? r[a] : r[b]).dot(m[a]);
        const double s0 = r[a].dot(e[a]), s1 = r[b].dot(e[a]);
        if (s0 < 0.0 && s1 > 0.0 && std::hypot(t0[a], w) <= kOnEdge * farthest) t0[a] = w = 0.0;
    }
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3;
        const double s0 = r[a].dot(e[a]), s1 = r[b].dot(e[a]);
        const double R02 = t0[a] * t0[a] + w * w;
        // f = asinh(s1/R0) - asinh(s0/R0); every product with f vanishes with R0.
        const double P0 = R[a] + std::abs(s0), P1 = R[b] + std::abs(s1);
        if (s0 < 0.0 && s1 > 0.0)
            E0[a] = R02 > 0.0 ? std::log(P1 * P0 / R02) : 0.0;
        else if (P0 > 0.0 && P1 > 0.0)
            E0[a] = s0 >= 0.0 ? std::log(P1 / P0) : std::log(P0 / P1);
        E1[a] = length[a] * (s0 + s1) / (R[a] + R[b]);  // R1 - R0 without cancellation
        J[a] = 0.5 * (s1 * R[b] - s0 * R[a] + R02 * E0[a]);
        E2[a] = 0.5 * (s1 * R[b] - s0 * R[a] - R02 * E0[a]);
    }

    TriangleIntegrals out;
    const double denominator = R[0] * R[1] * R[2] + r[0].dot(r[1]) * R[2] + r[0].dot(r[2]) * R[1] + r[1].dot(r[2]) * R[0];
    const double Om = w == 0.0 ? 0.0 : 2.0 * std::atan2(twiceArea * w, denominator);
    double I0 = -w * Om;
    Vec3 q = Vec3::Zero(), L = Vec3::Zero();  // int rho/R^3 and int rho/R, rho the in-plane part of r
    Eigen::Matrix3d edges = Eigen::Matrix3d::Zero();
    for (std::size_t a = 0; a < 3; ++a) {
        I0 += t0[a] * E0[a];
        q -= m[a] * E0[a];
        L += m[a] * J[a];
        edges += (t0[a] * E0[a] * m[a] + E1[a] * e[a]) * m[a].transpose();
    }
    Eigen::Matrix3d Q = I0 * P - edges;  // int rho rho^T / R^3
    Q = (0.5 * (Q + Q.transpose())).eval();
    out.solidAngle = Om;
    out.singleLayer = I0;
    out.kelvin = Q - w * (n * q.transpose() + q * n.transpose()) + w * Om * n * n.transpose();

    out.singleLayerGradient = L - w * I0 * n;

    std::array<Vec3, 3> gradient;
    std::array<double, 3> value{};  // of N_a at the projection of x
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t opposite = (a + 1) % 3;
        const double h = length[opposite] / twiceArea;
        const Vec3 g = gradient[a] = -h * m[opposite];
        const double atX = value[a] = h * t0[opposite];
        out.doubleLayer[static_cast<Eigen::Index>(a)] = atX * Om + w * g.dot(q);
        out.singleLayerLinear[static_cast<Eigen::Index>(a)] = atX * I0 + g.dot(L);
        // T = int (g.rho) rho rho^T / R^3, by parts over the edges.
        Eigen::Matrix3d T = L * g.transpose() + g.dot(L) * P;
        for (std::size_t b = 0; b < 3; ++b) {
            const double gm = g.dot(m[b]), ge = g.dot(e[b]);
            const Vec3 along = gm * t0[b] * t0[b] * E0[b] * m[b] + t0[b] * E1[b] * (gm * e[b] + ge * m[b]) + ge * E2[b] * e[b];
            T -= along * m[b].transpose();
        }
        T = (0.5 * (T + T.transpose())).eval();
        const Vec3 Qg = Q * g;
        out.kelvinLinear[a] =
            atX * out.kelvin + T - w * (n * Qg.transpose() + Qg * n.transpose()) + w * w * g.dot(q) * n * n.transpose();
    }
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3;
        out.doubleLayerBubble[static_cast<Eigen::Index>(a)] =
            4.0 * (value[a] * value[b] * Om + w * ((value[a] * gradient[b] + value[b] * gradient[a]).dot(q) + gradient[a].dot(Q * gradient[b])));
    }
    return out;
}

PairBlocks pairBlocks(const Vec3& x, const std::array<Vec3, 3>& corners, double nu) {
    const TriangleIntegrals in = triangleIntegrals(x, corners);
    const Vec3 areaNormal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const Vec3 n = areaNormal.normalized();
    const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
    const double pi = std::numbers::pi;
    const Eigen::Matrix3d M = ((1.0 - 2.0 * nu) * in.singleLayer * I + in.kelvin) / (8.0 * pi * (1.0 - nu));
    PairBlocks out;
    std::array<Eigen::Matrix3d, 3> linearM, curl;
    for (std::size_t a = 0; a < 3; ++a) {
        const Vec3 g = n.cross(corners[(a + 2) % 3] - corners[(a + 1) % 3]) / areaNormal.norm();
        const auto i = static_cast<Eigen::Index>(a);
        curl[a] = g * n.transpose() - n * g.transpose();
        linearM[a] = ((1.0 - 2.0 * nu) * in.singleLayerLinear[i] * I + in.kelvinLinear[a]) / (8.0 * pi * (1.0 - nu));
        out.h[a] = in.doubleLayer[i] / (4.0 * pi) * I + M * curl[a];
        out.g[a] = ((3.0 - 4.0 * nu) * in.singleLayerLinear[i] * I + in.kelvinLinear[a]) / (16.0 * pi * (1.0 - nu));
    }
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3;
        out.bubble[a] = in.doubleLayerBubble[static_cast<Eigen::Index>(a)] / (4.0 * pi) * I + 4.0 * (linearM[a] * curl[b] + linearM[b] * curl[a]);
    }
    return out;
}

LoadBlocks loadBlocks(const Vec3& x, const std::array<Vec3, 3>& corners, double nu) {
    const TriangleIntegrals in = triangleIntegrals(x, corners);
    const Vec3 n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    const Vec3& L = in.singleLayerGradient;
    const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
    LoadBlocks out;
    out.force = (n.dot(L) * I - n * L.transpose() / (2.0 * (1.0 - nu))) / (8.0 * std::numbers::pi);
    out.pressure = ((3.0 - 4.0 * nu) * in.singleLayer * I + in.kelvin) * n / (16.0 * std::numbers::pi * (1.0 - nu));
    return out;
}

TriangleBatch::TriangleBatch(const TriangleMesh& mesh, std::span<const std::int32_t> which, const Columns& columns) {
    layOut(mesh, which);
    const auto gather = [&](const std::vector<std::array<std::int32_t, 3>>& from, std::vector<std::int32_t>& to) {
        if (from.empty()) return;
        to.resize(3 * size_);
        for (std::size_t i = 0; i < size_; ++i)
            for (std::size_t c = 0; c < 3; ++c) to[c * size_ + i] = from[i < from.size() ? i : 0][c];
    };
    gather(columns.corner, corner_);
    gather(columns.bubble, bubble_);
    gather(columns.traction, traction_);
}

TriangleBatch::TriangleBatch(const TriangleMesh& mesh, std::span<const std::int32_t> which, std::span<const std::int32_t> corner,
                             std::span<const std::int32_t> traction) {
    layOut(mesh, which);
    const auto gather = [&](std::span<const std::int32_t> from, std::vector<std::int32_t>& to) {
        if (from.empty()) return;
        to.resize(3 * size_);
        for (std::size_t i = 0; i < size_; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                to[c * size_ + i] = from[static_cast<std::size_t>(mesh.triangles(which[i < which.size() ? i : 0], static_cast<Eigen::Index>(c)))];
    };
    gather(corner, corner_);
    gather(traction, traction_);
}

void TriangleBatch::layOut(const TriangleMesh& mesh, std::span<const std::int32_t> which) {
    size_ = (which.size() + kPad - 1) / kPad * kPad;
    data_.resize(size_ * kFields);
    const auto set = [this](int f, std::size_t i, double value) { data_[static_cast<std::size_t>(f) * size_ + i] = value; };
    for (std::size_t i = 0; i < size_; ++i) {
        const bool padding = i >= which.size();
        const std::int32_t triangle = which[padding ? 0 : i];
        std::array<Vec3, 3> p;
        for (int c = 0; c < 3; ++c) p[static_cast<std::size_t>(c)] = mesh.vertices.row(mesh.triangles(triangle, c)).transpose();
        const Vec3 areaNormal = (p[1] - p[0]).cross(p[2] - p[0]);
        const double twiceArea = areaNormal.norm();
        set(kTwiceArea, i, twiceArea);
        for (int c = 0; c < 3; ++c) {
            const Vec3 edge = p[static_cast<std::size_t>((c + 1) % 3)] - p[static_cast<std::size_t>(c)];
            const double length = edge.norm();
            set(kNormal + c, i, areaNormal[c] / twiceArea);
            set(kLength + c, i, length);
            set(kHeight + c, i, padding ? 0.0 : length / twiceArea);  // hat functions that vanish
            for (int k = 0; k < 3; ++k) {
                set(kCorner + 3 * c + k, i, p[static_cast<std::size_t>(c)][k]);
                set(kTangent + 3 * c + k, i, edge[k] / length);
            }
        }
    }
}

}  // namespace imomushi
