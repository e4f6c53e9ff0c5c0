// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <map>

#include "core/document/command_support.h"
#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kRigTables = R"(
CREATE TABLE rigs (character INTEGER PRIMARY KEY, to_scene BLOB, first BLOB, bone BLOB, weight BLOB, avatar TEXT);
CREATE TABLE rig_bones (character INTEGER, position INTEGER, name TEXT, parent INTEGER, node INTEGER, head BLOB, tail BLOB, rotation BLOB, PRIMARY KEY (character, position));
CREATE TABLE rig_nodes (character INTEGER, position INTEGER, name TEXT, parent INTEGER, translation BLOB, rotation BLOB, scale BLOB, PRIMARY KEY (character, position));
CREATE TABLE rig_roles (character INTEGER, position INTEGER, role TEXT, bone INTEGER, PRIMARY KEY (character, position));
CREATE TABLE rig_clips (character INTEGER, position INTEGER, name TEXT, seconds REAL, PRIMARY KEY (character, position));
CREATE TABLE rig_tracks (character INTEGER, clip INTEGER, position INTEGER, node INTEGER, path INTEGER, interpolation INTEGER, times BLOB, numbers BLOB,
    PRIMARY KEY (character, clip, position));
CREATE TABLE rig_morph_tracks (character INTEGER, clip INTEGER, position INTEGER, target TEXT, interpolation INTEGER, times BLOB, weights BLOB, PRIMARY KEY (character, clip, position));
)";

constexpr std::int32_t kLargestIndex = std::numeric_limits<std::int32_t>::max();

/// As the file has it: coordinates may be larger than those of a document.
Vec3 readFilePoint(RowReader& row) {
    const auto v = row.array<double>(3);
    require(v.size() == 3, "a bone is broken");
    return {v[0], v[1], v[2]};
}

}  // namespace

void createRigTables(Database& db) { db.run(kRigTables); }

void writeRigs(Database& db, const Document& document) {
    RowWriter rigs(db, "INSERT INTO rigs VALUES (?,?,?,?,?,?)"), bones(db, "INSERT INTO rig_bones VALUES (?,?,?,?,?,?,?,?)"), nodes(db, "INSERT INTO rig_nodes VALUES (?,?,?,?,?,?,?)"),
        roles(db, "INSERT INTO rig_roles VALUES (?,?,?,?)"), clips(db, "INSERT INTO rig_clips VALUES (?,?,?,?)"), tracks(db, "INSERT INTO rig_tracks VALUES (?,?,?,?,?,?,?,?)"),
        morphs(db, "INSERT INTO rig_morph_tracks VALUES (?,?,?,?,?,?,?)");
    for (const auto& [id, character] : document.characters) {
        if (!character->rig) continue;
        const Rig& rig = *character->rig;
        rigs.row(id, rig.toScene, rig.weights.first, rig.weights.bone, rig.weights.weight, rig.avatar);
        for (std::size_t i = 0; i < rig.bones.size(); ++i) {
            const RigBone& b = rig.bones[i];
            bones.row(id, i, b.name, b.parent, b.node, b.head, b.tail, b.rotation.coeffs());
        }
        for (std::size_t i = 0; i < rig.nodes.size(); ++i) nodes.row(id, i, rig.nodes[i].name, rig.nodes[i].parent, rig.nodes[i].translation, rig.nodes[i].rotation.coeffs(), rig.nodes[i].scale);
        for (std::size_t i = 0; i < rig.roles.size(); ++i) roles.row(id, i, rig.roles[i].role, rig.roles[i].bone);
        for (std::size_t i = 0; i < rig.clips.size(); ++i) {
            clips.row(id, i, rig.clips[i].name, rig.clips[i].seconds);
            for (std::size_t k = 0; k < rig.clips[i].tracks.size(); ++k) {
                const RigTrack& t = rig.clips[i].tracks[k];
                tracks.row(id, i, k, t.node, static_cast<int>(t.path), static_cast<int>(t.interpolation), t.times, t.values);
            }
            for (std::size_t k = 0; k < rig.clips[i].morphs.size(); ++k) {
                const MorphTrack& t = rig.clips[i].morphs[k];
                morphs.row(id, i, k, t.target, static_cast<int>(t.interpolation), t.times, t.weights);
            }
        }
    }
}

