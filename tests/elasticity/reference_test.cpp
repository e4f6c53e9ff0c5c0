// SPDX-License-Identifier: GPL-3.0-or-later
// Against second-order finite elements on exactly the same polyhedra (tests/data/reference/README.md).
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/reduction/element_response.h"
#include "tests/support/bisected_body.h"
#include "tests/support/obj.h"
#include "tests/support/reference_case.h"
#include "tests/support/thorough.h"

using namespace imomushi;
using nlohmann::json;

namespace {

const std::string kFolder = std::string(IMOMUSHI_TEST_DATA) + "/reference/";

json readJson(const std::string& name) {
    std::ifstream file(kFolder + name);
    REQUIRE_MESSAGE(file, name);
    return json::parse(file);
}

/// Relative L2 errors over the free vertices. Those of "as-is" are what a straightforward vertex collocation reaches (the table of the README, two
/// digits), those of the other settings what they promise.
struct Bound {
    double stretch, bend, tiltShift, asym;
    [[nodiscard]] double of(const std::string& name) const {
        constexpr double kRounding = 1.02;
        return kRounding * (name == "stretch" ? stretch : name == "bend" ? bend : name == "tilt_shift" ? tiltShift : asym);
    }
};

/// Modes beyond the paper's shear faces in their planes and are harder for flesh that leaves them at flat angles, the more so the less it can get smaller.
constexpr double kDefaultMode = 0.01;

/// The largest error over the joint modes, and what is stated of it. `original`: the body of `modes`, whose vertices are the first of the one that was solved.
void checkStated(const ReferenceBody& original, const std::string& solverMesh, const ReferenceModes& modes, const ElementResponse& response) {
    const Points& at = original.mesh->body.vertices;
    const auto heldCount = static_cast<double>(at.rows()) - static_cast<double>(original.freeVertices.size()), count = static_cast<double>(modes.vertices.size());
    double largest = 0.0;
    Eigen::Index m = 0;
    for (std::size_t f = 0; f < response.bases.size(); ++f)
        for (int c = 0; c < response.bases[f].columns(); ++c, ++m) {
            double held = 0.0, wrong = 0.0, moved = 0.0;
            for (const std::int32_t v : original.faces[f].vertices) held += response.bases[f].at(original.faces[f].frame.toLocal(at.row(v).transpose())).col(c).squaredNorm();
            for (std::size_t i = 0; i < modes.vertices.size(); ++i) {
                const auto place = std::lower_bound(response.freeVertices.begin(), response.freeVertices.end(), modes.vertices[i]) - response.freeVertices.begin();
                const Vec3 expected = modes.displacement[static_cast<std::size_t>(m)].row(static_cast<Eigen::Index>(i)).transpose();
                wrong += (response.response.block<3, 1>(3 * place, m) - expected).squaredNorm();
                moved += expected.squaredNorm();
            }
            largest = std::max(largest, std::sqrt(wrong / count / (moved / count + held / heldCount)));
        }
    REQUIRE(m == static_cast<Eigen::Index>(modes.displacement.size()));
    const ResponseQuality& quality = response.quality;
    const double stated = quality.error + quality.mappingError;
    MESSAGE(original.name, " ", solverMesh, " nu ", modes.nu, ": largest error of a mode ", 100.0 * largest, " %, stated ", 100.0 * stated, " %, ratio ", stated / largest, ", nodes ",
            quality.solverNodes, std::string(quality.decimated ? ", decimated, " : ", "), quality.seconds, " s");
    CHECK(largest <= (solverMesh == "draft" ? 0.1 : kDefaultMode));
    CHECK(stated >= largest / 1.5);
    CHECK(stated <= 3.0 * largest);
}

/// The same at one Poisson ratio. `vertices`: the body is bisected to so many.
void compareModes(const std::string& name, const std::string& solverMesh, double nu, int vertices = 0) {
    const ReferenceBody original = readReferenceBody(kFolder, name);
    ReferenceBody body = original;
    if (vertices > 0) bisect(body, vertices);
    ResponseInput input;
    input.mesh = body.mesh;
    input.faces = body.faces;
    input.nu = nu;
    input.basis = BasisKind::Affine;
    input.threads = 2;
    input.solverMesh = parseSolverMesh(solverMesh).value();
    const auto response = buildResponse(input, {});
    REQUIRE(response);
    int compared = 0;
    for (const ReferenceModes& modes : readReferenceModes(kFolder, name))
        if (modes.nu == nu) checkStated(original, solverMesh, modes, *response), ++compared;
    CHECK(compared == 1);
}

/// Checks every case of the Poisson ratios that `bounds` has, and what a draft and the default state. asym, whose free vertices hardly move, is measured against all vertices' motion.
void compare(const std::string& name, const std::string& solverMesh, const std::map<double, Bound>& bounds) {
    const json facts = readJson(name + ".faces.json"), answers = readJson(name + ".json");
    const auto mesh = std::make_shared<ElementMesh>();
    mesh->body = readObj(kFolder + name + ".obj");
    ResponseInput input;
    input.mesh = mesh;
    const bool states = solverMesh == "default" || solverMesh == "draft";
    input.basis = states ? BasisKind::Affine : BasisKind::Paper;
    input.threads = 2;
    input.solverMesh = parseSolverMesh(solverMesh).value();
    std::vector<std::string> faceNames;
    for (const json& face : facts["faces"]) {
        auto made = jointFaceByVertices(mesh->body, face["vertices"].get<std::vector<std::int32_t>>());
        REQUIRE(made);
        made->name = face["name"];
        faceNames.push_back(made->name);
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<std::size_t>(k);
            CHECK(made->frame.origin[k] == doctest::Approx(face["origin"][i].get<double>()).epsilon(1e-9));
            CHECK(made->frame.axes(k, 0) == doctest::Approx(face["x_axis"][i].get<double>()).epsilon(1e-9));
            CHECK(made->frame.axes(k, 2) == doctest::Approx(face["normal"][i].get<double>()).epsilon(1e-9));
        }
        input.faces.push_back(*made);
    }
    std::map<double, ElementResponse> responses;
    std::size_t checked = 0;
    std::map<double, double> largest;  // in the norm of what is stated: relative to free and held vertices together
    for (const json& result : answers["results"]) {
        const double nu = result["nu"];
        const std::string which = result["case"];
        const auto bound = bounds.find(nu);
        if (bound == bounds.end()) continue;
        if (!responses.contains(nu)) {
            input.nu = nu;
            auto response = buildResponse(input, {});
            REQUIRE(response);
            MESSAGE(name, " nu ", nu, ": ", response->quality.seconds, " s, residual ", response->quality.solve.residual, ", estimated error ",
                    100.0 * response->quality.error, " %, nodes ", response->quality.solverNodes, ", rcond ", response->quality.solve.rcond, ", asymmetry ", response->quality.asymmetry, ", negative energy ",
                    response->quality.negativeEnergy);
            CHECK(response->quality.solve.residual <= 1e-10);
            CHECK((response->quality.tetrahedra > 0) == (solverMesh != "as-is"));
            responses.emplace(nu, std::move(*response));
        }
        const ElementResponse& response = responses.at(nu);
        Eigen::VectorXd v = Eigen::VectorXd::Zero(response.columns());
        for (std::size_t f = 0; f < faceNames.size(); ++f) {
            if (!result["faces"].contains(faceNames[f])) continue;
            const json& p = result["faces"][faceNames[f]];
            const PaperParameters parameters{p.value("a", 1.0), p.value("b", 1.0), p.value("theta1", 0.0), p.value("theta2", 0.0), p.value("dz", 0.0)};
            double lost = 0.0;
            response.bases[f].coefficients(jointMap(parameters), input.faces[f].size, v.data() + response.firstColumn[f], lost);
            CHECK(lost <= 1e-12);
        }
        const Eigen::VectorXd u = response.response * v;
        const json& expected = result["displacement"];
        double all = 0.0, free = 0.0, error = 0.0;
        for (const json& d : expected) all += Vec3(d[0], d[1], d[2]).squaredNorm();
        for (std::size_t i = 0; i < response.freeVertices.size(); ++i) {
            const json& d = expected[static_cast<std::size_t>(response.freeVertices[i])];
            const Vec3 reference(d[0], d[1], d[2]);
            free += reference.squaredNorm();
            error += (u.segment<3>(3 * static_cast<Eigen::Index>(i)) - reference).squaredNorm();
        }
        const auto rows = static_cast<double>(expected.size()), freeRows = static_cast<double>(response.freeVertices.size());
        largest[nu] = std::max(largest[nu], std::sqrt(error / freeRows / (free / freeRows + (all - free) / (rows - freeRows))));
        const double relative = std::sqrt(error / (which == "asym" ? all : free));
        MESSAGE(name, " ", solverMesh, " ", which, " nu ", nu, ": ", 100.0 * relative, " %");
        CHECK(relative <= bound->second.of(which));
        ++checked;
    }
    CHECK(checked == 4 * bounds.size());
    if (!states) return;
    for (const auto& [nu, error] : largest) {
        MESSAGE(name, " ", solverMesh, " nu ", nu, ": largest error ", 100.0 * error, " %");
        CHECK(error <= (solverMesh == "draft" ? 0.1 : 0.01));
    }
    const ReferenceBody body = readReferenceBody(kFolder, name);
    for (const ReferenceModes& modes : readReferenceModes(kFolder, name))
        if (responses.contains(modes.nu)) checkStated(body, solverMesh, modes, responses.at(modes.nu));
}

