// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/character/character.h"
#include "core/export/rig_nodes.h"
#include "core/mesh/render_model.h"

namespace imomushi {

/// A performance to write: shapes of the character, or poses of its skeleton.
struct ExportClip {
    std::string name;
    std::vector<double> times;  ///< s, ascending from 0
    /// The numbers of a frame (ShapeLayout); empty: `poses` instead.
    std::function<void(std::size_t frame, double* numbers)> shape;
    std::vector<Pose> poses;    ///< of the frames; beside `shape` only needed where the scene has rigs
};

/// What is seen of some elements instead of their bodies: the file's own mesh.
struct ExportedMesh {
    std::string name;
    std::shared_ptr<const RenderModel> model;
    std::vector<int> elements;  ///< that move it, ascending
};

/// What goes out, by indices of `character`.
struct ExportScene {
    std::string name;
    CharacterInput character;
    std::vector<ExportedMesh> meshes;                  ///< of character.renderMeshes
    std::vector<ExportedRig> rigs;                     ///< of some meshes
    std::vector<std::string> elements, bones, points;  ///< names of elements, bones, and joint points ("bone/end")
    std::vector<Eigen::Vector3f> colors;               ///< of elements whose meshes bring no colours, linear RGB
    std::vector<ExportClip> clips;                     ///< one at least
};

/// How a character is written.
///   Baked    glTF: a node per element that moves rigidly, and morph targets, one per column of A' (the manual's model, "One element"): x = frame (rest + sum of
///            weight * target), which is what the studio computes
///   Rigged   the same in one skeleton, an element to a joint, with what drives the weights in `extras` (driver.h)
///   Skinned  glTF without morph targets: linear blend skinning with fitted weights, four joints per vertex
///   Cache    positions of all vertices per frame: PC2, MDD, or a sequence of OBJ or PLY files
/// Elements under a mesh of the scene go out as that mesh: its triangles, parts, materials, texture coordinates and vertices in the order of the file, split where the file
/// splits them. In glTF it has a mesh per part with a primitive per material and, also in Baked, a skin with a joint per element: each vertex follows one, and the
/// targets of an element move its vertices alone. What is more than columns of A' (parts beside joints that turn far, attached parts) is fitted like large motions.
/// A mesh with a rig brings the skeleton of its file in all glTF layouts: all its bones are joints of the skin, with their names, in its hierarchy and at rest where they were;
/// each bone follows its piece, in animations of the takes too. Baked and Rigged move vertices by the elements' own joints, exactly; Skinned by the bones of the file, so
/// that animations made for the old skeleton move it too.
enum class ExportLayout { Baked, Rigged, Skinned, Cache };

struct ExportOptions {
    ExportLayout layout = ExportLayout::Baked;
    double fps = 0.0;        ///< keys at this rate; 0: at the recorded times
    int targets = 0;         ///< at most so many per element or mesh of the scene, the most important ones; 0: all
    bool split = false;      ///< a target for each sign of a weight: weights stay within 0 ... 1
    bool quantised = false;  ///< KHR_mesh_quantization: 16 bits per coordinate and weight
    bool compressed = false; ///< by meshoptimizer, without loss; .fbx files never are
    bool normals = false;    ///< morph targets move normals too
    const Rig* avatar = nullptr;  ///< of the scene: it goes out as VRM 1.0 too; exportScene() finds it for a path that ends in .vrm
    double tolerance = 0.0;  ///< keys are left out where the others say the same within this part of the diagonal
};

/// A distance over the bounding-box diagonal of the character at rest.
struct ExportError {
    double largest = 0.0, rms = 0.0;
};

/// Something to know about what was written.
struct ExportWarning {
    std::string code;     ///< for translations: "not-precomputed", "poses-only", "texture-format", "uneven-frames"
    std::string subject;  ///< the name it is about
    std::string text;     ///< one English sentence
};

struct ExportReport {
    std::vector<std::filesystem::path> files;
    std::size_t bytes = 0;
    std::size_t uncompressed = 0;  ///< bytes that a compressed file would have without that; 0: it is not compressed
    int vertices = 0, triangles = 0;
    int targets = 0;        ///< of the mesh with the most
    std::size_t keys = 0;   ///< of all clips and elements
    struct Clip {
        std::string name;
        std::size_t frames = 0;
        double seconds = 0.0;
    };
    std::vector<Clip> clips;
    /// What the file has: an element with its body, or a mesh of the scene.
    struct Written {
        std::string name;
        bool ownMesh = false;  ///< of the scene
        int parts = 0;         ///< of a mesh of the scene
        int vertices = 0, triangles = 0;
    };
    std::vector<Written> written;
    /// What is lost by design, at the frames that it was measured on: large motions and fingers that fitted targets follow; what they leave of render vertices beside
    /// joints and of attached parts; targets that were dropped; a skin instead of the elastic body.
    ExportError warped, touched, followed, dropped, skinned;
    double quantised = 0.0;  ///< what whole numbers round vertices by at most, over the diagonal
    /// The file as it was read back against the character, at `checked` frames of the clips.
    ExportError check;
    int checked = 0;
    std::vector<ExportWarning> warnings;
};

/// Writes a scene: .glb, .vrm (a .glb file of one avatar, in the layout Skinned), .fbx (fbx.h; weights should be split, as Blender clamps them), or for caches .pc2, .mdd, .obj, .ply (cache_writer.h). Files appear
/// whole or not at all. What was written is read back and compared. Errors: "unknown-format", "bad-value", "not-writable", "not-readable" (what was written is not what was meant), "not-an-avatar",
/// "needs-blender", "not-converted", "cancelled".
Result<ExportReport> exportScene(const ExportScene& scene, const ExportOptions& options, const std::filesystem::path& path, const Progress& progress);

}  // namespace imomushi
