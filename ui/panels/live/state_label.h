// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QLabel>
#include <QStyle>

#include "ui/widgets/layouts.h"

namespace imomushi {

/// How a source or a receiver is, below its row, in the colour of a warning where something is wrong; without words it is hidden.
inline void showState(QLabel& label, const QString& text, bool troubled) {
    const char* role = troubled ? "warning" : "muted";
    if (label.property("role").toString() != QLatin1String(role)) {
        styled(&label, role);
        label.style()->polish(&label);
    }
    if (label.text() != text) label.setText(text);
    label.setVisible(!text.isEmpty());
}

}  // namespace imomushi
