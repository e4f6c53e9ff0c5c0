// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kTakeTables = R"(
CREATE TABLE takes (id INTEGER PRIMARY KEY, name TEXT, times BLOB, bones BLOB, points INTEGER, elements BLOB, element_sizes BLOB, joints INTEGER, warping INTEGER,
    nodes INTEGER, turns INTEGER, morphs INTEGER, pose BLOB, shape BLOB);
CREATE TABLE take_blocks (take INTEGER, shapes INTEGER, position INTEGER, moved BLOB, moved_to BLOB, varying BLOB, numbers BLOB, PRIMARY KEY (take, shapes, position));
CREATE TABLE take_targets (take INTEGER, position INTEGER, time REAL, bone INTEGER, at_end INTEGER, held INTEGER, pinned INTEGER, target BLOB, roll REAL,
    PRIMARY KEY (take, position));
)";

/// The frames of a take that is being read, block by block.
class BlockReader {
public:
    /// `rotations`: where in each frame the quaternions are.
    BlockReader(std::vector<double> first, std::size_t width, std::size_t frames, std::vector<std::size_t> rotations, bool keep)
        : row_(first), frames_(frames), rotations_(std::move(rotations)), keep_(keep) {
        require(first.size() == width && allCoordinates(first), "the first frame of a take is broken");
        checkRotations();
        first_ = first;
        numbers_ = FrameNumbers(std::move(first));
    }

    /// The columns from "position" on.
    void read(RowReader& rows) {
        readPosition(rows, blocks_);
        const std::size_t done = blocks_++ * FrameNumbers::kRows;
        require(done < frames_ && !first_.empty(), "a take has more frames than times");
        const std::size_t count = std::min(FrameNumbers::kRows, frames_ - done);
        auto block = std::make_shared<FrameNumbers::Block>();
        readColumns(rows, block->moved, block->to, block->varying, block->values);
        const auto width = static_cast<Eigen::Index>(first_.size());
        require(ascendingWithin(block->moved, width) && ascendingWithin(block->varying, width) && block->to.size() == block->moved.size() &&
                    block->values.size() == count * block->varying.size(),
                "a take has a broken size");
        require(allCoordinates(block->to) && allCoordinates(block->values), "a take is out of range");
        row_ = first_;
        for (std::size_t i = 0; i < block->moved.size(); ++i) row_[static_cast<std::size_t>(block->moved[i])] = block->to[i];
        for (const double* from = block->values.data(), *end = from + block->values.size(); from != end;) {
            for (const std::int32_t i : block->varying) row_[static_cast<std::size_t>(i)] = *from++;
            checkRotations();
        }
        if (block->varying.empty()) checkRotations();
        if (keep_) numbers_.addBlock(std::move(block), count);
    }

    FrameNumbers finish() {
        require(blocks_ == (first_.empty() ? 0 : (frames_ + FrameNumbers::kRows - 1) / FrameNumbers::kRows), "a take has fewer frames than times");
        return std::move(numbers_);
    }

private:
    void checkRotations() const {
        for (const std::size_t q : rotations_) require(std::abs(Eigen::Map<const Eigen::Vector4d>(row_.data() + q).norm() - 1.0) < 1e-6, "a take holds no rotation");
    }

    std::vector<double> first_, row_;
    std::size_t frames_, blocks_ = 0;
    std::vector<std::size_t> rotations_;
    bool keep_;
    FrameNumbers numbers_;
};

}  // namespace

void createTakeTables(Database& db) { db.run(kTakeTables); }

void writeTakes(Database& db, const Document& document) {
    RowWriter takes(db, "INSERT INTO takes VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?)"), blocks(db, "INSERT INTO take_blocks VALUES (?,?,?,?,?,?,?)"),
        targets(db, "INSERT INTO take_targets VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, take] : document.takes) {
        std::vector<PartId> bones;
        for (const Take::Bone& b : take->bones) bones.insert(bones.end(), {b.bone, static_cast<PartId>(b.start), static_cast<PartId>(b.end)});
        std::vector<std::int32_t> sizes;
        for (const auto& e : take->layout.elements) sizes.insert(sizes.end(), {e.weights, e.forces, e.fades});
        takes.row(id, take->name, take->times, bones, take->points, take->elements, sizes, take->layout.joints, take->layout.warping, take->layout.nodes, take->layout.turns,
                  take->layout.morphs, take->poses.first(), take->shapes.first());
        for (const bool shapes : {false, true}) {
            std::size_t position = 0;
            for (const auto& b : (shapes ? take->shapes : take->poses).blocks()) blocks.row(id, shapes, position++, b->moved, b->to, b->varying, b->values);
        }
        for (std::size_t i = 0; i < take->targets.size(); ++i) {
            const Take::Target& t = take->targets[i];
            targets.row(id, i, t.time, t.bone, t.atEnd, t.held, t.pinned, t.to, t.roll);
        }
    }
}

