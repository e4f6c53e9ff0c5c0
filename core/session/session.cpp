// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/session.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "core/document/command_support.h"
#include "core/live/performance.h"
#include "core/live/performer.h"
#include "core/live/pose_check.h"
#include "core/project/project_file.h"
#include "core/session/document_edit.h"
#include "core/session/hold_inputs.h"
#include "core/session/prepared_step.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

/// What an undo step says it was done to.
std::string subjectOf(const Json& arguments) {
    for (const char* key : {"effect", "name", "element", "endpoint", "target", "handle", "path", "a", "bone", "cut", "take"})
        if (const Json* value = find(arguments, key); value && value->is_string()) return value->get<std::string>();
    return {};
}

/// What a command answers where memory runs out: made before anything changes.
struct NoMemory {
    explicit NoMemory(const std::string& what)
        : nothingDone{"no-memory", "There is not enough memory for \"" + what + "\": close other programs or use a smaller mesh."},
          done{"no-memory-after", "\"" + what + "\" was done, and there is not enough memory for what follows it: undo takes it back."} {}
    Error nothingDone, done;
};

}  // namespace

Session::Session(const CommandRegistry& registry, std::shared_ptr<ResponseStore> store)
    : registry_(registry),
      responses_(history_.document(), store ? std::move(store) : std::make_shared<ResponseStore>()),
      live_(std::make_unique<LiveCharacter>(history_, responses_)) {}

Session::~Session() = default;

// ---- the one door ------------------------------------------------------------------------------------------------------

Result<Json> Session::execute(const Json& command, const Progress& progress) {
    try {
        return executeOrThrow(command, progress);
    } catch (const std::bad_alloc&) {  // not even for saying so at length
        return tl::unexpected(Error{"no-memory", "No memory left."});
    }
}

Result<Json> Session::executeOrThrow(const Json& command, const Progress& progress) {
    if (!command.is_object()) return fail("bad-command", "A command is a JSON object with the key \"do\".");
    const Json* name = find(command, "do");
    if (!name || !name->is_string()) return fail("bad-command", "A command needs the key \"do\" with the name of what to do.");
    const Command* what = registry_.find(name->get_ref<const std::string&>());
    if (!what) return fail("unknown-command", "There is no command \"" + name->get<std::string>() + "\"; \"imomushi run --help\" lists all.");
    if (auto ok = checkArguments(*what, command); !ok) return tl::unexpected(ok.error());
    const ParkedPerformer parked(performer_.get());
    if (performer_ && what->changesDocument()) performer_->dropInputs();

    // Frames that follow each other are one line of the script.
    if (what->name != "step") history_.flushFrames();
    Document before = history_.document();  // shares all parts
    NoMemory noMemory(what->name);
    // A command may run others (SessionAccess::execute()): what it has told so far is its own.
    struct Outer {
        Session& session;
        Change told = std::exchange(session.pendingChange_, {});
        bool historyMoved = std::exchange(session.historyMoved_, false);
        ~Outer() {
            session.pendingChange_ = std::move(told);
            session.historyMoved_ = historyMoved;
        }
    } outer{*this};
    Result<Json> answer;
    former_.reset();
    try {
        answer = runChecked(*what, command, before, progress);
    } catch (const std::bad_alloc&) {
        if (former_) putBack();
        answer = tl::unexpected(std::move(historyMoved_ ? noMemory.done : noMemory.nothingDone));
    }
    former_.reset();
    Change change;
    if (answer && what->changesDocument()) {
        try {
            change.document = difference(before, history_.document());
            history_.commit({what->name, subjectOf(command)}, before, command);
        } catch (const std::bad_alloc&) {
            answer = tl::unexpected(std::move(noMemory.nothingDone));
        }
    } else if (answer || historyMoved_) {
        change = changeSince(before);
    }
    // What an action did to the history as a whole stands, even where it failed after that: half of it taken back would fit nothing.
    if (!answer && !historyMoved_) {
        takeBack(std::move(before));
        return answer;
    }
    const bool posed = change.document.posing();
    change.replaced = change.replaced || pendingChange_.replaced;
    change.responses = pendingChange_.responses;
    change.file = pendingChange_.file;
    change.pose = pendingChange_.pose || posed || (what->changesDocument() && change.structure());
    pendingChange_ = {};
    const bool stepped = change.history = what->changesDocument() || historyMoved_;
    if (stepped || change.structure() || change.responses) live_->wake(stepped);
    try {
        if (what->changesDocument() && (posed || change.document.effects)) live_->leaveTake();
        if (change.structure() || change.responses) responses_.refresh();
        if (what->changesDocument() && !forInputs_) leaveToArtist(change.document);
    } catch (const std::bad_alloc&) {
        live_->drop();
    }
    if (stepped || change.structure() || change.pose || change.responses || change.file) tell(change);
    return answer;
}

