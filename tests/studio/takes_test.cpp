// SPDX-License-Identifier: GPL-3.0-or-later
#include <QDockWidget>
#include <QLineEdit>
#include <QListView>
#include <QSettings>
#include <QSignalSpy>
#include <QToolButton>

#include "tests/studio/window.h"
#include "tests/support/plain_sample.h"
#include "ui/models/recent_files.h"
#include "ui/models/texts.h"
#include "ui/panels/takes_panel.h"
#include "ui/panels/time_bar.h"
#include "ui/picking/picking.h"
#include "ui/widgets/appearance.h"

using namespace imomushi;

namespace {

constexpr double kPixel = 0.005;  ///< m: about one pixel of the view, where the caterpillar is 2.5 m long

/// The caterpillar in the drag tool, and the panel of takes.
struct TakeWindow : Window {
    TakeWindow() : Window({1280, 800}) {  // every frame is drawn without a graphics card: half the pixels, half the time
        open(samples()[0].path);
        for (const Json& line : plainLines(samples()[0].name.toStdString())) run(line);
        trigger("tool-pose");
        view().setFocus();
        settle();
    }

    EndpointRef lastEnd() { return {now().bones.rbegin()->first, true}; }
    TakeDeck& deck() { return window().deck(); }
    QListView& list() { return *window().takes().list(); }
    TimeBar& bar() { return *window().takes().bar(); }
    int position() { return document().session().position(); }
    QPointF end() { return *view().onScreen(lastEnd()); }
    /// In the world: the view gets smaller where takes need room.
    Vec3 place() { return *endpointPosition(document().session(), lastEnd()); }
    void drag(QPoint by) {
        const QPoint from = end().toPoint();
        QTest::mouseMove(&view(), from);
        settle();
        QTest::mousePress(&view(), Qt::LeftButton, {}, from);
        for (int i = 1; i <= 6; ++i) {
            // While something is recorded, each step of the pointer is seen by a frame.
            const auto frames = [&] { return deck().recording() ? document().session().recording()->frames : 0; };
            const auto before = frames();
            QTest::mouseMove(&view(), from + by * i / 6);
            settle();
            if (deck().recording()) waitFor([&] { return frames() > before; });
        }
        QTest::mouseRelease(&view(), Qt::LeftButton, {}, from + by);
        settle();
    }
    /// By the keyboard, as a performer does.
    void record(QPoint by) {
        QTest::keyClick(&view(), Qt::Key_R, Qt::ControlModifier);
        REQUIRE(deck().recording());
        drag(by);
        QTest::keyClick(&view(), Qt::Key_R, Qt::ControlModifier);
        REQUIRE(!deck().recording());
        settle();
    }
    QPoint at(double time) { return QPoint(int(std::lround(bar().xOf(time))), bar().height() - 23); }
    /// On the mark below the bar, which hangs outside of what it holds.
    QPoint mark(double time, int out) { return QPoint(int(std::lround(bar().xOf(time))) + 5 * out, bar().height() - 8); }
    const Take& take() { return *deck().take(); }
    void dragBar(QPoint from, QPoint to) {
        QTest::mousePress(&bar(), Qt::LeftButton, {}, from);
        QTest::mouseMove(&bar(), to);
        QTest::mouseRelease(&bar(), Qt::LeftButton, {}, to);
        settle();
    }
};

}  // namespace

TEST_CASE("takes: what is dragged while it is recorded becomes a take, as one step; undo takes it away") {
    TakeWindow w;
    w.shoot("takes-none");
    const int before = w.position();
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    REQUIRE(w.deck().recording());
    w.drag({20, -90});
    waitFor([&] { return w.document().session().recording()->seconds > 0.2; });
    const auto frames = w.document().session().recording()->frames;
    const double seconds = w.document().session().recording()->seconds;
    CHECK(frames >= 6);  // one for each step of the drag
    w.shoot("takes-recording");
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    waitFor([&] { return !w.deck().recording(); });
    REQUIRE(w.now().takes.size() == 1);
    const Take& take = *w.now().takes.begin()->second;
    CHECK(take.times.size() >= std::size_t(frames));
    CHECK(take.duration() >= doctest::Approx(seconds));
    CHECK(w.position() == before + 2);  // the drag, and the take
    const auto& step = w.document().session().steps().back();
    CHECK(stepText(step.name, step.subject) == QStringLiteral("Record: Take 1"));
    CHECK(w.list().model()->rowCount() == 1);
    w.shoot("takes-one");
    w.trigger("undo");
    CHECK(w.now().takes.empty());
    CHECK(w.list().model()->rowCount() == 0);
    CHECK(!w.deck().take());
    CHECK(!w.window().actions()["play"]->isEnabled());
    w.trigger("redo");
    CHECK(w.now().takes.size() == 1);
}

