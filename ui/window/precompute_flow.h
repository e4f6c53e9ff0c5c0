// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "ui/jobs/draft_job.h"
#include "ui/jobs/estimate_job.h"
#include "ui/jobs/precompute_job.h"

namespace imomushi {

/// Runs precomputes in the background. Drafts start by themselves; the full precompute follows by itself if it is estimated at 10 s or less; start() runs it on request.
class PrecomputeFlow : public QObject {
    Q_OBJECT
public:
    /// `busy`: a gesture goes on in the view.
    PrecomputeFlow(StudioDocument& document, std::function<bool()> busy, QObject* parent);
    ~PrecomputeFlow() override;
    [[nodiscard]] PrecomputeJob& job() { return *precompute_; }
    [[nodiscard]] DraftJob& drafts() { return *drafts_; }
    [[nodiscard]] EstimateJob& estimates() { return *estimates_; }

    /// What somebody asks for.
    void start();
    void cancel();

signals:
    void started();
    void done(const QString& message);
    void said(const QString& message);    ///< it was cancelled, or there was nothing to do
    void warned(const QString& message);
    void keptSome();                      ///< responses came that no file has

private:
    void finish(bool completed);
    /// What has a draft is precomputed as it is set, where that does not take long.
    void followDrafts();

    std::function<bool()> busy_;
    PrecomputeJob* precompute_;
    DraftJob* drafts_;
    EstimateJob* estimates_;
    bool failed_ = false;
    bool byItself_ = false;          // the precompute that runs follows drafts: nobody asked for it
    bool followsDrafts_ = false;     // once it is known what a precompute costs
    bool draftedMeanwhile_ = false;  // while it precomputed: there is more to do
};

}  // namespace imomushi
