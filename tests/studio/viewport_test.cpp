// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/viewport_widget.h"

#include <QElapsedTimer>
#include <QFocusEvent>
#include <QOpenGLWidget>
#include <QSignalSpy>
#include <QWheelEvent>

#include "tests/studio/window.h"
#include "ui/viewport/frame_clock.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

namespace {

/// A cylinder with two faces and a bone, in the pose tool, seen from the side.
struct Posing : Window {
    EndpointRef end;
    Posing() {
        import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
        const std::string name = now().elements.begin()->second->name;
        run({{"do", "add-joint-face"}, {"element", name}, {"name", "a"}, {"plane", {{"origin", {0, 0, -2}}, {"normal", {0, 0, -1}}}}});
        run({{"do", "add-joint-face"}, {"element", name}, {"name", "b"}, {"plane", {{"origin", {0, 0, 2}}, {"normal", {0, 0, 1}}}}});
        run({{"do", "add-bone"}, {"name", "bone"}, {"element", name}, {"from", name + "/a"}, {"to", name + "/b"}});
        trigger("tool-pose");
        look(Vec3(1, 0.2, 0.1));
        end = {now().boneNamed("bone")->id, true};
        view().setFocus();
    }
    QPoint at() { return view().onScreen(end)->toPoint(); }
    void beginDrag() {
        const QPoint from = at();
        QTest::mouseMove(&view(), from);
        settle();  // this one moves the pointer of the display, whose event comes later
        QTest::mousePress(&view(), Qt::LeftButton, {}, from);
        for (int i = 1; i <= 4; ++i) QTest::mouseMove(&view(), from + QPoint(0, -12 * i));
        settle();
        REQUIRE(view().tools().busy());
        REQUIRE(now().goals.contains(end));
    }
};

}  // namespace

TEST_CASE("viewport: what a button holds goes on where another window takes the focus; where it goes elsewhere, or no button holds it, the drag is taken back and leaves no gesture open") {
    Posing w;
    const int before = w.document().session().position();
    // Sent as it is, for a display without a window manager has no focus to lose.
    const auto lose = [&](Qt::FocusReason reason) {
        QFocusEvent lost(QEvent::FocusOut, reason);
        QApplication::sendEvent(&w.view(), &lost);
    };
    w.beginDrag();
    lose(Qt::ActiveWindowFocusReason);
    lose(Qt::PopupFocusReason);
    CHECK(w.view().tools().busy());
    CHECK(w.now().goals.contains(w.end));
    lose(Qt::TabFocusReason);
    CHECK(!w.view().tools().busy());
    CHECK(!w.now().goals.contains(w.end));
    CHECK(w.document().session().position() == before);
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, w.at());
    // The pointer leads without a button.
    w.document().select({{SelectionItem::Kind::Endpoint, w.end.bone, {}, w.end.atEnd}});
    QTest::mouseMove(&w.view(), w.at());
    w.settle();
    QTest::keyClick(&w.view(), Qt::Key_G);
    REQUIRE(w.view().tools().busy());
    lose(Qt::ActiveWindowFocusReason);
    CHECK(!w.view().tools().busy());
    CHECK(w.document().session().position() == before);
    w.run({{"do", "pin"}, {"endpoint", "bone/start"}});
    CHECK(w.document().session().position() == before + 1);
}

