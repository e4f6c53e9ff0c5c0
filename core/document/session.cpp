// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

#include "core/base/parallel.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/document/project_file.h"
#include "core/document/session_state.h"

namespace imomushi {

namespace {

/// A static pose counts as found after this many relaxation steps at the latest: about a tenth of a second for a large character.
constexpr int kSettleSteps = 200;

bool finite(const Json& value) {
    if (value.is_number_float()) return std::isfinite(value.get<double>());
    if (!value.is_structured()) return true;
    return std::all_of(value.begin(), value.end(), [](const Json& part) { return finite(part); });
}

/// What an undo step says it was done to.
std::string subjectOf(const Json& arguments) {
    for (const char* key : {"effect", "name", "element", "endpoint", "target", "path", "a", "bone", "take"})
        if (const Json* value = find(arguments, key); value && value->is_string()) return value->get<std::string>();
    return {};
}

bool sameFaces(const std::vector<JointFace>& a, const std::vector<JointFace>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const JointFace& p, const JointFace& q) {
        return p.name == q.name && p.frame.origin == q.frame.origin;
    });
}

/// Whether joint points can have moved: more than names and materials differ.
bool touchesSkeleton(const DocumentChange& change, const Document& after) {
    if (!change.bones.empty() || !change.joints.empty()) return true;
    return std::any_of(change.elements.begin(), change.elements.end(), [&](const auto& part) {
        const auto now = after.elements.find(part.first);
        if (!part.second || now == after.elements.end()) return true;
        return part.second->mesh != now->second->mesh || !sameFaces(part.second->faces, now->second->faces);
    });
}

/// Whether the same effects act on the same elements: numbers alone change while a character moves.
bool sameOnCharacter(const Effects& a, const Effects& b) {
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto kind = static_cast<EffectKind>(k);
        if (kind == EffectKind::BoneDynamics || kind == EffectKind::Ground) continue;
        if (a.has(kind) != b.has(kind) || (a.has(kind) && a[kind].elements != b[kind].elements)) return false;
        if (kind == EffectKind::Touch && a.has(kind) && a.number(kind, "patches") != b.number(kind, "patches")) return false;
    }
    return true;
}

/// Whether the live character is made of other things than before.
bool touchesCharacter(const DocumentChange& change, const Document& after) {
    if (touchesSkeleton(change, after)) return true;
    if (change.settings && !(*change.settings == after.settings)) return true;
    if (change.effects && !sameOnCharacter(*change.effects, after.effects)) return true;
    return std::any_of(change.elements.begin(), change.elements.end(), [&](const auto& part) {
        const Element& was = *part.second;
        const Element& is = *after.elements.at(part.first);
        return was.nu != is.nu || was.stiffness != is.stiffness || was.jointPlanes != is.jointPlanes;
    });
}

/// Whether a response is one of this element: the same free vertices and bases of the same kind.
bool fits(const ElementResponse& response, const Element& element, const BasisChoice& basis) {
    if (response.bases.size() != element.faces.size()) return false;
    const auto count = static_cast<std::size_t>(element.mesh->body.vertices.rows());
    std::vector<bool> held(count, false);
    for (std::size_t f = 0; f < element.faces.size(); ++f) {
        if (!(response.bases[f] == FaceBasis::on(element.mesh->body, element.faces[f], basis))) return false;
        for (const std::int32_t v : element.faces[f].vertices) held[static_cast<std::size_t>(v)] = true;
    }
    std::size_t next = 0;
    for (std::size_t v = 0; v < count; ++v) {
        if (held[v]) continue;
        if (next == response.freeVertices.size() || static_cast<std::size_t>(response.freeVertices[next]) != v) return false;
        ++next;
    }
    return next == response.freeVertices.size() && response.response.rows() == static_cast<Eigen::Index>(3 * next) &&
           response.response.cols() == response.columns() && response.stiffness.rows() == response.columns() &&
           response.tractions.rows() == (basis == BasisKind::Full ? response.columns() : 0);
}

}  // namespace

// ---- responses -----------------------------------------------------------------------------------------------------

std::shared_ptr<const ElementResponse> ResponseCache::find(const ContentKey& key) const {
    const std::lock_guard lock(mutex_);
    const auto found = responses_.find(key);
    return found == responses_.end() ? nullptr : found->second;
}

