// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <QMessageBox>

namespace imomushi {

class ActionSet;

/// What mouse buttons and all keys do, as they are set now. `blenderNavigation`: the view is turned as in Blender, else as in Maya.
class ControlsDialog : public QDialog {
    Q_OBJECT
public:
    ControlsDialog(const ActionSet& actions, bool blenderNavigation, QWidget* parent);
};

/// Name, version and licence.
class AboutDialog : public QMessageBox {
    Q_OBJECT
public:
    explicit AboutDialog(QWidget* parent);
};

}  // namespace imomushi
