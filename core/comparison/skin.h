// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/comparison/skin_weights.h"

namespace imomushi {

/// How other programs deform a character by its bones, for comparison only.
///   LinearBlend      matrices blended per vertex; with vector instructions where no vertex follows more than four
///   DualQuaternion   Kavan, Collins, Zara, O'Sullivan, "Geometric skinning with approximate dual quaternion blending", 2008; quaternions that point
///                    away from that of the largest weight are turned (antipodality); stretches are blended before, linearly
///   Spline           each bone is a cubic Bezier curve whose ends lean towards the neighbouring bones, in segments that are blended (like B-bones)
/// In all of them a bone that is stretched gets thinner and keeps its volume. Bones turn about themselves by the mean roll of their ends, those
/// with a free end by the roll of that; splines from end to end.
enum class SkinKind { LinearBlend, DualQuaternion, Spline };

/// A skin on the bones of a character. Built once, then update() is the per-frame job: it neither allocates nor fails.
class Skin {
public:
    /// Errors: "bad-value" where body, skeleton and weights do not belong together, "no-bone".
    static Result<Skin> build(const WeldedSurface& body, const Skeleton& skeleton, const SkinWeights& weights, SkinKind kind);
    Skin(Skin&&) noexcept;
    Skin& operator=(Skin&&) noexcept;
    ~Skin();

    /// Segments of a bone of a spline skin.
    static constexpr int kSegments = 16;

    /// A pose that does not fit the skeleton leaves all as it is.
    void update(const Pose& pose);
    /// #vertices of the body x 3, world, m.
    [[nodiscard]] const float* positions() const;
    [[nodiscard]] int vertices() const;
    [[nodiscard]] std::size_t bytes() const;  ///< that a frame reads and writes

private:
    struct State;
    explicit Skin(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
