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

void members(auto& archive, ImportRequest& r) { archive(r.path, r.unit, r.up, r.split, r.bonesSuffice); }
void members(auto& archive, Material& m) { archive(m.name, m.baseColor, m.metallic, m.roughness, m.baseColorTexture); }
void members(auto& archive, Texture& t) { archive(t.name, t.mimeType, t.bytes); }
void members(auto& archive, RenderMesh& m) {
    archive(m.bodyVertex, m.triangles, m.normals, m.texCoords, m.colors, m.material, m.materials, m.textures);
}
void members(auto& archive, ElementMesh& m) { archive(m.body, m.renderMesh); }
void members(auto& archive, ImportedBody& b) { archive(b.name, b.mesh, b.issues, b.components, b.closed); }
void members(auto& archive, ImportResult& r) { archive(r.format, r.metresPerUnit, r.zUpConverted, r.bodies, r.issues); }
void members(auto& archive, MorphTarget& t) { archive(t.name, t.atRest, t.vertices, t.deltas); }
void members(auto& archive, RenderModel& m) { archive(m.mesh, m.part, m.parts, m.morphs); }
void members(auto& archive, CharacterFile& f) { archive(f.format, f.metresPerUnit, f.zUpConverted, f.renderModel, f.issues, f.rig); }

bool sound(const ImportResult& result);
bool sound(const CharacterFile& file);

}  // namespace imomushi
