// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/mesh/health.h"
#include "core/mesh/mesh.h"
#include "core/mesh/rig.h"

// The members of meshes and rigs as messages to and from workers carry them (core/worker/codec.h).
namespace imomushi {

constexpr Severity lastOf(Severity) { return Severity::Error; }
constexpr RigTrack::Path lastOf(RigTrack::Path) { return RigTrack::Path::Scale; }
constexpr RigTrack::Interpolation lastOf(RigTrack::Interpolation) { return RigTrack::Interpolation::Cubic; }

template <class Archive>
void members(Archive& archive, TriangleMesh& m) {
    archive(m.vertices, m.triangles);
}
template <class Archive>
void members(Archive& archive, MeshIssue& i) {
    archive(i.severity, i.code, i.text, i.count, i.fixed, i.triangles, i.vertices);
}
template <class Archive>
void members(Archive& archive, RigBone& b) {
    archive(b.name, b.parent, b.node, b.head, b.tail, b.rotation);
}
template <class Archive>
void members(Archive& archive, RigNode& n) {
    archive(n.parent, n.translation, n.rotation, n.scale, n.name);
}
template <class Archive>
void members(Archive& archive, RigWeights& w) {
    archive(w.first, w.bone, w.weight);
}
template <class Archive>
void members(Archive& archive, RigTrack& t) {
    archive(t.node, t.path, t.interpolation, t.times, t.values);
}
template <class Archive>
void members(Archive& archive, MorphTrack& t) {
    archive(t.target, t.interpolation, t.times, t.weights);
}
template <class Archive>
void members(Archive& archive, RigClip& c) {
    archive(c.name, c.seconds, c.tracks, c.morphs);
}
template <class Archive>
void members(Archive& archive, Rig& r) {
    archive(r.bones, r.nodes, r.toScene, r.weights, r.clips);
}

/// Whether all indices are in range.
inline bool indicesFit(const TriangleMesh& m) {
    return m.triangles.size() == 0 || (m.triangles.minCoeff() >= 0 && m.triangles.maxCoeff() < m.vertices.rows());
}

}  // namespace imomushi
