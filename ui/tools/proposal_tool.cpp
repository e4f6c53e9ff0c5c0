// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/proposal_tool.h"

#include <QStringList>
#include <algorithm>
#include <limits>
#include <utility>

#include "core/commands/proposal_commands.h"
#include "ui/models/commands.h"
#include "ui/models/selection_commands.h"
#include "ui/models/texts.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Bodies are seen through while bones and planes in them are changed.
constexpr float kProposalXray = 0.55f;
/// The arrow of the selected plane is so much longer than its section is wide.
constexpr double kArrow = 1.35;
/// A bone to a tip ends this far along, within the flesh.
constexpr double kWithin = 0.92;

/// How far along a line (unit direction) the pointer's ray comes nearest to it; none: it looks along the line.
std::optional<double> slideAlong(const PointerEvent& e, const Vec3& point, const Vec3& direction) {
    const double across = direction.dot(e.rayDirection), square = 1.0 - across * across;
    if (square < 1e-3) return std::nullopt;
    const Vec3 w = e.rayOrigin - point;
    return (w.dot(direction) - across * w.dot(e.rayDirection)) / square;
}

/// Pixels from the pointer to a segment on the screen.
double pixelsToSegment(const PointerEvent& e, const Vec3& a, const Vec3& b) {
    const auto p = e.onScreen(a), q = e.onScreen(b);
    if (!p || !q) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d along = *q - *p, to = Eigen::Vector2d(e.x, e.y) - *p;
    const double t = along.squaredNorm() > 0.0 ? std::clamp(to.dot(along) / along.squaredNorm(), 0.0, 1.0) : 0.0;
    return (to - t * along).norm();
}

bool samePlane(const CutPlane& a, const CutPlane& b) { return a.origin == b.origin && a.normal == b.normal; }

std::vector<CutPlane> planesOf(const Proposal& proposal) {
    std::vector<CutPlane> planes;
    for (const ProposedCut& cut : proposal.cuts) planes.push_back(cut.plane);
    return planes;
}

bool within(int index, std::size_t size) { return index >= 0 && std::size_t(index) < size; }

}  // namespace

ProposalTool::ProposalTool(StudioDocument& document, PartId character, Proposal proposal, Host host)
    : Tool(document),
      character_(character),
      kept_(document.document().characters.at(character)),
      sections_(kept_->body, kept_->body->mesh),
      history_(std::move(proposal)),
      host_(std::move(host)) {
    QObject::connect(&trial_, &BackgroundJob::finished, &trial_, [this](bool completed) {
        if (completed) takeTrial();
    });
    show();
    tryNext();
}

const CharacterSource* ProposalTool::source() const {
    const auto found = document_.document().characters.find(character_);
    if (found == document_.document().characters.end()) return nullptr;
    return found->second->body == kept_->body && canBecomeSoft(document_.document(), *found->second) ? found->second.get() : nullptr;
}

// ---- what is under the pointer -------------------------------------------------------------------------------------------

std::optional<RayHit> ProposalTool::fleshUnder(const PointerEvent& e) const {
    auto hit = surfaceUnder(document_.session(), e);
    if (!hit) return std::nullopt;
    const auto& elements = document_.document().elements;
    const auto element = elements.find(hit->element);
    if (element == elements.end() || !element->second->piece || element->second->piece->character != character_) return std::nullopt;
    return hit;
}

std::int32_t ProposalTool::onBody(const RayHit& hit) const {
    const auto& triangles = document_.document().elements.at(hit.element)->piece->origin->triangles;
    return within(hit.triangle, triangles.size()) ? triangles[std::size_t(hit.triangle)] : -1;
}

std::optional<Vec3> ProposalTool::insideUnder(const PointerEvent& e) const {
    const auto hits = rayHits(document_.session(), e.rayOrigin, e.rayDirection);
    const auto entry = std::find_if(hits.begin(), hits.end(), [](const RayHit& hit) { return hit.entering; });
    if (entry == hits.end()) return std::nullopt;
    const auto exit = std::find_if(entry + 1, hits.end(), [&](const RayHit& hit) { return !hit.entering && hit.element == entry->element; });
    return exit == hits.end() ? std::nullopt : std::optional<Vec3>(0.5 * (entry->rest + exit->rest));
}