void ResponseCache::insert(const ContentKey& key, std::shared_ptr<const ElementResponse> response) {
    const std::lock_guard lock(mutex_);
    responses_.insert_or_assign(key, std::move(response));
    revision_.fetch_add(1, std::memory_order_release);
}

std::vector<std::pair<ContentKey, std::shared_ptr<const ElementResponse>>> ResponseCache::all() const {
    const std::lock_guard lock(mutex_);
    return {responses_.begin(), responses_.end()};
}

std::uint64_t ResponseCache::revision() const {
    return revision_.load(std::memory_order_acquire);
}

Session::State::Asked Session::State::askedOf(PartId element) const {
    const Effects& effects = document.effects;
    Asked asked;
    asked.basis = document.settings.basis;
    asked.loads = effects.has(EffectKind::Gravity, element) || effects.has(EffectKind::Inflate, element);
    if (effects.has(EffectKind::Touch, element)) asked.touch = static_cast<int>(std::lround(effects.number(EffectKind::Touch, "patches")));
    return asked;
}

ResponseInput Session::State::inputOf(PartId element) const {
    const Element& e = *document.elements.at(element);
    ResponseInput input;
    input.mesh = e.mesh;
    input.faces = e.faces;
    input.nu = e.nu;
    const Asked asked = askedOf(element);
    input.basis = asked.basis;
    input.loads = asked.loads;
    input.touch = asked.touch;
    input.solverMesh = e.solverMesh;
    input.threads = document.settings.threads > 0 ? document.settings.threads : hardwareThreads();
    return input;
}

Session::State::KnownKey& Session::State::keysOf(PartId element) const {
    const auto& part = document.elements.at(element);
    KnownKey& known = keys[element];
    if (const Asked asked = askedOf(element); known.element != part || !(known.asked == asked)) {
        ResponseInput input = inputOf(element);
        known = {part, asked, responseKey(input), {}};
        input.nu = 0.0;
        input.loads = false;
        input.touch = 0;
        known.shape = responseKey(input);
    }
    return known;
}

const Session::SharedResponse* Session::State::sharedOf(PartId element) const {
    std::map<PartId, Asked> asked;
    for (const auto& [id, part] : document.elements) asked.emplace(id, askedOf(id));
    if (sharing.asked != asked || sharing.elements != document.elements) {
        Sharing now;
        now.elements = document.elements;
        now.asked = std::move(asked);
        std::vector<PartId> computed;
        for (const auto& [id, part] : document.elements) {
            if (part->faces.empty()) continue;
            bool found = false;
            for (const PartId first : computed) {
                const std::pair pair(keysOf(first).key, keysOf(id).key);
                auto known = sharing.pairs.find(pair);
                std::shared_ptr<const Congruence> how;
                if (known != sharing.pairs.end()) {
                    how = known->second;
                } else if (auto congruence = findCongruence(inputOf(first), inputOf(id))) {
                    how = std::make_shared<const Congruence>(std::move(*congruence));
                }
                now.pairs.emplace(pair, how);
                if (!how) continue;
                now.shared[id] = {first, how};
                found = true;
                break;
            }
            if (!found) computed.push_back(id);
        }
        sharing = std::move(now);
    }
    const auto found = sharing.shared.find(element);
    return found == sharing.shared.end() ? nullptr : &found->second;
}

ResponseEstimate Session::State::estimateOf(PartId element) const {
    if (document.elements.at(element)->faces.empty()) return {};
    const ResponseInput input = inputOf(element);
    if (const SharedResponse* shared = sharedOf(element)) return carryEstimate(estimateOf(shared->from), input);
    return estimateOf(input);
}

ResponseEstimate Session::State::estimateOf(const ResponseInput& input) const {
    constexpr std::size_t kMost = 4096;  // then old answers are not worth their memory
    const std::pair key(responseKey(input), input.threads);
    if (const auto known = estimates.find(key); known != estimates.end()) return known->second;
    if (estimates.size() >= kMost) estimates.clear();
    return estimates[key] = estimateResponse(input);
}

