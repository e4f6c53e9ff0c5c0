// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/contact_job.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/character/frame.h"
#include "core/effects/meeting_job.h"

namespace imomushi {

namespace {

// The bend warp moves no vertex farther out of the ball around a body than this part of its size.
constexpr double kBent = 0.25;

bool isBent(const ElementState& of) { return of.runtime->warp && of.warpPart > 0.0; }

}  // namespace

void ContactEffect::ask(ElementTables& tables) const {
    tables.touch = tables.contact = true;
    tables.patches = std::max(tables.patches, static_cast<int>(std::lround(patches)));
}

Result<void> ContactEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    const bool any = std::any_of(frame.elements.begin(), frame.elements.end(), [](const ElementState& e) { return e.runtime->contact != nullptr; });
    if (any) jobs.add<ContactJob>(frame, *this);
    if (automatic && met) jobs.add<MeetingJob>(frame, any, met);
    return {};
}

/// Body vertices as the pose alone leaves them.
class ContactJob::Posed final : public FleshContact::Posed {
public:
    Posed(const Frame& frame, const std::vector<Body>& bodies) : frame_(frame), bodies_(bodies) {}
    [[nodiscard]] Vec3 at(std::size_t body, std::int32_t vertex) const override {
        const ElementState& of = frame_.elements[bodies_[body].element];
        const std::int32_t held = bodies_[body].held[static_cast<std::size_t>(vertex)];
        return held < 0 ? of.frame(of.localAt(vertex, of.local.data())) : frame_.heldAt(of, static_cast<std::size_t>(held));
    }
    [[nodiscard]] const Eigen::Matrix3d& axes(std::size_t body) const override { return frame_.elements[bodies_[body].element].frame.linear; }

private:
    const Frame& frame_;
    const std::vector<Body>& bodies_;
};

ContactJob::ContactJob(Frame& frame, const ContactEffect& settings)
    : EffectJob(settings, {{Stage::Weights, FrameData::Elements | FrameData::Parameters | FrameData::Loads, FrameData::Wants | FrameData::Forces},
                           {Stage::Dents, FrameData::JointMaps | FrameData::Elements | FrameData::Parameters | FrameData::Loads | FrameData::FaceOffsets | FrameData::Local, FrameData::Forces}}),
      bodies_(bodiesOf(frame, settings)),
      contact_(surfacesOf(frame, bodies_)),
      found_(bodies_.size()),
      moved_(bodies_.size()) {
    for (const Body& body : bodies_) {
        const auto& runtime = *frame.elements[body.element].runtime;
        const Vec3 far = Vec3::Constant(0.5 * runtime.size);
        boxes_.push_back({runtime.middle - far, runtime.middle + far});
    }
    tree_ = BoxTree(boxes_);
    near_.pairs.reserve(bodies_.size() * (bodies_.size() + 1) / 2);
    near_.grounded.reserve(bodies_.size());
}

std::vector<ContactJob::Body> ContactJob::bodiesOf(const Frame& frame, const ContactEffect& settings) {
    std::vector<Body> out;
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        const auto& of = frame.elements[e];
        if (!of.runtime->contact || !settings.on(e)) continue;
        const auto& given = of.runtime->input;
        const auto& patches = of.runtime->contact->patches();
        Body body;
        body.element = e;
        body.held.assign(of.runtime->vertices, -1);
        for (std::size_t i = 0; i < of.held.size(); ++i) body.held[static_cast<std::size_t>(of.held[i].vertex)] = static_cast<std::int32_t>(i);
        body.rest = body.now = Eigen::Matrix3Xd::Zero(3, patches.count());
        body.middles = Eigen::MatrixXf::Zero(3 * patches.count(), of.weights().size());
        body.weights = Eigen::VectorXf::Zero(of.weights().size());
        body.moved = Eigen::VectorXf::Zero(3 * patches.count());
        for (Eigen::Index p = 0; p < patches.count(); ++p) {
            const std::int32_t vertex = patches.centre[static_cast<std::size_t>(p)];
            body.rest.col(p) = of.runtime->contact->surface().vertex(vertex);
            const std::int32_t row = of.runtime->contact->surface().row(vertex);
            if (row < 0) continue;
            body.middles.block(3 * p, 0, 3, of.v.size()) = given.response->response.middleRows<3>(row).cast<float>();
            for (std::size_t l = 0; l < given.tables.loads.size(); ++l)
                body.middles.block<3, 1>(3 * p, of.v.size() + static_cast<Eigen::Index>(l)) = given.response->loads.block<3, 1>(row, given.tables.loads[l]).cast<float>();
        }
        out.push_back(std::move(body));
    }
    return out;
}

std::vector<FleshContact::Body> ContactJob::surfacesOf(const Frame& frame, const std::vector<Body>& bodies) {
    std::vector<FleshContact::Body> out;
    for (const Body& body : bodies) out.push_back({frame.elements[body.element].runtime->contact, frame.input.elements[body.element].stiffness});
    return out;
}

