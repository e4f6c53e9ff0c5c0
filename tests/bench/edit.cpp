// SPDX-License-Identifier: GPL-3.0-or-later
// An edit of one element of 200: from the command to the live character that shows it, and what panels ask for afterwards. All elements differ a little, so that
// none is congruent with another.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "core/commands/core_commands.h"
#include "core/document/character_input.h"
#include "core/session/session.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

constexpr int kElements = 200;
constexpr int kRepeats = 15;

using Clock = std::chrono::steady_clock;
double milliseconds(Clock::time_point from) { return std::chrono::duration<double, std::milli>(Clock::now() - from).count(); }

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

Json run(Session& session, const Json& command) {
    auto answer = session.execute(command);
    if (!answer) {
        std::fprintf(stderr, "%s: %s\n", command.dump().c_str(), answer.error().message.c_str());
        std::exit(1);
    }
    return *answer;
}

ImportedBody bar(int n) {
    ImportedBody body;
    body.name = "bar";
    body.closed = true;
    TriangleMesh mesh = shapes::bar(2).mesh;
    mesh.vertices.col(0) *= 1.0 + 0.001 * n;
    mesh.vertices.col(2).array() += 3.0 * n;
    for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v) body.mesh.renderMesh.bodyVertex.push_back(v);
    body.mesh.renderMesh.triangles = mesh.triangles;
    body.mesh.body = std::move(mesh);
    return body;
}

void buildChain(Session& session) {
    session.services().import = [](const ImportRequest& request, const Progress&) -> Result<ImportResult> {
        ImportResult result;
        result.bodies.push_back(bar(std::stoi(request.path.string())));
        return result;
    };
    for (int n = 0; n < kElements; ++n) {
        const std::string name = "e" + std::to_string(n);
        run(session, {{"do", "import-element"}, {"path", std::to_string(n)}, {"name", name}});
        run(session, {{"do", "set"}, {"target", name}, {"property", "solver-mesh"}, {"value", "as-is"}});
        for (const auto& [face, z, normal] : {std::tuple("in", 3.0 * n, -1.0), std::tuple("out", 3.0 * n + 3.0, 1.0)})
            run(session, {{"do", "add-joint-face"}, {"element", name}, {"name", face}, {"plane", {{"origin", {0, 0, z}}, {"normal", {0, 0, normal}}}}});
        if (n > 0) run(session, {{"do", "join"}, {"a", "e" + std::to_string(n - 1) + "/out"}, {"b", name + "/in"}});
        const std::string bone = "b" + std::to_string(n);
        run(session, {{"do", "add-bone"}, {"name", bone}, {"element", name}, {"from", n == 0 ? Json(name + "/in") : Json("b" + std::to_string(n - 1) + "/end")}, {"to", name + "/out"}});
    }
}

/// The median of several edits: of the command alone, of the character that follows, and of what panels ask for.
void measure(Session& session, const char* title, const std::function<Json(int)>& edit) {
    std::vector<double> commands, characters, panels;
    for (int i = 0; i < kRepeats; ++i) {
        auto start = Clock::now();
        run(session, edit(i));
        commands.push_back(milliseconds(start));
        start = Clock::now();
        if (!session.character()) std::exit(1);
        characters.push_back(milliseconds(start));
        start = Clock::now();
        for (const auto& [id, element] : session.document().elements) {
            (void)session.responseState(id);
            (void)session.sharedResponse(id);
            (void)session.responseEstimate(id);
        }
        panels.push_back(milliseconds(start));
    }
    std::printf("%-34s %9.2f %12.2f %9.2f %9.2f\n", title, median(commands), median(characters), median(panels), median(commands) + median(characters) + median(panels));
}

double time(const std::function<void()>& work) {
    std::vector<double> times;
    for (int i = 0; i < kRepeats; ++i) {
        const auto start = Clock::now();
        work();
        times.push_back(milliseconds(start));
    }
    return median(times);
}

}  // namespace

int main() {
    CommandRegistry registry;
    addCoreCommands(registry);
    Session session(registry);
    auto start = Clock::now();
    buildChain(session);
    std::printf("%d elements built by commands in %.0f ms", kElements, milliseconds(start));
    start = Clock::now();
    run(session, {{"do", "precompute"}});
    std::printf(", precomputed in %.0f ms\n\nms, median of %d           command    character    panels       all\n", milliseconds(start), kRepeats);

    const auto set = [](const char* property, const Json& value) { return Json{{"do", "set"}, {"target", "e100"}, {"property", property}, {"value", value}}; };
    measure(session, "colour of an element", [&](int i) { return set("color", i % 2 ? "#102030" : "#302010"); });
    measure(session, "stiffness of an element", [&](int i) { return set("stiffness", 1.0 + 0.01 * i); });
    measure(session, "Poisson ratio of an element", [&](int i) { return set("nu", 0.3 + 0.001 * i); });
    measure(session, "undo of that", [](int) { return Json{{"do", "undo"}}; });
    measure(session, "stretch limit of a bone", [](int i) { return Json{{"do", "set"}, {"target", "b100"}, {"property", "max-stretch"}, {"value", 2.0 + 0.01 * i}}; });
    measure(session, "drag of the last bone's end", [](int i) { return Json{{"do", "drag"}, {"endpoint", "b199/end"}, {"to", {0.1 * i, 0.0, 600.0}}}; });

    const auto plan = planCharacter(session.document());
    const CharacterInput input = session.character()->input();
    std::printf("\nof these: plan of all %.2f, character of all built anew %.2f, content key of one element %.3f\n", time([&] { (void)planCharacter(session.document()); }),
                time([&] { (void)Character::build(input); }), time([&] { (void)responseKey(session.responseInput(session.document().elements.begin()->first)); }));
}
