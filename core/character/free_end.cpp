// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/free_end.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace imomushi {

namespace {

constexpr double kAround = 0.15;     // of the length of the bone: flesh farther from the end than its nearest by this is not around it
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

std::optional<FreeEnd> freeEndOf(const CharacterInput& input, std::size_t element) {
    const auto& given = input.elements[element];
    if (static_cast<int>(given.faces.size()) == given.handles || !given.response || given.response->loads.size() == 0) return std::nullopt;
    const auto& bones = input.skeleton.bones;
    const auto isFree = [&](int point) {
        return std::count_if(bones.begin(), bones.end(), [&](const auto& b) { return b.start == point || b.end == point; }) == 1 &&
               std::none_of(input.joints.begin(), input.joints.end(), [&](const auto& j) { return j.point == point; });
    };
    std::optional<FreeEnd> found;
    for (const int b : given.bones) {
        const auto& bone = bones[static_cast<std::size_t>(b)];
        for (const auto& [end, near] : {std::pair(bone.end, bone.start), std::pair(bone.start, bone.end)}) {
            if (!isFree(end)) continue;
            if (found) return std::nullopt;
            found.emplace();
            found->end = end;
            found->near = near;
            found->length = bone.length;
        }
    }
    if (!found) return std::nullopt;
    const Vec3 end = input.skeleton.points[static_cast<std::size_t>(found->end)], along = end - input.skeleton.points[static_cast<std::size_t>(found->near)];
    const Eigen::FullPivLU<Eigen::Matrix3d> moves(movesAround(*given.response, given.mesh->body.vertices, end, kAround * found->length));
    if (!moves.isInvertible()) return std::nullopt;
    found->perMetre = moves.inverse();
    const Eigen::VectorXd way = given.response->loads.leftCols<3>() * (found->perMetre * (along / found->length));
    if (!way.allFinite()) return std::nullopt;
    double largest = 0.0;
    for (Eigen::Index i = 0; i < way.size(); i += 3) largest = std::max(largest, way.segment<3>(i).norm());
    return largest <= kMostBeside ? found : std::nullopt;
}

}  // namespace imomushi
