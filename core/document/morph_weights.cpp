// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/morph_weights.h"

#include "core/document/command_support.h"

namespace imomushi {

Result<MorphRef> morphOf(const Document& document, std::string_view characterName, std::string_view target) {
    IMOMUSHI_TRY(const auto character, characterOf(document, characterName));
    const RenderModel& model = *character->model;
    if (model.morphs.empty()) return fail("no-such-target", "The file of \"" + character->name + "\" brought no morph targets.");
    const int index = model.morphIndex(target);
    if (index >= 0) return MorphRef{character->id, index};
    std::string known;
    for (const MorphTarget& t : model.morphs) known += (known.empty() ? "\"" : ", \"") + t.name + "\"";
    return fail("no-such-target", "\"" + character->name + "\" has no morph target \"" + std::string(target) + "\"; it has " + known + ".");
}

double morphWeight(const Document& document, const CharacterSource& character, int target) {
    const auto set = document.morphs.find({character.id, target});
    return set == document.morphs.end() ? character.model->morphs[static_cast<std::size_t>(target)].atRest : set->second;
}

}  // namespace imomushi
