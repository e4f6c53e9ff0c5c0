// SPDX-License-Identifier: GPL-3.0-or-later
// What README.md, the manual and the program's help show as an example is run here, as it stands there.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "tests/run/program.h"

using namespace imomushi;
namespace fs = std::filesystem;

namespace {

const fs::path kSource = IMOMUSHI_SOURCE_DIR;

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

const std::string& page(const std::string& name) {
    static std::map<std::string, std::string> read;
    const auto [text, fresh] = read.try_emplace(name);
    if (fresh) text->second = readFile(kSource / name);
    return text->second;
}
/// README.md and the pages of the manual in English.
std::vector<std::string> pages() {
    std::vector<std::string> found{"README.md"};
    for (const auto& entry : fs::directory_iterator(kSource / "assets/manual/en")) found.push_back("assets/manual/en/" + entry.path().filename().string());
    std::sort(found.begin() + 1, found.end());
    return found;
}
const std::string& help() {
    static const std::string text = program("--help").out + program("run --help").out;
    return text;
}

/// All parts of `text` that match, by the first group.
std::vector<std::string> all(const std::string& text, const char* pattern) {
    const std::regex expression(pattern);
    std::vector<std::string> found;
    for (std::sregex_iterator m(text.begin(), text.end(), expression), end; m != end; ++m) found.push_back((*m)[1]);
    return found;
}

/// What stands between fences that begin with ```LANGUAGE, of the languages that are asked for; with its language.
struct Fenced {
    std::string language, text;
};
std::vector<Fenced> fenced(const std::string& text) {
    std::vector<Fenced> found;
    bool inside = false;
    for (const std::string& line : linesOf(text)) {
        if (line.starts_with("```")) {
            inside = !inside;
            if (inside) found.push_back({line.substr(3), ""});
        } else if (inside) {
            found.back().text += line + "\n";
        }
    }
    CHECK(!inside);
    return found;
}

/// Every {"do": ...} of the text, with what it holds.
std::vector<std::string> commandsIn(const std::string& text) {
    std::vector<std::string> found;
    for (auto at = text.find("{\"do\":"); at != std::string::npos; at = text.find("{\"do\":", at + 1)) {
        int depth = 0;
        for (auto i = at; i < text.size(); ++i) {
            depth += text[i] == '{' ? 1 : text[i] == '}' ? -1 : 0;
            if (depth == 0) {
                found.push_back(text.substr(at, i + 1 - at));
                break;
            }
        }
    }
    return found;
}

/// Puts the samples where the examples look for them, with the files that they were made from.
void takeSamples() {
    if (!fs::exists(folder() / "assets/samples")) {
        fs::create_directories(folder() / "assets");
        fs::copy(kSource / "assets/samples", folder() / "assets/samples", fs::copy_options::recursive);
    }
    fs::copy_file(kSource / "assets/samples/caterpillar.imomushi", folder() / "a.imomushi", fs::copy_options::overwrite_existing);
}

/// Runs commands on the sample caterpillar; each must succeed.
std::vector<Json> onCaterpillar(const std::string& lines) {
    const Run run = script("{\"do\":\"open\",\"path\":\"a.imomushi\"}\n" + lines, "--keep-going");
    for (const Json& answer : run.answers) CHECK_MESSAGE(codeOf(answer) == "ok", answer.dump());
    CHECK(run.status == 0);
    return run.answers;
}

/// The cells of the first column of the first table of a page of the manual whose head is `head`, each without its backquotes; with the cells of the second.
std::vector<std::pair<std::string, std::string>> table(const std::string& name, const std::string& head) {
    std::vector<std::pair<std::string, std::string>> rows;
    bool inside = false;
    for (const std::string& line : linesOf(page("assets/manual/en/" + name))) {
        if (inside && !line.starts_with("|")) break;
        if (inside)
            for (const std::string& cell : all(line.substr(0, line.find('|', 1)), "`([^`]+)`")) rows.emplace_back(cell, line.substr(line.find('|', 1) + 1));
        if (line.starts_with("| " + head + " |") || line.starts_with("| `" + head + "` |")) inside = true;
    }
    return rows;
}

}  // namespace

