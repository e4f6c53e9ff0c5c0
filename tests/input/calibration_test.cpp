// SPDX-License-Identifier: GPL-3.0-or-later
// What is found from a few poses.
#include "core/input/calibration.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/input/input_mapper.h"
#include "core/input/source_measure.h"
#include "tests/support/allocations.h"
#include "tests/support/input_values.h"

using namespace imomushi;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const Vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

using Turn = SaidAndMeant<Eigen::Quaterniond>;

Eigen::Quaterniond about(const Vec3& axis, double degrees) { return rotationOf(Vec3(degrees * kDegree * axis.normalized())); }

/// What becomes of a turn.
Eigen::Quaterniond corrected(const Correction& correction, const Eigen::Quaterniond& said) {
    const Vec3 v = rotationVector(said) / correction.radians;
    const std::array<double, 3> numbers = {v.x(), v.y(), v.z()};
    Vec3 made;
    for (int k = 0; k < 3; ++k) made[k] = correction.at(numbers, k) * correction.radians;
    return rotationOf(made);
}
double degreesOff(const Correction& correction, const Turn& pose) { return corrected(correction, pose.said).angularDistance(pose.meant) / kDegree; }

Vec3 placed(const Correction& correction, const Vec3& said) {
    const std::array<double, 3> numbers = {said.x(), said.y(), said.z()};
    return {correction.at(numbers, 0), correction.at(numbers, 1), correction.at(numbers, 2)};
}

}  // namespace

TEST_CASE("calibration: one pose of a turn is met exactly, whatever it is; what hangs on a parent turns from there about the axes of its parent") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1.5, 1.5);
    for (int i = 0; i < 100; ++i) {
        const Turn pose{rotationOf(Vec3(any(random), any(random), any(random))), rotationOf(Vec3(any(random), any(random), any(random)))};
        for (const bool inRoom : {false, true}) CHECK(degreesOff(fitTurn(std::array{pose}, inRoom), pose) < 1e-10);
    }
    // An arm hangs, which is how the character rests; raised by 30 degrees it is raised by 30 degrees.
    const Eigen::Quaterniond hangs = about(kZ, -75.0);
    const Correction arm = fitTurn(std::array{Turn{hangs, Eigen::Quaterniond::Identity()}}, false);
    for (const Vec3& axis : {kX, kY, kZ}) CHECK(corrected(arm, about(axis, 30.0) * hangs).angularDistance(about(axis, 30.0)) < 1e-9);
}

TEST_CASE("calibration: who stands turned and leans is put right by one pose, and every turn from there is the same turn") {
    for (const double yaw : {180.0, -90.0, 35.0, 0.0}) {
        const Eigen::Quaterniond turned = about(kY, yaw), leans = about(Vec3(1.0, 0.0, 0.3), 10.0);
        const Correction found = fitTurn(std::array{Turn{turned * leans, Eigen::Quaterniond::Identity()}}, true);
        for (const Vec3& axis : {kX, kY, kZ, Vec3(1, 2, 3)})
            for (const double angle : {-120.0, -20.0, 0.0, 5.0, 90.0}) CHECK(corrected(found, turned * about(axis, angle) * leans).angularDistance(about(axis, angle)) / kDegree < 1e-6);
    }
}

TEST_CASE("calibration: three poses of a turn tell both sides exactly, and every other turn; two are met both") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int i = 0; i < 50; ++i) {
        const Eigen::Quaterniond before = rotationOf(Vec3(any(random), any(random), any(random))), after = rotationOf(Vec3(any(random), any(random), any(random)));
        std::vector<Turn> poses;
        for (const Vec3& to : {Vec3(0, 0, 0), Vec3(0.9, 0.1, 0), Vec3(0.1, -0.2, 0.8)}) {
            const Eigen::Quaterniond said = rotationOf(to);
            poses.push_back({said, (before * said * after).normalized()});
        }
        const Correction all = fitTurn(poses, false);
        for (const Turn& pose : poses) CHECK(degreesOff(all, pose) < 1e-6);
        CHECK(all.before.angularDistance(before) < 1e-8);
        CHECK(all.gain == doctest::Approx(1.0).epsilon(1e-9));
        for (const Vec3& to : {Vec3(0.3, 0.4, -0.9), Vec3(-2.0, 0.5, 0.1)}) CHECK(degreesOff(all, {rotationOf(to), (before * rotationOf(to) * after).normalized()}) < 1e-5);
        const Correction two = fitTurn(std::span(poses).first(2), false);
        for (int k = 0; k < 2; ++k) CHECK(degreesOff(two, poses[static_cast<std::size_t>(k)]) < 1e-6);
    }
}

