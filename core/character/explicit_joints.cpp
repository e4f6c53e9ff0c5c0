// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/explicit_joints.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mesh/topology.h"

namespace imomushi {

using Eigen::Matrix3d;

namespace {

constexpr double kStill = 1e-7;  // sizes per second: slower vertices rest
constexpr double kLeastArea = 1e-3;  // of the mean: a vertex without a triangle of its own still has a mass

}  // namespace

Result<ExplicitJoints> ExplicitJoints::build(const CharacterInput& input, const Settings& settings) {
    std::vector<Element> elements(input.elements.size());
    std::vector<double> depth(input.elements.size(), 0.0);  // m, of the flesh that a face vertex carries: volume over surface
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const auto& given = input.elements[e];
        if (given.faces.empty()) continue;
        if (!given.response || given.response->tractions.size() == 0)
            return fail("bad-value", "The previous model needs a precompute in the basis \"full\" of every element with joint faces.");
        elements[e].tractions = given.response->tractions;
        elements[e].stiffness = given.stiffness;
        elements[e].wanted = elements[e].v = elements[e].traction = Eigen::VectorXd::Zero(given.response->columns());
        const auto& body = given.mesh->body;
        depth[e] = std::abs(enclosedVolume(body.vertices, body.triangles)) / std::max(surfaceArea(body), 1e-300);
        low = low.cwiseMin(body.vertices.colwise().minCoeff().transpose());
        high = high.cwiseMax(body.vertices.colwise().maxCoeff().transpose());
        for (const auto& face : given.faces) {
            elements[e].first.push_back(elements[e].held.size());
            std::vector<double> area(static_cast<std::size_t>(body.vertices.rows()), 0.0);
            for (const auto t : face.triangles) {
                const Vec3 a = body.vertices.row(body.triangles(t, 0)).transpose(), b = body.vertices.row(body.triangles(t, 1)).transpose(),
                           c = body.vertices.row(body.triangles(t, 2)).transpose();
                for (int k = 0; k < 3; ++k) area[static_cast<std::size_t>(body.triangles(t, k))] += (b - a).cross(c - a).norm() / 6.0;
            }
            const double least = kLeastArea * face.area / static_cast<double>(face.vertices.size());
            for (const auto v : face.vertices) elements[e].held.push_back({0, 0, std::max(area[static_cast<std::size_t>(v)], least), face.frame.axes});
        }
    }

    // Nodes are the vertices of the first face of each joint.
    std::vector<Vec3> rest;
    std::vector<double> mass;
    std::vector<int> firstNode;
    for (std::size_t j = 0; j < input.joints.size(); ++j) {
        const auto& joint = input.joints[j];
        firstNode.push_back(static_cast<int>(rest.size()));
        const auto position = [&](const CharacterInput::Joint::Face& f, std::size_t i) -> Vec3 {
            const auto& element = input.elements[static_cast<std::size_t>(f.element)];
            return element.mesh->body.vertices.row(element.faces[static_cast<std::size_t>(f.face)].vertices[i]).transpose();
        };
        for (const auto& f : joint.faces) {
            const auto& given = input.elements[static_cast<std::size_t>(f.element)];
            auto& element = elements[static_cast<std::size_t>(f.element)];
            const auto& face = given.faces[static_cast<std::size_t>(f.face)];
            for (std::size_t i = 0; i < face.vertices.size(); ++i) {
                auto& vertex = element.held[element.first[static_cast<std::size_t>(f.face)] + i];
                const Vec3 p = position(f, i);
                vertex.joint = static_cast<int>(j);
                if (&f == joint.faces.data()) {
                    vertex.node = static_cast<int>(rest.size());
                    rest.push_back(p);
                    mass.push_back(0.0);
                } else {
                    double nearest = std::numeric_limits<double>::max();
                    for (int n = firstNode[j]; n < static_cast<int>(rest.size()); ++n)
                        if (const double d = (rest[static_cast<std::size_t>(n)] - p).squaredNorm(); d < nearest) nearest = d, vertex.node = n;
                }
                mass[static_cast<std::size_t>(vertex.node)] += given.density * vertex.area * depth[static_cast<std::size_t>(f.element)];
            }
        }
    }
    firstNode.push_back(static_cast<int>(rest.size()));
    if (rest.empty()) return fail("bad-value", "The previous model needs a joint face.");

