// SPDX-License-Identifier: GPL-3.0-or-later
#include <QDockWidget>
#include <QMenu>
#include <QSignalSpy>

#include "core/live/pose_check.h"
#include "tests/studio/window.h"
#include "tests/support/plain_sample.h"
#include "ui/models/effect_texts.h"
#include "ui/models/recent_files.h"
#include "ui/models/texts.h"
#include "ui/panels/effects_panel.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/number_field.h"
#include "ui/widgets/switch.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

namespace {

/// The caterpillar, with the effects in front, in the drag tool.
struct Effective : Window {
    explicit Effective(int sample = 0) {
        open(samples()[sample].path);
        for (const Json& line : plainLines(samples()[sample].name.toStdString())) run(line);
        window().findChild<QDockWidget*>(QStringLiteral("effectsDock"))->raise();
        trigger("tool-pose");
        view().setFocus();
        settle();
    }

    Switch& button(const char* effect) {
        auto* found = window().effects().findChild<Switch*>(QLatin1String(effect));
        REQUIRE(found);
        return *found;
    }
    void flip(const char* effect) {
        Switch& s = button(effect);
        window().effects().ensureWidgetVisible(&s);
        QTest::mouseClick(&s, Qt::LeftButton, {}, s.rect().center());
        settle();
    }
    NumberField* field(const char* property) {
        // How fast things swing is behind a disclosure.
        for (auto* disclose : window().effects().findChildren<QToolButton*>(QStringLiteral("fine")))
            if (disclose->isVisible() && disclose->accessibleDescription() == QStringLiteral("hidden")) disclose->click();
        for (auto* f : window().effects().findChildren<NumberField*>(QLatin1String(property)))
            if (f->isVisible()) return f;
        return nullptr;
    }
    EndpointRef lastEnd() { return {now().bones.rbegin()->first, true}; }
    /// Drags an end by so many pixels, in steps, and lets go of the button.
    void drag(const EndpointRef& end, QPoint by) {
        const QPoint from = view().onScreen(end)->toPoint();
        QTest::mouseMove(&view(), from);
        settle();
        QTest::mousePress(&view(), Qt::LeftButton, {}, from);
        for (int i = 1; i <= 6; ++i) {
            QTest::mouseMove(&view(), from + by * i / 6);
            settle();
        }
        QTest::mouseRelease(&view(), Qt::LeftButton, {}, from + by);
    }
};

}  // namespace

TEST_CASE("effects: a switch turns one on with its settings and its price, as one step that bears its name") {
    Effective w;
    const int before = w.document().session().position();
    CHECK(w.field("swing-hertz") == nullptr);
    w.shoot("effects-off");
    w.flip("bone-dynamics");
    CHECK(w.now().effects.has(EffectKind::BoneDynamics));
    CHECK(w.button("bone-dynamics").isChecked());
    REQUIRE(w.field("swing-hertz"));
    CHECK(w.field("swing-hertz")->value() == doctest::Approx(2.5));
    REQUIRE(w.document().session().position() == before + 1);
    const auto& step = w.document().session().steps().back();
    CHECK(stepText(step.name, step.subject) == QStringLiteral("Turn on: Bone dynamics"));
    w.shoot("effects-on");

    NumberField* field = w.field("swing-hertz");
    const QPoint middle = field->rect().center();
    QTest::mousePress(field, Qt::LeftButton, {}, middle);
    for (int i = 1; i <= 5; ++i) {
        QTest::mouseMove(field, middle + QPoint(6 * i, 0));
        w.settle();
    }
    QTest::mouseRelease(field, Qt::LeftButton, {}, middle + QPoint(30, 0));
    w.settle();
    CHECK(w.now().effects.number(EffectKind::BoneDynamics, "swing-hertz") > 3.0);
    CHECK(w.document().session().position() == before + 2);

    w.trigger("undo");
    CHECK(w.field("swing-hertz")->value() == doctest::Approx(2.5));
    w.trigger("undo");
    CHECK(!w.button("bone-dynamics").isChecked());
    CHECK(w.field("swing-hertz") == nullptr);
    w.trigger("redo");
    CHECK(w.button("bone-dynamics").isChecked());
    CHECK(w.field("swing-hertz") != nullptr);
}

