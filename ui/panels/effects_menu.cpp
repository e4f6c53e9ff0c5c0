// SPDX-License-Identifier: GPL-3.0-or-later
// What the right button offers on effects.
#include <QContextMenuEvent>
#include <QMenu>
#include <QVBoxLayout>

#include "ui/models/effect_texts.h"
#include "ui/panels/effects_panel.h"

namespace imomushi {

void EffectsPanel::contextMenuEvent(QContextMenuEvent* event) {
    QMenu menu(this);
    menu.setWindowFlag(Qt::NoDropShadowWindowHint);
    std::vector<EffectKind> all;
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        const QWidget* holder = row(effect).layout->parentWidget();
        if (holder->rect().contains(holder->mapFromGlobal(event->globalPos())))
            menu.addAction(tr("Copy the settings of “%1”").arg(effectTitle(effect)), this, [this, effect] { Q_EMIT copyWanted({effect}); });
        if (document_.document().effects.has(effect)) all.push_back(effect);
    }
    if (!all.empty()) menu.addAction(tr("Copy the settings of all that are on"), this, [this, all] { Q_EMIT copyWanted(all); });
    menu.addAction(tr("Paste settings"), this, &EffectsPanel::pasteWanted);
    menu.exec(event->globalPos());
}

}  // namespace imomushi