TEST_CASE("examples: every script in README.md and in the manual does what it says") {
    takeSamples();
    int scripts = 0;
    for (const std::string& name : pages()) {
        CAPTURE(name);
        std::string lines;
        std::size_t commands = 0;
        const auto check = [&](const Run& run) {
            CHECK_MESSAGE(run.status == 0, lines, run.out, run.err);
            std::size_t asked = 0;
            bool dragged = false;  // samples swing: what was dragged is not there before some frames have passed
            for (const std::string& command : linesOf(lines)) {
                if (command.empty() || command.starts_with("#")) continue;
                ++asked;
                const Json json = Json::parse(command);
                dragged = json["do"] == "drag" ? lines.find(".imomushi") != std::string::npos : dragged && json["do"] != "step";
                if (json["do"] == "render") CHECK(!dragged);
                if (json["do"] != "open" && json.contains("path")) CHECK(fs::file_size(folder() / json["path"].get<std::string>()) > 1000);
            }
            CHECK(linesOf(run.out).size() == asked);
        };
        for (const Fenced& block : fenced(page(name))) {
            // Answers are shown as json, what is typed as sh; formulas have no language.
            CHECK(std::set<std::string>{"jsonl", "json", "sh"}.contains(block.language));
            if (block.language == "jsonl") {
                lines = block.text;
                commands += commandsIn(lines).size();
                check(script(lines));
                ++scripts;
            }
            if (block.language != "sh") continue;
            for (const std::string& typed : all(block.text, "bash packaging/run\\.sh (run [a-z]+\\.jsonl)")) {
                writeFile(typed.substr(4), lines);
                check(program(typed));
            }
        }
        if (name == "README.md") CHECK(commandsIn(page(name)).size() == commands);  // none stands outside of a script that was run
    }
    CHECK(scripts >= 15);
}

TEST_CASE("examples: every command that the help shows runs") {
    takeSamples();
    const auto commands = commandsIn(help());
    CHECK(!commands.empty());
    for (const std::string& command : commands) {
        CAPTURE(command);
        const Run run = script(command + "\n");
        CHECK_MESSAGE(run.status == 0, run.out);
    }
}

TEST_CASE("examples: what README.md and the manual say to type is there") {
    const std::string commands = help();
    const std::string presets = readFile(kSource / "CMakePresets.json");
    std::vector<std::string> names = pages();
    for (const char* other : {"CONTRIBUTING.md", "ARCHITECTURE.md"}) names.push_back(other);
    for (const std::string& name : names) {
        CAPTURE(name);
        const std::string& text = page(name);
        for (const std::string& file : all(text, "(packaging/[a-z]+\\.sh)")) {
            CAPTURE(file);
            REQUIRE(fs::exists(kSource / file));
            CHECK(readFile(kSource / file).starts_with("#!/usr/bin/env bash\n"));
        }
        for (const std::string& path : all(text, "`((?:app|assets|core|packaging|shaders|tests|ui)/[^`A-Z *{]*)`")) CHECK_MESSAGE(fs::exists(kSource / path), path);
        for (const std::string& preset : all(text, "--preset ([a-z]+)")) CHECK_MESSAGE(presets.find("\"configurePreset\": \"" + preset + "\"") != std::string::npos, preset);
        for (const std::string& label : all(text, "ctest -L ([a-z_]+)")) CHECK_MESSAGE(fs::exists(kSource / "tests" / label), label);
        for (const std::string& bench : all(text, "`bench_([a-z_]+)[` ]")) CHECK_MESSAGE(fs::exists(kSource / "tests/bench" / (bench + ".cpp")), bench);
        if (text.find("imomushi_hard_cases") != std::string::npos) CHECK(readFile(kSource / "tests/stability/test.cmake").find("add_executable(imomushi_hard_cases") != std::string::npos);
        // Names of commands in the text are commands.
        for (const std::string& command : all(text, "`((?:accuracy|paper|report|record|play|export|enable|step|render|precompute|propose|make-soft|mirror|append|repair|check-pose|write-mesh|[a-z]+-take|set))`"))
            CHECK_MESSAGE(commands.find("\n" + command + "\n") != std::string::npos, command);
    }
}

