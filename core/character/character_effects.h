// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/mesh/mesh.h"
#include "core/touch/touch_contact.h"

namespace imomushi {

/// The effects of a character that act on its elements and joints, by their numbers (model.md section 6). Which of them a character has, and where, is fixed when
/// it is built; the numbers may change while it moves.
struct CharacterEffects {
    struct Gravity {
        Vec3 acceleration = Vec3(0.0, -9.81, 0.0);  ///< of free fall, m/s^2, world
        double inertia = 1.0;                       ///< how much of its own acceleration the flesh feels
        double shearModulus = 3000.0;               ///< of stiffness 1, Pa
    };
    struct Inflate {
        double pressure = 0.1;      ///< over the shear modulus of stiffness 1
        double breath = 0.0;        ///< amplitude of its rise and fall
        double breathHertz = 0.25;
    };
    struct JointDynamics {
        double hertz = 4.0;         ///< of the softest way in which a joint jiggles
        double damping = 0.2;       ///< ratio
    };
    /// Of the paper's previous model, in the basis "full".
    struct PreviousModel {
        double step = 1.0 / 600.0;  ///< of the explicit integration, s
        double damping = 4.0;       ///< of velocities, 1/s
        double shearModulus = 3000.0;  ///< of stiffness 1, Pa
    };
    std::optional<Gravity> gravity;
    std::optional<Inflate> inflate;
    std::optional<JointDynamics> jointDynamics;
    std::optional<PreviousModel> previousModel;
    std::optional<TouchSettings> touch;
};

}  // namespace imomushi
