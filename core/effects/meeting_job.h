// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/character/frame_job.h"
#include "core/mesh/bounds.h"

namespace imomushi {

/// For automatic contact: finds elements that come near others and have no patches yet, from at most kPoints points of each. Elements without a
/// response are left out. Points that are near each other at rest count only if their elements share no joint and their distance is halved.
class MeetingJob final : public FrameJob {
public:
    /// pressing: there is a ContactJob, whose time this adds to. met: see ContactEffect.
    MeetingJob(const Frame& frame, bool pressing, std::shared_ptr<std::vector<std::size_t>> met);

    void run(Stage stage, Frame& frame) override;
    [[nodiscard]] std::size_t bytes() const override;
    void report(Frame& frame, double ms) const override;

private:
    static constexpr std::size_t kPoints = 96;  // of a surface, at most

    struct Body {
        std::size_t element = 0;
        bool presses = false;         // it has patches
        double reach = 0.0;           // m, at rest: no point of the surface is farther from the nearest of them
        Eigen::MatrixXf columns;      // 3 P x weights: displacements, m
        Eigen::VectorXf weights, moved;
        Eigen::Matrix3Xd rest, now;   // points, m; now: world
        Bounds box;                   // of these
        double bound = 0.0;           // m: no vertex is displaced by more
        bool placed = false;          // `now` is of this frame
    };
    /// Two of them that may meet.
    struct Pair {
        std::size_t a = 0, b = 0;
        bool joined = false;
    };
    void place(const Frame& frame, Body& body) const;
    [[nodiscard]] bool isNear(const Frame& frame, const Pair& pair);
    void note(const Body& body);

    std::vector<Body> bodies_;
    std::vector<Pair> pairs_;
    std::shared_ptr<std::vector<std::size_t>> met_;
    bool pressing_ = false;
};

}  // namespace imomushi
