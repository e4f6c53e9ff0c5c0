// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/live_character.h"

#include <algorithm>
#include <chrono>
#include <new>

#include "core/base/try.h"
#include "core/document/effect_meetings.h"
#include "core/document/morph_weights.h"
#include "core/effects/contact_job.h"
#include "core/effects/ground_job.h"
#include "core/effects/touch_job.h"
#include "core/live/character_change.h"
#include "core/touch/touch_contact.h"

namespace imomushi {

namespace {

/// A static pose counts as found after this many steps of inverse kinematics at the latest: about a tenth of a second for a large character.
constexpr int kMostSolves = 200;
/// A pose that is shown without frames is lifted out of the ground in this many rounds at most, each of which leaves less than half of what was below.
constexpr int kLiftRounds = 8;
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
    if (performance_ && (!waitsToMeet(document().effects, EffectKind::Contact) || knownPlans_.empty() || !sameParts(knownPlans_.back()))) formerPerformance_ = std::exchange(performance_, std::nullopt);
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
    if (lent) embeddedModels_.take(lent->models);
    addRenderMeshes(plan_, document(), embeddedModels_);
    responses_.refresh();
    if (document().elements.empty() && document().bones.empty()) {
        character_.reset();
        return {};
    }
    for (std::size_t e = 0; e < plan_.elements.size(); ++e) plan_.input.elements[e].response = responses_.fittingOf(plan_.elements[e]);
    auto made = Character::build(plan_.input, {lent ? &lent->character : nullptr, character_ ? &*character_ : nullptr, former_ ? &*former_ : nullptr});
    if (character_) former_ = std::exchange(character_, std::nullopt);
    if (!made) {
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
    tuned_.reset();
    ++tunes_;
    if (!Performance::wanted(effects)) {
        formerPerformance_.reset();
        performance_.reset();
        return {};
    }
    // Settings change while a body moves; what is turned on or off begins anew.
    const bool dynamic = effects.has(EffectKind::BoneDynamics) && !plan_.input.skeleton.bones.empty();
    if (performance_ && performance_->isDynamic() == dynamic && performance_->hasGround() == effects.has(EffectKind::Ground)) return performance_->set(effects);
    performance_.reset();
    IMOMUSHI_TRY(performance_, Performance::build(document(), plan_));
    // What swings goes on where elements or bones were edited.
    const auto former = std::exchange(formerPerformance_, std::nullopt);
    const bool goesOn = former && performance_->takeMotion(*former);
    seeFlesh();
    collectGoals();
    if (goesOn) return {};
    performance_->reset(posed(), goals_);
    if (former) performance_->takeMotionOfBones(*former);
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

// ---- following the document --------------------------------------------------------------------------------------------

Result<void> LiveCharacter::follow(const Document& before) {
    const DocumentChange change = difference(before, document());
    for (const auto& [id, element] : change.elements)
        if (const auto now = document().elements.find(id); now == document().elements.end() || (element && element->mesh != now->second->mesh)) positions_.erase(id);
    if (movesJointPoints(change, document())) {
        const auto was = planOf(before), is = planOf(document());
        if (!is) return tl::unexpected(is.error());
        valid_ = false;
        if (performance_) formerPerformance_ = std::exchange(performance_, std::nullopt);  // it is of the skeleton before
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
        if (!built()) return;
        // What moves goes on where no pose was exchanged: a name, a material, an effect.
        if (change.unknown || change.posing()) jumpToPose();
        else if (change.effects || change.has(&DocumentChange::takes)) leaveTake();
    } catch (const std::exception&) {  // no memory
        drop();
    }
}

void LiveCharacter::drop() noexcept {
    valid_ = poseConverged_ = false;
    error_.reset();
    character_.reset();
    former_.reset();
    performance_.reset();
    formerPerformance_.reset();
    shownTake_.reset();
    positions_.clear();
}

void LiveCharacter::replace() {
    knownPlans_.clear();
    former_.reset();
    performance_.reset();
    formerPerformance_.reset();
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
