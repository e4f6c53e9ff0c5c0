// SPDX-License-Identifier: GPL-3.0-or-later
#include <QPushButton>

#include "core/document/character_input.h"
#include "ui/models/paths.h"
#include "ui/panels/inspector/inspector_forms.h"
#include "ui/picking/picking.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {

EndpointForm::EndpointForm(StudioDocument& document, const SelectionItem& item, QWidget* parent) : InspectorForm(document, parent) {
    addHeading(QStringLiteral("pose"), [this, item] { return title(item); }, tr("Endpoint"));
    addSection();
    addFact(tr("State"), [this, item] {
        const EndpointGoal* h = held(item);
        return !h ? tr("free") : h->pinned ? tr("pinned") : tr("held");
    });
    addFact(tr("At rest (m)"), [this, item] {
        const Bone* b = bone(item);
        if (!b) return QStringLiteral("–");
        const auto p = restPosition(now(), item.atEnd ? b->end : b->start);
        return p ? vectorText(*p) : QStringLiteral("–");
    });
    addFact(tr("Now (m)"), [this, item] {
        const auto p = shownAt(item);
        return p ? vectorText(*p) : QStringLiteral("–");
    });
    addTarget(item);
    addButtons(item);
}

const EndpointGoal* EndpointForm::held(const SelectionItem& item) const {
    const auto found = now().goals.find(EndpointRef{item.part, item.atEnd});
    return found == now().goals.end() ? nullptr : &found->second;
}

std::optional<Vec3> EndpointForm::shownAt(const SelectionItem& item) const { return endpointPosition(document_.session(), {item.part, item.atEnd}); }

void EndpointForm::addTarget(const SelectionItem& item) {
    addSection(tr("Target"));
    static constexpr const char* kAxes[] = {"X", "Y", "Z"};
    const auto target = [this](const SelectionItem& endpoint) -> std::optional<Vec3> {
        const EndpointGoal* h = held(endpoint);
        return h ? std::optional(h->target) : shownAt(endpoint);
    };
    for (int axis = 0; axis < 3; ++axis) {
        addNumber(QLatin1String(kAxes[axis]), {QStringLiteral("m"), -1e6, 1e6, 0.005, 4, 1.0, {}}, {item},
                  [target, axis](const SelectionItem& endpoint) -> std::optional<double> {
                      const auto p = target(endpoint);
                      return p ? std::optional((*p)[axis]) : std::nullopt;
                  },
                  [this, target, axis](const SelectionItem& endpoint, double value) {
                      Vec3 p = target(endpoint).value_or(Vec3::Zero());
                      p[axis] = value;
                      return commands::drag(path(endpoint), p);
                  });
    }
}

void EndpointForm::addButtons(const SelectionItem& item) {
    auto* pin = new QPushButton(themedIcon(QStringLiteral("pin")), {}, this);
    auto* release = new QPushButton(themedIcon(QStringLiteral("release")), tr("Release"), this);
    sections_->addLayout(fill(new QHBoxLayout, pin, release));
    auto* turn = new QPushButton(tr("Hold orientation"), this);
    turn->setCheckable(true);
    turn->setToolTip(tr("The pin holds the direction of the bone, too."));
    sections_->addWidget(turn);
    const auto pinned = [this, item] { return isPinned(now(), EndpointRef{item.part, item.atEnd}); };
    connect(pin, &QPushButton::clicked, this, [this, item, pinned] { document_.execute(commands::setPinned(path(item), !pinned())); });
    connect(release, &QPushButton::clicked, this, [this, item] { document_.execute(commands::release(path(item))); });
    connect(turn, &QPushButton::clicked, this, [this, item](bool on) { document_.execute(commands::pinOrientation(path(item), on)); });
    follow([this, item, pin, release, turn, pinned] {
        turn->setEnabled(pinned());
        turn->setChecked(held(item) && held(item)->rotation);
        pin->setText(pinned() ? tr("Unpin") : tr("Pin"));
        release->setEnabled(held(item) != nullptr);
    });
}

}  // namespace imomushi
