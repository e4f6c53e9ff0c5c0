// SPDX-License-Identifier: GPL-3.0-or-later
#include <QDir>
#include <QDockWidget>
#include <QFile>
#include <QLineEdit>
#include <QListWidget>
#include <QMessageBox>
#include <QTabWidget>
#include <cmath>
#include <numbers>

#include "tests/studio/window.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/models/recent_files.h"
#include "ui/panels/history_panel.h"
#include "ui/panels/issues_panel.h"
#include "ui/widgets/appearance.h"
#include "ui/window/command_search.h"
#include "ui/window/start_page.h"

using namespace imomushi;

TEST_CASE("studio: samples open in one click and are ready to be dragged") {
    REQUIRE(samples().size() == QDir(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples")).entryList({QStringLiteral("*.imomushi")}).size());
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name.toStdString());
        Window w;
        w.open(sample.path);
        CHECK(!w.window().startShown());
        CHECK(!w.now().elements.empty());
        CHECK(!w.now().bones.empty());
        CHECK(!w.document().session().modified());
        // Saving a sample asks for a file of one's own: it never writes into the program's.
        CHECK(isSample(sample.path));
        // With the hand that drags, and alive.
        CHECK(w.view().tools().kind() == ToolKind::Pose);
        for (const EffectKind kind : {EffectKind::BendWarp, EffectKind::SmoothJoints, EffectKind::BoneDynamics}) CHECK(w.now().effects.has(kind));
        CHECK(!w.document().session().moving());
        w.shoot(qPrintable(QStringLiteral("sample-") + sample.name));
    }
    Window w;
    w.settle();
    w.shoot("start-pictures");
}

TEST_CASE("studio: two mouse actions lead from the start of the program to a bent limb: a click on a sample, and its hand drawn by the flesh") {
    for (const char* language : {"en", "ja"}) {
        CAPTURE(language);
        Window w;
        Appearance::instance().setLanguage(QLatin1String(language));
        w.settle();
        REQUIRE(w.window().startShown());
        w.shoot(qPrintable(QStringLiteral("first-touch-start-") + QLatin1String(language)));
        auto* tile = w.window().findChild<QAbstractButton*>(QStringLiteral("sample-figure"));
        REQUIRE(tile);
        QTest::mouseClick(tile, Qt::LeftButton);
        waitFor([&] { return !w.window().startShown() && !w.now().bones.empty() && w.view().isVisible(); });
        w.cameraStands();

        const Session& session = w.document().session();
        const auto at = [&](const char* end) { return *session.positionOf(*w.now().endpoint(end)); };
        const auto elbow = [&] {
            const Vec3 upper = at("upper-arm-bone.L/end") - at("upper-arm-bone.L/start"), lower = at("lower-arm-bone.L/end") - at("lower-arm-bone.L/start");
            return std::atan2(upper.cross(lower).norm(), upper.dot(lower)) * 180.0 / std::numbers::pi;
        };
        const double straight = elbow();
        const Vec3 foot = at("foot-bone.L/end");
        // The flesh of the hand, away from the ends of its bone.
        const QPoint from = w.onScreen(0.5 * (at("hand-bone.L/start") + at("hand-bone.L/end")));
        QTest::mouseMove(&w.view(), from);
        w.settle();
        QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
        for (int i = 1; i <= 12; ++i) {
            QTest::mouseMove(&w.view(), from + QPoint(-10 * i, -12 * i));
            w.settle();
        }
        waitFor([&] { return elbow() > straight + 20.0; });
        w.shoot(qPrintable(QStringLiteral("first-touch-bent-") + QLatin1String(language)));
        // B has the trunk lean with the limb, and stand again, without letting go.
        const double follows = w.now().settings.bodyFollows;
        REQUIRE(follows > 0.0);
        QTest::keyClick(&w.view(), Qt::Key_B);
        w.settle();
        CHECK(w.now().settings.bodyFollows == 0.0);
        CHECK(w.view().tools().busy());
        QTest::keyClick(&w.view(), Qt::Key_B);
        w.settle();
        CHECK(w.now().settings.bodyFollows == follows);
        // Far out of reach: a word beside the pointer, a colour at the limb.
        QTest::mouseMove(&w.view(), QPoint(20, 20));
        w.settle();
        w.settle();
        w.shoot(qPrintable(QStringLiteral("first-touch-limit-") + QLatin1String(language)));
        QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + QPoint(-120, -144));
        w.settle();
        CHECK((at("foot-bone.L/end") - foot).norm() < 0.02);
        CHECK(cutOff(w.window()) == "");
    }
}

