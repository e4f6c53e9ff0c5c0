// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/base/plane.h"
#include "core/mesh/box_tree.h"
#include "core/touch/contact_solve.h"
#include "core/touch/contact_surface.h"

namespace imomushi {

/// Contact of flesh with flesh: elements press on each other and on themselves through their patches (TouchResponse). Contact is unilateral, with Coulomb's friction, without inertia.
/// Sample points of one surface stay outside of the others. A force acts at a sample, and the opposite one where it presses; both are spread over the patches there.
/// Contacts are found on the surfaces that the pose alone gives, before dents. So each step is one linear complementarity problem, which starts from the forces of the step before.
/// Flesh still passes through where it is pressed so far that dents are no longer linear. What touches at rest does not press. Bodies in contact form islands; an island
/// that has converged sleeps until one of its bodies moves. Built once; per frame it neither allocates, locks nor fails, and the same calls give the same bytes.
class FleshContact {
public:
    struct Body {
        std::shared_ptr<const ContactSurface> surface;
        double shear = 1.0;  ///< relative shear modulus
    };
    struct Settings {
        double friction = 0.5;  ///< Coulomb's coefficient
        Plane ground{};         ///< that bodies of Near::grounded do not sink through
        double groundFriction = 0.6;
        double mostStrain = 0.95;  ///< largest displacement gradient (Frobenius) that contact makes in an element
        bool operator==(const Settings&) const = default;
    };
    /// Those that may meet.
    struct Near {
        std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< of bodies, the lower first; of a body with itself too
        std::vector<std::size_t> grounded;                       ///< the ground
        [[nodiscard]] bool none() const { return pairs.empty() && grounded.empty(); }
    };
    /// Contacts of an island of a few and of many bodies, at most: beyond, each body keeps its deepest ones, see bounded().
    static constexpr std::size_t kMost = 768, kMostPerBody = 96;

    explicit FleshContact(std::vector<Body> bodies);

    /// Where the pose alone has the bodies.
    class Posed {
    public:
        virtual ~Posed() = default;
        [[nodiscard]] virtual Vec3 at(std::size_t body, std::int32_t vertex) const = 0;  ///< m, world
        [[nodiscard]] virtual const Eigen::Matrix3d& axes(std::size_t body) const = 0;   ///< rest to world, a rotation
    };
    /// The middles of its patches are there (3 x P, m, world).
    void place(std::size_t body, const Eigen::Matrix3Xd& middles);
    /// Whether two bodies may meet where they were placed.
    [[nodiscard]] bool areNear(std::size_t a, std::size_t b) const;
    [[nodiscard]] bool isNearGround(std::size_t body, const Eigen::Matrix3Xd& middles, const Plane& ground) const;
    /// Two surfaces that have turned against each other by less (radians), and moved by less than half of their restClearance(), do not meet.
    static constexpr double kMostTurn = ContactSurface::kMostTurn;
    /// m: see ContactSurface::clearance().
    [[nodiscard]] double restClearance(std::size_t a, std::size_t b) const { return clearance_[a * bodies_.size() + b]; }

    /// Begins a step. moved: per body, 1: it is not where it was in the last step; empty: all are. Who may meet is the same while nothing has moved.
    void begin(const Near& near, const Settings& settings, std::span<const char> moved = {});
    /// In this step it meets something, and what comes of it is not known yet.
    [[nodiscard]] bool awake(std::size_t body) const { return states_[body].met && !states_[body].asleep; }
    /// It meets something, and its forces stay as they are.
    [[nodiscard]] bool asleep(std::size_t body) const { return states_[body].asleep; }
    /// Ends it. converge: solves until forces hardly change.
    void finish(const Posed& posed, bool converge);
    /// One step of bodies that have all moved.
    void step(const Posed& posed, const Near& near, const Settings& settings, bool converge) {
        begin(near, settings);
        finish(posed, converge);
    }
    /// Nothing presses.
    void reset();

    /// Over its shear modulus, in its rest axes, 3 P, m^2.
    [[nodiscard]] const Eigen::VectorXd& patchForces(std::size_t body) const { return states_[body].forces; }
    [[nodiscard]] bool idle() const;
    /// The last step changed nothing that shows.
    [[nodiscard]] bool converged() const { return converged_; }
    /// Samples were inside of something in the last step and left out, as there were too many.
    [[nodiscard]] bool bounded() const;
    /// All contact forces on a body together, world, m^2 in units of a shear modulus of 1.
    [[nodiscard]] Vec3 force(std::size_t body) const { return states_[body].force; }
    [[nodiscard]] std::size_t bytes() const;

private:
    static constexpr std::size_t kGround = static_cast<std::size_t>(-1);  ///< in place of a body: it gives no way, and its axes are the world's
    static constexpr std::size_t kWidth = 24;                             ///< patches under one point, at most
    static constexpr std::size_t kBlock = 12;  ///< numbers of a block of three by three: columns of four, the last of which is 0

