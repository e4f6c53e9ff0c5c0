// SPDX-License-Identifier: GPL-3.0-or-later
// The stage: the character alone on the screen. And how a sample was built, before the artist's eyes.
#include <QDockWidget>
#include <QMenuBar>
#include <QStatusBar>
#include <QToolBar>

#include "tests/studio/window.h"
#include "ui/models/recent_files.h"
#include "ui/window/replay_flow.h"

using namespace imomushi;

namespace {

std::vector<bool> shown(Window& w) {
    std::vector<bool> all;
    for (const QDockWidget* dock : w.window().findChildren<QDockWidget*>()) all.push_back(dock->isVisible());
    for (const QToolBar* bar : w.window().findChildren<QToolBar*>()) all.push_back(bar->isVisible());
    all.push_back(w.window().menuBar()->isVisible());
    all.push_back(w.window().statusBar()->isVisible());
    return all;
}

}  // namespace

TEST_CASE("stage: one key shows the character alone on the whole screen, drags go on there, and Esc brings everything back as it was") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    w.trigger("tool-pose");
    w.window().findChild<QDockWidget*>(QStringLiteral("takesDock"))->hide();
    w.settle();
    const EndpointRef end{w.now().boneNamed("head-bone")->id, true};
    w.document().select({{SelectionItem::Kind::Endpoint, end.bone, {}, true}});
    const std::vector<bool> before = shown(w);
    const QRect geometry = w.window().geometry();
    const auto selection = w.document().selection();
    QTest::keyClick(&w.view(), Qt::Key_F11, Qt::ControlModifier);
    const QSize screen = w.window().screen()->size();
    waitFor([&] { return w.view().size() == screen; });
    w.settle();
    for (const bool one : shown(w)) CHECK(!one);
    CHECK(w.window().actions()["stage"]->isChecked());
    // Words lie behind the view.
    w.window().messages().say(QStringLiteral("not on the stage"), MessageBar::Tone::Info);
    w.settle();
    const QWidget* over = w.window().centralWidget()->childAt(w.window().messages().geometry().center());
    CHECK(!w.window().messages().isAncestorOf(over));
    w.shoot("stage");
    // The pointer finds the end of the bone that is not drawn, and a drag is a step as ever.
    const int steps = w.document().session().position();
    const QPoint at = w.view().onScreen(end)->toPoint();
    QTest::mouseMove(&w.view(), at);
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, at);
    // No event of the display in between: its own pointer has no button down.
    QTest::mouseMove(&w.view(), at + QPoint(0, -30));
    QTest::mouseMove(&w.view(), at + QPoint(0, -60));
    INFO(at.x() << ' ' << at.y() << " of " << w.view().width() << ", focus " << w.view().hasFocus() << ", held " << w.now().goals.contains(end));
    REQUIRE(w.view().tools().busy());
    QTest::keyClick(&w.view(), Qt::Key_Escape);  // the drag first
    CHECK(!w.view().tools().busy());
    CHECK(w.window().actions()["stage"]->isChecked());
    CHECK(w.document().session().position() == steps);
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, at);
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, at);
    QTest::mouseMove(&w.view(), at + QPoint(0, -60));
    w.settle();
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, at + QPoint(0, -60));
    CHECK(w.document().session().position() == steps + 1);
    // What would bring a panel to the front does not.
    w.trigger("record");
    CHECK(w.window().deck().recording());
    w.settle();
    for (const bool one : shown(w)) CHECK(!one);
    w.trigger("record");
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    waitFor([&] { return w.window().geometry() == geometry; });
    w.settle();
    CHECK(shown(w) == before);
    CHECK(!w.window().actions()["stage"]->isChecked());
    CHECK(w.document().selection() == selection);
}

