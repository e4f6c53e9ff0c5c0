// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFormLayout>

namespace imomushi {

/// Rows of choices in a dialog: a quiet label, which names its field to screen readers too, and the field.
class DialogForm : public QFormLayout {
public:
    DialogForm();
    void add(const QString& label, QWidget* field);
    /// Below the fields, where it says itself what it is.
    void add(QWidget* field) { addRow(QString(), field); }
};

}  // namespace imomushi
