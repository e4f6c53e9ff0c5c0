// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QKeyEvent>
#include <functional>

namespace imomushi {

/// Delete, Backspace and F2 are for a list of names while it has the focus, not for what is selected in the view: for its event filter. `remove` is called for the first two; F2 goes on to the list, which renames.
/// True: the event goes no further.
inline bool takeListKey(QEvent& event, const std::function<void()>& remove) {
    if (event.type() != QEvent::ShortcutOverride && event.type() != QEvent::KeyPress) return false;
    const int key = static_cast<QKeyEvent&>(event).key();
    const bool removes = key == Qt::Key_Delete || key == Qt::Key_Backspace;
    if (!removes && key != Qt::Key_F2) return false;
    event.accept();
    if (event.type() == QEvent::ShortcutOverride) return true;
    if (removes) remove();
    return removes;
}

}  // namespace imomushi
