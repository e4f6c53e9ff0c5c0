// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/recent_files.h"

#include <QCoreApplication>
#include <QCryptographicHash>
#include <QDir>
#include <QFileInfo>
#include <QSettings>
#include <QStandardPaths>

namespace imomushi {
namespace {

constexpr int kMax = 12;
const QString kKey = QStringLiteral("files/recent");

QString thumbnailPath(const QString& path) {
    const QString folder = QStandardPaths::writableLocation(QStandardPaths::CacheLocation) + QStringLiteral("/thumbnails");
    QDir().mkpath(folder);
    const auto hash = QCryptographicHash::hash(QFileInfo(path).absoluteFilePath().toUtf8(), QCryptographicHash::Md5).toHex();
    return folder + u'/' + QString::fromLatin1(hash) + QStringLiteral(".png");
}

/// Where what comes with the program may lie: installed, or in the source.
QStringList foldersOf(const QString& what) {
    return {QCoreApplication::applicationDirPath() + QStringLiteral("/../share/imomushi/") + what, QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/") + what};
}
QStringList sampleFolders() { return foldersOf(QStringLiteral("samples")); }

}  // namespace

QStringList RecentFiles::paths() const { return QSettings().value(kKey).toStringList(); }

void RecentFiles::add(const QString& path) {
    const QString absolute = QFileInfo(path).absoluteFilePath();
    if (isSample(absolute)) return;  // they are on the start page anyway
    QStringList all = paths();
    all.removeAll(absolute);
    all.prepend(absolute);
    while (all.size() > kMax) QFile::remove(thumbnailPath(all.takeLast()));
    QSettings().setValue(kKey, all);
    Q_EMIT changed();
}

void RecentFiles::remove(const QString& path) {
    QStringList all = paths();
    all.removeAll(path);
    QSettings().setValue(kKey, all);
    QFile::remove(thumbnailPath(path));
    Q_EMIT changed();
}

QImage RecentFiles::thumbnail(const QString& path) const { return QImage(thumbnailPath(path)); }

QString RecentFiles::thumbnailFile(const QString& path) const { return thumbnailPath(path); }

QList<Sample> samples() {
    QList<Sample> found;
    for (const QString& folder : sampleFolders()) {
        for (const QFileInfo& file : QDir(folder).entryInfoList({QStringLiteral("*.imomushi")}, QDir::Files, QDir::Name)) {
            const QString base = file.absolutePath() + u'/' + file.completeBaseName(), script = base + QStringLiteral("/make.jsonl");
            found << Sample{file.completeBaseName(), file.absoluteFilePath(), base + QStringLiteral(".jpg"), QFileInfo::exists(script) ? script : QString()};
        }
        if (!found.isEmpty()) break;
    }
    return found;
}

bool isSample(const QString& path) {
    const QString folder = QFileInfo(path).canonicalPath();
    for (const QString& samplesIn : sampleFolders())
        if (!folder.isEmpty() && folder == QFileInfo(samplesIn).canonicalFilePath()) return true;
    return false;
}

QString manualFolder(const QString& language) {
    for (const QString& folder : foldersOf(QStringLiteral("manual/") + language))
        if (QDir(folder).exists()) return QDir::cleanPath(folder);
    return {};
}

}  // namespace imomushi
