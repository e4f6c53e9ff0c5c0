// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <rapidcheck.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <stop_token>

#include "core/accuracy/frame_prediction.h"
#include "core/accuracy/pareto.h"
#include "core/accuracy/plot.h"
#include "core/accuracy/pose_error.h"
#include "core/accuracy/study.h"
#include "core/accuracy/study_json.h"
#include "core/accuracy/synthetic_response.h"
#include "core/comparison/paper_caterpillar.h"
#include "core/effects/smooth_joints_job.h"
#include "tests/support/folder.h"

using namespace imomushi;

namespace {

/// The paper's caterpillar of half as many cells around, so that a study takes a moment.
StudyInput smallStudy(const std::filesystem::path& store = {}) {
    StudyInput out;
    out.store = store;
    out.seconds = 3.0;
    out.present.basis = BasisKind::Affine;
    out.present.mesh.kind = SolverMeshSetting::Kind::AsIs;
    out.reference.character = paperCaterpillar(12);
    out.reference.character.basis = BasisKind::Affine;
    for (const auto& e : out.reference.character.elements) {
        ResponseInput in;
        in.mesh = e.mesh;
        in.faces = e.faces;
        in.solverMesh.kind = SolverMeshSetting::Kind::AsIs;
        out.reference.elements.push_back(std::move(in));
    }
    out.reference.poses = standardPoses(out.reference.character.skeleton);
    out.reference.poses.resize(3);
    return out;
}

Reference quickReference(const StudyInput& input) {
    ReferenceInput in = input.reference;
    in.seconds = 1e-9;  // the bodies as they are
    return buildReference(in, {}).value();
}

ErrorSum errorWith(const StudyInput& input, const Reference& reference, const BasisChoice& basis, bool smooth) {
    auto elements = input.reference.elements;
    for (auto& e : elements) e.basis = basis;
    const auto solved = solveElements(elements, {}).value();
    CharacterInput given = input.reference.character;
    given.basis = basis;
    if (smooth) given.effects.set(SmoothJointsEffect{});
    for (std::size_t e = 0; e < elements.size(); ++e) given.elements[e].response = solved.responses[e];
    auto character = Character::build(std::move(given)).value();
    ErrorSum sum;
    for (std::size_t i = 0; i < input.reference.poses.size(); ++i) {
        character.update(input.reference.poses[i].pose);
        sum.add(errorOf(character, reference, i));
    }
    return sum;
}

}  // namespace

TEST_CASE("front: each point on it gains at least 1 % of error over all that cost no more, and everything else gains less") {
    CHECK(rc::check([] {
        std::vector<Trade> trades;
        for (const auto& [cost, error, known] : *rc::gen::container<std::vector<std::tuple<int, int, bool>>>(
                 rc::gen::tuple(rc::gen::inRange(0, 6), rc::gen::inRange(0, 20), rc::gen::arbitrary<bool>())))
            trades.push_back({double(cost), 1.0 + 0.004 * error, known});
        const auto worse = dominated(trades);
        const auto front = paretoFront(trades);
        const std::set<std::size_t> on(front.begin(), front.end());
        for (std::size_t i = 0; i + 1 < front.size(); ++i) {
            RC_ASSERT(trades[front[i]].cost < trades[front[i + 1]].cost);
            RC_ASSERT(0.99 * trades[front[i]].error > trades[front[i + 1]].error);
        }
        for (std::size_t i = 0; i < trades.size(); ++i) {
            bool matched = false, beaten = false;
            for (const std::size_t k : front) {
                matched = matched || (k != i && trades[k].cost <= trades[i].cost && 0.99 * trades[k].error <= trades[i].error);
                beaten = beaten || (trades[k].cost <= trades[i].cost && trades[k].error < trades[i].error);
            }
            RC_ASSERT((worse[i] != 0) == (trades[i].known && !on.contains(i)));
            if (!trades[i].known) RC_ASSERT(!on.contains(i));
            if (worse[i]) RC_ASSERT(matched);
            if (on.contains(i)) RC_ASSERT(!matched && !beaten);
        }
    }));
}

TEST_CASE("plot: a logarithmic axis shows all values, and its lines lie on it") {
    const LogAxis axis = LogAxis::around({0.03, 5.0, 0.7, -1.0});
    CHECK(axis.at(0.03) > 0.0);
    CHECK(axis.at(5.0) < 1.0);
    const auto ticks = axis.ticks();
    CHECK(ticks.size() >= 2);
    for (const auto& tick : ticks) CHECK((axis.at(tick.value) >= 0.0 && axis.at(tick.value) <= 1.0));
    CHECK(tickText(0.02) == "0.02");
    CHECK(LogAxis::around({}).ticks().size() >= 2);
    CHECK(LogAxis::around({3.0}).ticks().size() >= 1);
}