Result<Json> Session::runChecked(const Command& command, const Json& arguments, const Document& before, const Progress& progress) {
    Result<Json> answer;
    try {
        if (command.changesDocument()) {
            DocumentEdit edit(history_.edit(), *live_, responses_, services_);
            answer = command.change(edit, arguments, progress);
            if (!answer) return answer;
            for (const auto& [element, response] : edit.brought()) responses_.bring(element, response);
            pendingChange_.responses = !edit.brought().empty();
            if (auto ok = live_->follow(before); !ok) return tl::unexpected(ok.error());
            if (command.pose) answer = command.pose(*live_, arguments, std::move(*answer));
        } else {
            SessionAccess access(*this);
            answer = command.run(access, arguments, progress);
        }
        if (answer && !allFinite(*answer)) return fail("not-finite", "The answer is not finite: check the input of this command.");
        return answer;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        return fail("internal", "\"" + command.name + "\" failed: " + error.what());
    }
}

Result<Json> Session::takePrepared(const PreparedStep& made) {
    try {
        return takeOver(made);
    } catch (const std::bad_alloc&) {
        return tl::unexpected(Error{"no-memory", "No memory left."});
    }
}

Json Session::takeOver(const PreparedStep& made) {
    const ParkedPerformer parked(performer_.get());
    if (performer_) performer_->dropInputs();
    endGesture();
    Json answer = made.answer;
    const Document before = history_.document();
    Change change;
    change.document = difference(before, made.after);
    change.history = change.pose = true;
    history_.addStep(made.step, made.after, made.lines);
    change.responses = !made.responses.empty();
    try {
        responses_.take(made.derived);
        for (const auto& [element, response] : made.responses) responses_.bring(element, response);
    } catch (const std::bad_alloc&) {
        // What is missing is computed again.
    }
    live_->reuse(made.character);
    live_->wake(true);
    live_->followExchange(before);
    try {
        responses_.refresh();
    } catch (const std::bad_alloc&) {
        live_->drop();
    }
    tell(change);
    return answer;
}

void Session::takeBack(Document&& before) noexcept {
    pendingChange_ = {};
    const Document failed = history_.rollBack(std::move(before));
    responses_.dropGone();
    live_->takeBack(failed);
}

Session::Change Session::changeSince(const Document& before) const noexcept {
    Change change;
    try {
        change.document = difference(before, document());
    } catch (const std::bad_alloc&) {
        change.document = {};
        change.document.unknown = true;
    }
    return change;
}

void Session::tell(const Change& change) noexcept {
    if (listener_) listener_(change);
}

void Session::putBack() {
    history_ = std::move(former_->history);
    responses_.replace(std::move(former_->responses));
    former_.reset();
    live_->replace();
    historyMoved_ = false;
}

// ---- gestures ----------------------------------------------------------------------------------------------------------

void Session::beginGesture() {
    const ParkedPerformer parked(performer_.get());
    if (history_.inGesture()) endGesture();
    history_.beginGesture();
}

void Session::endGesture(Step named) {
    const ParkedPerformer parked(performer_.get());
    leaveHands();
    if (!history_.endGesture(std::move(named))) return;
    Change change;
    change.history = true;
    tell(change);
}

void Session::endGestureInLast(Step named) {
    const ParkedPerformer parked(performer_.get());
    const auto& all = steps();
    const bool live = !all.empty() && (all.back().name == "live" || all.back().name == "record");
    if (!live || !history_.endGestureInLast()) return endGesture(std::move(named));
    leaveHands();
    Change change;
    change.history = true;
    tell(change);
}

Document Session::dropGesture() noexcept {
    Document left = history_.cancelGesture();
    live_->wake(true);
    live_->followExchange(left);
    return left;
}

void Session::cancelGesture() noexcept {
    if (!history_.inGesture()) return;
    const ParkedPerformer parked(performer_.get());
    if (performer_) performer_->dropInputs();
    const Document left = dropGesture();
    leaveHands();
    Change change = changeSince(left);
    change.history = true;
    change.pose = true;
    tell(change);
}

// ---- the live character ------------------------------------------------------------------------------------------------

Character* Session::character() const {
    if (performer_) return performer_->character();
    const auto alive = live_->built();
    return alive ? *alive : nullptr;
}

