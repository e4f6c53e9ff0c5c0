// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/body_drag.h"

#include <numbers>

#include "tests/tools/stage.h"
#include "ui/tools/select_tool.h"
#include "ui/scene/document_scene.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;
using Sizes = render::GizmoSizes;

namespace {

/// Two joined bars along x with bones, and a box above that is alone.
struct BodyStage : ToolStage {
    SelectTool tool{document()};
    BodyStage() {
        addTwoBones(*this);
        add("alone", shapes::box(Vec3(-1, 2, -0.5), Vec3(1, 3, 0.5), 2, 2, 2).mesh);
        look(ViewAxis::Front);
        select("alone");
    }
    void select(const char* name) { document().select({{Kind::Element, now().elementNamed(name)->id, {}, false}}); }
    [[nodiscard]] double pixel() const { return at(0, 0, Qt::NoButton, {}).pixelSize; }
    Vec3 middle(const char* name) {
        const Points& v = now().elementNamed(name)->mesh->body.vertices;
        return 0.5 * (v.colwise().minCoeff() + v.colwise().maxCoeff()).transpose();
    }
    double height(const char* name) {
        const auto y = now().elementNamed(name)->mesh->body.vertices.col(1);
        return y.maxCoeff() - y.minCoeff();
    }
    void type(const QString& text) {
        for (const QChar sign : text) CHECK(tool.key(Qt::Key_unknown, {}, QString(sign)));
    }
};

}  // namespace

TEST_CASE("bodies: the gizmo of a selected element moves it by an axis, in one step; Esc leaves it, and a click there selects as ever") {
    BodyStage s;
    const Vec3 from = s.middle("alone"), grip = from + 60 * s.pixel() * Vec3::UnitY();
    const int before = s.steps();
    s.press(s.tool, grip);
    s.pull(s.tool, grip + Vec3(0.3, 0.4, 0));
    CHECK(s.steps() == before);
    s.letGo(s.tool, grip + Vec3(0.3, 0.4, 0));
    CHECK((s.middle("alone") - from - Vec3(0, 0.4, 0)).norm() < 1e-6);
    CHECK(s.steps() == before + 1);
    s.run({{"do", "undo"}});
    CHECK((s.middle("alone") - from).norm() == 0.0);
    s.press(s.tool, grip);
    s.pull(s.tool, grip + Vec3(0.3, 0.4, 0));
    s.tool.cancel();
    CHECK((s.middle("alone") - from).norm() == 0.0);
    CHECK(!s.tool.busy());
    s.click(s.tool, from + 20 * s.pixel() * Vec3::UnitY());
    CHECK(s.steps() == before);
    CHECK(s.selected()->part == s.now().elementNamed("alone")->id);
}

TEST_CASE("bodies: G moves, then R turns and S scales, with typed numbers, axes and Enter; all that is joined goes along with its bones") {
    BodyStage s;
    s.select("left");
    s.hover(s.tool, Vec3(0, 1.5, 0));
    CHECK(s.tool.wants(Qt::Key_G));
    CHECK(s.tool.wants(Qt::Key_R));
    const int before = s.steps();
    CHECK(s.tool.key(Qt::Key_G, {}));
    CHECK(s.tool.modal());
    CHECK(s.tool.wants(Qt::Key_R));
    CHECK(s.tool.key(Qt::Key_X, {}));
    s.type(QStringLiteral("1.5"));
    CHECK(s.tool.key(Qt::Key_Return, {}));
    CHECK((s.middle("left") - Vec3(0, 0, 0)).norm() < 1e-9);
    CHECK((s.middle("right") - Vec3(3, 0, 0)).norm() < 1e-9);
    CHECK((s.middle("alone") - Vec3(0, 2.5, 0)).norm() == 0.0);
    CHECK((*endpointRestPosition(s.now(), {s.now().boneNamed("bone 2")->id, true}) - Vec3(4.5, 0, 0)).norm() < 1e-9);
    CHECK(s.steps() == before + 1);
    CHECK(s.tool.key(Qt::Key_G, {}));
    CHECK(s.tool.key(Qt::Key_R, {}));
    s.type(QStringLiteral("90"));
    CHECK(s.tool.key(Qt::Key_Return, {}));
    CHECK((s.middle("right") - Vec3(1.5, 1.5, 0)).norm() < 1e-9);  // about the middle of both, as it is seen
    CHECK(s.tool.key(Qt::Key_S, {}));
    s.type(QStringLiteral("2"));
    CHECK(s.tool.key(Qt::Key_Return, {}));
    CHECK((s.middle("right") - Vec3(1.5, 3.0, 0)).norm() < 1e-9);
    CHECK(s.height("right") == doctest::Approx(6.0));
    CHECK(s.steps() == before + 3);
}

