// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/character/character_shape.h"
#include "core/document/effects.h"
#include "core/mesh/mesh.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Rows of numbers, one per frame. Frames are stored in blocks of kRows. A number that is constant
/// in a block is stored at most once. Copies share blocks.
class FrameNumbers {
public:
    /// Frames of a block; the last one may have fewer.
    static constexpr std::size_t kRows = 256;
    struct Block {
        std::vector<std::int32_t> moved;    ///< ascending places: what its first frame has otherwise than the first of all
        std::vector<double> to;             ///< of these
        std::vector<std::int32_t> varying;  ///< ascending places: what changes after its first frame
        std::vector<double> values;         ///< of these, #frames x #varying, row by row
        bool operator==(const Block&) const = default;
    };

    FrameNumbers() = default;
    /// Of the frames of blocks that addBlock() brings. first: of frame 0.
    explicit FrameNumbers(std::vector<double> first) : first_(std::move(first)) {}

    /// One more frame: as many numbers as those before it have. All frames stay as they are where memory runs out.
    void add(const std::vector<double>& row);
    /// Takes back the last add().
    void removeLast() noexcept;
    /// After the last frame.
    void finish();
    /// The next `rows` frames, as blocks() of another one has them.
    void addBlock(std::shared_ptr<const Block> block, std::size_t rows);

    [[nodiscard]] std::size_t width() const { return first_.size(); }
    /// width() numbers.
    void at(std::size_t frame, double* numbers) const;
    /// The rows [first, first + count).
    [[nodiscard]] FrameNumbers part(std::size_t first, std::size_t count) const;
    [[nodiscard]] std::size_t bytes() const;

    [[nodiscard]] const std::vector<double>& first() const { return first_; }
    /// After finish(): of all frames. None where a frame has no numbers.
    [[nodiscard]] const std::vector<std::shared_ptr<const Block>>& blocks() const { return blocks_; }
    bool operator==(const FrameNumbers& other) const;

private:
    std::size_t frames_ = 0;
    std::vector<double> first_;
    std::vector<std::shared_ptr<const Block>> blocks_;
    std::vector<double> open_;  // frames after the blocks, with all their numbers
};

/// A recorded performance. Per frame it keeps two things: the pose that was shown, which fits as long as its bones are there; and the shape of the
/// character (character_shape.h), a few hundred numbers from which every vertex follows, whatever effects had a part in it. While elements, joint faces, basis
/// and effects are those of the recording a take shows what was seen, byte for byte, at any frame and without what came before; afterwards it shows its poses, at rest
/// in each. Simulating again from the start would show what the settings of now make of it, and only in order.
struct Take {
    PartId id = 0;
    std::string name;
    std::vector<double> times;  ///< s, of each frame: ascending from 0, when the recording began

    struct Bone {
        PartId bone = 0;
        int start = 0, end = 0;  ///< joint points of `poses`
    };
    std::vector<Bone> bones;
    int points = 0;
    FrameNumbers poses;  ///< per frame: x y z of all points, x y z w of all bones, roll of all points

    std::vector<PartId> elements;
    ShapeLayout layout;
    FrameNumbers shapes;  ///< per frame: layout.size()

    /// What an endpoint was told, from that time on.
    struct Target {
        double time = 0.0;
        PartId bone = 0;
        bool atEnd = false;
        bool held = false;  ///< false: let go
        bool pinned = false;
        Vec3 to = Vec3::Zero();
        std::optional<double> roll;
    };
    std::vector<Target> targets;

    [[nodiscard]] double duration() const { return times.empty() ? 0.0 : times.back(); }
    [[nodiscard]] std::size_t bytes() const { return times.size() * sizeof(double) + poses.bytes() + shapes.bytes() + targets.size() * sizeof(Target); }
};

/// Between which frames a time is: `part` of the way from `frame` to the next one. Times outside are those of the ends.
struct TakeMoment {
    std::size_t frame = 0;
    double part = 0.0;
};
TakeMoment momentAt(const std::vector<double>& times, double time);

/// The frames [first, first + count) as a take of the same name, from 0. What was held when they begin is told again at 0.
Take takePart(const Take& take, std::size_t first, std::size_t count);

/// Numbers of Take::poses.
std::vector<double> poseNumbers(const Pose& pose);
/// The pose of a take at a moment. `bones`, `skeleton`: as the character is now; bones that the take does not know, and points of such bones alone, are at rest.
Pose takePose(const Take& take, const TakeMoment& moment, const std::vector<PartId>& bones, const Skeleton& skeleton);

}  // namespace imomushi
