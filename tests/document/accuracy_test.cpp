// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reports/accuracy_commands.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

const StudyInput::Effect& effectOf(const StudyInput& input, const std::string& name) {
    for (const auto& effect : input.effects)
        if (effect.name == name) return effect;
    FAIL("no effect ", name);
    return input.effects.front();
}

}  // namespace

TEST_CASE("accuracy: the error in the pose of now is nothing at rest, something in a bend, and does not ask what effects do to the flesh") {
    const TestFolder folder;
    Workbench w;
    w.buildChain();
    const Json ask{{"do", "accuracy"}, {"path", folder.file("pose.json")}, {"pose", "current"}, {"seconds", 0.1}};
    CHECK(w.code(ask) == "not-precomputed");
    w.good({{"do", "precompute"}});
    CHECK(w.good(ask)["error"]["relative"] == 0.0);
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 0.0, 5.2}}});
    const Json bent = w.good(ask);
    CHECK(bent["error"]["relative"].get<double>() > 0.0);
    CHECK(bent["reference"]["solver_mesh"] == "as-is");  // in a tenth of a second
    // The file tells the same of each vertex.
    std::ifstream file(folder.file("pose.json"));
    const Json told = Json::parse(file);
    double largest = 0.0;
    for (const Json& element : told["elements"])
        for (const Json& percent : element["percent"])
            if (percent.is_number()) largest = std::max(largest, percent.get<double>());
    CHECK(largest == doctest::Approx(bent["error"]["max_percent"].get<double>()).epsilon(1e-6));
    w.good({{"do", "enable"}, {"effect", "inflate"}});
    w.good({{"do", "precompute"}});
    CHECK(w.good(ask)["error"]["relative"].get<double>() == doctest::Approx(bent["error"]["relative"].get<double>()).epsilon(1e-9));
    Json wrong = ask;
    wrong["pose"] = "bend";
    CHECK(w.code(wrong) == "bad-value");
    wrong = ask;
    wrong["csv"] = folder.file("pose.csv");
    CHECK(w.code(wrong) == "bad-value");
}

TEST_CASE("accuracy: recorded takes are among the poses of a study, at three moments each") {
    Workbench w;
    w.buildChain();
    const std::size_t before = studiedCharacter(w.session).value().poses.size();
    w.good({{"do", "record"}, {"take", "踊り"}, {"action", "start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.2, 0.4, 5.2}}, {"seconds", 0.2}});
    w.good({{"do", "step"}, {"frames", 12}, {"dt", 0.025}});
    w.good({{"do", "record"}, {"take", "踊り"}, {"action", "stop"}});
    const auto poses = studiedCharacter(w.session).value().poses;
    REQUIRE(poses.size() == before + 3);
    CHECK(poses[before].name == "踊り 25 %");
    const auto end = [&](std::size_t i) { return poses[i].pose.points.back(); };
    CHECK((end(before) - end(before + 1)).norm() > 0.01);
}

TEST_CASE("accuracy: every effect has a price, and the touch of fingers as soon as there are responses for them") {
    Workbench w;
    w.buildChain();
    auto input = studyInput(w.session).value();
    CHECK(input.effects.size() == kEffects - 1);  // the previous model is a point of its own
    CHECK_FALSE(effectOf(input, "touch").unknown.empty());
    const auto& dynamics = effectOf(input, "bone-dynamics");
    REQUIRE(dynamics.step);
    CHECK(dynamics.predictedMs > 0.0);
    const Pose rest = restPose(input.reference.character.skeleton);
    CHECK((dynamics.step(1.0 / 60.0, rest, {}).points.back() - rest.points.back()).norm() < 1e-9);
    w.good({{"do", "enable"}, {"effect", "touch"}});
    w.good({{"do", "precompute"}});
    input = studyInput(w.session).value();
    CHECK(effectOf(input, "touch").unknown.empty());
    input.store.clear();
    input.seconds = 0.2;
    input.effects = {effectOf(input, "bone-dynamics"), effectOf(input, "touch"), effectOf(input, "ground")};
    const auto study = runStudy(input, {}, {}).value();
    CHECK(study.effects.size() == 3);
    for (const auto& effect : study.effects) CHECK(effect.measuredMs >= 0.0);
}
