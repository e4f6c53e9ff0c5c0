// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "core/character/character.h"
#include "core/character/welded_surface.h"
#include "core/commands/core_commands.h"
#include "core/document/material_preset.h"
#include "core/mesh/cgal/intersections.h"
#include "core/mesh/topology.h"
#include "core/reports/report_commands.h"
#include "core/session/session.h"
#include "tests/support/folder.h"
#include "tests/support/plain_sample.h"

using namespace imomushi;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

namespace {

const fs::path kSamples = IMOMUSHI_SAMPLES;

struct Sample {
    const char* name;
    int elements, bones, joints;
};
constexpr Sample kAll[] = {{"caterpillar", 5, 5, 4}, {"octopus", 25, 33, 24}, {"figure", 14, 19, 13}, {"dragon", 9, 14, 8}};
constexpr std::span kInParts(kAll, 3);  // those with a mesh per element

/// Runs a script inside a folder, without a display; every line must succeed. The answers.
std::vector<Json> run(const fs::path& folder, const fs::path& script) {
    const fs::path out = script.string() + ".out";
    const std::string command = "cd '" + folder.string() + "' && env -u DISPLAY -u WAYLAND_DISPLAY '" IMOMUSHI_PROGRAM "' run '" + script.string() + "' >'" + out.string() + "'";
    const int status = std::system(command.c_str());
    std::vector<Json> answers;
    std::ifstream lines(out);
    for (std::string line; std::getline(lines, line);) {
        answers.push_back(Json::parse(line));
        if (!answers.back()["ok"].get<bool>()) FAIL(line);
    }
    REQUIRE(WIFEXITED(status));
    REQUIRE(WEXITSTATUS(status) == 0);
    return answers;
}

std::vector<Json> run(const TestFolder& folder, const std::vector<Json>& lines) {
    const fs::path script = folder / "script.jsonl";
    std::ofstream file(script, std::ios::binary);
    for (const Json& line : lines) file << line.dump() << "\n";
    file.close();
    return run(folder.path(), script);
}

Points readVertices(const fs::path& obj) {
    std::vector<double> values;
    std::ifstream file(obj);
    for (std::string line; std::getline(file, line);) {
        if (line.rfind("v ", 0) != 0) continue;
        std::istringstream text(line.substr(2));
        for (double x; text >> x;) values.push_back(x);
    }
    REQUIRE(values.size() % 3 == 0);
    Points points(static_cast<Eigen::Index>(values.size() / 3), 3);
    std::copy(values.begin(), values.end(), points.data());
    return points;
}

/// An answer without what two computers may see differently.
Json withoutTimes(Json answer) {
    for (const char* key : {"ms", "ms_per_frame", "stages", "effects", "seconds"}) answer.erase(key);
    return answer;
}

}  // namespace

TEST_CASE("samples: each opens with all its parts, precomputed, and 1978 vertices make the caterpillar") {
    for (const Sample& sample : kAll) {
        CAPTURE(sample.name);
        const TestFolder folder;
        const Json opened = run(folder, {{{"do", "open"}, {"path", (kSamples / (std::string(sample.name) + ".imomushi")).string()}}})[0];
        CHECK(int(opened["elements"].size()) == sample.elements);
        CHECK(int(opened["bones"].size()) == sample.bones);
        CHECK(int(opened["joints"].size()) == sample.joints);
        int vertices = 0;
        for (const Json& element : opened["elements"]) {
            CHECK(element["state"] == "fresh");
            vertices += element["vertices"].get<int>();
        }
        if (sample.name == std::string("caterpillar")) CHECK(vertices == 1978);
        CHECK(fs::file_size(kSamples / (std::string(sample.name) + ".imomushi")) < 10'000'000);
    }
}

