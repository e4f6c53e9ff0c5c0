// SPDX-License-Identifier: GPL-3.0-or-later
// What F3 finds.
#include <QMenu>

#include "ui/dialogs/preferences_dialog.h"
#include "ui/models/effect_texts.h"
#include "ui/models/paths.h"
#include "ui/models/selection_commands.h"
#include "ui/panels/effects_panel.h"
#include "ui/panels/takes_panel.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"
#include "ui/window/command_search.h"
#include "ui/window/main_window.h"
#include "ui/window/rig_flow.h"
#include "ui/window/studio_actions.h"
#include "ui/window/studio_docks.h"
#include "ui/window/studio_menus.h"

namespace imomushi {

void MainWindow::showEffect(EffectKind effect) {
    StudioDocks::raise(effects());
    effects().reveal(effect);
}

std::vector<Findable> MainWindow::findables() {
    std::vector<Findable> all;
    const auto text = [](const std::string& name) { return QString::fromStdString(name); };
    const auto add = [&](const char* icon, const QString& name, const QString& kind, std::function<void()> run) { all.push_back({themedIcon(QLatin1String(icon)), name, kind, {}, {}, std::move(run)}); };
    for (QAction* action : actions_->all()) {
        QString why = whyDisabled(*action);
        if (!action->isEnabled() && why.isEmpty()) why = tr("Not now");
        all.push_back({action->icon(), commandName(*action), {}, action->shortcut().toString(QKeySequence::NativeText), why, [action] { action->trigger(); }});
    }
    for (QDockWidget* dock : docks_->all()) add("appearance", dock->windowTitle(), tr("Panel"), [dock] { StudioDocks::raise(*dock); });
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        const auto reveal = [this, effect] { showEffect(effect); };
        add("spring", effectTitle(effect), tr("Effect"), reveal);
        for (const EffectProperty& property : effectProperties(effect)) add("settings", effectPropertyTitle(property), tr("Setting of “%1”", "an effect").arg(effectTitle(effect)), reveal);
    }
    for (const QString& setting : PreferencesDialog::settings()) add("settings", setting, tr("Setting"), [this, setting] { openPreferences(setting); });
    for (QAction* sample : menus_->samplesMenu()->actions()) add("open", sample->text(), tr("Sample"), [sample] { sample->trigger(); });

    const Document& d = document_.document();
    const auto part = [&](const char* icon, const std::string& name, const QString& kind, const SelectionItem& item) {
        add(icon, text(name), kind, [this, item] {
            showStart(false);
            document_.select({item});
            viewport_->frameSelection();
        });
    };
    for (const auto& [id, character] : d.characters) {
        part("character", character->name, tr("Character"), {SelectionItem::Kind::Character, id, {}, false});
        for (const Cut& cut : character->cuts) part("cut", cut.name, tr("Cut"), {SelectionItem::Kind::Cut, cut.id, {}, false});
        if (!character->rig) continue;
        for (const RigClip& clip : character->rig->clips)
            add("take", text(clip.name), tr("Clip"), [this, id = id] {
                const auto now = document_.document().characters.find(id);
                if (now == document_.document().characters.end()) return;
                StudioDocks::raise(takes());
                rigs_->takeClips(*now->second);
            });
    }
    for (const auto& [id, element] : d.elements) {
        part("element", element->name, tr("Element"), {SelectionItem::Kind::Element, id, {}, false});
        for (const JointFace& face : element->faces) {
            const bool handle = element->handleOf(face.name) != nullptr;
            part(handle ? "handle" : "face", face.name, handle ? tr("Handle") : tr("Joint face of %1", "an element").arg(text(element->name)), {SelectionItem::Kind::Face, id, face.name, false});
        }
    }
    for (const auto& [id, bone] : d.bones) part("bone", bone->name, tr("Bone"), {SelectionItem::Kind::Bone, id, {}, false});
    for (const auto& [id, bone] : d.bones)
        for (const bool atEnd : {false, true}) part("pose", pathOf(d, EndpointRef{id, atEnd}), tr("End of a bone"), {SelectionItem::Kind::Endpoint, id, {}, atEnd});
    for (const auto& [id, take] : d.takes)
        add("take", text(take->name), tr("Take"), [this, id = id] {
            showStart(false);
            StudioDocks::raise(takes());
            deck_->choose(id);
        });
    return all;
}

}  // namespace imomushi