bool ProposalTool::onArrow(const PointerEvent& e) const {
    if (selected_.kind != Grip::Kind::Cut || !within(selected_.index, cuts_.size())) return false;
    const Shown& cut = cuts_[std::size_t(selected_.index)];
    const auto tip = e.onScreen(cut.centre + kArrow * cut.reach * cut.plane.normal);
    return tip && (*tip - Eigen::Vector2d(e.x, e.y)).norm() <= kEndpointPixels;
}

ProposalTool::Grip ProposalTool::gripUnder(const PointerEvent& e) const {
    using Kind = Grip::Kind;
    const Proposal& p = history_.now();
    if (onArrow(e)) return selected_;
    Grip best;
    double nearest = kEndpointPixels;
    const auto offer = [&](double pixels, Grip grip) {
        if (pixels < nearest) nearest = pixels, best = grip;
    };
    const auto pixelsTo = [&](const Vec3& place) {
        const auto at = e.onScreen(place);
        return at ? (*at - Eigen::Vector2d(e.x, e.y)).norm() : std::numeric_limits<double>::infinity();
    };
    for (int b = 0; b < int(p.bones.size()); ++b)
        for (const bool atEnd : {true, false})
            if (const double pixels = pixelsTo(placeOf(p, {b, atEnd})); pixels < nearest) {
                const ProposedEnd first = jointOf(p, {b, atEnd}).front();
                offer(pixels, {Kind::End, first.bone, first.atEnd});
            }
    for (int h = 0; h < int(p.handles.size()); ++h) offer(pixelsTo(p.handles[std::size_t(h)].point), {Kind::Handle, h});
    if (best.kind != Kind::Nothing) return best;
    // Rims on the side that is seen.
    const auto flesh = fleshUnder(e);
    nearest = kBonePixels;
    for (int c = 0; c < int(cuts_.size()); ++c)
        for (const auto& loop : cuts_[std::size_t(c)].loops)
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
                if (flesh && e.viewForward.dot(a - flesh->point) > cuts_[std::size_t(c)].reach * 0.5) continue;
                offer(pixelsToSegment(e, a, b), {Kind::Cut, c});
            }
    if (best.kind != Kind::Nothing) return best;
    for (int b = 0; b < int(p.bones.size()); ++b) offer(pixelsToSegment(e, p.bones[std::size_t(b)].start, p.bones[std::size_t(b)].end), {Kind::Bone, b});
    return best;
}

int ProposalTool::pieceAt(const Vec3& place) const {
    Eigen::Index vertex = -1;
    (sections_.body().vertices.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&vertex);
    return std::size_t(vertex) < tried_.piece.size() ? tried_.piece[std::size_t(vertex)] : -1;
}

// ---- drags ---------------------------------------------------------------------------------------------------------------

void ProposalTool::press(const PointerEvent& e) {
    if (e.button != Qt::LeftButton || drag_ || handedOver_ || over()) return;
    using Kind = Grip::Kind;
    const Proposal& p = history_.now();
    const bool shift = e.modifiers & Qt::ShiftModifier, turning = onArrow(e) || (e.modifiers & Qt::ControlModifier);
    Drag drag;
    drag.grip = gripUnder(e);
    switch (drag.grip.kind) {
        case Kind::End:
            drag.from = drag.to = placeOf(p, {drag.grip.index, drag.grip.atEnd});
            drag.does = shift ? Drag::Does::AddsBone : cutAt(p, {drag.grip.index, drag.grip.atEnd}) >= 0 ? Drag::Does::Slides : Drag::Does::Moves;
            break;
        case Kind::Handle:
            drag.to = p.handles[std::size_t(drag.grip.index)].point;
            drag.does = Drag::Does::Moves;
            break;
        case Kind::Cut: drag.does = turning ? Drag::Does::Turns : Drag::Does::Slides; break;
        case Kind::Bone: drag.does = Drag::Does::Nothing; break;
        case Kind::Nothing:
            if (const auto inside = shift ? insideUnder(e) : std::nullopt) {
                drag.from = drag.to = *inside;
                drag.does = Drag::Does::AddsBone;
            } else if (!shift && fleshUnder(e)) {
                drag.does = Drag::Does::AddsCut;
            }
            break;
    }
    begin(std::move(drag), e);
}