void ContactJob::run(Stage stage, Frame& frame) {
    if (frame.replaying) {
        known_ = false;  // elements go where contact does not follow them
        return;
    }
    if (frame.shifted) {
        known_ = false;  // all have moved, for who meets the ground
        for (std::size_t b = 0; stage == Stage::Weights && b < bodies_.size(); ++b) frame.elements[bodies_[b].element].patchForces += contact_.patchForces(b);
        return;
    }
    if (stage == Stage::Weights) return begin(frame);
    presses_ = !near_.none() || !contact_.idle();
    if (!presses_) return;
    contact_.finish(Posed(frame, bodies_), frame.stopped || (frame.seconds <= 0.0 && !frame.again));
    for (std::size_t b = 0; b < bodies_.size(); ++b)
        if (contact_.awake(b)) frame.elements[bodies_[b].element].patchForces += contact_.patchForces(b);
    if (contact_.bounded()) frame.warn(FrameWarning::ContactsBounded);
}

void ContactJob::begin(Frame& frame) {
    if (frame.stopped) contact_.reset();
    const FleshContact::Settings numbers{.friction = settings().friction, .ground = settings().ground.value_or(Plane()), .groundFriction = settings().groundFriction};
    const bool all = !known_ || frame.stopped || grounded_ != settings().ground.has_value() || !(numbers == numbers_);
    bool any = false;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        moved_[b] = all || frame.elements[bodies_[b].element].moved;
        any = any || moved_[b];
    }
    known_ = true;
    grounded_ = settings().ground.has_value();
    numbers_ = numbers;
    if (any) findNear(frame);
    contact_.begin(near_, numbers, moved_);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        auto& of = frame.elements[bodies_[b].element];
        if (contact_.awake(b)) of.wantsLocal = true;
        if (contact_.asleep(b)) of.patchForces += contact_.patchForces(b);
    }
}

void ContactJob::findNear(Frame& frame) {
    near_.pairs.clear();
    near_.grounded.clear();
    std::fill(found_.begin(), found_.end(), 0);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        Body& body = bodies_[b];
        const auto& of = frame.elements[body.element];
        body.bound = of.weights().cwiseAbs().dot(of.runtime->columnSize);
        const Vec3 middle = of.frame(of.runtime->middle), far = Vec3::Constant(0.5 * of.runtime->size + beyond(frame, b));
        boxes_[b] = {middle - far, middle + far};
        if (mayMeet(frame, b, b)) near_.pairs.emplace_back(b, b);
        if (settings().ground && mayMeetGround(frame, b)) near_.grounded.push_back(b);
    }
    tree_.follow(boxes_);
    tree_.near(0.0, [&](std::int32_t i, std::int32_t k) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(k);
        if (mayMeet(frame, a, b)) near_.pairs.emplace_back(a, b);
    });
    std::sort(near_.pairs.begin(), near_.pairs.end());
}

double ContactJob::beyond(const Frame& frame, std::size_t body) const {
    const auto& of = frame.elements[bodies_[body].element];
    return isBent(of) ? kBent * of.runtime->size : bodies_[body].bound;
}

bool ContactJob::mayMeetGround(const Frame& frame, std::size_t body) {
    const auto& of = frame.elements[bodies_[body].element];
    if (settings().ground->height(of.frame(of.runtime->middle)) > 0.5 * of.runtime->size + beyond(frame, body)) return false;
    return isBent(of) || contact_.isNearGround(body, middlesOf(frame, body), *settings().ground);
}

bool ContactJob::mayMeet(const Frame& frame, std::size_t a, std::size_t b) {
    const auto &A = frame.elements[bodies_[a].element], &B = frame.elements[bodies_[b].element];
    const bool bent = isBent(A) || isBent(B);
    const double clearance = contact_.restClearance(a, b);
    if (a == b && std::isinf(clearance)) return false;
    // Nothing has turned or moved against each other as far as it takes to meet. The bend warp moves vertices about as far as the product would.
    const double flesh = bodies_[a].bound + bodies_[b].bound;
    double moved = flesh, turned = flesh / std::min(A.runtime->size, B.runtime->size);
    if (a != b) {
        const Eigen::Matrix3d linear = A.frame.linear.transpose() * B.frame.linear - Eigen::Matrix3d::Identity();
        const Vec3 shift = A.frame.linear.transpose() * (B.frame.shift - A.frame.shift);
        turned += std::sqrt(0.5) * linear.norm();
        moved += (linear * B.runtime->middle + shift).norm() + 0.5 * B.runtime->size * std::sqrt(0.5) * linear.norm();
    }
    if (turned < FleshContact::kMostTurn && moved < 0.5 * clearance) return false;
    if (a != b) {
        const double reach = 0.5 * (A.runtime->size + B.runtime->size) + beyond(frame, a) + beyond(frame, b);
        if ((A.frame(A.runtime->middle) - B.frame(B.runtime->middle)).squaredNorm() > reach * reach) return false;
    }
    if (bent) return true;
    middlesOf(frame, a);
    middlesOf(frame, b);
    return contact_.areNear(a, b);
}

const Eigen::Matrix3Xd& ContactJob::middlesOf(const Frame& frame, std::size_t index) {
    Body& body = bodies_[index];
    if (found_[index]) return body.now;
    found_[index] = 1;
    const auto& of = frame.elements[body.element];
    body.weights = of.weights().cast<float>();
    body.moved.noalias() = body.middles * body.weights;
    for (Eigen::Index p = 0; p < body.rest.cols(); ++p) body.now.col(p) = of.frame(body.rest.col(p) + body.moved.segment<3>(3 * p).cast<double>());
    contact_.place(index, body.now);
    return body.now;
}

void ContactJob::report(Frame& frame, double ms) const { frame.setTime(ContactEffect::kName, ms + (presses_ ? std::exchange(frame.dentMs, 0.0) : 0.0)); }

}  // namespace imomushi
