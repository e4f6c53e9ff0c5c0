// SPDX-License-Identifier: GPL-3.0-or-later
// How things are dragged, as the artist sets it.
#include <QDialog>
#include <QSettings>

#include "tests/studio/window.h"
#include "ui/widgets/number_field.h"

using namespace imomushi;

TEST_CASE("drag: the magnet and the gizmo's axes are chosen by their actions, kept in the settings, and followed by what is dragged") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    w.window().showStart(false);
    w.trigger("tool-pose");
    w.trigger("snap");
    CHECK(QSettings().value(QStringLiteral("drag/snap")).toBool());
    w.trigger("snap-steps");
    auto* dialog = w.window().findChild<QDialog*>(QStringLiteral("snapDialog"));
    REQUIRE(dialog);
    auto* step = dialog->findChild<NumberField*>(QStringLiteral("gridStep"));
    step->setFocus();
    step->selectAll();
    QTest::keyClicks(step, QStringLiteral("0.25"));
    QTest::keyClick(step, Qt::Key_Return);
    CHECK(QSettings().value(QStringLiteral("drag/grid-step")).toDouble() == doctest::Approx(0.25));
    dialog->accept();
    w.activate();
    w.look(Vec3(0, 0, 1));
    const EndpointRef end{w.now().boneNamed("head-bone")->id, true};
    const QPoint from = w.view().onScreen(end)->toPoint();
    QTest::mouseMove(&w.view(), from);
    w.settle();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    QTest::mouseMove(&w.view(), from + QPoint(20, -60));
    w.settle();
    CHECK(w.view().hint().startsWith(QStringLiteral("On the grid")));
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + QPoint(20, -60));
    w.settle();
    REQUIRE(w.now().goals.contains(end));
    for (int k = 0; k < 3; ++k) CHECK(std::abs(std::remainder(w.now().goals.at(end).target[k], 0.25)) < 1e-9);
    w.trigger("axes-local");
    CHECK(w.window().actions()["axes-local"]->isChecked());
    CHECK(!w.window().actions()["axes-world"]->isChecked());
    CHECK(QSettings().value(QStringLiteral("drag/axes")).toInt() == 1);
    w.trigger("axes-world");
    w.trigger("snap");
    QSettings().remove(QStringLiteral("drag/grid-step"));
}

TEST_CASE("drag: an end is taken hold of where it is and led from there, so that the first move solves no chain at once, and is one step") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    w.window().showStart(false);
    w.trigger("tool-pose");
    w.activate();
    w.look(Vec3(0, 0, 1));
    const EndpointRef end{w.now().boneNamed("head-bone")->id, true};
    const QPoint from = w.view().onScreen(end)->toPoint();
    QTest::mouseMove(&w.view(), from);
    w.settle();
    const Vec3 at = *w.document().session().positionOf(end);
    const int steps = w.document().session().position();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    QTest::mouseMove(&w.view(), from + QPoint(20, -60));
    w.settle();
    REQUIRE(w.now().goals.contains(end));
    CHECK((*w.document().session().positionOf(end) - at).norm() > 0.01);  // it follows
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + QPoint(20, -60));
    w.settle();
    CHECK(w.document().session().position() == steps + 1);
    CHECK((w.now().goals.at(end).target - at).norm() > 0.01);
    std::vector<Vec3> targets;
    for (const Json& line : w.document().session().script())
        if (line.at("do") == "drag" && line.at("endpoint") == "head-bone/end") targets.push_back({line["to"][0].get<double>(), line["to"][1].get<double>(), line["to"][2].get<double>()});
    REQUIRE(!targets.empty());
    CHECK((targets.front() - at).norm() < 1e-9);
    CHECK((targets.back() - w.now().goals.at(end).target).norm() < 1e-9);
    w.trigger("undo");
    w.settle();
    CHECK((*w.document().session().positionOf(end) - at).norm() < 1e-6);
}
