// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/result.h"
#include "core/mesh/mesh.h"
#include "core/touch/contact_solve.h"
#include "core/touch/dent_surface.h"
#include "core/touch/touch_surface.h"

namespace imomushi {

/// How fingers feel. All elements of a character share one.
struct TouchSettings {
    /// Coulomb's coefficient, 0 ... 10: a finger sticks as long as its force along the surface is at most this many times the one into it, and slips
    /// beyond. 0: only pushes straight in; 1: sticks up to 45 degrees; 10: hardly ever slips.
    double friction = 1.0;
    /// s, 0 ... 10: after it a finger that is put down deep inside has come nine tenths of its way. 0: at once.
    double pressSeconds = 0.05;
    /// s, 0 ... 10: after it a tenth of the dent of a lifted finger is left. 0: none.
    double releaseSeconds = 0.15;
    /// Largest displacement gradient (Frobenius norm) that fingers make, 0.05 ... 0.9: how far the flesh gives way before a finger does not get any
    /// deeper. At 1 flesh would be pressed to nothing, or a thin fin bent by 0.7 radians.
    double mostStrain = 0.7;
    /// m, 0 ... 1000: the tips of fingers are smooth spheres of this radius, unless they are put down with another, and make dents of that width (DentSurface), as wide as a sphere's contact that
    /// deep, but no steeper than mostStrain. 0: only patches give way.
    double tip = 0.0;
};
/// Errors: "bad-value".
Result<void> checkTouchSettings(const TouchSettings& settings);

/// Fingers on one element. Each holds a point of its surface and pushes it towards a target, by a force that is spread over the patches around that
/// point (TouchResponse): unilateral, sticking up to a Coulomb cone, all fingers at once. The pressed points meet their targets exactly while they
/// stick. A finger presses a point of the flesh: one that slips stays at that point in the surface and loses its target sideways. Built once;
/// everything else is per frame: it neither allocates, locks nor fails, and the same calls give the same bytes. Displacements and forces are along
/// the element rest axes, in which the response is added to the pose; forces are for shear modulus 1.
class TouchContact {
public:
    static constexpr int kFingers = 24;
    static constexpr int kDents = kFingers + 8;  ///< with those that go back

    /// Errors: "bad-value" (settings).
    /// dents: of the same surface; null: there are none, whatever the tip.
    static Result<TouchContact> build(std::shared_ptr<const TouchSurface> surface, const TouchSettings& settings, std::shared_ptr<const DentSurface> dents = nullptr);
    /// Errors: "bad-value"; the old settings then stay.
    Result<void> set(const TouchSettings& settings);

    using Point = TouchSurface::Point;
    [[nodiscard]] const TouchSurface& surface() const { return *surface_; }

    /// Puts a finger (0 ... kFingers - 1) down, or moves one that is down to another point of the flesh. radius: m, that of the finger tip; no finger
    /// is smaller than TouchSurface::narrowest(), nor wider than TouchSurface::kMaxSpread allows; 0: it presses the patches around its point by their
    /// weights there. False, and nothing changes, where the point cannot be touched (joint faces, cavities) or is not a number.
    bool place(int finger, const Point& point, double radius);
    /// Where the finger wants its point, every frame. corners: those of triangle(finger) as the pose alone leaves them, target: in the same axes;
    /// axes: of the pose's displacement at the point relative to the rest axes (a rotation; how the pose turns the response of touch). False, and the
    /// last aim stays, for what is not finite.
    bool aim(int finger, const std::array<Vec3, 3>& corners, const Vec3& target, const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());
    /// The same as the displacement that is wanted and the outward normal (any length), both in rest axes.
    bool aim(int finger, const Vec3& wanted, const Vec3& normal);
    /// Takes it away: its dent goes back smoothly.
    void lift(int finger);
    void liftAll();
    /// No fingers, no dents.
    void reset();

    /// One frame: `seconds` pass (>= 0; anything else counts as 0).
    void step(double seconds);
    /// Solves for fingers that have been held still for long: they have come in fully, and dents of lifted fingers are gone.
    void converge();

