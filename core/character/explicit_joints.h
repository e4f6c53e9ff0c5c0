// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/character/character.h"
#include "core/dynamics/explicit_joint_dynamics.h"

namespace imomushi {

/// Joint dynamics of the paper's previous model in a character of basis "full" (model.md section 2): every vertex of the joint faces moves by itself about
/// where the bones carry its face, driven by the tractions of the elements, explicitly. Vertices of other faces of a joint do what the nearest one of its
/// first face does, so that seams stay closed.
class ExplicitJoints {
public:
    using Settings = CharacterEffects::PreviousModel;
    /// Errors: "bad-value": an element with joint faces has no response of basis "full"; numbers out of range.
    static Result<ExplicitJoints> build(const CharacterInput& input, const Settings& settings);
    /// Other numbers; it stops. Errors: "bad-value"; then nothing changes.
    Result<void> set(const Settings& settings);

    void reset();
    /// Rotations, rest to world, for the next step(): of a joint; of the frame of an element, with v as its bones want it.
    void setJoint(int joint, const Eigen::Matrix3d& rotation) { rotation_[static_cast<std::size_t>(joint)] = rotation; }
    void setElement(int element, const Eigen::Matrix3d& rotation, const Eigen::VectorXd& v);
    /// One frame of `seconds` > 0. False: it diverged; the last good state stays, at rest. Neither allocates, locks nor fails.
    bool step(double seconds);

    /// Adds to v of an element what its vertices do beyond their joints.
    void addTo(int element, Eigen::VectorXd& v) const;
    /// The same of a vertex of a face, m, in the rest axes of the joint. `node`: of nodeOf().
    [[nodiscard]] Vec3 offset(int node) const { return dynamics_.displacement().segment<3>(3 * static_cast<Eigen::Index>(node)); }
    /// The node of the i-th vertex of a face.
    [[nodiscard]] int nodeOf(int element, int face, std::size_t i) const;
    [[nodiscard]] bool resting() const;

private:
    struct Vertex {
        int node = 0, joint = 0;
        double area = 0.0;                                   // m^2
        Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // of its face
    };
    struct Element {
        std::vector<Vertex> held;      // in the order of columns
        std::vector<std::size_t> first;  // of each face in `held`
        Eigen::MatrixXd tractions;     // see ElementResponse; shear modulus 1
        double stiffness = 1.0;
        Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
        Eigen::VectorXd wanted, v, traction;
    };
    explicit ExplicitJoints(ExplicitJointDynamics dynamics) : dynamics_(std::move(dynamics)) {}
    void pull(const Eigen::VectorXd& displacement, Eigen::VectorXd& force);
    static void place(const Element& element, const std::vector<Eigen::Matrix3d>& rotation, const Eigen::VectorXd& displacement, Eigen::VectorXd& v);

    ExplicitJointDynamics::Input input_;
    ExplicitJointDynamics dynamics_;
    double shearModulus_ = 1.0;
    std::vector<Eigen::Matrix3d> rotation_;  // per joint
    std::vector<Element> elements_;
};

}  // namespace imomushi
