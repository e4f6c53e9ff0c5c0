// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/snap_dialog.h"

#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>
#include <numbers>

#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/number_field.h"

namespace imomushi {

SnapDialog::SnapDialog(const SnapSettings& now, QWidget* parent) : QDialog(parent) {
    setWindowTitle(tr("Steps to snap to"));
    setObjectName(QStringLiteral("snapDialog"));
    auto* form = new QFormLayout;
    form->setHorizontalSpacing(px(24));
    form->setVerticalSpacing(px(12));
    form->setLabelAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    const auto field = [&](const char* name, const QString& label, const NumberField::Spec& spec, double value) {
        auto* number = named(new NumberField(spec, this), name);
        number->setValue(value);
        number->setAccessibleName(label);
        form->addRow(label, number);
        return number;
    };
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    auto* step = field("gridStep", tr("Grid"), {.unit = QStringLiteral("m"), .low = 0.0, .high = SnapSettings::kLargestStep, .step = 0.001, .decimals = 4, .factor = 1.0, .standard = 0.0}, now.step);
    auto* angle = field("angleStep", tr("Angle"), {.unit = QStringLiteral("°"), .low = SnapSettings::kSmallestAngle, .high = SnapSettings::kLargestAngle, .step = 0.01, .decimals = 2, .factor = kDegrees, .standard = SnapSettings().angleStep}, now.angleStep);
    const auto tell = [this, step, angle] { Q_EMIT changed(step->value().value_or(0.0), angle->value().value_or(SnapSettings().angleStep)); };
    for (NumberField* number : {step, angle}) {
        connect(number, &NumberField::valueEdited, this, tell);
        connect(number, &NumberField::editEnded, this, tell);
    }
    auto* note = styled(new QLabel(tr("0 m: as fine as the view shows, in powers of ten."), this), "muted");
    note->setWordWrap(true);
    auto* buttons = new QDialogButtonBox(this);
    auto* close = buttons->addButton(tr("Close"), QDialogButtonBox::RejectRole);
    close->setAutoDefault(false);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::accept);
    fill(new QVBoxLayout(this), QMargins(px(20), px(18), px(20), px(16)), Spacing{px(16)}, form, note, buttons);
}

}  // namespace imomushi
