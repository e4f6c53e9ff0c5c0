// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/body_loads_job.h"

#include <algorithm>
#include <cmath>

#include "core/character/frame.h"

namespace imomushi {

namespace {

constexpr Eigen::Index kGravityColumns = 3;
constexpr int kPressureColumn = 3;  // of ElementResponse::loads

void askFor(std::vector<int>& loads, std::initializer_list<int> columns) {
    loads.insert(loads.end(), columns);
    std::sort(loads.begin(), loads.end());
}

}  // namespace

void GravityEffect::ask(ElementTables& tables) const { askFor(tables.loads, {0, 1, 2}); }
void InflateEffect::ask(ElementTables& tables) const { askFor(tables.loads, {kPressureColumn}); }

Result<void> GravityEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    jobs.add<BodyLoadsJob>(frame).add(*this);
    return {};
}

Result<void> InflateEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    jobs.add<BodyLoadsJob>(frame).add(*this);
    return {};
}

BodyLoadsJob::BodyLoadsJob(const Frame& frame) : FrameJob({}, {Stage::Loads}) {
    for (const auto& e : frame.elements) {
        const auto& loads = e.runtime->input.tables.loads;
        auto& made = elements_.emplace_back();
        made.gravity = !loads.empty() && loads.front() == 0;
        made.inflated = !loads.empty() && loads.back() == kPressureColumn;
        made.acceleration.reset(e.runtime->middle);
    }
}

void BodyLoadsJob::run(Stage, Frame& frame) {
    if (inflate_ && inflate_->breath > 0.0)
        phase_.step(frame, inflate_->breathHertz);
    else
        phase_ = {};
    for (std::size_t e = 0; e < elements_.size(); ++e)
        if (elements_[e].gravity || elements_[e].inflated) load(frame, e);
}

void BodyLoadsJob::load(Frame& frame, std::size_t e) {
    auto& own = elements_[e];
    auto& out = frame.elements[e];
    auto& all = out.withLoads;
    const auto& given = frame.input.elements[e];
    const auto& runtime = *out.runtime;
    const Eigen::Index first = out.v.size(), count = all.size() - first;
    if (own.gravity) {
        const Vec3 place = out.frame(runtime.middle);
        if (frame.stopped) own.acceleration.reset(place);
        own.acceleration.step(frame.seconds, place);
        const double softness = given.density / (gravity_->shearModulus * given.stiffness);
        all.segment<kGravityColumns>(first) =
            softness * (out.frame.linear.transpose() * (gravity_->acceleration - gravity_->inertia * own.acceleration.value()));
    }
    if (own.inflated) all[first + count - 1] = (inflate_->pressure + inflate_->breath * std::sin(phase_.radians())) / given.stiffness;
    const double wanted = all.tail(count).cwiseAbs().dot(runtime.columnSize.tail(count)), most = kMaxLoaded * runtime.size;
    out.jointForces.setZero();
    if (wanted <= 0.0) return;
    all.tail(count) *= most * std::tanh(wanted / most) / wanted;
    if (wanted > most) frame.warn(FrameWarning::LoadsBounded);
    if (!frame.smooth) return;
    const auto& forces = given.response->loadForces;
    if (own.gravity) out.jointForces.noalias() += forces.leftCols<kGravityColumns>() * all.segment<kGravityColumns>(first);
    if (own.inflated) out.jointForces.noalias() += forces.col(kPressureColumn) * all[first + count - 1];
}

void BodyLoadsJob::tune(const EffectSettings& settings) {
    if (const auto* gravity = settingsAs<GravityEffect>(settings); gravity && gravity_) gravity_ = *gravity;
    if (const auto* inflate = settingsAs<InflateEffect>(settings); inflate && inflate_) inflate_ = *inflate;
}

bool BodyLoadsJob::resting(const Frame&) const {
    const bool breathes = inflate_ && inflate_->breath > 0.0 && inflate_->breathHertz > 0.0;
    return std::none_of(elements_.begin(), elements_.end(),
                        [breathes](const Element& e) { return (breathes && e.inflated) || (e.gravity && !e.acceleration.resting()); });
}

// Besides their own time, loads have a share of the product by their columns.
void BodyLoadsJob::report(Frame& frame, double ms) const {
    double columns = 0.0, gravity = 0.0, inflated = 0.0;
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        const auto& e = frame.elements[i];
        if (e.work != VertexWork::Evaluate && e.work != VertexWork::EvaluateAndKeep) continue;
        const auto vertices = static_cast<double>(e.runtime->free.size());
        columns += vertices * static_cast<double>(e.weights().size());
        if (elements_[i].gravity) gravity += static_cast<double>(kGravityColumns) * vertices;
        if (elements_[i].inflated) inflated += vertices;
    }
    const double perColumn = columns > 0.0 ? frame.stats.productMs / columns : 0.0;
    const double own = (ms + frame.loadMsOfWarp) * (gravity_ && inflate_ ? 0.5 : 1.0);
    if (gravity_) frame.setTime(GravityEffect::kName, own + perColumn * gravity);
    if (inflate_) frame.setTime(InflateEffect::kName, own + perColumn * inflated);
}

}  // namespace imomushi