void readTakes(Database& db, Document& document, bool keep) {
    constexpr std::int64_t kMaxParts = 1'000'000;
    std::map<PartId, std::shared_ptr<Take>> read;
    std::map<std::pair<PartId, bool>, BlockReader> frameReaders;  // of poses, of shapes
    RowReader rows(db, "SELECT * FROM takes ORDER BY id");
    while (rows.next()) {
        auto take = std::make_shared<Take>();
        take->id = readId(rows);
        take->name = rows.text();
        require(checkNameText(take->name).has_value() && !document.takeNamed(take->name), "the name of a take is broken or used twice");
        take->times = rows.array<double>();
        const std::size_t frames = take->times.size();
        require(frames > 0 && allCoordinates(take->times) && take->times[0] == 0.0 && std::adjacent_find(take->times.begin(), take->times.end(), std::greater_equal<>()) == take->times.end(),
                "the times of a take are broken");
        const auto bones = rows.array<PartId>(3);
        take->points = static_cast<int>(rows.integer(0, kMaxParts));
        for (std::size_t i = 0; i < bones.size(); i += 3) {
            require(bones[i + 1] < static_cast<PartId>(take->points) && bones[i + 2] < static_cast<PartId>(take->points), "the bones of a take are broken");
            take->bones.push_back({bones[i], static_cast<int>(bones[i + 1]), static_cast<int>(bones[i + 2])});
        }
        take->elements = rows.array<PartId>();
        const auto sizes = rows.array<std::int32_t>();
        require(sizes.size() == 3 * take->elements.size(), "the elements of a take are broken");
        std::int64_t numbers = 0;
        for (std::size_t i = 0; i < sizes.size(); i += 3) {
            require(sizes[i] >= 0 && sizes[i] <= kMaxParts && sizes[i + 1] >= 0 && sizes[i + 1] <= kMaxParts, "the elements of a take are broken");
            require(sizes[i + 2] == 0 || sizes[i + 2] == 1, "the elements of a take are broken");
            take->layout.elements.push_back({sizes[i], sizes[i + 1], sizes[i + 2]});
            numbers += take->layout.elements.back().size();
        }
        take->layout.joints = static_cast<int>(rows.integer(0, kMaxParts));
        take->layout.warping = static_cast<int>(rows.integer(0, Warping::kMax));
        take->layout.nodes = static_cast<int>(rows.integer(0, kMaxParts));
        take->layout.turns = static_cast<int>(rows.integer(0, kMaxParts));
        take->layout.morphs = static_cast<int>(rows.integer(0, kMaxParts));
        require(numbers + 64 * kMaxParts < std::numeric_limits<int>::max(), "a take is too large");
        std::vector<std::size_t> rotations;
        const auto points = static_cast<std::size_t>(take->points);
        for (std::size_t b = 0; b < take->bones.size(); ++b) rotations.push_back(3 * points + 4 * b);
        frameReaders.try_emplace({take->id, false}, rows.array<double>(), 4 * points + 4 * take->bones.size(), frames, rotations, keep);
        rotations.clear();
        for (std::size_t e = 0, at = 0; e < take->layout.elements.size(); ++e) {
            rotations.push_back(at);
            at += static_cast<std::size_t>(take->layout.elements[e].size());
        }
        for (int j = 0; j < take->layout.joints; ++j) rotations.push_back(static_cast<std::size_t>(take->layout.joint(j)));
        frameReaders.try_emplace({take->id, true}, rows.array<double>(), static_cast<std::size_t>(take->layout.size()), frames, rotations, keep);
        read.emplace(take->id, take);
        document.takes.emplace(take->id, std::move(take));
    }
    RowReader blocks(db, "SELECT * FROM take_blocks ORDER BY take, shapes, position");
    while (blocks.next()) {
        const PartId take = readId(blocks);
        const auto frames = frameReaders.find({take, blocks.boolean()});
        require(frames != frameReaders.end(), "a block of frames belongs to no take");
        frames->second.read(blocks);
    }
    for (auto& [of, frames] : frameReaders) {
        Take& take = *read.at(of.first);
        (of.second ? take.shapes : take.poses) = frames.finish();
    }
    RowReader targets(db, "SELECT * FROM take_targets ORDER BY take, position");
    while (targets.next()) {
        const auto take = read.find(readId(targets));
        require(take != read.end(), "a target belongs to no take");
        auto& list = take->second->targets;
        readPosition(targets, list.size());
        Take::Target t;
        t.time = targets.real(0.0, kMaxCoordinate);
        t.bone = readId(targets);
        readColumns(targets, t.atEnd, t.held, t.pinned, t.to);
        t.roll = targets.optionalReal();
        require(!t.roll || std::abs(*t.roll) <= 1e6, "a roll is out of range");
        list.push_back(t);
    }
}

}  // namespace imomushi
