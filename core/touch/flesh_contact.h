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
#include "core/touch/contact_solve.h"
#include "core/touch/contact_surface.h"

namespace imomushi {

/// Flesh that meets flesh: elements press on each other, and on themselves, through their patches (TouchResponse): unilateral, with Coulomb's friction, without
/// inertia. Samples of one surface keep outside of the others; forces act at them, and against them where they press, spread over the patches there.
/// Where surfaces meet is found on those that the pose alone leaves: a linear problem for each step, which starts from the forces of the last one. Flesh
/// that is pressed farther than dents are linear still crosses. What touches at rest does not press. Built once; per frame it neither allocates, locks nor
/// fails, and the same calls give the same bytes.
class FleshContact {
public:
    struct Body {
        std::shared_ptr<const ContactSurface> surface;
        double shear = 1.0;  ///< relative shear modulus
    };
    struct Settings {
        double friction = 0.5;    ///< Coulomb's coefficient
        Plane ground{};  ///< that bodies of Near::grounded do not sink through
        double groundFriction = 0.6;
        double mostStrain = 0.95;  ///< largest displacement gradient (Frobenius) that contact makes in an element
    };
    /// Those that may meet.
    struct Near {
        std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< of bodies, the lower first; of a body with itself too
        std::vector<std::size_t> grounded;                       ///< the ground
        [[nodiscard]] bool none() const { return pairs.empty() && grounded.empty(); }
    };
    /// Contacts of one step, at most; further ones are left out.
    static constexpr std::size_t kMost = 768;

    explicit FleshContact(std::vector<Body> bodies);

    /// Where the pose alone has the bodies.
    class Posed {
    public:
        virtual ~Posed() = default;
        [[nodiscard]] virtual Vec3 at(std::size_t body, std::int32_t vertex) const = 0;  ///< m, world
        [[nodiscard]] virtual const Eigen::Matrix3d& axes(std::size_t body) const = 0;   ///< rest to world, a rotation
    };
    /// Whether two bodies may meet where their patches have these middles (3 x P, m, world).
    [[nodiscard]] bool areNear(std::size_t a, const Eigen::Matrix3Xd& middlesOfA, std::size_t b, const Eigen::Matrix3Xd& middlesOfB) const;
    [[nodiscard]] bool isNearGround(std::size_t body, const Eigen::Matrix3Xd& middles, const Plane& ground) const;
    /// Two surfaces that have turned against each other by less (radians), and moved by less than half of their restClearance(), do not meet.
    static constexpr double kMostTurn = 0.5;
    /// m: at rest, no samples of the two that such a turn may oppose to each other are nearer. Infinite: there are none.
    [[nodiscard]] double restClearance(std::size_t a, std::size_t b) const { return clearance_[a * bodies_.size() + b]; }

    /// One step. settle: until nothing moves, about.
    void step(const Posed& posed, const Near& near, const Settings& settings, bool settle);
    /// Nothing presses.
    void reset();

    /// Over its shear modulus, in its rest axes, 3 P, m^2.
    [[nodiscard]] const Eigen::VectorXd& patchForces(std::size_t body) const { return states_[body].forces; }
    [[nodiscard]] bool idle() const;
    /// The last step changed nothing that shows.
    [[nodiscard]] bool settled() const { return settled_; }
    /// All contact forces on a body together, world, m^2 in units of a shear modulus of 1.
    [[nodiscard]] Vec3 force(std::size_t body) const { return states_[body].force; }
    /// m: how deep the deepest sample is inside of another surface by the pose alone.
    [[nodiscard]] double deepest() const { return deepest_; }
    [[nodiscard]] std::size_t contacts() const { return contacts_.size(); }
    [[nodiscard]] std::size_t bytes() const;

private:
    static constexpr std::size_t kGround = static_cast<std::size_t>(-1);  ///< in place of a body: it gives no way, and its axes are the world's
    static constexpr std::size_t kWidth = 24;        ///< patches under one point, at most
    static constexpr std::size_t kMostPatches = 96;  ///< of one body that are pressed in a step

    /// What a sample knows from its last contact.
    struct Memory {
        std::uint64_t step = 0;   // 0: it had none
        std::size_t other = 0;    // it pressed on this body
        TouchSurface::Point held; // where, of the flesh, while it sticks
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
        Eigen::VectorXd forces, before;        // 3 P
        std::vector<std::int32_t> pressed;     // patches with forces
        std::vector<std::int32_t> active;      // patches of this step
        std::vector<std::int32_t> slot;        // per patch, its place among them, -1: none
        Eigen::Matrix3Xd sums;                 // per active patch: its force, world
        std::vector<Memory> memory;            // per sample
        std::vector<Candidate> candidates;     // per sample
        std::vector<std::size_t> met;          // samples with a candidate
        std::vector<Vertex> vertices;          // of the body
        std::vector<std::vector<char>> muted;  // per body, per sample, 1: it touches that one at rest; empty: none does
        double softness = 0.0;                 // m / m^2
        Vec3 force = Vec3::Zero();
    };
    /// A point of a body under which patches lie.
    struct Spread {
        std::size_t body = 0, count = 0;
        std::array<std::int32_t, kWidth> slot{};
        std::array<double, kWidth> weight{};
        std::size_t rows = 0;  // in rows_: a block of three by three per active patch of the body, world
    };
    struct Contact : ContactPoint {
        std::size_t sample = 0;
        TouchSurface::Point at;      // of the other body; distance: of the sample from it, along the normal
        Vec3 apart = Vec3::Zero();   // of the sample from there, by the pose alone, m, world; of the ground: from below its origin
        Spread on, under;
        Eigen::Matrix3d compliance = Eigen::Matrix3d::Zero();
    };

    const Vec3& vertexAt(std::size_t body, std::int32_t vertex, const Posed& posed);
    const Vec3& normalAt(std::size_t body, std::int32_t vertex, const Posed& posed);
    void findCandidates(std::size_t a, std::size_t b, const Posed& posed);
    void look(std::size_t body, std::size_t patch, std::size_t other, std::size_t otherPatch, const Posed& posed);
    bool meet(std::size_t body, std::size_t sample, const Posed& posed, Contact& out);
    void meetGround(std::size_t body, const Posed& posed, const Plane& ground);
    void findContacts(const Near& near, const Posed& posed, const Plane& ground);
    [[nodiscard]] double softness(const Contact& contact) const;
    [[nodiscard]] Eigen::Matrix3d axesUnder(const Contact& contact, const Posed& posed) const;
    bool spread(Spread& out, const std::array<std::int32_t, 3>& corners, const Vec3& parts);
    void findRows(Spread& spread, const std::array<std::int32_t, 3>& corners, const Vec3& parts, const Eigen::Matrix3d& axes);
    [[nodiscard]] Vec3 moved(const Spread& spread) const;
    void push(const Spread& spread, const Vec3& force);
    void solve(const Posed& posed, const Settings& settings, int sweeps);
    void sumForces(const Posed& posed, const Settings& settings);
    void once(const Posed& posed, const Near& near, const Settings& settings, int sweeps);

    std::vector<Body> bodies_;
    std::vector<State> states_;
    std::vector<double> clearance_;  // bodies x bodies
    std::vector<Contact> contacts_;
    std::vector<float> rows_;
    std::uint64_t step_ = 0;
    bool settled_ = true;
    double deepest_ = 0.0;
};

}  // namespace imomushi
