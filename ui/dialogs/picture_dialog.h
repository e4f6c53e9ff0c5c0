// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>

#include "ui/viewport/viewport_widget.h"

class QCheckBox;
class QSpinBox;

namespace imomushi {

/// Asks how large a picture of the view is to be, and what it shows. What was chosen is kept, but for the size.
class PictureDialog : public QDialog {
    Q_OBJECT
public:
    /// `size`: of the view, pixels.
    PictureDialog(QSize size, QWidget* parent);
    [[nodiscard]] ViewportWidget::Picture picture() const;

private:
    QSpinBox *width_, *height_;
    QCheckBox *transparent_, *markers_, *ground_;
};

}  // namespace imomushi
