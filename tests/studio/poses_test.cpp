// SPDX-License-Identifier: GPL-3.0-or-later
// Kept poses, by keys and in their panel.
#include <QListWidget>
#include <QSlider>

#include "core/document/kept_pose.h"
#include "tests/studio/window.h"
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