TEST_CASE("stage: the picture has no marks, and the same key ends it") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    w.trigger("tool-select");
    for (const char* off : {"bones", "grid"}) w.trigger(off);
    w.document().select({});
    w.trigger("stage");
    waitFor([&] { return w.view().size() == w.window().screen()->size(); });
    w.settle();
    const QImage plain = w.view().grabFramebuffer();
    for (const char* on : {"bones", "grid", "xray"}) w.window().actions()[on]->trigger();
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    w.settle();
    CHECK(w.view().grabFramebuffer() == plain);
    QTest::keyClick(&w.view(), Qt::Key_F11, Qt::ControlModifier);
    waitFor([&] { return w.window().menuBar()->isVisible() && w.view().size() != plain.size(); });
    w.settle();
    CHECK(w.view().grabFramebuffer().size() != plain.size());
    CHECK(w.window().menuBar()->isVisible());
}

TEST_CASE("replay: a sample is built step by step in a project of its own, waits while it is paused, and is as open as any other") {
    Window w;
    QString script;
    for (const Sample& sample : samples())
        if (sample.name == QLatin1String("caterpillar")) script = sample.script;
    REQUIRE(!script.isEmpty());
    ReplayFlow& replay = w.window().replay();
    replay.setPace(0);
    auto* button = w.window().findChild<QToolButton*>(QStringLiteral("replay"));
    REQUIRE(button);
    CHECK(button->accessibleName() == QStringLiteral("Watch how “Caterpillar” was built"));
    QTest::mouseClick(button, Qt::LeftButton);
    waitFor([&] { return replay.running() && replay.done() >= 7; });
    auto* pause = w.window().findChild<QPushButton*>(QStringLiteral("replayPause"));
    REQUIRE(pause->isVisible());
    CHECK(!w.window().startShown());
    QTest::mouseClick(pause, Qt::LeftButton);
    waitFor([&] { return !w.window().steps().running(); });
    const int at = replay.done();
    CHECK(stays([&] { return replay.done() == at; }));
    CHECK(w.document().session().position() == at);
    CHECK(w.now().elements.size() == 5);
    CHECK(pause->text() == QStringLiteral("Go on"));
    w.shoot("replay");
    CHECK(cutOff(*pause->parentWidget()) == "");
    QTest::mouseClick(pause, Qt::LeftButton);
    waitFor([&] { return !replay.running(); });
    w.window().precompute().cancel();
    CHECK(replay.done() == replay.count());
    CHECK(w.document().session().position() == replay.count());
    CHECK(w.now().bones.size() == 5);
    CHECK(w.now().joints.size() == 4);
    CHECK(w.document().session().path().empty());
    CHECK(!pause->isVisible());
    w.trigger("undo");
    CHECK(w.document().session().position() == replay.count() - 1);
    replay.setPace(-1);
}

TEST_CASE("replay: Stop leaves what is built so far, and so does a project that is opened meanwhile") {
    Window w;
    ReplayFlow& replay = w.window().replay();
    replay.setPace(0);
    const QString script = QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar/make.jsonl");
    REQUIRE(replay.start(QStringLiteral("Caterpillar"), script));
    waitFor([&] { return replay.done() >= 2; });
    QTest::mouseClick(w.window().findChild<QPushButton*>(QStringLiteral("replayStop")), Qt::LeftButton);
    CHECK(!replay.running());
    waitFor([&] { return !w.window().steps().running(); });
    const int position = w.document().session().position();
    CHECK(position >= 2);
    CHECK(stays([&] { return w.document().session().position() == position; }));
    w.run({{"do", "new"}});
    REQUIRE(replay.start(QStringLiteral("Caterpillar"), script));
    waitFor([&] { return replay.done() >= 1; });
    w.run({{"do", "save"}, {"path", w.folder.filePath(QStringLiteral("so far.imomushi")).toStdString()}});
    replay.setPaused(true);
    waitFor([&] { return !w.window().steps().running(); });
    w.run({{"do", "save"}, {"path", w.folder.filePath(QStringLiteral("so far.imomushi")).toStdString()}});
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/dragon.imomushi"));
    CHECK(!replay.running());
    CHECK(w.now().characters.size() == 1);
    replay.setPace(-1);
}