void ProposalTool::begin(Drag drag, const PointerEvent& e) {
    drag.pressed = {e.x, e.y};
    int cut = drag.grip.kind == Grip::Kind::Cut ? drag.grip.index : -1;
    if (drag.grip.kind == Grip::Kind::End && drag.does == Drag::Does::Slides) cut = cutAt(history_.now(), {drag.grip.index, drag.grip.atEnd});
    if (cut >= 0) {
        const Shown& shown = cuts_[std::size_t(cut)];
        drag.plane = {shown.centre, shown.plane.normal};
        const Vec3 tip = shown.centre + kArrow * shown.reach * shown.plane.normal;
        drag.held = drag.does == Drag::Does::Turns ? e.onPlane(tip, e.viewForward, tip) : Vec3(shown.centre + slideAlong(e, shown.centre, shown.plane.normal).value_or(0.0) * shown.plane.normal);
    } else {
        drag.held = e.onPlane(drag.to, e.viewForward, drag.to);
    }
    drag_ = std::move(drag);
    wouldCut_.reset();
}

void ProposalTool::move(const PointerEvent& e) {
    if (handedOver_ || over()) return;
    if (drag_) return dragTo(e);
    hovered_ = gripUnder(e);
    wouldCut_.reset();
    if (hovered_.kind != Grip::Kind::Nothing || (e.modifiers & Qt::ShiftModifier)) return;
    const auto flesh = fleshUnder(e);
    if (!flesh) return;
    const auto found = sections_.across(flesh->rest, flesh->normal, onBody(*flesh));
    wouldCut_ = found ? std::optional(found->plane) : std::nullopt;
    wouldCutRim_ = wouldCut_ ? shownAt(*wouldCut_).loops : std::vector<std::vector<Vec3>>();
}

void ProposalTool::dragTo(const PointerEvent& e) {
    Drag& drag = *drag_;
    if (!drag.moved && (Eigen::Vector2d(e.x, e.y) - drag.pressed).norm() < kDragPixels) return;
    drag.moved = true;
    const Proposal& p = history_.now();
    const auto cutOfDrag = [&] { return drag.grip.kind == Grip::Kind::Cut ? drag.grip.index : cutAt(p, {drag.grip.index, drag.grip.atEnd}); };
    Result<Proposal> changed = tl::unexpected(Error{});
    switch (drag.does) {
        case Drag::Does::Slides:
        case Drag::Does::Turns: {
            const int cut = cutOfDrag();
            CutPlane plane = drag.plane;
            if (drag.does == Drag::Does::Turns) {
                const double reach = kArrow * cuts_[std::size_t(cut)].reach;
                const Vec3 under = e.onPlane(drag.held, e.viewForward, drag.held);
                const Vec3 tip = plane.origin + reach * plane.normal + e.pace() * (under - drag.held);
                drag.held = under;
                if ((tip - plane.origin).norm() > 1e-3 * reach) drag.plane.normal = plane.normal = (tip - plane.origin).normalized();
            } else if (const auto along = slideAlong(e, plane.origin, plane.normal)) {
                drag.along += e.pace() * (*along - (drag.held - plane.origin).dot(plane.normal));
                drag.held = plane.origin + *along * plane.normal;
            }
            plane.origin += drag.along * plane.normal;
            const Shown shown = shownAt(plane);
            changed = withCutMoved(p, cut, plane, shown.centre, sides());
            break;
        }
        case Drag::Does::Moves: {
            const Vec3 under = e.onPlane(drag.held, e.viewForward, drag.held);
            drag.to += e.pace() * (under - drag.held);
            drag.held = under;
            if (drag.grip.kind == Grip::Kind::Handle) {
                if (const auto flesh = fleshUnder(e)) changed = withHandleMoved(p, drag.grip.index, flesh->rest, sides());
            } else {
                changed = withEndMoved(p, {drag.grip.index, drag.grip.atEnd}, drag.to, sides());
            }
            break;
        }
        case Drag::Does::AddsBone: {
            const Vec3 beside = e.onPlane(drag.from, e.viewForward, drag.from);
            drag.to = insideUnder(e).value_or(beside);
            const int piece = pieceAt(0.5 * (drag.from + drag.to));
            changed = drag.grip.kind == Grip::Kind::End ? withBoneAdded(p, ProposedEnd{drag.grip.index, drag.grip.atEnd}, drag.to, piece, sides()) : withBoneAdded(p, drag.from, drag.to, piece, sides());
            break;
        }
        case Drag::Does::AddsCut:
        case Drag::Does::Nothing: break;
    }
    if (changed) drag.shown = std::move(*changed);
    show();
}