    [[nodiscard]] bool down(int finger) const { return fingers_[static_cast<std::size_t>(finger)].down; }
    [[nodiscard]] std::int32_t triangle(int finger) const { return fingers_[static_cast<std::size_t>(finger)].point.triangle; }
    /// No finger pushes and no dent is left: patchForces() are 0, and the frame needs nothing of touch.
    [[nodiscard]] bool idle() const { return idle_; }
    /// Changes when patchForces() do.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }
    [[nodiscard]] const Eigen::VectorXd& patchForces() const { return total_; }  ///< 3 P, over the shear modulus, m^2
    /// What is added to the displacement by patchForces(): kDents of them, or none.
    [[nodiscard]] std::span<const Dent> dents() const { return {shown_.data(), dents_ ? shown_.size() : 0}; }
    /// Adds what touch does to the joint parameters, as generalised forces for that shear modulus: - shear * TouchResponse::forces * patchForces(). g
    void addJointForces(double shear, Eigen::VectorXd& forces) const;

    /// What became of a finger in the last step().
    enum class State { Up, Outside, Sticks, Slips };
    [[nodiscard]] State state(int finger) const { return fingers_[static_cast<std::size_t>(finger)].state; }
    [[nodiscard]] Vec3 force(int finger) const { return fingers_[static_cast<std::size_t>(finger)].force; }  ///< over the shear modulus, m^2
    /// How far touch moves the finger's point, m.
    [[nodiscard]] Vec3 displacement(int finger) const { return fingers_[static_cast<std::size_t>(finger)].moved; }
    /// The flesh did not give way any further: mostStrain was reached, and the point is not where the finger is.
    [[nodiscard]] bool clamped(int finger) const { return fingers_[static_cast<std::size_t>(finger)].clamped; }

    [[nodiscard]] std::size_t bytes() const;

private:
    using Row3 = Eigen::Matrix<double, 3, Eigen::Dynamic>;
    struct Finger : ContactPoint {
        bool down = false, clamped = false, aimed = false;
        State state = State::Up;
        Point point;
        std::array<std::int32_t, 3> corner{};
        Eigen::VectorXd weights;  // P, sum 1
        Row3 rows;                // 3 x 3 P: displacement of its point by patch forces
        Row3 gradients;           // 3 x 9 #probes: of the displacement by its force
        Vec3 wanted = Vec3::Zero();
        double remaining = 1.0, remainingRate = 0.0;  // what is left of the way of coming in, 1 ... 0
        Vec3 moved = Vec3::Zero();
        Dent dent;                            // at the force of 1; radius 0: none
        double tip = 0.0, narrowest = 0.0;    // m
    };
    struct Fading {
        Dent dent;
        Vec3 rate = Vec3::Zero();  // of its force
    };

    TouchContact(std::shared_ptr<const TouchSurface> surface, const TouchSettings& settings, std::shared_ptr<const DentSurface> dents);
    [[nodiscard]] const TouchResponse& touch() const { return surface_->touch(); }
    void findCompliance(std::size_t finger);
    [[nodiscard]] double largestGradient(const Eigen::VectorXd& gradients) const;
    [[nodiscard]] Eigen::Matrix3d dented(const Finger& finger, const Dent& by) const;
    void widen(std::size_t finger);
    double strainAlone(std::size_t finger);
    void reach(std::size_t finger, double strain);
    void findDents();
    void leave(Finger& finger);
    void advance(double seconds);
    void solve();
    void sumForces();

    std::shared_ptr<const TouchSurface> surface_;
    TouchSettings settings_;
    std::shared_ptr<const DentSurface> dents_;

    std::array<Finger, kFingers> fingers_;
    Eigen::VectorXd left_, leftRate_, total_, before_;  // 3 P: dents of fingers that are gone, and all
    Eigen::VectorXd weights_, nextWeights_;             // P
    Eigen::VectorXd gradients_;                         // 9 #probes
    ContactSolver solver_;                              // a slot per finger
    std::vector<Eigen::Matrix3d> byPatches_;            // with dents: compliances without them, kFingers x kFingers
    std::array<Fading, kDents - kFingers> fading_;
    std::array<Dent, kDents> shown_;
    bool idle_ = true, resting_ = true;  // resting_: no dents of fingers that are gone
    std::uint64_t revision_ = 0;
};

}  // namespace imomushi
