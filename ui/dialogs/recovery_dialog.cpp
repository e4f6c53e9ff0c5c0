// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/recovery_dialog.h"

#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {

RecoveryDialog::RecoveryDialog(const QList<Autosave::Found>& found, QWidget* parent) : QDialog(parent) {
    setWindowTitle(tr("Unsaved work"));
    auto* question = new QLabel(tr("Imomushi ended before this was saved. Go on where you were?"), this);
    question->setWordWrap(true);

    list_ = new QListWidget(this);
    list_->setAccessibleName(tr("Unsaved work"));
    const QLocale locale;
    for (int i = 0; i < found.size(); ++i) {
        const auto& one = found.at(i);
        const QString name = one.original.isEmpty() ? tr("New project, never saved") : QFileInfo(one.original).completeBaseName();
        const QString text = tr("%1 · %2", "name, date and time").arg(name, locale.toString(one.time, QLocale::ShortFormat));
        auto* item = new QListWidgetItem(one.outdated ? tr("%1 · older than the saved file", "name, date and time").arg(text) : text, list_);
        item->setData(kOutdated, one.outdated);
        item->setData(Qt::UserRole, i);
        item->setToolTip(one.original);
    }
    list_->setCurrentRow(0);
    list_->setSizeAdjustPolicy(QAbstractScrollArea::AdjustToContents);
    list_->setMinimumSize(px(380), px(std::min(16 + 44 * int(found.size()), 300)));
    connect(list_, &QListWidget::itemActivated, this, &QDialog::accept);

    auto* row = new QHBoxLayout;
    auto* throwAway = new QPushButton(tr("Delete"), this);
    auto* later = new QPushButton(tr("Not now"), this);
    auto* recover = new QPushButton(tr("Recover"), this);
    recover->setDefault(true);
    for (auto* button : {throwAway, later}) button->setAutoDefault(false);
    fill(row, throwAway, Stretch{}, later, recover);
    fill(new QVBoxLayout(this), QMargins(px(22), px(20), px(22), px(18)), Spacing{px(14)}, question, list_, row);
    connect(recover, &QPushButton::clicked, this, &QDialog::accept);
    connect(later, &QPushButton::clicked, this, &QDialog::reject);
    connect(throwAway, &QPushButton::clicked, this, [this, found] {
        if (!list_->currentItem()) return;
        Autosave::discard(found.at(chosen()));
        delete list_->currentItem();
        if (list_->count() == 0) reject();
    });
}

int RecoveryDialog::chosen() const { return list_->currentItem()->data(Qt::UserRole).toInt(); }

}  // namespace imomushi
