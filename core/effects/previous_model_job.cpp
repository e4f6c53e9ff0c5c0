// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/previous_model_job.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/character/frame.h"
#include "core/character/frame_job.h"
#include "core/dynamics/explicit_joint_dynamics.h"
#include "core/mesh/topology.h"

namespace imomushi {

using Eigen::Matrix3d;

namespace {

constexpr double kLeastArea = 1e-3;  // of a vertex, of the mean
constexpr double kStill = 1e-7;  // sizes per second: slower vertices rest

class PreviousModelJob final : public EffectJob<PreviousModelEffect> {
public:
    /// Errors: "bad-value": an element with joint faces has no response of basis "full"; numbers out of range.
    static Result<PreviousModelJob> build(const CharacterInput& input, const PreviousModelEffect& settings);

    void run(Stage stage, Frame& frame) override;
    [[nodiscard]] bool resting(const Frame&) const override { return dynamics_.velocity().cwiseAbs().maxCoeff() <= kStill * input_.size; }

    /// Tells held vertices their nodes.
    void number(Frame& frame) const;

private:
    struct Vertex {
        int node = 0, joint = 0;
        double area = 0.0;                     // m^2
        Matrix3d axes = Matrix3d::Identity();  // of its face
    };
    struct Element {
        std::vector<Vertex> held;        // in the order of columns
        std::vector<std::size_t> first;  // of each face in `held`
        Eigen::MatrixXf tractions;       // see ElementResponse; shear modulus 1
        double stiffness = 1.0;
        Matrix3d rotation = Matrix3d::Identity();  // of its frame, rest to world
        Eigen::VectorXd wanted, v;                 // wanted: v as its bones have it
        Eigen::VectorXf moved, traction;           // moved: v
    };
    PreviousModelJob(ExplicitJointDynamics dynamics, const PreviousModelEffect& settings)
        : EffectJob(settings, {{Stage::FaceOffsets, FrameData::Joints | FrameData::Elements | FrameData::Parameters, FrameData::Parameters | FrameData::FaceOffsets}}), dynamics_(std::move(dynamics)) {}
    /// It stops where numbers change.
    bool take(const PreviousModelEffect& asked) override;
    void pull(const Eigen::VectorXd& displacement, Eigen::VectorXd& force);
    static void place(const Element& element, const std::vector<Matrix3d>& rotation, const Eigen::VectorXd& displacement, Eigen::VectorXd& v);

