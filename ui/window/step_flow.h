// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <deque>
#include <functional>

#include "ui/jobs/step_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// Executes commands that take their time without holding up the window: the work is done in the background, on a copy of the document, and what comes of it is one step, taken over
/// at once. Where the document has changed meanwhile it is done anew.
class StepFlow : public QObject {
    Q_OBJECT
public:
    /// `busy`: a gesture is open, which is not disturbed.
    StepFlow(StudioDocument& document, std::function<bool()> busy, QObject* parent);
    [[nodiscard]] StepJob& job() { return job_; }
    [[nodiscard]] QString title() const;
    [[nodiscard]] bool running() const { return !waiting_.empty(); }

    /// After those that are being done.
    void start(SlowStep step);
    /// Gives up what is being done and what waits.
    void cancel();
    /// The same without a word: whoever asks for it does something else.
    void giveUp();
    /// No command was executed since the last one of them was asked for.
    [[nodiscard]] bool isLatest() const { return !waiting_.empty() && waiting_.back().position == document_.session().position(); }
    /// Gives up the one that was asked for last.
    void cancelLatest();

signals:
    void changed();    ///< running() may be another
    void cancelled();

private:
    void tell();
    void next();
    void finish();

    StudioDocument& document_;
    std::function<bool()> busy_;
    StepJob job_;
    QTimer later_;
    struct Waiting {
        SlowStep step;
        int position = 0;  ///< of the history when it was asked for, or when one before it was done
    };
    std::deque<Waiting> waiting_;
    int tries_ = 0;
    bool quiet_ = false;
    bool takingOver_ = false;  // what follows a step may ask for another
    Document begun_;           // that the job works on
};

}  // namespace imomushi
