// SPDX-License-Identifier: GPL-3.0-or-later
// The window and its parts have room at every size of the interface, in both languages.
#include <QAbstractButton>
#include <QDir>
#include <QDockWidget>
#include <QFileInfo>
#include <QFontMetrics>
#include <QScrollBar>
#include <QSettings>
#include <QToolBar>

#include "core/commands/core_commands.h"
#include "tests/studio/window.h"
#include "tests/support/capsules.h"
#include "ui/dialogs/export_dialog.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/panels/takes_panel.h"
#include "ui/panels/time_bar.h"
#include "ui/viewport/axis_ball.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/choice_card.h"
#include "ui/window/next_steps.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

namespace {

/// The smallest screen that the studio is made for.
constexpr QSize kSmallest(1280, 720);

std::string text(QSize size) { return std::to_string(size.width()) + " x " + std::to_string(size.height()); }

/// Tools that cannot be seen whole: also those that Qt would put behind an arrow.
std::string hiddenTools(MainWindow& window) {
    std::string hidden;
    for (const auto* bar : window.findChildren<QToolBar*>(Qt::FindDirectChildrenOnly))
        for (const auto* button : bar->findChildren<QToolButton*>()) {
            if (button->objectName() == QStringLiteral("qt_toolbar_ext_button")) continue;  // the arrow itself is never shown
            const QRect at(button->mapTo(&window, QPoint()), button->size());
            if (!button->isVisible() || !window.rect().contains(at)) hidden += button->text().toStdString() + "; ";
        }
    return hidden;
}

}  // namespace

TEST_CASE("studio: it opens within the screen at every size, in both languages, and asks for no more than the smallest screen") {
    const QRect screen = QGuiApplication::primaryScreen()->availableGeometry();
    SharedStudio::instance().close();
    for (const char* language : {"en", "ja"})
        for (const double scale : {1.0, 1.25, 1.5, 2.0}) {
            CAPTURE(language);
            CAPTURE(scale);
            Appearance::instance().setLanguage(QString::fromLatin1(language));
            Appearance::instance().setScale(scale);
            CommandRegistry registry;
            addCoreCommands(registry);
            MainWindow window(registry);
            window.show();
            REQUIRE(QTest::qWaitForWindowExposed(&window));
            QTest::qWait(kFrameMs);
            CHECK_MESSAGE(screen.contains(window.geometry()), text(window.size()));
            const QSize least = window.minimumSizeHint();
            CHECK_MESSAGE((least.width() <= kSmallest.width() && least.height() <= kSmallest.height()), text(least));
            CHECK_MESSAGE(QTest::qWaitFor([&] { return hiddenTools(window) == ""; }), hiddenTools(window));
        }
    Appearance::instance().setScale(1.0);
    Appearance::instance().setLanguage(QStringLiteral("en"));
}

TEST_CASE("studio: it stays within the screen when words and letters grow, also after 300 %") {
    Window w;
    const QRect screen = QGuiApplication::primaryScreen()->availableGeometry();
    for (const double scale : {1.5, 3.0, 1.0})
        for (const char* language : {"ja", "en"}) {
            CAPTURE(scale);
            CAPTURE(language);
            Appearance::instance().setScale(scale);
            Appearance::instance().setLanguage(QString::fromLatin1(language));
            w.settle();
            w.settle();
            CHECK_MESSAGE(screen.contains(w.window().geometry()), text(w.window().size()));
        }
}

TEST_CASE("studio: panels that grew with the letters shrink with them again") {
    Window w;
    auto* dock = w.window().findChild<QDockWidget*>(QStringLiteral("outlinerDock"));
    REQUIRE(dock);
    const int before = dock->width();
    Appearance::instance().setScale(1.5);
    CHECK(QTest::qWaitFor([&] { return dock->width() > before; }));
    Appearance::instance().setScale(1.0);
    CHECK(QTest::qWaitFor([&] { return std::abs(dock->width() - before) <= 2; }));
}

TEST_CASE("studio: at 1280 x 720 all tools are seen, in more columns where they need them") {
    Window w(kSmallest);
    w.settle();
    CHECK(w.window().size() == kSmallest);
    CHECK_MESSAGE(QTest::qWaitFor([&] { return hiddenTools(w.window()) == ""; }), hiddenTools(w.window()));
    w.shoot("small");
    for (const double scale : {1.5, 2.0}) {
        CAPTURE(scale);
        Appearance::instance().setScale(scale);
        w.settle();
        w.settle();
        CHECK(w.window().size() == kSmallest);
        CHECK_MESSAGE(QTest::qWaitFor([&] { return hiddenTools(w.window()) == ""; }), hiddenTools(w.window()));
    }
    Appearance::instance().setScale(1.0);
    w.window().resize(1560, 960);
    w.settle();
    int breaks = 0;
    for (auto* bar : w.window().findChildren<QToolBar*>(Qt::FindDirectChildrenOnly)) breaks += w.window().toolBarBreak(bar);
    CHECK(breaks == 0);
}

