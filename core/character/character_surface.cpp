// SPDX-License-Identifier: GPL-3.0-or-later
// v -> positions and normals. Vertices of joint faces are placed by their joint alone, welded ones from the rest position of their first face: seams are
// closed by construction, whatever the basis can say.
#include <algorithm>

#include "core/character/character_state.h"

namespace imomushi {

namespace {

// A change of v that moves no vertex by more than this part of the element is below single precision: the product is not computed again.
constexpr double kSameShape = 1e-8;

}  // namespace

void Character::State::findMoved(ElementState& out) {
    const auto& joints = frame.joints;
    const auto& runtime = *out.runtime;
    const bool warped = runtime.warp && out.warpPart > 0.0;
    out.moved = !out.shown || !(out.frame == out.shownFrame);
    for (std::size_t f = 0; f < out.jointOf.size(); ++f) {
        out.moved = out.moved || !(joints[out.jointOf[f]].map == out.shownJoints[f]);
        out.shownJoints[f] = joints[out.jointOf[f]].map;
    }
    for (std::size_t f = 0; f < out.shownWarping.size(); ++f) {
        out.moved = out.moved || joints[out.jointOf[f]].warping != out.shownWarping[f];
        out.shownWarping[f] = joints[out.jointOf[f]].warping;
    }
    if (out.turns != out.shownTurns) {
        out.moved = true;
        out.shownTurns = out.turns;
    }
    bool sameShape =
        out.shown && ((out.weights() - out.shownWeights).cwiseAbs().cwiseProduct(runtime.columnSize).array() <= kSameShape * runtime.size).all();
    // The bend warp bends by more than v says where the basis loses twist.
    if (warped && out.moved && frame.input.basis == BasisKind::Paper) sameShape = false;
    if (frame.exact || frame.replaying) sameShape = sameShape && out.weights() == out.shownWeights && !(warped && out.moved);
    sameShape = sameShape && out.warpPart == out.shownWarpPart;
    out.shownWarpPart = out.warpPart;
    out.sameShape = sameShape;
    out.moved = out.moved || !sameShape;
}

void Character::State::decideWork(ElementState& out) {
    const auto& runtime = *out.runtime;
    const bool warped = runtime.warp && out.warpPart > 0.0, sameShape = out.sameShape;
    // Dents are added to `local`, unless they and what is under them stay as they are.
    const bool pressed = (out.patchForces.array() != 0.0).any();
    if (out.moved ? pressed : out.patchForces != out.shownPatchForces || out.fingerDents != out.shownFingerDents) out.wantsLocal = true;
    const bool external = out.wantsExternal && !out.wantsLocal && !out.wantsHere && !warped && !pressed;
    out.moved = out.moved || out.wantsLocal || external != out.external;
    out.external = external;
    out.work = VertexWork::None;
    if (!out.moved) return;
    out.shownFrame = out.frame;
    ++out.revision;
    ++out.moves;

    out.placement = AffineMap{out.frame.linear, out.frame(runtime.middle)}.toFloat();
    out.pending = external || out.unseen;
    out.seenPending = external;
    out.partial = out.unseen && !out.wantsLocal && !warped;
    if (sameShape && out.localShown && (out.partial || !out.localPart)) {
        out.work = external ? VertexWork::None : VertexWork::Place;
        return;
    }
    if (external) {
        out.localShown = false;
        if (!sameShape) out.shownWeights = out.weights();
        out.blocks.weigh(out.shownWeights);
        out.shown = true;
        return;
    }
    // Who bends goes on bending, mostly: the bent shape is kept when it moves as it is, and at the start.
    out.localShown = sameShape || !out.shown || out.wantsLocal;
    out.localPart = out.partial;
    out.work = out.localShown ? VertexWork::EvaluateAndKeep : VertexWork::Evaluate;
    if (!sameShape) out.shownWeights = out.weights();
    out.blocks.weigh(out.shownWeights);
    out.shown = true;
    ++frame.stats.evaluatedElements;
    frame.stats.evaluatedVertices += out.evaluatedVertices;
}

void Character::State::showPositions(ElementState& out, std::size_t begin, std::size_t end) {
    if (out.work == VertexWork::None) return;
    if (out.work == VertexWork::Place)
        place(out.local.data(), out.blocks.first(), out.placement, begin, end, out.positions.data());
    else
        evaluateAndPlace(out.blocks.view(), out.blocks.weights(), out.placement, begin, end,
                         out.work == VertexWork::EvaluateAndKeep ? out.local.data() : nullptr, out.positions.data());
}

void Character::State::beginDents(ElementState& out) const {
    if (!frame.replaying) {
        out.patchForces.setZero();
        std::fill(out.fingerDents.begin(), out.fingerDents.end(), Dent());
    }
    out.wantsLocal = false;
}

void Character::State::placeDents() {
    const auto start = std::chrono::steady_clock::now();
    std::size_t bytes = 0;
    for (auto& out : frame.elements) {
        if (out.patchForces.size() == 0 || !out.moved) continue;
        out.shownPatchForces = out.patchForces;
        out.shownFingerDents = out.fingerDents;
        out.touchBlocks.weigh(out.patchForces);
        out.dented = out.touchBlocks.idle() ? nullptr : out.dents.data();
        if (out.dented) bytes += out.dents.bytes() * static_cast<std::size_t>(out.touchBlocks.activeColumns());
    }
    if (bytes > 0)
        frame.share(bytes, productPieces, [this](const Piece& p) {
            auto& out = frame.elements[static_cast<std::size_t>(p.element)];
            const std::size_t end = std::min(p.end, out.runtime->bodyBlocks), first = 3 * kVertexBlock * p.begin;
            if (!out.moved || !out.dented || p.begin >= end) return;
            std::copy_n(out.local.data() + first, 3 * kVertexBlock * (end - p.begin), out.dents.data() + first);
            out.touchBlocks.add(p.begin, end, out.dents.data());
            if (out.runtime->dents) out.runtime->dents->add(out.fingerDents, p.begin, end, out.dents.data());
            place(out.dents.data(), out.blocks.first(), out.placement, p.begin, end, out.positions.data());
        });
    frame.dentMs = dentMs += milliseconds(start, std::chrono::steady_clock::now());
}

void Character::State::holdVertices(ElementState& out) const {
    if (!out.moved || (out.pending && !out.unseen) || out.seenPending) return;
    const auto put = [&out](const HeldVertex& h, const Vec3& p) {
        for (int i = 0; i < 3; ++i) out.positions[3 * static_cast<std::size_t>(h.vertex) + i] = static_cast<float>(p[i]);
    };
    if (frame.smooth || !frame.offsets.empty())
        for (std::size_t i = 0; i < out.held.size(); ++i) put(out.held[i], frame.heldAt(out, i));
    else
        for (const auto& h : out.held) put(h, frame.joints[h.joint].map(h.rest));
}

void Character::State::holdNormals(ElementState& out) const {
    if (!out.moved || out.pending) return;
    for (const auto& h : out.runtime->hidden) {
        const Vec3 n = (frame.joints[out.jointOf[h.face]].map.linear * h.normal).normalized();
        for (int i = 0; i < 3; ++i) out.normals[3 * static_cast<std::size_t>(h.vertex) + i] = static_cast<float>(n[i]);
    }
    for (auto& r : out.rim) r.normal = Eigen::Map<const Eigen::Vector3f>(out.normals.data() + 3 * static_cast<std::ptrdiff_t>(r.vertex));
}

void Character::State::closeSeams() {
    for (const auto& s : seams) {
        auto& out = frame.elements[s.element];
        if (!out.moved && !frame.elements[s.other].moved) continue;
        if (out.pending || frame.elements[s.other].pending)
            out.seamsOpen = true;
        else if (!closeSeam(s))
            continue;
        if (!out.moved) seamOnly[s.element] = 1;
    }
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        if (seamOnly[e]) ++frame.elements[e].revision;
        seamOnly[e] = 0;
    }
}

bool Character::State::closeSeam(const SeamNormal& s) {
    auto& out = frame.elements[s.element];
    const auto& rim = frame.elements[s.other].rim;
    const Eigen::Vector3f own = out.rim[s.own].normal;
    const Eigen::Vector3f across = (1.0f - s.part) * rim[s.from].normal + s.part * rim[s.to].normal;
    const Eigen::Vector3f sum = own + across;
    const float length = sum.norm();
    const Eigen::Vector3f n = length > DeformInput::kNoSeamNormal ? Eigen::Vector3f(sum / length) : own;
    float* to = out.normals.data() + 3 * static_cast<std::ptrdiff_t>(s.vertex);
    if (std::equal(n.data(), n.data() + 3, to)) return false;
    std::copy_n(n.data(), 3, to);
    return true;
}

}  // namespace imomushi
