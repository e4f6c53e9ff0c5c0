// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/character/caterpillar.h"

namespace imomushi {

/// The response of an elastic tube of radius 1 between two joint faces, solved coarsely in the basis "paper", as harmonics of the angle about its
/// axis: faces move the rings by harmonics up to the second, so a tube of any fineness can be given this response.
class ElasticTube {
public:
    ElasticTube() {
        const auto body = shapes::cylinder(1.0, kLength, kAround, kRows);
        ResponseInput in;
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body = body.mesh;
        in.mesh = mesh;
        in.faces = {caterpillar::faceOf(body.mesh, body.ends[0], "low"), caterpillar::faceOf(body.mesh, body.ends[1], "high")};
        in.basis = BasisKind::Paper;
        in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
        const auto response = buildResponse(in, {}).value();
        faces_ = in.faces;
        bases_ = response.bases;
        // Coefficients of 1, cos, sin, cos 2, sin 2, cos 3, sin 3 on every ring between the faces.
        rings_.assign(kRows + 1, Eigen::MatrixXd::Zero(3 * kHarmonics, response.columns()));
        for (std::size_t i = 0; i < response.freeVertices.size(); ++i) {
            const Vec3 p = body.mesh.vertices.row(response.freeVertices[i]).transpose();
            auto& ring = rings_[static_cast<std::size_t>(std::lround(p.z() / kLength * kRows))];
            for (int h = 0; h < kHarmonics; ++h)
                ring.middleRows(3 * h, 3) += harmonic(h, std::atan2(p.y(), p.x())) * (h == 0 ? 1.0 : 2.0) / kAround * response.response.middleRows(3 * static_cast<Eigen::Index>(i), 3);
        }
        for (int k = 0; k < kAround; ++k)
            for (int f = 0; f < 2; ++f) {
                const double angle = 2.0 * std::numbers::pi * k / kAround;
                const Eigen::MatrixXd u = onFace(f, Vec3(std::cos(angle), std::sin(angle), 0));
                for (int h = 0; h < kHarmonics; ++h) rings_[f == 0 ? 0 : kRows].middleRows(3 * h, 3) += harmonic(h, angle) * (h == 0 ? 1.0 : 2.0) / kAround * u;
            }
    }

    static constexpr double kLength = 6.3;
    [[nodiscard]] Eigen::Index columns() const { return rings_[0].cols(); }
    /// 3 x columns at a point of the surface whose z is `part` of the length; cubic between the rings.
    [[nodiscard]] Eigen::MatrixXd at(const Vec3& p, double part) const {
        if (p.head<2>().norm() < 0.5) return onFace(part < 0.5 ? 0 : 1, Vec3::Zero());
        const int k = std::clamp(static_cast<int>(part * kRows) - 1, 0, kRows - 3);
        Eigen::MatrixXd ring = Eigen::MatrixXd::Zero(3 * kHarmonics, columns()), out = Eigen::MatrixXd::Zero(3, columns());
        for (int i = 0; i < 4; ++i) {
            double weight = 1.0;
            for (int j = 0; j < 4; ++j)
                if (j != i) weight *= (part * kRows - k - j) / (i - j);
            ring += weight * rings_[k + i];
        }
        for (int h = 0; h < kHarmonics; ++h) out += harmonic(h, std::atan2(p.y(), p.x())) * ring.middleRows(3 * h, 3);
        return out;
    }
    /// Both ends turned by half of `angle` about x in opposite directions (a bend) and moved apart by `stretch` of the length.
    [[nodiscard]] Eigen::VectorXd pose(double angle, double stretch) const {
        Eigen::VectorXd v(columns());
        for (int f = 0; f < 2; ++f) {
            const double side = f == 0 ? -1.0 : 1.0;
            const auto& axes = faces_[f].frame.axes;
            Eigen::Matrix3d linear = Eigen::AngleAxisd(side * angle / 2, Vec3::UnitX()).toRotationMatrix();
            linear.leftCols(2) *= 1.0 - 0.4 * stretch;
            JointMap map;
            map.linear = axes.transpose() * linear * axes;
            map.shift = axes.transpose() * Vec3(0, 0, side * stretch * kLength / 2);
            double lost = 0.0;
            bases_[f].coefficients(map, 1.0, v.data() + f * bases_[0].columns(), lost);
        }
        return v;
    }

private:
    static constexpr int kAround = 20, kRows = 20, kHarmonics = 7;
    static double harmonic(int h, double angle) { return h == 0 ? 1.0 : h % 2 ? std::cos((h + 1) / 2 * angle) : std::sin(h / 2 * angle); }
    [[nodiscard]] Eigen::MatrixXd onFace(int f, Vec3 p) const {
        p.z() = f == 0 ? 0.0 : kLength;
        const auto& frame = faces_[f].frame;
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3, 2 * bases_[0].columns());
        out.middleCols(f * bases_[0].columns(), bases_[0].columns()) = frame.axes * bases_[f].at(frame.toLocal(p));
        return out;
    }
    std::vector<JointFace> faces_;
    std::vector<FaceBasis> bases_;
    std::vector<Eigen::MatrixXd> rings_;
};

