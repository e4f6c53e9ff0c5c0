// SPDX-License-Identifier: GPL-3.0-or-later
// The reference driver for three.js against the character, where node is installed.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/session/session.h"
#include "tests/document/workbench.h"
#include "tests/export/read_glb.h"
#include "tests/support/left_out.h"
#include "tests/support/printed.h"

using namespace imomushi;

namespace {

Json skeletonData(const std::filesystem::path& glb) {
    const std::string bytes = readFile(glb);
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    const Json file = Json::parse(bytes.substr(20, length));
    for (const Json& node : file["nodes"])
        if (node.contains("extras") && node["extras"].contains("imomushi")) return node["extras"]["imomushi"];
    FAIL("there is no data for drivers");
    return {};
}

/// Exports the shown pose and lets the driver pose the same: weights of all targets.
void checkDriven(Workbench& w) {
    const auto path = Workbench::folder() / "driven.glb";
    w.good({{"do", "export"}, {"layout", "rigged"}, {"path", path.string()}});

    const Character& character = *w.session.character();
    const Pose& pose = w.session.shownPose();
    Json told{{"points", Json::array()}, {"rolls", pose.roll}, {"rotations", Json::array()}, {"weights", Json::array()}};
    for (const Vec3& p : pose.points) told["points"].push_back({p.x(), p.y(), p.z()});
    for (const auto& q : pose.frames) told["rotations"].push_back({q.x(), q.y(), q.z(), q.w()});
    std::vector<double> shape(static_cast<std::size_t>(character.shapeLayout().size()));
    character.shape(shape.data());
    double largest = 0.0;
    const Json data = skeletonData(path);
    for (std::size_t e = 0; e < data["elements"].size(); ++e) {
        const double* v = shape.data() + character.shapeLayout().element(e) + ShapeLayout::kFrame;
        const Json& matrix = data["elements"][e]["matrix"];
        const auto columns = data["elements"][e]["columns"].get<std::size_t>();
        Json weights = Json::array();
        for (std::size_t t = 0; t * columns < matrix.size(); ++t) {
            double sum = 0.0;
            for (std::size_t c = 0; c < columns; ++c) sum += matrix[t * columns + c].get<double>() * v[c];
            weights.push_back(sum);
            largest = std::max(largest, std::abs(sum));
        }
        told["weights"].push_back(weights);
    }
    CHECK(largest > 0.01);
    Workbench::writeFile(Workbench::folder() / "pose.json", told.dump());
    const std::string out = printed("node '" IMOMUSHI_EXPORT_TESTS "/check_weights.mjs' '" + path.string() + "' '" + (Workbench::folder() / "pose.json").string() + "' '" IMOMUSHI_DRIVERS "/three.js' 2>&1");
    INFO(out);
    // Both work in double precision, by the same steps; sums are in another order.
    CHECK(std::atof(out.c_str()) < 1e-9);
    CHECK(out.find("rror") == std::string::npos);
}

}  // namespace

TEST_CASE("driver: smooth joints, gravity and inflation weigh morph targets as the character does") {
    if (printed("node --version 2>/dev/null").empty()) return leaveOut("node is not installed");
    for (const char* basis : {"paper", "affine", "modes:6"})
        for (const auto& effects : std::initializer_list<std::vector<const char*>>{{}, {"gravity", "inflate"}, {"smooth-joints"}, {"smooth-joints", "gravity", "inflate"}}) {
            CAPTURE(std::string(basis));
            CAPTURE(effects.size());
            Workbench w;
            w.buildChain();
            w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", basis}});
            for (const char* effect : effects) w.good({{"do", "enable"}, {"effect", effect}});
            w.good({{"do", "precompute"}});
            w.good({{"do", "pin"}, {"endpoint", "a/start"}});
            w.good({{"do", "drag"}, {"endpoint", "b/start"}, {"to", {0.3, -0.2, 3.2}}});
            w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 0.4, 5.0}}, {"roll", 0.3}});
            checkDriven(w);
        }
}

TEST_CASE("driver: flesh at free ends stretches with its bone as that of the character does") {
    if (printed("node --version 2>/dev/null").empty()) return leaveOut("node is not installed");
    for (const auto& effects : std::initializer_list<std::vector<const char*>>{{"end-stretch", "gravity"}, {"end-stretch", "inflate"}, {"end-stretch", "smooth-joints", "gravity", "inflate"}}) {
        Workbench w;
        w.buildFreeEnd();
        for (const char* effect : effects) w.good({{"do", "enable"}, {"effect", effect}});
        w.good({{"do", "precompute"}});
        w.good({{"do", "pin"}, {"endpoint", "a/start"}});
        w.good({{"do", "drag"}, {"endpoint", "b/start"}, {"to", {0.3, -0.2, 3.2}}});
        w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 0.4, 7.0}}, {"roll", 0.3}});
        checkDriven(w);
    }
}