std::shared_ptr<const ElementResponse> Session::State::responseOf(PartId element, bool lastToo) const {
    KnownKey& known = keysOf(element);
    auto response = responses.find(known.key);
    if (!response && lastToo)
        if (const auto last = lastResponses.find(element); last != lastResponses.end() && last->second.shape == known.shape)
            response = responses.find(last->second.key);
    // Responses come from files too, and a key alone proves nothing about what a file holds under it.
    if (!response || response == known.fitting) return response;
    if (!fits(*response, *known.element, known.asked.basis)) return nullptr;
    return known.fitting = response;
}

// ---- live ------------------------------------------------------------------------------------------------------------

Result<Character*> Session::State::live() {
    if (characterValid && responsesSeen == responses.revision()) {
        if (!performanceValid && !characterError)
            if (auto ok = prepare(); !ok) return tl::unexpected(ok.error());
        if (characterError) return tl::unexpected(*characterError);
        return character ? &*character : nullptr;
    }
    characterValid = true;
    responsesSeen = responses.revision();
    character.reset();
    shownTake.reset();
    performance.reset();
    characterError.reset();
    auto planned = planCharacter(document);
    if (!planned) {
        characterError = planned.error();
        return tl::unexpected(*characterError);
    }
    plan = std::move(*planned);
    std::erase_if(lastResponses, [&](const auto& last) { return !document.elements.contains(last.first); });
    if (document.elements.empty() && document.bones.empty()) return nullptr;
    for (std::size_t i = 0; i < plan.elements.size(); ++i) {
        const PartId id = plan.elements[i];
        const KnownKey& known = keysOf(id);
        if (responses.find(known.key)) lastResponses.insert_or_assign(id, LastResponse{known.key, known.shape});
        plan.input.elements[i].response = responseOf(id, true);
    }
    auto built = Character::build(plan.input);
    if (!built) {
        characterError = built.error();
        return tl::unexpected(*characterError);
    }
    character.emplace(std::move(*built));
    character->keepExact(recording.has_value());
    trimPose();
    poseSettled = false;
    if (auto ok = prepare(); !ok) return tl::unexpected(ok.error());
    showPose();
    return &*character;
}

void Session::State::trimPose() {
    const Skeleton& skeleton = plan.input.skeleton;
    const Pose& pose = document.pose;
    if (pose.points.size() != skeleton.points.size() || pose.frames.size() != skeleton.bones.size() ||
        pose.roll.size() != skeleton.points.size())
        document.pose = {};
}

Result<void> Session::State::prepare() {
    performanceValid = true;
    if (character) character->tune(characterEffects(document.effects));
    if (!Performance::wanted(document.effects)) {
        performance.reset();
        return {};
    }
    // Settings change while a body moves; what is turned on or off begins anew.
    const bool dynamic = document.effects.has(EffectKind::BoneDynamics) && !plan.input.skeleton.bones.empty();
    if (performance && performance->isDynamic() == dynamic && performance->hasGround() == document.effects.has(EffectKind::Ground))
        return performance->set(document.effects);
    auto made = Performance::build(document, plan);
    if (!made) {
        performance.reset();
        return tl::unexpected(made.error());
    }
    performance = std::move(*made);
    performance->reset(document.pose.points.empty() ? restPose(plan.input.skeleton) : document.pose);
    return {};
}

void Session::State::showPose() {
    if (!character) return;
    shownTake.reset();
    const Pose pose = document.pose.points.empty() ? restPose(plan.input.skeleton) : document.pose;
    if (performance && !performance->isDynamic()) performance->reset(pose);
    applyTouches();
    character->update(performance ? performance->pose() : pose);
}

void Session::State::jumpToPose() {
    if (!character) return;
    if (performance) performance->reset(document.pose.points.empty() ? restPose(plan.input.skeleton) : document.pose);
    character->stop();
    showPose();
}

void Session::State::applyTouches() {
    if (!document.effects.has(EffectKind::Touch)) return;
    for (std::size_t e = 0; e < plan.elements.size(); ++e) {
        const int element = static_cast<int>(e);
        std::array<const Touch*, TouchContact::kFingers> down = {};
        for (const Touch& touch : document.touches)
            if (touch.element == plan.elements[e]) down[static_cast<std::size_t>(touch.finger)] = &touch;
        for (int i = 0; i < TouchContact::kFingers; ++i)
            if (const Touch* touch = down[static_cast<std::size_t>(i)])
                character->setFinger(element, i, touch->point, touch->to, touch->radius);
            else
                character->liftFinger(element, i);
    }
}

