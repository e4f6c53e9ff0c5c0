// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/take.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

namespace imomushi {

FrameNumbers::FrameNumbers(const std::vector<std::vector<double>>& rows) {
    if (rows.empty()) return;
    first_ = rows.front();
    for (std::size_t i = 0; i < first_.size(); ++i)
        if (std::any_of(rows.begin(), rows.end(), [&](const auto& row) { return row[i] != first_[i]; })) varying_.push_back(static_cast<std::int32_t>(i));
    values_.reserve(rows.size() * varying_.size());
    for (const auto& row : rows)
        for (const std::int32_t i : varying_) values_.push_back(row[static_cast<std::size_t>(i)]);
}

void FrameNumbers::at(std::size_t frame, double* numbers) const {
    std::copy(first_.begin(), first_.end(), numbers);
    const double* from = values_.data() + frame * varying_.size();
    for (const std::int32_t i : varying_) numbers[i] = *from++;
}

FrameNumbers FrameNumbers::part(std::size_t first, std::size_t count) const {
    std::vector<std::vector<double>> rows(count, std::vector<double>(width()));
    for (std::size_t i = 0; i < count; ++i) at(first + i, rows[i].data());
    return FrameNumbers(rows);
}

TakeMoment momentAt(const std::vector<double>& times, double time) {
    const auto after = std::upper_bound(times.begin(), times.end(), time);
    if (after == times.begin()) return {};
    const auto frame = static_cast<std::size_t>(after - times.begin()) - 1;
    if (after == times.end()) return {frame, 0.0};
    return {frame, (time - times[frame]) / (*after - times[frame])};
}

Take takePart(const Take& take, std::size_t first, std::size_t count) {
    Take part;
    part.id = take.id;
    part.name = take.name;
    part.bones = take.bones;
    part.points = take.points;
    part.elements = take.elements;
    part.layout = take.layout;
    part.poses = take.poses.part(first, count);
    part.shapes = take.shapes.part(first, count);
    const double start = take.times[first], end = take.times[first + count - 1];
    for (std::size_t i = first; i < first + count; ++i) part.times.push_back(take.times[i] - start);
    std::map<std::pair<PartId, bool>, Take::Target> before;  // the last word to each endpoint
    for (const Take::Target& target : take.targets) {
        if (target.time <= start) before.insert_or_assign({target.bone, target.atEnd}, target);
        else if (target.time <= end) part.targets.push_back(target);
    }
    for (Take::Target& target : part.targets) target.time -= start;
    for (auto& [endpoint, target] : before) {
        target.time = 0.0;
        if (target.held) part.targets.insert(part.targets.begin(), target);
    }
    return part;
}

std::vector<double> poseNumbers(const Pose& pose) {
    std::vector<double> numbers;
    for (const Vec3& p : pose.points) numbers.insert(numbers.end(), p.data(), p.data() + 3);
    for (const auto& q : pose.frames) numbers.insert(numbers.end(), q.coeffs().data(), q.coeffs().data() + 4);
    numbers.insert(numbers.end(), pose.roll.begin(), pose.roll.end());
    return numbers;
}

Pose takePose(const Take& take, const TakeMoment& moment, const std::vector<PartId>& bones, const Skeleton& skeleton) {
    std::vector<double> from(take.poses.width()), to;
    take.poses.at(moment.frame, from.data());
    if (moment.part > 0.0) {
        to.resize(from.size());
        take.poses.at(moment.frame + 1, to.data());
    } else {
        to = from;
    }
    const auto at = [&](std::size_t i) { return from[i] + moment.part * (to[i] - from[i]); };
    const auto points = static_cast<std::size_t>(take.points), frames = 3 * points, rolls = frames + 4 * take.bones.size();
    Pose pose = restPose(skeleton);
    for (std::size_t b = 0; b < bones.size(); ++b) {
        const auto known = std::find_if(take.bones.begin(), take.bones.end(), [&](const Take::Bone& t) { return t.bone == bones[b]; });
        if (known == take.bones.end()) continue;
        const std::size_t frame = frames + 4 * static_cast<std::size_t>(known - take.bones.begin());
        pose.frames[b] = Eigen::Quaterniond(from.data() + frame);
        if (moment.part > 0.0) pose.frames[b] = pose.frames[b].slerp(moment.part, Eigen::Quaterniond(to.data() + frame)).normalized();
        for (const auto& [now, then] : {std::pair(skeleton.bones[b].start, known->start), std::pair(skeleton.bones[b].end, known->end)}) {
            const auto p = static_cast<std::size_t>(then);
            pose.points[static_cast<std::size_t>(now)] = Vec3(at(3 * p), at(3 * p + 1), at(3 * p + 2));
            pose.roll[static_cast<std::size_t>(now)] = at(rolls + p);
        }
    }
    return pose;
}

}  // namespace imomushi
