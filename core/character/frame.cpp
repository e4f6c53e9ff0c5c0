// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/frame.h"

#include <algorithm>

#include "core/character/frame_job.h"

namespace imomushi {

AffineFloat AffineMap::toFloat() const {
    AffineFloat out{};
    for (int i = 0; i < 3; ++i) {
        out.shift[i] = static_cast<float>(shift[i]);
        for (int k = 0; k < 3; ++k) out.linear[3 * i + k] = static_cast<float>(linear(i, k));
    }
    return out;
}

Vec3 ElementState::localAt(std::int32_t vertex, const float* blocksOf) const {
    const std::int32_t* first = blocks.first();
    const std::size_t block = static_cast<std::size_t>(std::upper_bound(first, first + blocks.count(), vertex) - first) - 1;
    const float* at = blocksOf + block * 3 * kVertexBlock + (vertex - first[block]);
    return runtime->middle + Vec3(at[0], at[kVertexBlock], at[2 * kVertexBlock]);
}

Vec3 Frame::heldAt(const ElementState& element, std::size_t i) const {
    const auto& h = element.held[i];
    const auto& joint = joints[static_cast<std::size_t>(h.joint)];
    Vec3 p = joint.map(h.rest);
    if (smooth) p.noalias() += joint.warping * element.heldShapes.col(static_cast<Eigen::Index>(i));
    if (!offsets.empty()) p += joint.rotation * offsets[static_cast<std::size_t>(h.node)];
    return p;
}

void Frame::setTime(std::string_view effect, double ms) {
    const auto row = std::find_if(stats.effects.begin(), stats.effects.end(), [effect](const EffectTime& t) { return t.effect == effect; });
    if (row == stats.effects.end())
        stats.effects.push_back({effect, ms});  // in the frame that build() makes
    else
        row->ms = ms;
}

}  // namespace imomushi
