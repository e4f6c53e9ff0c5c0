// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "ui/render/scene_renderer.h"

namespace imomushi {

/// Hides the jump of surfaces when better responses take the place of others: what was seen before fades into what is seen now. It moves the picture alone.
class ShapeFade {
public:
    static constexpr double kSeconds = 0.3;

    /// Keeps where the bodies of a scene are. They have positions: the processor deformed them.
    void keep(const render::Scene& scene);
    [[nodiscard]] bool active() const { return !kept_.empty(); }
    /// Moves bodies towards where they were kept, less and less. `seconds`: since the last call; the first one after keep() shows what was kept. What it
    /// points to is valid until the next call.
    void apply(render::Scene& scene, double seconds);

private:
    struct Kept {
        std::shared_ptr<const ElementMesh> mesh;
        std::vector<float> away;   ///< positions then, and once applied how far they are from those after the change
        std::vector<float> shown;
    };
    std::map<std::uint64_t, Kept> kept_;  // by body
    double passed_ = -1.0;                // s; negative: not applied yet
    std::uint64_t revision_ = 0;
};

}  // namespace imomushi
