// SPDX-License-Identifier: GPL-3.0-or-later
// One frame: pose -> joints -> v (character_pose.cpp) -> vertices (character_surface.cpp).
#include "core/character/character_state.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

void Character::State::update(const Pose& wanted, double seconds) {
    const auto start = std::chrono::steady_clock::now();
    updateWarnings = 0;
    stats.evaluatedElements = stats.evaluatedVertices = 0;
    frameSeconds = seconds;
    if (wanted.points.empty() && !pose.points.empty())
        assign(poseOfRest);
    else if (fits(input.skeleton, wanted))
        assign(wanted);
    else
        updateWarnings |= static_cast<unsigned>(FrameWarning::PoseRefused);
    for (std::size_t e = 0; e < elements.size(); ++e) placeElement(e);
    const auto placing = std::chrono::steady_clock::now();
    for (std::size_t j = 0; j < joints.size(); ++j) placeJoint(j);
    if (effects.jointDynamics) stats.jointDynamicsMs = milliseconds(placing, std::chrono::steady_clock::now());
    for (std::size_t e = 0; e < elements.size(); ++e) measure(e);
    loadMs = 0.0;
    if (effects.gravity || effects.inflate) {
        const auto begun = std::chrono::steady_clock::now();
        if (effects.inflate)
            breath = !stopped && effects.inflate->breath > 0.0 ? std::fmod(breath + kTurn * effects.inflate->breathHertz * seconds, kTurn) : 0.0;
        for (std::size_t e = 0; e < elements.size(); ++e) load(e, seconds);
        loadMs = milliseconds(begun, std::chrono::steady_clock::now());
    }
    if (explicitJoints) stepExplicitJoints();
    if (equilibrium) {
        const auto rigid = std::chrono::steady_clock::now();
        relax();
        stats.equilibriumMs = milliseconds(rigid, std::chrono::steady_clock::now());
    }
    for (auto& e : elements) {
        if (e.loads) e.loads->all.head(e.v.size()) = e.v;
        if (e.touched) e.touched->replayed = false;
    }
    replaying = false;
    showShape(start);
    if (effects.gravity || effects.inflate) shareLoadTime();
    stopped = false;
}

void Character::State::showShape(std::chrono::steady_clock::time_point start) {
    const auto measured = std::chrono::steady_clock::now();
    std::size_t bytes = 0;
    stats.bendWarpMs = stats.touchMs = 0.0;
    for (std::size_t e = 0; e < elements.size(); ++e) decideWork(e);
    bendElements();
    for (std::size_t e = 0; e < elements.size(); ++e) {
        if (elements[e].moved && !elements[e].pending) bytes += elements[e].blocks.count() * elements[e].blocks.bytesPerBlock();
    }
    share(bytes, productPieces, [this](const Piece& p) { showPositions(elements[p.element], p.begin, p.end); });
    for (std::size_t e = 0; e < elements.size(); ++e)
        if (elements[e].touched) press(elements[e], input.elements[e]);
    for (auto& e : elements) holdVertices(e);
    const auto placed = std::chrono::steady_clock::now();
    share(bytes, normalPieces, [this](const Piece& p) {
        auto& out = elements[p.element];
        if (out.moved && !out.pending)
            findNormals(out.positions.data(), out.stencils.data(), static_cast<float>(out.scale()), p.begin, p.end, out.normals.data());
    });
    for (auto& e : elements) holdNormals(e);
    closeSeams();
    for (std::size_t e = 0; recipe && e < elements.size(); ++e) fillRecipe(e);
    const auto done = std::chrono::steady_clock::now();
    stats.jointsMs = milliseconds(start, measured);
    stats.productMs = milliseconds(measured, placed);
    stats.normalsMs = milliseconds(placed, done);
    stats.warnings = solveWarnings | updateWarnings;
}

