// SPDX-License-Identifier: GPL-3.0-or-later
// Kept poses, by keys and in their panel.
#include <QListWidget>
#include <QSlider>
#include <QStyleOptionSlider>
#include <QTreeWidget>

#include "core/document/cycle.h"
#include "core/document/kept_pose.h"
#include "tests/studio/window.h"
#include "ui/panels/cycles_panel.h"
#include "ui/panels/poses_panel.h"

using namespace imomushi;

namespace {

struct Posed : Window {
    Posed() {
        open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
        window().showStart(false);
        if (now().effects.has(EffectKind::BoneDynamics)) run({{"do", "disable"}, {"effect", "bone-dynamics"}});
        drag({1.1, 0.8, 0.3});
        settle();
        view().setFocus();
    }
    void drag(const Vec3& to) { run({{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {to.x(), to.y(), to.z()}}}); }
    Vec3 head() { return *document().session().positionOf({now().boneNamed("head-bone")->id, true}); }
    PosesPanel& panel() { return *window().findChild<PosesPanel*>(); }
    int steps() { return document().session().position(); }
};

}  // namespace

TEST_CASE("poses: Shift+K keeps the pose, Alt and its number bring it back, each in one step") {
    Posed w;
    const Vec3 up = w.head();
    const int before = w.steps();
    QTest::keyClick(&w.view(), Qt::Key_K, Qt::ShiftModifier);
    w.settle();
    CHECK(w.steps() == before + 1);
    REQUIRE(w.panel().list()->count() == 1);
    CHECK(w.panel().list()->item(0)->text() == QStringLiteral("pose 1"));
    CHECK(!w.panel().visibleRegion().isEmpty());
    // The menu says its name.
    CHECK(w.window().actions()["pose-1"]->text() == QStringLiteral("&1  pose 1"));
    CHECK(w.window().actions()["pose-2"]->text() == QStringLiteral("Pose &2"));
    w.shoot("poses");
    w.drag({1.0, 0.3, -0.4});
    w.settle();
    CHECK((w.head() - up).norm() > 0.1);
    w.view().setFocus();
    QTest::keyClick(&w.view(), Qt::Key_1, Qt::AltModifier);
    w.settle();
    CHECK((w.head() - up).norm() < 1e-3);
    CHECK(w.steps() == before + 3);
    w.trigger("undo");
    CHECK((w.head() - up).norm() > 0.1);
    // A pose that is not kept yet says so.
    CHECK(!w.window().actions()["pose-2"]->isEnabled());
    CHECK(!whyDisabled(*w.window().actions()["pose-2"]).isEmpty());
}

TEST_CASE("poses: the slider leads a part of the way while it is dragged, in one step, and stands at nothing again") {
    Posed w;
    const Vec3 up = w.head();
    w.trigger("keep-pose");
    w.run({{"do", "rest"}});
    const Vec3 rest = w.head();
    w.settle();
    w.panel().list()->setCurrentRow(0);
    const int before = w.steps();
    QSlider& blend = *w.panel().blend();
    CHECK(blend.isEnabled());
    blend.setSliderDown(true);
    blend.setValue(80);
    CHECK(w.document().inGesture());
    blend.setValue(50);
    CHECK((w.head() - 0.5 * (rest + up)).norm() < 0.1 * (up - rest).norm());
    blend.setSliderDown(false);
    CHECK(!w.document().inGesture());
    CHECK(blend.value() == 0);
    CHECK(w.steps() == before + 1);
    w.trigger("undo");
    CHECK((w.head() - rest).norm() < 1e-3);
}

