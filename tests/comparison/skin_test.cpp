// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/skin.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <stop_token>

#include "tests/support/allocations.h"
#include "tests/support/deformer_cases.h"

using namespace imomushi;

namespace {

const std::string kFolder = IMOMUSHI_TEST_DATA "/reference";
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr SkinKind kKinds[] = {SkinKind::LinearBlend, SkinKind::DualQuaternion, SkinKind::Spline};

const DeformerCase& bend90() {
    static const DeformerCase made = bentCylinder(kFolder, 90.0 * kDegree);
    return made;
}

SkinWeights weightsOf(const DeformerCase& c, bool automatic) {
    return automatic ? automaticWeights(c.surface, c.input.skeleton, {}).value() : rampWeights(c.surface, c.input.skeleton, 0.0).value();
}

Points positions(const Skin& skin) {
    return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(skin.positions(), skin.vertices(), 3).cast<double>();
}

Points deformed(const DeformerCase& c, SkinKind kind, const SkinWeights& weights, const Pose& pose) {
    auto skin = Skin::build(c.surface, c.input.skeleton, weights, kind).value();
    skin.update(pose);
    return positions(skin);
}

DeformationMeasures measured(const DeformerCase& c, SkinKind kind, bool automatic) {
    return measureDeformation(c, deformed(c, kind, weightsOf(c, automatic), c.pose));
}

}  // namespace

TEST_CASE("skin body: one closed surface over all elements, hidden vertices beside seen ones") {
    for (const auto& c : {bend90(), deformerCase(kFolder, "branch")}) {
        const auto& body = c.surface;
        // Euler: a closed surface without handles.
        std::vector<char> seen(static_cast<std::size_t>(body.vertices.rows()), 0);
        for (Eigen::Index i = 0; i < body.triangles.size(); ++i) seen[body.triangles.data()[i]] = 1;
        const auto vertices = std::count(seen.begin(), seen.end(), 1);
        CHECK(body.triangles.rows() == 2 * vertices - 4);
        for (std::size_t v = 0; v < seen.size(); ++v) {
            CHECK(body.same[v] <= static_cast<std::int32_t>(v));
            CHECK(seen[body.weightOf[v]] == 1);
            if (seen[v]) CHECK(body.weightOf[v] == static_cast<std::int32_t>(v));
        }
    }
    CHECK(bend90().surface.triangles.rows() == 2 * 3698 - 4);  // the whole cylinder
}

TEST_CASE("skin weights: positive, sum 1, descending, and the same on both sides of a seam") {
    for (const auto& c : {bend90(), deformerCase(kFolder, "branch"), deformerCase(kFolder, "S-bend")})
        for (const bool automatic : {false, true}) {
            CAPTURE(c.name);
            CAPTURE(automatic);
            const auto w = weightsOf(c, automatic);
            REQUIRE(w.vertices.size() == static_cast<std::size_t>(c.surface.vertices.rows()));
            for (std::size_t v = 0; v < w.vertices.size(); ++v) {
                float sum = 0.0f, last = 2.0f;
                for (const float x : w.vertices[v].weight) {
                    CHECK(x >= 0.0f);
                    CHECK(x <= last);
                    last = x;
                    sum += x;
                }
                CHECK(sum == doctest::Approx(1.0).epsilon(1e-6));
                CHECK(w.vertices[v].weight == w.vertices[static_cast<std::size_t>(c.surface.same[v])].weight);
            }
            CHECK(w.bytes() == w.vertices.size() * sizeof(SkinWeights::Vertex));
            CHECK(w.dropped <= 1e-12);  // few bones
            if (automatic) CHECK(w.residual < 1e-10);
        }
}

