// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/export/motion.h"

namespace imomushi {

/// Where the character has the vertices that go out (Motion::Seen) in several frames, each in the moving axes of its element. Body vertices that are columns times
/// weights come from one product for all frames, which reads the columns once; the others (large motions, fingers, render meshes) are kept in single precision.
class BodyFrames {
public:
    /// `shapes` must outlive this; the character of `motion` shows them in turn. Errors: "cancelled".
    static Result<BodyFrames> build(Motion& motion, std::vector<const double*> shapes, const Progress& progress);

    [[nodiscard]] std::size_t count() const { return shapes_.size(); }
    /// #vertices x 3 in each frame, m: `out` is 3 #vertices x count(). From any thread.
    void at(std::size_t element, std::span<const std::int32_t> vertices, Eigen::MatrixXd& out) const;
    /// The motion of an element's axes, rest to world.
    [[nodiscard]] Eigen::Isometry3d frame(std::size_t element, std::size_t k) const;

private:
    struct Part {
        const CharacterInput::Element* given = nullptr;
        std::vector<std::int32_t> row;  // per body vertex: its place in freeVertices or, as -1 - place, in `held`; without a response too
        Eigen::MatrixXd held;           // 3 #held x #frames
        std::vector<int> loads;         // columns of loads behind those of v
        Eigen::MatrixXd weights;        // #columns x #frames
        bool isWhole = false;           // columns do not say it all
        Eigen::MatrixXf whole;          // 3 #vertices x #frames, of such
    };
    std::vector<const double*> shapes_;
    ShapeLayout layout_;
    std::vector<Part> parts_;
};

}  // namespace imomushi
