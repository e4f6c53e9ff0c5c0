// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/versions_dialog.h"

#include <QDateTime>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {

VersionsDialog::VersionsDialog(const std::vector<ProjectVersion>& versions, const QString& project, QWidget* parent) : QDialog(parent) {
    setWindowTitle(tr("Versions of “%1”").arg(project));
    auto* text = new QLabel(versions.empty() ? tr("A version is kept whenever a saved project is saved again. There is none yet.")
                                             : tr("As it was saved. A version opens as an unsaved copy; the project stays as it is."),
                            this);
    text->setWordWrap(true);

    list_ = new QListWidget(this);
    list_->setAccessibleName(tr("Versions"));
    for (const ProjectVersion& version : versions)
        list_->addItem(tr("%1 · %2", "date and time, size")
                           .arg(locale().toString(QDateTime::fromSecsSinceEpoch(version.saved), QLocale::ShortFormat), locale().formattedDataSize(static_cast<qint64>(version.bytes), 1)));
    list_->setCurrentRow(0);
    list_->setSizeAdjustPolicy(QAbstractScrollArea::AdjustToContents);
    list_->setMinimumSize(px(380), px(std::min(16 + 44 * int(versions.size()), 300)));
    list_->setVisible(!versions.empty());
    connect(list_, &QListWidget::itemActivated, this, &QDialog::accept);

    auto* row = new QHBoxLayout;
    auto* close = new QPushButton(tr("Cancel"), this);
    auto* open = new QPushButton(tr("Open"), this);
    open->setEnabled(!versions.empty());
    open->setDefault(true);
    close->setAutoDefault(false);
    fill(row, Stretch{}, close, open);
    fill(new QVBoxLayout(this), QMargins(px(22), px(20), px(22), px(18)), Spacing{px(14)}, text, list_, row);
    connect(open, &QPushButton::clicked, this, &QDialog::accept);
    connect(close, &QPushButton::clicked, this, &QDialog::reject);
}

std::size_t VersionsDialog::chosen() const { return static_cast<std::size_t>(list_->currentRow()); }

}  // namespace imomushi
