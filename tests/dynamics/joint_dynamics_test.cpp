// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/joint_dynamics.h"

#include <doctest/doctest.h>

#include <Eigen/LU>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/dynamics/explicit_joint_dynamics.h"
#include "core/skeleton/bone_tree.h"
#include "tests/support/allocations.h"

using namespace imomushi;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd randomMatrix(std::mt19937& random, int rows, int columns) {
    std::normal_distribution<double> d;
    MatrixXd m(rows, columns);
    for (int c = 0; c < columns; ++c)
        for (int r = 0; r < rows; ++r) m(r, c) = d(random);
    return m;
}

// g parameters of which `rigid` combinations have no stiffness.
JointDynamics::Input randomInput(int seed, int g, int rigid, double hertz = 3.0, double damping = 0.1) {
    std::mt19937 random(seed);
    JointDynamics::Input input;
    const MatrixXd m = randomMatrix(random, g, 2 * g), k = randomMatrix(random, g, g - rigid);
    input.mass = m * m.transpose();
    input.stiffness = k * k.transpose();
    input.hertz = hertz;
    input.damping = damping;
    return input;
}

VectorXd pathOf(int g, double time) {
    VectorXd v(g);
    for (int i = 0; i < g; ++i) v[i] = std::sin(4.0 * time + i) * 0.3;
    return v;
}

}  // namespace

TEST_CASE("joint dynamics: the modes carry the mass and the stiffness, the softest at the frequency that was asked for") {
    const auto input = randomInput(1, 10, 3, 2.5);
    const auto dynamics = JointDynamics::build(input).value();
    REQUIRE(dynamics.frequencies().size() == 7);
    CHECK(dynamics.frequencies()[0] == doctest::Approx(2.5));
    // Ratios of squared frequencies are those of K and M alone: their trace over det-free invariants agree.
    const MatrixXd scaled = input.mass.inverse() * input.stiffness;
    const double traces = scaled.trace(), sum = dynamics.frequencies().cwiseAbs2().sum();
    const double squares = (scaled * scaled).trace(), sumOfSquares = dynamics.frequencies().cwiseAbs2().cwiseAbs2().sum();
    CHECK(sum * sum / sumOfSquares == doctest::Approx(traces * traces / squares).epsilon(1e-6));
}

TEST_CASE("joint dynamics: one parameter swings as an oscillator does, exactly, for any damping and any frame") {
    for (const double damping : {0.0, 0.1, 1.0 - 1e-12, 1.0, 1.0 + 1e-9, 3.0, 10.0}) {
        JointDynamics::Input input;
        input.mass = MatrixXd::Constant(1, 1, 2.0);
        input.stiffness = MatrixXd::Constant(1, 1, 5.0);
        input.hertz = 1.5;
        input.damping = damping;
        for (const double frame : {1e-3, 1.0 / 60.0, 0.3, 2.0}) {
            auto dynamics = JointDynamics::build(input).value();
            dynamics.reset(VectorXd::Zero(1));
            // The target runs away at 1 per second: y' = -1 at the start.
            const double end = 4.0;
            const int frames = static_cast<int>(std::lround(end / frame));
            for (int i = 1; i <= frames; ++i) dynamics.step(end / frames, VectorXd::Constant(1, end * i / frames));
            // Against many small steps of a method of fourth order.
            const double omega = 2.0 * M_PI * 1.5;
            double y = 0.0, rate = -1.0;
            const int steps = 40000;
            const double h = end / steps;
            const auto slope = [&](double a, double b) { return -2.0 * damping * omega * b - omega * omega * a; };
            for (int i = 0; i < steps; ++i) {
                const double k1 = rate, l1 = slope(y, rate), k2 = rate + 0.5 * h * l1, l2 = slope(y + 0.5 * h * k1, k2);
                const double k3 = rate + 0.5 * h * l2, l3 = slope(y + 0.5 * h * k2, k3), k4 = rate + h * l3, l4 = slope(y + h * k3, k4);
                y += h * (k1 + 2 * k2 + 2 * k3 + k4) / 6.0;
                rate += h * (l1 + 2 * l2 + 2 * l3 + l4) / 6.0;
            }
            CAPTURE(damping);
            CAPTURE(frame);
            CHECK(std::abs(dynamics.parameters()[0] - end - y) < 1e-9);
        }
    }
}