TEST_CASE("calibration: who turns farther than the character, or less far, gets a gain, which fades towards half a turn: nothing jumps there") {
    for (const double gain : {0.5, 1.0, 1.8}) {
        CAPTURE(gain);
        const Eigen::Quaterniond stands = about(kZ, -30.0), meant = about(kY, 15.0);
        const std::array poses = {Turn{stands, meant}, Turn{about(kX, 60.0) * stands, about(kX, 60.0 * gain) * meant}};
        const Correction found = fitTurn(poses, false);
        CHECK(found.gain == doctest::Approx(gain).epsilon(1e-9));
        for (const Turn& pose : poses) CHECK(degreesOff(found, pose) < 1e-6);
        CHECK(degreesOff(found, {about(kX, -30.0) * stands, about(kX, -30.0 * gain) * meant}) < 1e-6);
        Eigen::Quaterniond before = corrected(found, stands);
        double most = 0.0, all = 0.0;
        for (int degree = 1; degree <= 360; ++degree) {
            const Eigen::Quaterniond now = corrected(found, about(kX, degree) * stands);
            const double step = now.angularDistance(before) / kDegree;
            most = std::max(most, step);
            all += step;
            before = now;
        }
        CHECK(all == doctest::Approx(360.0).epsilon(1e-6));
        CHECK(most < 1.9);
    }
    // Beyond what is sane it is not followed.
    const std::array wild = {Turn{Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()}, Turn{about(kX, 10.0), about(kX, 90.0)}};
    CHECK(fitTurn(wild, false).gain == kLargestTurnGain);
    CHECK(degreesOff(fitTurn(wild, false), wild[1]) == doctest::Approx(25.0).epsilon(1e-6));
}

TEST_CASE("calibration: what trembles leaves a residual of its size, in each pose") {
    std::mt19937 random(3);
    std::normal_distribution<double> trembles(0.0, 1.0 * kDegree);
    const Eigen::Quaterniond before = about(Vec3(1, 3, 0), 60.0), after = about(kX, -40.0);
    double largest = 0.0, mean = 0.0;
    constexpr int kTimes = 100;
    for (int i = 0; i < kTimes; ++i) {
        std::vector<Turn> poses;
        for (const Vec3& to : {Vec3(0, 0, 0), Vec3(1.2, 0, 0), Vec3(0, 0, 1.2)}) {
            const Eigen::Quaterniond said = rotationOf(to);
            poses.push_back({(rotationOf(Vec3(trembles(random), trembles(random), trembles(random))) * said).normalized(), (before * said * after).normalized()});
        }
        const Correction found = fitTurn(poses, false);
        for (const Turn& pose : poses) {
            largest = std::max(largest, degreesOff(found, pose));
            mean += degreesOff(found, pose) / (3 * kTimes);
        }
        CHECK(found.before.angularDistance(before) / kDegree < 8.0);
    }
    CHECK(largest < 5.0);
    CHECK(mean > 0.3);
    CHECK(mean < 1.5);
}

TEST_CASE("calibration: poses of a turn that hardly differ tell no more than one, and their residual says so") {
    const Eigen::Quaterniond said = about(kZ, 40.0);
    // It says the same in both, which should be 20 degrees apart.
    const std::array alike = {Turn{said, Eigen::Quaterniond::Identity()}, Turn{about(kX, 1.0) * said, about(kX, 20.0)}};
    const Correction found = fitTurn(alike, false);
    CHECK(found.before.angularDistance(Eigen::Quaterniond::Identity()) == 0.0);
    CHECK(degreesOff(found, alike[0]) == doctest::Approx(9.5).epsilon(1e-3));
    CHECK(degreesOff(found, alike[1]) == doctest::Approx(9.5).epsilon(1e-3));
    // It differs where it should not: the same.
    const std::array still = {Turn{Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()}, Turn{about(kX, 30.0), Eigen::Quaterniond::Identity()}};
    CHECK(fitTurn(still, false).before.angularDistance(Eigen::Quaterniond::Identity()) == 0.0);
    CHECK(degreesOff(fitTurn(still, false), still[1]) == doctest::Approx(15.0).epsilon(1e-6));
}