TEST_CASE("takes: frames are recorded though nothing moves, at the pace of the clock") {
    TakeWindow w;
    auto* button = w.window().takes().findChild<QPushButton*>(QStringLiteral("recordButton"));
    QTest::mouseClick(button, Qt::LeftButton);
    REQUIRE(w.deck().recording());
    waitFor([&] { return w.document().session().recording()->seconds > 0.4; });
    QTest::mouseClick(button, Qt::LeftButton);
    REQUIRE(w.now().takes.size() == 1);
    CHECK(w.now().takes.begin()->second->times.size() > 2);
}

TEST_CASE("takes: the time bar shows any moment, keys go frame by frame, and a drag leaves the take") {
    TakeWindow w;
    const Vec3 rest = w.place();
    w.record({20, -100});
    const Vec3 posed = w.place();
    const Take& take = *w.deck().take();
    REQUIRE((posed - rest).norm() > 0.15);

    QTest::mousePress(&w.bar(), Qt::LeftButton, {}, w.at(0.0));
    w.settle();
    CHECK(w.deck().shown());
    CHECK(w.deck().exact());
    CHECK((w.place() - rest).norm() < kPixel);
    QTest::mouseMove(&w.bar(), w.at(0.5 * take.duration()));
    QTest::mouseRelease(&w.bar(), Qt::LeftButton, {}, w.at(0.5 * take.duration()));
    w.settle();
    CHECK(w.deck().frame() > 0);
    CHECK(w.deck().frame() < int(take.times.size()) - 1);
    w.shoot("takes-scrub");
    QTest::keyClick(&w.bar(), Qt::Key_Home);
    CHECK(w.deck().frame() == 0);
    QTest::keyClick(&w.bar(), Qt::Key_Right);
    CHECK(w.deck().frame() == 1);
    w.trigger("take-forward");
    CHECK(w.deck().frame() == 2);
    w.trigger("take-back");
    CHECK(w.deck().frame() == 1);
    QTest::keyClick(&w.bar(), Qt::Key_End);
    CHECK(w.deck().frame() == int(take.times.size()) - 1);
    CHECK((w.place() - posed).norm() < kPixel);

    // What is held and posed is untouched by looking at takes.
    QTest::keyClick(&w.bar(), Qt::Key_Home);
    w.trigger("leave-take");
    CHECK(!w.deck().shown());
    CHECK((w.place() - posed).norm() < kPixel);

    QTest::keyClick(&w.bar(), Qt::Key_Home);
    REQUIRE(w.deck().shown());
    w.drag({0, -60});
    CHECK(!w.deck().shown());
    CHECK(!w.document().session().showsTake());
}

TEST_CASE("takes: the space bar plays to the end and pauses, and loops where that is on") {
    TakeWindow w;
    w.record({10, -80});
    const double length = w.deck().take()->duration();
    QTest::keyClick(&w.view(), Qt::Key_Space);
    REQUIRE(w.deck().playing());
    QSignalSpy told(&w.deck(), &TakeDeck::changed);
    waitFor([&] { return !w.deck().playing(); });
    CHECK(told.count() > 3);
    CHECK(w.deck().time() == doctest::Approx(length));
    CHECK(w.deck().shown());

    w.trigger("loop");
    CHECK(w.deck().looping());
    QTest::keyClick(&w.view(), Qt::Key_Space);
    bool turned = false;
    double last = 0.0;
    const auto watch = QObject::connect(&w.deck(), &TakeDeck::changed, [&] {
        turned = turned || w.deck().time() < last;
        last = w.deck().time();
    });
    waitFor([&] { return turned && w.deck().playing(); });
    QObject::disconnect(watch);
    w.shoot("takes-playing");
    QTest::keyClick(&w.view(), Qt::Key_Space);
    CHECK(!w.deck().playing());
    const double paused = w.deck().time();
    CHECK(stays([&] { return w.deck().time() == paused; }));
    // A drag in mid-play goes on live.
    QTest::keyClick(&w.view(), Qt::Key_Space);
    REQUIRE(w.deck().playing());
    w.drag({0, -50});
    CHECK(!w.deck().playing());
    CHECK(!w.deck().shown());
}