TEST_CASE("joint dynamics: 30, 60 and 144 frames per second move alike within 2 % of the jiggle of a soft joint, 0.3 % of the motion of a stiff one") {
    for (const bool soft : {true, false}) {
        const int g = soft ? 1 : 8;
        std::vector<std::vector<VectorXd>> seen;
        for (const int rate : {1200, 30, 60, 144}) {
            auto dynamics = JointDynamics::build(soft ? randomInput(2, g, 0, 1.0) : randomInput(2, g, 2)).value();
            dynamics.reset(pathOf(g, 0.0));
            std::vector<VectorXd> at;
            for (int i = 1; i <= 3 * rate; ++i) {
                dynamics.step(1.0 / rate, pathOf(g, static_cast<double>(i) / rate));
                if (i % (rate / 6) == 0) at.push_back(dynamics.parameters());
            }
            seen.push_back(at);
        }
        double jiggle = 0.0, motion = 0.0, worst = 0.0;
        for (std::size_t k = 0; k < seen[0].size(); ++k) {
            jiggle = std::max(jiggle, (seen[0][k] - pathOf(g, static_cast<double>(k + 1) / 6.0)).norm());
            motion = std::max(motion, seen[0][k].norm());
            for (std::size_t r = 1; r < seen.size(); ++r) worst = std::max(worst, (seen[r][k] - seen[0][k]).norm());
        }
        REQUIRE(jiggle > 0.02 * motion);
        // Where frames cut the corners of the targets, they cut (1/30 s)^2 / 8 of their acceleration: 0.2 % here.
        CHECK(worst < (soft ? 0.02 * jiggle : 0.003 * motion));
    }
}

TEST_CASE("joint dynamics: rigid motions follow the targets, at rest everything is the target bit for bit, and sleeps") {
    const int g = 7;
    const auto input = randomInput(3, g, 2);
    auto dynamics = JointDynamics::build(input).value();
    dynamics.reset(VectorXd::Zero(g));
    const Eigen::MatrixXd rigid = input.stiffness.fullPivLu().kernel();
    REQUIRE(rigid.cols() == 2);
    dynamics.step(0.01, rigid.col(0));
    CHECK((dynamics.parameters() - rigid.col(0)).norm() < 1e-6 * rigid.col(0).norm());
    const VectorXd target = pathOf(g, 1.0);
    dynamics.step(0.01, target);
    CHECK((dynamics.parameters() - target).norm() > 0.01);
    int frames = 0;
    double before = 1e300;
    for (; frames < 3000 && !dynamics.resting(); ++frames) {
        dynamics.step(1.0 / 60.0, target);
        CHECK(dynamics.energy() <= before);
        before = dynamics.energy();
    }
    CHECK(dynamics.resting());
    CHECK(dynamics.parameters() == target);
}

