// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/io/raw_scene.h"

namespace imomushi {

/// Makes a rig of what a reader finds in a scene. Nodes are added parents first; a reader says which are joints of a skin, which carry a mesh and which vertices follow
/// which node. Nothing of the file has to be finite.
class RigBuilder {
public:
    /// Returns the index of the node. `rest`: where it is in the file's coordinates when the mesh is as its vertices come.
    int addNode(std::string name, int parent, const RigNode& local, const Eigen::Matrix4d& rest);
    /// The joint of a skin; where the skin says where it is at rest, that replaces what the node says.
    void setJoint(int node, const std::optional<Eigen::Matrix4d>& rest = {});
    /// A mesh hangs on the node. `unnamed`: the file gives the node no name. Where nothing hangs on such a node and nothing moves it, its mesh is its parent's: that is how programs
    /// that compress files say where a quantised mesh is.
    void setPart(int node, bool unnamed = false) { (unnamed ? nodes_[static_cast<std::size_t>(node)].lent : nodes_[static_cast<std::size_t>(node)].part) = true; }
    /// A vertex of the scene follows a node, or the nearest bone above it. Weights of one vertex need not sum to 1; those of one node add up.
    void bind(std::int32_t vertex, int node, double weight);
    /// The nodes of its tracks are those of addNode(). Times and values are checked by checkRig().
    void addClip(RigClip clip) { clips_.push_back(std::move(clip)); }

    /// Bones are the joints of skins. What no skin moves has a bone where a clip moves it; in a file without skins also where meshes hang on meshes, and without any
    /// mesh every node is a bone. What exceeds the limits of a rig, or is broken, is left out and told. Nothing: the file has neither bones nor clips that weigh morph targets.
    std::optional<Rig> finish(RawScene& scene);
    /// After that: the bone that the node is, -1: it is none.
    [[nodiscard]] int boneOf(int node) const { return nodes_[static_cast<std::size_t>(node)].isBone ? nodes_[static_cast<std::size_t>(node)].bone : -1; }

private:
    struct Node {
        std::string name;
        int parent = -1;
        RigNode local;
        Eigen::Matrix4d rest;
        bool joint = false, part = false, lent = false, moved = false, isBone = false;  // lent: its part is its parent's or its own; moved: by a clip
        int bone = -1, kept = -1;                         // in the rig
    };
    struct Binding {
        std::int32_t vertex;
        std::int32_t node;
        double weight;
    };
    void placeLentParts();
    [[nodiscard]] std::vector<char> chosenBones() const;
    void keep(const std::vector<char>& chosen, Rig& rig);
    void weigh(std::size_t vertices, Rig& rig) const;
    void takeClips(RawScene& scene, Rig& rig);
    /// As the first take of many FBX files does, "Take 001".
    [[nodiscard]] bool staysAtRest(const RigClip& clip) const;

    std::vector<Node> nodes_;
    std::vector<Binding> bindings_;
    std::vector<RigClip> clips_;
};

/// The local transformation of a matrix: translation, nearest rotation, and the lengths of its axes, the last one negative where it mirrors.
RigNode rigNode(int parent, const Eigen::Matrix4d& local);

}  // namespace imomushi
