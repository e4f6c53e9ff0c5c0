// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/joint_dynamics_job.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/character/frame.h"
#include "core/character/frame_job.h"
#include "core/dynamics/joint_dynamics.h"
#include "core/mesh/topology.h"

namespace imomushi {

using Eigen::Matrix3d;

namespace {

constexpr int kParameters = 9;
// Bounds, approached smoothly: shifts in face sizes, tilts and twist in radians, stretch.
constexpr double kMaxShift = 0.5, kMaxTurn = 0.7, kMaxStrain = 0.4;

// Radians, face sizes and parts of the stretch: smaller moves are none.
constexpr double kUnmoved = 1e-9;

/// The affine motion x -> x + linear x + shift of parameter k, in the axes of a face and about its origin; to first order.
void motion(int k, Matrix3d& linear, Vec3& shift) {
    linear.setZero();
    shift.setZero();
    switch (k) {
        case 0: linear(0, 0) = 1.0; break;
        case 1: linear(0, 1) = linear(1, 0) = 1.0; break;
        case 2: linear(1, 1) = 1.0; break;
        case 3: linear(2, 0) = 1.0, linear(0, 2) = -1.0; break;  // tilts turn the normal, too
        case 4: linear(2, 1) = 1.0, linear(1, 2) = -1.0; break;
        case 5: shift.z() = 1.0; break;
        case 6: shift.x() = 1.0; break;
        case 7: shift.y() = 1.0; break;
        default: linear(0, 1) = -1.0, linear(1, 0) = 1.0; break;
    }
}

/// Volume of a closed body, m^3, and the share of it of each vertex by its triangles' areas.
Eigen::VectorXd vertexVolumes(const TriangleMesh& body) {
    Eigen::VectorXd share = Eigen::VectorXd::Zero(body.vertices.rows());
    for (std::int32_t t = 0; t < body.triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) share[body.triangles(t, k)] += areaVector(body, t).norm() / 6.0;
    if (const double area = share.sum(); area > 0.0) share *= std::abs(enclosedVolume(body.vertices, body.triangles)) / area;
    return share;
}

double bounded(double x, double most) { return most * std::tanh(x / most); }

Vec3 bounded(const Vec3& x, double most) {
    const double n = x.norm();
    return n > 0.0 ? Vec3(bounded(n, most) / n * x) : x;
}

/// Where a joint is: rotation (rest to world), place (m, world) and in-plane stretch.
struct Place {
    Matrix3d rotation = Matrix3d::Identity();
    Vec3 at = Vec3::Zero();
    double stretch = 1.0;
};

/// One joint that jiggles.
class JigglingJoint {
public:
    /// Nothing when no element of the joint has a response. `stiffness` of elements counts relative to each other only. Errors: "bad-value".
    static Result<std::optional<JigglingJoint>> build(const CharacterInput& input, const CharacterInput::Joint& joint, const JointDynamicsEffect& settings);
    /// Other frequency and damping; it stops. Errors: "bad-value"; then nothing changes.
    Result<void> set(const JointDynamicsEffect& settings);

    void reset(const Place& wanted);
    /// One frame: `seconds` pass (>= 0; none: the joint stays as far from the pose as it is). `wanted`: where the pose has the joint; it is changed to where
    /// the joint is, but for its stretch, which inPlane() multiplies.
    void step(double seconds, Place& wanted);

    [[nodiscard]] const Matrix3d& inPlane() const { return inPlane_; }  ///< stretch of its face besides that of the pose, about 1, rest axes
    [[nodiscard]] bool resting() const { return dynamics_.resting(); }

private:
    JigglingJoint(JointDynamics dynamics, JointDynamics::Input input) : dynamics_(std::move(dynamics)), input_(std::move(input)) {}

    void follow(const Place& wanted);