TEST_CASE("calibration: a place is moved by one pose, scaled and turned by two and three; what is no such motion leaves a residual") {
    const auto meant = [](const Vec3& said) { return Vec3(1.7 * (about(kY, 130.0) * said) + Vec3(0.1, -0.4, 2.0)); };
    const std::vector<Vec3> said = {{0.1, 0.9, 0.2}, {0.6, 1.1, -0.3}, {-0.4, 1.5, 0.1}};
    std::vector<SaidAndMeant<Vec3>> poses;
    for (const Vec3& s : said) poses.push_back({s, meant(s)});
    const Vec3 elsewhere(0.3, 0.3, 0.3);
    CHECK((placed(fitPlace(std::span(poses).first(1), Eigen::Quaterniond::Identity(), 0.02), said[0]) - meant(said[0])).norm() < 1e-12);
    for (const std::size_t count : {2, 3}) {
        const Correction found = fitPlace(std::span(poses).first(count), Eigen::Quaterniond::Identity(), 0.02);
        CHECK(found.gain == doctest::Approx(1.7).epsilon(1e-12));
        CHECK((placed(found, elsewhere) - meant(elsewhere)).norm() < 1e-12);
    }
    poses[2].meant += Vec3(0.0, 0.09, 0.0);
    const Correction near = fitPlace(poses, Eigen::Quaterniond::Identity(), 0.02);
    double off = 0.0;
    for (const auto& pose : poses) off = std::max(off, (placed(near, pose.said) - pose.meant).norm());
    CHECK(off > 0.01);
    CHECK(off < 0.09);
    // One turned half round, who says so, goes to its left where the character does.
    const Correction turned = fitPlace(std::array{SaidAndMeant<Vec3>{{0.0, 1.0, 0.0}, {0.0, 1.0, 0.0}}}, about(kY, 180.0), 0.02);
    CHECK((placed(turned, Vec3(-0.5, 1.0, 0.0)) - Vec3(0.5, 1.0, 0.0)).norm() < 1e-12);
}

TEST_CASE("calibration: places that hardly differ, said or meant, are moved and not scaled") {
    for (const auto& [said, meant] : {std::pair(0.001, 0.8), std::pair(0.8, 0.0), std::pair(0.0, 0.0)}) {
        const std::array poses = {SaidAndMeant<Vec3>{{0, 0, 0}, {1, 1, 1}}, SaidAndMeant<Vec3>{{said, 0, 0}, {1.0 + meant, 1, 1}}};
        const Correction found = fitPlace(poses, Eigen::Quaterniond::Identity(), 0.02);
        CHECK(found.gain == 1.0);
        CHECK((placed(found, Vec3(0.5 * said, 0, 0)) - Vec3(1.0 + 0.5 * meant, 1, 1)).norm() < 1e-12);
    }
}

TEST_CASE("calibration: a number is moved by one pose, and gets a gain by two and three, within what is sane") {
    const auto at = [](const Correction& c, double number) { return c.at(std::array{9.0, number}, 1); };
    const auto fit = [](std::vector<SaidAndMeant<double>> poses) {
        Correction made = fitNumber(poses, 0.05);
        made.first = 1;
        return made;
    };
    CHECK(at(fit({{0.13, 0.0}}), 0.13) == 0.0);
    CHECK(at(fit({{0.13, 0.0}}), 0.5) == doctest::Approx(0.37));
    CHECK(at(fit({{0.1, 0.0}, {0.6, 1.0}}), 0.35) == doctest::Approx(0.5));
    CHECK(at(fit({{0.6, 0.0}, {0.1, 1.0}}), 0.35) == doctest::Approx(0.5));  // it says it the other way round
    const Correction three = fit({{0.0, 0.0}, {0.5, 0.4}, {1.0, 1.0}});
    CHECK(three.gain == doctest::Approx(1.0));
    CHECK(at(three, 0.5) == doctest::Approx(0.46667).epsilon(1e-4));
    CHECK(fit({{0.0, 0.0}, {0.06, 50.0}}).gain == kLargestGain);
    CHECK(fit({{0.50, 0.0}, {0.53, 1.0}}).gain == 1.0);  // that is no difference
    CHECK(at(fit({{0.1, 0.0}}), 0.1) == 0.0);
    // Other numbers of the channel are left alone.
    CHECK(fit({{0.6, 0.0}}).at(std::array{9.0, 0.7}, 0) == 9.0);
}