TEST_CASE("studio: the start page leads three ways, by mouse and by keyboard, in every language") {
    Window w;
    auto* page = w.window().findChild<StartPage*>();
    REQUIRE(page);
    for (const char* language : {"ja", "en"}) {
        Appearance::instance().setLanguage(QLatin1String(language));
        w.settle();
        CHECK_MESSAGE(QTest::qWaitFor([&] { return cutOff(*page) == ""; }), cutOff(*page));
        w.shoot(qPrintable(QStringLiteral("start-") + QLatin1String(language)));
    }
    for (const char* name : {"wayFromSample", "wayFromMesh", "wayFromRiggedFile"}) {
        auto* way = page->findChild<QAbstractButton*>(QLatin1String(name));
        REQUIRE(way);
        CHECK(way->isVisible());
        CHECK((way->focusPolicy() & Qt::TabFocus) != 0);
        CHECK(!way->accessibleDescription().isEmpty());
    }
    page->setDropping(true);
    w.settle();
    w.shoot("start-dropping");
    page->setDropping(false);
    auto* sample = page->findChild<QAbstractButton*>(QStringLiteral("wayFromSample"));
    sample->setFocus();
    QTest::keyClick(sample, Qt::Key_Return);
    waitFor([&] { return !w.now().bones.empty(); });
    CHECK(!w.window().startShown());
}

TEST_CASE("studio: commands are found by typing, and run") {
    Window w;
    w.run({{"do", "new"}});
    w.window().showStart(true);
    w.trigger("search");
    auto* search = w.window().findChild<CommandSearch*>();
    REQUIRE(search);
    auto* line = search->findChild<QLineEdit*>();
    QTest::keyClicks(line, QStringLiteral("fra"));
    w.settle();
    w.shoot("search");
    const auto* found = search->findChild<QListWidget*>();
    CHECK(found->geometry().bottom() > search->height() - px(20));  // all of it is for what is found
    line->selectAll();
    QTest::keyClicks(line, QStringLiteral("start page"));
    QTest::keyClick(line, Qt::Key_Return);
    w.settle();
    CHECK(!w.window().startShown());
}

TEST_CASE("studio: that a file is being opened is said no longer than it takes") {
    Window w;
    const QString text = QStringLiteral("Opening…");
    Q_EMIT w.window().files().working(text);
    CHECK(w.window().messages().isVisible());
    w.window().messages().withdraw(QStringLiteral("Something else"));
    CHECK(w.window().messages().isVisible());
    Q_EMIT w.window().files().worked(text);
    CHECK(!w.window().messages().isVisible());
}

TEST_CASE("studio: preferences change the look while they are open") {
    Window w;
    PreferencesDialog dialog(w.window().actions(), &w.window());
    dialog.show();
    w.shoot("preferences");
    auto* tabs = dialog.findChild<QTabWidget*>();
    tabs->setCurrentIndex(1);
    w.shoot("shortcuts");
    Appearance::instance().setLanguage(QStringLiteral("ja"));
    CHECK(QTest::qWaitFor([&] { return dialog.windowTitle() == QStringLiteral("設定"); }));
    w.shoot("shortcuts-japanese");
    Appearance::instance().setLanguage(QStringLiteral("en"));
    CHECK(QTest::qWaitFor([&] { return dialog.windowTitle() == QStringLiteral("Preferences"); }));
}