void ProposalTool::release(const PointerEvent& e) {
    if (!drag_ || e.button != Qt::LeftButton) return;
    Drag drag = std::move(*drag_);
    drag_.reset();
    if (drag.moved) {
        if (drag.shown && drag.does == Drag::Does::AddsBone && !isTried(history_.now())) {
            wait({{}, drag.from, drag.to});
        } else if (drag.shown) {
            if (drag.does == Drag::Does::AddsBone) selected_ = {Grip::Kind::Bone, int(history_.now().bones.size())};
            if (drag.grip.kind == Grip::Kind::Cut) selected_ = drag.grip;
            take(std::move(*drag.shown));
        }
        return show();
    }
    switch (drag.grip.kind) {
        case Grip::Kind::End:
            selected_ = {};
            take(withPinToggled(history_.now(), {drag.grip.index, drag.grip.atEnd}, sides()));
            break;
        case Grip::Kind::Handle:
            selected_ = drag.grip;
            take(withHandlePinToggled(history_.now(), drag.grip.index, sides()));
            break;
        case Grip::Kind::Cut:
        case Grip::Kind::Bone: selected_ = drag.grip; break;
        case Grip::Kind::Nothing:
            selected_ = {};
            if (drag.does != Drag::Does::AddsCut) break;
            if (const auto flesh = fleshUnder(e)) {
                if (const auto found = sections_.across(flesh->rest, flesh->normal, onBody(*flesh))) wait({found->plane, {}, {}});
                else Q_EMIT document_.failed(ToolTexts::tr("No plane cuts the flesh here."));
            }
            break;
    }
    show();
}

// ---- steps -----------------------------------------------------------------------------------------------------------------

bool ProposalTool::take(Result<Proposal> changed) {
    if (!changed) {
        Q_EMIT document_.failed(errorText(changed.error()));
        return false;
    }
    history_.push(std::move(*changed));
    hovered_ = {};
    refusalTold_ = false;
    show();
    tryNext();
    return true;
}

void ProposalTool::wait(Waiting waiting) {
    waiting_.push_back(std::move(waiting));
    tryNext();
}

Result<Proposal> ProposalTool::withCut(const CutPlane& plane, const Shown& shown) const { return withCutAdded(history_.now(), plane, shown.centre, shown.reach, std::nullopt, sides()); }

void ProposalTool::addCut(const CutPlane& plane, const Result<TriedCuts>& tried) {
    const Shown shown = shownAt(plane);
    const Proposal& p = history_.now();
    const int added = int(p.cuts.size());
    auto changed = withCut(plane, shown);
    if (changed) {
        std::optional<Error> why = tried ? tried->refused[std::size_t(added)] : std::optional(tried.error());
        if (why) return Q_EMIT document_.failed(errorText(*why));
        if (changed->bones.size() == p.bones.size()) {
            // A limb that has no bone gets one to the place of its flesh that is farthest out.
            Vec3 tip = shown.centre;
            for (Eigen::Index v = 0; v < sections_.body().vertices.rows(); ++v)
                if (const Vec3 place = sections_.body().vertices.row(v); tried->piece[std::size_t(v)] == added && (place - shown.centre).norm() > (tip - shown.centre).norm()) tip = place;
            if (tip != shown.centre) changed = withCutAdded(p, plane, shown.centre, shown.reach, Vec3(shown.centre + kWithin * (tip - shown.centre)), sides());
        }
        tried_ = *tried;
        triedPlanes_ = planesOf(*changed);
    }
    if (take(std::move(changed))) selected_ = {Grip::Kind::Cut, added};
}

void ProposalTool::addBone(const Vec3& from, const Vec3& to) {
    const Proposal& p = history_.now();
    const int piece = pieceAt(0.5 * (from + to));
    std::optional<ProposedEnd> end;  // ends may have been numbered anew since the drag
    for (int b = 0; b < int(p.bones.size()) && !end; ++b)
        for (const bool atEnd : {true, false})
            if (placeOf(p, {b, atEnd}) == from) end = jointOf(p, {b, atEnd}).front();
    const int added = int(p.bones.size());
    if (take(end ? withBoneAdded(p, *end, to, piece, sides()) : withBoneAdded(p, from, to, piece, sides()))) selected_ = {Grip::Kind::Bone, added};
}

