// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <vector>

#include "ui/models/studio_document.h"

namespace imomushi {

class FileFlow;
class StepFlow;

/// Builds a sample before the artist's eyes, in a new project: the commands of its script one after another, each a step of the history as if it had been done by hand. The artist may pause it,
/// look, change and go on; wherever it stops, the project is one as any other.
class ReplayFlow : public QObject {
    Q_OBJECT
public:
    ReplayFlow(StudioDocument& document, FileFlow& files, StepFlow& steps, QObject* parent);
    /// `script`: of the sample, one command a line; files are found beside it. What is not saved is asked about first. False: it did not begin.
    bool start(const QString& title, const QString& script);
    void setPaused(bool paused);
    void stop();
    [[nodiscard]] bool running() const { return running_; }
    [[nodiscard]] bool paused() const { return paused_; }
    [[nodiscard]] const QString& title() const { return title_; }
    [[nodiscard]] int done() const { return done_; }
    [[nodiscard]] int count() const { return int(commands_.size()); }
    /// What was done last, translated.
    [[nodiscard]] QString last() const;
    /// Between steps, so that each is seen, ms.
    void setPace(int ms) { pace_ = ms; }

Q_SIGNALS:
    void changed();
    void built();             ///< something came that is to be seen whole
    void precomputeWanted();  ///< its last step
    void ended(const QString& title);

private:
    void next();
    void finish();

    StudioDocument& document_;
    FileFlow& files_;
    StepFlow& steps_;
    QString title_;
    std::vector<Json> commands_;
    int done_ = 0, pace_ = -1;
    bool running_ = false, paused_ = false, waiting_ = false;
    bool precomputes_ = false;
    QTimer timer_;
};

}  // namespace imomushi
