// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/document_responses.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/elasticity/machine_rates.h"

namespace imomushi {

namespace {

/// More estimates than these are not worth their memory: all are forgotten then.
constexpr std::size_t kMaxEstimates = 4096;

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

/// Keys of responses that may have all that `input` asks for, its own first: body loads may be there that nobody asked for, or not with `Always`. The first kKept have
/// the same bytes; the one after them, without body loads, is of a project file of old and rounds otherwise.
constexpr std::size_t kKept = 2;
std::vector<ContentKey> answeringKeys(ResponseInput input) {
    const bool asked = input.loads == BodyLoads::Always;
    std::vector<ContentKey> keys{responseKey(input)};
    input.loads = asked ? BodyLoads::WhereCheap : BodyLoads::Always;
    keys.push_back(responseKey(input));
    if (asked) return keys;
    input.loads = BodyLoads::None;
    keys.push_back(responseKey(input));
    return keys;
}

bool answers(const ElementResponse& response, bool loads) { return !loads || response.loads.cols() > 0; }

}  // namespace

DocumentResponses::DocumentResponses(const Document& document, std::shared_ptr<ResponseStore> store) : document_(document), store_(std::move(store)) {}

// ---- what is asked for -------------------------------------------------------------------------------------------------

DocumentResponses::ResponseRequest DocumentResponses::requestOf(PartId element) const {
    const EffectColumns columns = columnsAsked(document_.effects, element);
    ResponseRequest request;
    request.basis = document_.settings.basis;
    request.loads = columns.loads > 0;
    request.touch = columns.patches;
    return request;
}

ResponseInput DocumentResponses::inputOf(PartId element) const {
    const Element& e = *document_.elements.at(element);
    const ResponseRequest request = requestOf(element);
    ResponseInput input;
    input.mesh = e.mesh;
    input.faces = e.faces;
    for (const Handle& handle : e.handles) input.faces[static_cast<std::size_t>(e.faceIndex(handle.face))].disc = SurfaceDisc{handle.point, handle.radius};
    input.nu = e.nu;
    input.basis = request.basis;
    input.loads = request.loads ? BodyLoads::Always : BodyLoads::WhereCheap;
    input.touch = request.touch;
    input.solverMesh = e.solverMesh;
    input.threads = threads();
    return input;
}

int DocumentResponses::threads() const { return document_.settings.threads > 0 ? document_.settings.threads : hardwareThreads(); }

ResponseInput DocumentResponses::inputOfDraft(PartId element) const {
    ResponseInput input = inputOf(element);
    input.solverMesh = {SolverMeshSetting::Kind::Draft, 0};
    return input;
}

DocumentResponses::Known& DocumentResponses::known(PartId element) const {
    const auto& part = document_.elements.at(element);
    Known& known = known_[element];
    if (const ResponseRequest request = requestOf(element); known.element != part || !(known.request == request)) {
        ResponseInput input = inputOf(element);
        known = {part, request, {}, {}, answeringKeys(input), {}, {}, {}};
        known.key = known.keys.front();
        input.nu = 0.0;
        input.loads = BodyLoads::None;
        input.touch = 0;
        known.shape = responseKey(input);
    }
    return known;
}

const ContentKey& DocumentResponses::partsOf(PartId element) const {
    Known& asked = known(element);
    if (asked.parts) return *asked.parts;
    ContentHasher hasher;
    const TriangleMesh& body = asked.element->mesh->body;
    hasher.number(static_cast<std::int64_t>(body.vertices.rows()));
    Triangles triangles = body.triangles;  // of mirror images they are turned round
    triangles.col(1) = body.triangles.col(1).cwiseMin(body.triangles.col(2));
    triangles.col(2) = body.triangles.col(1).cwiseMax(body.triangles.col(2));
    hasher.bytes(triangles.data(), static_cast<std::size_t>(triangles.size()) * sizeof(std::int32_t));
    for (const JointFace& face : asked.element->faces) hasher.bytes(face.vertices.data(), face.vertices.size() * sizeof(std::int32_t));
    hasher.number(asked.element->nu);
    hasher.number(static_cast<int>(asked.request.loads));
    hasher.number(asked.request.touch);
    return *(asked.parts = hasher.key());
}

const SharedResponse* DocumentResponses::sharedOf(PartId element) const {
    if (!isOfNow(sharing_) && isOfNow(formerSharing_)) std::swap(sharing_, formerSharing_);
    if (!isOfNow(sharing_)) findShared();
    const auto found = sharing_.shared.find(element);
    return found == sharing_.shared.end() ? nullptr : &found->second;
}

bool DocumentResponses::isOfNow(const Sharing& sharing) const {
    return sharing.basis == document_.settings.basis && sharing.effects == document_.effects && sharing.elements == document_.elements;
}

DocumentResponses::Derived DocumentResponses::derived() const {
    for (const auto& [id, element] : document_.elements) {
        (void)known(id);
        if (!element->faces.empty()) (void)sharedOf(id);
    }
    return {known_, sharing_};
}

void DocumentResponses::take(const Derived& derived) {
    for (const auto& [id, known] : derived.known)
        if (const auto own = known_.find(id); own == known_.end() || own->second.element != known.element || !(own->second.request == known.request)) known_.insert_or_assign(id, known);
    formerSharing_ = std::exchange(sharing_, derived.sharing);
}

void DocumentResponses::findShared() const {
    const Sharing& was = sharing_;
    Sharing now;
    now.elements = document_.elements;
    now.basis = document_.settings.basis;
    now.effects = document_.effects;
    struct Candidate {
        PartId id;
        bool known;  // unchanged, and computed itself the last time too
    };
    std::map<ContentKey, std::vector<Candidate>> computed;  // by parts: others cannot be congruent
    for (const auto& [id, part] : document_.elements) {
        if (part->faces.empty()) continue;
        const auto oldKey = was.keys.find(id);
        const bool same = oldKey != was.keys.end() && oldKey->second == keyOf(id);
        now.keys.emplace(id, keyOf(id));
        const auto last = same ? was.shared.find(id) : was.shared.end();
        auto& candidates = computed[partsOf(id)];
        bool found = false;
        for (const Candidate& first : candidates) {
            if (same && first.known) {
                if (last != was.shared.end() && last->second.from == first.id) {
                    now.shared.insert(*last);
                    found = true;
                    break;
                }
                // The last time, all up to the one it shared with were found not to be congruent.
                if (last == was.shared.end() || first.id < last->second.from) continue;
            }
            auto congruence = findCongruence(inputOf(first.id), inputOf(id));
            if (!congruence) continue;
            now.shared[id] = {first.id, std::make_shared<const Congruence>(std::move(*congruence))};
            found = true;
            break;
        }
        if (!found) candidates.push_back({id, same && last == was.shared.end()});
    }
    formerSharing_ = std::exchange(sharing_, std::move(now));
}

EffectCost DocumentResponses::costOf(EffectKind kind) const {
    const Effects& effects = document_.effects;
    const EffectDescriptor& effect = effectDescriptor(kind);
    EffectCost cost;
    if (effect.pairs) cost.milliseconds = 1e3 * machineRates().secondsPerPair * effect.pairs(document_);
    if (effect.scope == EffectScope::Bones) return cost;
    const int columns = columnsOf(effects, kind).count();
    for (const auto& [id, element] : document_.elements) {
        if (element->faces.empty()) continue;
        if (effect.tractions) {
            std::size_t size = 0;
            for (const JointFace& face : element->faces) size += 3 * face.vertices.size();
            cost.bytes += size * size * sizeof(double);
            cost.precompute = cost.precompute || document_.settings.basis != BasisKind::Full || !freshOf(id);
        }
        if (columns == 0 || (effects.has(kind) && !effects.has(kind, id))) continue;
        const EffectColumns others = columnsAsked(effects, id, std::pair(kind, false)), all = columnsAsked(effects, id, std::pair(kind, true)), now = columnsAsked(effects, id);
        ResponseInput with = inputOf(id), without = with;
        const auto loads = [](const EffectColumns& asked) { return asked.loads > 0 ? BodyLoads::Always : BodyLoads::WhereCheap; };
        with.loads = loads(all), with.touch = all.patches;
        without.loads = loads(others), without.touch = others.patches;
        const ContentKey withKey = all == now ? keyOf(id) : responseKey(with), withoutKey = others == now ? keyOf(id) : responseKey(without);
        const ResponseEstimate more = estimateOf(withKey, with), less = estimateOf(withoutKey, without);
        const bool has = this->has(id, with);
        cost.precompute = cost.precompute || !has;
        cost.columns += columns;
        cost.bytes += static_cast<std::size_t>(columns) * static_cast<std::size_t>(3 * element->mesh->body.vertices.rows()) * sizeof(float);
        if (!has && !sharedOf(id)) cost.seconds += more.seconds;
        if (more.columns > 0) cost.milliseconds += less.frameMilliseconds * std::min(columns, effect.maxColumnsRead) / std::max(1, less.columns);
    }
    return cost;
}

// ---- what is there -----------------------------------------------------------------------------------------------------

std::shared_ptr<const ElementResponse> DocumentResponses::checked(std::shared_ptr<const ElementResponse> response, PartId element) const {
    Known& asked = known(element);
    if (!response || response == asked.fitting.lock()) return response;
    if (!fits(*response, *asked.element, asked.request.basis)) return nullptr;
    asked.fitting = response;
    return response;
}

std::shared_ptr<const ElementResponse> DocumentResponses::freshOf(PartId element) const { return checked(found(element).response, element); }

StoredResponse DocumentResponses::found(PartId element) const {
    const Known& asked = known(element);
    StoredResponse response = found(*asked.element, asked.keys, asked.request.loads);
    response.shape = asked.shape;
    return response;
}

StoredResponse DocumentResponses::found(const Element& element, std::span<const ContentKey> keys, bool loads) const {
    for (std::size_t i = 0; i < keys.size(); ++i) {
        auto response = i < kKept ? store_->find(keys[i], element.mesh->body, element.faces) : store_->find(keys[i]);  // no answer depends on what a folder holds
        if (response && answers(*response, loads)) return {keys[i], {}, std::move(response)};
    }
    return {};
}

bool DocumentResponses::has(PartId element, const ResponseInput& input) const {
    return found(*document_.elements.at(element), answeringKeys(input), input.loads == BodyLoads::Always).response != nullptr;
}

bool DocumentResponses::isFresh(PartId element, const StoredResponse& response) const {
    const Known& asked = known(element);
    return std::find(asked.keys.begin(), asked.keys.end(), response.key) != asked.keys.end() && answers(*response.response, asked.request.loads);
}

std::shared_ptr<const ElementResponse> DocumentResponses::fittingOf(PartId element) const {
    if (auto fresh = found(element).response) return checked(std::move(fresh), element);
    const auto last = last_.find(element);
    return last != last_.end() && last->second.shape == shapeOf(element) ? checked(last->second.response, element) : nullptr;
}

ResponseState DocumentResponses::stateOf(PartId element) const {
    if (!document_.elements.contains(element)) return ResponseState::None;
    if (freshOf(element)) return ResponseState::Fresh;
    return last_.contains(element) ? ResponseState::Stale : ResponseState::None;
}

bool DocumentResponses::isDraft(PartId element) const {
    const auto last = last_.find(element);
    if (last == last_.end() || stateOf(element) != ResponseState::Stale || !fittingOf(element)) return false;
    auto& drafts = known(element).drafts;
    if (drafts.empty()) drafts = answeringKeys(inputOfDraft(element));
    return std::find(drafts.begin(), drafts.end(), last->second.key) != drafts.end();
}

// ---- what it costs -----------------------------------------------------------------------------------------------------

ResponseEstimate DocumentResponses::estimateOf(PartId element) const {
    if (document_.elements.at(element)->faces.empty()) return {};
    if (const SharedResponse* shared = sharedOf(element)) return carryEstimate(estimateOf(shared->from), inputOf(element));
    return estimateOf(keyOf(element), inputOf(element));
}

ResponseEstimate DocumentResponses::estimateOf(const ContentKey& key, const ResponseInput& input) const {
    const std::pair asked(key, input.threads);
    if (const auto known = estimates_.find(asked); known != estimates_.end()) return known->second;
    if (estimates_.size() >= kMaxEstimates) estimates_.clear();
    return estimates_[asked] = estimateResponse(input);
}

// ---- computing ---------------------------------------------------------------------------------------------------------

Result<std::shared_ptr<const ElementResponse>> DocumentResponses::compute(PartId element, const Progress& progress) {
    if (auto known = freshOf(element)) return known;
    Result<ElementResponse> built;
    if (const SharedResponse* shared = sharedOf(element)) {
        const auto first = compute(shared->from, progress);
        if (!first) return first;
        if (auto known = freshOf(element)) return known;  // the very same body in the same place
        built = shared->how->carry(**first);
    } else {
        built = buildResponse(inputOf(element), progress);
    }
    if (!built) return fail(built.error().code, "\"" + document_.elements.at(element)->name + "\": " + built.error().message);
    auto response = std::make_shared<const ElementResponse>(std::move(*built));
    insert(keyOf(element), response, sharedOf(element) != nullptr);
    last_.insert_or_assign(element, StoredResponse{keyOf(element), shapeOf(element), response});
    return response;
}

std::set<PartId> DocumentResponses::computeTogether(std::span<const PartId> elements, const Progress& progress) {
    std::vector<PartId> ids;
    std::vector<ResponseInput> inputs;
    for (const PartId id : elements) {
        if (document_.elements.at(id)->faces.empty() || freshOf(id) || sharedOf(id)) continue;
        ResponseInput input = inputOf(id);
        if (!solvedBesideOthers(input)) continue;
        ids.push_back(id);
        inputs.push_back(std::move(input));
    }
    if (ids.size() < 2) return {};
    std::vector<std::shared_ptr<const ElementResponse>> made(ids.size());
    buildResponses(inputs, threads(), [&](std::size_t i, Result<ElementResponse> response) {
        if (response) made[i] = std::make_shared<const ElementResponse>(std::move(*response));
    }, progress);
    std::set<PartId> done;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (!made[i]) continue;
        insert(keyOf(ids[i]), made[i], false);
        last_.insert_or_assign(ids[i], StoredResponse{keyOf(ids[i]), shapeOf(ids[i]), made[i]});
        done.insert(ids[i]);
    }
    return done;
}

