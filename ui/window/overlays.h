// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QFrame>
#include <QList>

namespace imomushi {

class JobCard;
class MessageBar;

/// What lies over the lower edge of the view: the card of a running job in the corner, and above it, in the middle, the message bar.
class Overlays : public QObject {
    Q_OBJECT
public:
    explicit Overlays(QWidget* view);
    [[nodiscard]] MessageBar& message() { return *message_; }
    [[nodiscard]] JobCard& job() { return *job_; }
    /// Another one, above those that are there.
    void add(QFrame* overlay);
    void place();
    /// Nothing of it is seen: it goes on behind the view.
    void setCovered(bool covered);

    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    QWidget* view_;
    MessageBar* message_;
    JobCard* job_;
    QList<QFrame*> all_;  ///< from the edge upwards
    bool covered_ = false;
};

}  // namespace imomushi
