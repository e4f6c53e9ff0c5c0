// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/kernels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace imomushi {

TriangleIntegrals triangleIntegrals(const Vec3& x, const std::array<Vec3, 3>& corners) {
    const std::array<Vec3, 3> r{corners[0] - x, corners[1] - x, corners[2] - x};
    const std::array<double, 3> R{r[0].norm(), r[1].norm(), r[2].norm()};
    const Vec3 areaNormal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double twiceArea = areaNormal.norm();
    const Vec3 n = areaNormal / twiceArea;
    const Eigen::Matrix3d P = Eigen::Matrix3d::Identity() - n * n.transpose();
    const auto nearest = static_cast<std::size_t>(std::min_element(R.begin(), R.end()) - R.begin());
    const double w = -r[nearest].dot(n);  // signed height of x above the plane; exactly 0 on a corner

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

    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t opposite = (a + 1) % 3;
        const double h = length[opposite] / twiceArea;
        const Vec3 g = -h * m[opposite];
        const double atX = h * t0[opposite];  // N_a at the projection of x
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
    for (std::size_t a = 0; a < 3; ++a) {
        const Vec3 g = n.cross(corners[(a + 2) % 3] - corners[(a + 1) % 3]) / areaNormal.norm();
        const auto i = static_cast<Eigen::Index>(a);
        out.h[a] = in.doubleLayer[i] / (4.0 * pi) * I + M * (g * n.transpose() - n * g.transpose());
        out.g[a] = ((3.0 - 4.0 * nu) * in.singleLayerLinear[i] * I + in.kelvinLinear[a]) / (16.0 * pi * (1.0 - nu));
    }
    return out;
}

TriangleBatch::TriangleBatch(const TriangleMesh& mesh, std::span<const std::int32_t> which, std::span<const std::int32_t> blockColumn,
                             std::span<const std::int32_t> displacementColumn)
    : size_((which.size() + kPad - 1) / kPad * kPad) {
    data_.resize(size_ * kFields);
    column_.resize(3 * size_);
    if (!displacementColumn.empty()) displacementColumn_.resize(3 * size_);
    const auto set = [this](int f, std::size_t i, double value) { data_[static_cast<std::size_t>(f) * size_ + i] = value; };
    for (std::size_t i = 0; i < size_; ++i) {
        const bool padding = i >= which.size();
        const std::int32_t triangle = which[padding ? 0 : i];
        std::array<Vec3, 3> p;
        for (int c = 0; c < 3; ++c) {
            const std::int32_t v = mesh.triangles(triangle, c);
            p[static_cast<std::size_t>(c)] = mesh.vertices.row(v).transpose();
            column_[static_cast<std::size_t>(c) * size_ + i] = blockColumn[static_cast<std::size_t>(v)];
            if (!displacementColumn.empty())
                displacementColumn_[static_cast<std::size_t>(c) * size_ + i] = displacementColumn[static_cast<std::size_t>(v)];
        }
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