void DocumentResponses::insert(const ContentKey& key, std::shared_ptr<const ElementResponse> response, bool carried) {
    unsaved_.insert(key);
    // One that was carried over depends on whose it was, in its last digits: it stays in this process, so that no answer depends on what a folder holds.
    if (carried)
        store_->insert(key, std::move(response));
    else
        store_->insertComputed(key, std::move(response));
}

void DocumentResponses::bring(PartId element, const StoredResponse& response) {
    store_->insert(response.key, response.response);
    StoredResponse taken = response;
    const auto kept = document_.elements.contains(element) ? fittingOf(element) : nullptr;
    if (kept && response.shape == shapeOf(element) && kept->touch.columns() == 0 && response.response->touch.columns() > 0 && !isFresh(element, response) &&
        last_.contains(element) && kept->freeVertices == response.response->freeVertices) {
        auto both = std::make_shared<ElementResponse>(*kept);
        both->touch = response.response->touch;
        ContentHasher hasher;  // a key of its own: it is neither of the two
        hasher.text("patches of a draft");
        for (const ContentKey& key : {last_.at(element).key, response.key}) hasher.bytes(&key, sizeof key);
        taken = {hasher.key(), response.shape, std::move(both)};
        auto& drafts = known(element).drafts;
        if (drafts.empty()) drafts = answeringKeys(inputOfDraft(element));
        drafts.push_back(taken.key);
    }
    last_.insert_or_assign(element, std::move(taken));
}

