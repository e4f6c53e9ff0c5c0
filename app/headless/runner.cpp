// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/headless/runner.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>

#include "app/headless/live_command.h"
#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/reports/report_commands.h"
#include "core/session/session.h"
#ifdef IMOMUSHI_RENDER_COMMAND
#include "app/headless/render_command.h"
#endif

namespace imomushi {

namespace {

/// No command nests deeper than a few levels; a line of a million brackets must not use up the stack.
constexpr int kDeepestNesting = 64;

constexpr const char* kUsage =
    "Usage: imomushi run [--keep-going] [--cache FOLDER] SCRIPT\n"
    "SCRIPT holds one JSON object per line ({\"do\": \"open\", \"path\": \"a.imomushi\"}); \"-\" is standard input.\n"
    "--keep-going goes on after a command that failed. --cache keeps what is precomputed in a folder, for other scripts and projects.\n"
    "imomushi run --help lists all commands.\n";

void printHelp(std::ostream& out) {
    out << kUsage
        << "\nOne answer per command is printed: {\"line\":N,\"do\":NAME,\"ok\":true,...} or {..,\"ok\":false,\"error\":{\"code\",\"message\"}}.\n"
           "Exit status: 0 all well, 1 a command failed, 2 the script cannot be read or an option is wrong.\n"
           "Metres, +Y up, right-handed; radians; seconds; indices count from 0. Blank lines and lines that begin with # are skipped.\n"
           "A key in [brackets] can be left out.\n";
    const CommandRegistry registry = headlessRegistry();
    for (const Command& command : registry.all()) {
        out << "\n" << command.name << "\n    " << command.help << "\n";
        for (const CommandKey& key : command.keys) {
            const std::string name = key.required ? key.name : "[" + key.name + "]";
            out << "    " << name << std::string(name.size() < 14 ? 14 - name.size() : 1, ' ') << typeText(key.type) << ". " << key.help << "\n";
        }
    }
}

bool tooDeep(const std::string& line) {
    int depth = 0;
    bool inText = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (inText) {
            if (c == '\\') ++i;
            if (c == '"') inText = false;
        } else if (c == '"') {
            inText = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kDeepestNesting) return true;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return false;
}

/// Answers are always one line of valid UTF-8.
void print(std::ostream& out, const Json& answer) { out << answer.dump(-1, ' ', false, Json::error_handler_t::replace) << "\n" << std::flush; }

/// A line with the answer to one command; false when it failed.
bool perform(Session& session, int number, const std::string& line, std::ostream& out) {
    Json answer;
    answer["line"] = number;
    answer["do"] = "";
    const auto command = parseScriptLine(line);
    Result<Json> result = command ? Json() : Result<Json>(tl::unexpected(command.error()));
    if (command) {
        if (command->is_object())
            if (const Json* name = find(*command, "do"); name && name->is_string()) answer["do"] = *name;
        result = session.execute(*command);
    }
    answer["ok"] = result.has_value();
    if (result)
        for (const auto& item : result->items()) answer[item.key()] = item.value();
    else
        answer["error"] = {{"code", result.error().code}, {"message", result.error().message}};
    print(out, answer);
    return result.has_value();
}

}  // namespace

CommandRegistry headlessRegistry() {
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    addLiveCommands(registry);
#ifdef IMOMUSHI_RENDER_COMMAND
    addRenderCommand(registry);
#endif
    return registry;
}

Result<Json> parseScriptLine(const std::string& line) {
    if (tooDeep(line)) return fail("bad-json", "The line nests too deeply: no command needs more than a few levels.");
    std::vector<std::set<std::string>> keys;
    std::string doubled;
    const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::object_start) keys.emplace_back();
        if (event == Json::parse_event_t::object_end) keys.pop_back();
        if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second && doubled.empty())
            doubled = parsed.get<std::string>();
        return true;
    };
    try {
        Json value = Json::parse(line, watch);
        if (!doubled.empty()) return fail("duplicate-key", "The key \"" + doubled + "\" stands twice in one object: leave one out.");
        return value;
    } catch (const Json::exception& error) {
        std::string what = error.what();
        if (const auto end = what.find("] "); what.starts_with("[json.exception") && end != std::string::npos) what.erase(0, end + 2);
        return fail("bad-json", "The line is not JSON: " + what);
    }
}

int runMain(const std::vector<std::string>& arguments, std::istream& in, std::ostream& out, std::ostream& err) {
    bool keepGoing = false, options = true;
    std::vector<std::string> scripts;
    std::string cache;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string& argument = arguments[i];
        if (options && argument == "--") {
            options = false;
        } else if (options && argument == "--keep-going") {
            keepGoing = true;
        } else if (options && (argument == "--help" || argument == "-h")) {
            printHelp(out);
            return 0;
        } else if (options && argument == "--cache") {
            if (++i == arguments.size() || arguments[i].empty()) {
                err << "imomushi run: --cache needs a folder.\n" << kUsage;
                return 2;
            }
            cache = arguments[i];
        } else if (options && argument.size() > 1 && argument[0] == '-') {
            err << "imomushi run: there is no option " << argument << ".\n" << kUsage;
            return 2;
        } else {
            scripts.push_back(argument);
        }
    }
    if (scripts.size() != 1) {
        err << "imomushi run: name one script.\n" << kUsage;
        return 2;
    }
    std::ifstream file;
    if (scripts[0] != "-") {
        std::error_code error;
        file.open(scripts[0], std::ios::binary);
        if (!file || std::filesystem::is_directory(scripts[0], error)) {
            err << "imomushi run: the script " << scripts[0] << " cannot be read.\n";
            return 2;
        }
    }
    std::istream& script = scripts[0] == "-" ? in : file;

    const CommandRegistry registry = headlessRegistry();
    Session session(registry, cache.empty() ? nullptr : std::make_shared<ResponseStore>(ResponseStore::Limits{}, cache));
    bool allWell = true;
    std::string line;
    for (int number = 1; std::getline(script, line); ++number) {
        if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
        const auto begin = line.find_first_not_of(" \t\r");
        if (begin == std::string::npos || line[begin] == '#') continue;
        if (perform(session, number, line, out)) continue;
        allWell = false;
        if (!keepGoing) return 1;
    }
    if (script.bad()) {
        err << "imomushi run: the script " << scripts[0] << " cannot be read to its end.\n";
        return 2;
    }
    return allWell ? 0 : 1;
}

}  // namespace imomushi