TEST_CASE("viewport: however fast the mouse tells, the character goes where it was last; a release brings its own place, and Esc leaves none") {
    Posing w;
    w.beginDrag();
    const auto target = [&] { return w.now().goals.at(w.end).target; };
    const QPoint from = w.view().rect().center(), before = w.at();
    const auto move = [&](QPoint at) {
        QMouseEvent event(QEvent::MouseMove, at, w.view().mapToGlobal(at), Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&w.view(), &event);
    };
    int commands = 0;
    const auto counted = QObject::connect(&w.document(), &StudioDocument::poseChanged, &w.view(), [&] { ++commands; });
    for (int i = 0; i < 200; ++i) move(from + QPoint(i, 0));  // without a turn of the event loop
    waitFor([&] { return (w.at() - before).manhattanLength() > 40; });
    w.settle();
    CHECK(commands == 0);  // the performance is given targets, and the document stays as it is
    QObject::disconnect(counted);
    for (int i = 0; i < 20; ++i) move(from + QPoint(199, i));
    const Vec3 held = target();
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + QPoint(0, 60));
    const Vec3 released = target();
    w.settle();
    CHECK((target() - released).norm() == 0.0);
    CHECK((released - held).norm() > 0.01);

    const int steps = w.document().session().position();
    w.run({{"do", "release"}});
    w.run({{"do", "rest"}});
    w.settle();
    w.beginDrag();
    for (int i = 0; i < 20; ++i) move(from + QPoint(0, i));
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    w.settle();
    CHECK(!w.view().tools().busy());
    CHECK(!w.now().goals.contains(w.end));
    CHECK(w.document().session().position() >= steps);
}

TEST_CASE("latency: it counts from the first input that a picture follows, and from when a move came that waited for others, until the picture is on the screen") {
    constexpr InputTime kMs = 1'000'000;
    LatencyMeter m;
    CHECK(!m.swapped(5 * kMs));  // nothing was asked for
    CHECK(!m.latency());
    m.shows(10 * kMs);
    m.shows(20 * kMs);  // before anything was drawn: the picture follows both
    m.painted();
    m.shows(30 * kMs);  // after it was drawn: the next one does
    REQUIRE(m.swapped(1000 * kMs));
    CHECK(m.latency()->medianMs == doctest::Approx(990.0));
    CHECK(!m.swapped(1001 * kMs));
    m.painted();
    CHECK(!m.swapped(1080 * kMs));  // half a second has not passed: nothing is told, but it is measured
    CHECK(m.latency()->pictures == 2);
    CHECK(m.latency()->p99Ms == doctest::Approx(1050.0));
    m.forget();
    m.moved(1990 * kMs, 2006 * kMs);
    m.moved(2010 * kMs, 2011 * kMs);  // the first one counts
    m.shows(2005 * kMs);
    m.shows(2005 * kMs);  // and once
    m.painted();
    REQUIRE(m.swapped(2020 * kMs));
    CHECK(m.latency()->medianMs == doctest::Approx(30.0));
}

TEST_CASE("latency: a drag in the view has one, and the status bar says it") {
    Posing w;
    const auto* strip = w.window().findChild<StatusStrip*>();
    const auto said = [&] {
        const auto labels = strip->findChildren<QLabel*>();
        return std::any_of(labels.begin(), labels.end(), [](const QLabel* label) { return label->isVisible() && label->text().startsWith(QStringLiteral("latency ")); });
    };
    w.view().latency().forget();
    w.beginDrag();
    const QPoint from = w.at();
    int moves = 0;
    waitFor([&] {
        QTest::mouseMove(&w.view(), from + QPoint(++moves % 40, 0));
        return w.view().latency().latency() && said();
    });
    const auto latency = w.view().latency().latency();
    CHECK(latency->medianMs > 0.0);
    CHECK(latency->medianMs <= latency->p99Ms);
    QTest::keyClick(&w.view(), Qt::Key_Escape);
}

TEST_CASE("viewport: Esc, the right button and undo in mid-drag take the drag back, and nothing else") {
    Posing w;
    const int before = w.document().session().position();
    const QPoint rest = w.at();
    for (const int way : {0, 1, 2}) {
        w.beginDrag();
        if (way == 0) QTest::keyClick(&w.view(), Qt::Key_Escape);
        if (way == 1) QTest::mousePress(&w.view(), Qt::RightButton, {}, w.at());
        if (way == 2) QTest::keyClick(&w.view(), Qt::Key_Z, Qt::ControlModifier);
        w.settle();
        CHECK(!w.view().tools().busy());
        CHECK(w.document().session().position() == before);
        CHECK((w.at() - rest).manhattanLength() <= 1);
        if (way == 1) QTest::mouseRelease(&w.view(), Qt::RightButton, {}, w.at());
        QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, w.at());
    }
}

