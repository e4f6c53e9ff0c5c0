// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/hard_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>

namespace imomushi {

Result<JointFace> makeFace(const TriangleMesh& mesh, const HardFace& face) {
    auto made = face.vertices.empty() ? jointFaceByPlane(mesh, face.origin, face.normal, 1e-4 * hard::sizeOf(mesh)) : jointFaceByVertices(mesh, face.vertices);
    if (made) made->name = face.name;
    return made;
}

Result<ResponseInput> responseInput(const HardElement& element) {
    ResponseInput input;
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = element.mesh;
    input.mesh = std::move(mesh);
    for (const HardFace& face : element.faces) {
        auto made = makeFace(element.mesh, face);
        if (!made) return tl::unexpected(made.error());
        input.faces.push_back(std::move(*made));
    }
    input.nu = element.nu;
    return input;
}

Eigen::VectorXd parametersOf(const SolvedElement& solved, const Eigen::Matrix3d& gradient, const Vec3& centre, const Vec3& shift) {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(solved.response.columns());
    for (std::size_t f = 0; f < solved.input.faces.size(); ++f) {
        const JointFace& face = solved.input.faces[f];
        JointMap map;
        map.linear += face.frame.axes.transpose() * gradient * face.frame.axes;
        map.shift = face.frame.axes.transpose() * (gradient * (face.frame.origin - centre) + shift);
        double lost = 0.0;
        solved.response.bases[f].coefficients(map, face.size, v.data() + solved.response.firstColumn[f], lost);
    }
    return v;
}

namespace hard {

double sizeOf(const TriangleMesh& mesh) { return (mesh.vertices.colwise().maxCoeff() - mesh.vertices.colwise().minCoeff()).norm(); }

Points freePoints(const SolvedElement& s) {
    Points out(static_cast<Eigen::Index>(s.response.freeVertices.size()), 3);
    for (Eigen::Index i = 0; i < out.rows(); ++i) out.row(i) = s.input.mesh->body.vertices.row(s.response.freeVertices[static_cast<std::size_t>(i)]);
    return out;
}

Points freeDisplacement(const SolvedElement& s, const Eigen::VectorXd& v) {
    const Eigen::VectorXd x = s.response.response * v;
    return Eigen::Map<const Points>(x.data(), x.size() / 3, 3);
}

namespace {

std::string timesCondition(double condition) {
    char text[80];
    std::snprintf(text, sizeof text, "rounding of 1e-14 times a condition number of %.0e", condition);
    return text;
}

Vec3 middleOf(const TriangleMesh& mesh) {
    return 0.5 * (mesh.vertices.colwise().minCoeff() + mesh.vertices.colwise().maxCoeff()).transpose();
}

/// Several cases are compared with the same plain body: it is solved once.
Result<std::shared_ptr<const ElementResponse>> responseOf(const ResponseInput& input) {
    static std::map<ContentKey, std::shared_ptr<const ElementResponse>> known;
    auto& response = known[responseKey(input)];
    if (!response) {
        auto built = buildResponse(input, {});
        if (!built) return tl::unexpected(built.error());
        response = std::make_shared<const ElementResponse>(std::move(*built));
    }
    return response;
}

/// Largest miss of the linear field u = gradient (x - middle) + shift at the free vertices, over the largest |u| of the body.
double linearError(const SolvedElement& s, const Eigen::Matrix3d& gradient, const Vec3& shift) {
    const Vec3 middle = middleOf(s.input.mesh->body);
    const auto field = [&](const Points& p) -> Points {
        return ((p.rowwise() - middle.transpose()) * gradient.transpose()).rowwise() + shift.transpose();
    };
    const Points miss = freeDisplacement(s, parametersOf(s, gradient, middle, shift)) - field(freePoints(s));
    return miss.rowwise().norm().maxCoeff() / field(s.input.mesh->body.vertices).rowwise().norm().maxCoeff();
}

}  // namespace

HardCheck rigid(double condition) {
    return {"rigid motions", kAssemblyRounding * condition, "they are linear, so exact but for " + timesCondition(condition),
            [](const SolvedElement& s) -> Result<double> {
                double worst = 0.0;
                for (int axis = 0; axis < 3; ++axis) {
                    worst = std::max(worst, linearError(s, Eigen::Matrix3d::Zero(), sizeOf(s.input.mesh->body) * Vec3::Unit(axis)));
                    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
                    turn((axis + 2) % 3, (axis + 1) % 3) = 1.0;
                    turn((axis + 1) % 3, (axis + 2) % 3) = -1.0;
                    worst = std::max(worst, linearError(s, turn, Vec3::Zero()));
                }
                return worst;
            }};
}

HardCheck stretch(double condition) {
    return {"uniaxial stretch", kAssemblyRounding * condition,
            "linear displacement and constant traction are in the trial spaces, so exact but for " + timesCondition(condition),
            [](const SolvedElement& s) -> Result<double> {
                return linearError(s, Vec3(-s.input.nu, -s.input.nu, 1.0).asDiagonal(), Vec3::Zero());
            }};
}

HardCheck sameAs(std::string what, HardElement other, double bound, std::string why, double scale, const Vec3& shift) {
    const auto error = [other = std::move(other), scale, shift](const SolvedElement& s) -> Result<double> {
        ResponseInput input = s.input;
        auto theirs = responseInput(other);
        if (!theirs) return tl::unexpected(theirs.error());
        input.mesh = theirs->mesh;
        input.faces = theirs->faces;
        input.nu = theirs->nu;
        const auto solved = responseOf(input);
        if (!solved) return tl::unexpected(solved.error());
        const SolvedElement o{input, **solved};
        const Points mine = freePoints(s), others = freePoints(o);
        std::vector<std::pair<Eigen::Index, Eigen::Index>> common;
        const double near = 1e-6 * sizeOf(other.mesh);
        for (Eigen::Index i = 0; i < mine.rows(); ++i) {
            const Eigen::RowVector3d p = (mine.row(i) - shift.transpose()) / scale;
            Eigen::Index k = 0;
            if ((others.rowwise() - p).rowwise().squaredNorm().minCoeff(&k) < near * near) common.emplace_back(i, k);
        }
        if (2 * static_cast<Eigen::Index>(common.size()) < std::min(mine.rows(), others.rows()))
            return fail("not-comparable", "The two bodies have too few vertices in common.");
        const auto motion = [](const SolvedElement& of, int which, double unit) {
            JointMap map;
            const double size = of.input.faces.back().size;
            if (which == 0) map.shift.z() = unit;
            if (which == 1) map.shift.x() = unit;
            if (which == 2) map.linear(2, 0) = unit / size, map.linear(0, 2) = -unit / size;
            if (which == 3) map.linear(0, 1) = -unit / size, map.linear(1, 0) = unit / size;
            Eigen::VectorXd v = Eigen::VectorXd::Zero(of.response.columns());
            double lost = 0.0;
            of.response.bases.back().coefficients(map, size, v.data() + of.response.firstColumn[of.response.bases.size() - 1], lost);
            return freeDisplacement(of, v);
        };
        double worst = 0.0;
        for (int which = 0; which < 4; ++which) {
            const Points a = motion(s, which, scale), b = motion(o, which, 1.0);
            double difference = 0.0, norm = 0.0;
            for (const auto& [i, k] : common) {
                difference += (a.row(i) / scale - b.row(k)).squaredNorm();
                norm += b.row(k).squaredNorm();
            }
            worst = std::max(worst, std::sqrt(difference / norm));
        }
        return worst;
    };
    return {std::move(what), bound, std::move(why), error};
}

HardCheck byDefault(HardCheck check, double bound, std::string why) {
    check.boundByDefault = bound;
    check.whyByDefault = std::move(why);
    return check;
}

}  // namespace hard
}  // namespace imomushi
