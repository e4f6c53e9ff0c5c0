// SPDX-License-Identifier: GPL-3.0-or-later
#include <QDir>
#include <QFile>
#include <QListWidget>
#include <QSettings>
#include <QStandardPaths>
#include <pwd.h>
#include <unistd.h>

#include "tests/studio/window.h"
#include "tests/support/own_home.h"
#include "ui/dialogs/recovery_dialog.h"
#include "ui/dialogs/versions_dialog.h"

using namespace imomushi;

namespace {

QString recoveryFolder() { return QStandardPaths::writableLocation(QStandardPaths::AppDataLocation) + QStringLiteral("/recovery"); }
std::string caterpillar() {
    for (const Sample& sample : samples())
        if (sample.name == QStringLiteral("caterpillar")) return sample.path.toStdString();
    FAIL("no sample");
    return {};
}

QStringList copies(const QString& folder) { return QDir(folder).entryList({QStringLiteral("*.imomushi")}, QDir::Files); }

/// Keeps the unsaved work of a window, and leaves it in the folder as a studio does that was killed: without its lock.
void crash(Window& w) {
    QDir().mkpath(recoveryFolder());
    w.window().files().autosave().saveSoon();
    waitFor([&] { return !w.window().files().autosave().running(); });
    const QStringList files = QDir(recoveryFolder()).entryList(QDir::Files);
    for (const QString& file : files)
        if (!file.endsWith(QStringLiteral(".lock"))) REQUIRE(QFile::copy(QDir(recoveryFolder()).filePath(file), w.folder.filePath(file)));
    const QString from = w.folder.path();
    w.end();
    REQUIRE(copies(recoveryFolder()).isEmpty());  // who ends well leaves nothing
    for (const QString& file : QDir(from).entryList(QDir::Files)) REQUIRE(QFile::copy(QDir(from).filePath(file), QDir(recoveryFolder()).filePath(file)));
}

/// Presses a button of the dialog that the next call opens.
void answer(const char* text) {
    whenModal<RecoveryDialog>([text](RecoveryDialog* dialog) {
        if (const QByteArray folder = qgetenv("IMOMUSHI_SCREENSHOTS"); !folder.isEmpty()) dialog->grab().save(QString::fromUtf8(folder) + QStringLiteral("/recovery.png"));
        for (auto* button : dialog->findChildren<QPushButton*>())
            if (button->text() == QLatin1String(text)) return QTest::mouseClick(button, Qt::LeftButton);
        FAIL("no such button");
    });
}

}  // namespace

TEST_CASE("recovery: a copy that could not be made for want of memory is made the next time") {
    Window w;
    w.run({{"do", "add-bone"}, {"name", "bone"}, {"element", ""}, {"from", {0, 0, 0}}, {"to", {0, 0, 1}}});
    Autosave& autosave = w.window().files().autosave();
    autosave.saveSoon();
    waitFor([&] { return !autosave.running(); });
    CHECK(autosave.kept());
    autosave.saveSoon();
    CHECK_FALSE(autosave.running());  // nothing has changed since
    Q_EMIT autosave.finished(false);  // as work that throws ends
    autosave.saveSoon();
    CHECK(autosave.running());
    waitFor([&] { return !autosave.running(); });
}

TEST_CASE("recovery: tests of the studio keep nothing in the folders of whoever runs them") {
    CHECK(ownHome().holdsAll());
    const QString own = QString::fromStdString(ownHome().path().string());
    using Where = QStandardPaths::StandardLocation;
    for (const Where where : {QStandardPaths::AppDataLocation, QStandardPaths::AppLocalDataLocation, QStandardPaths::GenericDataLocation, QStandardPaths::CacheLocation,
                              QStandardPaths::GenericCacheLocation, QStandardPaths::ConfigLocation, QStandardPaths::AppConfigLocation, QStandardPaths::DocumentsLocation, QStandardPaths::HomeLocation})
        CHECK_MESSAGE(QStandardPaths::writableLocation(where).startsWith(own), QStandardPaths::writableLocation(where).toStdString());
    CHECK(QSettings().fileName().startsWith(own));
    CHECK(recoveryFolder().startsWith(own));
    // Whose home it is in truth, whatever the environment says.
    const passwd* user = ::getpwuid(::getuid());
    REQUIRE(user);
    CHECK(QDir(own) != QDir(QString::fromLocal8Bit(user->pw_dir)));
    // And that is where a studio writes.
    Window w;
    w.run({{"do", "open"}, {"path", caterpillar()}, {"as", ""}});
    w.run({{"do", "rename"}, {"target", "head"}, {"name", "changed"}});
    w.window().files().autosave().saveSoon();
    waitFor([&] { return w.window().files().autosave().kept(); });
    CHECK(copies(own + QStringLiteral("/data/Imomushi/Imomushi/recovery")).size() == 1);
}