void Session::State::relax() {
    if (!character) return;
    document.pose = restPose(plan.input.skeleton);
    collectHolds();
    bool settled = holds.empty();
    for (int i = 0; i < kSettleSteps && !settled; ++i) {
        const auto report = character->solvePose(holds, document.pose);
        settled = report.settled || !report.finite;
    }
}

void Session::State::collectHolds() {
    holds.clear();
    for (const auto& [end, held] : document.held) {
        Hold hold;
        hold.point = plan.pointIndex(end);
        if (hold.point < 0) continue;
        const double done = held.seconds > 0.0 ? std::min(1.0, held.elapsed / held.seconds) : 1.0;
        hold.target = done < 1.0 ? Vec3(held.from + done * (held.target - held.from)) : held.target;
        hold.hasRoll = held.roll.has_value();
        if (held.roll) hold.roll = done < 1.0 ? held.fromRoll + done * (*held.roll - held.fromRoll) : *held.roll;
        holds.push_back(hold);
    }
}

Result<Session::State::Settled> Session::State::settle() {
    auto alive = live();
    if (!alive) return tl::unexpected(alive.error());
    Settled settled;
    if (!character) return settled;
    const auto start = std::chrono::steady_clock::now();
    collectHolds();
    if (!holds.empty() && document.pose.points.empty()) document.pose = restPose(plan.input.skeleton);
    settled.settled = holds.empty();
    while (!settled.settled && settled.iterations < kSettleSteps) {
        const auto report = character->solvePose(holds, document.pose);
        ++settled.iterations;
        settled.settled = report.settled;
        if (!report.finite) break;
    }
    showPose();
    settled.warnings = character->stats().warnings;
    settled.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return settled;
}

Result<Vec3> Session::State::positionOf(const EndpointRef& end) {
    if (auto alive = live(); !alive) return tl::unexpected(alive.error());
    const auto point = static_cast<std::size_t>(plan.pointIndex(end));
    if (shownTake) return shownTake->points[point];
    if (performance) return performance->pose().points[point];
    return document.pose.points.empty() ? plan.input.skeleton.points[point] : document.pose.points[point];
}

std::vector<std::string> Session::State::warningTexts(unsigned warnings) const {
    std::vector<std::string> texts = plan.warnings;
    const auto has = [&](FrameWarning bit) { return (warnings & static_cast<unsigned>(bit)) != 0; };
    if (has(FrameWarning::BasisLosesTwist))
        texts.emplace_back("The pose twists or shifts a joint face in its plane, which the basis \"paper\" cannot follow: set the character's basis to \"affine\".");
    if (has(FrameWarning::TargetOutOfReach))
        texts.emplace_back("A target is out of reach; the endpoint stays as near as its bones can stretch (max-stretch).");
    if (document.effects.has(EffectKind::PreviousModel) && document.settings.basis != BasisKind::Full)
        texts.emplace_back("The previous model works in the basis \"full\" alone and does nothing now: set the character's basis to \"full\", and precompute.");
    if (has(FrameWarning::Diverged))
        texts.emplace_back("The explicit dynamics of the previous model diverged; its joint faces stand still at their last good place: choose a smaller step or a softer shear-modulus.");
    if (has(FrameWarning::LoadsBounded))
        texts.emplace_back("Gravity or pressure is stronger than flesh so soft can show without folding, and acts less than asked for: raise its shear-modulus, or lower the pressure.");
    if (has(FrameWarning::PoseRefused))
        texts.emplace_back("A pose was not finite and was refused; the last good pose stays: release the endpoints or return to rest.");
    return texts;
}

Points Session::State::currentPositions(PartId element) {
    if (const auto result = results.find(element); result != results.end()) return result->second;
    const auto alive = live();
    const int index = plan.elementIndex(element);
    if (!alive || !*alive || index < 0) return document.elements.at(element)->mesh->body.vertices;
    return (*alive)->positions(index);
}

// ---- history ---------------------------------------------------------------------------------------------------------

void Session::State::push(Step step, DocumentChange change, std::vector<Json> lines) {
    if (savedPosition > position) savedPosition = -1;
    entries.resize(static_cast<std::size_t>(position));
    steps.resize(static_cast<std::size_t>(position));
    steps.push_back(step);
    entries.push_back({std::move(step), std::move(change), std::move(lines)});
    ++position;
    scriptValid = false;
}

