// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "ui/models/gesture.h"
#include "ui/tools/pose_tool.h"

namespace imomushi {

/// Several fingers of a touch screen that pose at once, each with a pose tool of its own, so that each does what the pointer would. One undo step, from the first finger to the last one that is lifted. As soon
/// as one of them moves, all hold what they are on.
class PoseFingers {
public:
    explicit PoseFingers(StudioDocument& document) : document_(document) {}
    [[nodiscard]] bool busy() const { return !fingers_.empty(); }
    /// False: there is nothing to take hold of, or another finger has it.
    bool land(int id, const PointerEvent& e, const ToolOptions& options);
    /// A finger whose drag is refused leads nothing any more; the only one is taken back.
    void move(int id, const PointerEvent& e);
    void lift(int id, const PointerEvent& e);
    void cancel();
    void decorate(render::Scene& scene) const;

private:
    struct Finger {
        int id = 0;
        std::unique_ptr<PoseTool> tool;
    };
    [[nodiscard]] std::vector<Finger>::iterator find(int id);
    /// All stay where they are while one moves. Again after commands of one of them: these drop what the performance was given for others and has not heard of yet.
    void holdStill();
    void dropRefused();

    StudioDocument& document_;
    std::unique_ptr<Gesture> gesture_;  ///< opened by the first real movement: taps make no undo step
    Session::Step name_;
    std::vector<Finger> fingers_;       // after the gesture: theirs are within it
};

}  // namespace imomushi
