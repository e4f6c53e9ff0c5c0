// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "core/document/hanging.h"
#include "core/session/prepared_step.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// Inverse kinematics has settled when it moves by 1e-6 of a bone's length (3 m) per solve, and some ten of these may be left.
constexpr double kSettled = 3e-5;
constexpr double kSinglePrecision = 5e-6;  // m, at ten metres

const Vec3 kShift(2.0, -1.0, 0.5), kAbout(0.3, 0.2, 1.0);
const Eigen::Quaterniond kTurn(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()));

Json numbersOf(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Json turnedBy(std::vector<std::string> names) {
    return {{"do", "transform"}, {"names", std::move(names)}, {"shift", numbersOf(kShift)}, {"rotation", {kTurn.x(), kTurn.y(), kTurn.z(), kTurn.w()}}, {"about", numbersOf(kAbout)}};
}
Vec3 placedAt(const Vec3& p) { return kAbout + kTurn * (p - kAbout) + kShift; }
double missed(const Points& before, const Points& after) {
    double most = 0.0;
    for (Eigen::Index v = 0; v < before.rows(); ++v) most = std::max(most, (placedAt(before.row(v).transpose()) - after.row(v).transpose()).norm());
    return most;
}
PartId partNamed(Workbench& w, const char* name) { return w.session.document().elementNamed(name)->id; }
Vec3 endOf(Workbench& w, const char* end) {
    const Json p = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", end}})["value"];
    return {p[0].get<double>(), p[1].get<double>(), p[2].get<double>()};
}

}  // namespace

TEST_CASE("transform: what is prepared on a copy brings the results along that it carried over, fresh ones and those that only fit, as the command itself does") {
    for (const bool fresh : {true, false}) {
        CAPTURE(fresh);
        Workbench direct, w;
        for (Workbench* of : {&direct, &w}) {
            of->buildChain();
            of->good({{"do", "precompute"}});
            if (!fresh) of->good({{"do", "set"}, {"target", "B"}, {"property", "nu"}, {"value", 0.3}});
        }
        const Json command = turnedBy({"B"});
        auto made = prepareStep(coreRegistry(), w.session.project(), {command}, {}, {});
        REQUIRE(made);
        direct.good(command);
        bool told = false;
        w.session.setListener([&](const Session::Change& change) { told = told || change.responses; });
        REQUIRE(w.session.takePrepared(*made));
        CHECK(told);
        for (const char* name : {"A", "B"}) {
            CAPTURE(name);
            CHECK(w.session.responseState(partNamed(w, name)) == direct.session.responseState(partNamed(direct, name)));
            REQUIRE(direct.session.responses().fittingOf(partNamed(direct, name)));
            CHECK(w.session.responses().fittingOf(partNamed(w, name)));
            CHECK(w.session.positionsOf(partNamed(w, name)) == direct.session.positionsOf(partNamed(direct, name)));
        }
    }
}

TEST_CASE("transform: a chain that is turned and moved as it is posed looks the same there, with its results, kept poses and pins, and nothing is solved again; one step") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "import-element"}, {"path", "bar3"}, {"name", "apart"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.2, 0.4, 5.0}}});
    w.good({{"do", "keep-pose"}, {"name", "bent"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "rest"}});
    w.good({{"do", "apply-pose"}, {"name", "bent"}});
    std::map<std::string, Points> was;
    for (const char* name : {"A", "B", "apart"}) was[name] = w.session.positionsOf(partNamed(w, name));
    const std::string before = w.content();
    const int steps = w.session.position();
    const Json answer = w.good(turnedBy({"B"}));
    CHECK(answer["elements"] == Json::array({"A", "B"}));
    CHECK(answer["bones"] == Json::array({"a", "b"}));
    CHECK(answer["stale"].empty());
    CHECK(w.session.position() == steps + 1);
    for (const char* name : {"A", "B"}) {
        CHECK(w.session.responseState(partNamed(w, name)) == ResponseState::Fresh);
        CHECK(missed(was[name], w.session.positionsOf(partNamed(w, name))) < kSettled);
    }
    CHECK(w.session.positionsOf(partNamed(w, "apart")) == was["apart"]);
    for (const Json& line : w.good({{"do", "precompute"}})["elements"]) CHECK_MESSAGE(line["reused"] == true, line.dump());
    w.good({{"do", "rest"}});
    w.good({{"do", "apply-pose"}, {"name", "bent"}});
    CHECK(missed(was["B"], w.session.positionsOf(partNamed(w, "B"))) < kSettled);
    while (w.session.position() > steps) w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    CHECK(w.session.responseState(partNamed(w, "B")) == ResponseState::Fresh);
}