void Session::State::afterExchange(const DocumentChange& change) {
    if (change.structure()) {
        pending.structure = true;
        if (touchesCharacter(change, document)) invalidateCharacter();
        if (change.effects) performanceValid = false;
    }
    if (change.pose || change.touches || !change.held.empty()) pending.pose = true;
    scriptValid = false;
}

Result<std::vector<Session::Step>> Session::State::undo(int count) {
    if (count > position)
        return fail("nothing-to-undo", position == 0 ? "There is nothing to undo." : "There are only " + std::to_string(position) + " steps to undo.");
    results.clear();
    std::vector<Step> done;
    for (; count > 0; --count) {
        HistoryEntry& entry = entries[static_cast<std::size_t>(--position)];
        exchange(document, entry.change);
        afterExchange(entry.change);
        done.push_back(entry.step);
    }
    if (live()) jumpToPose();
    return done;
}

Result<std::vector<Session::Step>> Session::State::redo(int count) {
    const int left = static_cast<int>(entries.size()) - position;
    if (count > left)
        return fail("nothing-to-redo", left == 0 ? "There is nothing to redo." : "There are only " + std::to_string(left) + " steps to redo.");
    results.clear();
    std::vector<Step> done;
    for (; count > 0; --count) {
        HistoryEntry& entry = entries[static_cast<std::size_t>(position++)];
        exchange(document, entry.change);
        afterExchange(entry.change);
        done.push_back(entry.step);
    }
    if (live()) jumpToPose();
    return done;
}

Result<void> Session::State::follow(const Document& before) {
    const DocumentChange change = difference(before, document, false);
    if (touchesSkeleton(change, document)) {
        if (auto ok = followSkeleton(before); !ok) return ok;
    } else if (touchesCharacter(change, document)) {
        invalidateCharacter();
    }
    if (!change.effects) return {};
    performanceValid = false;
    const auto alive = live();
    return alive ? Result<void>() : tl::unexpected(alive.error());
}

Result<void> Session::State::followSkeleton(const Document& before) {
    const auto was = planCharacter(before), is = planCharacter(document);
    if (!is) return tl::unexpected(is.error());
    invalidateCharacter();
    std::erase_if(document.held, [&](const auto& held) { return is->pointIndex(held.first) < 0; });
    if (was && sameSkeleton(was->input.skeleton, is->input.skeleton)) return {};
    // It begins from its rest pose, and pins at rest move along.
    document.pose = {};
    bool anythingPulled = false;
    for (auto& [end, held] : document.held) {
        const Vec3& now = is->input.skeleton.points[static_cast<std::size_t>(is->pointIndex(end))];
        const int old = was ? was->pointIndex(end) : -1;
        if (held.pinned && old >= 0 && held.target == was->input.skeleton.points[static_cast<std::size_t>(old)]) held.target = now;
        anythingPulled = anythingPulled || held.target != now || held.roll;
    }
    if (!anythingPulled) return {};
    const auto settled = settle();
    return settled ? Result<void>() : tl::unexpected(settled.error());
}

void Session::State::takeBack(const Document& before) {
    const DocumentChange change = difference(document, before, false);
    const bool rebuild = touchesCharacter(change, before) || characterError;
    document = before;
    if (rebuild) invalidateCharacter();
    if (change.effects) performanceValid = false;
    if ((rebuild || !change.empty()) && live()) showPose();
    pending = {};
}

void Session::State::noteFrames() {
    if (frames.empty()) return;
    const bool even = std::all_of(frames.begin(), frames.end(), [&](double dt) { return dt == frames[0]; });
    const Json line{{"do", "step"}, {"frames", frames.size()}, {"dt", even ? Json(frames[0]) : Json(frames)}};
    frames.clear();
    note(line);
}

void Session::State::note(const Json& line) {
    if (gesture)
        gesture->lines.push_back(line);
    else if (position > 0)
        entries[static_cast<std::size_t>(position - 1)].lines.push_back(line);
    else
        firstLines.push_back(line);
    scriptValid = false;
}