    /// What a sample knows from its last contact.
    struct Memory {
        std::uint64_t step = 0;    // 0: it had none
        std::size_t other = 0;     // it pressed on this body
        TouchSurface::Point held;  // where, of the flesh, while it sticks
        // In the axes of `other`: how far it had slipped from there when it began to, m, and the force on it.
        Vec3 slipped = Vec3::Zero(), force = Vec3::Zero();
    };
    struct Candidate {
        std::uint64_t step = 0;
        double square = 0.0;  // m^2
        std::size_t body = 0;
        std::int32_t vertex = 0;
    };
    struct Vertex {
        std::uint64_t step = 0, stepOfNormal = 0;
        Vec3 at = Vec3::Zero(), normal = Vec3::Zero();
    };
    struct State {
        Eigen::VectorXd forces, before;     // 3 P
        std::vector<std::int32_t> pressed;  // patches with forces
        std::vector<std::int32_t> active;   // patches of this step
        std::vector<std::int32_t> slot;     // per patch, its place among them, -1: none
        Eigen::Matrix3Xd sums;              // per active patch: its force, rest axes
        Eigen::Matrix4Xf sumsFloat;         // the same
        Eigen::VectorXf strain;             // gradients by these, as TouchResponse::gradients
        Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
        std::vector<Memory> memory;            // per sample
        std::vector<Candidate> candidates;     // per sample
        std::vector<std::size_t> near;         // samples with a candidate
        std::vector<Vertex> vertices;          // of the body
        Eigen::Matrix3Xd sampleAt;             // m, world, of the patches that were placed
        std::vector<std::uint64_t> placed;     // per patch: the step in which it was
        std::vector<std::vector<char>> muted;  // per body, per sample, 1: it touches that one at rest; empty: none does
        BoxTree tree;                          // over its patches
        std::vector<Bounds> boxes;             // of these
        double softness = 0.0;                 // m / m^2
        Vec3 force = Vec3::Zero();
        std::uint64_t step = 0, lastStep = 0;  // it was solved in, and the one before; 0: none
        bool met = false, asleep = false, converged = false, bounded = false;
    };
    /// A sample that meets a surface.
    struct Meeting {
        double gap = 0.0;  // m, of the sample from it, along the normal
        std::size_t body = 0, sample = 0, other = 0;
        TouchSurface::Point at;  // of the other body
        Vec3 normal = Vec3::UnitZ();
        Vec3 apart = Vec3::Zero();  // of the sample from there, by the pose alone, m, world; of the ground: from below its origin
    };
    /// A point of a body under which patches lie.
    struct Spread {
        std::size_t body = 0, count = 0;
        std::array<std::int32_t, kWidth> slot{};
        std::array<double, kWidth> weight{};
        std::size_t rows = 0;  // in rows_: a block of three by three per active patch of the body, rest axes
    };
    struct Contact : ContactPoint {
        Meeting met;
        Spread on, under;
        Eigen::Matrix3d compliance = Eigen::Matrix3d::Zero();
    };

    // flesh_meetings.cpp
    /// Around the vertices of a patch whose middle is there.
    [[nodiscard]] Bounds boxOf(std::size_t body, std::size_t patch, const Vec3& middle) const;
    void findTouchingAtRest();
    const Vec3& vertexAt(std::size_t body, std::int32_t vertex, const Posed& posed);
    const Vec3& normalAt(std::size_t body, std::int32_t vertex, const Posed& posed);
    void beginStep(const Posed& posed);
    void findCandidates(std::size_t a, std::size_t b, const Posed& posed);
    void placeSamples(std::size_t body, std::size_t patch, const Posed& posed);
    void broadphase(std::size_t body, std::size_t patch, std::size_t other, std::size_t otherPatch, const Posed& posed);
    bool narrowphase(std::size_t body, std::size_t sample, const Posed& posed, Meeting& out);
    void findGround(std::size_t body, const Posed& posed);
    void findMeetings(const Posed& posed);
    void keepDeepest();
    // flesh_forces.cpp
    [[nodiscard]] double softness(const Contact& contact) const;
    [[nodiscard]] Eigen::Matrix3d axesUnder(const Contact& contact) const;
    bool spread(Spread& out, const std::array<std::int32_t, 3>& corners, const Vec3& parts);
    void findRows(const Spread& spread, const std::array<std::int32_t, 3>& corners, const Vec3& parts);
    [[nodiscard]] Vec3 moved(const Spread& spread) const;
    void applyForce(const Spread& spread, const Vec3& force);
    void solve(const Posed& posed, int sweeps);
    bool sumForces();
    // flesh_contact.cpp
    bool once(const Posed& posed, std::size_t island, int sweeps);
    void release(std::size_t body);

    std::vector<Body> bodies_;
    std::vector<State> states_;
    std::vector<double> clearance_;  // bodies x bodies
    Near near_;
    Settings settings_;
    std::vector<std::size_t> island_, lastIsland_;  // per body: the lowest body of its island, in this step and in the last one
    std::vector<char> awake_, woken_;             // per island of the last step: one of it has moved; of this one: it is awake
    std::vector<std::size_t> members_;              // of the island that is solved
    std::vector<Meeting> meetings_;
    std::vector<Contact> contacts_;
    Eigen::ArrayXf rows_;
    std::uint64_t step_ = 0;
    bool converged_ = true;
};

}  // namespace imomushi
