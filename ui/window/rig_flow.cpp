// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/rig_flow.h"

#include <set>

#include "ui/dialogs/bones_dialog.h"
#include "ui/dialogs/clips_dialog.h"
#include "ui/models/commands.h"
#include "ui/models/take_deck.h"
#include "ui/models/texts.h"
#include "ui/window/file_flow.h"
#include "ui/window/step_flow.h"

namespace imomushi {

RigFlow::RigFlow(StudioDocument& document, FileFlow& files, StepFlow& steps, TakeDeck& deck, QWidget* window)
    : QObject(window), document_(document), files_(files), steps_(steps), deck_(deck), window_(window) {
    connect(&job_, &BackgroundJob::finished, this, [this](bool completed) {
        if (completed) askBones();
    });
}

void RigFlow::chooseBones(const CharacterSource& character) { job_.start(document_.document().characters.at(character.id)); }

void RigFlow::askBones() {
    const auto character = job_.character();
    if (!job_.proposal()) {
        Q_EMIT document_.failed(errorText(job_.proposal().error()));
        return;
    }
    BonesDialog dialog(*character->rig, *job_.proposal(), window_);
    if (dialog.exec() != QDialog::Accepted) return;
    const CharacterSource* now = document_.document().characterNamed(character->name);
    if (now && now->rig == character->rig) files_.makeSoft(*now, dialog.chosen());
}

void RigFlow::takeClips(const CharacterSource& character) {
    const auto rig = character.rig;
    const std::string name = character.name;
    ClipsDialog dialog(QString::fromStdString(name), rig->clips, window_);
    if (dialog.exec() != QDialog::Accepted) return;
    std::set<std::string> taken;
    for (const auto& [id, take] : document_.document().takes) taken.insert(take->name);
    const std::vector<std::size_t> chosen = dialog.chosen();
    for (const std::size_t c : chosen) {
        const std::string& clip = rig->clips[c].name;
        std::string take = clip;
        for (int n = 2; !taken.insert(take).second; ++n) take = clip + " " + std::to_string(n);
        SlowStep step;
        step.command = commands::takeClip(name, clip, take);
        step.title = tr("Making a take of “%1”").arg(QString::fromStdString(clip));
        step.done = [this, last = c == chosen.back(), count = int(chosen.size())](const Json& answer) {
            const Take* made = document_.document().takeNamed(answer.at("take").get<std::string>());
            if (!last || !made) return;
            deck_.choose(made->id);
            Q_EMIT said(tr("Made %n take(s). The space bar plays the chosen one.", nullptr, count));
        };
        steps_.start(std::move(step));
    }
}

}  // namespace imomushi
