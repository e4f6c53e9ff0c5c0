// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <random>

#include "core/proposal/proposal_mirror.h"

namespace imomushi {

/// What a hasty artist does to a proposal: the same on every machine for one seed.
class RandomEdits {
public:
    explicit RandomEdits(std::uint64_t seed) : engine_(seed) {}

    Sides sides = Sides::One;

    int below(std::size_t n) { return static_cast<int>(engine_() % n); }
    double number() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  ///< [0, 1)
    Vec3 vector() {
        const double x = 2.0 * number() - 1.0, y = 2.0 * number() - 1.0, z = 2.0 * number() - 1.0;
        return {x, y, z};
    }

    Result<Proposal> edit(const Proposal& p) {
        const int bones = static_cast<int>(p.bones.size()), cuts = static_cast<int>(p.cuts.size()), handles = static_cast<int>(p.handles.size());
        const Vec3 near = bones > 0 ? p.bones[static_cast<std::size_t>(below(p.bones.size()))].end : Vec3::Zero();
        switch (below(12)) {
            case 0:
            case 1:
                if (cuts > 0) {
                    const int c = below(p.cuts.size());
                    const CutPlane& plane = p.cuts[static_cast<std::size_t>(c)].plane;
                    const Vec3 origin = plane.origin + 0.05 * vector();
                    return withCutMoved(p, c, {origin, plane.normal + 0.3 * vector()}, origin, sides);
                }
                break;
            case 2:
                if (cuts > 0) return withoutCut(p, below(p.cuts.size()), sides);
                break;
            case 3:
            case 4:
                if (bones > 0) {
                    const ProposedBone& bone = p.bones[static_cast<std::size_t>(below(p.bones.size()))];
                    const Vec3 middle = 0.5 * (bone.start + bone.end);
                    return withCutAdded(p, {middle, bone.end - bone.start + 0.2 * vector()}, middle, 0.3, below(2) ? std::optional<Vec3>(bone.end + 0.1 * vector()) : std::nullopt, sides);
                }
                break;
            case 5: return withCutAdded(p, {near + vector(), vector()}, near + vector(), 0.01, below(2) ? std::optional<Vec3>(near + vector()) : std::nullopt, sides);
            case 6:
            case 7:
                if (bones > 0) return withEndMoved(p, {below(p.bones.size()), below(2) == 0}, near + 0.2 * vector(), sides);
                break;
            case 8:
                if (bones > 0) return withoutBone(p, below(p.bones.size()), sides);
                break;
            case 9:
                if (bones > 0 && below(2)) return withBoneAdded(p, ProposedEnd{below(p.bones.size()), below(2) == 0}, near + 0.3 * vector(), cuts > 0 ? below(p.cuts.size()) : -1, sides);
                return withBoneAdded(p, vector(), near + vector(), -1, sides);
            case 10:
                if (handles > 0) {
                    const int h = below(p.handles.size());
                    switch (below(3)) {
                        case 0: return withoutHandle(p, h, sides);
                        case 1: return withHandleMoved(p, h, vector(), sides);
                        default: return withHandlePinToggled(p, h, sides);
                    }
                }
                break;
            default: break;
        }
        if (bones > 0) return withPinToggled(p, {below(p.bones.size()), below(2) == 0}, sides);
        return withBoneAdded(p, vector(), vector(), -1, sides);
    }

private:
    std::mt19937_64 engine_;
};

}  // namespace imomushi