TEST_CASE("studio: at 1280 x 720 what comes next is said in whole words beside the ball of axes, at every size of letters, in both languages") {
    Window w(kSmallest);
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    w.run({{"do", "rename"}, {"target", w.now().elements.begin()->second->name}, {"name", "the caterpillar of my sister"}});
    auto* next = w.window().findChild<NextSteps*>();
    REQUIRE(next);
    w.window().findChild<QDockWidget*>(QStringLiteral("accuracyDock"))->hide();
    w.window().findChild<QDockWidget*>(QStringLiteral("takesDock"))->show();
    for (const char* language : {"en", "ja"})
        for (const double scale : {1.0, 1.5}) {
            CAPTURE(language);
            CAPTURE(scale);
            Appearance::instance().setLanguage(QString::fromLatin1(language));
            Appearance::instance().setScale(scale);
            w.settle();
            w.settle();
            REQUIRE(next->isVisible());
            CHECK_MESSAGE(QTest::qWaitFor([&] { return cutOff(*next) == ""; }), cutOff(*next));
            CHECK(!AxisBall::area(w.view().width(), scale).intersects(next->geometry()));
            CHECK(w.view().rect().contains(next->geometry()));
            // Nor is what stands where takes will be wider than there is room.
            for (const auto* bar : w.window().findChild<QDockWidget*>(QStringLiteral("takesDock"))->findChildren<QScrollBar*>()) CHECK((bar->orientation() == Qt::Vertical || !bar->isVisible()));
            w.window().messages().offer(QStringLiteral("Cut “%1 2” from “%1” and joined them.").arg(QStringLiteral("the caterpillar of my sister")), QStringLiteral("Place bones"), [] {});
            w.settle();
            CHECK_MESSAGE(QTest::qWaitFor([&] { return cutOff(w.window().messages()) == ""; }), cutOff(w.window().messages()));
            const QLabel* words = nullptr;
            for (const auto* label : w.window().messages().findChildren<QLabel*>())
                if (!label->text().isEmpty()) words = label;
            const auto* offer = w.window().messages().findChild<QPushButton*>(QStringLiteral("offer"));
            REQUIRE((words && offer));
            CHECK(!words->geometry().intersects(offer->geometry()));
            w.shoot("next-small");
            w.window().messages().hide();
        }
}

TEST_CASE("studio: at 1280 x 720 everything that plays and records takes is seen, in both languages") {
    Window w(kSmallest - QSize(16, 48));  // as it opens there, with room for a frame
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/dragon.imomushi"));
    auto* dock = w.window().findChild<QDockWidget*>(QStringLiteral("takesDock"));
    REQUIRE(dock);
    dock->show();
    dock->raise();
    TakesPanel& panel = w.window().takes();
    w.settle();
    CHECK(panel.height() < px(200));  // no more than it needs: the rest is for the view
    const auto hidden = [&] {
        std::string names;
        for (const QWidget* part : panel.findChildren<QWidget*>()) {
            const bool counts = qobject_cast<const QAbstractButton*>(part) || qobject_cast<const QLabel*>(part) || part == panel.bar();
            if (!counts || !part->isVisible()) continue;
            if (part->visibleRegion().boundingRect() != part->rect()) names += part->accessibleName().toStdString() + part->objectName().toStdString() + "; ";
        }
        return names;
    };
    for (const char* language : {"en", "ja"})
        for (const double scale : {1.0, 1.25, 1.5}) {
            CAPTURE(language);
            CAPTURE(scale);
            Appearance::instance().setLanguage(QString::fromLatin1(language));
            Appearance::instance().setScale(scale);
            w.window().resize(kSmallest - QSize(16, 48));
            w.settle();
            CHECK_MESSAGE(QTest::qWaitFor([&] { return hidden() == ""; }), hidden());
            w.shoot("takes-narrow");
            CHECK(panel.bar()->width() >= px(160));
            w.trigger("record");
            w.settle();
            CHECK_MESSAGE(QTest::qWaitFor([&] { return hidden() == ""; }), "recording: ", hidden());
            w.trigger("record");
            w.trigger("undo");
        }
    Appearance::instance().setScale(1.0);
    Appearance::instance().setLanguage(QStringLiteral("en"));
    dock->hide();
}

