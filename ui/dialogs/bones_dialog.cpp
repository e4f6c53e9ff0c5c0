// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/bones_dialog.h"

#include <QDialogButtonBox>
#include <QHeaderView>
#include <QLabel>
#include <QLocale>
#include <QPushButton>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <set>

#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

enum Column { kName, kFlesh, kFate, kColumns };

}  // namespace

BonesDialog::BonesDialog(const Rig& rig, const Proposal& proposal, QWidget* parent) : QDialog(parent), rig_(rig) {
    setWindowTitle(tr("Bones of the skeleton"));
    setObjectName(QStringLiteral("bonesDialog"));
    auto* text = new QLabel(tr("Checked bones stay and get flesh of their own. All others are merged: what carries them moves their flesh. Few bones make few elements, which are quick and soft."), this);
    text->setWordWrap(true);
    tree_ = new QTreeWidget(this);
    tree_->setAccessibleName(windowTitle());
    tree_->setColumnCount(kColumns);
    tree_->setHeaderLabels({tr("Bone"), tr("Flesh"), tr("What becomes of it")});
    tree_->setUniformRowHeights(true);
    tree_->header()->setStretchLastSection(true);

    std::set<std::string> merged;
    for (const ProposedMerge& merge : proposal.merged) merged.insert(merge.what);
    const QLocale locale;
    for (std::size_t b = 0; b < rig.bones.size(); ++b) {
        const RigBone& bone = rig.bones[b];
        auto* item = bone.parent < 0 ? new QTreeWidgetItem(tree_) : new QTreeWidgetItem(items_[std::size_t(bone.parent)]);
        item->setText(kName, QString::fromStdString(bone.name));
        item->setCheckState(kName, merged.contains(bone.name) ? Qt::Unchecked : Qt::Checked);
        const double share = b < proposal.share.size() ? proposal.share[b] : 0.0;
        item->setText(kFlesh, share > 0.0 ? tr("%1 %").arg(locale.toString(100.0 * share, 'f', share < 0.01 ? 1 : 0)) : tr("none", "flesh"));
        item->setTextAlignment(kFlesh, Qt::AlignRight | Qt::AlignVCenter);
        items_.push_back(item);
    }
    tree_->expandAll();
    tree_->setCurrentItem(items_.empty() ? nullptr : items_.front());

    count_ = styled(new QLabel(this), "muted");
    auto* all = new QPushButton(tr("Check all"), this);
    auto* none = new QPushButton(tr("Check none"), this);
    auto* reset = named(new QPushButton(tr("As proposed"), this), "asProposed");
    auto* row = fill(new QHBoxLayout, Spacing{px(8)});
    for (QPushButton* button : {all, none, reset}) {
        button->setAutoDefault(false);
        row->addWidget(button);
    }
    fill(row, Stretch{}, count_);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel, this);
    auto* use = buttons->addButton(tr("Use these bones"), QDialogButtonBox::AcceptRole);
    use->setObjectName(QStringLiteral("useBones"));
    use->setDefault(true);
    fill(new QVBoxLayout(this), QMargins(px(20), px(18), px(20), px(16)), Spacing{px(12)}, text, Share{tree_, 1}, row, buttons);
    resize(px(620), px(560));

    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(all, &QPushButton::clicked, this, [this] { check(true); });
    connect(none, &QPushButton::clicked, this, [this] { check(false); });
    connect(reset, &QPushButton::clicked, this, [this] {
        asProposed_ = true;
        accept();
    });
    connect(tree_, &QTreeWidget::itemChanged, this, [this] {
        if (!following_) follow();
    });
    follow();
    for (const int column : {kName, kFlesh}) tree_->resizeColumnToContents(column);
}

void BonesDialog::check(bool all) {
    following_ = true;
    for (QTreeWidgetItem* item : items_) item->setCheckState(kName, all ? Qt::Checked : Qt::Unchecked);
    following_ = false;
    follow();
}

void BonesDialog::follow() {
    following_ = true;
    int stay = 0;
    for (std::size_t b = 0; b < items_.size(); ++b) {
        const bool checked = items_[b]->checkState(kName) == Qt::Checked;
        stay += checked;
        int into = rig_.bones[b].parent;
        while (into >= 0 && items_[std::size_t(into)]->checkState(kName) != Qt::Checked) into = rig_.bones[std::size_t(into)].parent;
        items_[b]->setText(kFate, checked ? tr("stays") : into < 0 ? tr("merged") : tr("merged into %1").arg(items_[std::size_t(into)]->text(kName)));
        items_[b]->setForeground(kFate, themeColor(checked ? Appearance::Role::Text : Appearance::Role::Muted));
    }
    count_->setText(tr("%1 of %2 bones stay").arg(stay).arg(items_.size()));
    following_ = false;
}

std::optional<std::vector<std::string>> BonesDialog::chosen() const {
    if (asProposed_) return std::nullopt;
    std::vector<std::string> names;
    for (std::size_t b = 0; b < items_.size(); ++b)
        if (items_[b]->checkState(kName) == Qt::Checked) names.push_back(rig_.bones[b].name);
    return names;
}

}  // namespace imomushi
