// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "ui/picking/picking.h"

namespace imomushi {

/// The other side of a character, left and right of a plane across x: of the character that has the part, else of all elements together, through their middle at rest. One through the origin is
/// exact. What is on the other side is found by names that change sides (.L and .R, Left and Right), else by places that mirror each other at rest.
class Symmetry {
public:
    /// Across the middle of what has `bone`, or the handle's element; 0: of all elements.
    static Symmetry ofBone(const Document& document, PartId bone);
    static Symmetry ofElement(const Document& document, PartId element);

    [[nodiscard]] double middle() const { return middle_; }
    [[nodiscard]] Vec3 point(const Vec3& p) const { return {2.0 * middle_ - p.x(), p.y(), p.z()}; }
    [[nodiscard]] static Vec3 way(const Vec3& v) { return {-v.x(), v.y(), v.z()}; }
    [[nodiscard]] static Eigen::Quaterniond turn(const Eigen::Quaterniond& q) { return {q.w(), q.x(), -q.y(), -q.z()}; }
    /// In the plane, as far as parts of this size (m) are.
    [[nodiscard]] bool holds(const Vec3& p, double size) const;

    /// What is on the other side; none: nothing, or it is in the plane and its own image, as central() says.
    [[nodiscard]] std::optional<EndpointRef> imageOf(const Session& session, const EndpointRef& end) const;
    [[nodiscard]] std::optional<FaceRef> imageOf(const Document& document, const FaceRef& handle) const;
    [[nodiscard]] std::optional<PoseGrip> imageOf(const Session& session, const PoseGrip& grip) const;
    [[nodiscard]] bool central(const Document& document, const PoseGrip& grip) const;
    /// The joint face or the end of a bone at a place at rest, but of these bones; else the place itself.
    [[nodiscard]] static Bone::Place placeAt(const Document& document, const Vec3& rest, const std::vector<EndpointRef>& but, double size);

private:
    explicit Symmetry(double middle) : middle_(middle) {}
    double middle_ = 0.0;  ///< x, m
};

}  // namespace imomushi
