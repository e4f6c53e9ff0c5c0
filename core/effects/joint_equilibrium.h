// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/character/character.h"

namespace imomushi {

/// The shapes of all joints at once, in equilibrium (the manual's model, "Balance at joints"). Bones prescribe the place and the rotation of a joint;
/// free are its symmetric in-plane stretch and its warping, shared by all faces that meet there:
///
///   x -> at + R ((I + S) (x - place) + sum_k w_k phi_k(x)),   S symmetric in the plane, w_k vectors, phi_k the warping of the joint's first face.
///
/// They minimise sum_e mu_e (1/2 v_e^T K_e v_e + v_e^T f_e) with mu_e the relative stiffness of element e: tractions balance across every
/// joint as far as the modes allow, and free faces are as free of traction as that. v_e is linear in S and w for given rotations, so that a frame is
/// one sparse system of a dense block per joint. Joints whose elements have no response keep their shape.
/// Shapes that cost nothing, or less than kMinStiffness of the stiffest one of their joint, are resisted by that much.
/// A frame does not allocate. In the basis "full" joints have the most modes that there are.
class JointEquilibrium {
public:
    /// `input` must outlive this. Tables of joints and elements that are the same in `known` ones are taken over.
    explicit JointEquilibrium(const CharacterInput& input, std::span<const JointEquilibrium* const> known = {});
    JointEquilibrium(JointEquilibrium&&) noexcept;
    JointEquilibrium& operator=(JointEquilibrium&&) noexcept;
    ~JointEquilibrium();

    static constexpr double kMinStiffness = 1e-9;

    /// Rotation of a joint, rest to world, for the next solve().
    void setJoint(int joint, const Eigen::Matrix3d& rotation);
    /// Rotation of the moving frame of an element, rest to world; `rigid`: v of the element when its joints move rigidly; `force`: f above (see
    /// ElementResponse::loadForces), empty: none. Both as long as the response has columns.
    void setElement(int element, const Eigen::Matrix3d& rotation, const Eigen::VectorXd& rigid, std::span<const double> force = {});

    /// False: not finite, all joints keep their shape.
    bool solve();

    /// I + S in rest axes, with stretches bounded smoothly: never below kMinStretch or above kMaxStretch.
    [[nodiscard]] const Eigen::Matrix3d& stretch(int joint) const;
    /// w of each warping shape in rest axes, 3 x warpingShapes(), bounded smoothly so that no face turns inside out.
    [[nodiscard]] Eigen::Ref<const Eigen::Matrix3Xd> warping(int joint) const;
    [[nodiscard]] int warpingShapes() const;  ///< of every joint
    /// phi of a joint at a rest position, m; warpingShapes() values.
    void shapes(int joint, const Vec3& rest, double* values) const;
    /// v of an element in these shapes.
    [[nodiscard]] const Eigen::VectorXd& parameters(int element) const;

    static constexpr double kMinStretch = 0.3, kMaxStretch = 3.0;

    /// Everything that is the same in all frames, for solving elsewhere (assets/drivers).
    struct Constants {
        /// A joint displaces its points by a table of vectors in the axes of its first face, one per scalar shape: x, y, warping. Entry 3 shape + axis is
        /// the sum of these shares of free parameters.
        std::vector<std::vector<std::pair<int, double>>> entries;
        int parameters = 0;  ///< per joint: S as xx, xy, yy, then those of warping columns
        struct Joint {
            Eigen::Matrix3d axes;
            std::vector<Eigen::Matrix2Xd> slopes;  ///< of warping shapes at places of the face, along its x and y
        };
        std::vector<Joint> joints;
        /// Per element, per face: v of the face from the table, turned into its axes; columns of the face x entries. Empty without a response.
        std::vector<std::vector<Eigen::MatrixXd>> spread;
    };
    [[nodiscard]] Constants constants() const;
    static constexpr double kMaxFold = 0.9, kMaxSlope = 2.0;  ///< slopes of a warped face, over what would fold it in its plane (the least stretch), and out of it

    /// What solve() minimised, in the bounded shapes and with rigid joints; shear moduli times m^3. For tests.
    [[nodiscard]] double energy() const;
    [[nodiscard]] double rigidEnergy() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