    ExplicitJointDynamics::Input input_;
    ExplicitJointDynamics dynamics_;
    std::vector<Matrix3d> rotation_;  // per joint, rest to world
    std::vector<Element> elements_;
};

Result<PreviousModelJob> PreviousModelJob::build(const CharacterInput& input, const PreviousModelEffect& settings) {
    std::vector<Element> elements(input.elements.size());
    std::vector<double> depth(input.elements.size(), 0.0);  // m, of the flesh that a face vertex carries: volume over surface
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const auto& given = input.elements[e];
        if (given.faces.empty()) continue;
        if (!given.response || given.response->tractions.size() == 0)
            return fail("bad-value", "The previous model needs a precompute in the basis \"full\" of every element with joint faces.");
        elements[e].tractions = given.response->tractions.cast<float>();
        elements[e].stiffness = given.stiffness;
        elements[e].wanted = elements[e].v = Eigen::VectorXd::Zero(given.response->columns());
        elements[e].moved = elements[e].traction = Eigen::VectorXf::Zero(given.response->columns());
        const auto& body = given.mesh->body;
        depth[e] = std::abs(enclosedVolume(body.vertices, body.triangles)) / std::max(surfaceArea(body), 1e-300);
        low = low.cwiseMin(body.vertices.colwise().minCoeff().transpose());
        high = high.cwiseMax(body.vertices.colwise().maxCoeff().transpose());
        for (const auto& face : given.faces) {
            elements[e].first.push_back(elements[e].held.size());
            for (const double a : vertexAreas(body, face)) elements[e].held.push_back({0, 0, a, face.frame.axes});
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
    PreviousModelJob out(std::move(*dynamics), settings);
    out.input_ = std::move(made);
    out.rotation_.assign(input.joints.size(), Matrix3d::Identity());
    out.elements_ = std::move(elements);
    return out;
}

bool PreviousModelJob::take(const PreviousModelEffect& asked) {
    if (settings().step == asked.step && settings().damping == asked.damping && settings().shearModulus == asked.shearModulus) return true;
    auto changed = input_;
    changed.damping = asked.damping;
    changed.seconds = asked.step;
    auto dynamics = ExplicitJointDynamics::build(changed);
    if (!dynamics) return false;
    input_ = std::move(changed);
    dynamics_ = std::move(*dynamics);
    return true;
}

void PreviousModelJob::run(Stage, Frame& frame) {
    for (std::size_t j = 0; j < rotation_.size(); ++j) rotation_[j] = frame.joints[j].rotation.toRotationMatrix();
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        if (elements_[e].held.empty()) continue;
        elements_[e].rotation = frame.elements[e].frame.linear;
        elements_[e].wanted = frame.elements[e].v;
    }
    if (frame.stopped) dynamics_.reset(Eigen::VectorXd::Zero(input_.mass.size()));
    const auto forces = [this](const Eigen::VectorXd& displacement, Eigen::VectorXd& force) { pull(displacement, force); };
    if (frame.seconds > 0.0 && !dynamics_.step(frame.seconds, forces)) frame.warn(FrameWarning::Diverged);
    for (std::size_t e = 0; e < elements_.size(); ++e)
        if (!elements_[e].held.empty()) place(elements_[e], rotation_, dynamics_.displacement(), frame.elements[e].v);
    for (std::size_t n = 0; n < frame.offsets.size(); ++n) frame.offsets[n] = dynamics_.displacement().segment<3>(3 * static_cast<Eigen::Index>(n));
}

void PreviousModelJob::place(const Element& e, const std::vector<Matrix3d>& rotation, const Eigen::VectorXd& displacement, Eigen::VectorXd& v) {
    for (std::size_t i = 0; i < e.held.size(); ++i) {
        const auto& h = e.held[i];
        const Vec3 world = rotation[static_cast<std::size_t>(h.joint)] * displacement.segment<3>(3 * static_cast<Eigen::Index>(h.node));
        v.segment<3>(3 * static_cast<Eigen::Index>(i)) += h.axes.transpose() * (e.rotation.transpose() * world);
    }
}

void PreviousModelJob::pull(const Eigen::VectorXd& displacement, Eigen::VectorXd& force) {
    force.setZero();
    for (auto& e : elements_) {
        if (e.held.empty()) continue;
        e.v = e.wanted;
        place(e, rotation_, displacement, e.v);
        e.moved = e.v.cast<float>();
        e.traction.noalias() = e.tractions * e.moved;
        for (std::size_t i = 0; i < e.held.size(); ++i) {
            const auto& h = e.held[i];
            const Vec3 pulled = e.traction.segment<3>(3 * static_cast<Eigen::Index>(i)).cast<double>();
            force.segment<3>(3 * static_cast<Eigen::Index>(h.node)) -=
                settings().shearModulus * e.stiffness * h.area * (rotation_[static_cast<std::size_t>(h.joint)].transpose() * (e.rotation * pulled));
        }
    }
}

void PreviousModelJob::number(Frame& frame) const {
    frame.offsets.assign(static_cast<std::size_t>(input_.mass.size() / 3), Vec3::Zero());
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const auto& faces = frame.input.elements[e].faces;
        std::vector<int> node(frame.elements[e].runtime->vertices, 0);
        for (std::size_t f = 0; f < faces.size(); ++f)
            for (std::size_t i = 0; i < faces[f].vertices.size(); ++i)
                node[static_cast<std::size_t>(faces[f].vertices[i])] = elements_[e].held[elements_[e].first[f] + i].node;
        for (auto& h : frame.elements[e].held) h.node = node[static_cast<std::size_t>(h.vertex)];
    }
}

}  // namespace

std::vector<double> vertexAreas(const TriangleMesh& body, const JointFace& face) {
    std::vector<double> area(face.vertices.size(), 0.0);
    for (const std::int32_t t : face.triangles)
        for (int c = 0; c < 3; ++c)
            area[static_cast<std::size_t>(std::lower_bound(face.vertices.begin(), face.vertices.end(), body.triangles(t, c)) - face.vertices.begin())] += areaVector(body, t).norm() / 6.0;
    for (double& a : area) a = std::max(a, kLeastArea * face.area / static_cast<double>(area.size()));
    return area;
}

Result<void> PreviousModelEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    if (frame.input.basis != BasisKind::Full) return {};
    for (const auto& e : frame.input.elements)
        if (!e.faces.empty() && (!e.response || e.response->tractions.size() == 0)) return {};
    auto made = PreviousModelJob::build(frame.input, *this);
    if (!made) return tl::unexpected(made.error());
    jobs.add<PreviousModelJob>(std::move(*made)).number(frame);
    return {};
}

}  // namespace imomushi
