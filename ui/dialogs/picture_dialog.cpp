// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/picture_dialog.h"

#include <QCheckBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QPushButton>
#include <QSettings>
#include <QSpinBox>
#include <QVBoxLayout>

#include "ui/render/offscreen.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {

PictureDialog::PictureDialog(QSize size, QWidget* parent) : QDialog(parent) {
    setWindowTitle(tr("Save a picture"));
    setObjectName(QStringLiteral("pictureDialog"));
    auto* form = new QFormLayout;
    form->setHorizontalSpacing(px(24));
    form->setVerticalSpacing(px(12));
    form->setLabelAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    const auto side = [&](const char* name, const QString& label, int now) {
        auto* box = named(new QSpinBox(this), name);
        box->setRange(1, render::kLargestSide);
        box->setButtonSymbols(QAbstractSpinBox::NoButtons);
        box->setSuffix(tr(" px", "pixels"));
        box->setValue(now);
        box->setAccessibleName(label);
        form->addRow(label, box);
        return box;
    };
    width_ = side("pictureWidth", tr("Width"), size.width());
    height_ = side("pictureHeight", tr("Height"), size.height());
    const auto choice = [&](const char* name, const QString& label, bool usual) {
        auto* box = named(new QCheckBox(label, this), name);
        const QString key = QStringLiteral("picture/") + QLatin1String(name);
        box->setChecked(QSettings().value(key, usual).toBool());
        connect(box, &QCheckBox::toggled, this, [key](bool on) { QSettings().setValue(key, on); });
        form->addRow(box);
        return box;
    };
    transparent_ = choice("transparent", tr("Transparent background"), false);
    ground_ = choice("ground", tr("Ground and its shadow"), true);
    markers_ = choice("markers", tr("Bones and handles, where they are shown"), false);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel, this);
    auto* save = named(buttons->addButton(tr("Save…"), QDialogButtonBox::AcceptRole), "savePicture");
    save->setDefault(true);
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    fill(new QVBoxLayout(this), QMargins(px(20), px(18), px(20), px(16)), Spacing{px(16)}, form, buttons);
}

ViewportWidget::Picture PictureDialog::picture() const { return {QSize(width_->value(), height_->value()), transparent_->isChecked(), markers_->isChecked(), ground_->isChecked()}; }

}  // namespace imomushi
