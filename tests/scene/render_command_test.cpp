// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/headless/render_command.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/commands/core_commands.h"
#include "core/session/session.h"
#include "tests/document/workbench.h"
#include "tests/render/picture.h"
#include "tests/support/folder.h"
#include "ui/render/image.h"

using namespace imomushi;

namespace {

struct Bench {
    CommandRegistry registry;
    std::unique_ptr<Session> session;
    TestFolder folder;

    Bench() {
        addCoreCommands(registry);
        addRenderCommand(registry);
        session = std::make_unique<Session>(registry);
        session->services().import = [](const ImportRequest&, const Progress&) -> Result<ImportResult> {
            ImportResult result;
            result.format = "shape";
            result.bodies.push_back(importedBody("bar", shapes::bar(2).mesh));
            return result;
        };
        REQUIRE(session->execute({{"do", "import-element"}, {"path", "bar"}, {"name", "bar"}}));
    }

    [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }
    std::string code(Json command) {
        command["do"] = "render";
        const auto answer = session->execute(command);
        return answer ? "ok" : answer.error().code;
    }
    Json plain(int width = 90, int height = 60) const { return {{"path", file("a.png")}, {"width", width}, {"height", height}}; }
    Picture picture(Json command) {
        REQUIRE(code(command) == "ok");
        std::ifstream in(command["path"].get<std::string>(), std::ios::binary);
        const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
        auto image = render::decodeImage(bytes);
        REQUIRE(image.has_value());
        return {image->width, image->height, std::move(image->rgba)};
    }
};

}  // namespace

TEST_CASE("render writes a picture of the asked size that shows the element, the same bytes twice") {
    Bench bench;
    const Picture first = bench.picture(bench.plain());
    CHECK(first.width == 90);
    CHECK(first.height == 60);
    CHECK(bench.picture(bench.plain()).rgba == first.rgba);
    REQUIRE(bench.session->execute({{"do", "set"}, {"target", "bar"}, {"property", "visible"}, {"value", false}}));
    // The default view leaves a margin of a sixth and no more.
    CHECK(differing(first, bench.picture(bench.plain()), 20) > 90 * 60 / 10);
}

TEST_CASE("render takes a camera, a theme, bones, and a transparent background") {
    Bench bench;
    const Picture first = bench.picture(bench.plain());
    Json camera = bench.plain();
    camera["camera"] = {{"eye", {5, 1, 0}}, {"target", {0, 0, 0}}, {"up", {0, 1, 0}}, {"fov", 0.5}};
    CHECK(differing(first, bench.picture(camera)) > 300);
    Json light = bench.plain();
    light["theme"] = "light";
    CHECK(bench.picture(light).grey(1, 1) > first.grey(1, 1) + 60);
    REQUIRE(bench.session->execute({{"do", "add-bone"}, {"name", "b"}, {"from", {0, 0, 0}}, {"to", {0, 0, 3}}}));
    CHECK(bench.picture(bench.plain()).rgba == first.rgba);
    Json bones = bench.plain();
    bones["bones"] = true;
    CHECK(differing(first, bench.picture(bones)) > 20);
    Json clear = bench.plain();
    clear["transparent"] = true;
    CHECK(bench.picture(clear).at(1, 1)[3] == 0);
}

TEST_CASE("render refuses what it cannot draw or write, and leaves no undo step") {
    Bench bench;
    const int steps = bench.session->position();
    const auto changed = [&](const char* key, Json value) {
        Json command = bench.plain();
        command[key] = std::move(value);
        return bench.code(command);
    };
    for (const int size : {0, -3, 8193}) {
        CHECK(changed("width", size) == "bad-value");
        CHECK(changed("height", size) == "bad-value");
    }
    CHECK(bench.code(bench.plain(8192, 8192)) == "bad-value");
    CHECK(changed("width", 10.5) == "bad-type");
    CHECK(changed("path", "a.jpg") == "bad-value");
    CHECK(changed("theme", "pink") == "bad-value");
    CHECK(changed("colour", "red") == "unknown-key");
    CHECK(changed("camera", 3) == "bad-type");
    CHECK(changed("camera", Json::object()) == "missing-key");
    const auto camera = [&](Json more) {
        Json c = {{"eye", {0, 0, 5}}, {"target", {0, 0, 0}}};
        for (const auto& [key, value] : more.items()) c[key] = value;
        return changed("camera", c);
    };
    CHECK(camera({{"eye", {0, 0, 0}}}) == "bad-value");
    CHECK(camera({{"eye", {0, 0}}}) == "bad-value");
    CHECK(camera({{"eye", {0, 0, 1e30}}}) == "bad-value");
    CHECK(camera({{"eye", {0, 0, "far"}}}) == "bad-value");
    CHECK(camera({{"up", {0, 0, 1}}}) == "bad-value");
    CHECK(camera({{"up", {0, 0, 0}}}) == "bad-value");
    CHECK(camera({{"fov", 0}}) == "bad-value");
    CHECK(camera({{"fov", 3.2}}) == "bad-value");
    CHECK(camera({{"fov", "wide"}}) == "bad-value");
    CHECK(camera({{"zoom", 2}}) == "unknown-key");
    CHECK(changed("path", "/no/such/folder/a.png") == "not-writable");
    CHECK(bench.session->position() == steps);
}
