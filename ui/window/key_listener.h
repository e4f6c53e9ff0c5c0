// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <functional>
#include <string>
#include <vector>

class QKeyEvent;
class QWidget;

namespace imomushi {

class InputDeck;

/// Gives keys to live input (KeyBoard) where InputDeck wants them, while the window is in front and nobody types words or numbers. Such a key does nothing else. What is held is let go when the
/// window goes to the back. Escape ends learning.
class KeyListener : public QObject {
public:
    /// `typing`: keys belong to a drag without a button.
    KeyListener(QWidget& window, InputDeck& inputs, std::function<bool()> typing);
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    [[nodiscard]] bool takes(const QKeyEvent& key, const std::string& name) const;
    /// A take is shown, and a key that drives something leaves it: not where the time bar, a list or a button has the focus, nor the key that plays and stops it.
    [[nodiscard]] bool leavesTake(const std::string& name) const;
    [[nodiscard]] bool holds(const std::string& name) const;
    void letGo();
    /// While somebody learns, whatever has the focus.
    [[nodiscard]] bool endsLearning(const QKeyEvent& key) const;

    QWidget& window_;
    InputDeck& inputs_;
    std::function<bool()> typing_;
    std::vector<std::string> held_;
};

}  // namespace imomushi
