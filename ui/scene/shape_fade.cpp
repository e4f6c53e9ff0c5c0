// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/shape_fade.h"

#include <algorithm>
#include <utility>

namespace imomushi {

void ShapeFade::keep(const render::Scene& scene) {
    std::map<std::uint64_t, Kept> kept;  // beside those before, which a fading scene points to
    for (const render::Body& body : scene.bodies)
        if (body.mesh && body.positions) kept[body.id] = {body.mesh, {body.positions, body.positions + body.mesh->body.vertices.size()}, {}};
    kept_ = std::move(kept);
    passed_ = -1.0;
}

void ShapeFade::apply(render::Scene& scene, double seconds) {
    if (!active()) return;
    const bool first = passed_ < 0.0;
    passed_ = first ? 0.0 : passed_ + seconds;
    if (passed_ >= kSeconds) return kept_.clear();
    const double left = 1.0 - passed_ / kSeconds;
    const auto part = static_cast<float>(left * left * (3.0 - 2.0 * left));  // begins and ends slowly
    for (render::Body& body : scene.bodies) {
        const auto found = kept_.find(body.id);
        if (found == kept_.end() || !body.positions || body.mesh != found->second.mesh) continue;
        Kept& kept = found->second;
        if (first)
            for (std::size_t i = 0; i < kept.away.size(); ++i) kept.away[i] -= body.positions[i];
        kept.shown.resize(kept.away.size());
        for (std::size_t i = 0; i < kept.away.size(); ++i) kept.shown[i] = body.positions[i] + part * kept.away[i];
        body.positions = kept.shown.data();
        body.revision += ++revision_;
    }
    // One that was not there in the first frame would jump to where it never was.
    if (first) std::erase_if(kept_, [](const auto& entry) { return entry.second.shown.empty(); });
}

}  // namespace imomushi