Result<Character*> Session::builtCharacter() const {
    if (performer_) performer_->refresh();
    if (performer_ && performer_->running()) return performer_->character();
    const auto alive = live_->built();
    return alive && performer_ ? Result<Character*>(performer_->character()) : alive;
}

std::shared_ptr<const BuiltCharacter> Session::releaseCharacter() {
    const ParkedPerformer parked(performer_.get());
    return live_->release();
}

void Session::reuseCharacter(std::shared_ptr<const BuiltCharacter> built) {
    const ParkedPerformer parked(performer_.get());
    live_->reuse(std::move(built));
}

const CharacterPlan& Session::plan() const { return live_->plan(); }
int Session::elementIndex(PartId element) const { return builtCharacter() ? live_->plan().elementIndex(element) : -1; }
int Session::pointIndex(const EndpointRef& end) const { return builtCharacter() ? live_->plan().pointIndex(end) : -1; }

Result<std::vector<PoseFinding>> Session::checkPose() const {
    const ParkedPerformer parked(performer_.get());
    return imomushi::checkPose(*live_);
}

std::vector<std::function<void()>> Session::missingWatches() const {
    const Character* alive = character();
    return alive ? alive->missingWatches() : std::vector<std::function<void()>>();
}

const Pose& Session::shownPose() const {
    if (performer_) performer_->refresh();
    return performer_ && performer_->running() ? performer_->frame().pose : live_->shownPose();
}

Result<Vec3> Session::positionOf(const EndpointRef& end) const {
    if (performer_) performer_->refresh();
    if (!performer_ || !performer_->running()) return live_->positionOf(end);
    const auto point = static_cast<std::size_t>(plan().pointIndex(end));
    const auto& points = performer_->frame().pose.points;
    return points.empty() ? plan().input.skeleton.points[point] : points[point];
}

Result<HandlePose> Session::poseOf(const FaceRef& handle) const {
    if (performer_) performer_->refresh();
    if (!performer_ || !performer_->running()) return live_->poseOf(handle);
    const int index = plan().handleIndex(handle);
    if (index < 0) return fail("no-such-handle", "The handle \"" + handle.face + "\" is not there.");
    return performer_->character()->shownHandle(index);
}

Points Session::positionsOf(PartId element) const {
    const ParkedPerformer parked(performer_.get());
    return live_->positionsOf(element);
}

Points Session::renderPositionsOf(PartId character) const {
    const ParkedPerformer parked(performer_.get());
    return live_->renderPositionsOf(character);
}

bool Session::moving() const {
    if (performer_) performer_->refresh();
    return performer_ ? performer_->moving() : live_->moving();
}

void Session::stepFrame(double seconds) {
    const ParkedPerformer parked(performer_.get());
    const std::size_t before = document().effects[EffectKind::Contact].elements.size();
    live_->stepFrame(seconds);
    if (document().effects[EffectKind::Contact].elements.size() != before) tellOfMeetings();
}

void Session::tellOfMeetings() {
    // What met lacks its patches now: who listens shows it so.
    Change change;
    change.document.effects = document().effects;
    change.responses = true;
    tell(change);
}

void Session::perform(std::function<void()> stepped) {
    performer_.reset();  // its steps end before another one touches the character
    performer_ = std::make_unique<Performer>(*live_, std::move(stepped));
}

bool Session::give(const LiveInput& input) {
    if (!performer_ || !performer_->give(input)) return false;
    InputFeed* feed = performer_->feed();
    const LiveInput held = feed ? asDriven(plan(), input) : input;
    followHeld();
    std::erase_if(heldForInputs_, [&](const HeldForInputs& known) { return known.input.sameTarget(held); });  // the artist's, from now on
    if (!feed) return true;
    const auto known = std::ranges::find_if(byHand_, [&](const LiveInput& k) { return k.sameTarget(held); });
    if (known == byHand_.end()) byHand_.push_back(held);
    else *known = held;
    (void)feed->giveToHand(held);
    return true;
}

void Session::leaveHands() noexcept {
    InputFeed* feed = performer_ ? performer_->feed() : nullptr;
    for (const LiveInput& held : std::exchange(byHand_, {})) {
        if (!feed) continue;
        try {
            const auto hold = takingHoldOf(*this, held);
            (void)feed->hold(hold && *hold ? (*hold)->held : held);
        } catch (const std::bad_alloc&) {
            (void)feed->hold(held);
        }
    }
}

bool Session::inputsWait() const {
    const InputFeed* feed = performer_ ? performer_->feed() : nullptr;
    return feed && feed->refuses();
}

