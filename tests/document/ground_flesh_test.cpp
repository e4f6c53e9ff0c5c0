// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "core/effects/ground_job.h"
#include "core/skeleton/bone_tree.h"
#include "tests/document/workbench.h"
#include "tests/support/plain_sample.h"
#include "tests/support/thorough.h"

using namespace imomushi;

namespace {

/// A sample that stands on the ground.
struct OnGround {
    explicit OnGround(const std::string& sample, std::initializer_list<const char*> effects) {
        w.good({{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/" + sample + ".imomushi"}});
        for (const Json& line : plainLines(sample)) w.good(line);
        for (const auto& [id, element] : w.session.document().elements) {
            const Points& rest = element->mesh->body.vertices;
            low = low.cwiseMin(rest.colwise().minCoeff().transpose());
            high = high.cwiseMax(rest.colwise().maxCoeff().transpose());
        }
        w.good({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", low.y()}});
        for (const char* effect : effects) w.good({{"do", "enable"}, {"effect", effect}});
    }
    /// Of all body vertices as they are seen, over the height at rest.
    double lowest() {
        double found = 1e30;
        for (std::size_t e = 0; e < w.session.document().elements.size(); ++e) {
            const auto surface = w.session.character()->surface(static_cast<int>(e));
            for (int i = 0; i < surface.vertices; ++i) found = std::min(found, static_cast<double>(surface.positions[3 * i + 1]));
        }
        return (found - low.y()) / height();
    }
    Vec3 middle() {
        Vec3 sum = Vec3::Zero();
        int count = 0;
        for (std::size_t e = 0; e < w.session.document().elements.size(); ++e) {
            const auto surface = w.session.character()->surface(static_cast<int>(e));
            for (int i = 0; i < surface.vertices; ++i, ++count) sum += Eigen::Map<const Eigen::Vector3f>(surface.positions + 3 * i).cast<double>();
        }
        return sum / count;
    }
    double step(int frames) {
        double found = lowest();
        for (int i = 0; i < frames; ++i) {
            said = w.good({{"do", "step"}, {"frames", 1}})["warnings"];
            found = std::min(found, lowest());
        }
        return found;
    }
    void drag(const std::string& end, const Vec3& to, double seconds = 0.5) {
        w.good({{"do", "drag"}, {"endpoint", end}, {"to", {to.x(), to.y(), to.z()}}, {"seconds", seconds}});
    }
    void unpin() {
        std::vector<std::string> ends;
        for (const auto& [id, bone] : w.session.document().bones)
            for (const char* end : {"/start", "/end"}) ends.push_back(bone->name + end);
        for (const std::string& end : ends) w.code({{"do", "unpin"}, {"endpoint", end}});
    }
    bool warned() const { return said.dump().find("lower the ground") != std::string::npos; }
    [[nodiscard]] double height() const { return high.y() - low.y(); }
    [[nodiscard]] double size() const { return (high - low).norm(); }

    Workbench w;
    Vec3 low = Vec3::Constant(1e30), high = -low;
    Json said;
};

// Of the height at rest: flesh is followed to single precision, and vertices of which none is a sample lie between samples.
constexpr double kStill = 0.01, kMoving = 0.03;

void checkHeld(OnGround& scene) {
    CHECK(scene.step(600) > -kMoving);
    CHECK(scene.lowest() > -kStill);
    CHECK_FALSE(scene.w.session.moving());
    const Vec3 to(scene.high.x() - 0.3 * (scene.high.x() - scene.low.x()), scene.low.y() - 0.3 * scene.height(), 0.0);
    scene.drag("head-bone/end", to);
    CHECK(scene.step(120) > -kMoving);
    CHECK(scene.warned());
    scene.step(480);
    CHECK(scene.lowest() > -kStill);
    CHECK(scene.warned());
    CHECK_FALSE(scene.w.session.moving());
    scene.drag("head-bone/end", Vec3(scene.low.x(), scene.low.y() + 0.1 * scene.height(), 0.0));
    CHECK(scene.step(120) > -kMoving);
    scene.step(480);
    CHECK(scene.lowest() > -kStill);
    scene.w.good({{"do", "release"}});
    CHECK(scene.step(600) > -kMoving);
    CHECK(scene.lowest() > -kStill);
    CHECK_FALSE(scene.warned());
    CHECK_FALSE(scene.w.session.moving());
}

}  // namespace

TEST_CASE("ground: the flesh of the caterpillar stays above it at rest, with its head dragged into it and folded over, and comes to rest") {
    OnGround scene("caterpillar", {"bone-dynamics", "gravity", "ground"});
    checkHeld(scene);
}

TEST_CASE("ground: the same flesh with the bend warp stays above it") {
    OnGround scene("caterpillar", {"bone-dynamics", "gravity", "bend-warp", "ground"});
    checkHeld(scene);
}

TEST_CASE("ground: the same flesh without bone dynamics stays above it, at once") {
    OnGround scene("caterpillar", {"gravity", "ground"});
    CHECK(scene.lowest() > -kStill);
    const Json answer = scene.w.good({{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {scene.high.x(), scene.low.y() - 0.3 * scene.height(), 0.0}}});
    CHECK(scene.lowest() > -kStill);
    CHECK(answer["warnings"].dump().find("lower the ground") != std::string::npos);
    scene.drag("head-bone/end", Vec3(scene.low.x(), scene.low.y() + 0.1 * scene.height(), 0.0));
    CHECK(scene.step(120) > -kMoving);
    CHECK(scene.lowest() > -kStill);
    CHECK_FALSE(scene.w.session.moving());
}

TEST_CASE("ground: without bone dynamics every sample comes to rest above a ground that rises into it") {
    for (const std::string sample : {"caterpillar", "figure", "octopus", "dragon"})
        for (const bool warp : {false, true}) {
            CAPTURE(sample);
            CAPTURE(warp);
            OnGround scene(sample, {"gravity", "ground"});
            if (warp) scene.w.good({{"do", "enable"}, {"effect", "bend-warp"}});
            for (const double part : {0.1, 0.2, 0.4}) {
                CAPTURE(part);
                scene.w.good({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", scene.low.y() + part * scene.height()}});
                scene.step(60);
                CHECK(scene.lowest() > part - kStill);
                CHECK_FALSE(scene.w.session.moving());
            }
            // Where it goes down again, so do they.
            scene.w.good({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", scene.low.y()}});
            scene.step(60);
            CHECK(scene.lowest() == doctest::Approx(0.0).epsilon(kStill));
            CHECK_FALSE(scene.w.session.moving());
        }
}

TEST_CASE("ground: an end that several bones share takes the flesh along that is said to hang on it when it is lifted, in every sample") {
    for (const std::string sample : {"caterpillar", "figure", "octopus", "dragon"}) {
        CAPTURE(sample);
        OnGround scene(sample, {"ground"});
        CharacterInput input = scene.w.session.character()->input();
        GroundEffect ground;
        ground.height = 1e9;  // none of it is far above
        input.effects.set(ground);
        auto c = Character::build(input).value();
        const Pose rest = restPose(input.skeleton);
        const double lift = 0.01 * scene.size();
        for (std::size_t p = 0; p < rest.points.size(); ++p) {
            // The end of a limb turns its flesh instead, and not at all along the bone.
            if (std::ranges::count_if(input.skeleton.bones, [&](const auto& b) { return b.start == static_cast<int>(p) || b.end == static_cast<int>(p); }) < 2) continue;
            c.update(rest);
            const auto flesh = [&] {
                std::vector<double> heights;
                for (const FleshPoint& f : groundFlesh(c))
                    if (f.point == static_cast<int>(p)) heights.push_back(c.pose().points[p].y() + f.offset.y());
                return heights;
            };
            const std::vector<double> before = flesh();
            if (before.empty()) continue;
            Pose lifted = rest;
            lifted.points[p].y() += lift;
            for (std::size_t b = 0; b < input.skeleton.bones.size(); ++b) {
                const auto along = [&](const Pose& pose) -> Vec3 { return (pose.points[static_cast<std::size_t>(input.skeleton.bones[b].end)] - pose.points[static_cast<std::size_t>(input.skeleton.bones[b].start)]).normalized(); };
                lifted.frames[b] = minimalRotation(along(rest), along(lifted)) * rest.frames[b];
            }
            c.update(lifted);
            const std::vector<double> after = flesh();
            double rise = 0.0;
            for (std::size_t i = 0; i < before.size(); ++i) rise += (after[i] - before[i]) / static_cast<double>(before.size());
            CAPTURE(p);
            CHECK(rise > 0.5 * lift);
        }
    }
}

TEST_CASE("ground: with contact flesh is dented, and its bones come down no farther than dents carry") {
    OnGround scene("caterpillar", {"bone-dynamics", "gravity", "ground", "contact"});
    scene.w.good({{"do", "precompute"}});
    scene.w.good({{"do", "step"}, {"frames", 600}});
    CHECK(scene.lowest() > -kStill);
    CHECK(scene.lowest() < 0.0);
    scene.drag("head-bone/end", Vec3(0.5, scene.low.y() - 0.3 * scene.height(), 0.0));
    scene.w.good({{"do", "step"}, {"frames", 300}});
    CHECK(scene.lowest() > -kMoving);
    scene.drag("head-bone/end", Vec3(scene.low.x(), scene.low.y() + 0.2 * scene.height(), 0.0));
    scene.w.good({{"do", "step"}, {"frames", 300}});
    CHECK(scene.lowest() > -kMoving);
}

TEST_CASE("ground: without gravity what is let go comes back and rests on it") {
    OnGround scene("caterpillar", {"bone-dynamics", "ground"});
    scene.unpin();
    const Vec3 before = scene.middle();
    scene.drag("middle-bone/end", before + Vec3(0.2, 1.0, 0.0));
    scene.step(60);
    CHECK((scene.middle() - before).norm() > 0.1);
    scene.w.good({{"do", "release"}});
    scene.step(900);
    CHECK_FALSE(scene.w.session.moving());
    CHECK(std::abs(scene.lowest()) < kStill);
    // One that is in the ground lies on it.
    scene.w.good({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", scene.low.y() + 0.3 * scene.height()}});
    scene.step(600);
    CHECK(scene.lowest() == doctest::Approx(0.3).epsilon(kStill));
    CHECK_FALSE(scene.w.session.moving());
}

TEST_CASE("ground: a symmetric push does not drift to the side, and what rests costs nothing") {
    OnGround scene("caterpillar", {"bone-dynamics", "gravity", "ground"});
    scene.step(600);
    const Vec3 before = scene.middle();
    scene.drag("head-bone/end", Vec3(scene.high.x(), scene.low.y() - 0.3 * scene.height(), 0.0));
    scene.step(300);
    scene.w.good({{"do", "release"}});
    scene.step(600);
    CHECK(std::abs(scene.middle().z() - before.z()) < 0.002 * scene.size());
    REQUIRE_FALSE(scene.w.session.moving());
    const auto surface = scene.w.session.character()->surface(0);
    scene.step(10);
    CHECK(scene.w.session.character()->surface(0).revision == surface.revision);
    CHECK_FALSE(scene.w.session.moving());
}

TEST_CASE("ground: the flesh of every sample rests on it") {
    for (const std::string sample : {"caterpillar", "figure", "octopus", "dragon"}) {
        CAPTURE(sample);
        OnGround scene(sample, {"bone-dynamics", "gravity", "ground"});
        scene.unpin();
        CHECK(scene.step(300) > -kMoving);
        scene.step(600);
        CHECK(scene.lowest() > -kStill);
        CHECK(scene.lowest() < kStill);
    }
}

// Every effect that flesh has, on the ground, while ends are dragged about and let go, and fingers press. Numbers are as artists have them; soak_test.cpp has others.
namespace {

void checkThrown(const std::string& sample) {
    const char* given = std::getenv("IMOMUSHI_SOAK_FRAMES");
    const int frames = given ? std::clamp(std::atoi(given), 1, 100'000) : repeats(600, 2000);
    OnGround scene(sample, {"bone-dynamics", "smooth-joints", "bend-warp", "joint-dynamics", "gravity", "inflate", "touch", "contact", "ground"});
    scene.w.solveCoarsely();
    scene.w.good({{"do", "precompute"}});
    std::vector<std::string> ends;
    for (const auto& [id, bone] : scene.w.session.document().bones)
        for (const char* end : {"/start", "/end"}) ends.push_back(bone->name + end);
    std::vector<const Element*> elements;
    for (const auto& [id, element] : scene.w.session.document().elements) elements.push_back(element.get());
    std::mt19937 random(7);
    const auto uniform = [&](double from, double to) { return from + (to - from) * static_cast<double>(random()) / 4294967295.0; };
    const auto numbers = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
    Json finger;
    std::vector<double> ms;
    double lowest = 0.0;
    int pressed = 0;
    for (int frame = 0; frame < frames; ++frame) {
        if (frame % 60 == 0) {
            const Vec3 part(uniform(-0.3, 1.3), uniform(-0.2, 1.5), uniform(-0.3, 1.3));
            const Vec3 to = scene.low + part.cwiseProduct(scene.high - scene.low);
            scene.w.code({{"do", "drag"}, {"endpoint", ends[random() % ends.size()]}, {"to", numbers(to)}, {"seconds", uniform(0.3, 1.0)}});
        }
        if (frame % 90 == 0) {
            const std::size_t e = random() % elements.size();
            const Points& rest = elements[e]->mesh->body.vertices;
            const auto v = static_cast<int>(random() % static_cast<unsigned>(rest.rows()));
            const auto surface = scene.w.session.character()->surface(static_cast<int>(e));
            const Vec3 at = Eigen::Map<const Eigen::Vector3f>(surface.positions + 3 * v).cast<double>();
            finger = {{"do", "touch"}, {"element", elements[e]->name}, {"point", numbers(rest.row(v).transpose())}, {"to", numbers(at + 0.1 * scene.height() * Vec3(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)))}};
            pressed += scene.w.code(finger) == "ok" ? 1 : 0;
        }
        if (frame % 90 == 60) {
            finger["to"] = nullptr;
            scene.w.code(finger);
        }
        if (frame % 240 == 239) scene.w.good({{"do", "release"}});
        const Json answer = scene.w.good({{"do", "step"}, {"frames", 1}});
        REQUIRE(answer["finite"] == true);
        ms.push_back(answer["ms_per_frame"]["median"].get<double>());
        if (const double now = scene.lowest(); now < lowest) {
            lowest = now;
            if (now <= -kMoving) MESSAGE("frame " << frame << ": " << 100.0 * now << " % of the height, warnings " << answer["warnings"].dump());
        }
    }
    std::sort(ms.begin(), ms.end());
    MESSAGE(sample << ": " << frames << " frames, " << pressed << " presses, p99 " << ms[ms.size() * 99 / 100] << " ms, lowest " << 100.0 * lowest << " % of the height");
    CHECK(pressed > 0);
    CHECK(lowest > -kMoving);
}

}  // namespace

TEST_CASE("effects: the caterpillar with every effect on the ground, thrown about, stays finite and above it") { checkThrown("caterpillar"); }
TEST_CASE("effects: the figure with every effect on the ground, thrown about, stays finite and above it") { checkThrown("figure"); }
TEST_CASE("effects: the octopus with every effect on the ground, thrown about, stays finite and above it") { checkThrown("octopus"); }
TEST_CASE("effects: the dragon with every effect on the ground, thrown about, stays finite and above it") { checkThrown("dragon"); }