const std::vector<Json>& Session::State::allLines() const {
    if (scriptValid) return script;
    std::vector<Json> all = firstLines;
    for (int i = 0; i < position; ++i) {
        const auto& lines = entries[static_cast<std::size_t>(i)].lines;
        all.insert(all.end(), lines.begin(), lines.end());
    }
    // Frames matter until the last take ends. A recording that was undone leaves its beginning behind, and one can lose it to an undo while it ran.
    const auto records = [](const Json& line, const char* action) { return line["do"] == "record" && line["action"] == action; };
    std::size_t end = all.size();
    while (end > 0 && !records(all[end - 1], "stop")) --end;
    script.clear();
    Json open;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Json& line = all[i];
        if (line["do"] == "step" && i >= end) continue;
        if (records(line, "start")) {
            const auto same = [&](const Json& other) { return records(other, "stop") && other["take"] == line["take"]; };
            const auto next = std::find_if(all.begin() + static_cast<std::ptrdiff_t>(i) + 1, all.end(), [&](const Json& other) { return same(other) || records(other, "start"); });
            if (next == all.end() || !same(*next)) continue;
            open = line["take"];
        } else if (records(line, "stop")) {
            if (open != line["take"]) script.push_back({{"do", "record"}, {"take", line["take"]}, {"action", "start"}});
            open = nullptr;
        }
        script.push_back(line);
    }
    scriptValid = true;
    return script;
}

void Session::State::replaceDocument(Document fresh, std::filesystem::path file, Json line) {
    document = std::move(fresh);
    path = std::move(file);
    entries.clear();
    steps.clear();
    firstLines.assign(1, std::move(line));
    position = savedPosition = 0;
    gesture.reset();
    scriptValid = false;
    lastResponses.clear();
    keys.clear();
    results.clear();
    recording.reset();
    frames.clear();
    invalidateCharacter();
    pending = {true, true, true, true};
}

// ---- session -----------------------------------------------------------------------------------------------------------

Session::Session(const CommandRegistry& registry) : state_(std::make_unique<State>(registry)) {
    state_->importer = importFile;
    state_->effectMs.fill(-1.0);
    state_->firstLines.push_back(Json{{"do", "new"}});
}

Session::~Session() = default;

Result<Json> Session::execute(const Json& command, const Progress& progress) {
    State& s = *state_;
    if (!command.is_object()) return fail("bad-command", "A command is a JSON object with the key \"do\".");
    const Json* name = find(command, "do");
    if (!name || !name->is_string()) return fail("bad-command", "A command needs the key \"do\" with the name of what to do.");
    const Command* what = s.registry.find(name->get_ref<const std::string&>());
    if (!what) return fail("unknown-command", "There is no command \"" + name->get<std::string>() + "\"; \"imomushi run --help\" lists all.");
    if (auto ok = checkArguments(*what, command); !ok) return tl::unexpected(ok.error());

    if (what->name != "step") s.noteFrames();
    const Document before = s.document;  // shares all parts
    const int positionBefore = s.position;
    s.pending = {};
    Result<Json> answer = fail("internal", "");
    try {
        answer = what->run(*this, command, progress);
        if (answer && !finite(*answer)) answer = fail("not-finite", "The answer is not finite: check the input of this command.");
        if (answer && what->changesDocument)
            if (auto ok = s.follow(before); !ok) answer = tl::unexpected(ok.error());
    } catch (const std::bad_alloc&) {
        answer = fail("no-memory", "There is not enough memory for \"" + what->name + "\": close other programs or use a smaller mesh.");
    } catch (const std::exception& error) {
        answer = fail("internal", "\"" + what->name + "\" failed: " + error.what());
    }
    if (!answer) {
        s.takeBack(before);
        return answer;
    }

    bool posed = false;
    if (what->changesDocument) {
        DocumentChange change = difference(before, s.document, false);
        posed = change.pose || change.touches || !change.held.empty() || change.effects;
        if (!change.pose && (!change.held.empty() || touchesSkeleton(change, s.document))) change.pose = before.pose;
        s.pending.structure = s.pending.structure || change.structure();
        s.pending.pose = s.pending.pose || change.pose || change.touches || !change.held.empty() || s.pending.structure;
        if (s.gesture) {
            s.gesture->step = {what->name, subjectOf(command)};
            s.gesture->lines.push_back(command);
        } else {
            s.push({what->name, subjectOf(command)}, std::move(change), {command});
        }
    }
    if (what->changesDocument || s.position != positionBefore) s.poseSettled = false;
    if (what->changesDocument && posed) s.leaveTake();
    s.stirred = s.stirred || what->changesDocument || s.position != positionBefore || s.pending.structure || s.pending.responses;
    const Change told = s.pending;
    s.pending = {};
    if (s.listener && (told.structure || told.pose || told.responses || told.file || what->changesDocument || s.position != positionBefore))
        s.listener(told);
    return answer;
}

