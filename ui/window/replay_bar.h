// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFrame>

class QLabel;
class QProgressBar;
class QPushButton;

namespace imomushi {

class ReplayFlow;

/// How far a replay is, what it did last, and its pause and stop: over the view while one goes on.
class ReplayBar : public QFrame {
    Q_OBJECT
public:
    ReplayBar(ReplayFlow& replay, QWidget* parent);

protected:
    void changeEvent(QEvent* event) override;

private:
    void follow();

    ReplayFlow& replay_;
    QLabel *title_, *last_;
    QProgressBar* bar_;
    QPushButton *pause_, *stop_;
};

}  // namespace imomushi
