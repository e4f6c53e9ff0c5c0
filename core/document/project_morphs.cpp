// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "core/document/command_support.h"
#include "core/document/project_rows.h"
#include "core/document/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kMorphTables = R"(
CREATE TABLE rig_node_names (character INTEGER, node INTEGER, name TEXT, PRIMARY KEY (character, node));
CREATE TABLE morph_targets (character INTEGER, position INTEGER, name TEXT, at_rest REAL, vertices BLOB, deltas BLOB, PRIMARY KEY (character, position));
CREATE TABLE morph_weights (character INTEGER, target INTEGER, weight REAL, PRIMARY KEY (character, target));
CREATE TABLE take_morphs (take INTEGER PRIMARY KEY, morphs INTEGER);
)";

constexpr const char* kTrackTable =
    "CREATE TABLE rig_morph_tracks (character INTEGER, clip INTEGER, position INTEGER, target TEXT, interpolation INTEGER, times BLOB, weights BLOB, PRIMARY KEY (character, clip, position));";

using Deltas = decltype(MorphTarget::deltas);

}  // namespace

void createMorphTables(Database& db) { db.run(kMorphTables); }

void writeMorphs(Database& db, const Document& document) {
    RowWriter names(db, "INSERT INTO rig_node_names VALUES (?,?,?)"), targets(db, "INSERT INTO morph_targets VALUES (?,?,?,?,?,?)");
    for (const auto& [id, character] : document.characters) {
        for (std::size_t n = 0; character->rig && n < character->rig->nodes.size(); ++n)
            if (const std::string& name = character->rig->nodes[n].name; !name.empty()) names.row(id, n, name);
        for (std::size_t i = 0; i < character->model->morphs.size(); ++i) {
            const MorphTarget& t = character->model->morphs[i];
            targets.row(id, i, t.name, t.atRest, t.vertices, t.deltas);
        }
    }
    RowWriter weights(db, "INSERT INTO morph_weights VALUES (?,?,?)");
    for (const auto& [ref, weight] : document.morphs) weights.row(ref.character, ref.target, weight);
    RowWriter takes(db, "INSERT INTO take_morphs VALUES (?,?)");
    for (const auto& [id, take] : document.takes)
        if (take->layout.morphs > 0) takes.row(id, take->layout.morphs);
}

void readMorphs(Database& db, Document& document) {
    std::map<PartId, std::vector<MorphTarget>> read;
    RowReader targets(db, "SELECT * FROM morph_targets ORDER BY character, position");
    while (targets.next()) {
        const PartId id = readId(targets);
        require(document.characters.contains(id), "a morph target belongs to no character");
        readPosition(targets, read[id].size());
        MorphTarget& t = read[id].emplace_back();
        t.name = readUtf8(targets);
        t.atRest = targets.real();
        t.vertices = targets.array<std::int32_t>();
        t.deltas = targets.matrix<Deltas>();
    }
    for (auto& [id, morphs] : read) {
        RenderModel model = *document.characters.at(id)->model;
        require(checkMorphs(morphs, static_cast<std::size_t>(model.mesh.body.vertices.rows())).empty(), "a morph target is broken");
        model.morphs = std::move(morphs);
        exchangePart(document.characters, id, [&](CharacterSource& c) { c.model = std::make_shared<const RenderModel>(std::move(model)); });
    }
    RowReader weights(db, "SELECT * FROM morph_weights ORDER BY character, target");
    while (weights.next()) {
        MorphRef ref;
        ref.character = readId(weights);
        ref.target = static_cast<std::int32_t>(weights.integer(0, std::numeric_limits<std::int32_t>::max()));
        const auto character = document.characters.find(ref.character);
        require(character != document.characters.end() && static_cast<std::size_t>(ref.target) < character->second->model->morphs.size(), "a weight belongs to no morph target");
        document.morphs.emplace(ref, weights.real(-kLargestMorphWeight, kLargestMorphWeight));
    }
}

std::map<PartId, int> readTakeMorphs(Database& db) {
    constexpr std::int64_t kMostWeights = 1'000'000;
    std::map<PartId, int> morphs;
    RowReader rows(db, "SELECT * FROM take_morphs ORDER BY take");
    while (rows.next()) {
        const PartId take = readId(rows);
        morphs.emplace(take, static_cast<int>(rows.integer(1, kMostWeights)));
    }
    return morphs;
}

std::map<PartId, std::map<std::int64_t, std::string>> readNodeNames(Database& db) {
    std::map<PartId, std::map<std::int64_t, std::string>> names;
    RowReader rows(db, "SELECT * FROM rig_node_names ORDER BY character, node");
    while (rows.next()) {
        const PartId character = readId(rows);
        const std::int64_t node = rows.integer(0, std::numeric_limits<std::int32_t>::max());
        names[character][node] = readUtf8(rows);
    }
    return names;
}

void createMorphTrackTable(Database& db) { db.run(kTrackTable); }

void writeMorphTracks(Database& db, const Document& document) {
    RowWriter tracks(db, "INSERT INTO rig_morph_tracks VALUES (?,?,?,?,?,?,?)");
    for (const auto& [id, character] : document.characters)
        for (std::size_t i = 0; character->rig && i < character->rig->clips.size(); ++i) {
            const std::vector<MorphTrack>& morphs = character->rig->clips[i].morphs;
            for (std::size_t k = 0; k < morphs.size(); ++k) tracks.row(id, i, k, morphs[k].target, static_cast<int>(morphs[k].interpolation), morphs[k].times, morphs[k].weights);
        }
}

void readMorphTracks(Database& db, std::map<PartId, Rig>& rigs) {
    RowReader tracks(db, "SELECT * FROM rig_morph_tracks ORDER BY character, clip, position");
    while (tracks.next()) {
        const auto rig = rigs.find(readId(tracks));
        require(rig != rigs.end(), "a skeleton is missing");
        const auto clip = static_cast<std::size_t>(tracks.integer(0, std::numeric_limits<std::int32_t>::max()));
        require(clip < rig->second.clips.size(), "a track belongs to no clip");
        auto& morphs = rig->second.clips[clip].morphs;
        readPosition(tracks, morphs.size());
        MorphTrack& t = morphs.emplace_back();
        t.target = readUtf8(tracks);
        t.interpolation = static_cast<RigTrack::Interpolation>(tracks.integer(0, static_cast<int>(RigTrack::Interpolation::Cubic)));
        t.times = tracks.array<double>();
        t.weights = tracks.array<double>();
    }
}

}  // namespace imomushi
