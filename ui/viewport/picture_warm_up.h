// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/jobs/background_job.h"

namespace imomushi {

/// The first picture that is drawn without a window: it begins with an OpenGL context and programs that are compiled, where the processor draws for seconds. One for the process.
class PictureWarmUp : public BackgroundJob {
    Q_OBJECT
public:
    static PictureWarmUp& instance();
    [[nodiscard]] bool done() const { return done_; }
    /// Unless it was begun.
    void begin();

private:
    using BackgroundJob::BackgroundJob;
    bool done_ = false;
};

}  // namespace imomushi
