// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/packed_response.h"
#include "tests/document/workbench.h"

using namespace imomushi;

TEST_CASE("storage: the response of touch opens as it was saved, and a broken one is refused") {
    Workbench w;
    w.buildChain();
    Project project;
    project.document = w.session.document();
    const PartId id = project.document.elements.begin()->first;
    const Element& element = *project.document.elements.at(id);
    ResponseInput input;
    input.mesh = element.mesh;
    input.faces = element.faces;
    input.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
    input.touch = 6;
    auto response = std::make_shared<ElementResponse>(buildResponse(input, {}).value());
    REQUIRE(response->touch.patches.count() == 6);
    project.responses[id] = {responseKey(input), responseKey(input), response};
    const auto path = Workbench::folder() / "touch.imomushi";
    REQUIRE(saveProject(path, project));
    const auto opened = openProject(path);
    REQUIRE(opened);
    const TouchResponse &a = response->touch, &b = opened->responses.at(id).response->touch;
    CHECK(b.patches.centre == a.patches.centre);
    CHECK(b.patches.reach == a.patches.reach);
    CHECK(b.patches.first == a.patches.first);
    CHECK(b.patches.patch == a.patches.patch);
    CHECK(b.patches.weight == a.patches.weight);
    CHECK(b.displacement == a.displacement);
    CHECK(b.forces == a.forces);
    CHECK(b.compliance == a.compliance);
    CHECK(b.probes == a.probes);
    CHECK(b.gradients == a.gradients);
    CHECK(b.asymmetry == a.asymmetry);
    CHECK(b.negativeEnergy == a.negativeEnergy);
    auto told = std::make_shared<ElementResponse>(*response);
    told->quality.tetrahedra = 12'345;
    told->quality.noFilling = "Why not.";
    project.responses[id].response = told;
    REQUIRE(saveProject(path, project));
    const auto again = openProject(path);
    REQUIRE(again);
    CHECK(again->responses.at(id).response->quality.tetrahedra == 12'345);
    CHECK(again->responses.at(id).response->quality.noFilling == "Why not.");

    const auto refused = [&](auto breaks) {
        auto broken = std::make_shared<ElementResponse>(*response);
        breaks(broken->touch);
        project.responses[id].response = broken;
        const auto saved = saveProject(path, project);
        return !saved && saved.error().code == "not-sound" && saved.error().message.find("the response of element \"A\"") != std::string::npos;
    };
    CHECK(refused([](TouchResponse& t) { t.patches.patch[3] = 6; }));
    CHECK(refused([](TouchResponse& t) { t.patches.first[1] = -1; }));
    CHECK(refused([](TouchResponse& t) { t.patches.weight[0] = std::numeric_limits<float>::quiet_NaN(); }));
    CHECK(refused([](TouchResponse& t) { t.displacement.conservativeResize(t.displacement.rows(), 17); }));
    CHECK(refused([](TouchResponse& t) { t.gradients(0, 0) = std::numeric_limits<float>::infinity(); }));
    CHECK(refused([](TouchResponse& t) { t.probes[0] = 1'000'000; }));
}

TEST_CASE("packed response: it comes back bit by bit, and what is damaged or belongs elsewhere is refused") {
    Workbench w;
    w.buildChain();
    const Element& element = *w.session.document().elements.begin()->second;
    ResponseInput input;
    input.mesh = element.mesh;
    input.faces = element.faces;
    input.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
    input.basis = {BasisKind::Modes, 4};
    input.loads = BodyLoads::Always;
    input.touch = 6;
    const ElementResponse response = buildResponse(input, {}).value();
    const auto packed = packResponse(response);
    REQUIRE(packed);
    const auto back = unpackResponse(*packed, input.mesh->body, input.faces);
    REQUIRE(back);
    CHECK(back->freeVertices == response.freeVertices);
    CHECK(back->bases == response.bases);
    CHECK(back->firstColumn == response.firstColumn);
    CHECK(back->response == response.response);
    CHECK(back->stiffness == response.stiffness);
    CHECK(back->loads == response.loads);
    CHECK(back->loadForces == response.loadForces);
    CHECK(back->touch.displacement == response.touch.displacement);
    CHECK(back->quality.error == response.quality.error);
    CHECK(packResponse(*back).value() == *packed);
    ElementResponse filled = response;
    filled.quality.tetrahedra = 12'345;
    filled.quality.noFilling = "ただの例";
    const auto told = unpackResponse(packResponse(filled).value(), input.mesh->body, input.faces);
    REQUIRE(told);
    CHECK(told->quality.tetrahedra == 12'345);
    CHECK(told->quality.noFilling == filled.quality.noFilling);

    CHECK(unpackResponse({}, input.mesh->body, input.faces).error().code == "damaged");
    CHECK(unpackResponse(std::span(*packed).first(packed->size() / 2), input.mesh->body, input.faces).error().code == "damaged");
    CHECK(unpackResponse(*packed, input.mesh->body, std::span(input.faces).first(input.faces.size() - 1)).error().code == "damaged");
    auto flipped = *packed;
    flipped[flipped.size() / 2] ^= std::byte{1};
    const auto read = unpackResponse(flipped, input.mesh->body, input.faces);
    CHECK((!read || packResponse(*read).value() == *packed));  // a bit that belongs to no value changes nothing
}
