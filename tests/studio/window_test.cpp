// SPDX-License-Identifier: GPL-3.0-or-later
#include <QAbstractButton>
#include <QAccessible>
#include <QDockWidget>
#include <QLabel>
#include <QLineEdit>
#include <QMenuBar>
#include <QSettings>
#include <QToolBar>
#include <QWheelEvent>
#include <condition_variable>
#include <map>
#include <mutex>
#include <new>
#include <numbers>
#include <stdexcept>

#include "core/commands/core_commands.h"
#include "tests/studio/window.h"
#include "ui/jobs/background_job.h"
#include "ui/models/texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/number_field.h"
#include "ui/window/command_search.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

namespace {

/// A small character: a cylinder with two faces and a bone.
void build(Window& w) {
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const std::string name = w.now().elements.begin()->second->name;
    w.run({{"do", "add-joint-face"}, {"element", name}, {"name", "tip"}, {"plane", {{"origin", {0, 0, 2}}, {"normal", {0, 0, 1}}}}});
    w.run({{"do", "add-joint-face"}, {"element", name}, {"name", "root"}, {"plane", {{"origin", {0, 0, -2}}, {"normal", {0, 0, -1}}}}});
    w.run({{"do", "add-bone"}, {"name", "spine"}, {"from", name + "/root"}, {"to", name + "/tip"}});
    w.settle();
}

}  // namespace

TEST_CASE("studio: every widget that takes the keyboard has a name for screen readers") {
    Window w;
    build(w);
    for (const SelectionItem::Kind kind : {SelectionItem::Kind::Element, SelectionItem::Kind::Face, SelectionItem::Kind::Bone, SelectionItem::Kind::Endpoint}) {
        const bool body = kind == SelectionItem::Kind::Element || kind == SelectionItem::Kind::Face;
        const PartId part = body ? w.now().elements.begin()->first : w.now().bones.begin()->first;
        w.document().select({{kind, part, kind == SelectionItem::Kind::Face ? "tip" : "", false}});
        w.settle();
        for (const QWidget* widget : w.window().findChildren<QWidget*>()) {
            if (!widget->isVisible() || !(widget->focusPolicy() & Qt::TabFocus)) continue;
            const auto* button = qobject_cast<const QAbstractButton*>(widget);
            const bool named = !widget->accessibleName().isEmpty() || (button && !button->text().isEmpty());
            CHECK_MESSAGE((named || widget->focusProxy()), std::string(widget->metaObject()->className()), " ", widget->objectName().toStdString());
        }
    }
}

TEST_CASE("studio: no two actions share a shortcut, and a changed one is kept") {
    Window w;
    std::map<QString, QByteArray> users;
    for (const auto& entry : w.window().actions().entries())
        for (const QKeySequence& keys : entry.action->shortcuts()) {
            const QString text = keys.toString(QKeySequence::PortableText);
            CHECK_MESSAGE(!users.contains(text), text.toStdString(), " ", entry.id.toStdString(), " ", users[text].toStdString());
            users[text] = entry.id;
        }
    w.window().actions().setShortcut("precompute", QKeySequence(QStringLiteral("Ctrl+9")));
    {
        CommandRegistry registry;
        addCoreCommands(registry);
        MainWindow other(registry);
        CHECK(other.actions()["precompute"]->shortcut() == QKeySequence(QStringLiteral("Ctrl+9")));
    }
    w.window().actions().resetShortcuts();
    CHECK(w.window().actions()["precompute"]->shortcut() == QKeySequence(QStringLiteral("P")));
}

TEST_CASE("studio: language and theme change at run time, everywhere and back") {
    Window w;
    build(w);
    const QString hint = w.window().status().hint();
    const auto selected = w.document().selection();
    const QColor dark = w.window().palette().color(QPalette::Window);
    Appearance::instance().setLanguage(QStringLiteral("ja"));
    w.settle();
    CHECK(w.window().menuBar()->actions().first()->text() == QStringLiteral("ファイル(&F)"));
    CHECK(w.window().actions()["precompute"]->text() == QStringLiteral("前計算(&P)"));
    CHECK(w.window().status().hint() != hint);
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    w.settle();
    w.shoot("japanese");
    w.document().select({{SelectionItem::Kind::Bone, w.now().bones.begin()->first, {}, false}});
    w.settle();
    Appearance::instance().setTheme(Appearance::Theme::Light);
    w.settle();
    CHECK(w.window().palette().color(QPalette::Window) != dark);
    w.shoot("light");
    Appearance::instance().setTheme(Appearance::Theme::HighContrast);
    w.shoot("contrast");
    Appearance::instance().setTheme(Appearance::Theme::Dark);
    Appearance::instance().setLanguage(QStringLiteral("en"));
    w.document().select(selected);
    w.settle();
    CHECK(w.window().palette().color(QPalette::Window) == dark);
    CHECK(w.window().status().hint() == hint);
    CHECK(w.window().menuBar()->actions().first()->text() == QStringLiteral("&File"));
}

