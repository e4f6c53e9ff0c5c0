// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/take.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace imomushi {

namespace {

/// Where rows, one after the other, differ from `first`, ascending.
std::vector<std::int32_t> varyingOf(std::span<const double> rows, std::span<const double> first) {
    std::vector<char> varies(first.size(), 0);
    for (std::size_t at = 0; at < rows.size(); at += first.size())
        for (std::size_t i = 0; i < first.size(); ++i) varies[i] |= static_cast<char>(rows[at + i] != first[i]);
    std::vector<std::int32_t> out;
    for (std::size_t i = 0; i < first.size(); ++i)
        if (varies[i]) out.push_back(static_cast<std::int32_t>(i));
    return out;
}

}  // namespace

void FrameNumbers::add(const std::vector<double>& row) {
    if (frames_ == 0) first_ = row;
    if (frames_ > 0 && frames_ % kRows == 0) finish();
    open_.insert(open_.end(), row.begin(), row.end());
    ++frames_;
}

void FrameNumbers::removeLast() noexcept {
    open_.resize(open_.size() - width());
    --frames_;
}

void FrameNumbers::finish() {
    if (open_.empty()) return;
    const std::span<const double> start(open_.data(), width());
    auto block = std::make_shared<Block>();
    block->moved = varyingOf(start, first_);
    for (const std::int32_t i : block->moved) block->to.push_back(start[static_cast<std::size_t>(i)]);
    block->varying = varyingOf(open_, start);
    block->values.reserve(open_.size() / width() * block->varying.size());
    for (std::size_t at = 0; at < open_.size(); at += width())
        for (const std::int32_t i : block->varying) block->values.push_back(open_[at + static_cast<std::size_t>(i)]);
    blocks_.push_back(std::move(block));
    open_ = {};
}

void FrameNumbers::addBlock(std::shared_ptr<const Block> block, std::size_t rows) {
    blocks_.push_back(std::move(block));
    frames_ += rows;
}

void FrameNumbers::at(std::size_t frame, double* numbers) const {
    const std::size_t block = frame / kRows, row = frame % kRows;
    std::copy(first_.begin(), first_.end(), numbers);
    if (block < blocks_.size()) {
        const Block& b = *blocks_[block];
        for (std::size_t i = 0; i < b.moved.size(); ++i) numbers[b.moved[i]] = b.to[i];
        const double* from = b.values.data() + row * b.varying.size();
        for (const std::int32_t i : b.varying) numbers[i] = *from++;
    } else if (frame < frames_) {
        std::copy_n(open_.begin() + static_cast<std::ptrdiff_t>(row * width()), width(), numbers);
    }
}

FrameNumbers FrameNumbers::part(std::size_t first, std::size_t count) const {
    FrameNumbers part;
    std::vector<double> row(width());
    for (std::size_t i = 0; i < count; ++i) {
        at(first + i, row.data());
        part.add(row);
    }
    part.finish();
    return part;
}

std::size_t FrameNumbers::bytes() const {
    std::size_t bytes = (first_.size() + open_.size()) * sizeof(double);
    for (const auto& b : blocks_) bytes += (b->to.size() + b->values.size()) * sizeof(double) + (b->moved.size() + b->varying.size()) * sizeof(std::int32_t);
    return bytes;
}

bool FrameNumbers::operator==(const FrameNumbers& other) const {
    return frames_ == other.frames_ && first_ == other.first_ && open_ == other.open_ &&
           std::equal(blocks_.begin(), blocks_.end(), other.blocks_.begin(), other.blocks_.end(), [](const auto& a, const auto& b) { return a == b || *a == *b; });
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
