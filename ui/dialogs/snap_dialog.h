// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>

#include "ui/tools/tool_kind.h"

namespace imomushi {

/// The steps of the grid and of angles that drags snap to.
class SnapDialog : public QDialog {
    Q_OBJECT
public:
    explicit SnapDialog(const SnapSettings& now, QWidget* parent = nullptr);

Q_SIGNALS:
    void changed(double step, double angleStep);  ///< m, 0: chosen by the view; radians
};

}  // namespace imomushi