TEST_CASE("effects: with bone dynamics the body goes on by itself after the drag, is drawn where it is, and comes back when it is let go") {
    Effective w;
    w.run({{"do", "enable"}, {"effect", "bone-dynamics"}});
    w.settle();
    waitFor([&] { return !w.document().session().moving(); });
    const EndpointRef end = w.lastEnd();
    const QPointF rest = *w.view().onScreen(end);
    w.drag(end, {30, -110});
    REQUIRE(w.now().goals.contains(end));
    CHECK(w.document().session().moving());
    QSignalSpy steps(&w.document(), &StudioDocument::frameStepped);
    waitFor([&] { return !steps.isEmpty() && (*w.view().onScreen(end) - rest).manhattanLength() > 60.0; });
    CHECK(w.document().effectMilliseconds(EffectKind::BoneDynamics).has_value());
    w.shoot("effects-moving");
    const QPointF released = *w.view().onScreen(end);  // far from rest; on a busy machine it may be back before this action returns
    w.trigger("release");
    waitFor([&] { return (*w.view().onScreen(end) - released).manhattanLength() > 20.0; });
    waitFor([&] { return (*w.view().onScreen(end) - rest).manhattanLength() < 2.0; });
    w.shoot("effects-rest");
    // At rest nothing is computed any more.
    waitFor([&] { return !w.document().session().moving(); });
    w.settle();
    steps.clear();
    CHECK(stays([&] { return steps.isEmpty(); }));
}

TEST_CASE("effects: what moves goes on moving while the start page hides the view") {
    Effective w;
    w.run({{"do", "enable"}, {"effect", "bone-dynamics"}});
    w.drag(w.lastEnd(), {0, -90});
    REQUIRE(w.document().session().moving());
    w.window().showStart(true);
    w.settle();
    QSignalSpy steps(&w.document(), &StudioDocument::frameStepped);
    waitFor([&] { return steps.size() > 10; });
    w.window().showStart(false);
}

TEST_CASE("effects: an effect is turned on for one element where that is selected, and the panel says on how many it works") {
    Effective w;
    REQUIRE(w.now().elements.size() > 1);
    const PartId first = w.now().elements.begin()->first;
    w.document().select({{SelectionItem::Kind::Element, first, {}, false}});
    w.window().findChild<QDockWidget*>(QStringLiteral("inspectorDock"))->raise();
    w.settle();
    // Found anew each time: what goes out of date has other rows.
    const auto gravity = [&]() -> Switch* {
        for (auto* s : w.window().inspector().widget()->findChildren<Switch*>())
            if (s->accessibleName() == QStringLiteral("Gravity and inertia")) return s;
        return nullptr;
    };
    Switch* here = gravity();
    REQUIRE(here);
    w.window().inspector().ensureWidgetVisible(here);
    QTest::mouseClick(here, Qt::LeftButton, {}, here->rect().center());
    w.settle();
    CHECK(w.now().effects.has(EffectKind::Gravity, first));
    CHECK(!w.now().effects.has(EffectKind::Gravity, w.now().elements.rbegin()->first));
    REQUIRE(gravity());
    CHECK(gravity()->isChecked());
    w.shoot("effects-here");
    w.window().findChild<QDockWidget*>(QStringLiteral("effectsDock"))->raise();
    waitFor([&] {
        for (auto* b : w.window().effects().findChildren<QPushButton*>())
            if (b->isVisible() && b->text() == QStringLiteral("1 of %1").arg(w.now().elements.size())) return true;
        return false;
    });
    w.shoot("effects-gravity");
    w.trigger("undo");
    CHECK(!w.now().effects.has(EffectKind::Gravity));
}

