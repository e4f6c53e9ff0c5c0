// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <QApplication>
#include <QCursor>
#include <QPushButton>
#include <QScreen>
#include <QTemporaryDir>
#include <QTest>
#include <memory>

#include "ui/dialogs/import_dialog.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/window/file_flow.h"
#include "ui/window/main_window.h"
#include "ui/window/studio_actions.h"

namespace imomushi {

/// The window of the studio on the display of the test, with a folder to write into.
struct Window {
    CommandRegistry registry;
    QTemporaryDir folder;
    std::unique_ptr<MainWindow> made;

    explicit Window(QSize size = {1560, 960}) {
        addCoreCommands(registry);
        made = std::make_unique<MainWindow>(registry);
        made->resize(size);
        made->move(10, 10);
        // The pointer of the display would move over the view whenever a dialog closes, with no button down.
        QCursor::setPos(1599, 999);
        made->show();
        REQUIRE(QTest::qWaitForWindowExposed(made.get()));
        activate();
    }
    /// No window manager gives the focus back when a dialog or a list closes.
    void activate() {
        made->activateWindow();
        REQUIRE(QTest::qWaitForWindowActive(made.get()));
        settle();
    }

    MainWindow& window() { return *made; }
    StudioDocument& document() { return made->document(); }
    const Document& now() { return made->document().document(); }
    ViewportWidget& view() { return made->viewport(); }
    /// Lets so much time pass, and then what is queued happen: one slow frame must not use up all the time.
    void settle(int ms = 60) {
        QTest::qWait(ms);
        for (int round = 0; round < 4; ++round) QCoreApplication::processEvents();
    }

    void run(const Json& command) {
        const auto answer = document().execute(command);
        REQUIRE_MESSAGE(answer.has_value(), (answer ? "" : answer.error().message));
    }
    void trigger(const char* action) {
        QAction* a = made->actions()[action];
        REQUIRE_MESSAGE(a->isEnabled(), action);
        a->trigger();
        settle();
    }
    /// Imports a mesh through the dialog, as a person does.
    void import(const QString& path) {
        made->files().import({path});
        auto* dialog = made->findChild<ImportDialog*>();
        REQUIRE(dialog);
        auto* button = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
        REQUIRE(QTest::qWaitFor([&] { return button->isEnabled(); }, 20000));
        shoot("import");
        QTest::mouseClick(button, Qt::LeftButton);
        settle(400);  // the camera frames what came
        activate();
    }
    QPoint onScreen(const Vec3& p) {
        const auto at = view().onScreen(p);
        REQUIRE(at.has_value());
        const QPoint pixel = at->toPoint();
        REQUIRE(view().rect().contains(pixel));
        return pixel;
    }
    void click(QPoint at, Qt::KeyboardModifiers keys = {}) {
        QTest::mouseMove(&view(), at);
        settle(30);
        QTest::mouseClick(&view(), Qt::LeftButton, keys, at);
        settle(30);
    }
    void look(const Vec3& from) {
        view().cameraController().setDirection(-from, false);
        view().frameAll(false);
        settle();
    }
    /// Keeps a picture of the screen where IMOMUSHI_SCREENSHOTS names a folder.
    void shoot(const char* name) {
        const QString to = qEnvironmentVariable("IMOMUSHI_SCREENSHOTS");
        if (to.isEmpty()) return;
        settle(250);
        QGuiApplication::primaryScreen()->grabWindow(0).save(to + u'/' + QLatin1String(name) + QStringLiteral(".png"));
    }
};

}  // namespace imomushi