const Document& Session::document() const { return state_->document; }
const CommandRegistry& Session::registry() const { return state_->registry; }
ResponseCache& Session::responses() { return state_->responses; }
const std::vector<Session::Step>& Session::steps() const { return state_->steps; }
int Session::position() const { return state_->position; }

void Session::beginGesture() {
    State& s = *state_;
    if (s.gesture) endGesture();
    s.noteFrames();
    s.gesture = State::Gesture{s.document, {}, {}};
}

void Session::endGesture() {
    State& s = *state_;
    if (!s.gesture) return;
    s.noteFrames();
    State::Gesture gesture = std::move(*s.gesture);
    s.gesture.reset();
    if (gesture.step.name.empty()) {
        for (const Json& line : gesture.lines) s.note(line);
        return;
    }
    DocumentChange change = difference(gesture.before, s.document, false);
    if (!change.pose && (!change.held.empty() || touchesSkeleton(change, s.document))) change.pose = gesture.before.pose;
    s.push(gesture.step, std::move(change), std::move(gesture.lines));
    if (s.listener) s.listener({});
}

void Session::cancelGesture() {
    State& s = *state_;
    if (!s.gesture) return;
    DocumentChange change = difference(s.gesture->before, s.document, true);
    s.frames.clear();
    s.gesture.reset();
    exchange(s.document, change);
    s.pending = {};
    s.poseSettled = false;
    s.stirred = true;
    s.afterExchange(change);
    if (s.live()) s.jumpToPose();
    const Change told = s.pending;
    s.pending = {};
    if (s.listener) s.listener(told);
}

const Pose& Session::shownPose() {
    State& s = *state_;
    if (!s.live()) return s.document.pose;
    return s.shownTake ? *s.shownTake : s.performance ? s.performance->pose() : s.document.pose;
}

bool Session::moving() {
    State& s = *state_;
    const auto alive = s.live();
    if (!alive || !*alive || s.shownTake) return false;
    const auto& held = s.document.held;
    return (s.stirred && (!s.character->resting() || (s.performance && s.performance->isDynamic()))) || std::any_of(held.begin(), held.end(), [](const auto& h) { return h.second.elapsed < h.second.seconds; });
}

std::optional<double> Session::effectMilliseconds(EffectKind effect) const {
    const double ms = state_->effectMs[static_cast<std::size_t>(effect)];
    return ms < 0.0 ? std::nullopt : std::optional(ms);
}

EffectCost Session::effectCost(EffectKind effect) const { return state_->costOf(effect); }

bool Session::modified() const {
    const State& s = *state_;
    return s.position != s.savedPosition || (s.gesture && !s.gesture->step.name.empty());
}

Project Session::project() {
    State& s = *state_;
    Project project;
    project.document = s.document;
    if (const auto alive = s.live(); alive)  // brings the last responses up to date
        for (const auto& [element, last] : s.lastResponses) {
            if (!s.document.elements.contains(element)) continue;
            if (auto response = s.responses.find(last.key)) project.responses.emplace(element, StoredResponse{last.key, last.shape, std::move(response)});
        }
    return project;
}

const std::filesystem::path& Session::path() const { return state_->path; }

Character* Session::character() {
    const auto alive = state_->live();
    return alive ? *alive : nullptr;
}

int Session::elementIndex(PartId element) const { return state_->live() ? state_->plan.elementIndex(element) : -1; }
int Session::pointIndex(const EndpointRef& end) const { return state_->live() ? state_->plan.pointIndex(end) : -1; }

