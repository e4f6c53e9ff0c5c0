// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "ui/render/scene_renderer.h"

namespace imomushi {

/// Hides the jump of surfaces when other responses take the place of those there were: what was seen before fades into what is seen now. Where a response is still being
/// made, what was seen stays until it is there. It moves the picture alone.
class ShapeFade {
public:
    static constexpr double kSeconds = 0.3;
    /// A body waits for its response no longer than this after keep(), s: it would lag behind what moves it.
    static constexpr double kLongestWait = 4.0;
    /// Says of a body, by its id, whether something holds for it.
    using Asks = std::function<bool(std::uint64_t)>;

    /// Keeps where the bodies of a scene are. They have positions: the processor deformed them.
    void keep(const render::Scene& scene);
    /// Forgets all bodies but these.
    void retain(const Asks& wanted);
    [[nodiscard]] bool active() const { return !kept_.empty(); }
    /// The body is fading, or waits.
    [[nodiscard]] bool has(std::uint64_t body) const { return kept_.contains(body); }
    /// Moves bodies towards where they were kept, less and less. `seconds`: since the last call; the first one after keep() shows what was kept. Bodies that wait
    /// stay there. Parts of a model may be divided in another way than they were. What it points to is valid until the next call.
    void apply(render::Scene& scene, double seconds, const Asks& waits = {});

private:
    struct Kept {
        std::shared_ptr<const ElementMesh> mesh;
        std::vector<float> away;     ///< positions then, and once it fades how far they are from those after the change
        std::vector<float> normals;  ///< then; empty: they follow from the triangles
        std::vector<float> shown, shownNormals;
        double passed = -1.0;        ///< s of fading; negative: it has not begun
        double waited = 0.0;         ///< s
        bool seen = false;           ///< since keep()
        bool outdated = false;       ///< it was drawn as that
    };
    /// Where the vertices of a whole model were; not a number: hidden.
    struct Model {
        std::shared_ptr<const ElementMesh> mesh;
        std::vector<float> positions, normals;
    };
    /// What was kept of a body that is drawn now; null: nothing.
    Kept* keptOf(const render::Body& body);
    void show(render::Body& body, Kept& kept, double seconds, bool waits);

    std::map<std::uint64_t, Kept> kept_;       // by body
    std::map<const ElementMesh*, Model> models_;
    std::set<std::uint64_t> dropped_;          // bodies that retain() forgot
    bool first_ = true;                        // apply() comes next for the first time since keep()
    std::uint64_t revision_ = 0;
};

}  // namespace imomushi
