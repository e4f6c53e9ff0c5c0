// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/ground_job.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/character/frame.h"
#include "core/effects/body_loads_job.h"
#include "core/effects/ground_vertices.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

// Sizes of an element: the ground begins to carry flesh that is as near.
constexpr double kNear = 0.1;
// The same: what is as low lies on the ground.
constexpr double kTouches = 0.01;
// Softer landings are none.
constexpr double kSoft = 0.05;

/// What moves a place of an element at rest: the nearer end of its nearest bone. Where that end is no joint of an element that has several (the end of a spine between two hips), no flesh
/// goes where it goes: then it is the nearest joint.
FleshPoint moverOf(const CharacterInput& input, const ElementState& element, std::size_t index, const Vec3& rest) {
    const auto pointOf = [&](int joint) { return input.joints[static_cast<std::size_t>(joint)].point; };
    const auto points = std::count_if(element.jointOf.begin(), element.jointOf.end(), [&](int j) { return pointOf(j) >= 0; });
    const auto moves = [&](int point) { return points < 2 || std::any_of(element.jointOf.begin(), element.jointOf.end(), [&](int j) { return pointOf(j) == point; }); };
    FleshPoint out;
    double nearest = std::numeric_limits<double>::infinity();
    const Skeleton& skeleton = input.skeleton;
    for (const int b : input.elements[index].bones) {
        const auto& bone = skeleton.bones[static_cast<std::size_t>(b)];
        const Vec3 &start = skeleton.points[static_cast<std::size_t>(bone.start)], along = skeleton.points[static_cast<std::size_t>(bone.end)] - start;
        const double part = along.dot(rest - start) / std::max(along.squaredNorm(), std::numeric_limits<double>::min());
        const double square = (start + std::clamp(part, 0.0, 1.0) * along - rest).squaredNorm();
        if (square >= nearest) continue;
        nearest = square;
        out = {part < 0.5 ? bone.start : bone.end, b, std::max({0.0, -part, part - 1.0})};
    }
    if (out.point >= 0 && moves(out.point)) return out;
    nearest = std::numeric_limits<double>::infinity();
    for (const int j : element.jointOf) {
        if (pointOf(j) < 0) continue;
        const double square = (skeleton.points[static_cast<std::size_t>(pointOf(j))] - rest).squaredNorm();
        if (square < nearest) nearest = square, out = {pointOf(j)};
    }
    return out;
}

}  // namespace

Result<void> GroundEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    jobs.add<GroundJob>(frame, *this);
    return {};
}

GroundJob::GroundJob(const Frame& frame, const GroundEffect& settings) : EffectJob(settings, {{Stage::Placed, FrameData::JointMaps | FrameData::Elements | FrameData::Parameters | FrameData::Loads | FrameData::FaceOffsets | FrameData::Local | FrameData::Forces | FrameData::Positions, FrameData::Ground}}) {
    std::vector<std::pair<std::size_t, std::size_t>> placeOf;  // element and its chosen, in the order of flesh_ before it is sorted
    std::vector<FleshPoint> flesh;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        const auto& of = frame.elements[e];
        const auto& runtime = *of.runtime;
        const auto& given = runtime.input;
        const Points& body = given.mesh->body.vertices;
        const Bounds box = boundsOf(body);
        low = low.cwiseMin(box.low);
        high = high.cwiseMax(box.high);
        std::vector<char> hidden(runtime.vertices, 0);
        for (const auto& h : runtime.hidden) hidden[static_cast<std::size_t>(h.vertex)] = 1;
        // Around each joint point by itself.
        std::vector<int> groups, groupOf(runtime.vertices, -1);
        for (std::size_t v = 0; v < runtime.vertices; ++v) {
            if (hidden[v]) continue;
            const int point = moverOf(frame.input, of, e, body.row(static_cast<Eigen::Index>(v)).transpose()).point;
            if (point < 0) continue;
            const auto known = std::find(groups.begin(), groups.end(), point);
            groupOf[v] = static_cast<int>(known - groups.begin());
            if (known == groups.end()) groups.push_back(point);
        }
        if (groups.empty()) continue;
        std::vector<int> heldOf(runtime.vertices, -1);
        for (std::size_t i = 0; i < of.held.size(); ++i) heldOf[static_cast<std::size_t>(of.held[i].vertex)] = static_cast<int>(i);
        Element made;
        made.index = e;
        Eigen::Index rows = 0;
        for (const auto vertex : lowestVertices(runtime, groupOf, kPerPoint)) {
            Chosen chosen{vertex, heldOf[static_cast<std::size_t>(vertex)], rows, body.row(vertex).transpose(), flesh.size()};
            if (chosen.held < 0) ++rows;
            flesh.push_back(moverOf(frame.input, of, e, chosen.rest));
            placeOf.emplace_back(elements_.size(), made.chosen.size());
            made.chosen.push_back(chosen);
        }
        made.weights = Eigen::VectorXf::Zero(of.weights().size());
        made.moved = Eigen::VectorXf::Zero(3 * rows);
        made.rows = Eigen::MatrixXf::Zero(3 * rows, of.weights().size());
        for (const Chosen& c : made.chosen) {
            if (c.held >= 0 || !given.response) continue;
            const Eigen::Index row = 3 * (std::lower_bound(runtime.free.begin(), runtime.free.end(), c.vertex) - runtime.free.begin());
            made.rows.block(3 * c.row, 0, 3, of.v.size()) = given.response->response.middleRows<3>(row).cast<float>();
            for (std::size_t l = 0; l < given.tables.loads.size(); ++l)
                made.rows.block<3, 1>(3 * c.row, of.v.size() + static_cast<Eigen::Index>(l)) = given.response->loads.block<3, 1>(row, given.tables.loads[l]).cast<float>();
        }
        elements_.push_back(std::move(made));
    }
    std::vector<std::size_t> order(flesh.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return std::tie(flesh[a].point, flesh[a].bone) < std::tie(flesh[b].point, flesh[b].bone); });
    for (const std::size_t i : order) {
        elements_[placeOf[i].first].chosen[placeOf[i].second].flesh = flesh_.size();
        flesh_.push_back(flesh[i]);
    }
    for (const Element& e : elements_) depths_.push_back({flesh_[e.chosen.front().flesh].point, 0.0});
    at_.assign(flesh_.size(), Vec3::Zero());
    size_ = frame.elements.empty() ? 0.0 : (high - low).norm();
}

