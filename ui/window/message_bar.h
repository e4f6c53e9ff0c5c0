// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFrame>
#include <QTimer>
#include <functional>

class QBoxLayout;
class QLabel;
class QPushButton;
class QToolButton;

namespace imomushi {

/// One calm line over the viewport: what went wrong or what was done. Goes by itself; never stops the work.
class MessageBar : public QFrame {
    Q_OBJECT
public:
    enum class Tone { Info, Good, Warning };
    explicit MessageBar(QWidget* parent);
    void say(const QString& text, Tone tone);
    /// With one thing to do about it, at a click.
    void offer(const QString& text, const QString& label, std::function<void()> action);
    /// Takes back what is no longer so, where it is still seen.
    void withdraw(const QString& text);
    [[nodiscard]] QString text() const;

protected:
    void enterEvent(QEnterEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void leaveEvent(QEvent* event) override;
    void changeEvent(QEvent* event) override;

private:
    QLabel* icon_;
    QLabel* text_;
    QBoxLayout* words_;  // the text, and beside it or below it the button
    QPushButton* action_;
    QToolButton* close_;
    std::function<void()> act_;
    QTimer timer_;
};

}  // namespace imomushi