TEST_CASE("dialogs: none asks for more than the smallest screen, in both languages, at 100 to 150 %") {
    Window w(kSmallest);
    const QString mesh = writeMesh(w.folder.filePath(QStringLiteral("star.obj")), capsules::starfish());
    w.open(samples()[0].path);
    const auto fits = [](const QDialog& dialog) {
        const QSize least = dialog.minimumSizeHint();
        CHECK_MESSAGE((least.width() <= kSmallest.width() && least.height() <= kSmallest.height() - 40), dialog.objectName().toStdString(), " ", text(least));  // 40: the frame's title
    };
    for (const char* language : {"en", "ja"})
        for (const double scale : {1.0, 1.25, 1.5}) {
            CAPTURE(language);
            CAPTURE(scale);
            Appearance::instance().setScale(scale);
            Appearance::instance().setLanguage(QString::fromLatin1(language));
            w.settle();
            w.trigger("export");
            auto* exporting = w.window().findChild<ExportDialog*>();
            REQUIRE(exporting);
            fits(*exporting);
            exporting->reject();
            w.window().files().import({mesh});
            auto* import = w.window().findChild<ImportDialog*>();
            REQUIRE(import);
            fits(*import);
            import->reject();
            PreferencesDialog preferences(w.window().actions(), &w.window());
            fits(preferences);
            w.settle();
        }
    Appearance::instance().setScale(1.0);
    Appearance::instance().setLanguage(QStringLiteral("en"));
}

TEST_CASE("dialogs: a card of choices grows with its words") {
    SharedStudio::instance().close();
    ChoiceCard card(QStringLiteral("Short"), QStringLiteral("Two words."));
    const int usual = card.heightForWidth(px(160));
    CHECK(usual == card.heightForWidth(px(300)));  // as high as a neighbour with two lines
    ChoiceCard wordy(QStringLiteral("Long"), QString(QStringLiteral("Many words ")).repeated(12));
    CHECK(wordy.heightForWidth(px(160)) > usual + 2 * wordy.fontMetrics().height());
}

TEST_CASE("start page: the words of a card have room at every size, in both languages") {
    Window w;
    w.window().showStart(true);
    for (const char* language : {"en", "ja"})
        for (const double scale : {1.0, 1.25, 1.5, 2.0}) {
            CAPTURE(language);
            CAPTURE(scale);
            Appearance::instance().setLanguage(QString::fromLatin1(language));
            Appearance::instance().setScale(scale);
            w.window().resize(kSmallest);
            w.settle();
            auto* page = w.window().findChild<QWidget*>(QStringLiteral("startPage"));
            REQUIRE(page);
            CHECK_MESSAGE(QTest::qWaitFor([&] { return cutOff(*page) == ""; }), cutOff(*page));
            for (const char* name : {"wayFromSample", "wayFromMesh", "wayFromRiggedFile"}) {
                const auto* card = w.window().findChild<QAbstractButton*>(QLatin1String(name));
                REQUIRE(card);
                // A sign of 40 pixels within margins of 16, and the words below it.
                const int wide = card->width() - 2 * px(16), high = card->height() - px(16) - px(40) - px(9) - px(16);
                const int needed = QFontMetrics(card->font()).boundingRect(QRect(0, 0, wide, 10000), Qt::TextWordWrap, card->accessibleDescription()).height();
                CHECK_MESSAGE(needed <= high, name);
            }
        }
}

TEST_CASE("viewport: what can be taken hold of grows with the interface") {
    Window w;
    w.run({{"do", "add-bone"}, {"name", "a"}, {"element", ""}, {"from", {0, 0, 0}}, {"to", {0, 1, 0}}});
    w.window().showStart(false);
    w.trigger("tool-select");
    w.look(Vec3(0, 0, 1));
    const EndpointRef end{w.now().bones.begin()->first, true};
    const auto hovered = [&] {
        // Beside the bone: 18 logical pixels, of which 12 are near enough at 100 %.
        QTest::mouseMove(&w.view(), w.view().rect().bottomLeft() + QPoint(5, -5));
        w.settle();
        QTest::mouseMove(&w.view(), w.view().onScreen(end)->toPoint() + QPoint(18, 0));
        w.settle();
        return w.document().hovered().has_value();
    };
    CHECK(!hovered());
    Appearance::instance().setScale(2.0);
    w.settle();
    w.look(Vec3(0, 0, 1));
    CHECK(hovered());
    const QRectF ball = AxisBall::area(w.view().width(), 2.0);
    CHECK(ball.width() == 2.0 * AxisBall::area(w.view().width(), 1.0).width());
    // Seen along z, the ball has x on its right.
    QTest::mouseClick(&w.view(), Qt::LeftButton, {}, QPoint(int(ball.right()) - 24, int(ball.center().y())));
    w.cameraStands();
    CHECK((w.view().cameraController().axes().col(2) - Vec3::UnitX()).norm() < 1e-9);
}

