// SPDX-License-Identifier: GPL-3.0-or-later
// One frame: pose -> joints -> v (character_pose.cpp) -> vertices (character_surface.cpp).
#include <algorithm>

#include "core/character/character_state.h"
#include "core/character/render_columns.h"

namespace imomushi {

void Character::State::update(const Pose& wanted, double seconds, bool again) {
    const auto start = std::chrono::steady_clock::now();
    if (!again) frame.warnings = 0;
    frame.seconds = seconds;
    frame.again = again;
    frame.replaying = false;
    if (!again) beginTimes();
    if (wanted.points.empty() && !frame.pose.points.empty())
        assign(poseOfRest);
    else if (fits(frame.input.skeleton, wanted))
        assign(wanted);
    else
        frame.warn(FrameWarning::PoseRefused);
    for (auto& element : frame.elements) element.turns = element.askedTurns;
    for (std::size_t m = 0; m < frame.morphs.size(); ++m) std::copy(frame.askedMorphs[m].begin(), frame.askedMorphs[m].end(), frame.morphs[m].begin());
    for (std::size_t e = 0; e < frame.elements.size(); ++e) placeElement(e);
    for (std::size_t h = 0; h < frame.handles.size(); ++h) placeHandle(h);
    for (auto& element : frame.elements) fitElement(element);
    for (std::size_t j = 0; j < frame.joints.size(); ++j)
        if (!frame.joints[j].handle) placeJoint(j);
    jobs.run(Stage::Joints, frame);
    for (auto& joint : frame.joints) mapJoint(joint);
    if (weighs) weighEffects();
    jobs.run(Stage::JointMaps, frame);
    for (std::size_t e = 0; e < frame.elements.size(); ++e) findParameters(e);
    for (const Stage stage : {Stage::Loads, Stage::FaceOffsets, Stage::Equilibrium}) jobs.run(stage, frame);
    for (auto& e : frame.elements)
        if (e.withLoads.size() > 0) e.withLoads.head(e.v.size()) = e.v;
    showShape(start);
    frame.stopped = false;
}

void Character::State::beginTimes() {
    jobs.begin();
    frame.loadMsOfWarp = dentMs = 0.0;
    frame.stats.jointsMs = frame.stats.productMs = frame.stats.normalsMs = 0.0;
}

void Character::State::showShape(std::chrono::steady_clock::time_point start) {
    auto& elements = frame.elements;
    auto& stats = frame.stats;
    const auto weighed = std::chrono::steady_clock::now();
    stats.evaluatedElements = stats.evaluatedVertices = 0;
    for (auto& e : elements) {
        findMoved(e);
        beginDents(e);
    }
    jobs.run(Stage::Weights, frame);
    for (auto& e : elements) decideWork(e);
    jobs.run(Stage::LocalShape, frame);
    std::size_t bytes = 0;
    for (const auto& e : elements)
        if (e.moved && (!e.pending || e.unseen)) bytes += e.blocks.count() * e.blocks.bytesPerBlock();
    frame.share(bytes, productPieces, [&elements](const Piece& p) {
        auto& out = elements[p.element];
        if (!p.unseen || !out.partial) showPositions(out, p.begin, p.end);
    });
    jobs.run(Stage::Dents, frame);
    placeDents();
    for (auto& e : elements) holdVertices(e);
    jobs.run(Stage::Placed, frame);
    const auto placed = std::chrono::steady_clock::now();
    frame.share(bytes, normalPieces, [&elements](const Piece& p) {
        auto& out = elements[p.element];
        if (out.moved && !out.pending)
            findNormals(out.positions.data(), out.runtime->stencils.data(), static_cast<float>(out.runtime->inverseSize()), p.begin, p.end, out.normals.data());
    });
    for (auto& e : elements) holdNormals(e);
    closeSeams();
    jobs.run(Stage::Normals, frame);
    for (std::size_t e = 0; deformInput && e < elements.size(); ++e) fillDeformInput(e);
    const auto done = std::chrono::steady_clock::now();
    stats.jointsMs += milliseconds(start, weighed);
    stats.productMs += milliseconds(weighed, placed);
    stats.normalsMs += milliseconds(placed, done);
    stats.warnings = solveWarnings | frame.warnings;
    jobs.report(frame);
}

void Character::State::assign(const Pose& p) {
    std::copy(p.points.begin(), p.points.end(), frame.pose.points.begin());
    std::copy(p.frames.begin(), p.frames.end(), frame.pose.frames.begin());
    std::copy(p.roll.begin(), p.roll.end(), frame.pose.roll.begin());
}

Character::Character(std::unique_ptr<State> state) : state_(std::move(state)) {}
Character::Character(Character&&) noexcept = default;
Character& Character::operator=(Character&&) noexcept = default;
Character::~Character() = default;

const CharacterInput& Character::input() const { return state_->frame.input; }

InverseKinematics::Report Character::solvePose(const std::vector<IkGoal>& goals, Pose& pose, double seconds) {
    const auto start = std::chrono::steady_clock::now();
    const auto report = state_->kinematics.solve(goals, pose, seconds);
    state_->solveWarnings = (report.outOfReach ? static_cast<unsigned>(FrameWarning::TargetOutOfReach) : 0u) |
                            (report.finite ? 0u : static_cast<unsigned>(FrameWarning::PoseRefused));
    state_->frame.stats.poseMs = milliseconds(start, std::chrono::steady_clock::now());
    state_->frame.stats.warnings = state_->solveWarnings | state_->frame.warnings;
    return report;
}

void Character::update(const Pose& pose, double seconds) { state_->update(pose, seconds, false); }

void Character::correct(const Pose& pose) { state_->update(pose, 0.0, true); }

void Character::shift(const Pose& pose) {
    state_->frame.shifted = true;
    state_->update(pose, 0.0, true);
    state_->frame.shifted = false;
}

void Character::stop() { state_->frame.stopped = true; }

void Character::tune(const CharacterEffects& effects) { state_->jobs.tune(effects); }
void Character::tune(const EffectSettings& settings) { state_->jobs.tune(settings); }

FrameJobs& Character::jobs() { return state_->jobs; }

const FrameJobs& Character::jobs() const { return state_->jobs; }

const Pose& Character::pose() const { return state_->frame.pose; }

bool Character::resting() const { return state_->jobs.resting(state_->frame); }

Character::Surface Character::surface(int element) const {
    const auto& e = state_->frame.elements[element];
    if (e.pending || e.seamsOpen) state_->catchUp(static_cast<std::size_t>(element));
    return {e.positions.data(), e.normals.data(), static_cast<int>(e.runtime->vertices), e.revision};
}

Points Character::positions(int element) const {
    const auto& given = state_->frame.input.elements[element];
    const auto& e = state_->frame.elements[element];
    const auto& free = e.runtime->free;
    Points out(given.mesh->body.vertices.rows(), 3);
    std::vector<double> displacement(3 * free.size(), 0.0);
    Eigen::Map<Eigen::VectorXd> x(displacement.data(), static_cast<Eigen::Index>(displacement.size()));
    if (given.response && given.response->columns() > 0) x.noalias() = given.response->response * e.v;
    const auto& loads = e.runtime->input.tables.loads;
    if (!loads.empty() && loads.front() == 0) x.noalias() += given.response->loads.leftCols<3>() * e.withLoads.segment<3>(e.v.size());
    if (!loads.empty() && loads.back() == 3) x.noalias() += given.response->loads.col(3) * e.withLoads[e.withLoads.size() - 1];
    for (std::size_t i = 0; i < free.size(); ++i) {
        const Vec3 rest = given.mesh->body.vertices.row(free[i]).transpose();
        out.row(free[i]) = e.frame(rest + x.segment<3>(3 * static_cast<Eigen::Index>(i))).transpose();
    }
    // What only a frame knows is as precise as it is shown.
    if (e.warpPart > 0.0 || e.dented)
        for (const auto v : free) out.row(v) = e.frame(e.localAt(v, e.dented ? e.dented : e.local.data())).transpose();
    for (std::size_t i = 0; i < e.held.size(); ++i) out.row(e.held[i].vertex) = state_->frame.heldAt(e, i).transpose();
    return out;
}

Character::Surface Character::renderSurface(int mesh) const {
    state_->catchUpMesh(mesh);
    return state_->renderMeshes->surface(mesh);
}

Points Character::renderPositions(int mesh) const {
    const auto& tables = state_->renderMeshes->tables(mesh);
    std::vector<Points> bodies(state_->frame.elements.size());
    for (const auto e : tables.elements) bodies[static_cast<std::size_t>(e)] = positions(e);
    return state_->renderMeshes->positions(state_->frame, mesh, bodies);
}

const std::vector<double>& Character::morphWeights(int mesh) const { return state_->frame.morphs[static_cast<std::size_t>(mesh)]; }

const Points& Character::renderRestPositions(int mesh) const { return state_->renderMeshes->tables(mesh).rest; }

Eigen::MatrixXd Character::renderColumns(int mesh, int element) const {
    const auto& runtime = *state_->frame.elements[static_cast<std::size_t>(element)].runtime;
    const Eigen::MatrixXd all = vertexColumns(runtime);
    std::vector<Eigen::Index> rows;
    for (const auto& vertex : state_->renderMeshes->tables(mesh).mesh->vertices)
        if (vertex.element == element)
            for (Eigen::Index k = 0; k < 3; ++k) rows.push_back(3 * elementVertex(vertex, runtime) + k);
    return all(rows, Eigen::indexing::all);
}

std::vector<std::function<void()>> Character::missingWatches() const {
    std::vector<std::function<void()>> out;
    for (const auto& e : state_->frame.elements) {
        if (!e.runtime->lazyWatch || e.runtime->lazyWatch->ready()) continue;
        out.emplace_back([runtime = e.runtime] { (void)runtime->findWatch(); });
    }
    return out;
}

std::vector<PoseMeasures> Character::measurePose() {
    auto& elements = state_->frame.elements;
    std::vector<PoseMeasures> out(elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const auto& given = elements[e].runtime->input;
        if (!given.response || given.faces.empty()) continue;
        const auto watch = elements[e].runtime->findWatch();
        elements[e].watched.resize(given.faces.size());
        state_->findMotions(elements[e]);
        auto room = watch->room();
        out[e] = watch->measure(elements[e].v, elements[e].watched, room);
    }
    return out;
}

const Eigen::VectorXd& Character::jointParameters(int element) const { return state_->frame.elements[element].v; }

Eigen::Isometry3d Character::frame(int element) const {
    const auto& f = state_->frame.elements[element].frame;
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = f.linear;
    out.translation() = f.shift;
    return out;
}

const Character::Stats& Character::stats() const { return state_->frame.stats; }

Character::Memory Character::memory(int element) const {
    const auto& e = state_->frame.elements[element];
    const std::size_t mapping = e.runtime->embedded ? e.runtime->embedded->mapping.bytes() : 0;
    return {e.blocks.responseBytes(), e.blocks.rest().bytes() + e.local.bytes() + e.positions.bytes() + e.normals.bytes() +
                                          e.runtime->stencils.size() * sizeof(NormalStencil) + mapping};
}

double Character::formatError(int element) const { return state_->frame.elements[element].blocks.error(); }

double Character::formatError() const {
    double worst = 0.0;
    for (std::size_t e = 0; e < state_->frame.elements.size(); ++e) worst = std::max(worst, formatError(static_cast<int>(e)));
    return worst;
}

double Character::lateralContraction(int joint) const { return state_->frame.joints[joint].contraction; }

double Character::Stats::effectMs(std::string_view effect) const {
    for (const auto& t : effects)
        if (t.effect == effect) return t.ms;
    return 0.0;
}

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