TEST_CASE("plot: any name can stand in a picture, and what is unknown is left out") {
    ScatterPlot plot{"a < b & \"c\"", "x", "y", {{1.0, 2.0, "<虫>", true, true, true}, {-1.0, 2.0, "unknown", false, false, true}}};
    const std::string svg = plot.svg();
    CHECK(svg.find("a &lt; b &amp; &quot;c&quot;") != std::string::npos);
    CHECK(svg.find("&lt;虫&gt;") != std::string::npos);
    CHECK(svg.find("unknown") == std::string::npos);
    CHECK(svg.find("nan") == std::string::npos);
    CHECK(ScatterPlot{}.svg().find("</svg>") != std::string::npos);
}

TEST_CASE("settings: all different, the present one first, and stored ones are read back") {
    AccuracySetting present{false, {BasisKind::Modes, 7}, true, {true, SolverMeshSetting::Kind::Default, 0.0}, ResponseFormat::Half};
    const auto settings = studiedSettings(present);
    CHECK(settings.front() == present);
    std::set<std::string> names;
    AccuracyStudy study;
    for (const auto& s : settings) {
        CHECK(names.insert(settingName(s)).second);
        study.points.emplace_back().setting = s;
    }
    study.points[1].problem = Error{"no-memory", "Too large."};
    const AccuracyStudy back = studyFromJson(studyJson(study));
    REQUIRE(back.points.size() == settings.size());
    CHECK_FALSE(back.points[0].problem);
    CHECK((back.points[1].problem && back.points[1].problem->code == "no-memory" && back.points[1].problem->message == "Too large."));
    for (std::size_t i = 0; i < settings.size(); ++i) CHECK(back.points[i].setting == settings[i]);
    CHECK(back.points[0].frameMs < 0.0);  // unknown stays unknown
}

TEST_CASE("poses: the error in one pose is that of a study there, and the full solution is solved once") {
    const auto study = smallStudy();
    const Reference reference = quickReference(study);
    FullSolutionKeeper keeper;
    PoseErrorInput input{study.reference, study.reference.character};
    input.reference.seconds = 1e-9;
    const auto solved = solveElements(study.reference.elements, {}).value();
    for (std::size_t e = 0; e < solved.responses.size(); ++e) input.shown.elements[e].response = solved.responses[e];
    CHECK_FALSE(keeper.knows(referenceKey(input.reference)));
    auto character = Character::build(input.shown).value();
    double whole = 0.0;
    for (std::size_t i = 0; i < study.reference.poses.size(); ++i) {
        input.reference.poses = {study.reference.poses[i]};
        const auto made = keeper.measure(input, {}).value();
        character.update(study.reference.poses[i].pose);
        CHECK(made.error.relative == errorOf(character, reference, i).error().relative);
        CHECK(made.field == errorField(character, reference, i));
        if (i == 0) whole = made.reference.solutionSeconds;
        CHECK(made.reference.solutionSeconds == whole);  // solved once, and told with each pose
    }
    CHECK(keeper.knows(referenceKey(input.reference)));
    // The basis of the character is not part of it, its body is.
    auto other = input.reference;
    other.elements[0].basis = BasisKind::Paper;
    CHECK(keeper.knows(referenceKey(other)));
    other.elements[0].nu = 0.3;
    CHECK_FALSE(keeper.knows(referenceKey(other)));
    std::stop_source stop;
    stop.request_stop();
    CHECK(keeper.measure(input, Progress({}, stop.get_token())).error().code == kCancelled);
}

TEST_CASE("synthetic responses: a frame reads about as many bytes with them as with true responses, and no fewer") {
    const auto input = smallStudy();
    for (const BasisKind basis : {BasisKind::Paper, BasisKind::Affine}) {
        auto elements = input.reference.elements;
        for (auto& e : elements) e.basis = basis;
        const auto solved = solveElements(elements, {}).value();
        CharacterInput real = input.reference.character;
        real.basis = basis;
        const auto synthetic = Character::build(withSyntheticResponses(real)).value();
        for (std::size_t e = 0; e < elements.size(); ++e) real.elements[e].response = solved.responses[e];
        const auto character = Character::build(std::move(real)).value();
        // Between parallel faces uniform tension is no mode of its own, which a synthetic response does not know: one mode of eleven.
        for (int e = 0; e < int(elements.size()); ++e) {
            CHECK(synthetic.memory(e).response >= character.memory(e).response);
            CHECK(double(synthetic.memory(e).response) <= 1.1 * double(character.memory(e).response));
        }
    }
    CHECK(predictFrame(input.reference.character).value() > 0.0);
}

