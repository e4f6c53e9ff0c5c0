// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/action_states.h"

#include <QCoreApplication>
#include <QLocale>
#include <algorithm>

#include "core/commands/proposal_commands.h"
#include "ui/jobs/precompute_job.h"
#include "ui/models/input_deck.h"
#include "ui/models/paths.h"
#include "ui/models/selection_commands.h"
#include "ui/models/studio_document.h"
#include "ui/models/take_deck.h"
#include "ui/models/texts.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/window/clipboard_flow.h"
#include "ui/window/step_flow.h"
#include "ui/window/studio_actions.h"

#include "core/document/kept_pose.h"

namespace imomushi {

using Kind = SelectionItem::Kind;

ActionStates::ActionStates(ActionSet& actions, StudioDocument& document, TakeDeck& deck, InputDeck& inputs, PrecomputeJob& precompute, StepFlow& steps, ClipboardFlow& clipboard, QObject* parent)
    : QObject(parent), actions_(actions), document_(document), deck_(deck), inputs_(inputs), precompute_(precompute), steps_(steps), clipboard_(clipboard) {
    connect(&document, &StudioDocument::structureChanged, this, &ActionStates::updateSoon);
    connect(&document, &StudioDocument::selectionChanged, this, &ActionStates::updateSoon);
    connect(&document, &StudioDocument::historyChanged, this, &ActionStates::updateSoon);
    connect(&document, &StudioDocument::responsesChanged, this, &ActionStates::updateSoon);
    connect(&document, &StudioDocument::fileChanged, this, &ActionStates::updateSoon);
    connect(&precompute, &BackgroundJob::finished, this, &ActionStates::updateSoon);
    connect(&steps, &StepFlow::changed, this, &ActionStates::updateSoon);
    connect(&clipboard, &ClipboardFlow::changed, this, &ActionStates::updateSoon);
    connect(&deck, &TakeDeck::changed, this, &ActionStates::updateTakes);
    connect(&inputs, &InputDeck::changed, this, &ActionStates::updateSoon);
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
    const QString nothing = tr("Select something first."), noCharacter = tr("There is no character: import one, or select one of several."), working = tr("Wait until the running task is done, or cancel it.");
    a.allow("delete", count(Kind::Element, Kind::Face, Kind::Bone, Kind::Character, Kind::Cut) > 0, nothing);
    a.allow("versions", !session.path().empty(), tr("Versions are kept once the project is saved."));
    a.allow("rename", selection.size() == 1 && selection.front().kind != Kind::Endpoint, tr("Select one thing that has a name."));
    a.allow("duplicate", canDuplicate(document_), tr("Select an element, a character or a bone first."));
    for (const char* id : {"copy", "cut"}) a.allow(id, canMirror(document_), nothing);
    a.allow("paste", clipboard_.canPaste() && !steps_.running(), clipboard_.canPaste() ? working : tr("Nothing was copied yet."));
    for (const char* id : {"mirror-x", "mirror-y", "mirror-z"}) a.allow(id, canMirror(document_), tr("Select an element, a character or a bone first."));
    a.allow("replace-mesh", !replaceable(document_).name.empty(), tr("Select one character, or one element of its own."));
    const CharacterSource* character = chosenCharacter(document_);
    const SoftWish wish = softWish(document_);
    const bool idle = !steps_.running(), rigged = character && character->rig && !character->rig->bones.empty(), soften = character && idle && canBecomeSoft(d, *character);
    const QString notSoft = !idle ? working : !character ? noCharacter : tr("It is soft already: it has cuts, bones or handles.");
    const QString nothingSoft = tr("There is nothing to make soft: import a mesh, or select one of several characters and elements."), elementIsSoft = tr("It has joint faces, bones or handles: precompute makes it soft.");
    const QString noBones = tr("It has no skeleton. “Import skeleton” adds one.");
    const bool becomesSoft = idle && (wish.element ? canBecomeSoft(d, *wish.element) : soften);
    for (const char* id : {"make-soft", "propose"}) a.allow(id, becomesSoft, !idle || wish.character ? notSoft : wish.element ? elementIsSoft : nothingSoft);
    a.allow("make-soft-bones", soften && rigged, soften ? noBones : notSoft);
    a.allow("import-skeleton", character && idle, character ? working : noCharacter);
    a.allow("import-clips", character && idle && rigged, !character ? noCharacter : !idle ? working : noBones);
    for (const char* id : {"hide", "isolate", "lock"}) a.allow(id, canHide(document_), nothing);
    a.allow("edit-face", selection.size() == 1 && count(Kind::Face) == 1 && !handleOf(d, selection.front()), tr("Select one joint face first."));
    a.allow("join", count(Kind::Face) == 2, tr("Select two joint faces: click one, then Shift+click the other."));
    const bool handles = std::any_of(selection.begin(), selection.end(), [&](const SelectionItem& i) { return handleOf(d, i) != nullptr; });
    a.allow("pin", handles || count(Kind::Endpoint, Kind::Bone) > 0, tr("Select a bone, the end of one, or a handle first."));
    const bool held = !d.goals.empty() || std::any_of(d.handleGoals.begin(), d.handleGoals.end(), [](const auto& goal) { return goal.second.target.held; });
    a.allow("release", held, tr("Nothing is held."));
    a.allow("rest", held || !d.handleGoals.empty() || !d.turns.empty() || !d.morphs.empty() || !d.pose.points.empty(), tr("It is at rest."));
    for (const char* id : {"select-all", "stage", "export", "write-mesh", "picture", "place-bone", "place-face", "place-cut", "place-handle"}) a.allow(id, !d.elements.empty(), tr("The project is empty."));
    a.allow("select-invert", !d.elements.empty() || !d.bones.empty(), tr("The project is empty."));
    a.allow("select-more", count(Kind::Element, Kind::Bone, Kind::Endpoint) > 0, tr("Select an element or a bone first."));
    a.allow("select-chain", count(Kind::Bone, Kind::Endpoint) > 0, tr("Select a bone first."));
    const bool poses = !d.bones.empty() || std::any_of(d.elements.begin(), d.elements.end(), [](const auto& e) { return !e.second->handles.empty(); });
    for (const char* id : {"keep-pose", "mirror-pose"}) a.allow(id, poses, tr("There are no bones and no handles yet."));
    for (const char* id : {"rest-bones", "rest-chain"}) a.allow(id, count(Kind::Bone, Kind::Endpoint) > 0, tr("Select a bone first."));
    for (int n = 1; n <= 9; ++n) a.allow(QByteArray("pose-").append(QByteArray::number(n)).constData(), keptPoses(d).size() >= std::size_t(n), tr("So many poses are not kept yet."));
    namePoses();
    const bool stale = std::any_of(d.elements.begin(), d.elements.end(), [&](const auto& e) {
        return !e.second->faces.empty() && session.responseState(e.first) != Session::ResponseState::Fresh;
    });
    const bool faces = std::any_of(d.elements.begin(), d.elements.end(), [](const auto& e) { return !e.second->faces.empty(); });
    a.allow("precompute", stale && !precompute_.running(), precompute_.running() ? tr("It is precomputing.") : faces ? tr("Everything is precomputed already.") : tr("There is nothing to precompute: no element has a joint face or a handle."));
    a.allow("let-go", inputs_.listens(), tr("Nobody is listened to."));
    a.allow("save-mappings", d.mappings && !d.mappings->empty(), tr("There are no mappings."));
    updateSteps();
    updateTakes();
    a[kThemeActions[std::size_t(Appearance::instance().theme())]]->setChecked(true);
    a[QLocale().language() == QLocale::Japanese ? "language-ja" : "language-en"]->setChecked(true);
    Q_EMIT updated();
}

// The menu says which pose each number brings back.
void ActionStates::namePoses() {
    const KeptPoses& poses = keptPoses(document_.document());
    for (const ActionSet::Entry& entry : actions_.entries()) {
        if (!entry.id.startsWith("pose-")) continue;
        const std::size_t n = entry.id.mid(5).toUInt();
        QString text = QCoreApplication::translate("Actions", entry.text);
        if (n >= 1 && n <= poses.size()) text = QStringLiteral("&%1  %2").arg(n).arg(QString::fromStdString(poses[n - 1].name).replace(u'&', QStringLiteral("&&")));
        entry.action->setText(text);
    }
}

void ActionStates::updateSteps() {
    const Session& session = document_.session();
    const int position = session.position(), steps = int(session.steps().size());
    actions_.allow("undo", position > 0 || steps_.running(), tr("There is nothing to undo."));
    actions_.allow("redo", position < steps && !steps_.running(), tr("There is nothing to redo."));
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
    a.allow("record", deck_.canRecord(), tr("There is nothing to perform with yet: open a sample, or make a mesh soft."));
    const CharacterSource* character = chosenCharacter(document_);
    // Bones move as a clip does, and morph targets without any.
    const auto plays = [&](const RigClip& clip) { return !clip.morphs.empty() || !document_.document().bones.empty(); };
    a.allow("take-clip", character && character->rig && std::any_of(character->rig->clips.begin(), character->rig->clips.end(), plays) && !deck_.recording() && !steps_.running(),
            tr("The character has no clips that its bones could play."));
    const QString noTake = deck_.recording() ? tr("A take is being recorded.") : tr("There is no take yet: record one.");
    for (const char* id : {"play", "take-back", "take-forward", "mark-in", "mark-out", "rename-take", "duplicate-take", "remove-take"}) a.allow(id, chosen, noTake);
    for (const char* id : {"mark-none", "trim-take"}) a.allow(id, chosen && deck_.marked(), chosen ? tr("The whole take is selected already. Set a mark first.") : noTake);
    a.allow("leave-take", deck_.shown(), tr("No take is shown."));
    a["count-in"]->setChecked(deck_.countsIn());
    a["loop"]->setChecked(deck_.looping());
    static const QIcon play = themedIcon(QStringLiteral("play")), pause = themedIcon(QStringLiteral("pause"));
    a["play"]->setIcon(deck_.playing() ? pause : play);
}

}  // namespace imomushi
