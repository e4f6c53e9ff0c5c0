// SPDX-License-Identifier: GPL-3.0-or-later
#include <QElapsedTimer>
#include <filesystem>

#include "tests/studio/window.h"
#include "ui/models/texts.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/picking/picking.h"

using namespace imomushi;

namespace {

/// A penguin where third-party meshes are, else a cylinder.
QString body() {
    const QString penguin = QStringLiteral(IMOMUSHI_SHARED_MESHES "/penguin.obj");
    return std::filesystem::exists(penguin.toStdString()) ? penguin : QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj");
}

/// The body vertex that is farthest along a direction.
Vec3 farthest(const Element& element, const Vec3& direction) {
    Eigen::Index at = 0;
    (element.mesh->body.vertices * direction).maxCoeff(&at);
    return element.mesh->body.vertices.row(at).transpose();
}

}  // namespace

TEST_CASE("studio: four clicks on a body are four handles, soft at once, and one is dragged, pinned and looked at") {
    Window w;
    w.trigger("soft-at-once");
    w.import(body());
    REQUIRE(w.now().elements.size() == 1);
    const PartId id = w.now().elements.begin()->first;
    const auto element = [&]() -> const Element& { return *w.now().elements.at(id); };
    w.trigger("tool-handle");
    double placed = 0.0;
    QElapsedTimer clock;
    for (const Vec3& direction : {Vec3(0, 1, 0), Vec3(0, -1, 0.1), Vec3(-1, 0, 0.1), Vec3(1, 0, 0.1)}) {
        // Looked at from that side, so that nothing hides it.
        w.look(direction + Vec3(0.05, 0.1, 0.35));
        const std::size_t before = element().handles.size();
        const Vec3 place = farthest(element(), direction);
        const QPoint at = w.onScreen(place + 0.02 * (Vec3(element().mesh->body.vertices.colwise().mean().transpose()) - place));
        QTest::mouseMove(&w.view(), at);
        w.settle();
        clock.start();
        QTest::mouseClick(&w.view(), Qt::LeftButton, {}, at);
        if (before == 0) {
            // The first one bends the body, which is held where it stands and says so, with a bend warp that keeps its volume; a click lets it go.
            REQUIRE(element().handles.size() > 1);
            for (std::size_t i = 1; i < element().handles.size(); ++i) CHECK(w.now().handleGoals.at({id, element().handles[i].face}).pinned);
            CHECK(w.now().effects[EffectKind::BendWarp].automatic);
            w.settle();
            w.shoot("handles-held");
            auto* letGo = w.window().messages().findChild<QPushButton*>();
            REQUIRE(letGo);
            QTest::mouseClick(letGo, Qt::LeftButton);
            w.settle();
        }
        REQUIRE(element().handles.size() == before + 1);
        // Placed to soft: a draft that fits.
        waitFor([&] { return w.document().session().responses().fittingOf(id) != nullptr; });
        placed = std::max(placed, 1e-3 * double(clock.elapsed()));
        w.settle();
    }
    MESSAGE("handle placed to body soft: ", placed, " s at most, ", element().mesh->body.vertices.rows(), " vertices");
    w.shoot("handles-placed");

    // Dragged with the pose tool: it follows the pointer, and the others stay.
    w.look(Vec3(0.2, 0.15, 1));
    w.trigger("tool-pose");
    const FaceRef hand{id, element().handles.back().face};
    const auto other = [&](std::size_t i) { return w.document().session().poseOf({id, element().handles[i].face})->at; };
    const Vec3 still = other(0);
    const QPoint from = w.onScreen(gripPosition(w.document().session(), {{}, hand}).value());
    QTest::mouseMove(&w.view(), from);
    w.settle();
    const int steps = w.document().session().position();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    for (int i = 1; i <= 12; ++i) {
        QTest::mouseMove(&w.view(), from + QPoint(3 * i, -10 * i));
        w.settle();
    }
    w.shoot("handles-dragging");
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + QPoint(36, -120));
    w.settle();
    CHECK(w.document().session().position() == steps + 1);
    REQUIRE(w.now().handleGoals.contains(hand));
    CHECK((*w.view().onScreen(gripPosition(w.document().session(), {{}, hand}).value()) - QPointF(from + QPoint(36, -120))).manhattanLength() < 6.0);
    CHECK((other(0) - still).norm() < 1e-12);
    CHECK(w.document().selection() == std::vector<SelectionItem>{{SelectionItem::Kind::Face, id, hand.face, false}});
    CHECK(w.window().inspector().findChildren<NumberField*>().size() >= 4);
    w.trigger("pin");
    CHECK(w.now().handleGoals.at(hand).pinned);

    // What the settings ask for comes by itself, or by hand where it takes long.
    waitFor([&] { return !w.window().precompute().job().running(); });
    if (w.document().session().responseState(id) != Session::ResponseState::Fresh) {
        w.trigger("precompute");
        waitFor([&] { return !w.window().precompute().job().running(); });
    }
    CHECK(w.document().session().responseState(id) == Session::ResponseState::Fresh);
    w.shoot("handles-precomputed");
    w.trigger("delete");
    CHECK(element().handles.size() == 3);
    CHECK(!w.now().handleGoals.contains(hand));
}

