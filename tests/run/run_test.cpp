// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh/write_mesh.h"
#include "tests/run/program.h"
#include "tests/support/left_out.h"
#include "tests/support/obj.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// OBJ files of a chain of bars along z: bar0.obj, bar1.obj, ...
void writeBars(int count) {
    for (int i = 0; i < count; ++i) {
        TriangleMesh mesh = shapes::bar(2).mesh;
        mesh.vertices.col(2).array() += 3.0 * i;
        REQUIRE(writeMesh(folder() / ("bar" + std::to_string(i) + ".obj"), mesh.vertices, mesh.triangles).has_value());
    }
}

/// A script that builds a worm of bars: element "e0"..., faces "in" and "out", bones "b0"..., precomputed, its tail pinned.
std::string wormScript(int count) {
    std::string lines = "{\"do\":\"new\"}\n";
    const auto add = [&](const Json& line) { lines += line.dump() + "\n"; };
    for (int i = 0; i < count; ++i) {
        const std::string name = "e" + std::to_string(i);
        add({{"do", "import-element"}, {"path", "bar" + std::to_string(i) + ".obj"}, {"name", name}});
        add({{"do", "add-joint-face"}, {"element", name}, {"name", "in"}, {"plane", {{"origin", {0, 0, 3 * i}}, {"normal", {0, 0, -1}}}}});
        add({{"do", "add-joint-face"}, {"element", name}, {"name", "out"}, {"plane", {{"origin", {0, 0, 3 * i + 3}}, {"normal", {0, 0, 1}}}}});
        if (i > 0) add({{"do", "join"}, {"a", "e" + std::to_string(i - 1) + "/out"}, {"b", name + "/in"}});
    }
    for (int i = 0; i < count; ++i)
        add({{"do", "add-bone"}, {"name", "b" + std::to_string(i)}, {"from", i ? "b" + std::to_string(i - 1) + "/end" : std::string("e0/in")}, {"to", "e" + std::to_string(i) + "/out"}});
    add({{"do", "precompute"}});
    add({{"do", "pin"}, {"endpoint", "b0/start"}});
    return lines;
}

/// Answers without what may differ from run to run: times, predictions, cached.
std::string comparable(const Run& run) {
    std::string text;
    for (Json answer : run.answers) {
        for (const char* key : {"ms", "ms_per_frame", "stages", "effects", "seconds"}) answer.erase(key);
        if (answer.contains("elements"))
            for (Json& element : answer["elements"])
                if (element.is_object())
                    for (const char* key : {"seconds", "cached", "ms_per_frame"}) element.erase(key);
        text += answer.dump() + "\n";
    }
    return text;
}

}  // namespace

TEST_CASE("imomushi: says its version and how it is used") {
    const std::string version = program("--version").out;
    CHECK(version.starts_with("imomushi " IMOMUSHI_EXPECTED_VERSION "\ncommit "));
    for (const char* library : {"Eigen 3.", "CGAL 5.", "assimp 5.", "SQLite 3."}) CHECK_MESSAGE(version.find(library) != std::string::npos, version);
    CHECK(program("--help").status == 0);
    const Run help = program("run --help");
    CHECK(help.status == 0);
    for (const char* name : {"new", "open", "save", "import-element", "add-joint-face", "join", "add-bone", "pin", "unpin", "set", "estimate", "precompute", "drag",
                             "release", "rest", "step", "deform-element", "undo", "redo", "measure", "write-mesh", "render"})
        CHECK(help.out.find("\n" + std::string(name) + "\n") != std::string::npos);
    CHECK(help.out.find("endpoint") != std::string::npos);
}

TEST_CASE("run: a folder for responses spares the next script their computation") {
    writeBars(2);
    std::vector<Json> cached;
    for (int i = 0; i < 2; ++i) {
        const Run run = script(wormScript(2), "--cache responses");
        CHECK(run.status == 0);
        for (const Json& answer : run.answers)
            if (answer["do"] == "precompute") cached.push_back(answer["elements"][0]["cached"]);
    }
    CHECK(cached == std::vector<Json>{false, true});
}

