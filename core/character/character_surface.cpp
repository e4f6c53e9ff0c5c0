// SPDX-License-Identifier: GPL-3.0-or-later
// v -> positions and normals. Vertices of joint faces are placed by their joint alone, welded ones from the rest position of their first face: seams are
// closed by construction, whatever the basis can say.
#include "core/character/character_state.h"

#include <algorithm>

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

// A change of v that moves no vertex by more than this part of the element is below single precision: the product is not computed again.
constexpr double kSameShape = 1e-8;

}  // namespace

void Character::State::decideWork(std::size_t e) {
    auto& out = elements[e];
    out.moved = !out.shown || !(out.frame == out.shownFrame);
    for (std::size_t f = 0; f < out.jointOf.size(); ++f) {
        out.moved = out.moved || !(joints[out.jointOf[f]].map == out.shownJoints[f]);
        out.shownJoints[f] = joints[out.jointOf[f]].map;
    }
    for (std::size_t f = 0; f < out.shownWarping.size(); ++f) {
        out.moved = out.moved || joints[out.jointOf[f]].warping != out.shownWarping[f];
        out.shownWarping[f] = joints[out.jointOf[f]].warping;
    }
    bool sameShape = out.shown && ((out.weights() - out.shownV).cwiseAbs().cwiseProduct(out.columnSize).array() <= kSameShape * out.size).all();
    // The bend warp bends by more than v says where the basis loses twist.
    if (out.warped && out.moved && input.basis == BasisKind::Paper) sameShape = false;
    if (exact || replaying) sameShape = sameShape && out.weights() == out.shownV && !(out.warped && out.moved);
    const bool touched = out.touched && out.touched->active();
    const bool elsewhere = out.elsewhere && !touched;
    out.moved = out.moved || !sameShape || touched || elsewhere != out.madeElsewhere;
    out.madeElsewhere = elsewhere;
    out.work = Work::None;
    if (!out.moved) return;
    out.shownFrame = out.frame;
    ++out.revision;
    ++out.moves;

    const Vec3 shift = out.frame(out.middle);
    for (int i = 0; i < 3; ++i) {
        out.placement.shift[i] = static_cast<float>(shift[i]);
        for (int k = 0; k < 3; ++k) out.placement.linear[3 * i + k] = static_cast<float>(out.frame.linear(i, k));
    }
    out.pending = elsewhere;
    if (sameShape && out.localShown) {
        out.work = elsewhere ? Work::None : Work::Place;
        return;
    }
    if (elsewhere) {
        out.localShown = false;
        if (!sameShape) out.shownV = out.weights();
        out.blocks.weigh(out.shownV);
        out.shown = true;
        return;
    }
    // Who bends goes on bending, mostly: the bent shape is kept when it moves as it is, and at the start.
    out.localShown = sameShape || !out.shown || touched;
    out.work = out.localShown ? Work::EvaluateAndKeep : Work::Evaluate;
    if (!sameShape) out.shownV = out.weights();
    out.blocks.weigh(out.shownV);
    out.shown = true;
    ++stats.evaluatedElements;
    stats.evaluatedVertices += static_cast<int>(out.free.size());
}

void Character::State::bendElements() {
    bent.clear();
    std::size_t bytes = 0;
    for (std::size_t e = 0; e < elements.size(); ++e) {
        auto& out = elements[e];
        if (!out.warped || (out.work != Work::Evaluate && out.work != Work::EvaluateAndKeep)) continue;
        bent.push_back(e);
        bytes += out.warped->warp.cost().bytes;
    }
    if (bent.empty()) return;
    const auto start = std::chrono::steady_clock::now();
    share(bytes, bent, [this](std::size_t e) { bend(elements[e], input.elements[e]); });
    // Of the wall time, loads have what they have of the work.
    double all = 0.0, loaded = 0.0;
    for (const auto e : bent) all += elements[e].warped->bendMs + elements[e].warped->loadMs, loaded += elements[e].warped->loadMs;
    const double wall = milliseconds(start, std::chrono::steady_clock::now()), ofLoads = all > 0.0 ? wall * loaded / all : 0.0;
    loadMs += ofLoads;
    stats.bendWarpMs = wall - ofLoads;
}