void Character::State::shareLoadTime() {
    double columns = 0.0, gravity = 0.0, inflated = 0.0;
    for (const auto& e : elements) {
        if (e.work != Work::Evaluate && e.work != Work::EvaluateAndKeep) continue;
        const auto vertices = static_cast<double>(e.free.size());
        columns += vertices * static_cast<double>(e.weights().size());
        if (e.loads && e.loads->gravity) gravity += 3.0 * vertices;
        if (e.loads && e.loads->inflated) inflated += vertices;
    }
    const double share = columns > 0.0 ? stats.productMs / columns : 0.0;
    const double own = effects.gravity && effects.inflate ? 0.5 * loadMs : loadMs;
    stats.gravityMs = effects.gravity ? own + share * gravity : 0.0;
    stats.inflateMs = effects.inflate ? own + share * inflated : 0.0;
}

void Character::State::assign(const Pose& p) {
    std::copy(p.points.begin(), p.points.end(), pose.points.begin());
    std::copy(p.frames.begin(), p.frames.end(), pose.frames.begin());
    std::copy(p.roll.begin(), p.roll.end(), pose.roll.begin());
}

Character::Character(std::unique_ptr<State> state) : state_(std::move(state)) {}
Character::Character(Character&&) noexcept = default;
Character& Character::operator=(Character&&) noexcept = default;
Character::~Character() = default;

Result<Character> Character::build(CharacterInput input) {
    if (auto ok = checkInput(input); !ok) return tl::unexpected(ok.error());
    auto state = std::make_unique<State>(std::move(input));
    if (state->failure) return tl::unexpected(*state->failure);
    return Character(std::move(state));
}

const CharacterInput& Character::input() const { return state_->input; }

InverseKinematics::Report Character::solvePose(const std::vector<Hold>& holds, Pose& pose) {
    const auto start = std::chrono::steady_clock::now();
    const auto report = state_->kinematics.solve(holds, pose);
    state_->solveWarnings = (report.outOfReach ? static_cast<unsigned>(FrameWarning::TargetOutOfReach) : 0u) |
                            (report.finite ? 0u : static_cast<unsigned>(FrameWarning::PoseRefused));
    state_->stats.poseMs = milliseconds(start, std::chrono::steady_clock::now());
    state_->stats.warnings = state_->solveWarnings | state_->updateWarnings;
    return report;
}

void Character::update(const Pose& pose, double seconds) { state_->update(pose, seconds); }

void Character::stop() { state_->stopped = true; }

void Character::tune(const CharacterEffects& effects) {
    auto& now = state_->effects;
    if (now.gravity && effects.gravity) now.gravity = effects.gravity;
    if (now.inflate && effects.inflate) now.inflate = effects.inflate;
    if (now.jointDynamics && effects.jointDynamics &&
        (now.jointDynamics->hertz != effects.jointDynamics->hertz || now.jointDynamics->damping != effects.jointDynamics->damping)) {
        now.jointDynamics = effects.jointDynamics;
        for (auto& joint : state_->joints)
            if (joint.jiggle) (void)joint.jiggle->set(*now.jointDynamics);  // refused numbers leave it as it is
    }
    if (now.previousModel && effects.previousModel) {
        const auto &was = *now.previousModel, &is = *effects.previousModel;
        const bool same = was.step == is.step && was.damping == is.damping && was.shearModulus == is.shearModulus;
        now.previousModel = is;
        if (!same && state_->explicitJoints) (void)state_->explicitJoints->set(is);
    }
    if (now.touch && effects.touch) {
        now.touch = effects.touch;
        for (auto& e : state_->elements)
            if (e.touched) (void)e.touched->contact.set(*now.touch);
    }
}

bool Character::setFinger(int element, int finger, const Vec3& rest, const Vec3& target, double radius) {
    auto& e = state_->elements[static_cast<std::size_t>(element)];
    if (!e.touched || !allFinite(target)) return false;
    auto& t = *e.touched;
    auto& known = t.fingers[static_cast<std::size_t>(finger)];
    // A finger that only moves keeps its place: finding it again costs more than a frame.
    if (!t.contact.down(finger) || rest != known.rest || radius != known.radius)
        if (!t.contact.place(finger, t.contact.nearest(rest), radius)) return false;
    known = {rest, target, radius};
    return true;
}