TEST_CASE("run: bad options and scripts that cannot be read give status 2 and nothing on standard output") {
    for (const char* arguments : {"run", "run a b", "run --nonsense a", "run nothing.jsonl", "run .", "run --keep-going", "run a --cache"}) {
        CAPTURE(arguments);
        const Run run = program(arguments);
        CHECK(run.status == 2);
        CHECK(run.out.empty());
        CHECK(!run.err.empty());
    }
}

TEST_CASE("run: one answer per command in order, blank lines and comments skipped, the first failure stops") {
    const Run good = script("\xef\xbb\xbf# a comment\r\n\r\n{\"do\":\"new\"}\r\n   \n#{}\n{\"do\":\"list\"}");
    CHECK(good.status == 0);
    REQUIRE(good.answers.size() == 2);
    CHECK(good.out.starts_with("{\"line\":3,\"do\":\"new\",\"ok\":true}\n{\"line\":6,\"do\":\"list\",\"ok\":true,"));
    CHECK(good.err.empty());
    const Run stopped = script("{\"do\":\"new\"}\n{\"do\":\"nonsense\"}\n{\"do\":\"new\"}\n");
    CHECK(stopped.status == 1);
    CHECK(stopped.answers.size() == 2);
    CHECK(stopped.answers[1]["error"]["code"] == "unknown-command");
    const Run going = script("{\"do\":\"new\"}\n{\"do\":\"nonsense\"}\n{\"do\":\"new\"}\n", "--keep-going");
    CHECK(going.status == 1);
    CHECK(going.answers.size() == 3);
    CHECK(script("").status == 0);
}

