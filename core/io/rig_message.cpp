// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/message_bytes.h"
#include "core/io/raw_scene.h"

namespace imomushi {

namespace {

using Three = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Four = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

void write(MessageWriter& w, const Eigen::Quaterniond& q) { w.matrix(q.coeffs()); }

Vec3 readPlace(MessageReader& r) {
    Three m;
    r.matrix(m);
    if (m.rows() != 1) r.refuse();
    return r.good() ? Vec3(m.row(0).transpose()) : Vec3::Zero();
}

Eigen::Quaterniond readRotation(MessageReader& r) {
    Four m;
    r.matrix(m);
    if (m.rows() != 1) r.refuse();
    return r.good() ? Eigen::Quaterniond(Eigen::Vector4d(m.row(0).transpose())) : Eigen::Quaterniond::Identity();
}

}  // namespace

void writeRig(MessageWriter& w, const Rig& rig) {
    w.value(static_cast<std::uint64_t>(rig.bones.size()));
    for (const RigBone& bone : rig.bones) {
        w.text(bone.name);
        w.value(bone.parent);
        w.value(bone.node);
        w.matrix(bone.head);
        w.matrix(bone.tail);
        write(w, bone.rotation);
    }
    w.value(static_cast<std::uint64_t>(rig.nodes.size()));
    for (const RigNode& node : rig.nodes) {
        w.value(node.parent);
        w.matrix(node.translation);
        write(w, node.rotation);
        w.matrix(node.scale);
        w.text(node.name);
    }
    w.matrix(rig.toScene);
    w.items(rig.weights.first.data(), rig.weights.first.size());
    w.items(rig.weights.bone.data(), rig.weights.bone.size());
    w.items(rig.weights.weight.data(), rig.weights.weight.size());
    w.value(static_cast<std::uint64_t>(rig.clips.size()));
    for (const RigClip& clip : rig.clips) {
        w.text(clip.name);
        w.value(clip.seconds);
        w.value(static_cast<std::uint64_t>(clip.tracks.size()));
        for (const RigTrack& track : clip.tracks) {
            w.value(track.node);
            w.value(static_cast<std::uint8_t>(track.path));
            w.value(static_cast<std::uint8_t>(track.interpolation));
            w.items(track.times.data(), track.times.size());
            w.items(track.values.data(), track.values.size());
        }
        w.value(static_cast<std::uint64_t>(clip.morphs.size()));
        for (const MorphTrack& track : clip.morphs) {
            w.text(track.target);
            w.value(static_cast<std::uint8_t>(track.interpolation));
            w.items(track.times.data(), track.times.size());
            w.items(track.weights.data(), track.weights.size());
        }
    }
}

void readRig(MessageReader& r, std::size_t vertices, Rig& rig) {
    const std::size_t bones = r.count(1);
    for (std::size_t i = 0; i < bones && r.good(); ++i) {
        RigBone& bone = rig.bones.emplace_back();
        bone.name = cleanName(r.text(), "");
        bone.parent = r.value<std::int32_t>();
        bone.node = r.value<std::int32_t>();
        bone.head = readPlace(r);
        bone.tail = readPlace(r);
        bone.rotation = readRotation(r);
    }
    const std::size_t nodes = r.count(1);
    for (std::size_t i = 0; i < nodes && r.good(); ++i) {
        RigNode& node = rig.nodes.emplace_back();
        node.parent = r.value<std::int32_t>();
        node.translation = readPlace(r);
        node.rotation = readRotation(r);
        node.scale = readPlace(r);
        node.name = cleanName(r.text(), "");
    }
    Four scene;  // columns
    r.matrix(scene);
    if (scene.rows() != 4) r.refuse();
    if (r.good()) rig.toScene = scene.transpose();
    rig.weights.first = r.items<std::int32_t>();
    rig.weights.bone = r.items<std::int32_t>();
    rig.weights.weight = r.items<float>();
    const std::size_t clips = r.count(1);
    for (std::size_t i = 0; i < clips && r.good(); ++i) {
        RigClip& clip = rig.clips.emplace_back();
        clip.name = cleanName(r.text(), "");
        clip.seconds = r.value<double>();
        const std::size_t tracks = r.count(1);
        for (std::size_t t = 0; t < tracks && r.good(); ++t) {
            RigTrack& track = clip.tracks.emplace_back();
            track.node = r.value<std::int32_t>();
            const auto path = r.value<std::uint8_t>(), interpolation = r.value<std::uint8_t>();
            if (path > static_cast<std::uint8_t>(RigTrack::Path::Scale) || interpolation > static_cast<std::uint8_t>(RigTrack::Interpolation::Cubic)) r.refuse();
            track.path = static_cast<RigTrack::Path>(path);
            track.interpolation = static_cast<RigTrack::Interpolation>(interpolation);
            track.times = r.items<double>();
            track.values = r.items<double>();
        }
        const std::size_t morphs = r.count(1);
        for (std::size_t t = 0; t < morphs && r.good(); ++t) {
            MorphTrack& track = clip.morphs.emplace_back();
            track.target = cleanName(r.text(), "");
            const auto interpolation = r.value<std::uint8_t>();
            if (interpolation > static_cast<std::uint8_t>(RigTrack::Interpolation::Cubic)) r.refuse();
            track.interpolation = static_cast<RigTrack::Interpolation>(interpolation);
            track.times = r.items<double>();
            track.weights = r.items<double>();
        }
    }
    if (r.good() && !checkRig(rig, vertices).empty()) r.refuse();
}

}  // namespace imomushi
