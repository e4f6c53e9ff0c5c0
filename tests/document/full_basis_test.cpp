// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

Points current(Workbench& w, const std::string& element) {
    const auto path = Workbench::folder() / "current.obj";
    w.good({{"do", "write-mesh"}, {"path", path.string()}, {"element", element}});
    std::ifstream file(path);
    std::vector<double> values;
    for (std::string word; file >> word;)
        if (word == "v")
            for (int k = 0; k < 3; ++k) {
                file >> word;
                values.push_back(std::stod(word));
            }
    return Eigen::Map<const Points>(values.data(), static_cast<Eigen::Index>(values.size() / 3), 3);
}

Json setBasis(const char* basis) { return {{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", basis}}; }

}  // namespace

TEST_CASE("basis full: a drag gives what the affine basis gives, for bones move faces by affine maps") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const Json drag = {{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.9, 0.4, 5.6}}, {"roll", 0.3}};
    w.good(drag);
    const Points a = current(w, "A"), b = current(w, "B");
    w.good({{"do", "rest"}});
    w.good(setBasis("full"));
    const Json estimated = w.good({{"do", "estimate"}}), solved = w.good({{"do", "precompute"}});
    CHECK(estimated["elements"][0]["columns"] == 54);  // two faces of nine vertices
    CHECK(estimated["elements"][0]["bytes"].get<double>() > 0.0);
    CHECK(estimated["elements"][0]["ms_per_frame"].get<double>() > 0.0);
    CHECK(solved["elements"][0]["columns"] == 54);
    w.good(drag);
    CHECK((current(w, "A") - a).cwiseAbs().maxCoeff() <= 1e-9);
    CHECK((current(w, "B") - b).cwiseAbs().maxCoeff() <= 1e-9);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() <= 1e-12);
    w.good({{"do", "undo"}});
}

TEST_CASE("basis full: deform-element says the same in all models, for any displacement of vertices") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    const Json face = w.addFace("A", "out", 3, 1);
    w.addFace("A", "in", 0, -1);
    const Json one = {{std::to_string(face["indices"][0].get<int>()), {0.02, -0.01, 0.1}}};
    Json deform = {{"do", "deform-element"}, {"element", "A"}, {"faces", {{"out", {{"vertices", one}}}}}, {"model", "full"}};
    w.good(deform);
    const Points direct = current(w, "A");
    deform["model"] = "previous";
    w.good(deform);
    CHECK(current(w, "A") == direct);
    w.good(setBasis("full"));
    for (const char* model : {"full", "previous", "reduced"}) {
        deform["model"] = model;
        const Json answer = w.good(deform);
        CHECK(answer["basis_error"].get<double>() <= 1e-15);
        CHECK((current(w, "A") - direct).cwiseAbs().maxCoeff() <= 1e-10);
    }
}

TEST_CASE("basis full: responses are kept in files, and one of another face is not used") {
    Workbench w;
    w.buildChain();
    w.good(setBasis("full"));
    w.good({{"do", "precompute"}});
    const PartId a = w.session.document().elementNamed("A")->id;
    const auto before = w.session.responses().store().find(responseKey(w.session.responseInput(a)));
    REQUIRE(before);
    CHECK(before->tractions.rows() == 54);
    const auto path = (Workbench::folder() / "full.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    other.good({{"do", "open"}, {"path", path}});
    CHECK(other.session.document().settings.basis == BasisKind::Full);
    CHECK(other.session.responseState(other.session.document().elementNamed("A")->id) == Session::ResponseState::Fresh);
    const auto after = other.session.responses().store().find(responseKey(other.session.responseInput(a)));
    REQUIRE(after);
    CHECK(after->bases == before->bases);
    CHECK(after->response == before->response);
    CHECK(after->stiffness == before->stiffness);
    CHECK(after->tractions == before->tractions);
    other.good(setBasis("affine"));
    CHECK(other.session.responseState(a) != Session::ResponseState::Fresh);
}

TEST_CASE("body loads: a response with them is kept in files") {
    Workbench w;
    w.buildChain();
    Project project;
    project.document = w.session.document();
    const PartId a = project.document.elementNamed("A")->id;
    ResponseInput input = w.session.responseInput(a);
    input.loads = BodyLoads::Always;
    input.solverMesh.kind = SolverMeshSetting::Kind::AsIs;
    auto response = buildResponse(input, {});
    REQUIRE(response);
    const auto kept = std::make_shared<const ElementResponse>(std::move(*response));
    project.responses[a] = {responseKey(input), responseKey(input), kept};
    const auto path = Workbench::folder() / "loads.imomushi";
    REQUIRE(saveProject(path, project));
    const auto opened = openProject(path);
    REQUIRE(opened);
    const auto& read = *opened->responses.at(a).response;
    CHECK(read.loads == kept->loads);
    CHECK(read.loadForces == kept->loadForces);
    CHECK(read.loads.size() > 0);
}
