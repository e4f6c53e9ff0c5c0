// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/links_dialog.h"

#include <QDialogButtonBox>
#include <QHeaderView>
#include <QLabel>
#include <QLocale>
#include <QPushButton>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "core/mesh/triangle_tree.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/number_field.h"

namespace imomushi {
namespace {

enum LinkColumn { kBetween, kLinkRadius, kLinkVolume, kLinkColumns };

/// What lies at a place: the bone that moves it most, or the part of the file.
QString nameAt(const CharacterFile& file, const TriangleTree& tree, const Vec3& place) {
    const RenderModel& model = file.renderModel;
    const auto hit = tree.nearest(place);
    if (file.rig && !file.rig->weights.first.empty()) {
        const RigWeights& weights = file.rig->weights;
        const auto v = std::size_t(model.mesh.body.triangles(hit.triangle, 0));
        const auto from = weights.weight.begin() + weights.first[v], to = weights.weight.begin() + weights.first[v + 1];
        if (from != to) return QString::fromStdString(file.rig->bones[std::size_t(weights.bone[std::size_t(std::max_element(from, to) - weights.weight.begin())])].name);
    }
    return QString::fromStdString(model.parts[std::size_t(model.part[std::size_t(hit.triangle)])]);
}

}  // namespace

LinksDialog::LinksDialog(const CharacterFile& file, const Body& body, const std::optional<std::vector<FleshLink>>& asked, QWidget* parent)
    : QDialog(parent), links_(asked ? *asked : body.report.links) {
    setWindowTitle(tr("Links of flesh"));
    setObjectName(QStringLiteral("linksDialog"));
    auto* text = new QLabel(tr("A link is a tube of flesh between two parts that do not touch, so that the body hangs together. Without its link a small part is carried by the body, and a large one hangs on nothing."), this);
    text->setWordWrap(true);
    tree_ = new QTreeWidget(this);
    tree_->setAccessibleName(windowTitle());
    tree_->setColumnCount(kLinkColumns);
    tree_->setHeaderLabels({tr("Between"), tr("Radius"), tr("Volume")});
    tree_->setRootIsDecorated(false);
    tree_->header()->setStretchLastSection(false);
    tree_->header()->setSectionResizeMode(kBetween, QHeaderView::Stretch);
    const TriangleTree surface(file.renderModel.mesh.body);
    const double whole = meshFacts(body.mesh).volume;
    const QLocale locale;
    for (FleshLink& link : links_) {
        auto* item = new QTreeWidgetItem(tree_);
        item->setText(kBetween, tr("%1 and %2").arg(nameAt(file, surface, link.from), nameAt(file, surface, link.to)));
        item->setCheckState(kBetween, Qt::Checked);
        item->setSizeHint(kBetween, QSize(0, px(36)));
        const auto made = std::find_if(body.report.links.begin(), body.report.links.end(), [&](const FleshLink& of) { return (of.from - link.from).norm() < link.radius; });
        item->setText(kLinkVolume, made == body.report.links.end() ? tr("not made") : tr("%1 %").arg(locale.toString(100.0 * made->volume / whole, 'g', 2)));
        item->setTextAlignment(kLinkVolume, Qt::AlignRight | Qt::AlignVCenter);
        NumberField::Spec spec;
        spec.unit = QStringLiteral("m");
        spec.low = 0.1 * link.radius;
        spec.high = 10.0 * link.radius;
        spec.step = 0.01 * link.radius;
        spec.decimals = std::clamp(3 - int(std::floor(std::log10(link.radius))), 3, 9);
        spec.standard = link.radius;
        auto* radius = new NumberField(spec, tree_);
        radius->setAccessibleName(tr("Radius"));
        radius->setValue(link.radius);
        tree_->setItemWidget(item, kLinkRadius, radius);
        radii_.push_back(radius);
        link.volume = 0.0;
    }
    tree_->setColumnWidth(kLinkRadius, px(120));
    tree_->setColumnWidth(kLinkVolume, px(90));

    auto* reset = named(new QPushButton(tr("As found"), this), "asFound");
    reset->setAutoDefault(false);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel, this);
    auto* use = buttons->addButton(tr("Use these links"), QDialogButtonBox::AcceptRole);
    use->setObjectName(QStringLiteral("useLinks"));
    use->setDefault(true);
    fill(new QVBoxLayout(this), QMargins(px(20), px(18), px(20), px(16)), Spacing{px(12)}, text, Share{tree_, 1}, fill(new QHBoxLayout, reset, Stretch{}), buttons);
    resize(px(620), px(460));
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(reset, &QPushButton::clicked, this, [this] {
        asFound_ = true;
        accept();
    });
}

std::optional<std::vector<FleshLink>> LinksDialog::chosen() const {
    if (asFound_) return std::nullopt;
    std::vector<FleshLink> out;
    for (int i = 0; i < int(links_.size()); ++i) {
        if (tree_->topLevelItem(i)->checkState(kBetween) != Qt::Checked) continue;
        out.push_back(links_[std::size_t(i)]);
        out.back().radius = *radii_[std::size_t(i)]->value();
    }
    return out;
}

}  // namespace imomushi