TEST_CASE("studio: a mesh that cannot be used says why, and cannot be imported") {
    Window w;
    const QString path = w.folder.filePath(QStringLiteral("open.obj"));
    QFile file(path);
    REQUIRE(file.open(QIODevice::WriteOnly));
    file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    file.close();
    w.window().files().import({path});
    auto* dialog = w.window().findChild<ImportDialog*>();
    REQUIRE(dialog);
    waitFor([&] { return dialog->prepared() != nullptr; });
    w.settle();
    CHECK(!dialog->findChild<QPushButton*>(QStringLiteral("importButton"))->isEnabled());
    w.shoot("unusable");
    dialog->reject();
    w.settle();
    CHECK(w.now().elements.empty());
}

TEST_CASE("studio: the history lists every step and goes there") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const std::string name = w.now().elements.begin()->second->name;
    const int imported = w.document().session().position();
    w.run({{"do", "set"}, {"target", name}, {"property", "nu"}, {"value", 0.3}});
    w.run({{"do", "set"}, {"target", name}, {"property", "color"}, {"value", "#d08050"}});
    w.run({{"do", "rename"}, {"target", name}, {"name", "worm"}});
    w.run({{"do", "undo"}});
    w.window().findChild<QDockWidget*>(QStringLiteral("historyDock"))->raise();
    HistoryModel& model = *w.window().history().model();
    model.refresh();
    w.shoot("history");
    REQUIRE(model.rowCount() == imported + 4);  // the beginning, the import, and three steps of which the last is undone
    CHECK(model.position() == imported + 2);
    const auto text = [&](int row) { return model.data(model.index(row), Qt::DisplayRole).toString(); };
    const auto done = [&](int row) { return model.data(model.index(row), HistoryModel::DoneRole).toBool(); };
    for (int row = 0; row < model.rowCount(); ++row) {
        CHECK(!text(row).isEmpty());
        CHECK(done(row) == (row <= imported + 2));
    }
    CHECK(text(imported + 3).contains(QStringLiteral("worm")));
    model.goTo(imported + 3);
    REQUIRE(w.now().elementNamed("worm"));
    CHECK(w.document().session().position() == imported + 3);
    const auto color = w.now().elementNamed("worm")->color;
    CHECK(w.now().elementNamed("worm")->nu == 0.3);
    model.goTo(imported);
    REQUIRE(w.now().elementNamed(name));
    CHECK((w.now().elementNamed(name)->color - color).norm() > 0.1);
    CHECK(w.now().elementNamed(name)->nu != 0.3);
    model.goTo(0);
    CHECK(w.now().elements.empty());
}

TEST_CASE("studio: closing asks about unsaved changes, and cancelling keeps the window") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const auto answer = [&](const QString& button, const char* picture) {
        whenModal<QMessageBox>([&w, button, picture](QMessageBox* box) {
            if (picture) w.shoot(picture);
            for (QAbstractButton* b : box->buttons())
                if (b->text() == button) b->click();
        });
    };
    REQUIRE(w.document().session().modified());
    answer(QStringLiteral("Cancel"), "unsaved");
    CHECK(!w.window().close());
    CHECK(w.window().isVisible());
    answer(QStringLiteral("Don’t save"), nullptr);
    CHECK(w.window().close());
}

TEST_CASE("studio: dropped meshes are imported one after another, and what is neither is told") {
    Window w;
    const QString mesh = QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj");
    w.window().files().drop({mesh, mesh, QStringLiteral("/nowhere/letter.txt")});
    CHECK(w.window().messages().isVisible());
    for (int i = 1; i <= 2; ++i) {
        auto* dialog = w.window().findChild<ImportDialog*>();
        REQUIRE(dialog);
        auto* button = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
        waitFor([&] { return button->isEnabled(); });
        QTest::mouseClick(button, Qt::LeftButton);
        waitFor([&] { return w.now().elements.size() == std::size_t(i); });
    }
    CHECK(w.now().elements.begin()->second->name != w.now().elements.rbegin()->second->name);
}