bool Session::performInputs(std::shared_ptr<InputFeed> feed) {
    if (!performer_) return false;
    const ParkedPerformer parked(performer_.get());
    performer_->feed(feed);
    for (const LiveInput& held : byHand_)
        if (feed) (void)feed->giveToHand(held);
    return true;
}

void Session::performOutputs(SendingThread* to) {
    if (!performer_) return;
    const ParkedPerformer parked(performer_.get());
    performer_->send(to);
}

Result<bool> Session::holdInputs() {
    InputFeed* feed = performer_ ? performer_->feed() : nullptr;
    bool held = false;
    std::vector<LiveInput> seen;  // a step says it again until it is held
    while (const auto refused = feed ? feed->takeRefused() : std::nullopt) {
        if (std::any_of(seen.begin(), seen.end(), [&](const LiveInput& s) { return s.sameTarget(*refused); })) continue;
        seen.push_back(*refused);
        IMOMUSHI_TRY(const auto hold, takingHoldOf(*this, *refused));
        if (!hold) continue;
        const int since = position() + 1;
        if (auto done = executeForInputs(hold->command); !done) return tl::unexpected(done.error());
        if (refused->kind == LiveInput::Kind::Morph) history_.passesOn(refused->morph);
        if (refused->kind == LiveInput::Kind::Effect) history_.effectsPassOn();
        if (!refused->isNumber()) {
            std::erase_if(heldForInputs_, [&](const HeldForInputs& known) { return known.since > since || known.input.sameTarget(*refused); });
            heldForInputs_.push_back({*refused, refused->kind == LiveInput::Kind::Handle ? plan().handles[static_cast<std::size_t>(refused->handle)] : FaceRef(), since});
        }
        held = true;
        feed = performer_->feed();
        if (feed) (void)feed->hold(hold->held);
    }
    return held;
}

bool Session::inputsLeft() {
    const InputFeed* feed = performer_ ? performer_->feed() : nullptr;
    if (!feed || heldForInputs_.empty() || moving() || feed->refuses()) return false;
    if (std::exchange(lookedAt_, performer_->frame().step) == performer_->frame().step) return false;
    const ParkedPerformer parked(performer_.get());
    followHeld();
    return std::ranges::any_of(heldForInputs_, [&](const HeldForInputs& held) { return !feed->driver().moves(held.input) && !releasing(held).is_null(); });
}

void Session::followHeld() {
    std::erase_if(heldForInputs_, [this](HeldForInputs& held) {
        if (held.input.kind == LiveInput::Kind::Handle) held.input.handle = plan().handleIndex(held.handle);
        return held.input.kind == LiveInput::Kind::Handle && held.input.handle < 0;
    });
}

Json Session::releasing(const HeldForInputs& held) const { return position() < held.since && !history_.inGesture() ? Json() : releasingOf(*this, held.input); }

void Session::leaveToArtist(const DocumentChange& change) {
    const int before = history_.inGesture() ? position() : position() - 1;  // where the history was before this command
    std::erase_if(heldForInputs_, [&](const HeldForInputs& held) {
        if (held.since > before) return true;  // the step in which inputs took hold of it was undone, and can be redone no more
        if (held.input.kind == LiveInput::Kind::Handle) return change.handleGoals.contains(held.handle);
        const int point = plan().pointIndex(held.input.end);
        return std::ranges::any_of(change.goals, [&](const auto& goal) { return plan().pointIndex(goal.first) == point; });
    });
}

Result<void> Session::executeForInputs(const Json& command) {
    forInputs_ = true;
    const auto done = execute(command);
    forInputs_ = false;
    if (!done) return tl::unexpected(done.error());
    return {};
}

Result<void> Session::releaseInputs() {
    if (!performer_) return {};
    const InputFeed* feed = performer_->feed();
    const ParkedPerformer parked(performer_.get());
    followHeld();
    std::vector<Json> commands;
    for (const HeldForInputs& held : heldForInputs_)
        if (!feed || !feed->driver().moves(held.input))
            if (Json command = releasing(held); !command.is_null()) commands.push_back(std::move(command));
    for (const Json& command : commands)
        if (auto done = executeForInputs(command); !done) return done;
    return {};
}

bool Session::takeFrame() {
    if (!performer_) return false;
    performer_->refresh();
    const bool stepped = performer_->take();
    if (stepped && performer_->running()) {
        live_->bringPassed(performer_->frame().passed);
        if (performer_->frame().resting || performer_->frame().met) const ParkedPerformer parked(performer_.get());
    }
    if (performer_->takeMeeting()) tellOfMeetings();
    return stepped;
}