inline const ElasticTube& elasticTube() {
    static const ElasticTube tube;
    return tube;
}

/// A closed tube about z, radius 1, with a vertex in the middle of each end, and its response.
struct Tube {
    double length = ElasticTube::kLength;
    TriangleMesh mesh;
    std::vector<std::int32_t> all;
    Eigen::MatrixXd response;  // of all vertices

    Tube(int around, int rings) {
        mesh.vertices.resize(around * rings + 2, 3);
        mesh.triangles.resize(2 * around * rings, 3);
        Eigen::Index v = 0, t = 0;
        mesh.vertices.row(v++) << 0, 0, 0;
        for (int k = 0; k < rings; ++k)
            for (int i = 0; i < around; ++i) {
                const double a = 2.0 * std::numbers::pi * (i + 0.5 * (k % 2)) / around;
                mesh.vertices.row(v++) << std::cos(a), std::sin(a), length * k / (rings - 1);
            }
        mesh.vertices.row(v++) << 0, 0, length;
        const auto at = [&](int k, int i) { return 1 + k * around + i % around; };
        for (int i = 0; i < around; ++i) {
            mesh.triangles.row(t++) << 0, at(0, i + 1), at(0, i);
            mesh.triangles.row(t++) << static_cast<int>(v) - 1, at(rings - 1, i), at(rings - 1, i + 1);
        }
        for (int k = 0; k + 1 < rings; ++k)
            for (int i = 0; i < around; ++i) {
                // Every other ring is turned by half a cell, so all triangles are alike.
                const int left = at(k + 1, i + k % 2), right = at(k + 1, i + 1 + k % 2);
                mesh.triangles.row(t++) << at(k, i), at(k, i + 1), left;
                mesh.triangles.row(t++) << at(k, i + 1), right, left;
            }
        for (int i = 0; i < v; ++i) all.push_back(i);
        const auto& elastic = elasticTube();
        response.resize(3 * v, elastic.columns());
        for (Eigen::Index i = 0; i < v; ++i) {
            const Vec3 p = mesh.vertices.row(i).transpose();
            response.middleRows(3 * i, 3) = elastic.at(p, p.z() / length);
        }
    }

    [[nodiscard]] Eigen::VectorXd pose(double angle, double stretch) const { return elasticTube().pose(angle, stretch); }
    [[nodiscard]] std::vector<std::int32_t> corners() const { return {mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size()}; }
    [[nodiscard]] Points moved(const Eigen::VectorXd& v) const {
        const Eigen::VectorXd x = response * v;
        return mesh.vertices + Eigen::Map<const Points>(x.data(), mesh.vertices.rows(), 3);
    }
};

}  // namespace imomushi
