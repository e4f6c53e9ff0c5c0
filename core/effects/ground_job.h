// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/plane.h"
#include "core/character/effect_settings.h"
#include "core/character/frame_job.h"
#include "core/dynamics/flesh_clearance.h"

namespace imomushi {

struct ElementState;

/// A plane below which nothing goes. Bones keep above it (core/live/performance.h), as far as the flesh around them asks.
struct GroundEffect : EffectOf<GroundEffect> {
    static constexpr std::string_view kName = "ground";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Ground");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Bodies rest on a plane and do not sink through it.");
    double height = 0.0;    ///< m
    double friction = 0.6;  ///< Coulomb's coefficient

    [[nodiscard]] Plane plane() const { return Plane::level(height); }

    static constexpr auto properties() {
        return std::array{
            number<&GroundEffect::height>("height", "m", -1e9, 1e9, IMOMUSHI_TEXT("Effects", "Height"), IMOMUSHI_TEXT("Effects", "Height of the plane.")),
            number<&GroundEffect::friction>("friction", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Friction"),
                                            IMOMUSHI_TEXT("Effects", "Coulomb’s coefficient between bodies and the ground, with bone dynamics.")),
        };
    }
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// Positions of the flesh near the ground. The constructor chooses body vertices (at most kPerPoint of an element around one joint point) so
/// that one is close to the lowest vertex in any direction, at rest and bent. Each frame computes their positions from pose, loads and bend
/// warp, without dents, also if the element is deformed outside. depths() uses all vertices as shown if the element is warped or dented.
class GroundJob final : public EffectJob<GroundEffect> {
public:
    GroundJob(const Frame& frame, const GroundEffect& settings);

    void run(Stage stage, Frame& frame) override;
    [[nodiscard]] std::size_t bytes() const override;
    /// As of the last frame, by joint point.
    [[nodiscard]] std::span<const FleshPoint> flesh() const { return flesh_; }
    /// The same, by element.
    [[nodiscard]] std::span<const FleshDepth> depths() const { return depths_; }
    /// How hard an element landed in the last frame that took time: 1 as fast as what falls from half the size of the character, or faster; 0: none did, or softly.
    [[nodiscard]] double landing() const { return landing_; }

    static constexpr std::size_t kPerPoint = 128;  ///< vertices of an element around one joint point, at most

private:
    struct Chosen {
        std::int32_t vertex = 0;
        int held = -1;          // its place in ElementState::held; -1: it is free
        Eigen::Index row = 0;   // of a free one, in Element::rows
        Vec3 rest = Vec3::Zero();
        std::size_t flesh = 0;  // its place in flesh_
    };
    struct Element {
        std::size_t index = 0;
        std::vector<Chosen> chosen;
        Eigen::MatrixXf rows;      // 3 x free chosen, by weights: m
        Eigen::VectorXf weights, moved;
        // m above the plane: its lowest vertex, at least, and its middle; in this frame and in the one before.
        struct Height {
            double lowest = 0.0, middle = 0.0;
        } height, before;
    };
    bool take(const GroundEffect&) override;
    void measure(Element& element, double& depth, Frame& frame);
    void findLanding(const Frame& frame);

    std::vector<Element> elements_;
    std::vector<FleshPoint> flesh_;
    std::vector<FleshDepth> depths_;  // of elements_
    std::vector<Vec3> at_;   // of flesh_, m, world
    bool measured_ = false;  // all of it, as it was shown last
    double size_ = 0.0;      // m, of the character at rest
    double seconds_ = 0.0;   // of the frame that is shown, also while it is corrected
    double landing_ = 0.0;
};

/// Flesh that the ground may meet, as of the last update(). Empty without that effect.
inline std::span<const FleshPoint> groundFlesh(const Character& character) {
    const GroundJob* ground = character.job<GroundJob>();
    return ground ? ground->flesh() : std::span<const FleshPoint>();
}
inline std::span<const FleshDepth> groundDepths(const Character& character) {
    const GroundJob* ground = character.job<GroundJob>();
    return ground ? ground->depths() : std::span<const FleshDepth>();
}
inline double groundLanding(const Character& character) {
    const GroundJob* ground = character.job<GroundJob>();
    return ground ? ground->landing() : 0.0;
}

}  // namespace imomushi