void ProposalTool::drop(Grip grip) {
    const Proposal& p = history_.now();
    selected_ = {};
    switch (grip.kind) {
        case Grip::Kind::Cut: take(withoutCut(p, grip.index, sides())); break;
        case Grip::Kind::Bone: take(withoutBone(p, grip.index, sides())); break;
        case Grip::Kind::Handle: take(withoutHandle(p, grip.index, sides())); break;
        case Grip::Kind::End:
            if (isPinned(p, {grip.index, grip.atEnd})) take(withPinToggled(p, {grip.index, grip.atEnd}, sides()));
            break;
        case Grip::Kind::Nothing: break;
    }
}

void ProposalTool::accept() {
    const CharacterSource* of = source();
    if (!of) return;
    acceptsNext_ = !waiting_.empty();
    if (acceptsNext_) return;
    hovered_ = selected_ = {};
    wouldCut_.reset();
    handedOver_ = true;
    host_.accept(commands::makeSoft(*of, history_.now()));
}

void ProposalTool::handBack() {
    handedOver_ = false;
    tryNext();
}

bool ProposalTool::wants(int key) const {
    return !over() && (key == Qt::Key_Return || key == Qt::Key_Enter || key == Qt::Key_Delete || key == Qt::Key_Backspace || key == Qt::Key_Escape ||
                       (key == Qt::Key_X && history_.now().symmetry));
}

bool ProposalTool::key(int key, Qt::KeyboardModifiers, const QString&) {
    if (over()) return false;
    if (drag_ || handedOver_) return wants(key);  // it ends by the mouse, or by itself
    switch (key) {
        case Qt::Key_Return:
        case Qt::Key_Enter: accept(); return true;
        case Qt::Key_Escape: finished_ = true; return true;
        case Qt::Key_Delete:
        case Qt::Key_Backspace: drop(hovered_.kind != Grip::Kind::Nothing ? hovered_ : selected_); return true;
        case Qt::Key_X:
            if (!history_.now().symmetry) return false;
            mirrors_ = !mirrors_;
            return true;
        default: return false;
    }
}

void ProposalTool::cancel() {
    drag_.reset();
    show();
}

void ProposalTool::undo() {
    if (handedOver_) return;
    cancel();
    if (!history_.undo()) return;
    hovered_ = selected_ = {};
    show();
    tryNext();
}

void ProposalTool::redo() {
    if (handedOver_) return;
    cancel();
    if (!history_.redo()) return;
    hovered_ = selected_ = {};
    show();
    tryNext();
}

// ---- what is shown ---------------------------------------------------------------------------------------------------------

ProposalTool::Shown ProposalTool::shownAt(const CutPlane& plane) const {
    Shown shown;
    shown.plane = {plane.origin, plane.normal.stableNormalized()};
    shown.centre = plane.origin;
    const auto outline = sections_.at(plane);
    if (outline) {
        const TriangleMesh& body = sections_.body();
        shown.loops = sections_.placed(*outline, [&](std::int32_t v) { return Vec3(body.vertices.row(v)); });
        shown.centre = outline->centre;
        for (const Vec3& p : shown.loops.front()) shown.reach = std::max(shown.reach, (p - shown.centre).norm());
    } else {
        shown.reach = 0.05 * sections_.diagonal();
    }
    return shown;
}

void ProposalTool::show() {
    const Proposal& p = proposal();
    std::vector<Shown> shown;
    shown.reserve(p.cuts.size());
    for (std::size_t c = 0; c < p.cuts.size(); ++c) {
        const CutPlane& plane = p.cuts[c].plane;
        const auto known = std::find_if(cuts_.begin(), cuts_.end(), [&](const Shown& cut) { return samePlane(cut.plane, {plane.origin, plane.normal.stableNormalized()}); });
        shown.push_back(known != cuts_.end() ? *known : shownAt(plane));
    }
    cuts_ = std::move(shown);
}

