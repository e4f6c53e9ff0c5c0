// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QTimer>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "core/base/progress.h"

namespace imomushi {

/// Work on a thread of its own that reports progress and can be given up at once. Belongs to the GUI thread.
class BackgroundJob : public QObject {
    Q_OBJECT
public:
    explicit BackgroundJob(QObject* parent = nullptr);
    /// Gives the work up and waits until its thread has noticed.
    ~BackgroundJob() override;

    [[nodiscard]] bool running() const { return running_; }
    /// Asks the work to stop. finished(false) comes at once; the thread ends by itself and what it made is dropped.
    void cancel();

    [[nodiscard]] QString stage() const { return stage_; }     ///< translated
    [[nodiscard]] double fraction() const { return fraction_; } ///< 0...1
    /// Seconds that are still needed, by what passed so far; negative while unknown.
    [[nodiscard]] double secondsLeft() const;

signals:
    void progressed();                ///< at most 5 times a second while running, and when the work has ended
    void finished(bool completed);    ///< false: cancelled, or failed; Failures says why

protected:
    /// Runs `work` on a new thread, then `done` on the GUI thread unless cancelled. `work` shares nothing with the GUI thread but what it captured. What one of
    /// them throws ends it like a cancel; then `failed` runs.
    void launch(std::function<void(const Progress&)> work, std::function<void()> done, std::function<void()> failed = {});
    /// About 20 times a second while running, and once when the work has ended: takes what is done so far.
    virtual void takeDone() {}

private:
    // What the thread and the GUI share; outlives the job while the thread still runs.
    struct Shared {
        std::mutex mutex;
        std::string stage;
        double fraction = 0.0;
        bool ended = false;
        std::exception_ptr failure;
    };
    void poll();

    std::shared_ptr<Shared> shared_;
    std::jthread thread_;
    /// Work that was given up and may not have noticed. The next work waits for it, so that one at most does work; the window waits for none.
    std::jthread abandoned_;
    std::function<void()> done_, failed_;
    QTimer timer_;
    QElapsedTimer clock_, told_;
    QString stage_;
    double fraction_ = 0.0;
    bool running_ = false;
};

}  // namespace imomushi