    JointDynamics dynamics_;
    JointDynamics::Input input_;
    Matrix3d axes_ = Matrix3d::Identity();               // of the first face, rest
    double size_ = 1.0;                                  // m, of the largest face
    Place last_;
    Eigen::VectorXd target_ = Eigen::VectorXd::Zero(9);  // how far the pose has taken the joint in its own axes, all in all
    Matrix3d inPlane_ = Matrix3d::Identity();
};

Result<std::optional<JigglingJoint>> JigglingJoint::build(const CharacterInput& input, const CharacterInput::Joint& joint,
                                                          const JointDynamicsEffect& settings) {
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(kParameters, kParameters), stiffness = mass, damped = mass;
    const auto& firstFace = input.elements[static_cast<std::size_t>(joint.faces[0].element)].faces[static_cast<std::size_t>(joint.faces[0].face)];
    double size = 0.0;
    bool any = false;
    for (const auto& f : joint.faces) {
        const auto& element = input.elements[static_cast<std::size_t>(f.element)];
        const auto& face = element.faces[static_cast<std::size_t>(f.face)];
        size = std::max(size, face.size);
        if (!element.response) continue;
        any = true;
        const auto& response = *element.response;
        const FaceBasis& basis = response.bases[static_cast<std::size_t>(f.face)];
        const int first = response.firstColumn[static_cast<std::size_t>(f.face)], columns = basis.columns();
        const Points rest = localVertices(element.mesh->body, face);

        // Columns of this face per parameter of the joint; by a small step, as coefficients() takes motions.
        constexpr double kStep = 1e-4;
        Eigen::MatrixXd T(columns, kParameters);
        for (int k = 0; k < kParameters; ++k) {
            Matrix3d linear;
            Vec3 shift;
            motion(k, linear, shift);
            const Matrix3d world = firstFace.frame.axes * linear * firstFace.frame.axes.transpose();
            JointMap map;
            map.linear = Matrix3d::Identity() + kStep * face.frame.axes.transpose() * world * face.frame.axes;
            map.shift = kStep * face.frame.axes.transpose() * (world * (face.frame.origin - firstFace.frame.origin) + firstFace.frame.axes * shift);
            double lost = 0.0;
            Eigen::VectorXd v = Eigen::VectorXd::Zero(columns);
            basis.coefficients(map, rest, face.size, v.data(), lost);
            T.col(k) = v / kStep;
        }
        const Eigen::MatrixXd own = element.stiffness * T.transpose() * response.stiffness.block(first, first, columns, columns) * T;
        stiffness += own;
        damped += element.damping * own;

        const Eigen::VectorXd volume = vertexVolumes(element.mesh->body);
        const Eigen::MatrixXd A = response.response.middleCols(first, columns) * T;
        for (std::size_t i = 0; i < response.freeVertices.size(); ++i) {
            const auto rows = A.middleRows<3>(3 * static_cast<Eigen::Index>(i));
            mass += element.density * volume[response.freeVertices[i]] * (rows.transpose() * rows);
        }
        for (std::size_t i = 0; i < face.vertices.size(); ++i) {
            const Eigen::MatrixXd rows = basis.at(rest.row(static_cast<Eigen::Index>(i)).transpose(), static_cast<int>(i)) * T;
            mass += element.density * volume[face.vertices[i]] * (rows.transpose() * rows);
        }
    }
    if (!any) return std::optional<JigglingJoint>();
    // What the basis cannot say (the twist of "paper") neither weighs nor resists: it is given a little mass, and follows.
    mass.diagonal().array() += 1e-9 * std::max(mass.diagonal().maxCoeff(), 1e-300);
    mass = (0.5 * (mass + mass.transpose())).eval();
    stiffness = (0.5 * (stiffness + stiffness.transpose())).eval();
    damped = (0.5 * (damped + damped.transpose())).eval();
    JointDynamics::Input whole{std::move(mass), std::move(stiffness), settings.hertz, settings.damping, std::move(damped)};
    auto dynamics = JointDynamics::build(whole);
    if (!dynamics) return tl::unexpected(dynamics.error());
    JigglingJoint made(std::move(*dynamics), std::move(whole));
    made.axes_ = firstFace.frame.axes;
    made.size_ = size;
    return std::optional<JigglingJoint>(std::move(made));
}

Result<void> JigglingJoint::set(const JointDynamicsEffect& settings) {
    JointDynamics::Input changed = input_;
    changed.hertz = settings.hertz;
    changed.damping = settings.damping;
    auto dynamics = JointDynamics::build(changed);
    if (!dynamics) return tl::unexpected(dynamics.error());
    dynamics_ = std::move(*dynamics);
    dynamics_.reset(target_);
    return {};
}

void JigglingJoint::reset(const Place& wanted) {
    last_ = wanted;
    target_.setZero();
    dynamics_.reset(target_);
}

void JigglingJoint::follow(const Place& wanted) {
    const Matrix3d turned = axes_.transpose() * last_.rotation.transpose() * wanted.rotation * axes_;
    const Vec3 shift = axes_.transpose() * (last_.rotation.transpose() * (wanted.at - last_.at));
    const Eigen::AngleAxisd turn(turned);
    const Vec3 angle = turn.angle() * turn.axis();
    const double grown = wanted.stretch - last_.stretch;
    // A pose at rest goes on changing by rounding: what is that small waits until it adds up.
    if (angle.norm() < kUnmoved && shift.norm() < kUnmoved * size_ && std::abs(grown) < kUnmoved) return;
    last_ = wanted;
    target_[0] += grown;
    target_[2] += grown;
    target_[3] -= angle.y();
    target_[4] += angle.x();
    target_[5] += shift.z();
    target_[6] += shift.x();
    target_[7] += shift.y();
    target_[8] += angle.z();
}

void JigglingJoint::step(double seconds, Place& wanted) {
    if (seconds > 0.0) follow(wanted);
    dynamics_.step(seconds, target_);
    inPlane_.setIdentity();
    if (dynamics_.resting()) return;
    const auto away = [this](int k) { return dynamics_.parameters()[k] - target_[k]; };
    const Vec3 tilt = bounded(Vec3(away(4), -away(3), away(8)), kMaxTurn);
    wanted.at += wanted.rotation * (axes_ * bounded(Vec3(away(6), away(7), away(5)), kMaxShift * size_));
    const double angleOfTilt = tilt.norm();
    if (angleOfTilt > 0.0) wanted.rotation = wanted.rotation * axes_ * Eigen::AngleAxisd(angleOfTilt, tilt / angleOfTilt).toRotationMatrix() * axes_.transpose();
    Matrix3d inPlane = Matrix3d::Identity();
    inPlane(0, 0) += bounded(away(0), kMaxStrain);
    inPlane(1, 1) += bounded(away(2), kMaxStrain);
    inPlane(0, 1) = inPlane(1, 0) = bounded(away(1), 0.5 * kMaxStrain);
    inPlane_ = axes_ * inPlane * axes_.transpose();
}

class JointDynamicsJob final : public EffectJob<JointDynamicsEffect> {
public:
    static Result<JointDynamicsJob> build(const CharacterInput& input, const JointDynamicsEffect& settings) {
        JointDynamicsJob made(settings);
        for (const auto& joint : input.joints) {
            auto jiggling = JigglingJoint::build(input, joint, settings);
            if (!jiggling) return tl::unexpected(jiggling.error());
            made.joints_.push_back(std::move(*jiggling));
        }
        return made;
    }