TEST_CASE("skin weights: change little from vertex to vertex, and half and half in the plane of a joint") {
    const auto& c = bend90();
    for (const bool automatic : {false, true}) {
        CAPTURE(automatic);
        const auto w = weightsOf(c, automatic);
        const auto ofSecond = [&](std::int32_t v) {
            double sum = 0.0;
            for (int k = 0; k < SkinWeights::kMax; ++k)
                if (w.vertices[v].bone[k] == 1) sum += static_cast<double>(w.vertices[v].weight[k]);
            return sum;
        };
        // Rows are 1/8 apart: a ramp over 2 m or more never rises by more than an eighth over a row and a diagonal.
        for (Eigen::Index t = 0; t < c.surface.triangles.rows(); ++t)
            for (int k = 0; k < 3; ++k)
                CHECK(std::abs(ofSecond(c.surface.triangles(t, k)) - ofSecond(c.surface.triangles(t, (k + 1) % 3))) <= 0.125);
        for (Eigen::Index v = 0; v < c.surface.vertices.rows(); ++v) {
            const double x = c.surface.vertices(v, 0);
            if (std::abs(x) < 1e-9) CHECK(ofSecond(static_cast<std::int32_t>(v)) == doctest::Approx(0.5).epsilon(0.01));
            if (x > 3.0) CHECK(ofSecond(static_cast<std::int32_t>(v)) > (automatic ? 0.85 : 0.9999));
        }
    }
}

TEST_CASE("skin: at rest nothing moves, and a rigid motion of all bones moves the skin rigidly") {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0, Vec3(1, -2, 0.5).normalized()));
    const Vec3 shift(3, -1, 2);
    for (const auto& c : {bend90(), deformerCase(kFolder, "branch")})
        for (const auto kind : kKinds)
            for (const bool automatic : {false, true}) {
                const auto w = weightsOf(c, automatic);
                Pose pose = restPose(c.input.skeleton);
                CHECK((deformed(c, kind, w, pose) - c.surface.vertices).cwiseAbs().maxCoeff() <= 4e-6);  // single precision of a body of 8 m
                for (auto& p : pose.points) p = turn * p + shift;
                for (auto& q : pose.frames) q = turn * q;
                const Points wanted = ((turn.toRotationMatrix() * c.surface.vertices.transpose()).colwise() + shift).transpose();
                CHECK((deformed(c, kind, w, pose) - wanted).cwiseAbs().maxCoeff() <= 2e-5);
            }
}

TEST_CASE("skin: a vertex of one bone alone moves with that bone") {
    const auto& c = bend90();
    const auto w = weightsOf(c, false);
    for (const auto kind : {SkinKind::LinearBlend, SkinKind::DualQuaternion}) {
        const Points at = deformed(c, kind, w, c.pose);
        for (Eigen::Index v = 0; v < at.rows(); ++v) {
            if (w.vertices[v].weight[0] < 1.0f) continue;
            const int b = w.vertices[v].bone[0];
            const Vec3 wanted = c.pose.points[b] + c.pose.frames[b] * (c.surface.vertices.row(v).transpose() - c.input.skeleton.points[b]);
            CHECK((at.row(v).transpose() - wanted).norm() <= 1e-5);
        }
    }
}

TEST_CASE("skin: dual quaternions take the shorter way, whatever the sign of a frame") {
    const auto& c = bend90();
    const auto w = weightsOf(c, true);
    Pose pose = c.pose;
    const Points at = deformed(c, SkinKind::DualQuaternion, w, pose);
    pose.frames[1].coeffs() *= -1.0;
    CHECK((deformed(c, SkinKind::DualQuaternion, w, pose) - at).cwiseAbs().maxCoeff() <= 1e-6);
}

TEST_CASE("skin: a spline runs through the joint points and bends evenly where linear blending creases") {
    const auto& c = bend90();
    const auto spline = measured(c, SkinKind::Spline, true), linear = measured(c, SkinKind::LinearBlend, true);
    CHECK(spline.crease <= linear.crease);
    const auto w = weightsOf(c, false);
    const Points at = deformed(c, SkinKind::Spline, w, c.pose);
    // The middle of each ring is where the curve is; at the joint that is the joint point.
    Vec3 middle = Vec3::Zero();
    int count = 0;
    for (Eigen::Index v = 0; v < at.rows(); ++v)
        if (std::abs(c.surface.vertices(v, 0)) < 1e-9 && c.surface.vertices.row(v).norm() > 0.99) middle += at.row(v).transpose(), ++count;
    CHECK((middle / count).norm() <= 1e-5);
}