void Session::stepFrame(double dt) {
    State& s = *state_;
    const auto alive = s.live();
    if (!alive || !*alive) return;
    const bool wasTake = s.shownTake.has_value();
    s.shownTake.reset();
    for (auto& [end, held] : s.document.held)
        if (held.elapsed < held.seconds) held.elapsed = std::min(held.seconds, held.elapsed + dt);
    s.collectHolds();
    bool settled = true;
    // What is settled is not solved again: it would go on changing by rounding, and nothing would ever rest.
    if (!s.holds.empty() && !(s.poseSettled && s.holds == s.settledHolds)) {
        if (s.document.pose.points.empty()) s.document.pose = restPose(s.plan.input.skeleton);
        settled = s.poseSettled = s.character->solvePose(s.holds, s.document.pose).settled;
        s.settledHolds = s.holds;
    }
    if (!s.results.empty()) s.results.clear();
    s.effectMs.fill(-1.0);
    s.applyTouches();
    if (s.performance) {
        if (s.document.pose.points.empty()) s.document.pose = restPose(s.plan.input.skeleton);
        s.performance->step(dt, s.document.pose, s.holds);
        s.character->update(s.performance->pose(), dt);
        s.effectMs[static_cast<std::size_t>(s.performance->isDynamic() ? EffectKind::BoneDynamics : EffectKind::Ground)] = s.performance->milliseconds();
    } else if (!s.document.pose.points.empty() || s.stirred || wasTake || !s.character->resting()) {
        if (s.document.pose.points.empty()) s.document.pose = restPose(s.plan.input.skeleton);
        s.character->update(s.document.pose, dt);
    }
    const auto& effects = s.document.effects;
    const auto& stats = s.character->stats();
    if (effects.has(EffectKind::SmoothJoints)) s.effectMs[static_cast<std::size_t>(EffectKind::SmoothJoints)] = stats.equilibriumMs;
    if (effects.has(EffectKind::BendWarp)) s.effectMs[static_cast<std::size_t>(EffectKind::BendWarp)] = stats.bendWarpMs;
    if (effects.has(EffectKind::JointDynamics)) s.effectMs[static_cast<std::size_t>(EffectKind::JointDynamics)] = stats.jointDynamicsMs;
    if (effects.has(EffectKind::Touch)) s.effectMs[static_cast<std::size_t>(EffectKind::Touch)] = stats.touchMs;
    if (effects.has(EffectKind::PreviousModel)) s.effectMs[static_cast<std::size_t>(EffectKind::PreviousModel)] = stats.previousModelMs;
    if (effects.has(EffectKind::Gravity)) s.effectMs[static_cast<std::size_t>(EffectKind::Gravity)] = stats.gravityMs;
    if (effects.has(EffectKind::Inflate)) s.effectMs[static_cast<std::size_t>(EffectKind::Inflate)] = stats.inflateMs;
    s.stirred = !settled || (s.performance && !s.performance->resting()) || !s.character->resting();
    s.recordFrame(dt);
    s.frames.push_back(dt);
}

std::optional<Session::Recording> Session::recording() const {
    const auto& recorded = state_->recording;
    if (!recorded) return std::nullopt;
    return Recording{recorded->take.name, recorded->take.times.size(), recorded->take.duration()};
}

bool Session::showsTake() const { return state_->shownTake.has_value(); }

Session::ResponseState Session::responseState(PartId element) const {
    const State& s = *state_;
    if (!s.document.elements.contains(element)) return ResponseState::None;
    if (s.responseOf(element, false)) return ResponseState::Fresh;
    return s.lastResponses.contains(element) ? ResponseState::Stale : ResponseState::None;
}

ResponseInput Session::responseInput(PartId element) const { return state_->inputOf(element); }

const Session::SharedResponse* Session::sharedResponse(PartId element) const { return state_->sharedOf(element); }
std::shared_ptr<const ElementResponse> Session::response(PartId element) const { return state_->responseOf(element, false); }
ResponseEstimate Session::responseEstimate(PartId element) const { return state_->estimateOf(element); }

void Session::setListener(std::function<void(const Change&)> listener) { state_->listener = std::move(listener); }

void Session::setImporter(std::function<Result<ImportResult>(const ImportRequest&, const Progress&)> importer) {
    state_->importer = importer ? std::move(importer) : importFile;
}

const std::vector<Json>& Session::script() const { return state_->allLines(); }
Document& Session::edit() { return state_->document; }
Session::State& Session::state() { return *state_; }

}  // namespace imomushi
