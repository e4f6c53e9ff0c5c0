// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/precompute_flow.h"

#include <QTimer>
#include <utility>

namespace imomushi {
namespace {

constexpr int kAskAgainMs = 500;  // whether a gesture is over
constexpr double kSoon = 10.0;    // s, of a precompute that follows drafts by itself

}  // namespace

PrecomputeFlow::PrecomputeFlow(StudioDocument& document, std::function<bool()> busy, QObject* parent) : QObject(parent), busy_(std::move(busy)) {
    precompute_ = new PrecomputeJob(document, this);
    drafts_ = new DraftJob(document, this);
    estimates_ = new EstimateJob(document, [this] { return drafts_->running(); }, this);
    connect(precompute_, &PrecomputeJob::elementFailed, this, [this](const QString& element, const QString& message) {
        failed_ = true;
        Q_EMIT warned(tr("%1: %2", "element, what went wrong").arg(element, message));
    });
    connect(precompute_, &BackgroundJob::finished, this, &PrecomputeFlow::finish);
    connect(drafts_, &DraftJob::drafting, this, [this] {
        if (byItself_) precompute_->cancel();  // it would hold the draft up
    });
    connect(drafts_, &DraftJob::drafted, this, &PrecomputeFlow::followDrafts);
    connect(drafts_, &BackgroundJob::finished, estimates_, &EstimateJob::ask);
    connect(estimates_, &EstimateJob::estimated, this, [this] {
        if (followsDrafts_) followDrafts();
    });
}

PrecomputeFlow::~PrecomputeFlow() {
    delete precompute_;
    delete estimates_;
    delete drafts_;
}

void PrecomputeFlow::start() {
    failed_ = byItself_ = false;
    if (!precompute_->start()) Q_EMIT said(tr("Everything is precomputed already."));
    Q_EMIT started();
}

void PrecomputeFlow::cancel() {
    precompute_->cancel();
    drafts_->cancel();
}

void PrecomputeFlow::finish(bool completed) {
    const int kept = precompute_->kept();
    if (kept > 0) Q_EMIT keptSome();
    if (!std::exchange(byItself_, false)) {  // else nobody asked: only failures are told
        if (!completed) Q_EMIT said(kept > 0 ? tr("Precompute cancelled; %n element(s) were done and are kept.", nullptr, kept) : tr("Precompute cancelled"));
        else if (!failed_) Q_EMIT done(tr("Precomputed. Drag the end of a bone or a handle with the drag tool (D)."));
    }
    if (std::exchange(draftedMeanwhile_, false) && completed) followDrafts();
}

void PrecomputeFlow::followDrafts() {
    // A passing handle is gone soon, and all is as it was.
    if (busy_()) return QTimer::singleShot(kAskAgainMs, this, &PrecomputeFlow::followDrafts);
    draftedMeanwhile_ = precompute_->running();
    followsDrafts_ = !draftedMeanwhile_ && !estimates_->latest();
    if (followsDrafts_) return estimates_->ask();
    if (draftedMeanwhile_ || estimates_->latest()->precompute.seconds > kSoon) return;
    failed_ = false;
    byItself_ = precompute_->start();
    Q_EMIT started();
}

}  // namespace imomushi
