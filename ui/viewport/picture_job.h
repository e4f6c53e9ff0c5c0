// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QSize>
#include <QString>
#include <functional>

#include "core/base/result.h"
#include "ui/jobs/background_job.h"
#include "ui/render/scene.h"

namespace imomushi {

/// Draws a scene beside the window, as a PNG file.
class PictureJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    /// Errors: "no-opengl", "bad-size", "out-of-memory", "not-writable", "disk-full".
    using Done = std::function<void(const Result<void>&)>;

    /// `scene`: what it points to is copied; the processor deforms it (without a `deformInput`). `size`: pixels. `crop`: so much of the middle of the picture is kept; none: all of it. `done` is not
    /// called where it is cancelled. What was being drawn is given up.
    void start(const render::Scene& scene, QSize size, const QString& path, Done done, QSize crop = {});
};

}  // namespace imomushi