constexpr const char* kBodies[] = {"a_cylinder_coarse", "a_cylinder_fine", "b_prism_coarse", "c_barrel_coarse", "d_tentacle_coarse", "d_tentacle_fine", "e_body_coarse", "f_fin_coarse",
                                   "f_fin_one_face_coarse", "g_hexagon_coarse", "h_elbow_coarse", "i_hollow_elbow_coarse", "j_bored_elbow_coarse", "k_caterpillar_coarse",
                                   "l_barrel_coarse", "l_barrel_fine"};

}  // namespace

TEST_CASE("element: its own mesh, as a modelling program leaves it, gives what a straightforward collocation gives") {
    compare("a_cylinder_coarse", "as-is", {{0.3, {.0045, .0052, .0029, .0121}}, {0.45, {.0060, .0102, .0063, .0190}}});
    compare("c_barrel_coarse", "as-is", {{0.3, {.055, .081, .036, .036}}, {0.45, {.056, .078, .041, .030}}});
}

TEST_CASE("element: a draft is within 10 % of second-order finite elements, and says by how much") {
    const Bound bound{.10, .10, .10, .10};
    for (const char* name : kBodies) compare(name, "draft", {{0.3, bound}, {0.45, bound}});
}

TEST_CASE("element: the default is within 1 % of second-order finite elements, 2 % of what the free flesh moves, and says by how much") {
    const Bound bound{.02, .02, .02, .02};
    std::map<double, Bound> bounds{{0.45, bound}};  // the harder of the two
    if (repeats(0, 1) > 0) bounds.emplace(0.3, bound);
    for (const char* name : kBodies) compare(name, "default", bounds);
}

