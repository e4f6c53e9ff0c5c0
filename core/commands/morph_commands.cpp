// SPDX-License-Identifier: GPL-3.0-or-later
// Weights of morph targets.
#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/document/morph_weights.h"
#include "core/live/live_character.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

Result<Json> morph(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto ref, morphOf(document, text(arguments, "character"), text(arguments, "target")));
    IMOMUSHI_TRY(const auto weight, numberWithin(arguments.at("weight"), "weight", -kLargestMorphWeight, kLargestMorphWeight));
    if (weight == document.characters.at(ref.character)->model->morphs[static_cast<std::size_t>(ref.target)].atRest)
        document.morphs.erase(ref);
    else
        document.morphs.insert_or_assign(ref, weight);
    return Json{{"weight", weight}};
}

Result<Json> showMorph(LiveCharacter& live, const Json&, Json answer) {
    if (auto alive = live.built(); !alive) return tl::unexpected(alive.error());
    live.showPose();
    return answer;
}

}  // namespace

Json morphsJson(const Document& document, const CharacterSource& character) {
    Json out = Json::array();
    for (std::size_t t = 0; t < character.model->morphs.size(); ++t) {
        const MorphTarget& target = character.model->morphs[t];
        out.push_back({{"name", target.name}, {"weight", morphWeight(document, character, static_cast<int>(t))}, {"at_rest", target.atRest}, {"vertices", target.vertices.size()}});
    }
    return out;
}

void addMorphCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("morph",
                       "Sets the weight of a morph target that came with a character's file (a smile, a blink). It moves vertices at rest; the body carries that along, turned and "
                       "stretched as its surface is. Takes record it, and exports have the targets.",
                       {{"character", Type::Text, true, "The character."},
                        {"target", Type::Text, true, "The morph target by its name in the file; open and list tell them in \"morphs\"."},
                        {"weight", Type::Number, true, "How much of it is added: 0 nothing, 1 all of it; files mean 0 to 1, others are allowed."}},
                       morph, showMorph);
}

}  // namespace imomushi
