// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/key_listener.h"

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QComboBox>
#include <QKeyEvent>
#include <QKeySequenceEdit>
#include <QLineEdit>
#include <QMenuBar>
#include <QPlainTextEdit>
#include <QTextEdit>
#include <algorithm>
#include <utility>

#include "core/input/key_names.h"
#include "core/input/key_port.h"
#include "ui/models/input_deck.h"

namespace imomushi {
namespace {

/// X11 and Wayland count the codes of Linux' drivers from here.
constexpr int kFirstScanCode = 8;

/// Where places are not told, as by keys that a program presses: what a US keyboard has there.
std::string usName(int key) {
    constexpr std::pair<int, const char*> kKeys[] = {{Qt::Key_Space, "space"}, {Qt::Key_Left, "left"}, {Qt::Key_Right, "right"}, {Qt::Key_Up, "up"}, {Qt::Key_Down, "down"}, {Qt::Key_Return, "enter"}, {Qt::Key_Tab, "tab"}, {Qt::Key_Backspace, "backspace"},
                                                    {Qt::Key_Comma, "comma"}, {Qt::Key_Period, "dot"}, {Qt::Key_Home, "home"}, {Qt::Key_End, "end"}, {Qt::Key_PageUp, "page-up"}, {Qt::Key_PageDown, "page-down"}};
    if ((key >= Qt::Key_0 && key <= Qt::Key_9) || (key >= Qt::Key_A && key <= Qt::Key_Z)) return {char(key >= Qt::Key_A ? key - Qt::Key_A + 'a' : key)};
    if (key >= Qt::Key_F1 && key <= Qt::Key_F12) return "f" + std::to_string(key - Qt::Key_F1 + 1);
    const auto* found = std::find_if(std::begin(kKeys), std::end(kKeys), [&](const auto& k) { return k.first == key; });
    return found == std::end(kKeys) ? std::string() : found->second;
}

/// Empty: it has no name.
std::string nameOf(const QKeyEvent& key) {
    const int code = int(key.nativeScanCode()) - kFirstScanCode;
    if (code <= 0) return usName(key.key());
    return std::string(keyName(code).value_or(""));
}

bool typesWords() {
    const QWidget* focus = QApplication::focusWidget();
    const auto* box = qobject_cast<const QComboBox*>(focus);
    return (box && box->isEditable()) || qobject_cast<const QLineEdit*>(focus) || qobject_cast<const QAbstractSpinBox*>(focus) || qobject_cast<const QKeySequenceEdit*>(focus) || qobject_cast<const QTextEdit*>(focus) ||
           qobject_cast<const QPlainTextEdit*>(focus) || qobject_cast<const QMenuBar*>(focus);
}

}  // namespace

KeyListener::KeyListener(QWidget& window, InputDeck& inputs, std::function<bool()> typing) : QObject(&inputs), window_(window), inputs_(inputs), typing_(std::move(typing)) { qApp->installEventFilter(this); }

bool KeyListener::takes(const QKeyEvent& key, const std::string& name) const {
    if (key.modifiers() & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier | Qt::ShiftModifier)) return false;
    return window_.isActiveWindow() && !QApplication::activeModalWidget() && !QApplication::activePopupWidget() && (inputs_.wantsKey(name) || leavesTake(name)) && !typesWords() && !typing_();
}

bool KeyListener::leavesTake(const std::string& name) const {
    const QWidget* focus = QApplication::focusWidget();
    const bool used = qobject_cast<const QAbstractSlider*>(focus) || qobject_cast<const QAbstractItemView*>(focus) || qobject_cast<const QAbstractButton*>(focus);
    return inputs_.waits() == InputDeck::Waits::Take && !used && name != "space" && inputs_.drivesByKey(name);
}

bool KeyListener::endsLearning(const QKeyEvent& key) const {
    return key.key() == Qt::Key_Escape && key.modifiers() == Qt::NoModifier && inputs_.learning() && window_.isActiveWindow() && !QApplication::activeModalWidget() && !QApplication::activePopupWidget();
}

bool KeyListener::holds(const std::string& name) const { return std::find(held_.begin(), held_.end(), name) != held_.end(); }

void KeyListener::letGo() {
    for (const std::string& name : std::exchange(held_, {})) KeyBoard::say(name, false);
}

bool KeyListener::eventFilter(QObject* watched, QEvent* event) {
    switch (event->type()) {
        case QEvent::ShortcutOverride: {
            const auto& key = static_cast<const QKeyEvent&>(*event);
            const std::string name = nameOf(key);
            if (!holds(name) && !endsLearning(key) && !takes(key, name)) break;
            event->accept();  // no shortcut
            return true;
        }
        case QEvent::KeyPress: {
            const auto& key = static_cast<const QKeyEvent&>(*event);
            if (endsLearning(key)) {
                inputs_.stopLearning();
                return true;
            }
            const std::string name = nameOf(key);
            const bool held = holds(name);
            if (!held && !takes(key, name)) break;
            if (!held && !key.isAutoRepeat()) {  // a key that was down before is no press
                held_.push_back(name);
                if (leavesTake(name) || (inputs_.waits() == InputDeck::Waits::LetGo && inputs_.drivesByKey(name))) inputs_.goOn();  // who presses a key means it
                KeyBoard::say(name, true);
            }
            return true;
        }
        case QEvent::KeyRelease: {
            const auto& key = static_cast<const QKeyEvent&>(*event);
            const std::string name = nameOf(key);
            if (!holds(name)) break;
            if (!key.isAutoRepeat()) {
                std::erase(held_, name);
                KeyBoard::say(name, false);
            }
            return true;
        }
        case QEvent::WindowDeactivate:
            if (watched == &window_) letGo();
            break;
        default: break;
    }
    return QObject::eventFilter(watched, event);
}

}  // namespace imomushi