std::optional<Session::Performed> Session::performed() const {
    if (!performer_) return std::nullopt;
    return Performed{performer_->frame().step, performer_->frame().milliseconds, performer_->frame().input, performer_->leftOut()};
}

std::optional<double> Session::effectMilliseconds(EffectKind effect) const {
    if (!performer_ || !performer_->running()) return live_->effectMilliseconds(effect);
    const double ms = performer_->frame().effectMs[static_cast<std::size_t>(effect)];
    return ms < 0.0 ? std::nullopt : std::optional(ms);
}

std::optional<StageTimes> Session::stages() const {
    if (!character()) return std::nullopt;
    return performer_ ? performer_->stages() : live_->stages();
}

unsigned Session::warnings() const { return performer_ && performer_->running() ? performer_->frame().warnings : live_->warnings(); }

std::optional<Session::Recording> Session::recording() const {
    if (performer_ && performer_->running()) {
        const auto& take = performer_->recording();
        return take ? std::optional(Recording{*take, performer_->frame().recorded, performer_->frame().recordedSeconds, performer_->frame().recordingEnded}) : std::nullopt;
    }
    const auto& recorded = live_->recording();
    if (!recorded) return std::nullopt;
    return Recording{recorded->take.name, recorded->take.times.size(), recorded->take.duration(), !recorded->going};
}

bool Session::showsTake() const { return !(performer_ && performer_->running()) && live_->showsTake(); }

std::vector<Json> Session::script() const {
    const ParkedPerformer parked(performer_.get());
    return history_.script();
}

EffectCost Session::effectCost(EffectKind effect) const { return imomushi::effectCost(document(), responses_, effect); }

// ---- for studio and recovery -------------------------------------------------------------------------------------------

void Session::setListener(std::function<void(const Change&)> listener) { listener_ = std::move(listener); }

Project Session::project() {
    const ParkedPerformer parked(performer_.get());
    responses_.refresh();
    return {history_.document(), responses_.last(), {}};
}

// ---- what commands may do ----------------------------------------------------------------------------------------------

SessionAccess::SessionAccess(Session& owner) : session(owner), live(*owner.live_), responses(owner.responses_), services(owner.services_) {}

Result<bool> SessionAccess::undo(int count) {
    if (session.performer_) session.performer_->dropInputs();
    if (session.history_.inGesture()) {
        session.dropGesture();
        session.historyMoved_ = session.pendingChange_.pose = true;
        return false;
    }
    const Document before = session.document();
    if (auto ok = session.history_.undo(count); !ok) return tl::unexpected(ok.error());
    if (InputFeed* feed = session.performer_ ? session.performer_->feed() : nullptr) feed->forgetNumbers();
    session.historyMoved_ = true;
    live.followExchange(before);
    return true;
}

Result<bool> SessionAccess::redo(int count) {
    session.endGesture();
    const Document before = session.document();
    if (auto ok = session.history_.redo(count); !ok) return tl::unexpected(ok.error());
    session.historyMoved_ = true;
    live.followExchange(before);
    return true;
}

std::shared_ptr<const Take> SessionAccess::addTake(Take take, const Json& line) {
    Document after = session.document();
    take.id = after.nextId++;
    auto added = std::make_shared<const Take>(std::move(take));
    after.takes.emplace(added->id, added);
    session.history_.addStep({text(line, "do"), added->name}, std::move(after), {line});
    session.historyMoved_ = true;
    return added;
}

void SessionAccess::endStep(DocumentHistory::Step step) {
    session.history_.endGesture(std::move(step));
    session.historyMoved_ = true;
}

void SessionAccess::replace(Project project, std::filesystem::path path, bool saved, const Json& line) {
    for (const auto& [element, response] : project.responses) responses.store().insert(response.key, response.response);
    DocumentHistory history;
    history.setLimits(session.history_);
    history.replace(std::move(project.document), std::move(path), saved, line);
    session.former_.emplace(std::exchange(session.history_, std::move(history)), responses.replace({std::move(project.responses), {}}));
    session.historyMoved_ = true;
    live.replace();
    session.heldForInputs_.clear();
    session.pendingChange_.replaced = session.pendingChange_.pose = session.pendingChange_.responses = session.pendingChange_.file = true;
}

void SessionAccess::markSaved(const std::filesystem::path& path) {
    session.history_.markSaved(path);
    responses.markSaved();
    session.pendingChange_.file = true;
}

}  // namespace imomushi