TEST_CASE("calibration: what a curve made goes back to what was said, to its middle in the dead zone and to its ends beyond") {
    for (const ResponseCurve& c : {ResponseCurve{-1.0, 1.0, -0.2, 0.4, 2.0, 0.1}, ResponseCurve{0.2, 0.9, 1.0, -1.0, 0.5, 0.2}, ResponseCurve{-2.0, 1.0, 0.0, 6.0}})
        for (int i = 0; i <= 20; ++i) {
            const double out = c.outLow + i / 20.0 * (c.outHigh - c.outLow);
            CHECK(c.at(c.back(out)) == doctest::Approx(out).epsilon(1e-9));
        }
    const ResponseCurve stick{-1.0, 1.0, -0.2, 0.4, 2.0, 0.1};
    CHECK(stick.back(0.1) == 0.0);
    CHECK(stick.back(7.0) == 1.0);
    CHECK(stick.back(-7.0) == -1.0);
    CHECK(ResponseCurve{0.3, 1.0, 2.0, 2.0}.back(2.0) == 0.3);
}

TEST_CASE("mapper: rows are given what their correction makes of all three numbers, before their curves, without memory; meters say what was said") {
    std::vector<InputRow> rows;
    for (int k = 0; k < 3; ++k) {
        InputRow row;
        row.source = "body";
        row.channel = "bone/Hips";
        row.component = 7 + k;
        row.slot = k;
        row.correction = 0;
        row.curve = {-std::numbers::pi, std::numbers::pi, -std::numbers::pi, std::numbers::pi};
        rows.push_back(row);
    }
    const Eigen::Quaterniond leans = about(kX, 10.0), turned = about(kY, 180.0);
    Correction found = fitTurn(std::array{Turn{turned * leans, Eigen::Quaterniond::Identity()}}, true);
    found.first = 7;
    const std::array<double, 3> zero{};
    InputMapper m(rows, zero, zero, {found});
    const auto says = [&](const Eigen::Quaterniond& q) {
        const Vec3 v = rotationVector(q);
        return valueOf("body", "bone/Hips", {0, 1, 0, q.x(), q.y(), q.z(), q.w(), v.x(), v.y(), v.z()});
    };
    const InputValue stands = says(turned * leans), bows = says(turned * about(kX, 30.0) * leans);
    const auto shows = [&] { return Vec3(m.shown(0), m.shown(1), m.shown(2)); };
    CHECK(m.take(stands));
    for (int i = 0; i < 60; ++i) m.step(1.0 / 60.0);
    CHECK(shows().norm() < 1e-9);
    const std::size_t before = allocations();
    const bool taken = m.take(bows);
    m.step(1.0 / 60.0);
    const std::size_t after = allocations();
    CHECK(taken);
    CHECK(after == before);
    CHECK((shows() - Vec3(30.0 * kDegree, 0, 0)).norm() < 1e-9);
    CHECK(m.meterOf(1).raw == bows.numbers[8]);
}

TEST_CASE("measure: the numbers of each channel on average, rotations as rotations; what is not said again counts as it was, other sources and what is plugged out do not") {
    SourceMeasure measure("body");
    const auto pose = [](const Eigen::Quaterniond& q, double sign) {
        const Vec3 v = rotationVector(q);
        return valueOf("body", "bone/Hips", {0.5, 1, 0, sign * q.x(), sign * q.y(), sign * q.z(), sign * q.w(), v.x(), v.y(), v.z()});
    };
    measure.knew(valueOf("body", "fader", {0.25}));
    measure.knew(valueOf("body", "blend/A", {0.9}));
    measure.knew(valueOf("face", "blend/B", {0.9}));
    measure.knew(valueOf("body", "button", {1.0}));
    CHECK(measure.heard() == 0);
    // Half a turn, a little more and a little less: rotation vectors point to both sides, and quaternions have either sign.
    for (int i = 0; i < 10; ++i) {
        measure.hear(pose(about(kY, i % 2 ? 178.0 : 182.0), i % 3 ? 1.0 : -1.0));
        measure.hear(valueOf("body", "blend/A", {i % 2 ? 0.1 : 0.3}));
        measure.hear(valueOf("face", "blend/A", {0.7}));
    }
    InputValue gone = valueOf("body", "button", {0.0});
    gone.gone = true;
    measure.hear(gone);
    CHECK(measure.heard() == 20);
    const auto means = measure.means();
    REQUIRE(means.size() == 3);
    CHECK(means.at("fader") == std::vector{0.25});
    CHECK(means.at("blend/A")[0] == doctest::Approx(0.2));
    const std::vector<double>& hips = means.at("bone/Hips");
    CHECK(hips[0] == 0.5);
    const Eigen::Quaterniond q(hips[6], hips[3], hips[4], hips[5]);
    CHECK(std::abs(q.norm() - 1.0) < 1e-12);
    CHECK(q.angularDistance(about(kY, 180.0)) < 1e-6);
    CHECK(rotationOf(Vec3(hips[7], hips[8], hips[9])).angularDistance(q) < 1e-6);
}