TEST_CASE("element: what is stated of joint modes holds for flesh that hardly gets smaller, too") {
    for (const char* name : {"a_cylinder_coarse", "c_barrel_coarse", "e_body_coarse"})
        for (const char* solverMesh : {"draft", "default"}) compareModes(name, solverMesh, 0.49);
}

TEST_CASE("element: what is stated of joint modes holds for the same bodies of many vertices, which are decimated") {
    for (const char* name : {"a_cylinder_coarse", "c_barrel_coarse", "e_body_coarse"})
        for (const int vertices : {2000, 8000}) {
            compareModes(name, "draft", 0.45, vertices);
            if ((vertices == 2000 && name == std::string("c_barrel_coarse")) || repeats(0, 1) > 0) compareModes(name, "default", 0.45, vertices);
        }
}

TEST_CASE("element: a thousand vertices filled with tetrahedra are within 5 % of second-order finite elements with many more at rims") {
    const Bound bound{.05, .05, .05, .05};
    for (const char* name : {"a_cylinder_coarse", "e_body_coarse", "i_hollow_elbow_coarse"}) compare(name, "volume:1000", {{0.45, bound}});
}

TEST_CASE("element: the best setting is within 1 % of second-order finite elements, 1.5 % where a body has three faces") {
    const Bound bound{.01, .01, .01, .01};
    compare("c_barrel_coarse", "best", {{0.45, bound}});
    compare("f_fin_coarse", "best", {{0.3, bound}});
}
