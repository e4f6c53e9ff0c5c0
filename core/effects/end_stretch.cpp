// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/end_stretch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/character/frame.h"
#include "core/character/lateral_contraction.h"
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
    const auto& tables = frame.elements[element].runtime->input.tables;
    if (!tables.freeEnd || tables.loads.empty() || tables.loads.front() != 0) return std::nullopt;
    const auto& skeleton = frame.input.skeleton;
    const auto& bone = skeleton.bones[static_cast<std::size_t>(given.bones.front())];
    EndStretch out;
    Constants& is = out.is_;
    is.joint = frame.input.joints[static_cast<std::size_t>(frame.elements[element].anchorJoint)].point;
    is.end = bone.start == is.joint ? bone.end : bone.start;
    const Vec3 end = skeleton.points[static_cast<std::size_t>(is.end)], along = end - skeleton.points[static_cast<std::size_t>(is.joint)];
    is.length = along.norm();
    const Eigen::FullPivLU<Eigen::Matrix3d> moves(movesAround(*given.response, given.mesh->body.vertices, end, kAround * is.length));
    if (!moves.isInvertible()) return std::nullopt;
    is.perMetre = moves.solve(along / is.length);
    if (!is.perMetre.allFinite()) return std::nullopt;
    const Eigen::VectorXd way = given.response->loads.leftCols<3>() * is.perMetre;
    double largest = 0.0;
    for (Eigen::Index i = 0; i < way.size(); i += 3) largest = std::max(largest, way.segment<3>(i).norm());
    return largest <= kMostBeside ? std::optional(out) : std::nullopt;
}

Vec3 EndStretch::load(const Pose& pose) const {
    const double longer = (pose.points[static_cast<std::size_t>(is_.end)] - pose.points[static_cast<std::size_t>(is_.joint)]).norm() - is_.length;
    const double room = is_.length * (longer < 0.0 ? kMostShorter : kMostLonger);
    return room * std::tanh(longer / room) * is_.perMetre;
}

}  // namespace imomushi