void Character::State::bend(ElementState& out, const CharacterInput::Element& given) const {
    const auto start = std::chrono::steady_clock::now();
    auto& w = *out.warped;
    const Matrix3d toElement = out.frame.linear.transpose();
    for (std::size_t f = 0; f < w.motions.size(); ++f) {
        const auto& joint = joints[static_cast<std::size_t>(out.jointOf[f])];
        auto& motion = w.motions[f];
        motion.linear = toElement * joint.map.linear;
        motion.shift = toElement * (joint.map.shift - out.frame.shift);
        motion.rotation = out.rotation.conjugate() * joint.turn;
        if (!out.sameTree[f] && motion.rotation.w() < 0.0) motion.rotation.coeffs() = -motion.rotation.coeffs();
        if (const int modes = given.response->bases[f].modes; equilibrium && modes > 0) {
            const int first = given.response->firstColumn[f] + given.response->bases[f].plainColumns();
            w.warping.segment(first, modes) = joint.part * out.v.segment(first, modes);
        }
    }
    for (std::size_t i = 0; i < w.heldOf.size(); ++i)
        w.held.row(static_cast<Eigen::Index>(i)) = (toElement * (heldAt(out, w.heldOf[i]) - out.frame.shift)).transpose();
    w.warp.evaluate(w.motions, w.warping, w.held, out.local.data());
    const auto warped = std::chrono::steady_clock::now();
    w.bendMs = milliseconds(start, warped);
    w.loadMs = 0.0;
    if (out.loads) {
        // What loads do to the shape at rest is added; `weights` without its joints is what they do alone.
        out.loads->all.head(out.v.size()).setZero();
        out.blocks.weigh(out.loads->all);
        evaluateAndPlace(out.blocks.view(), out.blocks.weights(), out.placement, 0, out.blocks.count(), w.loaded.data(), out.positions.data());
        out.loads->all.head(out.v.size()) = out.v;
        const float* rest = out.blocks.rest().data();
        for (std::size_t i = 0; i < out.local.size(); ++i) out.local[i] += w.loaded[i] - rest[i];
        w.loadMs = milliseconds(warped, std::chrono::steady_clock::now());
    }
    out.localShown = true;
    out.work = Work::Place;
}

void Character::State::press(ElementState& out, const CharacterInput::Element& given) {
    auto& t = *out.touched;
    if (!t.active()) return;
    const auto start = std::chrono::steady_clock::now();
    if (!t.replayed) aimFingers(out, given);
    t.wasDented = t.replayed ? (t.shownForces.array() != 0.0).any() : !t.contact.idle();
    if (t.wasDented) {
        t.blocks.weigh(t.forces());
        std::copy_n(out.local.data(), out.local.size(), t.dented.data());
        t.blocks.add(0, out.blocks.count(), t.dented.data());
        place(t.dented.data(), out.blocks.first(), out.placement, 0, out.blocks.count(), out.positions.data());
    }
    stats.touchMs += milliseconds(start, std::chrono::steady_clock::now());
}

void Character::State::aimFingers(ElementState& out, const CharacterInput::Element& given) {
    auto& t = *out.touched;
    const Matrix3d toElement = out.frame.linear.transpose();
    for (int i = 0; i < TouchContact::kFingers; ++i) {
        if (!t.contact.down(i)) continue;
        std::array<Vec3, 3> corners;
        for (int c = 0; c < 3; ++c) corners[static_cast<std::size_t>(c)] = poseAt(out, given.mesh->body.triangles(t.contact.triangle(i), c));
        const Vec3 target = toElement * (t.fingers[static_cast<std::size_t>(i)].target - out.frame.shift);
        t.contact.aim(i, corners, target);
    }
    if (frameSeconds > 0.0)
        t.contact.step(frameSeconds);
    else
        t.contact.settle();
}

Vec3 Character::State::poseAt(const ElementState& e, std::int32_t vertex) const {
    const auto held = std::find_if(e.held.begin(), e.held.end(), [vertex](const HeldVertex& h) { return h.vertex == vertex; });
    if (held != e.held.end()) return e.frame.linear.transpose() * (heldAt(e, static_cast<std::size_t>(held - e.held.begin())) - e.frame.shift);
    return localAt(e, vertex, false);
}

