// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QString>
#include <vector>

#include "ui/jobs/repair_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

class FileFlow;

/// Mends meshes one after the other, each as one step, and says what was wrong before and after.
class RepairFlow : public QObject {
    Q_OBJECT
public:
    RepairFlow(StudioDocument& document, FileFlow& files, QObject* parent);
    [[nodiscard]] RepairJob& job() { return job_; }
    [[nodiscard]] QString subject() const;  ///< what is being mended

    /// Commands "repair". Those that wait are dropped where one is cancelled or fails.
    void start(std::vector<Json> commands);
    void cancel();

signals:
    void repaired(const QString& message);
    void unchanged(const QString& message);  ///< there was nothing to mend, or it was cancelled

private:
    void next();
    void finish();

    StudioDocument& document_;
    FileFlow& files_;
    RepairJob job_;
    std::vector<Json> waiting_;
};

}  // namespace imomushi
