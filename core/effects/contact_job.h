// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/character/effect_settings.h"
#include "core/character/frame_job.h"
#include "core/touch/flesh_contact.h"

namespace imomushi {

struct ElementState;

/// Elements press on each other and on themselves (core/touch/flesh_contact.h).
struct ContactEffect : EffectOf<ContactEffect> {
    static constexpr std::string_view kName = "contact";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Contact");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Elements press dents into each other where they meet, instead of passing through. With the ground, into them, too.");
    double patches = 48.0;  ///< of the surface of each element, on which others press: columns of its response, those of touch
    double friction = 0.5;
    /// The plane of the effect "ground", which flesh presses against as well, and its friction. None: there is no ground.
    std::optional<Plane> ground;
    double groundFriction = 0.6;
    /// Automatic: each update writes here the elements that came near others and have no patches yet, ascending (MeetingJob). Null: nobody wants to know.
    std::shared_ptr<std::vector<std::size_t>> met;

    static constexpr auto properties() {
        return std::array{
            number<&ContactEffect::patches>("patches", "", 8.0, 256.0, IMOMUSHI_TEXT("Effects", "Patches"),
                                            IMOMUSHI_TEXT("Effects", "On how many patches of a surface others press. More of them make finer dents, and a longer precompute."), true, true),
            number<&ContactEffect::friction>("friction", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Friction"),
                                             IMOMUSHI_TEXT("Effects", "Coulomb’s coefficient between two surfaces. 0: they slide over each other.")),
        };
    }
    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// Contact of flesh with flesh. It works on the surfaces that the pose alone gives, before dents. It costs nothing while no bodies are near, or while bodies in contact are at rest.
class ContactJob final : public EffectJob<ContactEffect> {
public:
    ContactJob(Frame& frame, const ContactEffect& settings);

    void run(Stage stage, Frame& frame) override;
    [[nodiscard]] bool resting(const Frame&) const override { return !presses_ || contact_.converged(); }
    [[nodiscard]] std::size_t bytes() const override { return contact_.bytes(); }
    void report(Frame& frame, double ms) const override;
    [[nodiscard]] const FleshContact& contact() const { return contact_; }

private:
    struct Body {
        std::size_t element = 0;
        Eigen::MatrixXf middles;         // 3 P x weights: displacements of the middles of patches, m
        Eigen::Matrix3Xd rest, now;      // of these, m; now: world
        Eigen::VectorXf weights;         // of the frame
        Eigen::VectorXf moved;           // 3 P
        double bound = 0.0;              // m: no vertex is displaced by more
        std::vector<std::int32_t> held;  // per body vertex, its place in ElementState::held; -1: it is free
    };
    class Posed;
    static std::vector<Body> bodiesOf(const Frame& frame, const ContactEffect& settings);
    static std::vector<FleshContact::Body> surfacesOf(const Frame& frame, const std::vector<Body>& bodies);
    void begin(Frame& frame);
    void findNear(Frame& frame);
    /// m: no vertex of it is farther out of the ball around its body at rest.
    [[nodiscard]] double beyond(const Frame& frame, std::size_t body) const;
    [[nodiscard]] bool mayMeetGround(const Frame& frame, std::size_t body);
    [[nodiscard]] bool mayMeet(const Frame& frame, std::size_t a, std::size_t b);
    const Eigen::Matrix3Xd& middlesOf(const Frame& frame, std::size_t body);

    std::vector<Body> bodies_;
    FleshContact contact_;
    FleshContact::Settings numbers_;
    BoxTree tree_;                    // over bodies
    std::vector<Bounds> boxes_;       // of these
    FleshContact::Near near_;         // in this frame
    std::vector<char> found_;         // per body: its middles are those of this frame
    std::vector<char> moved_;         // per body: it is not where it was in the last frame
    bool presses_ = false;
    bool known_ = false;     // the last frame was one of this job's
    bool grounded_ = false;  // it had a ground
};

}  // namespace imomushi
