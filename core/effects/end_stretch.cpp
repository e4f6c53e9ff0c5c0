// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/end_stretch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/character/frame.h"
#include "core/effects/body_loads_job.h"

namespace imomushi {

namespace {

constexpr double kAround = 0.15;   // of the length of the bone: flesh farther from the end than its nearest by this is not around it
constexpr double kMostBeside = 2.0;  // of the way of the end: where other flesh moves farther, the force bends more than it stretches

/// Mean displacement around a place at rest per unit of each of the first three loads, m^2; weights fall from the nearest flesh on.
Eigen::Matrix3d movesAround(const ElementResponse& response, const Points& body, const Vec3& place, double reach) {
    const auto distance = [&](std::int32_t v) { return (Vec3(body.row(v).transpose()) - place).norm(); };
    double nearest = HUGE_VAL;
    for (const auto v : response.freeVertices) nearest = std::min(nearest, distance(v));
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    double weights = 0.0;
    for (std::size_t i = 0; i < response.freeVertices.size(); ++i) {
        const double w = 1.0 - (distance(response.freeVertices[i]) - nearest) / reach;
        if (w <= 0.0) continue;
        sum += w * w * response.loads.block<3, 3>(static_cast<Eigen::Index>(3 * i), 0);
        weights += w * w;
    }
    return weights > 0.0 ? Eigen::Matrix3d(sum / weights) : sum;
}

}  // namespace

void EndStretchEffect::ask(ElementTables& tables) const {
    if (tables.freeEnd) askForLoads(tables, {0, 1, 2});
}

Result<void> EndStretchEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    jobs.add<BodyLoadsJob>(frame).add(*this, frame);
    return {};
}

std::optional<EndStretch> EndStretch::of(const Frame& frame, std::size_t element) {
    const auto& given = frame.input.elements[element];
    const auto& loads = frame.elements[element].runtime->input.tables.loads;
    const auto at = freeEndOf(frame.input, element);
    if (!at || loads.empty() || loads.front() != 0) return std::nullopt;
    const auto& points = frame.input.skeleton.points;
    const Vec3 end = points[static_cast<std::size_t>(at->end)], along = end - points[static_cast<std::size_t>(at->near)];
    EndStretch out;
    out.is_.at = *at;
    out.is_.length = along.norm();
    const Eigen::FullPivLU<Eigen::Matrix3d> moves(movesAround(*given.response, given.mesh->body.vertices, end, kAround * out.is_.length));
    if (!moves.isInvertible()) return std::nullopt;
    out.is_.perMetre = moves.inverse();
    const Eigen::VectorXd way = given.response->loads.leftCols<3>() * (out.is_.perMetre * (along / out.is_.length));
    if (!way.allFinite()) return std::nullopt;
    double largest = 0.0;
    for (Eigen::Index i = 0; i < way.size(); i += 3) largest = std::max(largest, way.segment<3>(i).norm());
    return largest <= kMostBeside ? std::optional(out) : std::nullopt;
}

Vec3 EndStretch::load(const Pose& pose, const Eigen::Matrix3d& toElement) const {
    const Vec3 along = pose.points[static_cast<std::size_t>(is_.at.end)] - pose.points[static_cast<std::size_t>(is_.at.near)];
    const double length = along.norm(), longer = length - is_.length;
    if (length <= 0.0) return Vec3::Zero();
    const double room = is_.length * (longer < 0.0 ? kMostShorter : kMostLonger);
    return room * std::tanh(longer / room) / length * (is_.perMetre * (toElement * along));
}

}  // namespace imomushi