bool DocumentResponses::lacksPatches(PartId element) const {
    const auto fitting = inputOf(element).touch > 0 ? fittingOf(element) : nullptr;
    return fitting && fitting->touch.columns() == 0;
}

// ---- the project -------------------------------------------------------------------------------------------------------

void DocumentResponses::refresh() {
    dropGone();
    for (const auto& [id, part] : document_.elements)
        if (auto fresh = found(id); checked(fresh.response, id)) last_.insert_or_assign(id, std::move(fresh));
}

void DocumentResponses::dropGone() {
    const auto gone = [&](const auto& item) { return !document_.elements.contains(item.first); };
    std::erase_if(last_, gone);
    std::erase_if(known_, gone);
}

bool DocumentResponses::unsaved() const {
    for (const auto& [id, response] : last_)
        if (unsaved_.contains(response.key) && document_.elements.contains(id)) return true;
    return false;
}

void DocumentResponses::markSaved() {
    for (const auto& [id, response] : last_) unsaved_.erase(response.key);
}

DocumentResponses::Remembered DocumentResponses::replace(Remembered by) {
    known_.clear();
    for (Sharing* sharing : {&sharing_, &formerSharing_}) {
        sharing->elements.clear();  // asks for no memory, as an empty Sharing would
        sharing->keys.clear();
        sharing->shared.clear();
    }
    return {std::exchange(last_, std::move(by.last)), std::exchange(unsaved_, std::move(by.unsaved))};
}

}  // namespace imomushi
