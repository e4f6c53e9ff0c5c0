// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studio/victim.h"

#include <QApplication>
#include <QListWidget>
#include <QPushButton>
#include <QTest>
#include <QTimer>
#include <cstdio>
#include <memory>

#include "core/commands/core_commands.h"
#include "core/project/project_file.h"
#include "ui/dialogs/recovery_dialog.h"
#include "ui/studio.h"
#include "ui/window/file_flow.h"
#include "ui/window/main_window.h"

namespace imomushi {
namespace {

const std::string kWork = "work ";

int stepOf(const Document& document) {
    for (const auto& [id, element] : document.elements)
        if (element->name.starts_with(kWork)) return std::stoi(element->name.substr(kWork.size()));
    return -1;
}

void say(const char* what, int a, int b = 0) {
    std::printf("%s %d %d\n", what, a, b);
    std::fflush(stdout);
}

/// What the person would answer who finds a dialog: recover what is newest, and throw away what is older than what was saved.
void recoverWhenAsked(QApplication& application) {
    auto* timer = new QTimer(&application);
    QObject::connect(timer, &QTimer::timeout, timer, [] {
        auto* dialog = qobject_cast<RecoveryDialog*>(QApplication::activeModalWidget());
        if (!dialog) return;
        if (!dialog->findChild<QListWidget*>()->currentItem()->data(RecoveryDialog::kOutdated).toBool()) return dialog->accept();
        for (auto* button : dialog->findChildren<QPushButton*>())
            if (button->text() == QStringLiteral("Delete")) return button->click();
    });
    timer->start(5);
}

}  // namespace

int studioVictim(int argc, char** argv, const std::string& project, bool last) {
    QApplication application(argc, argv);
    prepareStudio();
    CommandRegistry registry;
    addCoreCommands(registry);
    MainWindow window(registry);
    FileFlow& files = window.files();
    StudioDocument& document = window.document();
    recoverWhenAsked(application);
    const auto onDisk = openProject(project);
    const bool recovered = files.offerRecovery();
    if (!onDisk) return 2;
    if (recovered)
        (void)QTest::qWaitFor([&] { return !files.autosave().running(); }, 60'000);
    else
        files.open(QString::fromStdString(project));
    say("found", stepOf(onDisk->document), recovered ? stepOf(document.document()) : -1);
    if (last) {
        const bool saved = files.save();
        say("done", stepOf(document.document()));
        return saved ? 0 : 3;
    }
    for (int step = stepOf(document.document()) + 1;; ++step) {
        const std::string before = kWork + std::to_string(step - 1), now = kWork + std::to_string(step);
        if (!document.execute({{"do", "rename"}, {"target", before}, {"name", now}})) return 4;
        if (step % 3 == 0) {
            if (!files.save()) return 5;
        } else {
            files.autosave().saveSoon();
            if (!QTest::qWaitFor([&] { return !files.autosave().running(); }, 60'000) || !files.autosave().kept()) return 6;
        }
        say("done", step);
    }
}

}  // namespace imomushi
