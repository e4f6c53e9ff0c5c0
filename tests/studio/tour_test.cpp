// SPDX-License-Identifier: GPL-3.0-or-later
#include <QDockWidget>
#include <QFile>
#include <QLineEdit>
#include <QMessageBox>
#include <QTabWidget>
#include <QTimer>

#include "tests/studio/window.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/models/recent_files.h"
#include "ui/widgets/appearance.h"
#include "ui/window/command_search.h"

using namespace imomushi;

TEST_CASE("studio: samples open in one click and are ready to be dragged") {
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name.toStdString());
        Window w;
        w.window().files().open(sample.path);
        w.settle(700);
        CHECK(!w.window().startShown());
        CHECK(!w.now().elements.empty());
        CHECK(!w.now().bones.empty());
        CHECK(!w.document().session().modified());
        // Saving a sample asks for a file of one's own: it never writes into the program's.
        CHECK(isSample(sample.path));
        w.trigger("tool-pose");
        w.shoot(qPrintable(QStringLiteral("sample-") + sample.name));
    }
    Window w;
    w.settle(200);
    w.shoot("start-pictures");
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
    line->selectAll();
    QTest::keyClicks(line, QStringLiteral("start page"));
    QTest::keyClick(line, Qt::Key_Return);
    w.settle();
    CHECK(!w.window().startShown());
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
    REQUIRE(QTest::qWaitFor([&] { return dialog->prepared() != nullptr; }, 20000));
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
    w.run({{"do", "set"}, {"target", name}, {"property", "nu"}, {"value", 0.3}});
    w.run({{"do", "set"}, {"target", name}, {"property", "color"}, {"value", "#d08050"}});
    w.run({{"do", "rename"}, {"target", name}, {"name", "worm"}});
    w.run({{"do", "undo"}});
    w.window().findChild<QDockWidget*>(QStringLiteral("historyDock"))->raise();
    w.settle(200);
    w.shoot("history");
    w.run({{"do", "new"}});
}

TEST_CASE("studio: closing asks about unsaved changes, and cancelling keeps the window") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const auto answer = [&](const QString& button, const char* picture) {
        QTimer::singleShot(300, [&w, button, picture] {
            auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
            REQUIRE(box);
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
        REQUIRE(QTest::qWaitFor([&] { return button->isEnabled(); }, 20000));
        QTest::mouseClick(button, Qt::LeftButton);
        w.settle(100);
        CHECK(w.now().elements.size() == std::size_t(i));
    }
    CHECK(w.now().elements.begin()->second->name != w.now().elements.rbegin()->second->name);
    w.run({{"do", "new"}});
}
