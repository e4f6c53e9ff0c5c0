// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/export/export.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

/// The clips of a scene sampled at their keys: one shape (ShapeLayout) per key, of a character that this owns.
class Motion {
public:
    struct Clip {
        std::vector<double> times;
        std::vector<std::vector<double>> shapes;
        std::vector<std::vector<Eigen::Isometry3d>> bones;  ///< per key, per bone of all rigs of the scene, one rig after the other: rest to world. Empty: there are none
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

    /// The bones of all rigs in a pose; `shape`: the numbers of that pose.
    [[nodiscard]] std::vector<Eigen::Isometry3d> rigBones(const ExportScene& scene, const Pose& pose, const double* shape) const;

    /// Morph targets of a mesh of the scene that take part, and the weight of one in a shape.
    [[nodiscard]] int morphs(int mesh) const { return morphs_[static_cast<std::size_t>(mesh)].count; }
    [[nodiscard]] double morphWeight(int mesh, int target, const double* shape) const { return shape[layout.morph(morphs_[static_cast<std::size_t>(mesh)].first + target)]; }
    /// Some weight is not that at rest in a clip.
    [[nodiscard]] bool morphsChange(std::size_t clip, int mesh) const;
    /// The numbers of a shape with all weights as at rest.
    [[nodiscard]] std::vector<double> withoutMorphs(const double* shape) const;
    /// What the weights of a shape add to rest positions of what goes out of an element, 3 per vertex, m.
    void addMorphs(std::size_t element, const double* shape, Eigen::Ref<Eigen::VectorXd> to) const;

    /// Frames that can be measured in about a second, with so many products each; 48 at least.
    static std::size_t affordable(Eigen::Index products);
    /// Some keys of all clips, evenly spread, `most` at most: clip and frame.
    [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> sample(std::size_t most) const;

private:
    explicit Motion(Character made) : character(std::move(made)) {}
    BoneTree tree_;
    struct Morphs {
        int first = 0, count = 0;  // among all of the layout
        std::shared_ptr<const RenderModel> model;
    };
    std::vector<Morphs> morphs_;  // per mesh of the scene
};

/// Of the first clip that has more than one frame; 60 where none has.
double framesPerSecond(const Motion& motion);

}  // namespace imomushi