TEST_CASE("studio: what opens soft has Drag in hand, wherever its file is; what has no answers yet has not") {
    Window w;
    build(w);
    const QString hard = w.folder.filePath(QStringLiteral("hard.imomushi")), soft = w.folder.filePath(QStringLiteral("soft.imomushi"));
    w.run({{"do", "save"}, {"path", hard.toStdString()}});
    w.trigger("tool-select");
    w.open(hard);
    CHECK(w.view().tools().kind() == ToolKind::Select);
    w.run({{"do", "precompute"}});
    w.run({{"do", "save"}, {"path", soft.toStdString()}});
    w.open(soft);
    CHECK(w.view().tools().kind() == ToolKind::Pose);
}

TEST_CASE("studio: at 125 % everything grows and nothing is cut off") {
    Window w;
    build(w);
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    const int before = w.window().findChild<QToolBar*>(QStringLiteral("tools"))->iconSize().width();
    // Rows of a panel take their places over a few rounds of events.
    const auto nothingIsCutOff = [&] { return cutOff(w.window()) == ""; };
    CHECK_MESSAGE(QTest::qWaitFor(nothingIsCutOff, kWaitMs), cutOff(w.window()));
    Appearance::instance().setScale(1.25);
    w.settle();
    CHECK_MESSAGE(QTest::qWaitFor(nothingIsCutOff, kWaitMs), cutOff(w.window()));
    CHECK(w.window().findChild<QToolBar*>(QStringLiteral("tools"))->iconSize().width() > before);
    w.shoot("125");
    Appearance::instance().setScale(1.0);
    w.settle();
}

TEST_CASE("work in the background that is given up: the window waits for none of it, however long it does not notice") {
    class Work : public BackgroundJob {
    public:
        using BackgroundJob::launch;
    };
    std::mutex mutex;
    std::condition_variable freed;
    bool free = false;
    int done = 0;
    Work job;
    // None of these ends before it is let go, below: a window that waited for one would wait for ever.
    for (int i = 0; i < 3; ++i) {
        job.launch([&](const Progress&) {
            std::unique_lock lock(mutex);
            freed.wait(lock, [&] { return free; });
        }, [&] { ++done; });
        job.cancel();
        CHECK(!job.running());
    }
    // What is wanted now begins when they have noticed.
    job.launch([](const Progress&) {}, [&] { done += 10; });
    CHECK(job.running());
    {
        const std::scoped_lock lock(mutex);
        free = true;
        freed.notify_all();
    }
    waitFor([&] { return !job.running(); });
    CHECK(done == 10);
}

TEST_CASE("work in the background that fails: it says so, and the studio lives") {
    class Work : public BackgroundJob {
    public:
        using BackgroundJob::BackgroundJob;
        void start(std::function<void()> work) {
            launch([work = std::move(work)](const Progress&) { work(); }, [this] { ++done; }, [this] { ++failed; });
        }
        int done = 0, failed = 0;
    };
    Window w;
    Work job;
    int ended = 0;
    QObject::connect(&job, &BackgroundJob::finished, &job, [&](bool completed) { ended += completed ? 0 : 1; });
    const auto said = [&](std::function<void()> work) {
        w.window().messages().hide();
        job.start(std::move(work));
        waitFor([&] { return !job.running(); });
        CHECK(w.window().messages().isVisible());
        return w.window().messages().text();
    };
    CHECK(said([] { throw std::bad_alloc(); }).contains(QStringLiteral("not enough memory")));
    CHECK(said([] { throw std::runtime_error("a broken promise"); }).contains(QStringLiteral("a broken promise")));
    CHECK(said([] { throw 5; }).contains(QStringLiteral("report")));
    CHECK(ended == 3);
    CHECK(job.done == 0);
    CHECK(job.failed == 3);
    job.start([] {});
    waitFor([&] { return job.done == 1; });
    CHECK(job.failed == 3);
    build(w);
    CHECK(w.now().bones.size() == 1);
}