bool ProposalTool::isTried(const Proposal& proposal) const {
    const auto& cuts = proposal.cuts;
    return !tried_.piece.empty() && std::equal(cuts.begin(), cuts.end(), triedPlanes_.begin(), triedPlanes_.end(), [](const ProposedCut& cut, const CutPlane& plane) { return samePlane(cut.plane, plane); });
}

bool ProposalTool::isTried(int cut) const {
    const auto at = std::size_t(cut);
    return at < tried_.refused.size() && at < triedPlanes_.size() && samePlane(triedPlanes_[at], proposal().cuts[at].plane);
}

void ProposalTool::tryNext() {
    if (trial_.running() || handedOver_) return;
    const auto body = std::shared_ptr<const TriangleMesh>(kept_->body, &kept_->body->mesh);
    if (!isTried(history_.now())) return trial_.start(body, history_.now());
    while (!waiting_.empty()) {
        const Waiting next = waiting_.front();
        if (next.cut) {
            auto with = withCut(*next.cut, shownAt(*next.cut));
            if (with) return trial_.start(body, std::move(*with));
            Q_EMIT document_.failed(errorText(with.error()));
        }
        waiting_.pop_front();
        if (!next.cut) addBone(next.from, next.to);
    }
    if (acceptsNext_) accept();
}

void ProposalTool::takeTrial() {
    const Proposal& of = trial_.proposal();
    const Result<TriedCuts>& tried = *trial_.result();
    const auto planes = planesOf(of);
    const auto isOf = [&](const Proposal& proposal) {
        const auto wanted = planesOf(proposal);
        return std::equal(wanted.begin(), wanted.end(), planes.begin(), planes.end(), samePlane);
    };
    // Another change may have come between: then it is tried anew.
    if (!isTried(history_.now()) && isOf(history_.now())) {
        const auto before = std::exchange(tried_, tried ? *tried : TriedCuts{std::vector<std::optional<Error>>(of.cuts.size(), tried.error()), std::vector<int>(std::size_t(sections_.body().vertices.rows()), -1)}).refused;
        triedPlanes_ = planes;
        // What was refused before was said before.
        for (std::size_t c = 0; c < tried_.refused.size() && !refusalTold_; ++c) {
            refusalTold_ = tried_.refused[c] && !(before.size() == tried_.refused.size() && before[c]);
            if (refusalTold_) Q_EMIT document_.failed(ToolTexts::tr("“%1” does not cut there: %2", "a plane, why").arg(QString::fromStdString(of.cuts[c].name), errorText(*tried_.refused[c])));
        }
        refusalTold_ = true;
    } else if (isTried(history_.now()) && !waiting_.empty() && waiting_.front().cut) {
        const CutPlane plane = *waiting_.front().cut;
        if (const auto with = withCut(plane, shownAt(plane)); with && isOf(*with)) {
            waiting_.pop_front();
            addCut(plane, tried);
        }
    }
    tryNext();
    if (host_.changed) host_.changed();
}

QString ProposalTool::banner() const {
    if (over()) return {};
    if (handedOver_) return ToolTexts::tr("It is being made soft …");
    const Proposal& p = history_.now();
    QStringList parts;
    if (const int n = int(p.cuts.size()); n > 0) parts << ToolTexts::tr("%n cut(s)", nullptr, n);
    if (const int n = int(p.bones.size()); n > 0) parts << ToolTexts::tr("%n bone(s)", nullptr, n);
    if (const int n = int(p.handles.size()); n > 0) parts << ToolTexts::tr("%n handle(s)", nullptr, n);
    if (const int n = int(p.pins.size()); n > 0) parts << ToolTexts::tr("%n pin(s)", nullptr, n);
    int none = 0;
    for (int c = 0; c < int(proposal().cuts.size()); ++c) none += isTried(c) && tried_.refused[std::size_t(c)];
    if (none > 0) parts << ToolTexts::tr("%n plane(s) that do not cut", nullptr, none);
    if (p.symmetry) parts << (mirrors_ ? ToolTexts::tr("Mirror: on (X)") : ToolTexts::tr("Mirror: off (X)"));
    parts << ToolTexts::tr("Enter: make it soft") << ToolTexts::tr("Esc: leave it as it is");
    return parts.join(QStringLiteral("  ·  "));
}

