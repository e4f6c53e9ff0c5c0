// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QTimer>
#include <QWidget>

#include "ui/jobs/pose_error_job.h"
#include "ui/models/studio_document.h"

class QComboBox;
class QLabel;
class QPushButton;

namespace imomushi {

class AccuracyBody;
struct AccuracyStudy;

/// The error of the character as it is set now as colours on its body, beside the full solution: in a pose of the study, or in the pose of now. For that the full solution
/// is solved in the background when asked for, and kept, so that the colours then follow the pose wherever that takes a moment.
class AccuracyErrors : public QWidget {
    Q_OBJECT
public:
    explicit AccuracyErrors(StudioDocument& document, QWidget* parent = nullptr);
    /// The study must stay as long as this, or until the next call. `outdated`: it is of another character.
    void setStudy(const AccuracyStudy& study, bool outdated);
    [[nodiscard]] PoseErrorJob& job() { return *job_; }
    /// About how long the full solution of the pose of now may take, s; 0: as long as it takes.
    void setLimit(double seconds) { limit_ = seconds; }
    /// Of the pose of now; the character may have moved since.
    [[nodiscard]] const std::optional<PoseErrors>& errors() const { return job_->errors(); }

protected:
    void changeEvent(QEvent* event) override;
    void showEvent(QShowEvent* event) override;

private:
    void retranslate();
    void fillPoses();
    [[nodiscard]] int pose() const;  ///< of the study, -1: that of now
    void measure();
    void characterChanged();
    void moved();
    void refresh();
    void showPoseOfNow();
    void showPoseOfStudy(int pose);

    StudioDocument& document_;
    const AccuracyStudy* study_ = nullptr;
    bool outdated_ = true, moved_ = false;
    ContentKey solved_;  ///< of the last measure()
    double limit_ = 0.0;
    PoseErrorJob* job_;
    ReferenceCostJob* cost_;
    QTimer follow_, changed_;
    QLabel *label_, *text_;
    QComboBox* poses_;
    QPushButton* measure_;
    AccuracyBody* body_;
};

}  // namespace imomushi
