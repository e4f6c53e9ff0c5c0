// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <QObject>
#include <optional>
#include <string>
#include <vector>

#include "core/commands/core_commands.h"
#include "core/reports/report_commands.h"
#include "tests/support/shapes.h"
#include "ui/models/studio_document.h"
#include "ui/tools/tool.h"
#include "ui/viewport/camera_controller.h"

namespace imomushi {

/// A document of test bodies that is looked at with an orthographic camera of 800 x 600 pixels, and pointers in it. No display.
struct ToolStage {
    CommandRegistry registry;
    std::optional<StudioDocument> made;
    CameraController camera;
    std::map<std::string, TriangleMesh> bodies;
    std::vector<QString> refusals;

    ToolStage() {
        addCoreCommands(registry);
        addReportCommands(registry);
        made.emplace(registry);
        made->services().import = [this](const ImportRequest& request, const Progress&) -> Result<ImportResult> {
            ImportedBody body;
            body.name = request.path.stem().string();
            body.mesh.body = bodies.at(body.name);
            body.mesh.renderMesh.triangles = body.mesh.body.triangles;
            for (std::int32_t v = 0; v < body.mesh.body.vertices.rows(); ++v) body.mesh.renderMesh.bodyVertex.push_back(v);
            body.closed = true;
            ImportResult result;
            result.format = "obj";
            result.bodies.push_back(std::move(body));
            return result;
        };
        QObject::connect(&document(), &StudioDocument::failed, [this](const QString& text) { refusals.push_back(text); });
        camera.setViewport(800, 600);
        camera.setOrthographic(true);
    }

    StudioDocument& document() { return *made; }
    const Session& session() { return made->session(); }
    const Document& now() { return made->document(); }
    int steps() { return session().position(); }

    void add(const std::string& name, const TriangleMesh& mesh) {
        bodies[name] = mesh;
        const auto answer = document().execute({{"do", "import-element"}, {"path", name + ".obj"}, {"name", name}});
        REQUIRE_MESSAGE(answer.has_value(), (answer ? "" : answer.error().message));
    }
    void run(const Json& command) {
        const auto answer = document().execute(command);
        REQUIRE_MESSAGE(answer.has_value(), (answer ? "" : answer.error().message));
    }
    /// Looks along an axis at everything.
    void look(ViewAxis axis) {
        camera.setAxis(axis, false);
        std::vector<Vec3> points;
        for (const auto& [id, element] : now().elements)
            for (std::int32_t v = 0; v < element->mesh->body.vertices.rows(); ++v) points.push_back(element->mesh->body.vertices.row(v));
        camera.frame(points, false);
    }
    const Element& element(const std::string& name) { return *now().elementNamed(name); }

    PointerEvent at(double x, double y, Qt::MouseButton button, Qt::MouseButtons buttons, Qt::KeyboardModifiers modifiers = {}) const {
        PointerEvent e;
        e.x = x;
        e.y = y;
        e.button = button;
        e.buttons = buttons;
        e.modifiers = modifiers;
        camera.aim(e);
        return e;
    }
    Eigen::Vector2d screen(const Vec3& p) const { return *camera.onScreen(p); }
    void hover(Tool& tool, const Vec3& p, Qt::KeyboardModifiers modifiers = {}) const {
        const auto s = screen(p);
        tool.move(at(s.x(), s.y(), Qt::NoButton, Qt::NoButton, modifiers));
    }
    void click(Tool& tool, const Vec3& p, Qt::KeyboardModifiers modifiers = {}) const {
        const auto s = screen(p);
        tool.move(at(s.x(), s.y(), Qt::NoButton, Qt::NoButton, modifiers));
        tool.press(at(s.x(), s.y(), Qt::LeftButton, Qt::LeftButton, modifiers));
        tool.release(at(s.x(), s.y(), Qt::LeftButton, Qt::NoButton, modifiers));
    }
    void press(Tool& tool, const Vec3& p, Qt::KeyboardModifiers modifiers = {}) const {
        const auto s = screen(p);
        tool.move(at(s.x(), s.y(), Qt::NoButton, Qt::NoButton, modifiers));
        tool.press(at(s.x(), s.y(), Qt::LeftButton, Qt::LeftButton, modifiers));
    }
    void pull(Tool& tool, const Vec3& p, Qt::KeyboardModifiers modifiers = {}) const {
        const auto s = screen(p);
        tool.move(at(s.x(), s.y(), Qt::NoButton, Qt::LeftButton, modifiers));
    }
    void letGo(Tool& tool, const Vec3& p) const {
        const auto s = screen(p);
        tool.release(at(s.x(), s.y(), Qt::LeftButton, Qt::NoButton));
    }
    /// A click that is given as a place in the document: one element of the selection.
    std::optional<SelectionItem> selected() {
        if (document().selection().size() != 1) return std::nullopt;
        return document().selection().front();
    }
};

/// Two bars end to end along x: "left" from -3 to 0, "right" from 0 to 3, one metre thick.
inline void addTwoBars(ToolStage& stage) {
    stage.add("left", shapes::box(Vec3(-3, -0.5, -0.5), Vec3(0, 0.5, 0.5), 6, 2, 2).mesh);
    stage.add("right", shapes::box(Vec3(0, -0.5, -0.5), Vec3(3, 0.5, 0.5), 6, 2, 2).mesh);
}

/// Two joined bars with a bone in each: "bone 1" from (-3,0,0) to the joint, "bone 2" from there to (3,0,0).
inline void addTwoBones(ToolStage& stage) {
    addTwoBars(stage);
    const auto face = [&](const char* element, const char* name, double x, double nx) {
        stage.run({{"do", "add-joint-face"},
                   {"element", element},
                   {"name", name},
                   {"plane", {{"origin", Json::array({x, 0.0, 0.0})}, {"normal", Json::array({nx, 0.0, 0.0})}}}});
    };
    face("left", "tail", -3, -1);
    face("left", "joint", 0, 1);
    face("right", "joint", 0, -1);
    face("right", "tip", 3, 1);
    stage.run({{"do", "join"}, {"a", "left/joint"}, {"b", "right/joint"}});
    stage.run({{"do", "add-bone"}, {"name", "bone 1"}, {"element", "left"}, {"from", "left/tail"}, {"to", "left/joint"}});
    stage.run({{"do", "add-bone"}, {"name", "bone 2"}, {"element", "right"}, {"from", "bone 1/end"}, {"to", "right/tip"}});
}

}  // namespace imomushi