namespace {

/// The body with handles at both ends and at its right, soft. Drafts are what its settings ask for: nobody waits for better ones.
PartId importSoft(Window& w) {
    w.trigger("soft-at-once");
    w.import(body());
    REQUIRE(w.now().elements.size() == 1);
    const Element& element = *w.now().elements.begin()->second;
    const PartId id = element.id;
    w.run({{"do", "set"}, {"target", element.name}, {"property", "solver-mesh"}, {"value", "draft"}});
    for (const Vec3& direction : {Vec3(0, 1, 0), Vec3(0, -1, 0.1), Vec3(1, 0, 0.1)}) {
        const Vec3 point = farthest(element, direction);
        w.run({{"do", "handle"}, {"element", element.name}, {"point", {point.x(), point.y(), point.z()}}});
    }
    w.look(Vec3(0.2, 0.15, 1));
    waitFor([&] { return w.document().session().responses().fittingOf(id) != nullptr; });
    waitFor([&] { return !w.window().precompute().job().running(); });
    w.document().select({});
    return id;
}

/// The share of pixels that differ clearly.
double different(const QImage& a, const QImage& b) {
    REQUIRE(a.size() == b.size());
    int count = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x) {
            const QColor p = a.pixelColor(x, y), q = b.pixelColor(x, y);
            count += std::abs(p.red() - q.red()) + std::abs(p.green() - q.green()) + std::abs(p.blue() - q.blue()) > 60;
        }
    return double(count) / (double(a.width()) * a.height());
}

}  // namespace

