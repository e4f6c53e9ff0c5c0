// SPDX-License-Identifier: GPL-3.0-or-later
#include <QElapsedTimer>
#include <filesystem>

#include "tests/studio/window.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/tools/picking.h"

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
    waitFor([&] { return !w.window().precomputeJob().running(); });
    if (w.document().session().responseState(id) != Session::ResponseState::Fresh) {
        w.trigger("precompute");
        waitFor([&] { return !w.window().precomputeJob().running(); });
    }
    CHECK(w.document().session().responseState(id) == Session::ResponseState::Fresh);
    w.shoot("handles-precomputed");
    w.trigger("delete");
    CHECK(element().handles.size() == 3);
    CHECK(!w.now().handleGoals.contains(hand));
}
