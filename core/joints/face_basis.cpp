// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/joints/face_basis.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>

namespace imomushi {

JointMap jointMap(const PaperParameters& p) {
    const double c1 = std::cos(p.theta1), s1 = std::sin(p.theta1);
    const double c2 = std::cos(p.theta2), s2 = std::sin(p.theta2);
    JointMap map;
    // The six parameters of eq. (5) after the angles and stretches went in: in-plane stretch (symmetric), slopes, shift.
    const double xx = p.a * c1 * c1 * c2 + p.b * s1 * s1;
    const double xy = p.a * s1 * c1 * c2 - p.b * s1 * c1;
    const double yy = p.a * s1 * s1 * c2 + p.b * c1 * c1;
    map.linear.col(0) = Vec3(xx, xy, p.a * c1 * s2);
    map.linear.col(1) = Vec3(xy, yy, p.a * s1 * s2);
    map.linear.col(2) = Vec3(-c1 * s2, -s1 * s2, c2);
    map.shift = Vec3(0.0, 0.0, p.dz);
    return map;
}

FaceBasis FaceBasis::on(const TriangleMesh& body, const JointFace& face, const BasisChoice& choice) {
    if (choice.kind == BasisKind::Full) return {choice.kind, true, static_cast<int>(face.vertices.size()), 0, {}};
    return {choice.kind, face.flat(), 0, choice.modes, Warping(body, face, warpShapes(choice.modes))};
}

Eigen::Matrix<double, 3, Eigen::Dynamic> FaceBasis::at(const Vec3& p) const {
    assert(kind != BasisKind::Full);
    Eigen::Matrix<double, 3, Eigen::Dynamic> u = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, columns());
    const double x = p.x(), y = p.y(), z = p.z();
    u(0, 0) = x;
    u(0, 1) = y, u(1, 1) = x;
    u(1, 2) = y;
    u(2, 3) = x;
    u(2, 4) = y;
    u(2, 5) = 1.0;
    int next = 6;
    if (kind != BasisKind::Paper) {
        u(0, 6) = 1.0;
        u(1, 7) = 1.0;
        u(0, 8) = -y, u(1, 8) = x;
        next = 9;
    }
    if (!flat)
        for (int axis = 0; axis < 3; ++axis) u(axis, next + axis) = z;
    if (modes > 0) {
        std::array<double, Warping::kMax> shape;
        warping.at(x, y, shape.data());
        for (int i = 0; i < modes; ++i)
            for (const WarpTerm& term : warpColumn(i)) u(term.axis, plainColumns() + i) = term.share * shape[static_cast<std::size_t>(term.shape)];
    }
    return u;
}

Eigen::Matrix<double, 3, Eigen::Dynamic> FaceBasis::at(const Vec3& p, int i) const {
    if (kind != BasisKind::Full) return at(p);
    Eigen::Matrix<double, 3, Eigen::Dynamic> u = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, columns());
    u.middleCols<3>(3 * i).setIdentity();
    return u;
}

void FaceBasis::coefficients(const JointMap& map, const Points& rest, double size, double* v, double& lost) const {
    if (kind != BasisKind::Full) return coefficients(map, size, v, lost);
    lost = 0.0;
    for (Eigen::Index i = 0; i < rest.rows(); ++i) {
        const Vec3 p = rest.row(i).transpose();
        Eigen::Map<Vec3>(v + 3 * i) = map.linear * p + map.shift - p;
    }
}

void FaceBasis::coefficients(const JointMap& map, double size, double* v, double& lost) const {
    assert(kind != BasisKind::Full);
    Eigen::Matrix3d l = map.linear;
    lost = 0.0;
    if (kind == BasisKind::Paper) {
        // Without the twist that eq. (5) cannot say, the in-plane part is symmetric (its polar factor), so the plane, its tilt and its
        // stretch stay what they were.
        const double twist = std::atan2(l(1, 0) - l(0, 1), l(0, 0) + l(1, 1));
        const double c = std::cos(twist), s = std::sin(twist);
        const Vec3 x = c * l.col(0) - s * l.col(1);
        const Vec3 y = s * l.col(0) + c * l.col(1);
        l.col(0) = x, l.col(1) = y;
        lost = std::max(std::abs(twist), size > 0.0 ? map.shift.head<2>().norm() / size : 0.0);
    }
    v[0] = l(0, 0) - 1.0;
    v[1] = 0.5 * (l(0, 1) + l(1, 0));
    v[2] = l(1, 1) - 1.0;
    v[3] = l(2, 0);
    v[4] = l(2, 1);
    v[5] = map.shift.z();
    int next = 6;
    if (kind != BasisKind::Paper) {
        v[6] = map.shift.x();
        v[7] = map.shift.y();
        v[8] = 0.5 * (l(1, 0) - l(0, 1));
        next = 9;
    }
    if (!flat) {
        v[next] = l(0, 2);
        v[next + 1] = l(1, 2);
        v[next + 2] = l(2, 2) - 1.0;
    }
    std::fill_n(v + plainColumns(), modes, 0.0);
}

Points localVertices(const TriangleMesh& body, const JointFace& face) {
    Points out(static_cast<Eigen::Index>(face.vertices.size()), 3);
    for (std::size_t i = 0; i < face.vertices.size(); ++i)
        out.row(static_cast<Eigen::Index>(i)) = face.frame.toLocal(body.vertices.row(face.vertices[i]).transpose()).transpose();
    return out;
}

Result<BasisChoice> parseBasis(const std::string& name) {
    if (name == "paper") return BasisKind::Paper;
    if (name == "affine") return BasisKind::Affine;
    if (name == "full") return BasisKind::Full;
    const std::string most = std::to_string(BasisChoice::kMaxModes);
    if (name.starts_with("modes:")) {
        BasisChoice choice(BasisKind::Modes);
        const char* end = name.data() + name.size();
        const auto read = std::from_chars(name.data() + 6, end, choice.modes);
        if (read.ec == std::errc() && read.ptr == end && choice.modes >= 1 && choice.modes <= BasisChoice::kMaxModes) return choice;
        return fail("bad-value", "The basis \"" + name + "\" has no count of modes between 1 and " + most + ": write \"modes:12\".");
    }
    return fail("bad-value", "There is no basis \"" + name + "\"; choose \"paper\", \"affine\", \"modes:1\" to \"modes:" + most + "\", or \"full\".");
}

std::string basisName(const BasisChoice& choice) {
    switch (choice.kind) {
        case BasisKind::Paper: return "paper";
        case BasisKind::Affine: return "affine";
        case BasisKind::Modes: return "modes:" + std::to_string(choice.modes);
        case BasisKind::Full: break;
    }
    return "full";
}

}  // namespace imomushi