TEST_CASE("studio: flesh anywhere is pulled by a passing handle, soft while it is dragged, and everything is as it was after that") {
    Window w;
    const PartId id = importSoft(w);
    const auto element = [&]() -> const Element& { return *w.now().elements.at(id); };
    const auto response = w.document().session().responses().fittingOf(id);
    CHECK(!w.shared->actions()["passing-handles"]->isChecked());
    w.trigger("passing-handles");
    w.trigger("tool-pose");
    // The flesh that is in the middle of what is seen.
    const auto& vertices = element().mesh->body.vertices;
    const QPoint from = w.onScreen(Vec3(0.5 * (vertices.colwise().minCoeff() + vertices.colwise().maxCoeff()).transpose()));
    QTest::mouseMove(&w.view(), from);
    w.settle();
    w.shoot("passing-hint");
    const int steps = w.document().session().position();
    const std::vector<SelectionItem> selection = w.document().selection();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    QElapsedTimer clock;
    clock.start();
    QTest::mouseMove(&w.view(), from + QPoint(8, -2));
    REQUIRE(element().handles.size() == 4);
    const FaceRef made{id, element().handles.back().face};
    waitFor([&] { return w.document().session().responses().fittingOf(id) != nullptr; });
    MESSAGE("flesh pressed to soft: ", 1e-3 * double(clock.elapsed()), " s, ", vertices.rows(), " vertices");
    for (int i = 1; i <= 12; ++i) {
        QTest::mouseMove(&w.view(), from + QPoint(8 + 10 * i, -2 - 2 * i));
        w.settle();
        if (i == 2) w.shoot("passing-soft");
    }
    const QPoint to = from + QPoint(128, -26);
    w.shoot("passing-dragged");
    const Vec3 rest = element().faces.back().frame.origin;
    const double size = (vertices.colwise().maxCoeff() - vertices.colwise().minCoeff()).norm();
    waitFor([&] { return (w.document().session().poseOf(made)->at - rest).norm() > 0.01 * size; });
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, to);
    CHECK(element().handles.size() == 3);
    CHECK(w.document().session().responses().fittingOf(id) == response);  // by its key
    CHECK(w.document().session().position() == steps + 1);
    CHECK(stepText(w.document().session().steps().back().name, w.document().session().steps().back().subject) == QStringLiteral("Drag: ") + QString::fromStdString(element().name));
    CHECK(w.document().selection() == selection);
    CHECK(w.now().handleGoals.empty());
    w.settle();
    w.shoot("passing-gone");

    // Kept by K, also after it went.
    QTest::keyClick(&w.view(), Qt::Key_K);
    w.settle();
    CHECK(element().handles.size() == 4);
    waitFor([&] { return w.document().session().responses().fittingOf(id) != nullptr; });
    waitFor([&] { return !w.view().fading(); });
    w.shoot("passing-kept");
    CHECK(w.now().handleGoals.size() == 1);
    w.trigger("undo");
    CHECK(element().handles.size() == 3);
    CHECK(w.document().session().responses().fittingOf(id) == response);
    w.trigger("passing-handles");
    CHECK(!w.shared->actions()["passing-handles"]->isChecked());
}

TEST_CASE("studio: a body that is to become soft anew keeps its shape until it is") {
    Window w;
    const PartId id = importSoft(w);
    const Element& element = *w.now().elements.at(id);
    w.trigger("bones");  // off
    const HandlePose right = w.document().session().poseOf({id, element.handles[2].face}).value();
    const double size = (element.mesh->body.vertices.colwise().maxCoeff() - element.mesh->body.vertices.colwise().minCoeff()).norm();
    const Vec3 to = right.at + Vec3(-0.05, 0.2, 0.05) * size;
    w.run({{"do", "drag"}, {"endpoint", element.handles[2].face}, {"to", {to.x(), to.y(), to.z()}}});
    w.settle();
    const QImage soft = w.view().grabFramebuffer();
    w.shoot("anew-before");
    const Vec3 left = farthest(element, Vec3(-1, 0, 0.1));
    w.run({{"do", "handle"}, {"element", element.name}, {"point", {left.x(), left.y(), left.z()}}});
    REQUIRE(!w.document().session().responses().fittingOf(id));
    const QImage waiting = w.view().grabFramebuffer();
    CHECK(!w.document().session().responses().fittingOf(id));
    CHECK(w.view().fading());
    // While it fades, the processor draws half as many pixels each way: edges look softer. A rigid body differs by more, see below.
    CHECK(different(soft, waiting) < 0.01);
    // When it is soft it fades from there (tests/scene/shape_fade_test.cpp), and comes to an end.
    waitFor([&] { return w.document().session().responses().fittingOf(id) != nullptr; });
    waitFor([&] { return !w.view().fading(); });
    w.shoot("anew-after");
    MESSAGE("pixels that differ: ", different(soft, waiting), " while it waits, ", different(soft, w.view().grabFramebuffer()), " when it is soft");
    // Nothing waits where nobody makes it soft: then what is rigid is seen.
    w.trigger("soft-at-once");
    w.run({{"do", "remove-handle"}, {"handle", element.handles[2].face}});
    w.settle();
    CHECK(different(soft, w.view().grabFramebuffer()) > 0.01);
    w.trigger("bones");
}