TEST_CASE("poses: a pose is renamed in the list, removed by Delete, and the mirror and rest of bones are commands of the menu") {
    Posed w;
    w.trigger("keep-pose");
    w.settle();
    w.panel().list()->item(0)->setText(QStringLiteral("見上げる"));
    w.settle();
    CHECK(keptPoses(w.now()).front().name == "見上げる");
    w.panel().list()->setCurrentRow(0);
    w.panel().list()->setFocus();
    QTest::keyClick(w.panel().list(), Qt::Key_Delete);
    w.settle();
    CHECK(keptPoses(w.now()).empty());
    CHECK(w.now().elements.size() > 1);  // nothing else was removed
    w.trigger("undo");
    CHECK(w.panel().list()->count() == 1);
    w.document().select({{SelectionItem::Kind::Bone, w.now().boneNamed("middle-bone")->id, {}, false}});
    w.settle();
    const int before = w.steps();
    w.trigger("rest-chain");
    w.trigger("mirror-pose");
    CHECK(w.steps() == before + 2);
}

TEST_CASE("poses: each kept pose has a picture of its own beside the window, which changes nothing and comes back under another name") {
    Posed w;
    w.trigger("keep-pose");
    w.run({{"do", "rest"}});
    w.trigger("keep-pose");
    w.settle();
    const Vec3 head = w.head();
    const int before = w.steps();
    const auto picture = [&](const char* name) { return w.panel().picture(QString::fromLatin1(name)); };
    waitFor([&] { return !picture("pose 1").isNull() && !picture("pose 2").isNull(); });
    CHECK(picture("pose 1") != picture("pose 2"));
    const QImage first = picture("pose 1");
    const auto covered = [](const QImage& image) {
        int count = 0;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x) count += qAlpha(image.pixel(x, y)) > 128;
        return double(count) / (image.width() * image.height());
    };
    CHECK(covered(first) > 0.05);  // the character, and around it nothing
    CHECK(covered(first) < 0.9);
    CHECK(w.steps() == before);
    CHECK((w.head() - head).norm() == 0.0);
    w.shoot("pose-pictures");
    w.run({{"do", "rename-pose"}, {"pose", "pose 1"}, {"name", "up"}});
    waitFor([&] { return !picture("up").isNull(); });
    CHECK(picture("up").cacheKey() == first.cacheKey());  // not drawn again
    CHECK(picture("pose 1").isNull());
}

namespace {

struct Cycling : Posed {
    Cycling() {
        run({{"do", "rest"}});
        trigger("keep-pose");
        settle();
        waitFor([&] { return panel().isVisible(); });
    }
    CyclesPanel& cycles() { return *panel().cycles(); }
    template <class Widget>
    Widget& part(const char* name) {
        auto* found = panel().findChild<Widget*>(QLatin1String(name));
        REQUIRE_MESSAGE(found, name);
        return *found;
    }
    void press(const char* button) {
        auto& b = part<QAbstractButton>(button);
        REQUIRE(b.isVisible());
        REQUIRE(b.isEnabled());
        QTest::mouseClick(&b, Qt::LeftButton);
        settle();
    }
    /// By the mouse, from where its handle is to the end of the slider and beyond.
    static void dragToEnd(QSlider& slider, bool high) {
        QStyleOptionSlider option;
        option.initFrom(&slider);
        option.orientation = Qt::Horizontal;
        option.minimum = slider.minimum(), option.maximum = slider.maximum();
        option.sliderPosition = option.sliderValue = slider.value();
        option.subControls = QStyle::SC_All;
        const QPoint from = slider.style()->subControlRect(QStyle::CC_Slider, &option, QStyle::SC_SliderHandle, &slider).center();
        const int way = (high ? 2 : -2) * slider.width();
        QTest::mousePress(&slider, Qt::LeftButton, {}, from);
        for (int i = 1; i <= 4; ++i) QTest::mouseMove(&slider, from + QPoint(i * way / 4, 0));
        QTest::mouseRelease(&slider, Qt::LeftButton, {}, from + QPoint(way, 0));
        CHECK(slider.value() == (high ? slider.maximum() : slider.minimum()));
    }
};

}  // namespace