TEST_CASE("number field: typing, dragging, taking back and resetting") {
    NumberField field({QStringLiteral("m"), -10.0, 10.0, 0.1, 3, 1.0, 2.0});
    std::vector<double> edits;
    int ended = 0, kept = 0;
    QObject::connect(&field, &NumberField::valueEdited, [&](double v) { edits.push_back(v); });
    QObject::connect(&field, &NumberField::editEnded, [&](bool keep) {
        ++ended;
        kept += keep;
    });
    field.resize(200, 30);
    field.show();
    REQUIRE(QTest::qWaitForWindowExposed(&field));
    field.setValue(1.5);
    CHECK(field.text() == QStringLiteral("1.5\u2009m"));

    QTest::mousePress(&field, Qt::LeftButton, {}, QPoint(50, 15));
    QTest::mouseMove(&field, QPoint(60, 15));
    QTest::mouseMove(&field, QPoint(70, 15));
    QTest::mouseRelease(&field, Qt::LeftButton, {}, QPoint(70, 15));
    REQUIRE(!edits.empty());
    CHECK(edits.back() == doctest::Approx(3.5));
    CHECK(ended == 1);
    CHECK(kept == 1);

    QTest::mousePress(&field, Qt::LeftButton, {}, QPoint(50, 15));
    QTest::mouseMove(&field, QPoint(90, 15));
    QTest::keyClick(&field, Qt::Key_Escape);
    CHECK(ended == 2);
    CHECK(kept == 1);  // the listener takes the drag back

    field.setValue(1.0);
    field.activateWindow();
    waitFor([&] { return field.isActiveWindow(); });
    field.setFocus();
    REQUIRE(field.hasFocus());
    field.selectAll();
    QTest::keyClicks(&field, QStringLiteral("99"));
    QTest::keyClick(&field, Qt::Key_Return);
    CHECK(edits.back() == 10.0);  // within its range
    const auto many = edits.size();
    field.selectAll();
    QTest::keyClicks(&field, QStringLiteral("abc"));
    QTest::keyClick(&field, Qt::Key_Return);
    CHECK(edits.size() == many);  // not a number: as it was
    CHECK(field.value() == 10.0);
    field.clearFocus();

    // The mouse is over the text, which is a widget of its own.
    auto* line = field.findChild<QLineEdit*>();
    QTest::mousePress(line, Qt::LeftButton, {}, QPoint(50, 10));
    QTest::mouseMove(line, QPoint(40, 10));
    QTest::mouseMove(line, QPoint(30, 10));
    CHECK(!field.hasFocus());
    QTest::mouseRelease(line, Qt::LeftButton, {}, QPoint(30, 10));
    CHECK(edits.back() == doctest::Approx(8.0));
    QTest::mouseClick(line, Qt::LeftButton, {}, QPoint(50, 10));
    CHECK(field.hasFocus());
    QTest::keyClick(&field, Qt::Key_Down, Qt::ControlModifier);
    CHECK(edits.back() == doctest::Approx(7.0));
    QTest::keyClick(&field, Qt::Key_Escape);
    CHECK(field.text() == QStringLiteral("7\u2009m"));

    QWheelEvent wheel(QPointF(50, 10), field.mapToGlobal(QPointF(50, 10)), {}, QPoint(0, 120), Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase, false);
    QApplication::sendEvent(&field, &wheel);
    CHECK(field.value() == doctest::Approx(7.0));  // it scrolls what is around

    field.setValue({});
    CHECK(field.text().isEmpty());
}

TEST_CASE("number field: screen readers hear a number with its range and step, and set it") {
    NumberField field({QStringLiteral("°"), 0.0, std::numbers::pi, 1.0, 1, 180.0 / std::numbers::pi, 0.0});
    int ended = 0;
    QObject::connect(&field, &NumberField::editEnded, [&](bool keep) { ended += keep; });
    field.setValue(0.5 * std::numbers::pi);
    auto* access = QAccessible::queryAccessibleInterface(&field);
    REQUIRE(access);
    CHECK(access->role() == QAccessible::SpinBox);
    auto* number = access->valueInterface();
    REQUIRE(number);
    CHECK(number->currentValue().toDouble() == doctest::Approx(90.0));
    CHECK(number->minimumValue().toDouble() == 0.0);
    CHECK(number->maximumValue().toDouble() == doctest::Approx(180.0));
    number->setCurrentValue(45.0);
    CHECK(*field.value() == doctest::Approx(0.25 * std::numbers::pi));
    CHECK(ended == 1);
    field.stepBy(5);
    CHECK(*field.value() == doctest::Approx(50.0 * std::numbers::pi / 180.0));
    field.setValue({});
    CHECK(!number->currentValue().isValid());
}

TEST_CASE("command search: the start of a word counts most, letters in order count least") {
    CHECK(searchScore(QStringLiteral("sav"), QStringLiteral("Save as")) > searchScore(QStringLiteral("sav"), QStringLiteral("Unsaved")));
    CHECK(searchScore(QStringLiteral("as"), QStringLiteral("Save as")) > searchScore(QStringLiteral("as"), QStringLiteral("Mask")));
    CHECK(searchScore(QStringLiteral("fs"), QStringLiteral("Frame the selection")) > 0);
    CHECK(searchScore(QStringLiteral("xyz"), QStringLiteral("Save as")) == 0);
    CHECK(searchScore({}, QStringLiteral("Save as")) > 0);
}

TEST_CASE("texts: numbers are said in units that read well") {
    CHECK(lengthText(0.0123) == QStringLiteral("1.23 cm"));
    CHECK(lengthText(0.0045) == QStringLiteral("4.5 mm"));
    CHECK(lengthText(2.5) == QStringLiteral("2.5 m"));
    CHECK(durationText(0.25) == QStringLiteral("250 ms"));
    CHECK(durationText(75.0) == QStringLiteral("1 min 15 s"));
    CHECK(errorText({"no-such-thing", "there is none"}) == QStringLiteral("There is none."));
}
