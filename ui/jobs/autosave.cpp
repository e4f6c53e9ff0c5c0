// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/autosave.h"

#include <QDir>
#include <QFile>
#include <QFile>
#include <QFileInfo>
#include <QUuid>
#include <filesystem>
#include <utility>

#include "core/base/abandoned_files.h"
#include "core/project/project_file.h"
#include "ui/models/failures.h"
#include "ui/models/texts.h"

namespace imomushi {
namespace {

const QString kSuffix = QStringLiteral(".imomushi");

// Beside a copy: the path of the project that it is of and, in a second line, the name of the copy that it was taken up from; and what says that its studio lives.
QString originalOf(const QString& file) { return file.chopped(kSuffix.size()) + QStringLiteral(".path"); }
QString lockOf(const QString& file) { return file.chopped(kSuffix.size()) + QStringLiteral(".lock"); }

void remove(const QString& file) {
    QFile::remove(file);
    QFile::remove(originalOf(file));
}

}  // namespace

Autosave::Autosave(StudioDocument& document, QString folder, QObject* parent) : BackgroundJob(parent), document_(document), folder_(std::move(folder)) {
    timer_.setInterval(kMinutes * 60 * 1000);
    connect(&timer_, &QTimer::timeout, this, &Autosave::saveSoon);
    timer_.start();
    const auto change = [this] { changed_ = true; };
    connect(this, &BackgroundJob::finished, this, [this](bool completed) { changed_ = changed_ || !completed; });  // what failed is still to be kept
    connect(&document, &StudioDocument::historyChanged, this, change);
    connect(&document, &StudioDocument::responsesChanged, this, change);
    connect(&document, &StudioDocument::fileChanged, this, [this] {
        if (!document_.session().modified()) clear();
    });
}

Autosave::~Autosave() {
    attempt([this] { clear(); });
}

void Autosave::clear() {
    cancel();
    changed_ = false;
    if (const auto old = std::exchange(takenUp_, std::nullopt)) remove(old->file);
    if (file_.isEmpty()) return;
    remove(file_);
    // What still writes there takes it away itself; the next copy has another name.
    file_.clear();
    lock_.reset();
}

void Autosave::saveSoon() {
    if (!changed_ || running() || !document_.session().modified()) return;
    if (file_.isEmpty()) {
        QDir().mkpath(folder_);
        file_ = QDir(folder_).filePath(QUuid::createUuid().toString(QUuid::WithoutBraces) + kSuffix);
        lock_ = FileLock::take(lockOf(file_).toStdString());
    }
    auto result = std::make_shared<Result<void>>();
    const auto project = std::make_shared<const Project>(document_.project());
    const QByteArray original = QByteArray::fromStdString(document_.session().path().string()) + '\n' + (takenUp_ ? QFileInfo(takenUp_->file).fileName().toUtf8() : QByteArray());
    launch(
        [result, project, original, file = file_](const Progress& progress) {
            QFile path(originalOf(file));
            if (path.open(QIODevice::WriteOnly)) path.write(original);
            path.close();
            *result = saveProject(std::filesystem::path(file.toStdString()), *project);
            if (progress.cancelled()) remove(file);
        },
        [this, result] {
            if (!*result) {
                changed_ = true;
                if (!failureTold_) Q_EMIT failed(tr("Your work could not be kept for recovery. %1").arg(errorText(result->error())));
            }
            failureTold_ = !*result;
            if (const auto old = kept() ? std::exchange(takenUp_, std::nullopt) : std::nullopt) remove(old->file);
        });
    changed_ = false;
}

bool Autosave::kept() const { return !file_.isEmpty() && QFile::exists(file_); }

QList<Autosave::Found> Autosave::found() const {
    QList<Found> out;
    QStringList takenUp;
    removeAbandonedFiles(folder_.toStdString());  // each copy has a name of its own: nobody writes there again
    const auto files = QDir(folder_).entryInfoList({QStringLiteral("*") + kSuffix}, QDir::Files, QDir::Time);
    for (const QFileInfo& info : files) {
        Found one{info.absoluteFilePath(), {}, info.lastModified(), false, nullptr};
        if (one.file == QFileInfo(file_).absoluteFilePath()) continue;
        one.lock = FileLock::take(lockOf(one.file).toStdString());
        if (!one.lock) continue;  // of a studio that lives
        if (QFile path(originalOf(one.file)); path.open(QIODevice::ReadOnly)) {
            const QList<QByteArray> lines = path.readAll().split('\n');
            one.original = QString::fromUtf8(lines.value(0));
            takenUp << QString::fromUtf8(lines.value(1));
        }
        one.outdated = !one.original.isEmpty() && QFileInfo(one.original).lastModified() > one.time;
        out << one;
    }
    // A studio that was killed between its own copy and the end of the one that it came from.
    out.removeIf([&](const Found& one) {
        const bool superseded = takenUp.contains(QFileInfo(one.file).fileName());
        if (superseded) remove(one.file);
        return superseded;
    });
    // One that was killed before it had a copy.
    for (const QFileInfo& info : QDir(folder_).entryInfoList({QStringLiteral("*.lock"), QStringLiteral("*.path")}, QDir::Files)) {
        const QString file = QDir(folder_).filePath(info.completeBaseName() + kSuffix);
        if (QFile::exists(file) || file == file_) continue;
        if (const auto lock = FileLock::take(lockOf(file).toStdString())) QFile::remove(originalOf(file));
    }
    return out;
}

void Autosave::takeUp(const Found& found) {
    takenUp_ = found;
    saveSoon();
}

void Autosave::discard(const Found& found) {
    QFile::moveToTrash(found.file);  // work is never thrown away by one click; where there is no bin, it goes
    remove(found.file);
}

}  // namespace imomushi
