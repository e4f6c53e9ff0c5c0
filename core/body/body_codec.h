// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/body/body.h"
#include "core/body/cut.h"
#include "core/mesh/mesh_codec.h"

// The members of bodies and cuts as messages to and from workers carry them (core/worker/codec.h).
namespace imomushi {

constexpr BodyKind lastOf(BodyKind) { return BodyKind::Wrapped; }

template <class Archive>
void members(Archive& archive, BodySetting& s) {
    archive(s.how, s.detail);
}
template <class Archive>
void members(Archive& archive, ClosedGaps& g) {
    archive(g.area, g.widest, g.narrowest, g.places);
}
template <class Archive>
void members(Archive& archive, BodyReport& r) {
    archive(r.how, r.distanceRms, r.distanceLargest, r.volumeError, r.gaps, r.detail, r.components, r.seconds, r.issues);
}
template <class Archive>
void members(Archive& archive, Body& b) {
    archive(b.mesh, b.bodyVertex, b.report);
}
inline bool sound(const Body& b) { return indicesFit(b.mesh); }

template <class Archive>
void members(Archive& archive, CutPlane& p) {
    archive(p.origin, p.normal);
}
template <class Archive>
void members(Archive& archive, BodyPiece::Cap& c) {
    archive(c.cut, c.front, c.vertices, c.triangles, c.smallestAngle);
}
template <class Archive>
void members(Archive& archive, BodyPiece& p) {
    archive(p.body, p.source, p.sourceTriangle, p.caps);
}
inline bool sound(const BodyPiece& p) { return indicesFit(p.body); }
template <class Archive>
void members(Archive& archive, CutRefusal& r) {
    archive(r.code, r.message, r.cut, r.other, r.nearest);
}

}  // namespace imomushi
