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

void members(auto& archive, TriangleMesh& m) { archive(m.vertices, m.triangles); }
void members(auto& archive, MeshIssue& i) { archive(i.severity, i.code, i.text, i.count, i.fixed, i.triangles, i.vertices); }
void members(auto& archive, RigBone& b) { archive(b.name, b.parent, b.node, b.head, b.tail, b.rotation); }
void members(auto& archive, RigNode& n) { archive(n.parent, n.translation, n.rotation, n.scale, n.name); }
void members(auto& archive, RigWeights& w) { archive(w.first, w.bone, w.weight); }
void members(auto& archive, RigTrack& t) { archive(t.node, t.path, t.interpolation, t.times, t.values); }
void members(auto& archive, MorphTrack& t) { archive(t.target, t.interpolation, t.times, t.weights); }
void members(auto& archive, RigClip& c) { archive(c.name, c.seconds, c.tracks, c.morphs); }
void members(auto& archive, RigRole& r) { archive(r.role, r.bone); }
void members(auto& archive, Rig& r) { archive(r.bones, r.nodes, r.toScene, r.weights, r.clips, r.roles, r.avatar); }

/// Whether all indices are in range.
inline bool indicesFit(const TriangleMesh& m) {
    return m.triangles.size() == 0 || (m.triangles.minCoeff() >= 0 && m.triangles.maxCoeff() < m.vertices.rows());
}

}  // namespace imomushi