TEST_CASE("cycles: suggested by one click, the amount fader makes the character crawl, a take records it, and at nothing it rests where it was") {
    Cycling w;
    const Vec3 rest = w.head();
    const std::size_t held = w.now().goals.size();  // pins
    CHECK(!w.cycles().amount()->isEnabled());
    w.press("suggest-cycles");
    REQUIRE(w.cycles().list()->topLevelItemCount() == 3);
    CHECK(w.cycles().chosen() == QStringLiteral("crawl"));
    CHECK(!w.window().inputs().listens());

    w.trigger("record");
    waitFor([&] { return w.window().deck().recording(); });
    w.dragToEnd(*w.cycles().amount(), true);
    const double high = rest.y() + 0.02;
    waitFor([&] { return w.head().y() > high; });
    waitFor([&] { return w.head().y() < high; });
    waitFor([&] { return w.head().y() > high; });  // it goes on by itself
    w.shoot("cycles");
    w.trigger("record");
    waitFor([&] { return !w.now().takes.empty(); });
    const Take& take = *w.now().takes.begin()->second;
    const int head = [&] {
        const PartId id = w.now().boneNamed("head-bone")->id;
        for (const Take::Bone& bone : take.bones)
            if (bone.bone == id) return bone.end;
        return -1;
    }();
    REQUIRE(head >= 0);
    double lowest = 1e9, highest = -1e9;
    std::vector<double> row(take.poses.width());
    for (std::size_t f = 0; f < take.times.size(); ++f) {
        take.poses.at(f, row.data());
        lowest = std::min(lowest, row[std::size_t(3 * head + 1)]);
        highest = std::max(highest, row[std::size_t(3 * head + 1)]);
    }
    CHECK(highest - lowest > 0.05);

    // The feed was made anew for the take, and the crawl goes on.
    waitFor([&] { return w.head().y() < high; });
    waitFor([&] { return w.head().y() > high; });
    w.dragToEnd(*w.cycles().amount(), false);
    waitFor([&] { return (w.head() - rest).norm() < 1e-4; });
    // It comes to a standstill: no step is made any more.
    waitFor([&] {
        const Vec3 still = w.head();
        return stays([&] { return w.head() == still; });
    });
    CHECK((w.head() - rest).norm() < 1e-4);
    // And holds nothing any more, which is undone with the take.
    waitFor([&] { return w.now().goals.size() == held; });
    CHECK(w.document().session().steps().back().name == "record");
    w.trigger("undo");
    CHECK(w.now().takes.empty());
    CHECK(w.now().goals.size() > held);
    // What undo holds again stays so, and the take can be had again, until all inputs are stopped.
    CHECK(stays([&] { return w.now().goals.size() > held; }));
    w.trigger("redo");
    CHECK(w.now().takes.size() == 1);
    CHECK(w.now().goals.size() == held);
    w.trigger("undo");
    w.trigger("let-go");
    waitFor([&] { return w.now().goals.size() == held; });
}

TEST_CASE("cycles: speed runs it backwards and stops it, and letting everything go lets the faders go") {
    Cycling w;
    w.press("suggest-cycles");
    const Vec3 rest = w.head();
    const std::size_t held = w.now().goals.size();  // pins
    w.cycles().amount()->setValue(100);
    waitFor([&] { return (w.head() - rest).norm() > 0.02; });
    w.cycles().speed()->setValue(0);
    waitFor([&] {
        const Vec3 before = w.head();
        QTest::qWait(5 * kFrameMs);
        return (w.head() - before).norm() < 1e-6;
    });
    CHECK((w.head() - rest).norm() > 1e-4);
    w.cycles().speed()->setValue(-200);
    const Vec3 stood = w.head();
    waitFor([&] { return (w.head() - stood).norm() > 0.02; });
    w.trigger("let-go");
    CHECK(w.cycles().amount()->value() == 0);
    CHECK(w.cycles().speed()->value() == 100);
    waitFor([&] { return (w.head() - rest).norm() < 1e-4; });
    waitFor([&] { return w.now().goals.size() == held; });
    // Drawn up again, it goes on.
    w.cycles().amount()->setValue(60);
    waitFor([&] { return (w.head() - rest).norm() > 0.02; });
}