    ExplicitJointDynamics::Input made;
    const Eigen::Index dofs = 3 * static_cast<Eigen::Index>(rest.size());
    made.mass.resize(dofs);
    for (std::size_t n = 0; n < rest.size(); ++n) made.mass.segment<3>(3 * static_cast<Eigen::Index>(n)).setConstant(mass[n]);
    made.damping = settings.damping;
    made.seconds = settings.step;
    made.size = std::max((high - low).norm(), 1e-12);
    made.held = Eigen::MatrixXd::Zero(dofs, 6 * static_cast<Eigen::Index>(input.joints.size()));
    for (std::size_t j = 0; j < input.joints.size(); ++j) {
        Vec3 middle = Vec3::Zero();
        for (int n = firstNode[j]; n < firstNode[j + 1]; ++n) middle += rest[static_cast<std::size_t>(n)] / static_cast<double>(firstNode[j + 1] - firstNode[j]);
        for (int n = firstNode[j]; n < firstNode[j + 1]; ++n)
            for (int k = 0; k < 3; ++k) {
                const auto column = 6 * static_cast<Eigen::Index>(j) + k;
                made.held.block<3, 1>(3 * n, column) = Vec3::Unit(k);
                made.held.block<3, 1>(3 * n, column + 3) = Vec3::Unit(k).cross(rest[static_cast<std::size_t>(n)] - middle);
            }
    }
    auto dynamics = ExplicitJointDynamics::build(made);
    if (!dynamics) return tl::unexpected(dynamics.error());
    ExplicitJoints out(std::move(*dynamics));
    out.input_ = std::move(made);
    out.shearModulus_ = settings.shearModulus;
    out.rotation_.assign(input.joints.size(), Matrix3d::Identity());
    out.elements_ = std::move(elements);
    return out;
}

Result<void> ExplicitJoints::set(const Settings& settings) {
    auto changed = input_;
    changed.damping = settings.damping;
    changed.seconds = settings.step;
    auto dynamics = ExplicitJointDynamics::build(changed);
    if (!dynamics) return tl::unexpected(dynamics.error());
    input_ = std::move(changed);
    dynamics_ = std::move(*dynamics);
    shearModulus_ = settings.shearModulus;
    return {};
}

void ExplicitJoints::reset() { dynamics_.reset(Eigen::VectorXd::Zero(input_.mass.size())); }

void ExplicitJoints::setElement(int element, const Matrix3d& rotation, const Eigen::VectorXd& v) {
    auto& e = elements_[static_cast<std::size_t>(element)];
    if (e.held.empty()) return;
    e.rotation = rotation;
    e.wanted = v;
}

bool ExplicitJoints::step(double seconds) {
    return dynamics_.step(seconds, [this](const Eigen::VectorXd& displacement, Eigen::VectorXd& force) { pull(displacement, force); });
}

void ExplicitJoints::place(const Element& e, const std::vector<Matrix3d>& rotation, const Eigen::VectorXd& displacement, Eigen::VectorXd& v) {
    for (std::size_t i = 0; i < e.held.size(); ++i) {
        const auto& h = e.held[i];
        const Vec3 world = rotation[static_cast<std::size_t>(h.joint)] * displacement.segment<3>(3 * static_cast<Eigen::Index>(h.node));
        v.segment<3>(3 * static_cast<Eigen::Index>(i)) += h.axes.transpose() * (e.rotation.transpose() * world);
    }
}

void ExplicitJoints::pull(const Eigen::VectorXd& displacement, Eigen::VectorXd& force) {
    force.setZero();
    for (auto& e : elements_) {
        if (e.held.empty()) continue;
        e.v = e.wanted;
        place(e, rotation_, displacement, e.v);
        e.traction.noalias() = e.tractions * e.v;
        for (std::size_t i = 0; i < e.held.size(); ++i) {
            const auto& h = e.held[i];
            const Vec3 pulled = e.traction.segment<3>(3 * static_cast<Eigen::Index>(i));
            force.segment<3>(3 * static_cast<Eigen::Index>(h.node)) -=
                shearModulus_ * e.stiffness * h.area * (rotation_[static_cast<std::size_t>(h.joint)].transpose() * (e.rotation * pulled));
        }
    }
}

void ExplicitJoints::addTo(int element, Eigen::VectorXd& v) const {
    const auto& e = elements_[static_cast<std::size_t>(element)];
    if (!e.held.empty()) place(e, rotation_, dynamics_.displacement(), v);
}

int ExplicitJoints::nodeOf(int element, int face, std::size_t i) const {
    const auto& e = elements_[static_cast<std::size_t>(element)];
    return e.held[e.first[static_cast<std::size_t>(face)] + i].node;
}

bool ExplicitJoints::resting() const { return dynamics_.velocity().cwiseAbs().maxCoeff() <= kStill * input_.size; }

}  // namespace imomushi
