// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "core/document/command_support.h"
#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kMorphTables = R"(
CREATE TABLE morph_targets (character INTEGER, position INTEGER, name TEXT, at_rest REAL, vertices BLOB, deltas BLOB, PRIMARY KEY (character, position));
CREATE TABLE morph_weights (character INTEGER, target INTEGER, weight REAL, PRIMARY KEY (character, target));
)";

}  // namespace

void createMorphTables(Database& db) { db.run(kMorphTables); }

void writeMorphs(Database& db, const Document& document) {
    RowWriter targets(db, "INSERT INTO morph_targets VALUES (?,?,?,?,?,?)");
    for (const auto& [id, character] : document.characters)
        for (std::size_t i = 0; i < character->model->morphs.size(); ++i) {
            const MorphTarget& t = character->model->morphs[i];
            targets.row(id, i, t.name, t.atRest, t.vertices, t.deltas);
        }
    RowWriter weights(db, "INSERT INTO morph_weights VALUES (?,?,?)");
    for (const auto& [ref, weight] : document.morphs) weights.row(ref.character, ref.target, weight);
}

void readMorphs(Database& db, Document& document) {
    std::map<PartId, std::vector<MorphTarget>> read;
    RowReader targets(db, "SELECT * FROM morph_targets ORDER BY character, position");
    while (targets.next()) {
        const PartId id = readId(targets);
        require(document.characters.contains(id), "a morph target belongs to no character");
        readPosition(targets, read[id].size());
        MorphTarget& t = read[id].emplace_back();
        readColumns(targets, t.name, t.atRest, t.vertices, t.deltas);
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

}  // namespace imomushi
