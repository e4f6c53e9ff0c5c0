// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/export/gltf_file.h"
#include "core/export/rig_nodes.h"
#include "core/export/skin_fit.h"

namespace imomushi {

/// The skeletons of the files that meshes of a scene came from, as nodes of a glTF file. Bones are counted over all rigs of the scene.
class GltfRigs {
public:
    /// Both must outlive this.
    GltfRigs(const ExportScene& scene, GltfFile& file) : scene_(scene), file_(file) {}

    /// Adds their nodes; `below`: gets those that have no parent, `names`: what they are called.
    void add(GltfFile::Json& below, std::set<std::string>& names);
    [[nodiscard]] std::size_t bones() const { return boneNodes_.size(); }
    [[nodiscard]] int bone(std::size_t b) const { return boneNodes_[b]; }  ///< node in the file
    [[nodiscard]] Eigen::Affine3d place(std::size_t b) const { return bonePlaces_[b].matrix(); }
    /// The node of a joint of a skin that is a bone, or hangs on one: that is made now. And where it is at rest.
    int joint(const FittedSkin::Joint& joint);
    [[nodiscard]] Eigen::Affine3d place(const FittedSkin::Joint& joint) const;

    /// A channel with a number, or four, per key of a clip.
    struct Track {
        int node = 0;
        const char* path = "translation";  ///< or "rotation"
        std::vector<float> numbers;
    };
    /// What moves bones, and joints of `skin` that hang on them, in its clip `c`. Nodes that stay as they are at rest relative to their parents have none.
    [[nodiscard]] std::vector<Track> tracks(const Motion::Clip& clip, const FittedSkin* skin, std::size_t c) const;

private:
    int addNode(const std::string& name, const RigNodes::Local& local);
    void addChild(int parent, int child);
    [[nodiscard]] RigNodes::Local below(const FittedSkin::Joint& joint, const std::vector<Eigen::Isometry3d>& bones, const Eigen::Isometry3d& motion) const;
    [[nodiscard]] std::vector<Eigen::Isometry3d> rest() const { return std::vector<Eigen::Isometry3d>(bones(), Eigen::Isometry3d::Identity()); }

    const ExportScene& scene_;
    GltfFile& file_;
    std::vector<RigNodes> rigs_;
    std::vector<std::vector<int>> nodes_;  // per rig, per node of it: in the file
    std::vector<int> boneNodes_;
    std::vector<RigNodes::Place> bonePlaces_;
    std::vector<int> helpers_;             // nodes of joints that hang on bones, in the order of the skin
};

}  // namespace imomushi