QString ProposalTool::hint() const {
    if (handedOver_ || over()) return {};
    if (drag_ && drag_->moved) {
        const bool cuts = drag_->does == Drag::Does::Slides || drag_->does == Drag::Does::Turns;
        if (cuts && drag_->grip.kind == Grip::Kind::Cut && within(drag_->grip.index, cuts_.size()) && cuts_[std::size_t(drag_->grip.index)].loops.empty())
            return ToolTexts::tr("There is no flesh to cut here.");
        return ToolTexts::tr("Release: leave it here · Shift: fine · Right button: take back");
    }
    switch (hovered_.kind) {
        case Grip::Kind::Cut: return ToolTexts::tr("Drag: move the plane · Ctrl+drag, or its arrow: turn it · Delete: drop it");
        case Grip::Kind::End: return ToolTexts::tr("Drag: move the joint · Click: pin or unpin · Shift+drag: new bone");
        case Grip::Kind::Bone: return ToolTexts::tr("Delete: drop the bone");
        case Grip::Kind::Handle: return ToolTexts::tr("Drag: move the handle · Click: pin or unpin · Delete: drop it");
        case Grip::Kind::Nothing: break;
    }
    return ToolTexts::tr("Click: add a cut · Shift+drag: add a bone · Drag planes and joints · Delete: drop");
}

void ProposalTool::decorate(render::Scene& scene) const {
    if (over()) return;
    using Shape = render::Marker::Shape;
    for (render::Body& body : scene.bodies) body.opacity = std::min(body.opacity, kProposalXray);
    const Proposal& p = proposal();
    const auto add = [&](Shape shape, const Vec3& from, const Vec3& to, const Grip& grip) -> render::Marker& {
        render::Marker& marker = scene.markers.emplace_back();
        marker.shape = shape;
        marker.from = from;
        marker.to = to;
        marker.selected = grip.kind != Grip::Kind::Nothing && grip == selected_;
        marker.hovered = grip.kind != Grip::Kind::Nothing && grip == (drag_ ? drag_->grip : hovered_);
        return marker;
    };
    for (int c = 0; c < int(cuts_.size()); ++c) {
        const Shown& cut = cuts_[std::size_t(c)];
        const Grip grip{Grip::Kind::Cut, c};
        const bool tried = isTried(c), refused = cut.loops.empty() || (tried && tried_.refused[std::size_t(c)]);
        for (const auto& loop : cut.loops) {
            render::Marker& rim = add(Shape::FaceOutline, loop.front(), loop.front(), grip);
            rim.outline = loop;
            rim.filled = tried;
            rim.refused = refused;
        }
        if (grip == selected_ || cut.loops.empty()) add(Shape::PlaneGizmo, cut.centre, cut.centre + kArrow * cut.reach * cut.plane.normal, grip).refused = refused;
    }
    for (int b = 0; b < int(p.bones.size()); ++b) add(Shape::Bone, p.bones[std::size_t(b)].start, p.bones[std::size_t(b)].end, {Grip::Kind::Bone, b});
    for (int b = 0; b < int(p.bones.size()); ++b)
        for (const bool atEnd : {true, false}) {
            const ProposedEnd end{b, atEnd};
            if (jointOf(p, end).front() != end) continue;
            add(isPinned(p, end) ? Shape::PinnedPoint : Shape::JointPoint, placeOf(p, end), placeOf(p, end), {Grip::Kind::End, b, atEnd});
        }
    for (int h = 0; h < int(p.handles.size()); ++h) {
        const ProposedHandle& handle = p.handles[std::size_t(h)];
        add(handle.pinned ? Shape::PinnedPoint : Shape::HeldPoint, handle.point, handle.point, {Grip::Kind::Handle, h});
    }
    for (const Waiting& waiting : waiting_) {
        if (!waiting.cut) add(Shape::Bone, waiting.from, waiting.to, {});
        else
            for (const auto& loop : shownAt(*waiting.cut).loops) add(Shape::FaceOutline, loop.front(), loop.front(), {}).outline = loop;
    }
    if (!wouldCut_ || drag_) return;
    for (const auto& loop : wouldCutRim_) {
        render::Marker& rim = add(Shape::FaceOutline, loop.front(), loop.front(), {});
        rim.outline = loop;
        rim.hovered = true;
    }
}

}  // namespace imomushi