void readRigs(Database& db, Document& document) {
    std::map<PartId, Rig> read;
    RowReader rigs(db, "SELECT * FROM rigs ORDER BY character");
    while (rigs.next()) {
        const PartId id = readId(rigs);
        require(document.characters.contains(id), "a skeleton belongs to no character");
        Rig& rig = read[id];
        const auto place = rigs.array<double>(16);
        require(place.size() == 16, "a skeleton is broken");
        rig.toScene = Eigen::Map<const Eigen::Matrix4d>(place.data());
        readColumns(rigs, rig.weights.first, rig.weights.bone, rig.weights.weight, rig.avatar);
    }
    const auto rigAt = [&](PartId id) -> Rig& {
        const auto found = read.find(id);
        require(found != read.end(), "a skeleton is missing");
        return found->second;
    };
    RowReader bones(db, "SELECT * FROM rig_bones ORDER BY character, position");
    while (bones.next()) {
        Rig& rig = rigAt(readId(bones));
        readPosition(bones, rig.bones.size());
        RigBone& b = rig.bones.emplace_back();
        readColumns(bones, b.name, Within{b.parent, -1, kLargestIndex}, Within{b.node, 0, kLargestIndex}, b.head, b.tail, b.rotation);
    }
    RowReader nodes(db, "SELECT * FROM rig_nodes ORDER BY character, position");
    while (nodes.next()) {
        Rig& rig = rigAt(readId(nodes));
        readPosition(nodes, rig.nodes.size());
        RigNode& n = rig.nodes.emplace_back();
        readColumns(nodes, n.name, Within{n.parent, -1, kLargestIndex});
        n.translation = readFilePoint(nodes);
        readColumns(nodes, n.rotation);
        n.scale = readFilePoint(nodes);
    }
    RowReader roles(db, "SELECT * FROM rig_roles ORDER BY character, position");
    while (roles.next()) {
        Rig& rig = rigAt(readId(roles));
        readPosition(roles, rig.roles.size());
        RigRole& r = rig.roles.emplace_back();
        readColumns(roles, r.role, Within{r.bone, 0, kLargestIndex});
    }
    RowReader clips(db, "SELECT * FROM rig_clips ORDER BY character, position");
    while (clips.next()) {
        Rig& rig = rigAt(readId(clips));
        readPosition(clips, rig.clips.size());
        RigClip& c = rig.clips.emplace_back();
        readColumns(clips, c.name, c.seconds);
    }
    RowReader tracks(db, "SELECT * FROM rig_tracks ORDER BY character, clip, position");
    while (tracks.next()) {
        Rig& rig = rigAt(readId(tracks));
        const auto clip = static_cast<std::size_t>(tracks.integer(0, kLargestIndex));
        require(clip < rig.clips.size(), "a track belongs to no clip");
        readPosition(tracks, rig.clips[clip].tracks.size());
        RigTrack& t = rig.clips[clip].tracks.emplace_back();
        readColumns(tracks, Within{t.node, 0, kLargestIndex}, Within{t.path, RigTrack::Path::Translation, RigTrack::Path::Scale},
                    Within{t.interpolation, RigTrack::Interpolation::Step, RigTrack::Interpolation::Cubic}, t.times, t.values);
    }
    RowReader morphs(db, "SELECT * FROM rig_morph_tracks ORDER BY character, clip, position");
    while (morphs.next()) {
        Rig& rig = rigAt(readId(morphs));
        const auto clip = static_cast<std::size_t>(morphs.integer(0, kLargestIndex));
        require(clip < rig.clips.size(), "a track belongs to no clip");
        readPosition(morphs, rig.clips[clip].morphs.size());
        MorphTrack& t = rig.clips[clip].morphs.emplace_back();
        readColumns(morphs, t.target, Within{t.interpolation, RigTrack::Interpolation::Step, RigTrack::Interpolation::Cubic}, t.times, t.weights);
    }
    for (auto& [id, rig] : read) {
        require(checkRig(rig, static_cast<std::size_t>(document.characters.at(id)->model->mesh.body.vertices.rows())).empty(), "a skeleton is broken");
        exchangePart(document.characters, id, [&](CharacterSource& c) { c.rig = std::make_shared<const Rig>(std::move(rig)); });
    }
}

}  // namespace imomushi