TEST_CASE("samples: the script beside the meshes makes what the project file holds, from sound meshes and flat faces that match") {
    for (const Sample& sample : kInParts) {
        CAPTURE(sample.name);
        const std::string name = sample.name;
        const TestFolder folder;
        fs::copy(kSamples / name, folder / name);
        int faceVertices = 0, faces = 0;
        for (const Json& answer : run(folder / name, folder / (name + "/make.jsonl"))) {
            const std::string command = answer["do"];
            if (command == "import-element") {
                REQUIRE(answer["elements"].size() == 1);
                CHECK(answer["elements"][0]["closed"] == true);
                CHECK(answer["elements"][0]["components"] == 1);
                for (const Json& issue : answer["issues"]) CHECK(issue["code"] == "unwelded");  // the seam of the texture; anything else is a flaw
            } else if (command == "add-joint-face") {
                CHECK(answer["planarity_error"].get<double>() <= 1e-6);  // coordinates of a metre in float
                faceVertices += answer["vertices"].get<int>();
                ++faces;
            } else if (command == "join") {
                CHECK(answer["welded"].get<int>() > 0);
                CHECK(answer["unmatched"] == 0);
                CHECK(answer["largest_gap"] == 0.0);
            }
        }
        CHECK(faces == 2 * sample.joints);
        if (name == "caterpillar") CHECK(std::abs(faceVertices / 5.0 - 65) < 5);  // as in the paper's experiment

        // The same document, and the same motion up to the rounding of another computer's linear algebra.
        std::vector<Json> opened[2];
        const fs::path files[] = {folder / (name + ".imomushi"), kSamples / (name + ".imomushi")};
        for (int i = 0; i < 2; ++i) {
            const TestFolder work;
            opened[i] = run(work, {{{"do", "open"}, {"path", files[i].string()}}, {{"do", "write-mesh"}, {"path", (folder / ("rest" + std::to_string(i) + ".obj")).string()}, {"state", "rest"}}});
            const std::string tip = opened[i][0]["bones"].back()["name"].get<std::string>() + "/end";
            std::vector<Json> lines = {{{"do", "open"}, {"path", files[i].string()}}};
            for (const Json& line : plainLines(name)) lines.push_back(line);
            lines.push_back({{"do", "drag"}, {"endpoint", tip}, {"to", {0.3, 0.9, 0.4}}});
            lines.push_back({{"do", "write-mesh"}, {"path", (folder / ("posed" + std::to_string(i) + ".obj")).string()}, {"state", "current"}});
            run(work, lines);
        }
        CHECK(opened[0][0] == opened[1][0]);
        CHECK(readFile(folder / "rest0.obj") == readFile(folder / "rest1.obj"));
        const Points a = readVertices(folder / "posed0.obj"), b = readVertices(folder / "posed1.obj"), rest = readVertices(folder / "rest0.obj");
        REQUIRE(a.rows() == b.rows());
        CHECK((a - b).cwiseAbs().maxCoeff() < 1e-6);
        CHECK((a - rest).cwiseAbs().maxCoeff() > 0.1);
    }
}

TEST_CASE("samples: the mended body of the dragon carries its wings and is far from them, so that by itself a wrap takes its place, whatever its openings enclose") {
    const TestFolder folder;
    std::ofstream(folder / "wrap.jsonl") << Json{{"do", "import-character"}, {"path", (kSamples / "dragon/dragon.glb").string()}, {"name", "dragon"}}.dump() << "\n";
    const auto answers = run(folder.path(), folder / "wrap.jsonl");
    REQUIRE(!answers.empty());
    const Json& body = answers.back()["body"];
    CHECK(body["how"] == "wrapped");
    CHECK(body["distance"]["rms"].get<double>() < 0.02);  // what the report calls far
    CHECK(body["volume_error"].is_null());
}

TEST_CASE("samples: the dragon's file has parts, openings, a skeleton, clips and a morph target, and its script makes what the project file holds, here with coarse answers") {
    const TestFolder folder;
    fs::create_directory(folder / "dragon");
    fs::copy(kSamples / "dragon/dragon.glb", folder / "dragon");
    std::ifstream lines(kSamples / "dragon/make.jsonl");
    std::ofstream script(folder / "dragon/make.jsonl", std::ios::binary);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        Json command = Json::parse(line);
        if (command["do"] == "make-soft") command["draft"] = true, command["precompute"] = false;
        script << command.dump() << "\n";
    }
    script << Json{{"do", "drag"}, {"endpoint", "head/end"}, {"to", {0.4, 1.7, 0.3}}} << "\n"
           << Json{{"do", "step"}, {"frames", 5}} << "\n"
           << Json{{"do", "measure"}, {"what", "gap"}} << "\n"
           << Json{{"do", "write-mesh"}, {"path", "rest.obj"}, {"state", "rest"}} << "\n"
           << Json{{"do", "write-mesh"}, {"path", "posed.obj"}, {"state", "current"}} << "\n";
    script.close();
    Json soft;
    for (const Json& answer : run(folder / "dragon", folder / "dragon/make.jsonl")) {
        if (answer["do"] == "make-soft") soft = answer;
        if (answer["do"] == "step") CHECK(answer["finite"] == true);
        if (answer["do"] == "measure") CHECK(answer["value"].get<double>() < 1e-12);
    }
    const auto names = [](const Json& list) {
        std::vector<std::string> all;
        for (const Json& item : list) all.push_back(item["name"]);
        return all;
    };
    CHECK(names(soft["parts"]) == std::vector<std::string>{"body", "tongue", "teeth", "eye.L", "horn.L", "wing.L", "eye.R", "horn.R", "wing.R"});
    CHECK(soft["skeleton"].size() == 16);
    CHECK(names(soft["clips"]) == std::vector<std::string>{"wave", "breathe"});
    CHECK(names(soft["morphs"]) == std::vector<std::string>{"smile"});
    CHECK(soft["body"]["how"] == "mended");
    CHECK(soft["refused"].empty());
    const auto open = std::find_if(soft["issues"].begin(), soft["issues"].end(), [](const Json& issue) { return issue["code"] == "open"; });
    REQUIRE(open != soft["issues"].end());
    CHECK((*open)["count"] == 2);  // the sockets of its eyes
    const fs::path files[] = {folder / "dragon.imomushi", kSamples / "dragon.imomushi"};
    Json opened[2];
    for (int i = 0; i < 2; ++i) opened[i] = run(folder, {{{"do", "open"}, {"path", files[i].string()}}})[0];
    CHECK(names(opened[0]["elements"]) == names(opened[1]["elements"]));
    CHECK(opened[0]["bones"] == opened[1]["bones"]);
    CHECK(opened[0]["joints"] == opened[1]["joints"]);
    CHECK(opened[0]["takes"] == opened[1]["takes"]);
    const Points rest = readVertices(folder / "dragon/rest.obj"), posed = readVertices(folder / "dragon/posed.obj");
    REQUIRE(rest.rows() == posed.rows());
    CHECK(posed.allFinite());
    CHECK((posed - rest).cwiseAbs().maxCoeff() > 0.1);
}

