// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/clips_dialog.h"

#include <QDialogButtonBox>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/models/texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {

ClipsDialog::ClipsDialog(const QString& character, const std::vector<RigClip>& clips, QWidget* parent) : QDialog(parent) {
    setWindowTitle(tr("Takes from clips"));
    setObjectName(QStringLiteral("clipsDialog"));
    auto* text = new QLabel(tr("Clips of the file of “%1”. A take of one moves the bones as the file does, and the flesh with them.").arg(character), this);
    text->setWordWrap(true);
    list_ = new QListWidget(this);
    list_->setAccessibleName(tr("Clips"));
    for (const RigClip& clip : clips) {
        auto* item = new QListWidgetItem(tr("%1 · %2", "clip, its length").arg(QString::fromStdString(clip.name), durationText(clip.seconds)), list_);
        item->setCheckState(clips.size() == 1 ? Qt::Checked : Qt::Unchecked);
    }
    list_->setCurrentRow(0);
    auto* all = named(new QPushButton(tr("Check all"), this), "allClips");
    all->setAutoDefault(false);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel, this);
    buttons->addButton(all, QDialogButtonBox::ResetRole);
    make_ = buttons->addButton(tr("Make takes"), QDialogButtonBox::AcceptRole);
    make_->setObjectName(QStringLiteral("makeTakes"));
    make_->setDefault(true);
    fill(new QVBoxLayout(this), QMargins(px(20), px(18), px(20), px(16)), Spacing{px(12)}, text, Share{list_, 1}, buttons);
    resize(px(460), px(380));
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(all, &QPushButton::clicked, this, [this] {
        for (int i = 0; i < list_->count(); ++i) list_->item(i)->setCheckState(Qt::Checked);
    });
    connect(list_, &QListWidget::itemChanged, this, &ClipsDialog::follow);
    follow();
}

void ClipsDialog::follow() { make_->setEnabled(!chosen().empty()); }

std::vector<std::size_t> ClipsDialog::chosen() const {
    std::vector<std::size_t> clips;
    for (int i = 0; i < list_->count(); ++i)
        if (list_->item(i)->checkState() == Qt::Checked) clips.push_back(std::size_t(i));
    return clips;
}

}  // namespace imomushi