TEST_CASE("bodies: what is seen goes along while the pointer leads, with bones and faces; the document waits") {
    BodyStage s;
    s.select("left");
    s.hover(s.tool, Vec3(0, 1.5, 0));
    CHECK(s.tool.key(Qt::Key_G, {}));
    CHECK(s.tool.key(Qt::Key_Y, {}));
    s.type(QStringLiteral("2"));
    DocumentScene scenes;
    render::Scene scene;
    SceneOptions options;
    options.bones = true;
    scenes.update(s.session(), options, scene);
    s.tool.decorate(scene);
    int seen = 0;
    for (const render::Body& body : scene.bodies) {
        const auto part = scenePart(body.id);
        const Element& element = *s.now().elements.at(part->part);
        const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>> shown(body.positions, element.mesh->body.vertices.rows(), 3);
        const double by = element.name == "alone" ? 0.0 : 2.0;
        CHECK(((shown.cast<double>() - element.mesh->body.vertices).rowwise() - Eigen::RowVector3d(0, by, 0)).cwiseAbs().maxCoeff() < 1e-6);
        ++seen;
    }
    CHECK(seen == 3);
    int bones = 0;
    for (const render::Marker& m : scene.markers)
        if (m.shape == render::Marker::Shape::Bone) CHECK(m.from.y() == doctest::Approx(2.0)), ++bones;
    CHECK(bones == 2);
    CHECK((s.middle("left") - Vec3(-1.5, 0, 0)).norm() == 0.0);
    s.tool.cancel();
    CHECK((s.middle("left") - Vec3(-1.5, 0, 0)).norm() == 0.0);
}

TEST_CASE("bodies: the magnet takes the middle to the grid; locked ones have no gizmo, and a scale says before that results go") {
    BodyStage s;
    ToolOptions options;
    options.snap.on = options.snap.grid = true;
    options.snap.step = 0.5;
    options.snap.vertices = options.snap.surface = options.snap.middle = options.snap.ends = false;
    s.tool.setOptions(options);
    s.hover(s.tool, Vec3(0, 1.4, 0));
    CHECK(s.tool.key(Qt::Key_G, {}));
    s.hover(s.tool, Vec3(0.83, 1.4, 0));
    CHECK(s.tool.key(Qt::Key_Return, {}));
    CHECK((s.middle("alone") - Vec3(1.0, 2.5, 0)).norm() < 1e-9);
    s.run({{"do", "add-joint-face"}, {"element", "alone"}, {"name", "low"}, {"plane", {{"origin", {1.0, 2.0, 0.0}}, {"normal", {0, -1, 0}}}}});
    s.run({{"do", "set"}, {"target", "alone"}, {"property", "solver-mesh"}, {"value", "as-is"}});
    s.run({{"do", "precompute"}, {"elements", {"alone"}}});
    s.select("alone");
    s.hover(s.tool, Vec3(0, 1.4, 0));
    CHECK(s.tool.key(Qt::Key_G, {}));
    CHECK(s.tool.hint().contains(QStringLiteral("Results go along")));
    CHECK(s.tool.key(Qt::Key_S, {}));
    CHECK(s.tool.banner().contains(QStringLiteral("must be precomputed again")));
    CHECK(!s.tool.banner().contains(QStringLiteral("takes")));
    s.tool.cancel();
    // A take of the flesh goes along to another place, and loses what it shows by a turn.
    s.run({{"do", "record"}, {"take", "still"}, {"action", "start"}});
    s.run({{"do", "step"}, {"frames", 2}});
    s.run({{"do", "record"}, {"take", "still"}, {"action", "stop"}});
    s.select("alone");
    s.hover(s.tool, Vec3(0, 1.4, 0));
    CHECK(s.tool.key(Qt::Key_G, {}));
    CHECK(!s.tool.banner().contains(QStringLiteral("takes")));
    CHECK(s.tool.key(Qt::Key_R, {}));
    CHECK(s.tool.banner().contains(QStringLiteral("takes will show their poses alone")));
    s.tool.cancel();
    s.run({{"do", "set"}, {"target", "alone"}, {"property", "locked"}, {"value", true}});
    CHECK(!s.tool.wants(Qt::Key_G));
    CHECK(!s.tool.key(Qt::Key_S, {}));
}

TEST_CASE("bodies: R turns what is selected at once, a bone's end too; where R chooses what the gizmo has, it does not") {
    BodyStage s;
    s.select("left");
    s.hover(s.tool, Vec3(0, 1.5, 0));
    const int before = s.steps();
    CHECK(s.tool.key(Qt::Key_R, {}));
    CHECK(s.tool.modal());
    s.type(QStringLiteral("90"));
    CHECK(s.tool.key(Qt::Key_Return, {}));
    CHECK((s.middle("right") - Vec3(0, 1.5, 0)).norm() < 1e-9);
    CHECK(s.steps() == before + 1);
    s.run({{"do", "undo"}});
    const EndpointRef tip{s.now().boneNamed("bone 2")->id, true};
    s.document().select({{Kind::Endpoint, tip.bone, {}, true}});
    s.hover(s.tool, Vec3(0, 1.6, 0));
    CHECK(s.tool.wants(Qt::Key_R));
    CHECK(s.tool.key(Qt::Key_R, {}));
    s.type(QStringLiteral("30"));
    CHECK(s.tool.key(Qt::Key_Return, {}));
    CHECK(s.now().goals.at(tip).roll.value_or(0.0) == doctest::Approx(std::numbers::pi / 6.0));
    ToolOptions options;
    options.turnKey = false;
    s.tool.setOptions(options);
    s.select("left");
    CHECK(!s.tool.wants(Qt::Key_R));
    CHECK(!s.tool.key(Qt::Key_R, {}));
    CHECK(s.tool.wants(Qt::Key_G));
}