TEST_CASE("samples: each performs headless, keeps its joints closed and leaves a picture and a mesh") {
    for (const Sample& sample : kAll) {
        CAPTURE(sample.name);
        const std::string name = sample.name;
        const TestFolder folder;
        fs::copy(kSamples / (name + ".imomushi"), folder.path());
        fs::copy(kSamples / (name + "_perform.jsonl"), folder.path());
        double gap = -1;
        for (const Json& answer : run(folder.path(), folder / (name + "_perform.jsonl"))) {
            if (answer["do"] == "step") {
                CHECK(answer["finite"] == true);
                CHECK(answer["warnings"].empty());
            }
            if (answer["do"] == "measure" && gap < 0) gap = answer["value"];
        }
        CHECK(gap >= 0);
        CHECK(gap < 1e-12);
        CHECK(fs::file_size(folder / (name + ".png")) > 10'000);
        CHECK(readVertices(folder / (name + ".obj")).allFinite());
    }
}

namespace {

/// The bodies of a character without their joint faces, as one surface welded where elements are joined.
struct Skin {
    std::vector<std::pair<int, std::int32_t>> vertices;  ///< element of the character and vertex
    Triangles triangles;

    explicit Skin(const CharacterInput& input) {
        std::map<std::array<long long, 3>, std::int32_t> known;
        std::vector<std::array<std::int32_t, 3>> list;
        for (std::size_t e = 0; e < input.elements.size(); ++e) {
            const auto& element = input.elements[e];
            const TriangleMesh& body = element.mesh->body;
            std::set<std::int32_t> inside;
            for (const JointFace& face : element.faces) inside.insert(face.triangles.begin(), face.triangles.end());
            for (std::int32_t t = 0; t < body.triangles.rows(); ++t) {
                if (inside.contains(t)) continue;
                auto& corners = list.emplace_back();
                for (int k = 0; k < 3; ++k) {
                    const std::int32_t v = body.triangles(t, k);
                    std::array<long long, 3> place{};
                    for (int axis = 0; axis < 3; ++axis) place[static_cast<std::size_t>(axis)] = std::llround(1e7 * body.vertices(v, axis));
                    const auto [at, added] = known.try_emplace(place, static_cast<std::int32_t>(vertices.size()));
                    if (added) vertices.emplace_back(static_cast<int>(e), v);
                    corners[static_cast<std::size_t>(k)] = at->second;
                }
            }
        }
        triangles.resize(static_cast<Eigen::Index>(list.size()), 3);
        for (std::size_t t = 0; t < list.size(); ++t)
            for (int k = 0; k < 3; ++k) triangles(static_cast<Eigen::Index>(t), k) = list[t][static_cast<std::size_t>(k)];
    }

    [[nodiscard]] TriangleMesh of(const Character& character) const {
        std::vector<Points> positions;
        for (std::size_t e = 0; e < character.input().elements.size(); ++e) positions.push_back(character.positions(static_cast<int>(e)));
        TriangleMesh mesh{Points(static_cast<Eigen::Index>(vertices.size()), 3), triangles};
        for (std::size_t v = 0; v < vertices.size(); ++v)
            mesh.vertices.row(static_cast<Eigen::Index>(v)) = positions[static_cast<std::size_t>(vertices[v].first)].row(vertices[v].second);
        return mesh;
    }
};

/// The largest angle between the triangles at an edge whose ends `joint` both marks, degrees.
double sharpest(const TriangleMesh& mesh, const std::vector<char>& joint) {
    double largest = 0.0;
    std::map<std::pair<std::int32_t, std::int32_t>, Vec3> normals;
    for (std::int32_t t = 0; t < mesh.triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) {
            const std::int32_t a = mesh.triangles(t, k), b = mesh.triangles(t, (k + 1) % 3);
            if (!joint[static_cast<std::size_t>(a)] || !joint[static_cast<std::size_t>(b)]) continue;
            const Vec3 normal = areaVector(mesh, t).normalized();
            if (const auto other = normals.find({b, a}); other != normals.end())
                largest = std::max(largest, std::atan2(normal.cross(other->second).norm(), normal.dot(other->second)));
            normals[{a, b}] = normal;
        }
    return largest * 180.0 / std::numbers::pi;
}

}  // namespace

TEST_CASE("samples: gravity by default sags flesh by 2 to 8 % of the height, without folds or warnings") {
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    for (const Sample& sample : kAll) {
        CAPTURE(sample.name);
        Session session(registry);
        const auto good = [&](const Json& command) {
            const auto answer = session.execute(command);
            if (!answer) FAIL(answer.error().message);
            return *answer;
        };
        good({{"do", "open"}, {"path", (kSamples / (std::string(sample.name) + ".imomushi")).string()}});
        for (const Json& line : plainLines(sample.name)) good(line);
        std::vector<std::string> names;
        for (const auto& [id, element] : session.document().elements) names.push_back(element->name);
        for (const std::string& name : names) good({{"do", "set"}, {"target", name}, {"property", "solver-mesh"}, {"value", "as-is"}});
        good({{"do", "enable"}, {"effect", "gravity"}});
        good({{"do", "precompute"}});
        const Skin skin(session.character()->input());
        const auto& elements = session.character()->input().elements;
        std::vector<char> joint(skin.vertices.size(), 0);
        TriangleMesh rest{Points(static_cast<Eigen::Index>(joint.size()), 3), skin.triangles};
        for (std::size_t v = 0; v < joint.size(); ++v) {
            const auto& [e, vertex] = skin.vertices[v];
            const auto& element = elements[static_cast<std::size_t>(e)];
            rest.vertices.row(static_cast<Eigen::Index>(v)) = element.mesh->body.vertices.row(vertex);
            for (const JointFace& face : element.faces) joint[v] = joint[v] || std::binary_search(face.vertices.begin(), face.vertices.end(), vertex);
        }
        CHECK(good({{"do", "step"}, {"frames", 2}})["warnings"].empty());
        const TriangleMesh now = skin.of(*session.character());
        const double height = (rest.vertices.colwise().maxCoeff() - rest.vertices.colwise().minCoeff()).y();
        const double sag = (now.vertices - rest.vertices).rowwise().norm().maxCoeff() / height;
        double slip = 0.0;
        for (const auto& [endpoint, goal] : session.document().goals) {
            if (!goal.pinned) continue;
            Eigen::Index nearest = 0;
            (rest.vertices.rowwise() - goal.target.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
            slip = std::max(slip, (now.vertices.row(nearest) - rest.vertices.row(nearest)).norm() / height);
        }
        const double crease = sharpest(now, joint), before = sharpest(rest, joint);
        MESSAGE(std::string(sample.name) << ": sag " << 100.0 * sag << " % of the height, beside pins " << 100.0 * slip << " %, sharpest edge at joints " << crease << " degrees, " << before << " at rest");
        CHECK(sag >= 0.02);
        CHECK(sag <= 0.08);
        CHECK(crease <= before + 20.0);  // bones hold faces, flesh hangs between them
        CHECK(slip <= sag);
    }
}

TEST_CASE("samples: flesh of each preset sags as far as the preset says, whatever the size, without warnings") {
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    for (const Sample& sample : kAll) {
        CAPTURE(sample.name);
        Session session(registry);
        const auto good = [&](const Json& command) {
            const auto answer = session.execute(command);
            if (!answer) FAIL(answer.error().message);
            return *answer;
        };
        good({{"do", "open"}, {"path", (kSamples / (std::string(sample.name) + ".imomushi")).string()}});
        for (const Json& line : plainLines(sample.name)) good(line);
        good({{"do", "enable"}, {"effect", "gravity"}});
        std::vector<std::string> names;
        for (const auto& [id, element] : session.document().elements) names.push_back(element->name);
        for (const std::string& name : names) good({{"do", "set"}, {"target", name}, {"property", "solver-mesh"}, {"value", "as-is"}});
        for (const MaterialPreset& preset : kMaterialPresets) {
            CAPTURE(preset.name);
            for (const std::string& name : names) good({{"do", "set"}, {"target", name}, {"property", "preset"}, {"value", preset.name}});
            good({{"do", "precompute"}});
            CHECK(good({{"do", "step"}, {"frames", 2}})["warnings"].empty());
            double low = std::numeric_limits<double>::infinity(), high = -low, farthest = 0.0;
            const auto& elements = session.character()->input().elements;
            for (std::size_t e = 0; e < elements.size(); ++e) {
                const Points& rest = elements[e].mesh->body.vertices;
                low = std::min(low, rest.col(1).minCoeff());
                high = std::max(high, rest.col(1).maxCoeff());
                farthest = std::max(farthest, (session.character()->positions(static_cast<int>(e)) - rest).rowwise().norm().maxCoeff());
            }
            const double sag = farthest / (high - low);
            MESSAGE(std::string(sample.name) << ", " << std::string(preset.name) << ": sag " << 100.0 * sag << " % of the height, stated " << 100.0 * preset.sag() << " %");
            CHECK(sag == doctest::Approx(preset.sag()).epsilon(0.25));
        }
    }
}

TEST_CASE("figure: a hand that is twisted twice round turns its arm, and not the head") {
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    for (const bool dynamics : {false, true}) {
        CAPTURE(dynamics);
        Session session(registry);
        const auto good = [&](const Json& command) {
            const auto answer = session.execute(command);
            if (!answer) FAIL(answer.error().message);
            return *answer;
        };
        good({{"do", "open"}, {"path", (kSamples / "figure.imomushi").string()}});
        for (const Json& line : plainLines("figure")) good(line);
        if (dynamics) good({{"do", "enable"}, {"effect", "bone-dynamics"}});
        const auto turnOf = [&](const char* element) {
            return Eigen::Quaterniond(session.character()->frame(session.elementIndex(session.document().elementNamed(element)->id)).linear());
        };
        // The trunk follows its shoulder, a little.
        const std::pair<const char*, double> parts[] = {{"head", 2.0}, {"hand.R", 2.0}, {"foot.L", 2.0}, {"trunk", 30.0}};
        const auto twisted = [&](double roll) {
            good({{"do", "drag"}, {"endpoint", "hand-bone.L/end"}, {"to", {1.021725, 0.758997, 0.08016}}, {"roll", roll}, {"seconds", 1.0}});
            good({{"do", "step"}, {"frames", 300}});
            std::vector<Eigen::Quaterniond> turns;
            for (const auto& part : parts) turns.push_back(turnOf(part.first));
            return turns;
        };
        const auto before = twisted(0.0), after = twisted(4.0 * std::numbers::pi);
        for (std::size_t i = 0; i < before.size(); ++i) {
            const double degrees = before[i].angularDistance(after[i]) * 180.0 / std::numbers::pi;
            MESSAGE(std::string(parts[i].first), std::string(dynamics ? ", with bone dynamics: " : ": "), degrees, " degrees");
            CHECK(degrees < parts[i].second);
        }
        CHECK(good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() < 1e-12);
    }
}

TEST_CASE("figure: with stiff bones in trunk and legs a hand that is pulled by a tenth of the height tilts the trunk by less than 2 degrees") {
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    double worst[2] = {0.0, 0.0}, missed = 0.0;
    for (const bool stiff : {false, true}) {
        Session session(registry);
        const auto good = [&](const Json& command) {
            const auto answer = session.execute(command);
            if (!answer) FAIL(answer.error().message);
            return *answer;
        };
        good({{"do", "open"}, {"path", (kSamples / "figure.imomushi").string()}});
        for (const Json& line : plainLines("figure")) good(line);
        const Vec3 hand(1.021725, 0.758997, 0.08016);
        const double pulled = 0.1 * 2.1;  // the figure is 2.06 m high, to the top of its bones
        if (stiff)
            for (const std::string& bone : {"spine-bone", "neck-bone", "shoulder-bone.L", "shoulder-bone.R", "hip-bone.L", "hip-bone.R", "upper-leg-bone.L", "upper-leg-bone.R",
                                            "lower-leg-bone.L", "lower-leg-bone.R", "foot-bone.L", "foot-bone.R"})
                good({{"do", "set"}, {"target", bone}, {"property", "stiffness"}, {"value", 300.0}});
        const auto trunk = [&] {
            return Eigen::Quaterniond(session.character()->frame(session.elementIndex(session.document().elementNamed("trunk")->id)).linear());
        };
        for (const Vec3& way : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
            good({{"do", "rest"}});
            const Eigen::Quaterniond before = trunk();
            const Vec3 to = hand + pulled * way;
            good({{"do", "drag"}, {"endpoint", "hand-bone.L/end"}, {"to", {to.x(), to.y(), to.z()}}, {"seconds", 0.5}});
            good({{"do", "step"}, {"frames", 120}});
            const double degrees = before.angularDistance(trunk()) * 180.0 / std::numbers::pi;
            MESSAGE(std::string(stiff ? "stiff" : "plain"), ", pulled along ", way.x(), " ", way.y(), " ", way.z(), ": the trunk tilts by ", degrees, " degrees");
            worst[stiff] = std::max(worst[stiff], degrees);
            const auto at = good({{"do", "measure"}, {"what", "position"}, {"endpoint", "hand-bone.L/end"}})["value"];
            if (stiff) missed = std::max(missed, (Vec3(at[0], at[1], at[2]) - to).norm());
        }
    }
    CHECK(worst[0] > 2.0);
    CHECK(worst[1] < 2.0);
    CHECK(missed < 0.01);
}

TEST_CASE("figure: a foot that is pinned with its orientation stays as it points while the body is pulled, and heavy bones are moved less by light ones") {
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    double foot[2][2] = {{0.0, 0.0}, {0.0, 0.0}}, sway[2] = {0.0, 0.0};
    const auto session = [&](bool dynamics) {
        auto made = std::make_unique<Session>(registry);
        REQUIRE(made->execute({{"do", "open"}, {"path", (kSamples / "figure.imomushi").string()}}));
        for (const Json& line : plainLines("figure")) REQUIRE(made->execute(line));
        if (dynamics) REQUIRE(made->execute({{"do", "enable"}, {"effect", "bone-dynamics"}}));
        return made;
    };
    const auto good = [](Session& of, const Json& command) {
        const auto answer = of.execute(command);
        if (!answer) FAIL(answer.error().message);
        return *answer;
    };
    for (const bool dynamics : {false, true})
        for (const bool oriented : {false, true}) {
            const auto of = session(dynamics);
            if (oriented) good(*of, {{"do", "pin"}, {"endpoint", "foot-bone.L/end"}, {"orientation", true}});
            good(*of, {{"do", "unpin"}, {"endpoint", "spine-bone/start"}});
            const Bone& bone = *of->document().boneNamed("foot-bone.L");
            const auto direction = [&]() -> Vec3 { return (*of->positionOf(EndpointRef{bone.id, true}) - *of->positionOf(EndpointRef{bone.id, false})).normalized(); };
            const Vec3 before = direction();
            good(*of, {{"do", "drag"}, {"endpoint", "spine-bone/start"}, {"to", {0.25, 0.65, 0.2}}, {"seconds", 0.2}});
            for (int i = 0; i < 90; ++i) {
                good(*of, {{"do", "step"}, {"frames", 1}});
                foot[dynamics][oriented] = std::max(foot[dynamics][oriented], std::acos(std::min(1.0, before.dot(direction()))) * kDegrees);
            }
            // It is kept through undo, a release and rest, and let go by name.
            if (!oriented || dynamics) continue;
            const auto held = [&] { return of->document().goals.at(EndpointRef{bone.id, true}).rotation.has_value(); };
            good(*of, {{"do", "release"}});
            good(*of, {{"do", "rest"}});
            CHECK(held());
            good(*of, {{"do", "pin"}, {"endpoint", "foot-bone.L/end"}, {"orientation", false}});
            CHECK(!held());
            good(*of, {{"do", "undo"}});
            CHECK(held());
        }
    // A heavy arm and a light trunk, and the other way round.
    for (const bool heavy : {false, true}) {
        const auto of = session(true);
        const std::vector<std::string> arm = {"upper-arm-bone.L", "lower-arm-bone.L", "hand-bone.L"}, trunk = {"spine-bone", "neck-bone", "shoulder-bone.L", "shoulder-bone.R", "head-bone"};
        for (const std::string& bone : heavy ? trunk : arm) good(*of, {{"do", "set"}, {"target", bone}, {"property", "weight"}, {"value", 100.0}});
        const auto top = [&] { return *of->positionOf(EndpointRef{of->document().boneNamed("head-bone")->id, true}); };
        good(*of, {{"do", "drag"}, {"endpoint", "hand-bone.L/end"}, {"to", {1.1, 1.3, 0.3}}, {"seconds", 0.1}});
        good(*of, {{"do", "step"}, {"frames", 300}});
        good(*of, {{"do", "release"}, {"endpoint", "hand-bone.L/end"}});
        Vec3 last = top();
        for (int i = 0; i < 60; ++i) {
            good(*of, {{"do", "step"}, {"frames", 1}});
            sway[heavy] = std::max(sway[heavy], (top() - last).norm());
            last = top();
        }
    }
    MESSAGE("the foot turns by ", foot[0][0], " degrees, pinned with its orientation by ", foot[0][1], "; with bone dynamics ", foot[1][0], " and ", foot[1][1], "; the head moves by ", sway[0], " m per frame when a heavy arm is let go, with a heavy trunk instead by ", sway[1]);
    for (const int dynamics : {0, 1}) {
        CHECK(foot[dynamics][0] > 5.0);
        CHECK(foot[dynamics][1] < 2.0);
    }
    CHECK(sway[1] < 0.85 * sway[0]);
}

namespace {

constexpr double kLength = 2.55;                   // of the caterpillar, m, rounded down
constexpr double kDragStep = 0.01 * kLength;       // m per frame
constexpr int kFrames = 10'000;

/// Targets that wander by one drag step a frame, far beyond reach and back.
std::vector<Vec3> randomWalk() {
    std::vector<Vec3> walk;
    Vec3 target(1.3, 0.45, 0), heading(0, 1, 0);
    unsigned state = 1;
    const auto random = [&] {  // a linear congruence, the same everywhere; -1...1
        state = state * 1664525u + 1013904223u;
        return double(state >> 8) / double(1u << 23) - 1.0;
    };
    constexpr double kBox = 3 * kLength;
    for (int i = 0; i < kFrames; ++i) {
        for (int k = 0; k < 3; ++k) heading[k] += 0.35 * random();
        heading.normalize();
        for (int k = 0; k < 3; ++k)
            if (std::abs(target[k]) > kBox && target[k] * heading[k] > 0) heading[k] = -heading[k];
        target += kDragStep * heading;
        walk.push_back(target);
    }
    return walk;
}

Json dragTo(const Vec3& target) {
    return {{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {target.x(), target.y(), target.z()}}};
}

}  // namespace

TEST_CASE("caterpillar: in a random walk of 10,000 frames no vertex moves more than ten drag steps in any frame") {
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    Session session(registry);
    REQUIRE(session.execute({{"do", "open"}, {"path", (kSamples / "caterpillar.imomushi").string()}}).has_value());
    for (const Json& line : plainLines("caterpillar")) REQUIRE(session.execute(line).has_value());
    std::vector<std::vector<float>> before;
    float largest = 0, sum = 0;  // of squared moves, m^2
    double reach = 0;
    for (const Vec3& target : randomWalk()) {
        REQUIRE(session.execute(dragTo(target)).has_value());
        session.stepFrame(1.0 / 60);
        Character& character = *session.character();
        const int elements = int(character.input().elements.size());
        before.resize(std::size_t(elements));
        for (int e = 0; e < elements; ++e) {
            const auto surface = character.surface(e);
            // Plain numbers, by pointers: twenty million vertices in a test that is not optimised.
            const float *now = surface.positions, *end = now + 3 * surface.vertices, *was = before[e].empty() ? now : before[e].data();
            for (; now != end; now += 3, was += 3) {
                const float x = now[0] - was[0], y = now[1] - was[1], z = now[2] - was[2], square = x * x + y * y + z * z;
                if (square > largest) largest = square;
                sum += square;  // not finite as soon as one is not
            }
            before[e].assign(surface.positions, surface.positions + 3 * surface.vertices);
        }
        const Pose& pose = session.document().pose;
        reach = std::max(reach, (target - pose.points.at(session.pointIndex({session.document().boneNamed("head-bone")->id, true}))).norm());
    }
    const double worst = std::sqrt(double(largest));
    MESSAGE("largest move of a vertex in one frame: " << worst / kDragStep << " drag steps; target at most " << reach << " m out of reach");
    CHECK(std::isfinite(sum));
    CHECK(worst <= 10 * kDragStep);
    CHECK(reach > kLength);
}

TEST_CASE("caterpillar: a random walk of 10,000 steps headless is finite and closed, and the same bytes for 1 and 2 threads") {
    constexpr int kSampled = 250;
    const TestFolder folder;
    const auto script = [&](int threads) {
        std::vector<Json> lines = {{{"do", "open"}, {"path", (kSamples / "caterpillar.imomushi").string()}},
                                   {{"do", "set"}, {"target", "character"}, {"property", "threads"}, {"value", threads}}};
        for (const Json& line : plainLines("caterpillar")) lines.push_back(line);
        int frame = 0;
        for (const Vec3& target : randomWalk()) {
            lines.push_back(dragTo(target));
            lines.push_back({{"do", "step"}, {"frames", 1}});
            if (++frame % kSampled == 0) {
                lines.push_back({{"do", "write-mesh"}, {"path", std::to_string(frame / kSampled) + ".obj"}, {"state", "current"}});
                lines.push_back({{"do", "measure"}, {"what", "gap"}});
            }
        }
        return lines;
    };
    std::vector<std::string> meshes[2], answers[2];
    for (int r = 0; r < 2; ++r) {
        for (const Json& answer : run(folder, script(r + 1))) {
            if (answer["do"] == "step") CHECK(answer["finite"] == true);
            if (answer["do"] == "measure") CHECK(answer["value"].get<double>() < 1e-12);
            answers[r].push_back(withoutTimes(answer).dump());
        }
        for (int i = 1; i <= kFrames / kSampled; ++i) meshes[r].push_back(readFile(folder / (std::to_string(i) + ".obj")));
    }
    CHECK(meshes[0] == meshes[1]);
    CHECK(answers[0] == answers[1]);
}

TEST_CASE("caterpillar: rolled up and back in 600 frames the automatic bend warp folds and crosses nothing, jumps nowhere, and is the product while straight") {
    constexpr int kRolled = 600;
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    Session session(registry);
    REQUIRE(session.execute({{"do", "open"}, {"path", (kSamples / "caterpillar.imomushi").string()}}));
    for (const Json& line : plainLines("caterpillar")) REQUIRE(session.execute(line));
    struct Run {
        double step = 0.0;
        std::vector<double> ms, straightMs;
        int straight = 0, crossings = 0;
        std::vector<std::vector<Points>> frames;
    };
    const auto perform = [&] {
        Run run;
        Character& c = **session.builtCharacter();
        const Skeleton& skeleton = c.input().skeleton;
        const WeldedSurface welded = weldedSurface(c.input(), false);
        const int elements = static_cast<int>(c.input().elements.size());
        c.stop();
        for (int f = 0; f <= kRolled; ++f) {
            const double each = (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * f / kRolled)) * 1.2;  // rad, per joint
            Pose pose = restPose(skeleton);
            for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
                const auto& bone = skeleton.bones[b];
                const Vec3 along = skeleton.points[static_cast<std::size_t>(bone.end)] - skeleton.points[static_cast<std::size_t>(bone.start)];
                if (bone.parent >= 0)
                    pose.frames[b] = pose.frames[static_cast<std::size_t>(bone.parent)] * Eigen::Quaterniond(Eigen::AngleAxisd(each, Vec3::UnitZ()));
                pose.points[static_cast<std::size_t>(bone.end)] = pose.points[static_cast<std::size_t>(bone.start)] + pose.frames[b] * along;
            }
            const auto start = std::chrono::steady_clock::now();
            c.update(pose, 1.0 / 60.0);
            const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
            run.ms.push_back(ms);
            double part = 0.0;
            std::vector<Points> now;
            for (int e = 0; e < elements; ++e) {
                part = std::max(part, c.warpPart(e));
                now.push_back(c.positions(e));
                if (f > 0) run.step = std::max(run.step, (now.back() - run.frames.back()[static_cast<std::size_t>(e)]).rowwise().norm().maxCoeff());
            }
            // Straight: less than 4 degrees at a joint.
            if (part == 0.0) ++run.straight;
            if (each < 0.07) run.straightMs.push_back(ms);
            if (f % 20 == 0) {
                TriangleMesh shown{welded.vertices, welded.triangles};
                for (int e = 0; e < elements; ++e) shown.vertices.middleRows(welded.first[static_cast<std::size_t>(e)], now[static_cast<std::size_t>(e)].rows()) = now[static_cast<std::size_t>(e)];
                // Flesh of elements that are no neighbours meets where the body is rolled up far enough, whatever its shape.
                const auto elementOf = [&](std::int32_t t) { return std::upper_bound(welded.first.begin(), welded.first.end(), shown.triangles(t, 0)) - welded.first.begin(); };
                for (const auto& [a, b] : selfIntersections(shown, 10000)) run.crossings += std::abs(elementOf(a) - elementOf(b)) <= 1;
            }
            run.frames.push_back(std::move(now));
        }
        std::sort(run.ms.begin(), run.ms.end());
        std::sort(run.straightMs.begin(), run.straightMs.end());
        return run;
    };
    const Run plain = perform();
    REQUIRE(session.execute({{"do", "enable"}, {"effect", "bend-warp"}, {"auto", true}}));
    const Run automatic = perform();
    REQUIRE(session.execute({{"do", "enable"}, {"effect", "bend-warp"}, {"auto", false}}));
    const Run always = perform();
    int same = 0;
    for (int f = 0; f <= kRolled; ++f) same += plain.frames[static_cast<std::size_t>(f)] == automatic.frames[static_cast<std::size_t>(f)];
    MESSAGE("product: largest step ", plain.step, " m, ", plain.crossings, " crossing pairs, ", plain.ms[kRolled / 2], " ms per frame (median), straight ", plain.straightMs[plain.straightMs.size() / 2], "; automatic: ", automatic.step, " m, ", automatic.crossings, " (always on: ", always.crossings, "), ", automatic.ms[kRolled / 2], " ms, straight ", automatic.straightMs[automatic.straightMs.size() / 2], " ms; always on ", always.ms[kRolled / 2], " ms; ",
            automatic.straight, " frames without, ", same, " the same bytes");
    CHECK(plain.crossings > 0);
    CHECK(automatic.crossings == 0);
    CHECK(automatic.step < 1.5 * plain.step);
    CHECK(automatic.straight > 50);
    CHECK(same >= automatic.straight);
}