TEST_CASE("takes: they are renamed in place and removed by the keyboard, each as one step") {
    TakeWindow w;
    w.record({10, -60});
    w.record({-10, 40});
    REQUIRE(w.now().takes.size() == 2);
    const int before = w.position();
    w.list().setFocus();
    w.list().setCurrentIndex(w.list().model()->index(0, 0));
    w.settle();
    CHECK(w.deck().take()->name == "Take 1");
    CHECK(w.deck().shown());
    QTest::keyClick(&w.list(), Qt::Key_F2);
    auto* editor = w.list().findChild<QLineEdit*>();
    REQUIRE(editor);
    editor->selectAll();
    QTest::keyClicks(editor, QStringLiteral("wave"));
    QTest::keyClick(editor, Qt::Key_Return);
    w.settle();
    CHECK(w.now().takeNamed("wave"));
    CHECK(w.position() == before + 1);
    w.shoot("takes-two");

    // Del is for the take, whatever is selected in the view.
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    const std::size_t elements = w.now().elements.size();
    w.settle();
    w.list().setFocus();
    QTest::keyClick(&w.list(), Qt::Key_Delete);
    w.settle();
    CHECK(!w.now().takeNamed("wave"));
    CHECK(w.now().elements.size() == elements);
    CHECK(w.position() == before + 2);
    w.trigger("undo");
    CHECK(w.now().takeNamed("wave"));
    w.trigger("undo");
    CHECK(w.now().takeNamed("Take 1"));
}

TEST_CASE("takes: marks hold a part, by mouse or keys; it is played alone, and trimming keeps it as one step") {
    TakeWindow w;
    w.record({20, -100});
    const double length = w.take().duration();
    const std::size_t frames = w.take().times.size();
    REQUIRE(frames > 8);
    CHECK(!w.deck().marked());
    CHECK(!w.window().actions()["trim-take"]->isEnabled());
    w.dragBar(w.mark(0.0, -1), w.at(0.25 * length));
    CHECK(w.deck().from() == doctest::Approx(0.25 * length).epsilon(0.2));
    CHECK(w.deck().to() == length);
    CHECK(!w.deck().playing());
    w.dragBar(w.mark(length, 1), w.at(0.75 * length));
    CHECK(w.deck().to() == doctest::Approx(0.75 * length).epsilon(0.1));
    w.shoot("takes-marked");

    // Played from the one to the other.
    w.dragBar(w.at(0.0), w.at(0.0));
    const double from = w.deck().from(), to = w.deck().to();
    QTest::keyClick(&w.view(), Qt::Key_Space);
    REQUIRE(w.deck().playing());
    CHECK(w.deck().time() == from);
    waitFor([&] { return !w.deck().playing(); });
    CHECK(w.deck().time() == to);

    // The keys mark where the playhead is; marks do not cross.
    w.dragBar(w.at(0.5 * length), w.at(0.5 * length));
    const double middle = w.take().times[std::size_t(w.deck().frame())];
    QTest::keyClick(&w.view(), Qt::Key_I);
    CHECK(w.deck().from() == middle);
    w.dragBar(w.mark(middle, -1), w.at(length));
    CHECK(w.deck().from() < w.deck().to());
    CHECK(w.deck().to() == to);
    w.trigger("mark-none");
    CHECK(!w.deck().marked());
    w.dragBar(w.at(0.25 * length), w.at(0.25 * length));
    QTest::keyClick(&w.view(), Qt::Key_I);
    w.dragBar(w.at(0.75 * length), w.at(0.75 * length));
    QTest::keyClick(&w.view(), Qt::Key_O);
    const double kept = w.deck().to() - w.deck().from();
    const QPointF seen = w.end();

    const int before = w.position();
    w.trigger("trim-take");
    CHECK(w.position() == before + 1);
    CHECK(w.take().times.size() < frames);
    CHECK(w.take().duration() == doctest::Approx(kept));
    CHECK(!w.deck().marked());
    CHECK(w.deck().shown());
    CHECK((w.end() - seen).manhattanLength() < 1.0);  // the moment that was seen is still seen
    CHECK(w.bar().maximum() == int(w.take().times.size()) - 1);
    w.shoot("takes-trimmed");
    w.trigger("undo");
    CHECK(w.take().times.size() == frames);
    CHECK(w.bar().maximum() == int(frames) - 1);
    CHECK(!w.deck().marked());
}

