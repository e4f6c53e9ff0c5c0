// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFrame>
#include <functional>

class QLabel;
class QProgressBar;
class QToolButton;

namespace imomushi {

class BackgroundJob;

/// A job in the background: what it does, how far it is, how long it still takes, and a way to stop it.
class JobCard : public QFrame {
    Q_OBJECT
public:
    explicit JobCard(QWidget* parent);
    /// Shown while `job` runs. `title` is asked again with each progress.
    void follow(BackgroundJob* job, std::function<QString()> title);

protected:
    void changeEvent(QEvent* event) override;

private:
    QLabel* title_;
    QLabel* detail_;
    QProgressBar* bar_;
    QToolButton* cancel_;
};

}  // namespace imomushi
