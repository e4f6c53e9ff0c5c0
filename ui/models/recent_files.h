// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QImage>
#include <QObject>
#include <QStringList>

namespace imomushi {

/// The projects that were opened or saved last, with small pictures of them; kept in QSettings and in the cache folder of the user.
class RecentFiles : public QObject {
    Q_OBJECT
public:
    using QObject::QObject;
    [[nodiscard]] QStringList paths() const;  ///< newest first
    void add(const QString& path);
    void remove(const QString& path);

    static constexpr QSize kThumbnail{480, 300};  ///< pixels, in the shape of the tiles of the start page
    [[nodiscard]] QImage thumbnail(const QString& path) const;  ///< null: none
    /// Where the small picture of a project belongs; its folder is there.
    [[nodiscard]] QString thumbnailFile(const QString& path) const;
    void thumbnailDrawn() { Q_EMIT changed(); }

signals:
    void changed();
};

/// The projects that come with the program: installed, or in the source tree it was built from.
struct Sample {
    QString name;  ///< of the file, without suffix
    QString path;
    QString picture;  ///< a JPEG file beside it
    QString script;   ///< that builds it, one command a line; empty: it is not there
};
QList<Sample> samples();
/// The pages of the manual in a language ("en", "ja"); empty: they are not there.
QString manualFolder(const QString& language);
[[nodiscard]] bool isSample(const QString& path);

}  // namespace imomushi