TEST_CASE("cycles: one is made of the chosen poses, renamed and timed in place, and removed; a row of the table wins over the fader") {
    Cycling w;
    w.drag({1.1, 0.8, 0.3});
    w.trigger("keep-pose");
    w.settle();
    CHECK(!w.part<QToolButton>("new-cycle").isEnabled());
    w.panel().list()->selectAll();
    w.press("new-cycle");
    REQUIRE(cyclesOf(w.now()).size() == 1);
    CHECK(cyclesOf(w.now()).front().poses == std::vector<std::string>{"pose 1", "pose 2"});
    QTreeWidgetItem* item = w.cycles().list()->topLevelItem(0);
    item->setText(0, QStringLiteral("うなずく"));
    w.settle();
    CHECK(cyclesOf(w.now()).front().name == "うなずく");
    w.cycles().list()->topLevelItem(0)->setText(1, QStringLiteral("0.8 s"));
    w.settle();
    CHECK(cyclesOf(w.now()).front().seconds == 0.8);
    w.cycles().list()->topLevelItem(0)->setText(1, QStringLiteral("soon"));
    w.settle();
    CHECK(cyclesOf(w.now()).front().seconds == 0.8);
    CHECK(w.cycles().list()->topLevelItem(0)->text(1) == QStringLiteral("0.8 s"));
    // A pose that it goes through stays, and the window says why.
    w.panel().list()->setCurrentRow(0);
    w.panel().list()->setFocus();
    QTest::keyClick(w.panel().list(), Qt::Key_Delete);
    w.settle();
    CHECK(keptPoses(w.now()).size() == 2);
    w.press("remove-cycle");
    CHECK(cyclesOf(w.now()).empty());
    CHECK(keptPoses(w.now()).size() == 2);  // they were the artist's own
    w.press("suggest-cycles");
    w.press("remove-cycle");
    CHECK(keptPose(w.now(), "crawl 1") == nullptr);  // these were made with it
}

TEST_CASE("cycles: undo takes back a cycle that runs, and one of that name that comes later is at rest") {
    Cycling w;
    const Vec3 rest = w.head();
    w.press("suggest-cycles");
    w.cycles().amount()->setValue(80);
    waitFor([&] { return (w.head() - rest).norm() > 0.02; });
    w.trigger("undo");
    waitFor([&] { return w.window().inputs().waits() == InputDeck::Waits::Undone; });
    CHECK((w.head() - rest).norm() < 1e-3);
    w.trigger("undo");
    CHECK(cyclesOf(w.now()).empty());
    waitFor([&] { return !w.window().inputs().listens(); });
    w.press("suggest-cycles");
    CHECK(w.cycles().amount()->value() == 0);
    CHECK(stays([&] { return (w.head() - rest).norm() < 1e-3; }));
    w.cycles().amount()->setValue(80);
    waitFor([&] { return (w.head() - rest).norm() > 0.02; });
}

TEST_CASE("cycles: the panel is whole in both languages") {
    Cycling w;
    CHECK(cutOff(w.panel()) == "");
    w.shoot("cycles-none");
    CHECK(!w.window().inputs().listens());
    w.press("suggest-cycles");
    w.panel().list()->selectAll();
    w.settle();
    CHECK(cutOff(w.panel()) == "");
    CHECK(pale(w.panel()) == "");
    w.shoot("cycles-en");
    Appearance::instance().setLanguage(QStringLiteral("ja"));
    w.settle();
    CHECK(cutOff(w.panel()) == "");
    w.shoot("cycles-ja");
}
