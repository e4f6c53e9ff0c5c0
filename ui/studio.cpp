// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/studio.h"

#include <QFileInfo>
#include <QIcon>
#include <QStandardPaths>
#include <QTimer>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "core/commands/core_commands.h"
#include "core/document/command.h"
#include "core/project/response_store.h"
#include "core/project/version.h"
#include "core/reports/report_commands.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/models/failures.h"
#include "ui/widgets/appearance.h"
#include "ui/window/file_flow.h"
#include "ui/window/guarded_application.h"
#include "ui/window/main_window.h"

// A static library's resources must be asked for from outside any namespace.
static void loadResources() { Q_INIT_RESOURCE(studio); }

namespace imomushi {

void prepareStudio() {
    loadResources();
    QCoreApplication::setOrganizationName(QStringLiteral("Imomushi"));
    QCoreApplication::setApplicationName(QStringLiteral("Imomushi"));
    QCoreApplication::setApplicationVersion(QString::fromLatin1(kVersion));
    QGuiApplication::setApplicationDisplayName({});
    QGuiApplication::setDesktopFileName(QStringLiteral("imomushi"));
    QGuiApplication::setWindowIcon(QIcon(QStringLiteral(":/icons/imomushi.svg")));
    Failures::instance().listen();
    Appearance::start();
}

namespace {

/// Qt ends the program by abort() where it can draw nowhere, and advises to install it again.
void refuseToStart(QtMsgType type, const QMessageLogContext&, const QString& message) {
    if (type != QtFatalMsg) return;
    std::fputs("The studio found no display to open a window on. Start it in a desktop session, or set DISPLAY or WAYLAND_DISPLAY;\n"
               "\"imomushi run SCRIPT\" performs without one. Qt says:\n",
               stderr);
    std::fputs(qUtf8Printable(message), stderr);
    std::_Exit(1);
}

}  // namespace

int runStudio(int argc, char** argv) {
    const QtMessageHandler usual = qInstallMessageHandler(refuseToStart);
    GuardedApplication application(argc, argv);
    qInstallMessageHandler(usual);
    prepareStudio();
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    // What was computed once is there for other projects too.
    const QString cache = QStandardPaths::writableLocation(QStandardPaths::CacheLocation) + QStringLiteral("/responses");
    MainWindow window(registry, std::make_shared<ResponseStore>(PreferencesDialog::responseLimits(), std::filesystem::path(cache.toStdString())));
    window.show();
    QStringList files;
    for (const QString& argument : QCoreApplication::arguments().mid(1))
        if (!argument.startsWith(u'-')) files << QFileInfo(argument).absoluteFilePath();
    QTimer::singleShot(0, &window, [&window, files] {
        window.files().offerRecovery();
        window.files().drop(files);
    });
    return QApplication::exec();
}

}  // namespace imomushi