void Character::liftFinger(int element, int finger) {
    if (auto& touched = state_->elements[static_cast<std::size_t>(element)].touched) touched->contact.lift(finger);
}

bool Character::resting() const { return state_->resting(); }

Character::Surface Character::surface(int element) const {
    const auto& e = state_->elements[element];
    if (e.pending || e.seamsOpen) state_->catchUp(static_cast<std::size_t>(element));
    return {e.positions.data(), e.normals.data(), static_cast<int>(e.vertices), e.revision};
}

Points Character::positions(int element) const {
    const auto& given = state_->input.elements[element];
    const auto& e = state_->elements[element];
    Points out(given.mesh->body.vertices.rows(), 3);
    std::vector<double> displacement(3 * e.free.size(), 0.0);
    Eigen::Map<Eigen::VectorXd> x(displacement.data(), static_cast<Eigen::Index>(displacement.size()));
    if (given.response && given.response->columns() > 0) x.noalias() = given.response->response * e.v;
    if (e.loads) {
        const Eigen::Index first = e.loads->first();
        if (e.loads->gravity) x.noalias() += given.response->loads.leftCols<3>() * e.loads->all.segment<3>(first);
        if (e.loads->inflated) x.noalias() += given.response->loads.col(3) * e.loads->all[e.loads->all.size() - 1];
    }
    for (std::size_t i = 0; i < e.free.size(); ++i) {
        const Vec3 rest = given.mesh->body.vertices.row(e.free[i]).transpose();
        out.row(e.free[i]) = e.frame(rest + x.segment<3>(3 * static_cast<Eigen::Index>(i))).transpose();
    }
    // What only a frame knows is as precise as it is shown.
    if (e.warped || (e.touched && e.touched->wasDented))
        for (const auto v : e.free) out.row(v) = e.frame(state_->localAt(e, v, e.touched && e.touched->wasDented)).transpose();
    for (std::size_t i = 0; i < e.held.size(); ++i) out.row(e.held[i].vertex) = state_->heldAt(e, i).transpose();
    return out;
}

const Eigen::VectorXd& Character::jointParameters(int element) const { return state_->elements[element].v; }

Eigen::Isometry3d Character::frame(int element) const {
    const auto& f = state_->elements[element].frame;
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = f.linear;
    out.translation() = f.shift;
    return out;
}

const Character::Stats& Character::stats() const { return state_->stats; }

Character::Memory Character::memory(int element) const {
    const auto& e = state_->elements[element];
    return {e.blocks.responseBytes(), e.blocks.rest().bytes() + e.local.bytes() + e.positions.bytes() + e.normals.bytes() + e.stencils.size() * sizeof(NormalStencil)};
}

double Character::formatError(int element) const { return state_->elements[element].blocks.error(); }

double Character::formatError() const {
    double worst = 0.0;
    for (std::size_t e = 0; e < state_->elements.size(); ++e) worst = std::max(worst, formatError(static_cast<int>(e)));
    return worst;
}

double Character::shrink(int joint) const { return state_->joints[joint].shrink; }

Points deformElement(const ElementMesh& mesh, const std::vector<JointFace>& faces, const ElementResponse& response, const Eigen::VectorXd& v) {
    Points out = mesh.body.vertices;
    const Eigen::VectorXd x = response.response * v;
    for (std::size_t i = 0; i < response.freeVertices.size(); ++i)
        out.row(response.freeVertices[i]) += x.segment<3>(3 * static_cast<Eigen::Index>(i)).transpose();
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const auto& frame = faces[f].frame;
        const auto part = v.segment(response.firstColumn[f], response.bases[f].columns());
        int i = 0;
        for (const auto p : faces[f].vertices) {
            const Vec3 rest = mesh.body.vertices.row(p).transpose();
            out.row(p) += (frame.axes * (response.bases[f].at(frame.toLocal(rest), i++) * part)).transpose();
        }
    }
    return out;
}

}  // namespace imomushi
