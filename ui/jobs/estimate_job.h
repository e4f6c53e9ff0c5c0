// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QTimer>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "ui/jobs/background_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// What precomputing all elements that are not fresh would cost on this machine.
struct PrecomputeEstimate {
    int elements = 0;
    double seconds = 0.0;
    double bytes = 0.0;
};

struct Estimates {
    PrecomputeEstimate precompute;
    std::array<EffectCost, kEffects> effects;
    std::map<PartId, StudioDocument::Estimate> elements;  ///< for StudioDocument
};

/// Estimates in the background what everything costs, after each change: solver meshes are made for it, which takes tenths of a second.
class EstimateJob : public BackgroundJob {
    Q_OBJECT
public:
    /// `waits`: something more urgent runs; ask() when it is done.
    EstimateJob(StudioDocument& document, std::function<bool()> waits, QObject* parent = nullptr);

    /// Of the document as it is now; none: not known yet.
    [[nodiscard]] const std::optional<Estimates>& latest() const { return latest_; }
    /// Where the latest is none: begins soon.
    void ask();

signals:
    void estimated();  ///< latest() is there

private:
    struct Work;
    void forget();
    void start();

    StudioDocument& document_;
    std::function<bool()> waits_;
    std::shared_ptr<Work> work_;  ///< remembers what was estimated before
    std::optional<Estimates> latest_;
    bool again_ = false;  ///< the document has changed since the run began
    QTimer soon_;
};

}  // namespace imomushi