TEST_CASE("effects: the ground is a plane in the view, and all of it reads in Japanese and in light colours") {
    Effective w;
    const QImage without = w.view().grabFramebuffer();
    w.run({{"do", "enable"}, {"effect", "ground"}});
    waitFor([&] { return w.view().grabFramebuffer() != without; });
    CHECK(pale(w.window().effects()) == "");
    w.run({{"do", "enable"}, {"effect", "bone-dynamics"}});
    w.run({{"do", "enable"}, {"effect", "gravity"}});
    w.settle();
    w.shoot("ground");
    Appearance::instance().setTheme(Appearance::Theme::Light);
    w.settle();
    CHECK(pale(w.window().effects()) == "");
    w.shoot("ground-light");
    Appearance::instance().setLanguage(QStringLiteral("ja"));
    w.settle();
    CHECK(w.button("ground").accessibleName() == QStringLiteral("床"));
    CHECK(pale(w.window().effects()) == "");
    w.shoot("effects-japanese");
    Appearance::instance().setTheme(Appearance::Theme::HighContrast);
    w.settle();
    CHECK(pale(w.window().effects()) == "");
    w.shoot("effects-contrast");
    Appearance::instance().setTheme(Appearance::Theme::Dark);
    Appearance::instance().setLanguage(QStringLiteral("en"));
    w.settle();
}

TEST_CASE("effects: every effect and every setting has its words in the studio") {
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        CHECK(!effectTitle(effect).isEmpty());
        CHECK(effectHelp(effect).endsWith(u'.'));
        for (const EffectProperty& property : effectProperties(effect)) {
            CAPTURE(std::string(property.name));
            CHECK(effectPropertyTitle(property) != QString::fromUtf8(property.name.data(), qsizetype(property.name.size())));
            CHECK(effectPropertyHelp(property).endsWith(u'.'));
        }
    }
}

TEST_CASE("effects: a pose that leaves what is linear is told beside the effect that mends it, which is shown while a button is held and taken with a click") {
    Effective w;
    auto& panel = w.window().effects();
    const auto part = [&](const char* name) {
        for (auto* button : panel.findChildren<QAbstractButton*>(QLatin1String(name)))
            if (button->isVisible()) return button;
        return static_cast<QAbstractButton*>(nullptr);
    };
    w.settle();
    CHECK(stays([&] { return part("take") == nullptr; }));
    REQUIRE(w.document().execute({{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {0.1, 1.15, 0.0}}}));
    REQUIRE(w.document().session().checkPose().has_value());
    waitFor([&] { return part("take") != nullptr; });
    const auto position = w.document().session().position();
    panel.ensureWidgetVisible(part("take"));
    w.settle();
    CHECK(cutOff(panel) == "");
    w.shoot("effects-offer");

    QAbstractButton* compare = part("compare");
    QTest::mousePress(compare, Qt::LeftButton, {}, compare->rect().center());
    CHECK(w.now().effects.has(EffectKind::BendWarp));
    w.settle();
    w.shoot("effects-offer-compared");
    QTest::mouseRelease(compare, Qt::LeftButton, {}, compare->rect().center());
    CHECK(!w.now().effects.has(EffectKind::BendWarp));
    CHECK(w.document().session().position() == position);
    w.settle();

    waitFor([&] { return part("take") != nullptr; });
    QTest::mouseClick(part("take"), Qt::LeftButton);
    CHECK(w.now().effects[EffectKind::BendWarp].automatic);
    CHECK(w.document().session().position() == position + 1);
    w.settle();
    CHECK(part("take") == nullptr);
    REQUIRE(part("automatic"));
    CHECK(part("automatic")->isChecked());
    QTest::mouseClick(part("automatic"), Qt::LeftButton, {}, QPoint(8, part("automatic")->height() / 2));
    CHECK(w.now().effects.has(EffectKind::BendWarp));
    CHECK(!w.now().effects[EffectKind::BendWarp].automatic);

    // What is dismissed does not come again.
    w.flip("bend-warp");
    waitFor([&] { return part("dismiss") != nullptr; });
    QTest::mouseClick(part("dismiss"), Qt::LeftButton);
    w.settle();
    REQUIRE(w.document().execute({{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {0.0, 1.1, 0.1}}}));
    CHECK(stays([&] { return part("take") == nullptr; }));
}