    void run(Stage stage, Frame& frame) override {
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            if (!joints_[j]) continue;
            if (stage == Stage::Joints)
                move(*joints_[j], frame, frame.joints[j]);
            else if (!frame.smooth)
                stretch(*joints_[j], frame.joints[j]);
        }
    }

    [[nodiscard]] bool resting(const Frame&) const override {
        return std::all_of(joints_.begin(), joints_.end(), [](const auto& joint) { return !joint || joint->resting(); });
    }

private:
    explicit JointDynamicsJob(const JointDynamicsEffect& settings) : EffectJob(settings, {{Stage::Joints, FrameData::Joints, FrameData::Joints}, {Stage::JointMaps, FrameData::Joints | FrameData::JointMaps, FrameData::JointMaps}}) {}

    bool take(const JointDynamicsEffect& asked) override {
        if (settings().hertz == asked.hertz && settings().damping == asked.damping) return true;
        bool taken = true;  // refused numbers leave a joint as it is
        for (auto& joint : joints_)
            if (joint) taken = joint->set(asked).has_value() && taken;
        return taken;
    }

    static void move(JigglingJoint& joint, const Frame& frame, JointState& out) {
        Place place{out.rotationMatrix, out.at, out.stretch};
        if (frame.stopped) joint.reset(place);
        joint.step(frame.seconds, place);
        if (!(place.rotation == out.rotationMatrix)) {
            const Eigen::Quaterniond moved(place.rotation);
            out.rotation = moved.dot(out.rotation) < 0.0 ? Eigen::Quaterniond(-moved.coeffs()) : moved;
        }
        out.rotationMatrix = place.rotation;
        out.at = place.at;
    }

    static void stretch(const JigglingJoint& joint, JointState& out) {
        out.map.linear = out.map.linear * joint.inPlane();
        out.map.shift = out.at - out.map.linear * out.restPlace;
    }

    std::vector<std::optional<JigglingJoint>> joints_;  // of the character; nothing: it does not jiggle
};

}  // namespace

Result<void> JointDynamicsEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    auto made = JointDynamicsJob::build(frame.input, *this);
    if (!made) return tl::unexpected(made.error());
    jobs.add<JointDynamicsJob>(std::move(*made));
    return {};
}

}  // namespace imomushi
