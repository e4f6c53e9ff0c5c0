// SPDX-License-Identifier: GPL-3.0-or-later
// How time passes for the live character: one frame, here or on another thread.
#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/effects/contact_job.h"
#include "core/effects/ground_job.h"
#include "core/effects/smooth_joints_job.h"
#include "core/live/live_character.h"

namespace imomushi {

namespace {

/// A frame whose flesh came deep into the ground is lifted in this many rounds at most. What is left then, about 1 % of its size, lifts the whole character.
constexpr int kLiftsOfFrame = 2;

/// Frames on another thread for which there is room from the start: a quarter of an hour at 60 Hz.
constexpr std::size_t kFramesOfStretch = 1 << 16;
/// Inputs there, of which the script keeps all: an hour of one hand, some minutes of a face and a body. With more of them there is no script.
constexpr std::size_t kMostInputsOfStretch = 1 << 18;
/// A pose whose points move less than this part of the skeleton in 1/60 s has come as near as it can.
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
    if (performed_ && !scriptForgotten_ && performedInputs_.size() == performedInputs_.capacity()) performedInputs_.reserve(2 * performedInputs_.size() + 1);  // before anything changes
    Document& document = passing();
    if (input.kind == LiveInput::Kind::Morph) {
        const auto character = document.characters.find(input.morph.character);
        if (character == document.characters.end() || input.morph.target < 0 || static_cast<std::size_t>(input.morph.target) >= character->second->model->morphs.size()) return false;
        // On another thread all are there: see beginPerforming().
        if (!performed_ && input.weight == character->second->model->morphs[static_cast<std::size_t>(input.morph.target)].atRest)
            document.morphs.erase(input.morph);
        else
            document.morphs.insert_or_assign(input.morph, input.weight);
    } else if (input.kind == LiveInput::Kind::Effect) {
        auto& values = document.effects[input.effect].values;
        if (input.value < 0 || static_cast<std::size_t>(input.value) >= values.size()) return false;
        values[static_cast<std::size_t>(input.value)] = input.weight;
        tuneAsPassed(input.effect);
    } else if (input.kind == LiveInput::Kind::Handle) {
        if (input.handle < 0 || input.handle >= static_cast<int>(plan_.handles.size())) return false;
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
    wake(!input.isNumber());
    if (!performed_) {
        if (history_.hasScript()) history_.noteInput(lineOf(input));
        return true;
    }
    const std::size_t frame = performedFrames_.size();
    for (auto known = performedInputs_.rbegin(); known != performedInputs_.rend() && known->frame == frame; ++known)
        if (known->input.sameTarget(input)) {
            known->input = input;
            return true;
        }
    // A script so long has no room for its lines either.
    scriptForgotten_ = scriptForgotten_ || performedInputs_.size() >= kMostInputsOfStretch;
    if (!scriptForgotten_) performedInputs_.push_back({frame, input});
    return true;
}

Json LiveCharacter::lineOf(const LiveInput& input) const {
    if (input.kind == LiveInput::Kind::Morph) {
        const CharacterSource& character = *document().characters.at(input.morph.character);
        return {{"character", character.name}, {"morph", character.model->morphs[static_cast<std::size_t>(input.morph.target)].name}, {"weight", input.weight}};
    }
    if (input.kind == LiveInput::Kind::Effect) {
        const auto& [property, first] = propertyOf(input);
        Json line{{"effect", effectName(input.effect)}, {"property", property.name}, {"value", input.weight}};
        if (property.size > 1) line["axis"] = input.value - first;
        return line;
    }
    Json line{{"to", json(input.target)}};
    if (input.kind == LiveInput::Kind::Handle) {
        line["endpoint"] = plan_.handles[static_cast<std::size_t>(input.handle)].face;
        const Eigen::Vector4d& q = input.rotation.coeffs();
        line["rotation"] = {q.x(), q.y(), q.z(), q.w()};
    } else {
        line["endpoint"] = endpointText(document(), input.end);
        if (input.hasRoll) line["roll"] = input.roll;
    }
    return line;
}

void LiveCharacter::tuneAsPassed(EffectKind driven) {
    const Effects& effects = document().effects;
    if (!tuned_) tuned_ = settingsOfEffects();
    drivenEffects_ = true;
    for (const EffectKind kind : {driven, EffectKind::Contact}) {  // which knows of the ground
        EffectSettings* settings = (*tuned_)[static_cast<std::size_t>(kind)].get();
        if (!settings || !character_) continue;
        readNumbers(effects, kind, *settings);
        character_->tune(*settings);
        if (driven != EffectKind::Ground) break;
    }
    const bool ofBones = driven == EffectKind::BoneDynamics || driven == EffectKind::Ground || driven == EffectKind::Gravity;
    if (performance_ && ofBones) (void)performance_->set(effects);  // within their ranges
}

std::array<std::shared_ptr<EffectSettings>, kEffects> LiveCharacter::settingsOfEffects() const {
    std::array<std::shared_ptr<EffectSettings>, kEffects> all;
    for (const auto& settings : effects())
        if (const auto kind = effectNamed(settings->name())) all[static_cast<std::size_t>(*kind)] = std::const_pointer_cast<EffectSettings>(settings);  // nobody else has them
    return all;
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
        converged = poseConverged_ = character_->solvePose(goals_, ownPose(), seconds).converged;
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
    approaching_ = approaching_ && !(moved <= kAtRest * std::min(60.0 * seconds, 1.0) * size);
    recordFrame(seconds);
}

// ---- time on another thread --------------------------------------------------------------------------------------------

void LiveCharacter::beginPerforming() {
    performedFrames_.reserve(kFramesOfStretch);
    performedInputs_.reserve(kFramesOfStretch);
    scriptForgotten_ = false;
    performed_ = history_.document();
    // Room for all weights that inputs may give.
    for (const auto& [id, character] : performed_->characters)
        for (std::size_t t = 0; t < character->model->morphs.size(); ++t)
            performed_->morphs.try_emplace({id, static_cast<std::int32_t>(t)}, character->model->morphs[t].atRest);
    tuned_ = settingsOfEffects();  // steps take no memory for it
    met_ = drivenEffects_ = false;
}

void LiveCharacter::advance(double seconds) noexcept {
    try {
        stepOn(seconds);
        performedFrames_.push_back(seconds);
    } catch (const std::bad_alloc&) {
        if (recording_) recording_->going = false;
    }
}

void LiveCharacter::passed(PassedTime& passed) const {
    const Document& document = this->document();
    passed.pose = document.pose;
    const auto values = [](const auto& map, auto& to) {
        to.clear();
        for (const auto& [key, value] : map) to.push_back(value);
    };
    values(document.goals, passed.goals);
    values(document.handleGoals, passed.handles);
    values(document.turns, passed.turns);
    values(document.morphs, passed.morphs);
    passed.numbers.clear();
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto& of = document.effects[static_cast<EffectKind>(k)].values;
        passed.numbers.insert(passed.numbers.end(), of.begin(), of.end());
    }
}

void LiveCharacter::bringPassed(const PassedTime& passed) {
    Document& document = history_.passing();
    document.pose = passed.pose;
    const auto bring = [](const auto& values, auto& map) {
        auto value = values.begin();
        for (auto& [key, to] : map) to = *value++;
    };
    bring(passed.goals, document.goals);
    bring(passed.handles, document.handleGoals);
    bring(passed.turns, document.turns);
    auto weight = passed.morphs.begin();
    for (const auto& [id, character] : document.characters)
        for (std::size_t t = 0; t < character->model->morphs.size(); ++t, ++weight) {
            const MorphRef morph{id, static_cast<std::int32_t>(t)};
            if (*weight == character->model->morphs[t].atRest) document.morphs.erase(morph);
            else document.morphs.insert_or_assign(morph, *weight);
        }
    auto number = passed.numbers.begin();
    for (std::size_t k = 0; k < kEffects; ++k)
        for (double& value : document.effects[static_cast<EffectKind>(k)].values) value = *number++;
}

void LiveCharacter::endPerforming() noexcept {
    if (!performed_) return;
    Document& document = history_.passing();
    document.pose = std::move(performed_->pose);
    document.goals = std::move(performed_->goals);
    document.handleGoals = std::move(performed_->handleGoals);
    document.turns = std::move(performed_->turns);
    document.morphs = std::move(performed_->morphs);
    std::erase_if(document.morphs, [&](const auto& set) { return set.second == document.characters.at(set.first.character)->model->morphs[static_cast<std::size_t>(set.first.target)].atRest; });
    if (met_ || drivenEffects_) document.effects = std::move(performed_->effects);
    if (std::exchange(drivenEffects_, false)) ++tunes_;
    performed_.reset();
    if (met_) valid_ = met_ = false;
    if (scriptForgotten_) history_.forgetScript();
    try {
        if (scriptForgotten_) performedFrames_.clear();
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

double LiveCharacter::landing() const { return character_ ? groundLanding(*character_) : 0.0; }

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

}  // namespace imomushi
