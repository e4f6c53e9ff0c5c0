// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/dialog_form.h"

#include <QLabel>

#include "ui/widgets/appearance.h"

namespace imomushi {

DialogForm::DialogForm() {
    setHorizontalSpacing(px(14));
    setVerticalSpacing(px(9));
    setLabelAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
}

void DialogForm::add(const QString& label, QWidget* field) {
    auto* text = new QLabel(label);
    text->setProperty("role", "muted");
    text->setBuddy(field);
    field->setAccessibleName(label);
    addRow(text, field);
}

}  // namespace imomushi
