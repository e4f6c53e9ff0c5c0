// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/export/export.h"

namespace imomushi {

/// The clips of a scene sampled at their keys: one shape (ShapeLayout) per key, of a character that this owns.
class Motion {
public:
    struct Clip {
        std::vector<double> times;
        std::vector<std::vector<double>> shapes;
    };
    /// fps: see ExportOptions. Errors: those of Character::build, "bad-value" (a clip without frames, or of another character), "cancelled".
    static Result<Motion> build(const ExportScene& scene, double fps, const Progress& progress);

    Character character;  ///< surfaces are not made unless somebody asks for them
    std::vector<Clip> clips;
    ShapeLayout layout;
    double diagonal = 1.0;  ///< m, of the bounding box at rest; never 0
    std::vector<double> restShape;

    /// What goes out of an element: the vertices of its body or, where a mesh of the scene is seen instead, those of the mesh that it moves.
    struct Seen {
        int mesh = -1;                       ///< -1: the body
        std::vector<std::int32_t> vertices;  ///< of the mesh, ascending
    };
    std::vector<Seen> seen;  ///< per element
    struct MeshVertex {
        std::int32_t element = 0, row = 0;  ///< row: in Seen::vertices
    };
    std::vector<std::vector<MeshVertex>> meshVertices;  ///< per mesh of the scene, per vertex
    /// Where they are in the shape that the character shows, #vertices x 3 per mesh of the scene, m, world.
    [[nodiscard]] std::vector<Points> meshPositions() const;
    /// The same of those that an element moves, or at rest.
    [[nodiscard]] Points seenPositions(std::size_t element, const std::vector<Points>& ofMeshes) const;
    [[nodiscard]] Points seenAtRest(std::size_t element) const;

    /// Frames that can be measured in about a second, with so many products each; 48 at least.
    static std::size_t affordable(Eigen::Index products);
    /// Some keys of all clips, evenly spread, `most` at most: clip and frame.
    [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> sample(std::size_t most) const;

private:
    explicit Motion(Character made) : character(std::move(made)) {}
};

/// Of the first clip that has more than one frame; 60 where none has.
double framesPerSecond(const Motion& motion);

}  // namespace imomushi
