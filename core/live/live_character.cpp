// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/live_character.h"

#include <algorithm>
#include <chrono>
#include <new>

#include "core/base/try.h"
#include "core/document/command_support.h"
#include "core/document/effect_meetings.h"
#include "core/document/morph_weights.h"
#include "core/document/names.h"
#include "core/effects/contact_job.h"
#include "core/effects/ground_job.h"
#include "core/effects/smooth_joints_job.h"
#include "core/effects/touch_job.h"
#include "core/live/character_change.h"
#include "core/touch/touch_contact.h"

namespace imomushi {

namespace {

/// A static pose counts as found after this many steps of inverse kinematics at the latest: about a tenth of a second for a large character.
constexpr int kMostSolves = 200;
/// A pose that is shown without frames is lifted out of the ground in this many rounds at most, each of which leaves less than half of what was below.
constexpr int kLiftRounds = 8;
/// The same in a frame, where flesh came deep into the ground.
constexpr int kLiftsOfFrame = 4;

/// Frames on another thread for which there is room from the start: a quarter of an hour at 60 Hz.
constexpr std::size_t kFramesOfStretch = 1 << 16;
/// A pose whose points move less than this part of the skeleton in a frame has come as near as it can.
constexpr double kAtRest = 1e-6;

/// Flesh that met in the last frame is in the effect of the document from now on: no step of the history, as it passes with time. True: then the character must be built anew.
/// Not in a recording, which another character would end.
bool noteMeetings(const Character& character, const CharacterPlan& plan, bool recording, Document& document) {
    const auto* contact = character.input().effects.find<ContactEffect>();
    if (!contact || !contact->met || contact->met->empty() || recording) return false;
    for (const std::size_t e : *contact->met) document.effects[EffectKind::Contact].elements.insert(plan.elements[e]);
    return true;
}

void advanceGlides(Document& document, double seconds) {
    const auto advance = [seconds](auto& goals) {
        for (auto& [what, goal] : goals)
            if (goal.elapsed < goal.seconds) goal.elapsed = std::min(goal.seconds, goal.elapsed + seconds);
    };
    advance(document.goals);
    advance(document.handleGoals);
    advance(document.turns);
}

}  // namespace

LiveCharacter::LiveCharacter(DocumentHistory& history, DocumentResponses& responses) : history_(history), responses_(responses) { effectMs_.fill(-1.0); }

// ---- what it is --------------------------------------------------------------------------------------------------------

Result<std::shared_ptr<const CharacterPlan>> LiveCharacter::planOf(const Document& of) {
    const auto known = std::find_if(knownPlans_.begin(), knownPlans_.end(), [&](const KnownPlan& k) {
        return k.elements == of.elements && k.joints == of.joints && k.bones == of.bones && k.settings == of.settings && k.effects == of.effects;
    });
    if (known != knownPlans_.end()) {
        std::rotate(known, known + 1, knownPlans_.end());
        return knownPlans_.back().plan;
    }
    IMOMUSHI_TRY(auto planned, planCharacter(of));
    if (knownPlans_.size() == 2) knownPlans_.erase(knownPlans_.begin());
    knownPlans_.push_back({of.elements, of.joints, of.bones, of.settings, of.effects, std::make_shared<const CharacterPlan>(std::move(planned))});
    return knownPlans_.back().plan;
}

Result<Character*> LiveCharacter::built() {
    const auto revision = responses_.store().revision();  // before the look: others may insert meanwhile
    if (valid_ && responsesSeen_ != revision) valid_ = usesLatestResponses();
    responsesSeen_ = revision;
    try {
        if (!valid_) {
            if (auto ok = build(); !ok) return tl::unexpected(ok.error());
        } else if (!performanceValid_ && !error_) {
            if (auto ok = prepare(); !ok) return tl::unexpected(ok.error());
        }
    } catch (const std::bad_alloc&) {
        drop();
        throw;
    }
    if (error_) return tl::unexpected(*error_);
    return character_ ? &*character_ : nullptr;
}

std::shared_ptr<const BuiltCharacter> LiveCharacter::release() {
    const auto alive = built();
    if (!alive || !*alive) return nullptr;
    valid_ = false;
    auto given = std::make_shared<const BuiltCharacter>(BuiltCharacter{std::move(*character_), embeddedModels_});
    character_.reset();
    return given;
}

bool LiveCharacter::usesLatestResponses() const {
    if (error_) return false;
    responses_.refresh();
    for (std::size_t e = 0; e < plan_.elements.size(); ++e)
        if (responses_.fittingOf(plan_.elements[e]) != plan_.input.elements[e].response) return false;
    return true;
}

void LiveCharacter::leaveVerticesToOthers(bool leave) {
    leavesVertices_ = leave;
    for (std::size_t e = 0; character_ && e < plan_.elements.size(); ++e) character_->deformExternally(static_cast<int>(e), leave);
}

Result<void> LiveCharacter::build() {
    valid_ = true;
    ++builds_;
    error_.reset();
    shownTake_.reset();
    // Where flesh meets while a body moves, it goes on: only answers of its elements are others.
    const auto sameParts = [&](const KnownPlan& k) { return k.elements == document().elements && k.joints == document().joints && k.bones == document().bones; };
    if (!waitsToMeet(document().effects, EffectKind::Contact) || knownPlans_.empty() || !sameParts(knownPlans_.back())) performance_.reset();
    const auto planned = planOf(document());
    if (!planned) {
        character_.reset();
        error_ = planned.error();
        return tl::unexpected(*error_);
    }
    plan_ = **planned;
    if (const auto* contact = plan_.input.effects.find<ContactEffect>(); contact && contact->automatic) {
        ContactEffect asking = *contact;
        asking.met = std::make_shared<std::vector<std::size_t>>();
        plan_.input.effects.set(std::move(asking));
    }
    const std::shared_ptr<const BuiltCharacter> lent = std::exchange(reusable_, nullptr);
    if (lent) embeddedModels_ = lent->models;
    addRenderMeshes(plan_, document(), embeddedModels_);
    responses_.refresh();
    if (document().elements.empty() && document().bones.empty()) {
        character_.reset();
        return {};
    }
    for (std::size_t e = 0; e < plan_.elements.size(); ++e) plan_.input.elements[e].response = responses_.fittingOf(plan_.elements[e]);
    auto made = Character::build(plan_.input, lent ? &lent->character : character_ ? &*character_ : nullptr);
    if (!made) {
        character_.reset();
        error_ = made.error();
        return tl::unexpected(*error_);
    }
    character_ = std::move(*made);
    character_->keepExact(recording_.has_value());
    if (leavesVertices_) leaveVerticesToOthers(true);
    dropForeignPose();
    poseConverged_ = false;
    if (auto ok = prepare(); !ok) return ok;
    showPose();
    return {};
}

void LiveCharacter::dropForeignPose() {
    const Skeleton& skeleton = plan_.input.skeleton;
    Pose& pose = passing().pose;
    if (pose.points.size() != skeleton.points.size() || pose.frames.size() != skeleton.bones.size() || pose.roll.size() != skeleton.points.size()) pose = {};
}

Result<void> LiveCharacter::prepare() {
    performanceValid_ = true;
    const Effects& effects = document().effects;
    if (character_) character_->tune(this->effects());
    ++tunes_;
    if (!Performance::wanted(effects)) {
        performance_.reset();
        return {};
    }
    // Settings change while a body moves; what is turned on or off begins anew.
    const bool dynamic = effects.has(EffectKind::BoneDynamics) && !plan_.input.skeleton.bones.empty();
    if (performance_ && performance_->isDynamic() == dynamic && performance_->hasGround() == effects.has(EffectKind::Ground)) return performance_->set(effects);
    performance_.reset();
    IMOMUSHI_TRY(performance_, Performance::build(document(), plan_));
    seeFlesh();
    collectGoals();
    performance_->reset(posed(), goals_);
    return {};
}

Pose LiveCharacter::posed() const { return document().pose.points.empty() ? restPose(plan_.input.skeleton) : document().pose; }

Pose& LiveCharacter::ownPose() {
    Pose& pose = passing().pose;
    if (pose.points.empty()) pose = restPose(plan_.input.skeleton);
    return pose;
}

// ---- where it is -------------------------------------------------------------------------------------------------------

const Pose& LiveCharacter::shownPose() {
    if (!built()) return document().pose;
    return presentPose();
}

const Pose& LiveCharacter::presentPose() const { return shownTake_ ? *shownTake_ : performance_ ? performance_->pose() : document().pose; }

Result<Vec3> LiveCharacter::positionOf(const EndpointRef& end) {
    if (auto alive = built(); !alive) return tl::unexpected(alive.error());
    const auto point = static_cast<std::size_t>(plan_.pointIndex(end));
    if (shownTake_) return shownTake_->points[point];
    if (performance_) return performance_->pose().points[point];
    return document().pose.points.empty() ? plan_.input.skeleton.points[point] : document().pose.points[point];
}

Result<HandlePose> LiveCharacter::poseOf(const FaceRef& handle) {
    if (auto alive = built(); !alive) return tl::unexpected(alive.error());
    const int index = plan_.handleIndex(handle);
    if (!character_ || index < 0) return fail("no-such-handle", "The handle \"" + handle.face + "\" is not there.");
    return character_->shownHandle(index);
}

Result<HandlePose> LiveCharacter::carried(const FaceRef& handle, const HandlePose& world) {
    if (auto alive = built(); !alive) return tl::unexpected(alive.error());
    const int index = plan_.handleIndex(handle);
    if (!character_ || index < 0) return fail("no-such-handle", "The handle \"" + handle.face + "\" is not there.");
    const Eigen::Isometry3d carrier = character_->handleCarrier(index);
    const Eigen::Quaterniond turn(carrier.linear());
    return HandlePose{carrier.inverse() * world.at, (turn.conjugate() * world.rotation).normalized(), false};
}

Points LiveCharacter::positionsOf(PartId element) {
    if (const auto given = positions_.find(element); given != positions_.end()) return given->second;
    const auto alive = built();
    const int index = plan_.elementIndex(element);
    if (!alive || !*alive || index < 0) return document().elements.at(element)->mesh->body.vertices;
    return (*alive)->positions(index);
}

Points LiveCharacter::renderPositionsOf(PartId character) {
    const auto alive = built();
    const auto found = std::find(plan_.characters.begin(), plan_.characters.end(), character);
    if (!alive || !*alive || found == plan_.characters.end()) return document().characters.at(character)->model->mesh.body.vertices;
    return (*alive)->renderPositions(static_cast<int>(found - plan_.characters.begin()));
}

// ---- posing ------------------------------------------------------------------------------------------------------------

void LiveCharacter::collectGoals() {
    goals_.clear();
    for (const auto& [end, held] : document().goals) {
        IkGoal goal;
        goal.point = plan_.pointIndex(end);
        if (goal.point < 0) continue;
        const double done = held.seconds > 0.0 ? std::min(1.0, held.elapsed / held.seconds) : 1.0;
        goal.target = done < 1.0 ? Vec3(held.from + done * (held.target - held.from)) : held.target;
        goal.pinned = held.pinned;
        goal.hasRoll = held.roll.has_value();
        if (held.rotation) {
            goal.heldBone = plan_.boneIndex(end.bone);
            goal.rotation = Eigen::Quaterniond(held.rotation->data());
        }
        if (held.roll) goal.roll = done < 1.0 ? held.fromRoll + done * (*held.roll - held.fromRoll) : *held.roll;
        goals_.push_back(goal);
    }
}

Result<LiveCharacter::Convergence> LiveCharacter::converge() {
    if (auto alive = built(); !alive) return tl::unexpected(alive.error());
    Convergence solved;
    if (!character_) return solved;
    const auto start = std::chrono::steady_clock::now();
    collectGoals();
    solved.converged = goals_.empty();
    while (!solved.converged && solved.iterations < kMostSolves) {
        const auto report = character_->solvePose(goals_, ownPose());
        ++solved.iterations;
        solved.converged = report.converged;
        if (!report.finite) break;
    }
    showPose();
    solved.warnings = warnings();
    solved.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return solved;
}

Result<void> LiveCharacter::returnToRest() {
    if (auto alive = built(); !alive) return tl::unexpected(alive.error());
    if (!character_) return {};
    passing().pose = restPose(plan_.input.skeleton);
    collectGoals();
    bool converged = goals_.empty();
    for (int i = 0; i < kMostSolves && !converged; ++i) {
        const auto report = character_->solvePose(goals_, passing().pose);
        converged = report.converged || !report.finite;
    }
    return {};
}

void LiveCharacter::showPose() {
    if (!character_) return;
    shownTake_.reset();
    const Pose pose = posed();
    const bool raised = performance_ && !performance_->isDynamic();
    if (raised) {
        collectGoals();
        performance_->reset(pose, goals_);
    }
    applyHandles();
    applyTurns();
    applyMorphs();
    applyTouches();
    character_->update(performance_ ? performance_->pose() : pose);
    seeFlesh();
    if (raised) liftFlesh(pose);
    ++shows_;
}

void LiveCharacter::seeFlesh() {
    if (performance_ && character_) performance_->seeFlesh(groundFlesh(*character_), character_->pose().points);
}

void LiveCharacter::liftFlesh(const Pose& pose) {
    for (int round = 0; round < kLiftRounds && !performance_->holdsFlesh(); ++round) {
        performance_->reset(pose, goals_);
        character_->update(performance_->pose());
        seeFlesh();
    }
}

void LiveCharacter::jumpToPose() {
    if (!character_) return;
    if (performance_) {
        collectGoals();
        performance_->reset(posed(), goals_);
    }
    character_->stop();
    showPose();
    if (performance_ && performance_->isDynamic()) liftFlesh(posed());
    ++shows_;
}

bool LiveCharacter::putFinger(const Touch& touch) {
    const auto alive = built();
    if (!alive || !*alive) return false;
    const int element = plan_.elementIndex(touch.element);
    if (element < 0 || !setFinger(*character_, element, touch.finger, touch.point, touch.to, touch.radius)) return false;
    showPose();
    return true;
}

bool LiveCharacter::applyHandles() {
    bool moved = false;
    for (std::size_t i = 0; i < plan_.handles.size(); ++i) {
        const int handle = static_cast<int>(i);
        const FaceRef& ref = plan_.handles[i];
        const auto goal = document().handleGoals.find(ref);
        HandlePose pose;
        if (goal == document().handleGoals.end()) {
            const auto& of = plan_.input.joints[static_cast<std::size_t>(plan_.input.handles[i].joint)].faces[0];
            pose.at = plan_.input.elements[static_cast<std::size_t>(of.element)].faces[static_cast<std::size_t>(of.face)].frame.origin;
        } else {
            pose = goal->second.now();
        }
        if (character_->handlePose(handle) == pose) continue;
        moved = character_->setHandle(handle, pose) || moved;
    }
    return moved;
}

bool LiveCharacter::applyTurns() {
    bool moved = false;
    for (const CharacterPlan::Rigid& rigid : plan_.rigid) {
        const auto goal = document().turns.find(rigid.part);
        moved = character_->setTurn(rigid.element, rigid.index, goal == document().turns.end() ? Eigen::Quaterniond::Identity() : goal->second.now()) || moved;
    }
    return moved;
}

bool LiveCharacter::applyMorphs() {
    bool moved = false;
    for (std::size_t m = 0; m < plan_.characters.size(); ++m) {
        const CharacterSource& character = *document().characters.at(plan_.characters[m]);
        for (std::size_t t = 0; t < plan_.input.renderMeshes[m]->morphs(); ++t)
            moved = character_->setMorph(static_cast<int>(m), static_cast<int>(t), morphWeight(document(), character, static_cast<int>(t))) || moved;
    }
    return moved;
}

void LiveCharacter::applyTouches() {
    if (!document().effects.has(EffectKind::Touch)) return;
    for (std::size_t e = 0; e < plan_.elements.size(); ++e) {
        const int element = static_cast<int>(e);
        std::array<const Touch*, TouchContact::kFingers> down = {};
        for (const Touch& touch : document().touches)
            if (touch.element == plan_.elements[e]) down[static_cast<std::size_t>(touch.finger)] = &touch;
        for (int i = 0; i < TouchContact::kFingers; ++i)
            if (const Touch* touch = down[static_cast<std::size_t>(i)])
                setFinger(*character_, element, i, touch->point, touch->to, touch->radius);
            else
                liftFinger(*character_, element, i);
    }
}

// ---- time --------------------------------------------------------------------------------------------------------------

bool LiveCharacter::swings() const {
    if (shownTake_) return false;
    if (awake_ && (!character_->resting() || (performance_ && (performance_->isDynamic() || !performance_->resting())))) return true;
    const auto glide = [](const auto& goals) { return std::any_of(goals.begin(), goals.end(), [](const auto& goal) { return goal.second.elapsed < goal.second.seconds; }); };
    return glide(document().goals) || glide(document().handleGoals) || glide(document().turns);
}

bool LiveCharacter::moving() {
    const auto alive = built();
    return alive && *alive && swings();
}

bool LiveCharacter::apply(const LiveInput& input) {
    Document& document = passing();
    if (input.handle >= 0) {
        const auto held = document.handleGoals.find(plan_.handles[static_cast<std::size_t>(input.handle)]);
        if (held == document.handleGoals.end() || !held->second.target.held) return false;
        held->second.target.at = input.target;
        held->second.target.rotation = input.rotation;
        held->second.elapsed = held->second.seconds;
    } else {
        // An end of another bone may be the same point.
        const int point = plan_.pointIndex(input.end);
        const auto held = std::find_if(document.goals.begin(), document.goals.end(), [&](const auto& goal) { return plan_.pointIndex(goal.first) == point; });
        if (point < 0 || held == document.goals.end()) return false;
        held->second.target = input.target;
        if (input.hasRoll) held->second.roll = input.roll;
        held->second.elapsed = held->second.seconds;
    }
    wake(true);
    if (!performed_) {
        history_.noteInput(lineOf(input));
        return true;
    }
    const std::size_t frame = performedFrames_.size();
    for (auto known = performedInputs_.rbegin(); known != performedInputs_.rend() && known->frame == frame; ++known)
        if (known->input.sameTarget(input)) {
            known->input = input;
            return true;
        }
    performedInputs_.push_back({frame, input});
    return true;
}

Json LiveCharacter::lineOf(const LiveInput& input) const {
    Json line{{"to", json(input.target)}};
    if (input.handle >= 0) {
        line["endpoint"] = plan_.handles[static_cast<std::size_t>(input.handle)].face;
        const Eigen::Vector4d& q = input.rotation.coeffs();
        line["rotation"] = {q.x(), q.y(), q.z(), q.w()};
    } else {
        line["endpoint"] = endpointText(document(), input.end);
        if (input.hasRoll) line["roll"] = input.roll;
    }
    return line;
}

bool LiveCharacter::inMotion() const {
    return (recording_ && recording_->going) || swings() || (!shownTake_ && approaching_ && !document().goals.empty());
}

void LiveCharacter::stepFrame(double seconds) {
    const auto alive = built();
    if (!alive || !*alive) return;
    stepOn(seconds);
    if (met_) valid_ = met_ = false;
    history_.noteFrame(seconds);
}

void LiveCharacter::stepOn(double seconds) {
    const bool wasTake = shownTake_.has_value();
    if (wasTake) shownTake_.reset();
    Document& document = passing();
    advanceGlides(document, seconds);
    collectGoals();
    pointsBefore_ = document.pose.points;
    bool converged = true;
    // What is converged is not solved again: it would go on changing by rounding, and nothing would ever rest.
    if (!goals_.empty() && !(poseConverged_ && goals_ == convergedGoals_)) {
        converged = poseConverged_ = character_->solvePose(goals_, ownPose()).converged;
        convergedGoals_ = goals_;
    }
    if (!positions_.empty()) positions_.clear();
    const bool handled = applyHandles(), turned = applyTurns(), morphed = applyMorphs();
    applyTouches();
    if (performance_) {
        performance_->step(seconds, ownPose(), goals_);
        character_->update(performance_->pose(), seconds);
        seeFlesh();
        int round = 0;
        for (; round < kLiftsOfFrame && performance_->lift(); ++round) {
            character_->correct(performance_->pose());
            seeFlesh();
        }
        if (performance_->liftWhole(groundDepths(*character_))) {
            character_->shift(performance_->pose());
            seeFlesh();
        }
    } else if (handled || turned || morphed || !document.pose.points.empty() || awake_ || wasTake || !character_->resting()) {
        character_->update(ownPose(), seconds);
    }
    ++shows_;
    measureEffects();
    met_ = noteMeetings(*character_, plan_, recording_.has_value(), document) || met_;
    awake_ = !converged || (performance_ && !performance_->resting()) || !character_->resting();
    const auto& points = document.pose.points;
    double moved = pointsBefore_.size() == points.size() ? 0.0 : 1.0, size = 0.0;
    for (std::size_t i = 0; i < points.size() && i < pointsBefore_.size(); ++i) {
        moved = std::max(moved, (points[i] - pointsBefore_[i]).norm());
        size = std::max(size, (points[i] - points[0]).norm());
    }
    approaching_ = approaching_ && !(moved <= kAtRest * size);
    recordFrame(seconds);
}

// ---- time on another thread --------------------------------------------------------------------------------------------

void LiveCharacter::beginPerforming() {
    performedFrames_.reserve(kFramesOfStretch);
    performedInputs_.reserve(kFramesOfStretch);
    performed_ = history_.document();
    met_ = false;
}

void LiveCharacter::advance(double seconds) noexcept {
    try {
        stepOn(seconds);
        performedFrames_.push_back(seconds);
    } catch (const std::bad_alloc&) {
        if (recording_) recording_->going = false;
    }
}

void LiveCharacter::endPerforming() noexcept {
    Document& document = history_.passing();
    document.pose = std::move(performed_->pose);
    document.goals = std::move(performed_->goals);
    document.handleGoals = std::move(performed_->handleGoals);
    document.turns = std::move(performed_->turns);
    if (met_) document.effects = std::move(performed_->effects);
    performed_.reset();
    if (met_) valid_ = met_ = false;
    try {
        auto given = performedInputs_.begin();
        for (std::size_t f = 0; f < performedFrames_.size(); ++f) {
            for (; given != performedInputs_.end() && given->frame == f; ++given) history_.noteInput(lineOf(given->input));
            history_.noteFrame(performedFrames_[f]);
        }
    } catch (const std::bad_alloc&) {
        history_.forgetScript();
    }
    performedFrames_.clear();
    performedInputs_.clear();
}

void LiveCharacter::measureEffects() {
    effectMs_.fill(-1.0);
    const auto measured = [&](EffectKind kind, double milliseconds) { effectMs_[static_cast<std::size_t>(kind)] = milliseconds; };
    // An effect that is on but waits for a precompute takes no time.
    for (std::size_t k = 0; k < kEffects; ++k)
        if (const auto kind = static_cast<EffectKind>(k); document().effects.has(kind) && effectDescriptor(kind).isOnCharacter()) measured(kind, 0.0);
    for (const auto& [effect, milliseconds] : character_->stats().effects) measured(*effectNamed(effect), milliseconds);
    if (performance_ && performance_->isDynamic()) measured(EffectKind::BoneDynamics, performance_->milliseconds());
    if (performance_ && !performance_->isDynamic()) effectMs_[static_cast<std::size_t>(EffectKind::Ground)] += performance_->milliseconds();
}

StageTimes stageTimes(const Character& character) {
    const Character::Stats& stats = character.stats();
    const double equilibrium = stats.effectMs(SmoothJointsEffect::kName);
    return {stats.poseMs, stats.jointsMs - equilibrium, equilibrium, stats.productMs, stats.normalsMs};
}

std::optional<double> LiveCharacter::effectMilliseconds(EffectKind effect) const {
    const double ms = effectMs_[static_cast<std::size_t>(effect)];
    return ms < 0.0 ? std::nullopt : std::optional(ms);
}

unsigned LiveCharacter::warnings() const {
    if (!character_) return 0;
    const bool held = performance_ && !shownTake_ && (performance_->warnings() & static_cast<unsigned>(DynamicsWarning::HeldByGround)) != 0;
    return character_->stats().warnings | (held ? static_cast<unsigned>(FrameWarning::HeldByGround) : 0u);
}

bool LiveCharacter::droppedTime() const { return performance_ && (performance_->warnings() & static_cast<unsigned>(DynamicsWarning::TimeDropped)) != 0; }

std::vector<std::string> LiveCharacter::warningTexts(unsigned warnings) const {
    std::vector<std::string> texts = plan_.warnings;
    const auto has = [&](FrameWarning bit) { return (warnings & static_cast<unsigned>(bit)) != 0; };
    if (has(FrameWarning::BasisLosesTwist))
        texts.emplace_back("The pose twists or shifts a joint face in its plane, which the basis \"paper\" cannot follow: set the character's basis to \"affine\".");
    if (has(FrameWarning::TargetOutOfReach))
        texts.emplace_back("A target is out of reach; the endpoint stays as near as its bones can stretch (max-stretch).");
    if (has(FrameWarning::HeldByGround))
        texts.emplace_back("A target is in the ground, which keeps its endpoint above: move the target up, or lower the ground.");
    if (document().effects.has(EffectKind::PreviousModel) && document().settings.basis != BasisKind::Full)
        texts.emplace_back("The previous model works in the basis \"full\" alone and does nothing now: set the character's basis to \"full\", and precompute.");
    if (has(FrameWarning::Diverged))
        texts.emplace_back("The explicit dynamics of the previous model diverged; its joint faces stand still at their last good place: choose a smaller step or a softer shear-modulus.");
    if (has(FrameWarning::LoadsBounded))
        texts.emplace_back("Gravity or pressure is stronger than flesh so soft can show without folding, and acts less than asked for: raise its shear-modulus, or lower the pressure.");
    if (has(FrameWarning::ContactsBounded))
        texts.emplace_back("Flesh is pressed in more places than contact looks at; the deepest are held, others may cross: move what presses it apart, or give contact fewer patches.");
    if (has(FrameWarning::PoseRefused))
        texts.emplace_back("A pose was not finite and was refused; the last good pose stays: release the endpoints or return to rest.");
    return texts;
}

// ---- following the document --------------------------------------------------------------------------------------------

Result<void> LiveCharacter::follow(const Document& before) {
    const DocumentChange change = difference(before, document());
    for (const auto& [id, element] : change.elements)
        if (const auto now = document().elements.find(id); now == document().elements.end() || (element && element->mesh != now->second->mesh)) positions_.erase(id);
    if (movesJointPoints(change, document())) {
        const auto was = planOf(before), is = planOf(document());
        if (!is) return tl::unexpected(is.error());
        valid_ = false;
        performance_.reset();
        if (followSkeleton(history_.edit(), was ? was->get() : nullptr, **is))
            if (const auto solved = converge(); !solved) return tl::unexpected(solved.error());
    } else if (changesCharacter(change, document())) {
        valid_ = false;
    }
    if (!change.effects) return {};
    performanceValid_ = false;
    const auto alive = built();
    return alive ? Result<void>() : tl::unexpected(alive.error());
}

void LiveCharacter::takeBack(const Document& failed) noexcept {
    try {
        const DocumentChange change = difference(failed, document());
        const bool rebuild = changesCharacter(change, document()) || error_;
        if (rebuild) valid_ = false;
        if (change.effects) performanceValid_ = false;
        if (change.posing()) poseConverged_ = false;
        if ((rebuild || !change.empty()) && built() && !shownTake_) showPose();
    } catch (const std::exception&) {  // no memory
        drop();
    }
}

void LiveCharacter::followExchange(const Document& before) noexcept {
    positions_.clear();
    try {
        const DocumentChange change = difference(before, document());
        if (change.structure() && changesCharacter(change, document())) valid_ = false;
        if (change.effects) performanceValid_ = false;
        if (built()) jumpToPose();
    } catch (const std::exception&) {  // no memory
        drop();
    }
}

void LiveCharacter::drop() noexcept {
    valid_ = poseConverged_ = false;
    error_.reset();
    character_.reset();
    performance_.reset();
    shownTake_.reset();
    positions_.clear();
}

void LiveCharacter::replace() {
    knownPlans_.clear();
    positions_.clear();
    recording_.reset();
    valid_ = false;
}

void LiveCharacter::wake(bool posed) {
    if (posed) poseConverged_ = false;
    approaching_ = approaching_ || posed;
    awake_ = true;
}

void LiveCharacter::leaveTake() {
    if (shownTake_ && built()) showPose();
}

}  // namespace imomushi
