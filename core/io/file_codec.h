// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/io/character_file.h"
#include "core/io/import.h"
#include "core/mesh/mesh_codec.h"
#include "core/worker/codec.h"

// The members of what is read from files, as messages from workers carry them (core/worker/codec.h). Whoever asked believes nothing: every index and number is checked before use.
namespace imomushi {

constexpr Unit lastOf(Unit) { return Unit::Metre; }
constexpr UpAxis lastOf(UpAxis) { return UpAxis::Z; }

template <class Archive>
void members(Archive& archive, ImportRequest& r) {
    archive(r.path, r.unit, r.up, r.split, r.bonesSuffice);
}
template <class Archive>
void members(Archive& archive, Material& m) {
    archive(m.name, m.baseColor, m.metallic, m.roughness, m.baseColorTexture);
}
template <class Archive>
void members(Archive& archive, Texture& t) {
    archive(t.name, t.mimeType, t.bytes);
}
template <class Archive>
void members(Archive& archive, RenderMesh& m) {
    archive(m.bodyVertex, m.triangles, m.normals, m.texCoords, m.colors, m.material, m.materials, m.textures);
}
template <class Archive>
void members(Archive& archive, ElementMesh& m) {
    archive(m.body, m.renderMesh);
}
template <class Archive>
void members(Archive& archive, ImportedBody& b) {
    archive(b.name, b.mesh, b.issues, b.components, b.closed);
}
template <class Archive>
void members(Archive& archive, ImportResult& r) {
    archive(r.format, r.metresPerUnit, r.zUpConverted, r.bodies, r.issues);
}
template <class Archive>
void members(Archive& archive, MorphTarget& t) {
    archive(t.name, t.atRest, t.vertices, t.deltas);
}
template <class Archive>
void members(Archive& archive, RenderModel& m) {
    archive(m.mesh, m.part, m.parts, m.morphs);
}
template <class Archive>
void members(Archive& archive, CharacterFile& f) {
    archive(f.format, f.metresPerUnit, f.zUpConverted, f.renderModel, f.issues, f.rig);
}

bool sound(const ImportResult& result);
bool sound(const CharacterFile& file);

}  // namespace imomushi
