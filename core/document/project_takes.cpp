// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "core/document/project_rows.h"
#include "core/document/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kTakeTables = R"(
CREATE TABLE takes (id INTEGER PRIMARY KEY, name TEXT, times BLOB, bones BLOB, points INTEGER, pose_first BLOB, pose_varying BLOB, pose_values BLOB,
    elements BLOB, element_sizes BLOB, joints INTEGER, warping INTEGER, nodes INTEGER, shape_first BLOB, shape_varying BLOB, shape_values BLOB);
CREATE TABLE take_targets (take INTEGER, position INTEGER, time REAL, bone INTEGER, at_end INTEGER, held INTEGER, pinned INTEGER, target BLOB, roll REAL,
    PRIMARY KEY (take, position));
)";

/// Of `frames` frames; `rotations`: where in each the quaternions are.
FrameNumbers readFrames(RowReader& rows, std::size_t width, std::size_t frames, const std::vector<std::size_t>& rotations) {
    auto first = rows.array<double>();
    auto varying = rows.array<std::int32_t>();
    auto values = rows.array<double>();
    require(first.size() == width && ascendingWithin(varying, static_cast<Eigen::Index>(width)) && values.size() == frames * varying.size(), "a take has a broken size");
    require(allCoordinates(first) && allCoordinates(values), "a take is out of range");
    FrameNumbers numbers(std::move(first), std::move(varying), std::move(values));
    std::vector<double> row(width);
    for (std::size_t f = 0; f < frames; ++f) {
        numbers.at(f, row.data());
        for (const std::size_t q : rotations)
            require(std::abs(Eigen::Map<const Eigen::Vector4d>(row.data() + q).norm() - 1.0) < 1e-6, "a take holds no rotation");
    }
    return numbers;
}

}  // namespace

void createTakeTables(Database& db) { db.run(kTakeTables); }

void writeTakes(Database& db, const Document& document) {
    RowWriter takes(db, "INSERT INTO takes VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"), targets(db, "INSERT INTO take_targets VALUES (?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, take] : document.takes) {
        std::vector<PartId> bones;
        for (const Take::Bone& b : take->bones) bones.insert(bones.end(), {b.bone, static_cast<PartId>(b.start), static_cast<PartId>(b.end)});
        // Three where an effect fades, else two per element.
        const auto& elements = take->layout.elements;
        const bool fades = std::any_of(elements.begin(), elements.end(), [](const auto& e) { return e.fades != 0; });
        std::vector<std::int32_t> sizes;
        for (const auto& e : elements) {
            sizes.insert(sizes.end(), {e.weights, e.forces});
            if (fades) sizes.push_back(e.fades);
        }
        takes.row(id, take->name, take->times, bones, take->points, take->poses.first(), take->poses.varying(), take->poses.values(), take->elements, sizes,
                  take->layout.joints, take->layout.warping, take->layout.nodes, take->shapes.first(), take->shapes.varying(), take->shapes.values());
        for (std::size_t i = 0; i < take->targets.size(); ++i) {
            const Take::Target& t = take->targets[i];
            targets.row(id, i, t.time, t.bone, t.atEnd, t.held, t.pinned, t.to, t.roll);
        }
    }
}

void readTakes(Database& db, Document& document, const std::map<PartId, int>& turns, const std::map<PartId, int>& morphs) {
    constexpr std::int64_t kMaxParts = 1'000'000;
    std::map<PartId, std::shared_ptr<Take>> read;
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
        std::vector<std::size_t> rotations;
        const auto points = static_cast<std::size_t>(take->points);
        for (std::size_t b = 0; b < take->bones.size(); ++b) rotations.push_back(3 * points + 4 * b);
        take->poses = readFrames(rows, 4 * points + 4 * take->bones.size(), frames, rotations);
        take->elements = rows.array<PartId>();
        const auto sizes = rows.array<std::int32_t>();
        const std::size_t each = sizes.size() == 3 * take->elements.size() ? 3 : 2;
        require(sizes.size() == each * take->elements.size(), "the elements of a take are broken");
        std::int64_t numbers = 0;
        for (std::size_t i = 0; i < sizes.size(); i += each) {
            require(sizes[i] >= 0 && sizes[i] <= kMaxParts && sizes[i + 1] >= 0 && sizes[i + 1] <= kMaxParts, "the elements of a take are broken");
            const int fades = each == 3 ? sizes[i + 2] : 0;
            require(fades == 0 || fades == 1, "the elements of a take are broken");
            take->layout.elements.push_back({sizes[i], sizes[i + 1], fades});
            numbers += take->layout.elements.back().size();
        }
        take->layout.joints = static_cast<int>(rows.integer(0, kMaxParts));
        take->layout.warping = static_cast<int>(rows.integer(0, Warping::kMax));
        take->layout.nodes = static_cast<int>(rows.integer(0, kMaxParts));
        if (const auto turned = turns.find(take->id); turned != turns.end()) take->layout.turns = turned->second;
        if (const auto weighed = morphs.find(take->id); weighed != morphs.end()) take->layout.morphs = weighed->second;
        require(numbers + 64 * kMaxParts < std::numeric_limits<int>::max(), "a take is too large");
        rotations.clear();
        for (std::size_t e = 0, at = 0; e < take->layout.elements.size(); ++e) {
            rotations.push_back(at);
            at += static_cast<std::size_t>(take->layout.elements[e].size());
        }
        for (int j = 0; j < take->layout.joints; ++j) rotations.push_back(static_cast<std::size_t>(take->layout.joint(j)));
        take->shapes = readFrames(rows, static_cast<std::size_t>(take->layout.size()), frames, rotations);
        read.emplace(take->id, take);
        document.takes.emplace(take->id, std::move(take));
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
        t.atEnd = targets.boolean();
        t.held = targets.boolean();
        t.pinned = targets.boolean();
        t.to = readPoint(targets);
        t.roll = targets.optionalReal();
        require(!t.roll || std::abs(*t.roll) <= 1e6, "a roll is out of range");
        list.push_back(t);
    }
}

}  // namespace imomushi