TEST_CASE("recovery: work that was never saved is offered at the next start, taken up with its history begun anew, and goes once it is saved") {
    QDir(recoveryFolder()).removeRecursively();
    {
        Window w;
        w.run({{"do", "open"}, {"path", caterpillar()}, {"as", ""}});
        w.run({{"do", "rename"}, {"target", "head"}, {"name", "頭"}});
        crash(w);
    }
    REQUIRE(copies(recoveryFolder()).size() == 1);
    Window w;
    answer("Recover");
    REQUIRE(w.window().files().offerRecovery());
    CHECK(w.now().elementNamed("頭"));
    CHECK(w.document().session().modified());
    CHECK(w.document().session().path().empty());
    for (const auto& [id, element] : w.now().elements) CHECK(w.document().session().responseState(id) == Session::ResponseState::Fresh);
    // A new copy stands in for the old one before that goes.
    waitFor([&] { return !w.window().files().autosave().running(); });
    CHECK(copies(recoveryFolder()).size() == 1);
    w.run({{"do", "save"}, {"path", w.folder.filePath(QStringLiteral("kept.imomushi")).toStdString()}});
    CHECK(!w.document().session().modified());
    CHECK(copies(recoveryFolder()).isEmpty());
}

TEST_CASE("recovery: the copy of a project knows its file, a studio that lives is left alone, and what is deleted is gone") {
    QDir(recoveryFolder()).removeRecursively();
    QTemporaryDir folder;
    const std::string own = folder.filePath(QStringLiteral("いもむし.imomushi")).toStdString();
    {
        Window w;
        w.run({{"do", "open"}, {"path", caterpillar()}});
        w.run({{"do", "save"}, {"path", own}});
        w.run({{"do", "rename"}, {"target", "head"}, {"name", "changed"}});
        w.window().files().autosave().saveSoon();
        waitFor([&] { return !w.window().files().autosave().running(); });
        CHECK(copies(recoveryFolder()).size() == 1);
        CHECK(!w.window().files().offerRecovery());
        Autosave other(w.document(), recoveryFolder());
        CHECK(other.found().isEmpty());
        crash(w);
    }
    Window w;
    auto found = w.window().files().autosave().found();
    REQUIRE(found.size() == 1);
    CHECK(found.front().original.toStdString() == own);
    CHECK(w.window().files().autosave().found().isEmpty());  // it is held above
    found.clear();
    answer("Delete");
    CHECK(!w.window().files().offerRecovery());
    CHECK(copies(recoveryFolder()).isEmpty());
}

TEST_CASE("recovery: an earlier version of a project opens as an unsaved copy") {
    QDir(recoveryFolder()).removeRecursively();
    Window w;
    const QString path = w.folder.filePath(QStringLiteral("versions.imomushi"));
    w.run({{"do", "open"}, {"path", caterpillar()}, {"as", ""}});
    std::string name = "head";
    for (const char* next : {"first", "second", "third"}) {
        w.run({{"do", "rename"}, {"target", name}, {"name", next}});
        w.run({{"do", "save"}, {"path", path.toStdString()}});
        name = next;
    }
    whenModal<VersionsDialog>([](VersionsDialog* dialog) {
        auto* list = dialog->findChild<QListWidget*>();
        CHECK(list->count() == 3);
        list->setCurrentRow(1);
        if (const QByteArray folder = qgetenv("IMOMUSHI_SCREENSHOTS"); !folder.isEmpty()) dialog->grab().save(QString::fromUtf8(folder) + QStringLiteral("/versions.png"));
        dialog->accept();
    });
    w.window().files().askVersion();
    CHECK(w.now().elementNamed("second"));
    CHECK(w.document().session().path().empty());
    CHECK(w.document().session().modified());
    CHECK(openProject(path.toStdString()).value().document.elementNamed("third"));
}

TEST_CASE("saving and opening: the window goes on meanwhile, and takes no input") {
    Window w;
    const QString path = w.folder.filePath(QStringLiteral("saved.imomushi"));
    int turns = 0;
    QTimer timer;
    QObject::connect(&timer, &QTimer::timeout, &timer, [&] {
        ++turns;
        QTest::keyClick(&w.window(), Qt::Key_A, Qt::ControlModifier);  // selects everything, at other times
    });
    w.run({{"do", "open"}, {"path", caterpillar()}, {"as", path.toStdString()}});
    timer.start(0);
    REQUIRE(w.window().files().save());
    CHECK(turns > 0);
    CHECK(!w.document().session().modified());
    turns = 0;
    REQUIRE(w.window().files().open(path));
    CHECK(turns > 0);
    timer.stop();
    CHECK(w.document().selection().empty());
    w.settle();
    QTest::keyClick(&w.window(), Qt::Key_A, Qt::ControlModifier);
    CHECK(!w.document().selection().empty());
    CHECK(openProject(path.toStdString()).value().document.elements.size() == w.now().elements.size());
}
