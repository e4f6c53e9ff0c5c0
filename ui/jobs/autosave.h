// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDateTime>
#include <QList>
#include <QString>
#include <QTimer>
#include <memory>
#include <optional>

#include "core/base/file_lock.h"
#include "ui/jobs/background_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// Keeps a copy of work that is not saved, for the next start should this one end badly: every kMinutes while there are changes, and when asked to. A copy is a whole
/// project file, written in the background; it goes away when the work is saved or given up. Each studio has its own, marked by a lock that ends with its process.
class Autosave : public BackgroundJob {
    Q_OBJECT
public:
    static constexpr int kMinutes = 2;

    /// folder: of all copies of this user, made when needed.
    Autosave(StudioDocument& document, QString folder, QObject* parent = nullptr);
    ~Autosave() override;

    /// Writes what changed since the last copy, in the background. finished() tells.
    void saveSoon();
    /// There is a copy of this session on the disk.
    [[nodiscard]] bool kept() const;

    /// Work that a studio left behind which is no more. Holding it keeps others from offering it too.
    struct Found {
        QString file;       ///< the copy
        QString original;   ///< the project that it is of, empty: never saved
        QDateTime time;
        bool outdated = false;  ///< the project was saved later
        std::shared_ptr<FileLock> lock;
    };
    [[nodiscard]] QList<Found> found() const;  ///< newest first
    /// What is in the document is this work: it goes when there is a copy of its own.
    void takeUp(const Found& found);
    static void discard(const Found& found);

signals:
    void failed(const QString& message);  ///< once, until it works again

private:
    void clear();

    StudioDocument& document_;
    QString folder_, file_;
    std::unique_ptr<FileLock> lock_;
    std::optional<Found> takenUp_;
    QTimer timer_;
    bool changed_ = false, failureTold_ = false;
};

}  // namespace imomushi
