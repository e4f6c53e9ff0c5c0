// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh.h"
#include "core/mesh/triangle_tree.h"
#include "core/reduction/element_response.h"

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
    static constexpr int kFingers = 16;
    static constexpr int kMostSpread = 8;  ///< see place()

    /// `response` was made with ResponseInput::touch. Errors: "bad-value" (settings; a response without patches, or of another mesh).
    static Result<TouchContact> build(const TriangleMesh& body, std::span<const JointFace> faces, std::shared_ptr<const ElementResponse> response,
                                      const TouchSettings& settings);
    /// Errors: "bad-value"; the old settings then stay.
    Result<void> set(const TouchSettings& settings);

    /// A point of the surface that can be touched.
    struct Point {
        std::int32_t triangle = -1;  ///< of the body; -1: none
        Vec3 barycentric = Vec3::Zero();
        double distance = 0.0;  ///< m, from what was asked for
    };
    /// The nearest one to a place in the rest pose; with a direction, among those whose surface faces it (where a ray from outside came from: minus
    /// the ray).
    [[nodiscard]] Point nearest(const Vec3& rest) const;
    [[nodiscard]] Point nearestFacing(const Vec3& rest, const Vec3& direction) const;

    /// Puts a finger (0 ... kFingers - 1) down, or moves one that is down to another point of the flesh. radius: m, that of the finger tip; no finger
    /// is smaller than a bump (about narrowest()), nor wider than kMostSpread bumps; 0: as smooth as bumps are. False, and nothing changes, where the
    /// point cannot be touched (joint faces, cavities) or is not a number.
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
    /// The pose that fingers held for long leave.
    void settle();

    [[nodiscard]] bool down(int finger) const { return fingers_[static_cast<std::size_t>(finger)].down; }
    [[nodiscard]] std::int32_t triangle(int finger) const { return fingers_[static_cast<std::size_t>(finger)].point.triangle; }
    /// No finger pushes and no dent is left: patchForces() are 0, and the frame needs nothing of touch.
    [[nodiscard]] bool idle() const { return idle_; }
    /// Changes when patchForces() do.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }
    [[nodiscard]] const Eigen::VectorXd& patchForces() const { return total_; }  ///< 3 P, over the shear modulus, m^2
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

    /// m: radius of the smallest finger.
    [[nodiscard]] double narrowest() const;
    [[nodiscard]] std::size_t bytes() const;

private:
    using Row3 = Eigen::Matrix<double, 3, Eigen::Dynamic>;
    struct Finger {
        bool down = false, clamped = false, aimed = false;
        State state = State::Up;
        Point point;
        std::array<std::int32_t, 3> corner{};
        Eigen::VectorXd weights;  // P, sum 1
        Row3 rows;                // 3 x 3 P: displacement of its point by patch forces
        Row3 gradients;           // 3 x 9 #probes: of the displacement by its force
        Vec3 wanted = Vec3::Zero(), normal = Vec3::UnitZ();
        double behind = 1.0, behindRate = 0.0;  // what is left of the way of coming in, 1 ... 0
        Vec3 force = Vec3::Zero(), slip = Vec3::Zero(), moved = Vec3::Zero();
        Vec3 goal = Vec3::Zero();  // of the displacement by all fingers, this frame
    };
    enum class Grip : char { None, Stick, Slip };

    TouchContact(const TriangleMesh& body, std::span<const JointFace> faces, std::shared_ptr<const ElementResponse> response,
                 const TouchSettings& settings);
    [[nodiscard]] const TouchResponse& touch() const { return response_->touch; }
    void spread(Finger& finger, double radius);
    void measure(std::size_t finger);
    [[nodiscard]] Eigen::Matrix3d& compliance(std::size_t of, std::size_t by) { return compliance_[of * kFingers + by]; }
    [[nodiscard]] const Eigen::Matrix3d& compliance(std::size_t of, std::size_t by) const { return compliance_[of * kFingers + by]; }
    [[nodiscard]] double largestGradient(const Eigen::VectorXd& gradients) const;
    void grip(const Eigen::Matrix3d& compliance, const Vec3& gap, Finger& finger, Grip& how) const;
    void leave(Finger& finger);
    void advance(double seconds);
    void solve();
    void sweep();
    bool polish();
    [[nodiscard]] Vec3 missing(std::size_t i) const;
    void addUp();

    std::shared_ptr<const ElementResponse> response_;
    TouchSettings settings_;
    TriangleMesh body_;
    Points normals_;                 // of the body at rest
    std::vector<std::int32_t> row_;  // per body vertex: of displacement, -1: held
    std::vector<char> touchable_;    // per triangle
    std::unique_ptr<TriangleTree> tree_;
    Eigen::MatrixXd overlap_;  // P x P, rows add up to 1: how patches share places
    Eigen::VectorXd largest_;  // P: displacement of any vertex per force, m / m^2
    double size_ = 1.0;

    std::array<Finger, kFingers> fingers_;
    Eigen::VectorXd left_, leftRate_, total_, before_;  // 3 P: dents of fingers that are gone, and all
    Eigen::VectorXd spread_, spreadNext_;               // P
    Eigen::VectorXd gradients_;                         // 9 #probes
    std::vector<std::size_t> active_;                   // fingers that are inside
    std::vector<Grip> grip_;                            // of active_
    std::vector<Eigen::Matrix3d>
        compliance_;  // kFingers x kFingers: displacement of a finger's point by the force of another, of those that are down
    std::vector<double> matrix_, right_;
    std::vector<Vec3> kept_;
    bool idle_ = true, resting_ = true;  // resting_: no dents of fingers that are gone
    std::uint64_t revision_ = 0;
};

}  // namespace imomushi
