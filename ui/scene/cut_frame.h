// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "core/session/session.h"

namespace imomushi {

/// A cut of a character as it is posed now.
struct CutFrame {
    std::array<PartId, 2> elements{};       ///< behind the plane, in front of it
    std::vector<std::vector<Vec3>> rim;     ///< closed loops, m, world; none: the joint face of the cut was removed
    Vec3 centre = Vec3::Zero();             ///< of the cap, m, world
    Vec3 normal = Vec3::UnitX();            ///< unit, world
    Vec3 restCentre = Vec3::Zero();         ///< m
    double reach = 0.0;                     ///< m: as far as the rim is from the centre
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< of the plane, rest -> world

    /// A place and a direction of the world as they are at rest.
    [[nodiscard]] Vec3 atRest(const Vec3& point) const { return restCentre + rotation.inverse() * (point - centre); }
};

/// None: there is no such cut.
std::optional<CutFrame> cutFrame(const Session& session, PartId cut);

}  // namespace imomushi
