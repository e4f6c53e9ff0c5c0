// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/body/body.h"
#include "core/body/cut.h"
#include "core/mesh/mesh_codec.h"

// The members of bodies and cuts as messages to and from workers carry them (core/worker/codec.h).
namespace imomushi {

constexpr BodyKind lastOf(BodyKind) { return BodyKind::Wrapped; }

void members(auto& archive, ClosedGaps& g) { archive(g.area, g.widest, g.narrowest, g.places); }
void members(auto& archive, FleshLink& l) { archive(l.from, l.to, l.radius, l.volume); }
void members(auto& archive, BodySetting& s) { archive(s.how, s.detail, s.links); }
void members(auto& archive, BodyBones& b) { archive(b.bone, b.parent); }
void members(auto& archive, BodyReport& r) { archive(r.how, r.distanceRms, r.distanceLargest, r.volumeError, r.gaps, r.links, r.detail, r.components, r.seconds, r.issues); }
void members(auto& archive, Body& b) { archive(b.mesh, b.bodyVertex, b.report); }
inline bool sound(const Body& b) { return indicesFit(b.mesh); }

void members(auto& archive, CutPlane& p) { archive(p.origin, p.normal); }
void members(auto& archive, BodyPiece::Cap& c) { archive(c.cut, c.front, c.vertices, c.triangles, c.smallestAngle); }
void members(auto& archive, BodyPiece& p) { archive(p.body, p.source, p.sourceTriangle, p.caps); }
inline bool sound(const BodyPiece& p) { return indicesFit(p.body); }
void members(auto& archive, CutRefusal& r) { archive(r.code, r.message, r.cut, r.other, r.nearest); }

}  // namespace imomushi
