// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/body_loads_job.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/union_find.h"
#include "core/character/frame.h"

namespace imomushi {

namespace {

constexpr Eigen::Index kForceColumns = 3;  // the first of ElementResponse::loads
constexpr int kPressureColumn = 3;  // of ElementResponse::loads
constexpr double kLeastHeight = 0.1;       // a height below that part of the diagonal does not count as one

}  // namespace

std::vector<double> modulusForSag(const CharacterInput& input, double sag) {
    UnionFind connected(input.elements.size());
    for (const auto& joint : input.joints)
        for (const auto& face : joint.faces) connected.unite(joint.faces.front().element, face.element);
    struct Whole {
        Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
        double softest = 0.0;  // Pa m: how far it sags where it sags most, times the shear modulus
    };
    std::vector<Whole> wholes(input.elements.size());
    const auto wholeOf = [&](std::size_t e) -> Whole& { return wholes[static_cast<std::size_t>(connected.find(static_cast<std::int32_t>(e)))]; };
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        const auto& element = input.elements[e];
        Whole& whole = wholeOf(e);
        whole.low = whole.low.cwiseMin(element.mesh->body.vertices.colwise().minCoeff().transpose());
        whole.high = whole.high.cwiseMax(element.mesh->body.vertices.colwise().maxCoeff().transpose());
        if (!element.response || element.response->loads.cols() < kForceColumns) continue;
        const auto down = element.response->loads.col(1);
        for (Eigen::Index i = 0; i < down.size(); i += 3)
            whole.softest = std::max(whole.softest, kEarthGravity * CharacterInput::Element::kStandardDensity * down.segment<3>(i).norm());
    }
    std::vector<double> moduli;
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        const Whole& whole = wholeOf(e);
        const Vec3 size = whole.high - whole.low;
        moduli.push_back(whole.softest > 0.0 ? whole.softest / (sag * std::max(size.y(), kLeastHeight * size.norm())) : 0.0);
    }
    return moduli;
}

void GravityEffect::ask(ElementTables& tables) const { askForLoads(tables, {0, 1, 2}); }
void InflateEffect::ask(ElementTables& tables) const { askForLoads(tables, {kPressureColumn}); }

Result<void> GravityEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    jobs.add<BodyLoadsJob>(frame).add(*this);
    return {};
}

Result<void> InflateEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    jobs.add<BodyLoadsJob>(frame).add(*this);
    return {};
}

BodyLoadsJob::BodyLoadsJob(const Frame& frame) : FrameJob({}, {{Stage::Loads, FrameData::Elements | FrameData::Ground, FrameData::Loads}}) {
    const std::vector<double> moduli = modulusForSag(frame.input, 1.0);
    for (const auto& e : frame.elements) {
        const auto& loads = e.runtime->input.tables.loads;
        auto& made = elements_.emplace_back();
        made.forces = !loads.empty() && loads.front() == 0;
        made.pressure = !loads.empty() && loads.back() == kPressureColumn;
        made.modulus = moduli[elements_.size() - 1];
        made.acceleration.reset(e.runtime->middle);
    }
}

void BodyLoadsJob::add(const GravityEffect& gravity) {
    gravity_ = gravity;
    for (std::size_t e = 0; e < elements_.size(); ++e) elements_[e].gravity = elements_[e].forces && gravity.on(e);
}

void BodyLoadsJob::add(const InflateEffect& inflate) {
    inflate_ = inflate;
    for (std::size_t e = 0; e < elements_.size(); ++e) elements_[e].inflated = elements_[e].pressure && inflate.on(e);
}

void BodyLoadsJob::run(Stage, Frame& frame) {
    if (frame.shifted) return;  // what the ground carried before is what is shifted
    if (inflate_ && inflate_->breath > 0.0)
        phase_.step(frame, inflate_->breathHertz);
    else
        phase_ = {};
    for (std::size_t e = 0; e < elements_.size(); ++e)
        if (elements_[e].forces || elements_[e].pressure) load(frame, e);
}

void BodyLoadsJob::load(Frame& frame, std::size_t e) {
    auto& own = elements_[e];
    auto& out = frame.elements[e];
    auto& all = out.withLoads;
    const auto& given = frame.input.elements[e];
    const auto& runtime = *out.runtime;
    const Eigen::Index first = out.v.size(), count = all.size() - first;
    all.tail(count).setZero();
    if (own.gravity) {
        const Vec3 place = out.frame(runtime.middle);
        if (frame.stopped) own.acceleration.reset(place);
        own.acceleration.step(frame.seconds, place);
        const double modulus = gravity_->shearModulus > 0.0 ? gravity_->shearModulus : own.modulus / gravity_->sag;
        const double softness = modulus > 0.0 ? given.density / (modulus * given.stiffness) : 0.0;
        // Flesh that lies on the ground does not lag into it, nor off it: the ground carries it. Bones that the ground moves by their flesh would move it on and on.
        Vec3 lag = gravity_->inertia * own.acceleration.value();
        lag -= (1.0 - out.aloft) * frame.up.dot(lag) * frame.up;
        all.segment<kForceColumns>(first) = softness * (out.frame.linear.transpose() * (gravity_->acceleration - lag));
    }
    if (own.inflated) all[first + count - 1] = (inflate_->pressure + inflate_->breath * std::sin(phase_.radians())) / given.stiffness;
    const double wanted = all.tail(count).cwiseAbs().dot(runtime.columnSize.tail(count)), most = kMaxLoaded * runtime.size;
    out.jointForces.setZero();
    if (wanted > 0.0) all.tail(count) *= most * std::tanh(wanted / most) / wanted;
    if (wanted > most) frame.warn(FrameWarning::LoadsBounded);
    if (out.freeEnd) all.segment<kForceColumns>(first) += stretchingLoad(*out.freeEnd, frame.pose, out.frame.linear.transpose());
    if (!frame.smooth) return;
    const auto& forces = given.response->loadForces;
    if (own.forces) out.jointForces.noalias() += forces.leftCols<kForceColumns>() * all.segment<kForceColumns>(first);
    if (own.pressure) out.jointForces.noalias() += forces.col(kPressureColumn) * all[first + count - 1];
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
    double columns = 0.0, gravity = 0.0, inflated = 0.0, stretched = 0.0;
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        const auto& e = frame.elements[i];
        if (e.work != VertexWork::Evaluate && e.work != VertexWork::EvaluateAndKeep) continue;
        const auto vertices = static_cast<double>(e.runtime->free.size());
        columns += vertices * static_cast<double>(e.weights().size());
        if (elements_[i].forces) (elements_[i].gravity ? gravity : stretched) += static_cast<double>(kForceColumns) * vertices;
        if (elements_[i].inflated) inflated += vertices;
    }
    const double perColumn = columns > 0.0 ? frame.stats.productMs / columns : 0.0;
    const double own = (ms + frame.loadMsOfWarp) / (gravity_.has_value() + inflate_.has_value() + stretch_.has_value());
    if (gravity_) frame.setTime(GravityEffect::kName, own + perColumn * gravity);
    if (inflate_) frame.setTime(InflateEffect::kName, own + perColumn * inflated);
    if (stretch_) frame.setTime(EndStretchEffect::kName, own + perColumn * stretched);
}

}  // namespace imomushi