TEST_CASE("driver: parts of a character are weighed by all elements that move them, with targets of their own or shared") {
    if (printed("node --version 2>/dev/null").empty()) return leaveOut("node is not installed");
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "snowman"}, {"name", "doll"}});
    w.addFace("doll body", "in", 0, -1);
    w.addFace("doll body", "out", 12, 1);
    w.good({{"do", "cut"}, {"element", "doll"}, {"plane", {{"origin", {0, 0, 5.3}}, {"normal", {0, 0, 1}}}}, {"names", {"low", "high"}}, {"name", "waist"}});
    for (const char* element : {"low", "high"}) w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", "low/in"}, {"to", "low/waist"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", "high/out"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {2.5, 0.4, 10.0}}, {"roll", 0.3}});
    for (const bool shared : {false, true}) {
        CAPTURE(shared);
        const auto path = Workbench::folder() / "doll.glb";
        Json command{{"do", "export"}, {"layout", "rigged"}, {"path", path.string()}};
        if (shared) command["targets"] = 6;
        w.good(command);
        const Character& character = *w.session.character();
        const Pose& pose = w.session.shownPose();
        Json told{{"points", Json::array()}, {"rolls", pose.roll}, {"rotations", Json::array()}, {"weights", Json::array()}, {"parts", Json::array()}};
        for (const Vec3& p : pose.points) told["points"].push_back({p.x(), p.y(), p.z()});
        for (const auto& q : pose.frames) told["rotations"].push_back({q.x(), q.y(), q.z(), q.w()});
        std::vector<double> shape(static_cast<std::size_t>(character.shapeLayout().size()));
        character.shape(shape.data());
        // The weights of the file, which has one frame, are those of this pose.
        const ReadGlb file(path);
        for (const char* part : {"trunk", "eye"}) {
            const int node = file.nodeNamed(part);
            const Json data = skeletonData(path);
            const auto number = file.root["nodes"][static_cast<std::size_t>(node)]["extras"]["part"].get<int>();
            std::vector<double> weights(file.meshOf(node)["weights"].size(), 0.0);
            for (std::size_t e = 0; e < data["elements"].size(); ++e)
                for (const Json& moved : data["elements"][e].value("parts", Json::array())) {
                    if (moved[0] != number) continue;
                    const double* v = shape.data() + character.shapeLayout().element(e) + ShapeLayout::kFrame;
                    const Json& matrix = data["elements"][e]["matrix"];
                    const auto columns = data["elements"][e]["columns"].get<std::size_t>();
                    for (std::size_t t = 0; t * columns < matrix.size(); ++t)
                        for (std::size_t c = 0; c < columns; ++c) weights.at(moved[1].get<std::size_t>() + t) += matrix[t * columns + c].get<double>() * v[c];
                }
            told["parts"].push_back(weights);
            if (std::string(part) == "trunk") CHECK(Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size())).cwiseAbs().maxCoeff() > 0.01);
            for (const Json& channel : file.root["animations"][0]["channels"]) {
                if (channel["target"]["node"] != node) continue;
                const auto written = file.numbers(file.root["animations"][0]["samplers"][channel["sampler"].get<std::size_t>()]["output"]);
                REQUIRE(written.size() == weights.size());
                const auto& names = file.meshOf(node)["extras"]["targetNames"];
                // Fitted targets are of this clip alone.
                for (std::size_t t = 0; t < weights.size(); ++t)
                    if (shared || names[t].get<std::string>().find("fitted") == std::string::npos) CHECK(std::abs(written[t] - weights[t]) < 1e-4);
            }
        }
        Workbench::writeFile(Workbench::folder() / "pose.json", told.dump());
        const std::string out = printed("node '" IMOMUSHI_EXPORT_TESTS "/check_weights.mjs' '" + path.string() + "' '" + (Workbench::folder() / "pose.json").string() + "' '" IMOMUSHI_DRIVERS "/three.js' 2>&1");
        INFO(out);
        CHECK(std::atof(out.c_str()) < 1e-9);
        CHECK(out.find("rror") == std::string::npos);
    }
}