TEST_CASE("joint dynamics: each mode is damped by what is stored in it, and by the ratio alone where all of it is damped alike") {
    // Two parameters of their own, of which the second is damped four times as much.
    JointDynamics::Input input;
    input.mass = MatrixXd::Identity(2, 2);
    input.stiffness = Eigen::Vector2d(1.0, 9.0).asDiagonal();
    input.damped = Eigen::Vector2d(1.0, 36.0).asDiagonal();
    input.hertz = 2.0;
    input.damping = 0.1;
    auto both = JointDynamics::build(input).value();
    const auto alone = [](double hertz, double damping) {
        JointDynamics::Input one;
        one.mass = one.stiffness = MatrixXd::Identity(1, 1);
        one.hertz = hertz;
        one.damping = damping;
        return JointDynamics::build(one).value();
    };
    auto first = alone(2.0, 0.1), second = alone(6.0, 0.4);
    for (int i = 1; i <= 90; ++i) {
        const VectorXd target = pathOf(2, i / 60.0);
        both.step(1.0 / 60.0, target);
        first.step(1.0 / 60.0, target.head(1));
        second.step(1.0 / 60.0, target.tail(1));
        CHECK(both.parameters()[0] == doctest::Approx(first.parameters()[0]).epsilon(1e-9));
        CHECK(both.parameters()[1] == doctest::Approx(second.parameters()[0]).epsilon(1e-9));
    }
    input = randomInput(4, 8, 2);
    auto plain = JointDynamics::build(input).value();
    input.damped = input.stiffness;
    auto same = JointDynamics::build(input).value();
    for (int i = 1; i <= 30; ++i) {
        plain.step(1.0 / 60.0, pathOf(8, i / 60.0));
        same.step(1.0 / 60.0, pathOf(8, i / 60.0));
        CHECK(plain.parameters() == same.parameters());
    }
}

TEST_CASE("joint dynamics: a steady force shifts the parameters by stiffness^-1 of it") {
    JointDynamics::Input input;
    input.mass = MatrixXd::Constant(1, 1, 2.0);
    input.stiffness = MatrixXd::Constant(1, 1, 7.0);
    input.hertz = 1.0;
    input.damping = 1.0;
    auto dynamics = JointDynamics::build(input).value();
    for (int i = 0; i < 600; ++i) dynamics.step(1.0 / 60.0, VectorXd::Zero(1), VectorXd::Constant(1, 3.0));
    CHECK(dynamics.parameters()[0] == doctest::Approx(3.0 / (2.0 * std::pow(2.0 * M_PI, 2))).epsilon(1e-6));
    for (int i = 0; i < 600; ++i) dynamics.step(1.0 / 60.0, VectorXd::Zero(1));
    CHECK(dynamics.resting());
    CHECK(dynamics.parameters()[0] == 0.0);
}

TEST_CASE("joint dynamics: a million random steps at the limits stay finite and come back to rest, without allocating") {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    std::size_t asked = 0;
    for (int scene = 0; scene < 100; ++scene) {
        const int g = 1 + scene % 6;
        auto input = randomInput(scene, g, scene % 2 && g > 2 ? 1 : 0, std::pow(10.0, -2.0 + 5.0 * (scene % 11) / 10.0), 10.0 * (scene % 7) / 6.0);
        auto dynamics = JointDynamics::build(input).value();
        VectorXd target = VectorXd::Zero(g), force = VectorXd::Zero(g);
        const std::size_t before = allocations();
        for (int i = 0; i < 10000; ++i) {
            for (int k = 0; k < g; ++k) target[k] += d(random), force[k] = 10.0 * d(random);
            dynamics.step(std::pow(10.0, 3.0 * d(random) - 2.0), target, force);
            REQUIRE(allFinite(dynamics.parameters()));
        }
        if (input.damping > 0.0) {
            for (int i = 0; i < 400 && !dynamics.resting(); ++i) dynamics.step(1e3, target);
            CHECK(dynamics.resting());
        }
        asked += allocations() - before;
    }
    CHECK(asked == 0);
}

TEST_CASE("joint dynamics: bad input is refused, with a reason when building") {
    const auto good = randomInput(4, 4, 1);
    const auto refused = [](const JointDynamics::Input& input) {
        const auto built = JointDynamics::build(input);
        return !built && built.error().code == "bad-value";
    };
    auto input = good;
    input.mass(1, 1) = 0.0;
    CHECK(refused(input));
    input = good;
    input.stiffness(0, 1) += 1.0;
    CHECK(refused(input));
    input = good;
    input.stiffness = -input.stiffness;
    CHECK(refused(input));
    input = good;
    input.stiffness.setZero();
    CHECK(refused(input));
    input = good;
    input.mass(0, 0) = std::numeric_limits<double>::quiet_NaN();
    CHECK(refused(input));
    input = good;
    input.hertz = 0.0;
    CHECK(refused(input));
    CHECK(refused({}));

    auto dynamics = JointDynamics::build(good).value();
    dynamics.step(0.01, VectorXd::Ones(4));
    const VectorXd last = dynamics.parameters();
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
        dynamics.step(0.01, VectorXd::Constant(4, bad));
        CHECK(dynamics.refused());
        CHECK(dynamics.parameters() == last);
    }
    dynamics.step(std::numeric_limits<double>::quiet_NaN(), VectorXd::Ones(4));
    CHECK(dynamics.refused());
    dynamics.step(0.01, VectorXd::Ones(3));
    CHECK(dynamics.refused());
    dynamics.step(0.01, VectorXd::Ones(4));
    CHECK(!dynamics.refused());
}