TEST_CASE("run: a preset sets the numbers of an element in one step, and what is none is refused with those that are") {
    writeFile("preset.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const std::string lines = R"({"do":"import-element","path":"preset.obj","name":"belly"}
{"do":"set","target":"belly","property":"preset","value":"jelly"}
{"do":"set","target":"belly","property":"preset","value":"stone"}
{"do":"undo"}
{"do":"undo"}
{"do":"undo"}
)";
    const Run run = script(lines, "--keep-going");
    REQUIRE(run.answers.size() == 6);
    CHECK(run.answers[1]["ok"] == true);
    CHECK(run.answers[2]["error"]["code"] == "bad-value");
    CHECK(run.answers[2]["error"]["message"].get<std::string>().find("\"jelly\", \"rubber\"") != std::string::npos);
    CHECK(run.answers[3]["ok"] == true);
    CHECK(run.answers[4]["ok"] == true);
    CHECK(run.answers[5]["error"]["code"] == "nothing-to-undo");
    CHECK(program("run --help").out.find("preset (\"standard\", \"jelly\"") != std::string::npos);
}

TEST_CASE("run: a dash reads standard input") {
    writeFile("in.jsonl", "{\"do\":\"new\"}\n{\"do\":\"undo\"}\n");
    const Run run = program("run --keep-going - < in.jsonl");
    CHECK(run.status == 1);
    CHECK(run.out.starts_with("{\"line\":1,\"do\":\"new\",\"ok\":true}\n{\"line\":2,\"do\":\"undo\",\"ok\":false,\"error\":{\"code\":\"nothing-to-undo\""));
}

TEST_CASE("run: lines that are no commands fail like commands and never crash") {
    std::string lines;
    const auto add = [&](const std::string& line) { lines += line + "\n"; };
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"nonsense", "bad-json"},
        {"{\"do\":\"new\"", "bad-json"},
        {"{\"do\":\"new\"} {}", "bad-json"},
        {"{\"do\":\"drag\",\"endpoint\":\"a/end\",\"to\":[NaN,0,0]}", "bad-json"},
        {"{\"do\":\"drag\",\"endpoint\":\"a/end\",\"to\":[Infinity,0,0]}", "bad-json"},
        {"{\"do\":\"drag\",\"endpoint\":\"a/end\",\"to\":[1e999,0,0]}", "bad-json"},
        {"{\"do\":\"drag\",\"endpoint\":\"a/end\",\"to\":[-1e999,0,0]}", "bad-json"},
        {"{\"do\":\"drag\",\"endpoint\":\"a/end\",\"to\":[1e300,0,0]}", "bad-type"},
        {"{\"do\":\"new\",\"do\":\"list\"}", "duplicate-key"},
        {"{\"do\":\"drag\",\"endpoint\":\"a/end\",\"to\":[0,0,0],\"to\":[0,0,0]}", "duplicate-key"},
        {"{\"do\":\"new\",\"path\":\"\xff\xfe\"}", "bad-json"},
        {"{\"do\":\"\xed\xa0\x80\"}", "bad-json"},
        {"{\"do\":\"new\\ud800\"}", "bad-json"},
        {std::string("{\"do\":\"new\0\"}", 13), "bad-json"},
        {"{\"do\":\"new\\u0000\"}", "unknown-command"},
        {std::string(1'000'000, '['), "bad-json"},
        {std::string(500'000, '[') + std::string(500'000, ']'), "bad-json"},
        {"{\"do\":" + std::string(1000, '{'), "bad-json"},
        {"[]", "bad-command"},
        {"42", "bad-command"},
        {"null", "bad-command"},
        {"{}", "bad-command"},
        {"{\"do\":null}", "bad-command"},
        {"{\"do\":\"new\",\"extra\":1}", "unknown-key"},
        {"{\"do\":\"step\"}", "missing-key"},
        {"{\"do\":\"step\",\"frames\":99999999999999999999}", "bad-type"},
        {"{\"do\":\"step\",\"frames\":-1}", "bad-value"},
        {"{\"do\":\"step\",\"frames\":true}", "bad-type"},
        {"{\"do\":\"undo\",\"count\":0}", "bad-value"},
        {"{\"do\":\"open\",\"path\":\"\"}", "bad-value"},
        {"{\"do\":\"open\",\"path\":\"a\\u0000b\"}", "bad-value"},
        {"{\"do\":\"open\",\"path\":\"nothing.imomushi\"}", "file-not-found"},
        {"{\"do\":\"open\",\"path\":\"" + std::string(100'000, 'x') + "\"}", "file-not-found"},
        {"{\"do\":\"import-element\",\"path\":\"nothing.obj\"}", "file-not-found"},
        {"{\"do\":\"set\",\"target\":\"character\",\"property\":\"basis\",\"value\":{\"a\":[[[1]]]}}", "bad-type"},
        {"{\"do\":\"" + std::string(100'000, 'x') + "\"}", "unknown-command"},
        {"{\"do\":\"bake\",\"element\":\"a\"}", "unknown-command"},
    };
    for (const auto& [line, code] : cases) add(line);
    const Run run = script(lines, "--keep-going");
    CHECK(run.status == 1);
    REQUIRE(run.answers.size() == cases.size());
    for (std::size_t i = 0; i < cases.size(); ++i) {
        CAPTURE(cases[i].first.substr(0, 80));
        CHECK(codeOf(run.answers[i]) == cases[i].second);
        CHECK(run.answers[i]["line"] == i + 1);
    }
}

TEST_CASE("run: import then write-mesh keeps vertices, order and axes of the reference meshes") {
    const std::filesystem::path reference = std::filesystem::path(IMOMUSHI_TEST_DATA) / "reference";
    int meshes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(reference)) {
        if (entry.path().extension() != ".obj") continue;
        ++meshes;
        CAPTURE(entry.path().string());
        const std::string out = (folder() / "written.obj").string();
        const Run run = script("{\"do\":\"import-element\",\"path\":\"" + entry.path().string() + "\",\"name\":\"e\"}\n{\"do\":\"write-mesh\",\"path\":\"" + out + "\"}\n");
        REQUIRE(run.status == 0);
        const auto numbers = [](const std::filesystem::path& path, const std::string& kind) {
            std::vector<double> values;
            std::ifstream file(path);
            for (std::string line; std::getline(file, line);) {
                if (!line.starts_with(kind + " ")) continue;
                std::istringstream fields(line.substr(2));
                for (std::string field; fields >> field;) values.push_back(std::stod(field));  // "12/3/4" gives 12
            }
            return values;
        };
        CHECK(numbers(out, "v") == numbers(entry.path(), "v"));
        CHECK(numbers(out, "f") == numbers(entry.path(), "f"));
        // The frames of the joint faces, where the reference has them.
        const auto facesFile = entry.path().parent_path() / (entry.path().stem().string() + ".faces.json");
        if (!std::filesystem::exists(facesFile)) continue;
        const Json faces = Json::parse(readFile(facesFile))["faces"];
        std::string lines = "{\"do\":\"import-element\",\"path\":\"" + entry.path().string() + "\",\"name\":\"e\"}\n";
        for (const Json& face : faces)
            lines += Json({{"do", "add-joint-face"}, {"element", "e"}, {"name", face["name"]}, {"plane", {{"origin", face["origin"]}, {"normal", face["normal"]}}}}).dump() + "\n";
        const Run framed = script(lines);
        REQUIRE(framed.status == 0);
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const Json& answer = framed.answers[f + 1];
            CHECK(answer["indices"] == faces[f]["vertices"]);
            for (const auto& [ours, theirs] : {std::pair{"origin", "origin"}, std::pair{"x", "x_axis"}, std::pair{"y", "y_axis"}, std::pair{"z", "normal"}})
                for (std::size_t k = 0; k < 3; ++k)
                    CHECK(std::abs(answer["frame"][ours][k].get<double>() - faces[f][theirs][k].get<double>()) <= 1e-6);
        }
    }
    CHECK(meshes >= 7);
}

TEST_CASE("run: a worm is built, posed, saved under a Unicode name and opened again as it was") {
    writeBars(2);
    const Run run = script(wormScript(2) + R"({"do":"drag","endpoint":"b1/end","to":[2,0,5]}
{"do":"measure","what":"gap"}
{"do":"measure","what":"volume"}
{"do":"write-mesh","path":"posed.obj"}
{"do":"save","path":"芋虫 🐛.imomushi"}
{"do":"save-script","path":"session.jsonl"}
{"do":"open","path":"芋虫 🐛.imomushi"}
{"do":"write-mesh","path":"opened.obj"}
)");
    REQUIRE(run.status == 0);
    CHECK(readFile(folder() / "posed.obj") == readFile(folder() / "opened.obj"));
    const Json& opened = run.answers[run.answers.size() - 2];
    CHECK(opened["elements"][1]["state"] == "fresh");
    CHECK(opened["bones"][1]["parent"] == "b0");
    CHECK(opened["joints"] == Json::array({{"e0/out", "e1/in"}}));
    CHECK(opened["effects"] == Json::array());
    CHECK(opened["takes"] == Json::array());
    // The session's own script makes the same pose.
    const Run again = script(readFile(folder() / "session.jsonl") + "{\"do\":\"write-mesh\",\"path\":\"again.obj\"}\n");
    CHECK(again.status == 0);
    CHECK(readFile(folder() / "again.obj") == readFile(folder() / "posed.obj"));
}

TEST_CASE("run: the same script gives the same bytes twice and with one and two threads") {
    writeBars(3);
    std::string steps;
    for (int i = 0; i < 12; ++i)
        steps += Json({{"do", "drag"}, {"endpoint", "b2/end"}, {"to", {i % 3 - 1.0, 0.4 * (i % 4), 9.0 - 0.5 * i}}, {"seconds", 0.2}}).dump() + "\n{\"do\":\"step\",\"frames\":15}\n";
    const auto perform = [&](int threads, const std::string& name) {
        const std::string lines = wormScript(3);
        const std::string first = "{\"do\":\"new\"}\n";
        return script(first + "{\"do\":\"set\",\"target\":\"character\",\"property\":\"threads\",\"value\":" + std::to_string(threads) + "}\n" + lines.substr(first.size()) + steps +
                      "{\"do\":\"write-mesh\",\"path\":\"" + name + ".ply\"}\n{\"do\":\"set\",\"target\":\"character\",\"property\":\"threads\",\"value\":0}\n{\"do\":\"save\",\"path\":\"" + name +
                      ".imomushi\"}\n");
    };
    const Run a = perform(1, "a"), b = perform(1, "b"), c = perform(2, "c");
    REQUIRE(a.status == 0);
    CHECK(comparable(a) == comparable(b));
    CHECK(comparable(a) == comparable(c));
    for (const char* suffix : {".ply", ".imomushi"}) {
        CHECK(readFile(folder() / (std::string("a") + suffix)) == readFile(folder() / (std::string("b") + suffix)));
        CHECK(readFile(folder() / (std::string("a") + suffix)) == readFile(folder() / (std::string("c") + suffix)));
    }
}

TEST_CASE("run: a random walk of drags, also far out of reach, stays finite and closed") {
    writeBars(3);
    std::string lines = wormScript(3);
    unsigned state = 12345;
    const auto random = [&] {
        state = state * 1664525u + 1013904223u;
        return static_cast<double>(state >> 8) / (1 << 24) - 0.5;
    };
    for (int i = 0; i < 40; ++i) {
        const double reach = i % 10 == 9 ? 1e5 : 12.0;
        lines += Json({{"do", "drag"}, {"endpoint", "b2/end"}, {"to", {reach * random(), reach * random(), reach * random()}}, {"seconds", 0.3}}).dump() + "\n";
        lines += "{\"do\":\"step\",\"frames\":25}\n{\"do\":\"measure\",\"what\":\"gap\"}\n";
    }
    const Run run = script(lines);
    REQUIRE(run.status == 0);
    for (const Json& answer : run.answers) {
        if (answer["do"] == "step") CHECK(answer["finite"] == true);
        if (answer["do"] == "measure") CHECK(answer["value"].get<double>() <= 1e-12);
    }
}

TEST_CASE("run: files that are not what they say are refused by a reason, and the run goes on") {
    writeFile("broken.obj", "v 0 0 0\nv 1 0 0\nv nan 0 0\nf 1 2 3\n");
    writeFile("broken.imomushi", "SQLite format 3");
    writeFile("broken.glb", "glTF\x02");
    const Run run = script(R"({"do":"import-element","path":"broken.obj"}
{"do":"import-element","path":"broken.glb"}
{"do":"import-element","path":"."}
{"do":"open","path":"broken.imomushi"}
{"do":"open","path":"."}
{"do":"list"}
)",
                           "--keep-going");
    CHECK(run.status == 1);
    REQUIRE(run.answers.size() == 6);
    for (std::size_t i = 0; i < 5; ++i) {
        CHECK(run.answers[i]["ok"] == false);
        CHECK(!run.answers[i]["error"]["message"].get<std::string>().empty());
    }
    CHECK(run.answers[5]["ok"] == true);
}

TEST_CASE("run: the paper's table of a character that is built in") {
    const Run r = script("{\"do\":\"paper\",\"path\":\"paper.md\",\"seconds\":0}\n");
    REQUIRE(r.status == 0);
    const Json& answer = r.answers.at(0);
    CHECK(answer["rows"][0]["vertices"] == 1978);
    CHECK(answer["rows"][0]["elements"] == 5);
    CHECK(answer["ratios"]["bytes"].get<double>() >= 15.0);
    CHECK(answer["paper"][0]["vertices_at_60_fps"] == 28257);
    CHECK(readFile(folder() / "paper.md").find("| vertices | 1978 | 1978 |") != std::string::npos);
}

TEST_CASE("run: what accuracy costs, as JSON, CSV and plots, within a budget of seconds") {
    writeBars(2);
    const std::string ask = "{\"do\":\"accuracy\",\"path\":\"accuracy.json\",\"svg\":\"plot.svg\",\"csv\":\"accuracy.csv\",\"seconds\":2}\n";
    const Run r = script(wormScript(2) + ask + ask);
    for (const auto& answer : r.answers) CHECK_MESSAGE(codeOf(answer) == "ok", answer.dump());
    REQUIRE(r.status == 0);
    const Json &first = r.answers[r.answers.size() - 2], &second = r.answers.back();
    CHECK(first["poses"].size() == 6);
    CHECK(first["reference"]["solution"] == "full");
    CHECK(first["points"][0]["present"] == true);
    for (const Json& p : first["points"]) {
        // Both errors or none; a speed never without its error where there is a reference.
        CHECK(p["error"]["relative"].is_null() == p["error"]["max_percent"].is_null());
        if (p["ms_per_frame"]["median"].is_number()) CHECK(p["error"]["relative"].is_number());
    }
    // What is known is not measured again; times of frames become those of the machine at its quickest, should the reference load be quicker now.
    CHECK(second["points"][0]["precompute_seconds"] == first["points"][0]["precompute_seconds"]);
    CHECK(second["yardstick_ms"].get<double>() <= first["yardstick_ms"].get<double>());
    const double share = second["yardstick_ms"].get<double>() / first["yardstick_ms"].get<double>();
    for (const char* key : {"median", "p99"})
        CHECK(second["points"][0]["ms_per_frame"][key].get<double>() == doctest::Approx(share * first["points"][0]["ms_per_frame"][key].get<double>()).epsilon(1e-9));
    const Json file = Json::parse(readFile(folder() / "accuracy.json"));
    CHECK(file["points"] == second["points"]);
    CHECK(readFile(folder() / "plot.svg").starts_with("<svg"));
    CHECK(readFile(folder() / "plot-precompute.svg").starts_with("<svg"));
    CHECK(readFile(folder() / "accuracy.csv").starts_with("setting,precompute seconds"));
    const Run bad = script("{\"do\":\"accuracy\",\"path\":\"accuracy.txt\"}\n{\"do\":\"accuracy\",\"path\":\"accuracy.json\"}\n", "--keep-going");
    CHECK(codeOf(bad.answers.at(0)) == "unknown-format");
    CHECK(codeOf(bad.answers.at(1)) == "no-bone");
}

TEST_CASE("run: a report with all its parts") {
    writeBars(2);
    const Run r = script(wormScript(2) + "{\"do\":\"report\",\"path\":\"report.md\",\"seconds\":1}\n");
    REQUIRE(r.status == 0);
    const std::string text = readFile(folder() / "report.md");
    for (const char* part : {"## What accuracy costs", "## Scaling", "## Against skins", "linear blend skinning", "dual quaternions", "spline skin", "## Against the previous model"})
        CHECK_MESSAGE(text.find(part) != std::string::npos, part);
}

TEST_CASE("run: a whole character from its file, cut, boned, dragged and written in its file's own order") {
    // A worm that is open at its head, which makes it no element, with an eye beside it.
    TriangleMesh worm = shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 9.0}, 3, 3, 24).mesh;
    const TriangleMesh eye = shapes::moved(shapes::sphere(0.06, 1), Eigen::Matrix3d::Identity(), {0.0, 0.53, 7.9}).mesh;
    std::string obj = "o worm\n";
    const auto add = [&](const TriangleMesh& mesh, int first, bool open) {
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
            obj += "v " + Json(mesh.vertices(v, 0)).dump() + " " + Json(mesh.vertices(v, 1)).dump() + " " + Json(mesh.vertices(v, 2)).dump() + "\n";
        for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
            bool head = true;
            for (int k = 0; k < 3; ++k) head = head && mesh.vertices(mesh.triangles(t, k), 2) == 9.0;
            if (open && head) continue;
            obj += "f";
            for (int k = 0; k < 3; ++k) obj += " " + std::to_string(first + mesh.triangles(t, k));
            obj += "\n";
        }
    };
    add(worm, 1, true);
    obj += "o eye\n";
    add(eye, static_cast<int>(worm.vertices.rows()) + 1, false);
    writeFile("worm.obj", obj);
    const std::string lines = R"({"do":"import-character","path":"worm.obj","name":"worm"}
{"do":"cut","element":"worm","plane":{"origin":[0,0,3.1],"normal":[0,0,1]},"names":["tail","belly"],"name":"hip"}
{"do":"cut","element":"belly","plane":{"origin":[0,0,6.1],"normal":[0,0,1]},"names":["belly","head"],"name":"neck"}
{"do":"add-bone","name":"a","element":"tail","from":[0,0,0.3],"to":"tail/hip"}
{"do":"add-bone","name":"b","from":"a/end","to":"belly/neck"}
{"do":"add-bone","name":"c","element":"head","from":"b/end","to":[0,0,8.7]}
{"do":"set","target":"tail","property":"solver-mesh","value":"as-is"}
{"do":"set","target":"belly","property":"solver-mesh","value":"as-is"}
{"do":"set","target":"head","property":"solver-mesh","value":"as-is"}
{"do":"precompute"}
{"do":"pin","endpoint":"a/start"}
{"do":"drag","endpoint":"c/end","to":[2,1,7.5]}
{"do":"measure","what":"gap"}
{"do":"write-mesh","path":"rest.obj","character":"worm","state":"rest"}
{"do":"write-mesh","path":"now.obj","character":"worm"}
{"do":"move-cut","cut":"neck","plane":{"origin":[0,0,5.8],"normal":[0,0,1]}}
{"do":"list"}
{"do":"save","path":"worm.imomushi"}
{"do":"open","path":"worm.imomushi"}
{"do":"remove-cut","cut":"neck"}
{"do":"list"}
)";
    const Run first = script(lines);
    INFO(first.out << first.err);
    REQUIRE(first.status == 0);
    CHECK(first.answers[0]["body"]["how"] != "exact");
    CHECK(first.answers[0]["parts"].size() == 2);
    CHECK(first.answers[12]["value"].get<double>() < 1e-9);
    const TriangleMesh rest = readObj((folder() / "rest.obj").string()), now = readObj((folder() / "now.obj").string());
    Points own(worm.vertices.rows() + eye.vertices.rows(), 3);
    own << worm.vertices, eye.vertices;
    CHECK(rest.vertices == own);
    CHECK(now.triangles == rest.triangles);
    CHECK((now.vertices - own).rowwise().norm().maxCoeff() > 0.5);
    CHECK(first.answers[15]["stale"] == Json::array({"belly", "head"}));
    CHECK(first.answers[16]["elements"][0]["state"] == "fresh");
    CHECK(first.answers[18]["characters"] == first.answers[16]["characters"]);
    CHECK(first.answers[20]["elements"].size() == 2);
    const std::string posed = readFile(folder() / "now.obj");
    const Run again = script("{\"do\":\"set\",\"target\":\"character\",\"property\":\"threads\",\"value\":1}\n" + lines);
    REQUIRE(again.status == 0);
    CHECK(readFile(folder() / "now.obj") == posed);
}

TEST_CASE("run: the studio without a display says what is missing instead of ending as if it had crashed") {
    const Run started = program("-platform xcb");
    if (started.err.find("built without the studio") != std::string::npos) return leaveOut("this program has no studio");
    CHECK(started.status == 1);
    CHECK(started.err.find("no display") != std::string::npos);
    CHECK(started.err.find("imomushi run") != std::string::npos);
}