Vec3 Character::State::localAt(const ElementState& e, std::int32_t vertex, bool dented) {
    const std::int32_t* first = e.blocks.first();
    const std::size_t block = static_cast<std::size_t>(std::upper_bound(first, first + e.blocks.count(), vertex) - first) - 1;
    const float* at = (dented ? e.touched->dented : e.local).data() + block * 3 * kVertexBlock + (vertex - first[block]);
    return e.middle + Vec3(at[0], at[kVertexBlock], at[2 * kVertexBlock]);
}

void Character::State::showPositions(ElementState& out, std::size_t begin, std::size_t end) {
    if (out.work == Work::None) return;
    if (out.work == Work::Place)
        place(out.local.data(), out.blocks.first(), out.placement, begin, end, out.positions.data());
    else
        evaluateAndPlace(out.blocks.view(), out.blocks.weights(), out.placement, begin, end,
                         out.work == Work::EvaluateAndKeep ? out.local.data() : nullptr, out.positions.data());
}

void Character::State::holdVertices(ElementState& out) const {
    if (!out.moved || out.pending) return;
    if (equilibrium || explicitJoints) return holdWarped(out);
    for (const auto& h : out.held) {
        const Vec3 p = joints[h.joint].map(h.rest);
        for (int i = 0; i < 3; ++i) out.positions[3 * static_cast<std::size_t>(h.vertex) + i] = static_cast<float>(p[i]);
    }
}

Vec3 Character::State::heldAt(const ElementState& element, std::size_t i) const {
    const auto& h = element.held[i];
    const auto& joint = joints[h.joint];
    Vec3 p = joint.map(h.rest);
    if (equilibrium) p.noalias() += joint.warping * element.heldShapes.col(static_cast<Eigen::Index>(i));
    if (explicitJoints) p += joint.turn * offset(h.node);
    return p;
}

void Character::State::holdWarped(ElementState& out) const {
    for (std::size_t k = 0; k < out.held.size(); ++k) {
        const Vec3 p = heldAt(out, k);
        for (int i = 0; i < 3; ++i) out.positions[3 * static_cast<std::size_t>(out.held[k].vertex) + i] = static_cast<float>(p[i]);
    }
}

void Character::State::holdNormals(ElementState& out) const {
    if (!out.moved || out.pending) return;
    for (const auto& h : out.hidden) {
        const Vec3 n = (joints[h.joint].map.linear * h.normal).normalized();
        for (int i = 0; i < 3; ++i) out.normals[3 * static_cast<std::size_t>(h.vertex) + i] = static_cast<float>(n[i]);
    }
    for (auto& r : out.rim) r.normal = Eigen::Map<const Eigen::Vector3f>(out.normals.data() + 3 * static_cast<std::ptrdiff_t>(r.vertex));
}

void Character::State::closeSeams() {
    for (const auto& s : seams) {
        auto& out = elements[s.element];
        if (!out.moved && !elements[s.other].moved) continue;
        if (out.pending || elements[s.other].pending)
            out.seamsOpen = true;
        else if (!closeSeam(s))
            continue;
        if (!out.moved) seamOnly[s.element] = 1;
    }
    for (std::size_t e = 0; e < elements.size(); ++e) {
        if (seamOnly[e]) ++elements[e].revision;
        seamOnly[e] = 0;
    }
}

bool Character::State::closeSeam(const SeamNormal& s) {
    auto& out = elements[s.element];
    const auto& rim = elements[s.other].rim;
    const Eigen::Vector3f own = out.rim[s.own].normal;
    const Eigen::Vector3f across = (1.0f - s.part) * rim[s.from].normal + s.part * rim[s.to].normal;
    const Eigen::Vector3f sum = own + across;
    const float length = sum.norm();
    const Eigen::Vector3f n = length > SurfaceRecipe::kNoSeamNormal ? Eigen::Vector3f(sum / length) : own;
    float* to = out.normals.data() + 3 * static_cast<std::ptrdiff_t>(s.vertex);
    if (std::equal(n.data(), n.data() + 3, to)) return false;
    std::copy_n(n.data(), 3, to);
    return true;
}

}  // namespace imomushi