TEST_CASE("studio: it remembers that it was maximised") {
    {
        Window w;
        w.window().showMaximized();
        w.settle();
        w.window().close();
        w.end();
    }
    CommandRegistry registry;
    addCoreCommands(registry);
    MainWindow window(registry);
    CHECK(window.isMaximized());
    QSettings().remove(QStringLiteral("window"));
}

TEST_CASE("studio: another theme and another start leave the docks their sizes") {
    const auto height = [](MainWindow& window) { return window.findChild<QDockWidget*>(QStringLiteral("outlinerDock"))->height(); };
    const auto make = [&](CommandRegistry& registry) {
        addCoreCommands(registry);
        auto window = std::make_unique<MainWindow>(registry);
        window->resize(1500, 900);
        window->show();
        REQUIRE(QTest::qWaitForWindowExposed(window.get()));
        QTest::qWait(2 * kFrameMs);
        return window;
    };
    SharedStudio::instance().close();
    int chosen = 0;
    {
        CommandRegistry registry;
        auto window = make(registry);
        window->resizeDocks({window->findChild<QDockWidget*>(QStringLiteral("outlinerDock")), window->findChild<QDockWidget*>(QStringLiteral("inspectorDock"))}, {500, 300}, Qt::Vertical);
        QTest::qWait(kFrameMs);
        chosen = height(*window);
        REQUIRE(chosen > 400);
        for (const auto theme : {Appearance::Theme::Light, Appearance::Theme::HighContrast, Appearance::Theme::Dark}) {
            Appearance::instance().setTheme(theme);
            QTest::qWait(2 * kFrameMs);
            CHECK(std::abs(height(*window) - chosen) <= 4);  // a share that was rounded
        }
        window->close();
    }
    for (int start = 0; start < 3; ++start) {
        CommandRegistry registry;
        auto window = make(registry);
        CHECK(std::abs(height(*window) - chosen) <= 4);
        window->close();
    }
    QSettings().remove(QStringLiteral("window"));
}

TEST_CASE("studio: a panel that is asked for is in front, floats with a title, and one that is alone says its name") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    const auto dock = [&](const char* name) { return w.window().findChild<QDockWidget*>(QLatin1String(name)); };
    const auto action = [&](QDockWidget* d) {
        for (auto* a : w.window().findChildren<QAction*>())
            if (a->text() == d->windowTitle() && a->isCheckable() && a != d->toggleViewAction()) return a;
        return static_cast<QAction*>(nullptr);
    };
    QDockWidget *outliner = dock("outlinerDock"), *history = dock("historyDock"), *takes = dock("takesDock");
    REQUIRE(history->visibleRegion().isEmpty());
    REQUIRE(action(history));
    action(history)->trigger();
    w.settle();
    CHECK(!history->visibleRegion().isEmpty());
    CHECK(outliner->visibleRegion().isEmpty());
    action(outliner)->trigger();  // behind: it comes to the front, and is not closed
    w.settle();
    CHECK(!outliner->visibleRegion().isEmpty());
    action(outliner)->trigger();
    w.settle();
    CHECK(outliner->isHidden());
    action(outliner)->trigger();
    w.settle();
    CHECK(outliner->titleBarWidget() != nullptr);  // its tab says the name
    CHECK(takes->titleBarWidget() == nullptr);     // it is alone
    CHECK(takes->features().testFlag(QDockWidget::DockWidgetFloatable));
    outliner->setFloating(true);
    w.settle();
    CHECK(outliner->titleBarWidget() == nullptr);
    CHECK(outliner->isVisible());
    outliner->setFloating(false);
    w.settle();
    w.shoot("docks");
}

TEST_CASE("studio: vertices are counted in one way") {
    Window w;
    for (const char* sample : {"caterpillar", "dragon"}) {
        CAPTURE(sample);
        w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/") + QLatin1String(sample) + QStringLiteral(".imomushi"));
        w.document().select({});
        waitFor([&] { return inspectorRow<QLabel>(w, "Vertices") != nullptr; });
        w.settle();
        const QString count = inspectorRow<QLabel>(w, "Vertices")->text();
        REQUIRE(!count.isEmpty());
        bool said = false;
        for (const auto* label : w.window().status().findChildren<QLabel*>()) said = said || label->text() == count + QStringLiteral(" vertices");
        CHECK_MESSAGE(said, count.toStdString());
    }
}

TEST_CASE("studio: folders that are proposed exist") {
    Window w;
    QSettings().setValue(QStringLiteral("files/folder"), w.folder.filePath(QStringLiteral("gone/deeper")));
    CHECK(QDir(w.window().files().folder()) == QDir(w.folder.path()));
    QSettings().setValue(QStringLiteral("files/folder"), QStringLiteral("/nowhere/at/all"));
    CHECK(QFileInfo(w.window().files().folder()).isDir());
    QSettings().remove(QStringLiteral("files/folder"));
}
