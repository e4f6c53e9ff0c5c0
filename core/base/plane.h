// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/base/finite.h"
#include "core/base/result.h"
#include "core/base/vec3.h"

namespace imomushi {

/// A plane with a front. Whatever holds one need not check it: it is finite, and its normal is of unit length.
class Plane {
public:
    /// Across the world's up direction, through its origin.
    Plane() = default;
    static constexpr double kFarthest = 1e50;  ///< m, of its origin along each axis: heights above it are finite wherever anything is

    /// Through `origin` (m, within kFarthest), its front where `normal` (of any length but 0) points. Errors: "bad-value".
    static Result<Plane> through(const Vec3& origin, const Vec3& normal) {
        if (!allFinite(origin) || !(origin.cwiseAbs().maxCoeff() <= kFarthest))
            return fail("bad-value", "The plane has no place: give a point of it.");
        const double largest = allFinite(normal) ? normal.cwiseAbs().maxCoeff() : 0.0;
        if (!(largest > 0.0)) return fail("bad-value", "The plane has no direction: give a normal that is finite and not zero.");
        return Plane(origin, (normal / largest).normalized());
    }
    /// Across the world's up direction (+y), at that height (m, finite).
    static Plane level(double height) { return {Vec3(0.0, height, 0.0), Vec3::UnitY()}; }

    [[nodiscard]] const Vec3& origin() const { return origin_; }  ///< a point of it, m
    [[nodiscard]] const Vec3& normal() const { return normal_; }  ///< of unit length
    /// m: how far in front of it a point is; negative behind it.
    [[nodiscard]] double height(const Vec3& p) const { return normal_.dot(p - origin_); }
    /// The part of a direction that runs along it.
    [[nodiscard]] Vec3 along(const Vec3& d) const { return d - normal_.dot(d) * normal_; }

    bool operator==(const Plane&) const = default;

private:
    Plane(const Vec3& origin, const Vec3& normal) : origin_(origin), normal_(normal) {}
    Vec3 origin_ = Vec3::Zero(), normal_ = Vec3::UnitY();
};

}  // namespace imomushi
