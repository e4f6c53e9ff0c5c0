// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/gltf_rigs.h"

#include <cmath>

namespace imomushi {

namespace {

using Json = GltfFile::Json;

constexpr float kPlain = 1e-6f;   // of a scale that is none
constexpr double kStill = 1e-9;   // relative, and radians: less is rounding

/// Adds what differs from `rest`.
void addTracks(int node, const RigNodes::Local& rest, const std::vector<RigNodes::Local>& keys, std::vector<GltfRigs::Track>& out) {
    bool shifted = false, turned = false;
    GltfRigs::Track shift{node, "translation", {}}, turn{node, "rotation", {}};
    Eigen::Vector4d before = rest.rotation.coeffs();
    for (const auto& key : keys) {
        shifted = shifted || (key.translation - rest.translation).norm() > kStill * rest.translation.norm() + kStill / std::abs(key.scale);
        turned = turned || key.rotation.angularDistance(rest.rotation) > kStill;
        for (int i = 0; i < 3; ++i) shift.numbers.push_back(static_cast<float>(key.translation[i]));
        const Eigen::Vector4d q = key.rotation.coeffs().dot(before) < 0.0 ? Eigen::Vector4d(-key.rotation.coeffs()) : Eigen::Vector4d(key.rotation.coeffs());
        before = q;
        const Eigen::Vector4f unit = q.cast<float>().normalized();
        turn.numbers.insert(turn.numbers.end(), unit.data(), unit.data() + 4);
    }
    if (shifted) out.push_back(std::move(shift));
    if (turned) out.push_back(std::move(turn));
}

}  // namespace

void GltfRigs::add(Json& below, std::set<std::string>& names) {
    for (const ExportedRig& rig : scene_.rigs) {
        const RigNodes& nodes = rigs_.emplace_back(*rig.rig);
        int above = -1;
        if (nodes.hasRoot()) {
            const auto& place = nodes.root();
            above = addNode(scene_.meshes[static_cast<std::size_t>(rig.mesh)].name + " skeleton", {place.at, place.rotation, place.scale});
            below.push_back(above);
        }
        auto& made = nodes_.emplace_back();
        const std::size_t first = boneNodes_.size();
        boneNodes_.resize(first + rig.rig->bones.size());
        bonePlaces_.resize(boneNodes_.size());
        for (std::size_t n = 0; n < nodes.count(); ++n) {
            const int node = addNode(nodes.name(n), nodes.restLocal(n));
            made.push_back(node);
            names.insert(nodes.name(n));
            if (const int parent = nodes.parent(n) < 0 ? above : made[static_cast<std::size_t>(nodes.parent(n))]; parent >= 0)
                addChild(parent, node);
            else
                below.push_back(node);
            if (const int bone = nodes.boneOf(n); bone >= 0) {
                boneNodes_[first + static_cast<std::size_t>(bone)] = node;
                bonePlaces_[first + static_cast<std::size_t>(bone)] = nodes.place(n);
            }
        }
    }
}

int GltfRigs::addNode(const std::string& name, const RigNodes::Local& local) {
    Json node{{"name", name}};
    const Eigen::Vector3f at = local.translation.cast<float>();
    const Eigen::Vector4f q = local.rotation.coeffs().cast<float>().normalized();
    const auto scale = static_cast<float>(local.scale);
    if (!at.isZero(0.0f)) node["translation"] = {at[0], at[1], at[2]};
    if (!q.head<3>().isZero(0.0f)) node["rotation"] = {q[0], q[1], q[2], q[3]};
    if (std::abs(scale - 1.0f) > kPlain) node["scale"] = {scale, scale, scale};
    return file_.add("nodes", std::move(node));
}

void GltfRigs::addChild(int parent, int child) { file_.root["nodes"][static_cast<std::size_t>(parent)]["children"].push_back(child); }

RigNodes::Local GltfRigs::below(const FittedSkin::Joint& joint, const std::vector<Eigen::Isometry3d>& bones, const Eigen::Isometry3d& motion) const {
    std::size_t rig = 0, first = 0;
    while (static_cast<std::size_t>(joint.parent) >= first + scene_.rigs[rig].rig->bones.size()) first += scene_.rigs[rig++].rig->bones.size();
    return rigs_[rig].below(joint.parent - static_cast<int>(first), bones.data() + first, joint.origin, motion);
}

int GltfRigs::joint(const FittedSkin::Joint& joint) {
    if (joint.rigBone >= 0) return boneNodes_[static_cast<std::size_t>(joint.rigBone)];
    helpers_.push_back(addNode(joint.name, below(joint, rest(), Eigen::Isometry3d::Identity())));
    addChild(boneNodes_[static_cast<std::size_t>(joint.parent)], helpers_.back());
    return helpers_.back();
}

Eigen::Affine3d GltfRigs::place(const FittedSkin::Joint& joint) const {
    if (joint.rigBone >= 0) return place(static_cast<std::size_t>(joint.rigBone));
    return Eigen::Affine3d(Eigen::Translation3d(joint.origin) * Eigen::Scaling(bonePlaces_[static_cast<std::size_t>(joint.parent)].scale));
}

std::vector<GltfRigs::Track> GltfRigs::tracks(const Motion::Clip& clip, const FittedSkin* skin, std::size_t c) const {
    std::vector<Track> out;
    std::vector<RigNodes::Local> keys(clip.bones.size());
    for (std::size_t r = 0, first = 0; r < rigs_.size(); first += scene_.rigs[r++].rig->bones.size())
        for (std::size_t n = 0; n < rigs_[r].count(); ++n) {
            for (std::size_t k = 0; k < keys.size(); ++k) keys[k] = rigs_[r].local(n, clip.bones[k].data() + first);
            addTracks(nodes_[r][n], rigs_[r].restLocal(n), keys, out);
        }
    std::size_t helper = 0;
    for (std::size_t j = 0; skin && j < skin->joints.size(); ++j) {
        const auto& joint = skin->joints[j];
        if (joint.rigBone >= 0 || joint.parent < 0) continue;
        const auto& track = skin->tracks[c][j];
        for (std::size_t k = 0; k < keys.size(); ++k) {
            const auto key = static_cast<Eigen::Index>(k);
            Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
            motion.linear() = Eigen::Quaterniond(Eigen::Vector4d(track.rotations.col(key))).toRotationMatrix();
            motion.translation() = track.places.col(key) - motion.linear() * joint.origin;
            keys[k] = below(joint, clip.bones[k], motion);
        }
        addTracks(helpers_[helper++], below(joint, rest(), Eigen::Isometry3d::Identity()), keys, out);
    }
    return out;
}

}  // namespace imomushi
