// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/action_states.h"

#include <QLocale>
#include <algorithm>

#include "ui/jobs/precompute_job.h"
#include "ui/models/paths.h"
#include "ui/models/selection_commands.h"
#include "ui/models/studio_document.h"
#include "ui/models/take_deck.h"
#include "ui/models/texts.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/window/step_flow.h"
#include "ui/window/studio_actions.h"

namespace imomushi {

using Kind = SelectionItem::Kind;

ActionStates::ActionStates(ActionSet& actions, StudioDocument& document, TakeDeck& deck, PrecomputeJob& precompute, StepFlow& steps, QObject* parent)
    : QObject(parent), actions_(actions), document_(document), deck_(deck), precompute_(precompute), steps_(steps) {
    connect(&document, &StudioDocument::structureChanged, this, &ActionStates::updateSoon);
    connect(&document, &StudioDocument::selectionChanged, this, &ActionStates::updateSoon);
    connect(&document, &StudioDocument::historyChanged, this, &ActionStates::updateSoon);
    connect(&document, &StudioDocument::responsesChanged, this, &ActionStates::updateSoon);
    connect(&document, &StudioDocument::fileChanged, this, &ActionStates::updateSoon);
    connect(&precompute, &BackgroundJob::finished, this, &ActionStates::updateSoon);
    connect(&steps, &StepFlow::changed, this, &ActionStates::updateSoon);
    connect(&deck, &TakeDeck::changed, this, &ActionStates::updateTakes);
}

void ActionStates::updateSoon() {
    if (scheduled_) return;
    scheduled_ = true;
    QMetaObject::invokeMethod(this, &ActionStates::update, Qt::QueuedConnection);
}

void ActionStates::update() {
    scheduled_ = false;
    ActionSet& a = actions_;
    const Document& d = document_.document();
    const Session& session = document_.session();
    const auto& selection = document_.selection();
    const auto count = [&](auto... kinds) { return std::count_if(selection.begin(), selection.end(), [&](const SelectionItem& i) { return ((i.kind == kinds) || ...); }); };
    a["delete"]->setEnabled(count(Kind::Element, Kind::Face, Kind::Bone, Kind::Character, Kind::Cut) > 0);
    a["versions"]->setEnabled(!session.path().empty());
    a["rename"]->setEnabled(selection.size() == 1 && selection.front().kind != Kind::Endpoint);
    a["duplicate"]->setEnabled(canDuplicate(document_));
    for (const char* id : {"mirror-x", "mirror-y", "mirror-z"}) a[id]->setEnabled(canMirror(document_));
    a["replace-mesh"]->setEnabled(!replaceable(document_).name.empty());
    const CharacterSource* character = chosenCharacter(document_);
    const bool idle = !steps_.running(), soften = character && idle && canBecomeSoft(d, *character);
    a["make-soft"]->setEnabled(soften);
    a["make-soft-bones"]->setEnabled(soften && character->rig && !character->rig->bones.empty());
    a["import-skeleton"]->setEnabled(character && idle);
    a["import-clips"]->setEnabled(character && idle && character->rig && !character->rig->bones.empty());
    a["propose"]->setEnabled(soften);
    a["hide"]->setEnabled(count(Kind::Element) > 0);
    a["join"]->setEnabled(count(Kind::Face) == 2);
    const bool handles = std::any_of(selection.begin(), selection.end(), [&](const SelectionItem& i) { return handleOf(d, i) != nullptr; });
    a["pin"]->setEnabled(handles || count(Kind::Endpoint, Kind::Bone) > 0);
    const bool held = !d.goals.empty() || std::any_of(d.handleGoals.begin(), d.handleGoals.end(), [](const auto& goal) { return goal.second.target.held; });
    a["release"]->setEnabled(held);
    a["rest"]->setEnabled(held || !d.handleGoals.empty() || !d.turns.empty() || !d.morphs.empty() || !d.pose.points.empty());
    for (const char* id : {"select-all", "export", "write-mesh"}) a[id]->setEnabled(!d.elements.empty());
    const bool stale = std::any_of(d.elements.begin(), d.elements.end(), [&](const auto& e) {
        return !e.second->faces.empty() && session.responseState(e.first) != Session::ResponseState::Fresh;
    });
    a["precompute"]->setEnabled(stale && !precompute_.running());
    updateSteps();
    updateTakes();
    a[kThemeActions[std::size_t(Appearance::instance().theme())]]->setChecked(true);
    a[QLocale().language() == QLocale::Japanese ? "language-ja" : "language-en"]->setChecked(true);
    Q_EMIT updated();
}

void ActionStates::updateSteps() {
    const Session& session = document_.session();
    const int position = session.position(), steps = int(session.steps().size());
    actions_["undo"]->setEnabled(position > 0);
    actions_["redo"]->setEnabled(position < steps);
    const auto tell = [&](const char* id, const QString& text, int i) {
        if (i < 0 || i >= steps) return;
        const auto& step = session.steps()[std::size_t(i)];
        actions_[id]->setToolTip(QStringLiteral("%1  (%2)").arg(text.arg(stepText(step.name, step.subject)), actions_[id]->shortcut().toString(QKeySequence::NativeText)));
    };
    tell("undo", tr("Undo: %1"), position - 1);
    tell("redo", tr("Redo: %1"), position);
}

void ActionStates::updateTakes() {
    ActionSet& a = actions_;
    const bool chosen = deck_.take() && !deck_.recording();
    a["record"]->setEnabled(deck_.canRecord());
    const CharacterSource* character = chosenCharacter(document_);
    // Bones move as a clip does, and morph targets without any.
    const auto plays = [&](const RigClip& clip) { return !clip.morphs.empty() || !document_.document().bones.empty(); };
    a["take-clip"]->setEnabled(character && character->rig && std::any_of(character->rig->clips.begin(), character->rig->clips.end(), plays) && !deck_.recording() && !steps_.running());
    for (const char* id : {"play", "take-back", "take-forward", "mark-in", "mark-out", "rename-take", "duplicate-take", "remove-take"}) a[id]->setEnabled(chosen);
    for (const char* id : {"mark-none", "trim-take"}) a[id]->setEnabled(chosen && deck_.marked());
    a["count-in"]->setChecked(deck_.countsIn());
    a["leave-take"]->setEnabled(deck_.shown());
    a["loop"]->setChecked(deck_.looping());
    static const QIcon play = themedIcon(QStringLiteral("play")), pause = themedIcon(QStringLiteral("pause"));
    a["play"]->setIcon(deck_.playing() ? pause : play);
}

}  // namespace imomushi
