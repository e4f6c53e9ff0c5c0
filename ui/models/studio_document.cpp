// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/studio_document.h"

#include <QScopeGuard>
#include <algorithm>
#include <utility>

#include "core/document/document_change.h"
#include "core/session/prepared_step.h"
#include "ui/models/commands.h"
#include "ui/models/failures.h"
#include "ui/models/gesture.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"

namespace imomushi {
namespace {

/// Weight of a new frame in the smoothed times.
constexpr double kNewFrame = 0.08;

/// More than the pose.
bool changesMore(const CommandRegistry& registry, const Json& command) {
    const auto name = command.find("do");
    if (name == command.end() || !name->is_string()) return false;
    const Command* known = registry.find(name->get_ref<const std::string&>());
    return known && ((known->changesDocument() && !known->pose) || known->name == "undo" || known->name == "redo");
}

bool replacesDocument(const Json& command) {
    const auto name = command.find("do");
    return name != command.end() && (*name == "new" || *name == "open");
}

/// Steps of a performance per second.
constexpr int kPaceMs = 1000;

/// With more vertices than these a slow step holds up the window for longer than anybody likes to wait: a cut takes 5 ms for a thousand.
constexpr std::int64_t kQuickVertices = 8000;

bool takesLong(const Document& document, const SlowStep& step) {
    std::int64_t vertices = step.brings;
    for (const auto& [id, element] : document.elements) vertices += element->mesh->body.vertices.rows();
    for (const auto& [id, character] : document.characters) vertices += character->model->mesh.body.vertices.rows();
    return vertices > kQuickVertices;
}

void smooth(double& mean, double value) { mean = mean < 0.0 ? value : mean + kNewFrame * (value - mean); }

}  // namespace

StudioDocument::StudioDocument(const CommandRegistry& registry, std::shared_ptr<ResponseStore> store, QObject* parent)
    : QObject(parent), session_(registry, std::move(store)) {
    effectMs_.fill(-1.0);
    session_.setListener([this](const Session::Change& change) {
        if (!attempt([&] { tell(change); })) unheard_ = true;
    });
}

void StudioDocument::tell(const Session::Change& change) {
    // Where memory ran out while it was told, who did not hear is told everything next time.
    const bool all = std::exchange(unheard_, false);
    if (all || change.structure()) {
        // What is gone cannot stay selected; listeners of structureChanged() may already rely on that.
        const bool unselected = std::erase_if(selection_, [this](const SelectionItem& item) { return !exists(item); }) > 0;
        if (hovered_ && !exists(*hovered_)) hovered_.reset();
        std::array<bool, kEffects> effects;
        for (std::size_t k = 0; k < kEffects; ++k) effects[k] = document().effects.has(EffectKind(k));
        if (effects != measured_) {  // frames of another price
            measured_ = effects;
            effectMs_.fill(-1.0);
            frameMs_ = -1.0;
        }
        DocumentChange told = change.document;
        told.unknown = told.unknown || all;
        Q_EMIT structureChanged(told);
        if (unselected) Q_EMIT selectionChanged();
    }
    if (all || change.history) Q_EMIT historyChanged();
    if (all || change.pose) Q_EMIT poseChanged();
    if (all || change.responses) Q_EMIT responsesChanged();
    if (all || change.file) Q_EMIT fileChanged();
    if (performing_) askForFrame();  // what moves now is stepped, whoever looks
}

bool StudioDocument::exists(const SelectionItem& item) const {
    const Document& d = document();
    switch (item.kind) {
        case SelectionItem::Kind::Element:
            return d.elements.contains(item.part);
        case SelectionItem::Kind::Face: {
            const auto found = d.elements.find(item.part);
            return found != d.elements.end() && found->second->faceIndex(item.face) >= 0;
        }
        case SelectionItem::Kind::Bone:
        case SelectionItem::Kind::Endpoint:
            return d.bones.contains(item.part);
        case SelectionItem::Kind::Character:
            return d.characters.contains(item.part);
        case SelectionItem::Kind::Cut:
            return cutOf(d, item) != nullptr;
    }
    return false;
}

Result<Json> StudioDocument::execute(const Json& command, bool quiet) {
    const bool more = changesMore(session_.registry(), command);
    if (more) Q_EMIT changing();
    // What a document that goes held is freed beside the window.
    std::shared_ptr<const Project> gone;
    if (replacesDocument(command)) attempt([&] { gone = std::make_shared<const Project>(session_.project()); });
    const auto freed = qScopeGuard([&] {
        if (gone) freeing_ = std::jthread([kept = std::move(gone)]() mutable { kept.reset(); });
    });
    auto answer = session_.execute(command);
    if (more) Q_EMIT changeDone();
    if (!answer && !quiet) Q_EMIT failed(errorText(answer.error()));
    return answer;
}

bool StudioDocument::worksBeside(const SlowStep& step) const { return beside_ && takesLong(document(), step); }

void StudioDocument::executeSlow(SlowStep step) {
    if (!inGesture() && worksBeside(step)) return beside_(std::move(step));
    executeAtOnce(step);
}

void StudioDocument::giveUpUnderWay() {
    if (!underWay_.empty()) giveUp_();
}

void StudioDocument::setUnderWay(std::vector<Json> commands) {
    if (commands == underWay_) return;
    underWay_ = std::move(commands);
    Q_EMIT underWayChanged();
}

bool StudioDocument::turnedOn(EffectKind effect) const {
    bool on = document().effects.has(effect);
    for (const Json& command : underWay_)
        for (const bool to : {false, true})
            if (command == commands::setEnabled(effect, to)) on = to;
    return on;
}

bool StudioDocument::turnedOn(EffectKind effect, PartId element) const {
    bool on = document().effects.has(effect, element);
    const std::string& name = document().elements.at(element)->name;
    for (const Json& command : underWay_)
        for (const bool to : {false, true})
            if (command == commands::setEnabled(effect, to) || command == commands::setEnabled(effect, to, name)) on = to;
    return on;
}

void StudioDocument::executeAtOnce(const SlowStep& step) {
    const Services usual = session_.services();
    if (step.arrange) step.arrange(session_);
    const std::vector<Json> commands = step.commands();
    std::optional<Gesture> together;
    if (commands.size() > 1) together.emplace(*this);
    Result<Json> answer;
    for (const Json& command : commands)
        if (!(answer = execute(command, bool(step.refused)))) break;
    if (answer && together) together->commit();
    together.reset();
    session_.services() = usual;
    if (answer) {
        if (step.done) step.done(*answer);
    } else if (step.refused) {
        if (step.lookFurther) step.lookFurther(document());
        step.refused(answer.error());
    }
}

Result<Json> StudioDocument::takePrepared(const PreparedStep& step) {
    Q_EMIT changing();
    auto answer = session_.takePrepared(step);
    Q_EMIT changeDone();
    if (!answer) Q_EMIT failed(errorText(answer.error()));
    return answer;
}

Project StudioDocument::project() { return session_.project(); }

void StudioDocument::perform() {
    performing_ = true;
    session_.perform([this] { askForFrame(); });
    askForFrame();
}

void StudioDocument::performInputs(std::shared_ptr<InputFeed> feed) {
    session_.performInputs(std::move(feed));
    askForFrame();
}

bool StudioDocument::holdInputs() {
    Gesture gesture(*this);
    const auto held = session_.holdInputs();
    if (!held) {
        Q_EMIT failed(errorText(held.error()));
        return false;
    }
    gesture.commit({"live", {}});
    return true;
}

bool StudioDocument::releaseInputs() {
    Gesture gesture(*this);
    if (const auto released = session_.releaseInputs(); !released) {
        Q_EMIT failed(errorText(released.error()));
        return false;
    }
    gesture.commitInLast({"release", {}});
    return true;
}

// One event at a time, however fast steps follow each other.
void StudioDocument::askForFrame() {
    if (!frameAsked_.exchange(true)) QMetaObject::invokeMethod(this, &StudioDocument::takeFrame, Qt::QueuedConnection);
}

void StudioDocument::takeFrame() {
    frameAsked_ = false;
    attempt([this] {
        if (!session_.takeFrame()) return;
        const Session::Performed performed = *session_.performed();
        if (!pacing_.isValid() || pacing_.elapsed() >= kPaceMs) {
            if (pacing_.isValid()) pace_ = std::clamp(1.0 - (performed.leftOut - leftOut_) / (1e-3 * double(pacing_.elapsed())), 0.0, 1.0);
            leftOut_ = performed.leftOut;
            pacing_.start();
        }
        measure(performed.milliseconds);
    });
}

void StudioDocument::stepFrame(double seconds) {
    QElapsedTimer work;
    work.start();
    session_.stepFrame(seconds);
    measure(double(work.nsecsElapsed()) * 1e-6);
}

void StudioDocument::measure(double milliseconds) {
    smooth(frameMs_, milliseconds);
    for (std::size_t k = 0; k < kEffects; ++k)
        if (const auto ms = session_.effectMilliseconds(EffectKind(k))) smooth(effectMs_[k], *ms);
    Q_EMIT frameStepped();
}

std::optional<double> StudioDocument::effectMilliseconds(EffectKind effect) const {
    const double ms = effectMs_[std::size_t(effect)];
    return ms < 0.0 ? std::nullopt : std::optional(ms);
}

std::optional<double> StudioDocument::frameMilliseconds() const { return frameMs_ < 0.0 ? std::nullopt : std::optional(frameMs_); }

unsigned StudioDocument::warnings() {
    return session_.character() ? session_.warnings() : 0;
}

const ResponseEstimate* StudioDocument::estimateOf(PartId element) const {
    const auto known = estimates_.find(element);
    const auto now = document().elements.find(element);
    return known != estimates_.end() && now != document().elements.end() && known->second.element == now->second ? &known->second.estimate : nullptr;
}

void StudioDocument::setEstimates(std::map<PartId, Estimate> estimates) {
    estimates_ = std::move(estimates);
    Q_EMIT estimated();
}

void StudioDocument::select(std::vector<SelectionItem> items) {
    std::erase_if(items, [this](const SelectionItem& item) { return !exists(item); });
    if (items == selection_) return;
    selection_ = std::move(items);
    Q_EMIT selectionChanged();
}

bool StudioDocument::isSelected(const SelectionItem& item) const {
    return std::find(selection_.begin(), selection_.end(), item) != selection_.end();
}

void StudioDocument::setHovered(std::optional<SelectionItem> item) {
    if (item == hovered_) return;
    hovered_ = std::move(item);
    Q_EMIT hoverChanged();
}

}  // namespace imomushi