TEST_CASE("transform: what is scaled is out of date, which is said, with its faces, handles and points of bones as large") {
    Workbench w;
    w.buildFreeEnd();
    w.good({{"do", "handle"}, {"element", "B"}, {"point", {0.5, 0.0, 4.5}}, {"radius", 0.3}, {"name", "knob"}});
    w.good({{"do", "precompute"}});
    const Vec3 end = endOf(w, "b/end");
    const double size = w.session.document().elementNamed("A")->faces[0].size;
    const Json answer = w.good({{"do", "transform"}, {"names", {"A"}}, {"scale", 2.0}, {"about", {0, 0, 0}}});
    CHECK(answer["stale"] == Json::array({"A", "B"}));
    CHECK(w.session.responseState(partNamed(w, "A")) == ResponseState::Stale);
    CHECK((endOf(w, "b/end") - 2.0 * end).norm() < 1e-12);
    CHECK(w.session.document().elementNamed("A")->faces[0].size == doctest::Approx(2.0 * size));
    const Element& b = *w.session.document().elementNamed("B");
    CHECK(b.handles[0].radius == doctest::Approx(0.6));
    CHECK((b.handles[0].point - Vec3(1, 0, 9)).norm() < 0.3);
    CHECK(w.good({{"do", "precompute"}})["elements"].size() == 2);
    // Half as large again: it is as it was, and so is what was solved.
    w.good({{"do", "transform"}, {"names", {"B"}}, {"scale", 0.5}, {"about", {0, 0, 0}}});
    CHECK(w.session.responseState(partNamed(w, "A")) == ResponseState::Fresh);
}

TEST_CASE("transform: a character goes whole, by its name or that of a piece, and its cuts fit it there") {
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "snowman"}, {"name", "man"}});
    w.good({{"do", "cut"}, {"element", "man"}, {"plane", {{"origin", {0, 0, 5}}, {"normal", {0, 0, 1}}}}, {"names", {"low", "high"}}, {"name", "waist"}});
    const CharacterSource before = *w.session.document().characterNamed("man");
    const Points low = w.session.document().elementNamed("low")->mesh->body.vertices;
    CHECK(w.good(turnedBy({"high"}))["characters"] == Json::array({"man"}));
    const CharacterSource& after = *w.session.document().characterNamed("man");
    CHECK(missed(before.model->mesh.body.vertices, after.model->mesh.body.vertices) < 1e-12);
    CHECK(missed(before.body->mesh.vertices, after.body->mesh.vertices) < 1e-12);
    CHECK(missed(low, w.session.document().elementNamed("low")->mesh->body.vertices) < 1e-12);
    CHECK((after.cuts[0].plane.normal - kTurn * Vec3::UnitZ()).norm() < 1e-12);
    w.good({{"do", "move-cut"}, {"cut", "waist"}, {"plane", {{"origin", numbersOf(placedAt({0, 0, 7}))}, {"normal", numbersOf(kTurn * Vec3::UnitZ())}}}});
    double most = 0.0;
    const Points moved = w.session.document().elementNamed("low")->mesh->body.vertices;
    for (Eigen::Index v = 0; v < moved.rows(); ++v) most = std::max(most, (kTurn.conjugate() * (Vec3(moved.row(v).transpose()) - kAbout - kShift) + kAbout).z());
    CHECK(most == doctest::Approx(7.0));
}

TEST_CASE("transform: takes of what is moved show the same there, to the frame; of what is turned their poses, turned, and it is said; both are saved") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "record"}, {"take", "dance"}, {"action", "start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.2, 0.4, 5.2}}, {"seconds", 0.1}});
    w.good({{"do", "step"}, {"frames", 12}});
    w.good({{"do", "release"}});
    w.good({{"do", "record"}, {"take", "dance"}, {"action", "stop"}});
    const auto shown = [&](Workbench& of) {
        const Json answer = of.good({{"do", "play"}, {"take", "dance"}, {"time", 0.1}});
        return std::pair(answer["exact"].get<bool>(), of.session.positionsOf(partNamed(of, "B")));
    };
    const Points was = shown(w).second;
    const Vec3 end = endOf(w, "b/end");
    w.good({{"do", "step"}, {"frames", 1}});
    CHECK(w.good({{"do", "transform"}, {"names", {"A"}}, {"shift", numbersOf(kShift)}})["takes"].empty());
    auto [exact, moved] = shown(w);
    CHECK(exact);
    CHECK(((moved - was).rowwise() - kShift.transpose()).cwiseAbs().maxCoeff() < kSinglePrecision);
    w.good({{"do", "step"}, {"frames", 1}});
    w.good({{"do", "undo"}});
    CHECK(w.good(turnedBy({"A"}))["takes"] == Json::array({"dance"}));
    CHECK(!shown(w).first);
    CHECK((endOf(w, "b/end") - placedAt(end)).norm() < 1e-9);
    const std::string path = (Workbench::folder() / "turned.imomushi").string();
    w.good({{"do", "step"}, {"frames", 1}});
    w.good({{"do", "save"}, {"path", path}, {"copy", true}});
    Workbench other;
    other.good({{"do", "open"}, {"path", path}});
    CHECK(!shown(other).first);
    CHECK((endOf(other, "b/end") - placedAt(end)).norm() < 1e-9);
}

TEST_CASE("transform: what cannot be done is refused and changes nothing") {
    Workbench w;
    w.buildChain();
    const std::string before = w.content();
    CHECK(w.code({{"do", "transform"}, {"names", Json::array()}}) == "no-element");
    CHECK(w.code({{"do", "transform"}, {"names", {"nobody"}}}) == "no-such-element");
    CHECK(w.code({{"do", "transform"}, {"names", {"A"}}, {"scale", 0.0}}) == "bad-value");
    CHECK(w.code({{"do", "transform"}, {"names", {"A"}}, {"scale", -1.0}}) == "bad-value");
    CHECK(w.code({{"do", "transform"}, {"names", {"A"}}, {"rotation", {0, 0, 0, 0}}}) == "bad-value");
    CHECK(w.code({{"do", "transform"}, {"names", {"A"}}, {"shift", {1e9, 0, 0}}}) == "bad-value");
    CHECK(w.content() == before);
}