TEST_CASE("viewport: the middle button orbits, the wheel zooms to the pointer, and neither makes a step") {
    Posing w;
    const int before = w.document().session().position();
    const Eigen::Matrix3d axes = w.view().cameraController().axes();
    const QPoint centre = w.view().rect().center();
    QTest::mousePress(&w.view(), Qt::MiddleButton, {}, centre);
    QTest::mouseMove(&w.view(), centre + QPoint(40, 10));
    QTest::mouseRelease(&w.view(), Qt::MiddleButton, {}, centre + QPoint(40, 10));
    CHECK((w.view().cameraController().axes() - axes).norm() > 0.1);

    // What is at the target's depth under the pointer stays there.
    const Vec3 target = w.view().cameraController().camera().target + 0.5 * w.view().cameraController().axes().col(0);
    const QPointF pointer = *w.view().onScreen(target);
    const Vec3 eye = w.view().cameraController().camera().eye;
    QWheelEvent wheel(pointer, w.view().mapToGlobal(pointer), {}, QPoint(0, 240), Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase, false);
    QApplication::sendEvent(&w.view(), &wheel);
    CHECK((w.view().cameraController().camera().eye - eye).norm() > 0.1);
    CHECK((*w.view().onScreen(target) - pointer).manhattanLength() < 0.01);
    CHECK(w.document().session().position() == before);
}

TEST_CASE("viewport: the axis ball and the number keys show the axis views") {
    Posing w;
    QTest::keyClick(&w.view(), Qt::Key_3);
    waitFor([&] { return !w.view().cameraController().moving(); });
    CHECK((w.view().cameraController().axes().col(2) - Vec3::UnitX()).norm() < 1e-9);
    // Seen along x, the ball has y at its top.
    QTest::mouseClick(&w.view(), Qt::LeftButton, {}, QPoint(w.view().width() - 56, 22));
    waitFor([&] { return !w.view().cameraController().moving(); });
    CHECK((w.view().cameraController().axes().col(2) - Vec3::UnitY()).norm() < 1e-9);
    QTest::keyClick(&w.view(), Qt::Key_5);
    CHECK(w.view().orthographic());
}

TEST_CASE("viewport: fast pictures are coarse ones, fine ones are what a picture of the view is made of") {
    Posing w;
    auto* canvas = w.view().findChild<QOpenGLWidget*>();
    REQUIRE(canvas);
    const auto drawn = [&] { return canvas->grabFramebuffer(); };
    waitFor([&] { return !w.view().cameraController().moving(); });
    const QImage fine = w.view().grabFramebuffer();
    w.view().setPictureQuality(ViewportWidget::PictureQuality::Fast);
    CHECK(drawn() != fine);
    w.view().setPictureQuality(ViewportWidget::PictureQuality::Fine);
    CHECK(drawn() == fine);
}

TEST_CASE("viewport: draws while something moves and is still when nothing does") {
    Posing w;
    w.beginDrag();
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, w.at());
    QSignalSpy steps(&w.document(), &StudioDocument::frameStepped);
    waitFor([&] {
        steps.clear();
        return stays([&] { return steps.isEmpty(); });
    });
    QSignalSpy frames(&w.view(), &ViewportWidget::frameMeasured);
    waitFor([&] {  // the last picture may come when the display gets to it
        frames.clear();
        return stays([&] { return frames.isEmpty(); });
    });
    w.view().setViewAxis(ViewAxis::Front);
    REQUIRE(w.view().cameraController().moving());
    waitFor([&] { return !frames.isEmpty(); });
    CHECK(frames.last().at(0).toDouble() > 0.0);
    CHECK(frames.last().at(2).toInt() == int(w.now().elements.begin()->second->mesh->body.vertices.rows()));
}