// What other programs do on this case is known (measured in Blender 3.4): a comparison is fair where ours lose no more.
TEST_CASE("skin: a bend of 90 degrees does to the volume what it does in other programs, or less") {
    const auto& c = bend90();
    const auto linearRamp = measured(c, SkinKind::LinearBlend, false), linearAuto = measured(c, SkinKind::LinearBlend, true);
    CHECK(linearRamp.volumeChange < -0.03);  // -4 %
    CHECK(linearRamp.volumeChange > -0.05);
    CHECK(linearAuto.volumeChange < -0.2);   // -31 %
    CHECK(linearAuto.volumeChange > -0.31);
    const auto dualRamp = measured(c, SkinKind::DualQuaternion, false);
    CHECK(std::abs(dualRamp.volumeChange) < 0.001);  // -0.1 %
    CHECK(dualRamp.worstQuality > 0.33);             // .33
    const auto spline = measured(c, SkinKind::Spline, true);
    CHECK(spline.volumeChange < 0.0);                // -3.7 %
    CHECK(spline.volumeChange > -0.037);
    CHECK(spline.worstQuality > 0.64);               // .64
    CHECK(spline.intersections == 0);
}

TEST_CASE("skin: 180 degrees of twist collapse a linear skin and leave the volume to dual quaternions and splines") {
    const auto c = deformerCase(kFolder, "twist 180");
    CHECK(measured(c, SkinKind::LinearBlend, true).volumeChange < -0.3);
    CHECK(std::abs(measured(c, SkinKind::DualQuaternion, true).volumeChange) < 0.005);
    CHECK(measured(c, SkinKind::Spline, false).worstQuality > 0.7);
}

TEST_CASE("skin: stretching and squashing a straight limb keep its volume") {
    for (const char* name : {"stretch 250", "squash 40"}) {
        const auto c = deformerCase(kFolder, name);
        for (const auto kind : kKinds)
            for (const bool automatic : {false, true}) CHECK(std::abs(measured(c, kind, automatic).volumeChange) < 1e-4);
    }
}

TEST_CASE("skin: frames allocate nothing, keep the last pose where one does not fit, and are the same every time") {
    const auto& c = bend90();
    for (const auto kind : kKinds) {
        auto skin = Skin::build(c.surface, c.input.skeleton, weightsOf(c, true), kind).value();
        const auto before = allocations();
        skin.update(c.pose);
        CHECK(allocations() == before);
        const Points at = positions(skin);
        Pose bad = c.pose;
        bad.points[1].x() = std::numeric_limits<double>::quiet_NaN();
        skin.update(bad);
        CHECK(positions(skin) == at);
        auto again = Skin::build(c.surface, c.input.skeleton, weightsOf(c, true), kind).value();
        again.update(c.pose);
        CHECK(std::memcmp(again.positions(), skin.positions(), 12 * static_cast<std::size_t>(skin.vertices())) == 0);
        CHECK(skin.bytes() > 0);
        // All joint points in one place: nothing to see, but nothing that is not a number either.
        Pose collapsed = c.pose;
        for (auto& p : collapsed.points) p.setZero();
        skin.update(collapsed);
        CHECK(positions(skin).cwiseAbs().maxCoeff() < 1e3);
    }
}

TEST_CASE("skin: bad input is told") {
    const auto code = [](const auto& result) { return result ? std::string("ok") : result.error().code; };
    const auto& c = bend90();
    const Skeleton none;
    CHECK(code(rampWeights(c.surface, none, 0.0)) == "no-bone");
    CHECK(code(automaticWeights(c.surface, none, {})) == "no-bone");
    CHECK(code(rampWeights({}, c.input.skeleton, 0.0)) == "too-small");
    CHECK(code(rampWeights(c.surface, c.input.skeleton, -1.0)) == "bad-value");
    Skeleton point = c.input.skeleton;
    point.points[1] = point.points[0];
    CHECK(code(automaticWeights(c.surface, point, {})) == "bad-value");
    Skeleton outside = c.input.skeleton;
    for (auto& p : outside.points) p.y() += 10.0;
    // Bones beside the body: the side towards them would be heated from outside.
    CHECK(code(automaticWeights(c.surface, outside, {})) == "no-heat");
    std::stop_source stop;
    stop.request_stop();
    CHECK(code(automaticWeights(c.surface, c.input.skeleton, Progress({}, stop.get_token()))) == kCancelled);
    auto weights = rampWeights(c.surface, c.input.skeleton, 0.0).value();
    weights.vertices[5].bone[0] = 2;
    CHECK(code(Skin::build(c.surface, c.input.skeleton, weights, SkinKind::LinearBlend)) == "bad-value");
    weights.vertices.pop_back();
    CHECK(code(Skin::build(c.surface, c.input.skeleton, weights, SkinKind::LinearBlend)) == "bad-value");
}