TEST_CASE("takes: buttons beside the list copy, rename and remove the take that is chosen") {
    TakeWindow w;
    w.record({10, -60});
    const auto button = [&](const char* action) -> QAbstractButton* {
        for (auto* b : w.window().takes().findChildren<QToolButton*>())
            if (b->defaultAction() == w.window().actions()[action]) return b;
        return nullptr;
    };
    for (const char* action : {"rename-take", "duplicate-take", "remove-take", "trim-take", "mark-in", "mark-out", "count-in"}) {
        CAPTURE(action);
        REQUIRE(button(action));
        CHECK(button(action)->isVisible());
    }
    const double length = w.take().duration();
    QTest::mouseClick(button("duplicate-take"), Qt::LeftButton);
    w.settle();
    REQUIRE(w.now().takes.size() == 2);
    CHECK(w.take().name == "Take 1 copy");
    CHECK(w.take().duration() == length);
    CHECK(w.list().currentIndex().row() == 1);
    QTest::mouseClick(button("rename-take"), Qt::LeftButton);
    auto* editor = w.list().findChild<QLineEdit*>();
    REQUIRE(editor);
    editor->selectAll();
    QTest::keyClicks(editor, QStringLiteral("nod"));
    QTest::keyClick(editor, Qt::Key_Return);
    w.settle();
    CHECK(w.take().name == "nod");
    QTest::mouseClick(button("remove-take"), Qt::LeftButton);
    w.settle();
    CHECK(w.now().takes.size() == 1);
    CHECK(!w.now().takeNamed("nod"));
}

TEST_CASE("takes: a recording starts after a count where that is wished for, and the same key gives it up") {
    TakeWindow w;
    QSettings().remove(QStringLiteral("takes"));
    w.trigger("count-in");
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    CHECK(!w.deck().recording());
    CHECK(w.deck().counting() == 3);
    w.shoot("takes-counting");
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    CHECK(w.deck().counting() == 0);
    CHECK(stays([&] { return !w.deck().recording() && w.deck().counting() == 0; }));
    CHECK(w.now().takes.empty());
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    waitFor([&] { return w.deck().recording(); });
    w.drag({10, -40});
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    CHECK(w.now().takes.size() == 1);
    w.trigger("count-in");
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    CHECK(w.deck().recording());
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
}

TEST_CASE("takes: a recording ends with its take when the document is left, and says when it ends early") {
    TakeWindow w;
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    w.settle();
    REQUIRE(w.deck().recording());
    w.run({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "paper"}});
    waitFor([&] { return !w.deck().recording(); });
    CHECK(w.now().takes.size() == 1);
    CHECK(w.window().messages().text().contains(QStringLiteral("ended early")));
    w.trigger("undo");  // the take
    w.trigger("undo");  // the basis
    REQUIRE(w.now().takes.empty());
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    w.settle();
    Q_EMIT w.window().files().leaving();
    CHECK(!w.deck().recording());
    CHECK(w.now().takes.size() == 1);
}

TEST_CASE("takes: the panel reads in every theme, in Japanese and at 125 %") {
    TakeWindow w;
    w.record({20, -90});
    w.record({-10, 60});
    QTest::mouseClick(&w.bar(), Qt::LeftButton, {}, w.at(0.3));
    auto& look = Appearance::instance();
    look.setTheme(Appearance::Theme::Light);
    w.settle();
    CHECK(pale(w.window().takes()) == "");
    w.shoot("takes-light");
    look.setLanguage(QStringLiteral("ja"));
    w.settle();
    CHECK(pale(w.window().takes()) == "");
    w.shoot("takes-japanese");
    CHECK(w.list().accessibleName() == QStringLiteral("テイク"));
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    w.settle();
    w.shoot("takes-recording-light");
    QTest::keyClick(&w.view(), Qt::Key_R, Qt::ControlModifier);
    look.setTheme(Appearance::Theme::HighContrast);
    w.settle();
    CHECK(pale(w.window().takes()) == "");
    w.shoot("takes-contrast");
    look.setTheme(Appearance::Theme::Dark);
    look.setLanguage(QStringLiteral("en"));
    look.setScale(1.25);
    w.settle();
    CHECK(pale(w.window().takes()) == "");
    w.shoot("takes-125");
    look.setScale(1.0);
    w.settle();
}