bool GroundJob::take(const GroundEffect&) {
    measured_ = false;  // what is far above one plane may be near another
    return true;
}

void GroundJob::run(Stage, Frame& frame) {
    if (frame.replaying) {
        measured_ = false;
        landing_ = 0.0;
        return;
    }
    if (!frame.again) {
        seconds_ = measured_ ? frame.seconds : 0.0;
        for (Element& e : elements_) e.before = e.height;
    }
    frame.up = settings().plane().normal();
    for (std::size_t i = 0; i < elements_.size(); ++i)
        if (!measured_ || frame.elements[elements_[i].index].moved) measure(elements_[i], depths_[i].depth, frame);
    measured_ = true;
    findLanding(frame);
    for (std::size_t i = 0; i < flesh_.size(); ++i) flesh_[i].offset = at_[i] - frame.pose.points[static_cast<std::size_t>(flesh_[i].point)];
}

void GroundJob::findLanding(const Frame& frame) {
    landing_ = 0.0;
    if (!(seconds_ > 0.0) || !(size_ > 0.0)) return;
    double fastest = 0.0;  // m/s
    for (const Element& e : elements_)
        if (const double touches = kTouches * frame.elements[e.index].runtime->size; e.before.lowest > touches && e.height.lowest <= touches) fastest = std::max(fastest, (e.before.middle - e.height.middle) / seconds_);
    const double part = std::min(1.0, fastest / std::sqrt(2.0 * kEarthGravity * 0.5 * size_));
    if (part >= kSoft) landing_ = part;
}

void GroundJob::measure(Element& element, double& depth, Frame& frame) {
    ElementState& of = frame.elements[element.index];
    const ElementRuntime& runtime = *of.runtime;
    const bool warped = runtime.warp && of.warpPart > 0.0;
    // Far above, all of it is. How far a warped one reaches nobody knows before.
    of.aloft = 1.0;
    const Plane plane = settings().plane();
    element.height.middle = plane.height(of.frame(runtime.middle));
    if (!warped && element.height.middle > (0.5 + kNear) * runtime.size + of.weights().cwiseAbs().dot(runtime.columnSize)) {
        for (const Chosen& c : element.chosen) at_[c.flesh] = of.frame(c.rest);
        depth = 0.0;
        element.height.lowest = kNear * runtime.size;
        return;
    }
    if (!warped) {
        element.weights = of.weights().cast<float>();
        element.moved.noalias() = element.rows * element.weights;
    }
    double lowest = std::numeric_limits<double>::infinity();
    for (const Chosen& c : element.chosen) {
        Vec3& at = at_[c.flesh];
        if (c.held >= 0)
            at = frame.heldAt(of, static_cast<std::size_t>(c.held));
        else if (warped)
            at = of.dented ? of.frame(of.localAt(c.vertex, of.local.data())) : Eigen::Map<const Eigen::Vector3f>(of.positions.data() + 3 * static_cast<std::size_t>(c.vertex)).cast<double>();
        else
            at = of.frame(c.rest + element.moved.segment<3>(3 * c.row).cast<double>());
        lowest = std::min(lowest, plane.height(at));
    }
    of.aloft = std::clamp(lowest / (kNear * runtime.size), 0.0, 1.0);
    if (warped || of.dented) {
        // Heights over the middle, which are as exact as positions.
        const Eigen::Vector3f up = plane.normal().cast<float>(), middle = of.frame(runtime.middle).cast<float>();
        const Eigen::Map<const Eigen::Matrix3Xf> positions(of.positions.data(), 3, static_cast<Eigen::Index>(runtime.vertices));
        lowest = element.height.middle + static_cast<double>(up.transpose().lazyProduct(positions.colwise() - middle).minCoeff());
    }
    depth = -lowest;
    element.height.lowest = lowest;
}

std::size_t GroundJob::bytes() const {
    std::size_t sum = 0;
    for (const Element& e : elements_) sum += static_cast<std::size_t>(e.rows.size()) * sizeof(float) + e.chosen.size() * sizeof(Chosen);
    return sum;
}

}  // namespace imomushi