TEST_CASE("examples: every solver mesh, effect, basis and layout that the manual names can be had") {
    takeSamples();
    std::string lines;
    const auto add = [&](const Json& line) { lines += line.dump() + "\n"; };
    std::vector<std::string> meshes;
    for (const auto& [name, rest] : table("accuracy.md", "setting")) meshes.push_back(std::regex_replace(name, std::regex("N$"), "300"));
    CHECK(meshes.size() == 7);
    for (const std::string& mesh : meshes) add({{"do", "set"}, {"target", "head"}, {"property", "solver-mesh"}, {"value", mesh}});
    const auto effects = table("effects.md", "effect");
    CHECK(effects.size() == 11);
    for (const auto& [effect, rest] : effects) {
        add({{"do", "enable"}, {"effect", effect}});
        add({{"do", "disable"}, {"effect", effect}});
    }
    const auto presets = table("effects.md", "preset");
    CHECK(presets.size() == 5);
    for (const auto& [preset, rest] : presets) add({{"do", "set"}, {"target", "head"}, {"property", "preset"}, {"value", preset}});
    const auto bases = table("accuracy.md", "basis");
    CHECK(bases.size() == 4);
    for (const auto& [basis, rest] : bases) add({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", std::regex_replace(basis, std::regex("K$"), "4")}});
    onCaterpillar(lines);

    lines.clear();
    add({{"do", "record"}, {"take", "nod"}, {"action", "start"}});
    add({{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {1.0, 1.0, 0.25}}, {"seconds", 0.1}});
    add({{"do", "step"}, {"frames", 3}});
    add({{"do", "record"}, {"take", "nod"}, {"action", "stop"}});
    int layouts = 0;
    for (const auto& [layout, files] : table("takes-and-export.md", "layout"))
        for (const std::string& ending : all(files, "[ ,](\\.[a-z0-9]+)"))
            if (ending != ".fbx" && ending != ".vrm") {  // need Blender, and an avatar (avatar_test of document)
                add({{"do", "export"}, {"path", layout + ending}, {"layout", layout}});
                ++layouts;
            }
    CHECK(layouts == 7);
    onCaterpillar(lines);
}

TEST_CASE("examples: every choice that the help of a key offers is taken") {
    takeSamples();
    // What a key's choices are tried in, in place of %. A key that offers choices and stands neither here nor among those that need no try fails the test.
    const std::map<std::string, std::string> tries = {
        {"import-element unit", R"({"do":"import-element","path":"rest.obj","name":"as-%","unit":"%"})"},
        {"import-element up", R"({"do":"import-element","path":"rest.obj","name":"up-%","up":"%"})"},
        {"import-character unit", R"({"do":"import-character","path":"rest.obj","name":"character-as-%","unit":"%"})"},
        {"import-character up", R"({"do":"import-character","path":"rest.obj","name":"character-up-%","up":"%"})"},
        {"import-character body", R"({"do":"import-character","path":"rest.obj","name":"character-%","body":"%","detail":0.02})"},
        {"mirror axis", R"({"do":"mirror","from":["as-m"],"axis":"%","at":5})"},
        {"replace-mesh unit", R"({"do":"replace-mesh","element":"as-%","path":"rest.obj","unit":"%"})"},
        {"replace-mesh up", R"({"do":"replace-mesh","element":"up-%","path":"rest.obj","up":"%"})"},
        {"replace-mesh body", R"({"do":"replace-mesh","character":"character-%","path":"rest.obj","body":"%"})"},
        {"attach mode", R"({"do":"attach","character":"character-auto","part":"rest","mode":"%"})"},
        {"enable effect", R"({"do":"enable","effect":"%"})"},
        {"disable effect", R"({"do":"disable","effect":"%"})"},
        {"deform-element model", R"({"do":"deform-element","element":"head","faces":{},"model":"%"})"},
        {"record action", R"({"do":"record","take":"choice","action":"%"})"},
        {"export layout", R"({"do":"export","path":"%.%","layout":"%"})"},
        {"export preset", R"({"do":"export","path":"%.glb","layout":"baked","preset":"%"})"},
        {"export targets", R"({"do":"export","path":"targets.glb","layout":"baked","targets":"%"})"},
        {"write-mesh state", R"({"do":"write-mesh","path":"%.obj","state":"%"})"},
        {"map-input silence", R"({"do":"map-input","source":"osc","channel":"/%","target":"bone/tail-bone/start/x","silence":"%"})"},
        {"suggest-mappings protocol", R"({"do":"suggest-mappings","protocol":"%"})"},
        {"suggest-cycles names", R"({"do":"suggest-cycles","names":{"%":"my %"}})"},
        {"render theme", R"({"do":"render","path":"%.png","width":64,"height":36,"theme":"%"})"},
    };
    const std::set<std::string> named = {"set target", "add-joint-face plane", "edit-joint-face plane", "cut plane", "move-cut plane", "deform-element faces", "export pose", "accuracy pose", "map-input source", "map-input channel",  // quotes of other things
                                         "propose from", "import-skeleton unit", "import-skeleton up", "import-clips unit", "import-clips up", "express expression", "morph target"};  // need a file with a skeleton or morph targets: make_soft_test, rig_test of document
    std::string lines = "{\"do\":\"write-mesh\",\"path\":\"rest.obj\",\"element\":\"head\",\"state\":\"rest\"}\n", command;
    std::size_t tried = 0;
    const std::regex key("^    (?:\\[([a-z_-]+)\\]|([a-z_-]+)) +(?:a text|any value|an object)\\. (.*)$");
    for (const std::string& line : linesOf(help())) {
        if (std::regex_match(line, std::regex("[a-z]+(-[a-z]+)*"))) command = line;
        std::smatch found;
        if (!std::regex_match(line, found, key)) continue;
        const std::string name = command + " " + found[1].str() + found[2].str();
        std::vector<std::string> choices = all(found[3], "\"([a-z][a-z0-9-]*)\"");
        if (choices.empty() || named.contains(name)) continue;
        CAPTURE(name);
        REQUIRE(tries.contains(name));
        for (const std::string& choice : choices) {
            std::string text = tries.at(name);
            for (auto at = text.find('%'); at != std::string::npos; at = text.find('%')) text.replace(at, 1, choice);
            if (name == "export layout") text = std::regex_replace(text, std::regex(choice + "\\." + choice), choice + (choice == "cache" ? ".pc2" : ".glb"));
            // One effect at a time.
            if (name == "disable effect") lines += std::regex_replace(text, std::regex("disable"), "enable") + "\n";
            lines += text + "\n";
            if (name == "enable effect") lines += std::regex_replace(text, std::regex("enable"), "disable") + "\n";
        }
        ++tried;
    }
    CHECK(tried == tries.size());
    // Properties of `set` and names of `measure`, which their help lists in one sentence each.
    const std::string text = help().substr(help().find("\nset\n"));
    const auto quoted = [&](const std::string& property) { return all(all(text, (property + " \\(([^()]*)\\)").c_str()).at(0), "\"([a-z][a-z0-9:N-]*)\""); };
    for (const char* property : {"solver-mesh", "joint-planes"})
        for (const std::string& value : quoted(property))
            lines += Json{{"do", "set"}, {"target", "head"}, {"property", property}, {"value", std::regex_replace(value, std::regex("N$"), "300")}}.dump() + "\n";
    for (const char* property : {"basis", "format"})
        for (const std::string& value : quoted(property)) lines += Json{{"do", "set"}, {"target", "character"}, {"property", property}, {"value", value}}.dump() + "\n";
    const auto measures = all(linesOf(help().substr(help().find("\nmeasure\n"))).at(2), "\"([a-z]+)\"");
    CHECK(measures.size() == 8);
    std::string first;
    for (const std::string& what : measures) {
        Json measure{{"do", "measure"}, {"what", what}};
        if (what == "stiffness") measure["element"] = "head";
        if (what == "position") measure["endpoint"] = "head-bone/end";
        if (what == "length") measure["bone"] = "head-bone";
        first += measure.dump() + "\n";
    }
    onCaterpillar(first + lines);
}