TEST_CASE("error: the reference differs from itself by nothing, and by a shift as large as it is") {
    const auto input = smallStudy();
    const Reference reference = quickReference(input);
    REQUIRE(reference.positions.size() == input.reference.poses.size());
    auto frames = Character::build(input.reference.character).value();
    frames.update(input.reference.poses[0].pose);
    CHECK(errorOf(frames, reference.positions[0], reference, 0).error().relative == 0.0);
    auto moved = reference.positions[0];
    const Points& body = input.reference.character.elements[1].mesh->body.vertices;
    const double diagonal = (body.colwise().maxCoeff() - body.colwise().minCoeff()).norm();
    moved[1].col(2).array() += 0.01 * diagonal;
    CHECK(errorOf(frames, moved, reference, 0).percent == doctest::Approx(1.0));
}

TEST_CASE("error: joints in equilibrium with more modes come nearer to the full solution") {
    const auto input = smallStudy();
    const Reference reference = quickReference(input);
    const double paper = errorWith(input, reference, BasisKind::Paper, false).error().relative;
    const double affine = errorWith(input, reference, BasisKind::Affine, false).error().relative;
    const double smooth = errorWith(input, reference, BasisChoice(BasisKind::Modes, 12), true).error().relative;
    CHECK(affine < paper);  // twist
    CHECK(smooth < 0.5 * affine);
    CHECK(smooth < 0.1);
    CHECK(reference.how.size() > 20);
}

TEST_CASE("study: what was measured is kept, and not measured again") {
    const TestFolder folder;
    auto input = smallStudy(folder.path());
    int arrived = 0;
    std::stop_source stop;
    const auto first = runStudy(
        input,
        [&](const AccuracyStudy& study) {
            arrived = 0;
            for (const auto& p : study.points) arrived += p.measured();
            if (arrived >= 1) stop.request_stop();
        },
        Progress({}, stop.get_token()));
    REQUIRE_FALSE(first);
    CHECK(first.error().code == kCancelled);
    const AccuracyStudy kept = knownStudy(input);
    REQUIRE(kept.reference);
    CHECK(kept.points[0].measured());
    CHECK_FALSE(kept.points[1].measured());
    CHECK_FALSE(kept.complete);
    const auto second = runStudy(input, {}, {}).value();
    // Times are told in those of the reference load, which a quieter moment makes shorter.
    CHECK(second.points[0].frameMs / second.calibrationMs == doctest::Approx(kept.points[0].frameMs / kept.calibrationMs).epsilon(1e-9));
    CHECK(second.points[0].relative == kept.points[0].relative);
    for (std::size_t i = 0; i < kept.reference->positions.size(); ++i)
        for (std::size_t e = 0; e < kept.reference->positions[i].size(); ++e) CHECK(second.reference->positions[i][e] == kept.reference->positions[i][e]);
    // Another body is another study.
    auto other = input;
    auto mesh = std::make_shared<ElementMesh>(*other.reference.elements[0].mesh);
    mesh->body.vertices(0, 0) += 1e-3;
    other.reference.elements[0].mesh = mesh;
    CHECK(studyKey(other) != studyKey(input));
    CHECK_FALSE(knownStudy(other).points[0].measured());
}

TEST_CASE("study: a damaged store counts as empty") {
    const TestFolder folder;
    auto input = smallStudy(folder.path());
    input.seconds = 0.5;
    REQUIRE(runStudy(input, {}, {}));
    const auto table = folder.path() / (studyKey(input).hex() + ".json"), positions = folder.path() / (studyKey(input).hex() + ".positions");
    std::filesystem::resize_file(positions, std::filesystem::file_size(positions) - 8);
    CHECK_FALSE(knownStudy(input).points[0].measured());
    std::ofstream(table) << "{\"points\": [1, {\"setting\": 3}], \"reference\": []";
    CHECK_FALSE(knownStudy(input).points[0].measured());
    std::ofstream(table) << "{\"points\": [1, {\"setting\": {\"basis\": 7}}], \"reference\": [], \"effects\": {}}";
    CHECK_FALSE(knownStudy(input).points[0].measured());
}

TEST_CASE("study: without bones or joint faces it says what is missing") {
    auto input = smallStudy();
    input.reference.character.skeleton = {};
    CHECK(runStudy(input, {}, {}).error().code == "no-bone");
    auto bare = smallStudy();
    for (auto& e : bare.reference.elements) e.faces.clear();
    CHECK(buildReference(bare.reference, {}).error().code == "no-face");
}