TEST_CASE("explicit joint dynamics: below the stable step it swings at the stiffness' frequency, above it divergence is noticed and survived") {
    const double stiffness = 400.0, mass = 4.0, omega = std::sqrt(stiffness / mass);
    const auto springs = [&](const VectorXd& u, VectorXd& force) { force = -stiffness * u; };
    for (const double part : {0.05, 0.9, 1.05, 3.0}) {
        CAPTURE(part);
        ExplicitJointDynamics::Input input;
        input.mass = VectorXd::Constant(3, mass);
        input.damping = 0.0;
        input.seconds = part * 2.0 / omega;
        auto dynamics = ExplicitJointDynamics::build(input).value();
        dynamics.reset(VectorXd::Constant(3, 0.1));
        bool diverged = false;
        double crossed = 0.0, before = 0.1, time = 0.0;
        for (int i = 0; i < 600; ++i) {
            diverged = !dynamics.step(input.seconds, springs) || diverged;
            time += input.seconds;
            REQUIRE(allFinite(dynamics.displacement()));
            REQUIRE(dynamics.displacement().cwiseAbs().maxCoeff() <= 10.0);
            if (crossed == 0.0 && dynamics.displacement()[0] < 0.0) {
                const double now = dynamics.displacement()[0];
                crossed = time - input.seconds * now / (now - before);
            }
            before = dynamics.displacement()[0];
        }
        CHECK(diverged == (part > 1.0));
        CHECK((dynamics.divergences() > 0) == (part > 1.0));
        if (part < 0.1) CHECK(crossed == doctest::Approx(0.5 * M_PI / omega).epsilon(0.06));  // half a step of the first velocity
    }
}

TEST_CASE("explicit joint dynamics: motions that bones hold do not happen, forces that are not finite are survived") {
    ExplicitJointDynamics::Input input;
    input.mass = VectorXd::LinSpaced(6, 1.0, 2.0);
    input.held = MatrixXd::Zero(6, 3);
    for (int i = 0; i < 6; ++i) input.held(i, i % 3) = 1.0;  // two vertices: shifts of both
    auto dynamics = ExplicitJointDynamics::build(input).value();
    const auto push = [](const VectorXd& u, VectorXd& force) {
        force = -10.0 * u;
        force[0] += 5.0;
    };
    for (int i = 0; i < 60; ++i) REQUIRE(dynamics.step(1.0 / 60.0, push));
    CHECK(dynamics.displacement().cwiseAbs().maxCoeff() > 0.01);
    const VectorXd momentum = input.held.transpose() * input.mass.cwiseProduct(dynamics.displacement());
    CHECK(momentum.cwiseAbs().maxCoeff() < 1e-12);

    const VectorXd last = dynamics.displacement();
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
        CHECK(!dynamics.step(1.0 / 60.0, [&](const VectorXd&, VectorXd& force) { force.setConstant(bad); }));
        CHECK(dynamics.displacement() == last);
        CHECK(dynamics.velocity().isZero(0.0));
    }
    CHECK(!dynamics.step(1.0 / 60.0, [&](const VectorXd&, VectorXd& force) { force.resize(2); }));
    CHECK(dynamics.step(1.0 / 60.0, push));
    CHECK(dynamics.divergences() == 4);
    input.mass[2] = 0.0;
    CHECK(!ExplicitJointDynamics::build(input));
}
