// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/key_reduction.h"

#include <Eigen/Geometry>

namespace imomushi {

std::vector<std::size_t> neededKeys(const ElementMorphs& morphs, const ElementMorphs::Track& track, double tolerance) {
    const std::size_t count = track.times.size();
    std::vector<char> keep(count, 0);
    keep.front() = keep.back() = 1;
    const double radius = morphs.rest.rows() > 0 ? morphs.rest.rowwise().norm().maxCoeff() : 0.0;
    const auto miss = [&](std::size_t from, std::size_t to, std::size_t at) {
        const auto a = static_cast<Eigen::Index>(from), b = static_cast<Eigen::Index>(to), i = static_cast<Eigen::Index>(at);
        const double part = (track.times[at] - track.times[from]) / (track.times[to] - track.times[from]);
        const Eigen::Quaterniond p(Eigen::Vector4d(track.rotations.col(a))), q(Eigen::Vector4d(track.rotations.col(b))), is(Eigen::Vector4d(track.rotations.col(i)));
        const double turned = p.slerp(part, q).angularDistance(is);
        const double moved = (track.places.col(a) + part * (track.places.col(b) - track.places.col(a)) - track.places.col(i)).norm();
        const double shaped =
            (track.weights.col(a) + part * (track.weights.col(b) - track.weights.col(a)) - track.weights.col(i)).cwiseAbs().dot(morphs.reach);
        // Targets add to the radius by as much as they reach; their own error is in `shaped`.
        return turned * (radius + track.weights.col(i).cwiseAbs().dot(morphs.reach)) + moved + shaped;
    };
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, count - 1}};
    while (!open.empty()) {
        const auto [from, to] = open.back();
        open.pop_back();
        double worst = tolerance;
        std::size_t at = 0;
        for (std::size_t i = from + 1; i < to; ++i)
            if (const double m = miss(from, to, i); m > worst) worst = m, at = i;
        if (at == 0) continue;
        keep[at] = 1;
        open.emplace_back(from, at);
        open.emplace_back(at, to);
    }
    std::vector<std::size_t> keys;
    for (std::size_t i = 0; i < count; ++i)
        if (keep[i]) keys.push_back(i);
    // Nothing moves: one key says it.
    if (keys.size() == 2 && track.rotations.col(0) == track.rotations.rightCols<1>() && track.places.col(0) == track.places.rightCols<1>() &&
        track.weights.col(0) == track.weights.rightCols<1>())
        keys.pop_back();
    return keys;
}

}  // namespace imomushi
