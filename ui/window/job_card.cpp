// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/job_card.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/jobs/background_job.h"
#include "ui/jobs/progress_text.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {

JobCard::JobCard(QWidget* parent) : QFrame(parent) {
    setObjectName(QStringLiteral("card"));
    title_ = new QLabel(this);
    detail_ = styled(new QLabel(this), "muted");
    bar_ = new QProgressBar(this);
    bar_->setTextVisible(false);
    bar_->setRange(0, 1000);
    cancel_ = new QToolButton(this);
    cancel_->setProperty("small", true);
    cancel_->setIcon(themedIcon(QStringLiteral("close"), Appearance::Role::Text));
    cancel_->setToolTip(tr("Cancel"));
    cancel_->setAccessibleName(tr("Cancel"));
    auto* top = fill(new QHBoxLayout, Share{title_, 1}, detail_, cancel_);
    fill(new QVBoxLayout(this), QMargins(px(14), px(8), px(10), px(12)), Spacing{px(7)}, top, bar_);
    hide();
}

void JobCard::follow(BackgroundJob* job, std::function<QString()> title) {
    const auto show = [this, job, title = std::move(title)] {
        if (!job->running()) return;
        title_->setText(title());
        detail_->setText(progressText(*job));
        bar_->setValue(int(1000.0 * job->fraction()));
        setVisible(true);
    };
    connect(job, &BackgroundJob::progressed, this, show);
    connect(job, &BackgroundJob::finished, this, [this] { setVisible(false); });
    connect(cancel_, &QToolButton::clicked, job, &BackgroundJob::cancel);
}

void JobCard::changeEvent(QEvent* event) {
    QFrame::changeEvent(event);
    if (event->type() != QEvent::LanguageChange) return;
    cancel_->setToolTip(tr("Cancel"));
    cancel_->setAccessibleName(tr("Cancel"));
}

}  // namespace imomushi
