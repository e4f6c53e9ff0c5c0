// SPDX-License-Identifier: GPL-3.0-or-later

#include "core/document/character_cuts.h"
#include "core/document/command_support.h"
#include "core/document/document_edit.h"
#include "core/document/names.h"

namespace imomushi {

namespace {

/// The names of the two pieces, behind first; empty ones where none are given. Those that only an element may have that is being cut are not checked: see checkOwnName().
Result<std::array<std::string, 2>> namesFrom(const Document& document, const Json& arguments) {
    std::array<std::string, 2> names;
    const Json* given = find(arguments, "names");
    if (!given) return names;
    if (given->size() != 2 || !(*given)[0].is_string() || !(*given)[1].is_string())
        return fail("bad-type", "\"names\" must be two texts: the element behind the plane, then the one in front of it.");
    for (std::size_t i = 0; i < 2; ++i) names[i] = (*given)[i].get<std::string>();
    if (names[0] == names[1]) return fail("name-taken", "Both pieces cannot be called \"" + names[0] + "\": give them different names.");
    for (std::size_t i = 0; i < 2; ++i)
        if (i == 1 || !document.elementNamed(names[i]))
            if (auto ok = checkNewName(document, names[i]); !ok) return tl::unexpected(ok.error());
    return names;
}

Result<std::pair<std::shared_ptr<const CharacterSource>, const Cut*>> cutOf(const Document& document, const std::string& name) {
    if (const CharacterSource* character = document.characterOfCut(name))
        return std::pair(document.characters.at(character->id), &character->cuts[static_cast<std::size_t>(character->cutIndex(name))]);
    std::vector<std::string> names;
    for (const auto& [id, character] : document.characters)
        for (const Cut& cut : character->cuts) names.push_back(cut.name);
    return fail("no-such-cut", "There is no cut \"" + name + "\"; " + listNames(names) + ".");
}

Result<CutPlane> cutPlaneFrom(const Json& arguments) {
    IMOMUSHI_TRY(const auto plane, planeFrom(arguments.at("plane")));
    return CutPlane{plane.origin(), plane.normal()};
}

Result<Json> cut(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto plane, cutPlaneFrom(arguments));
    IMOMUSHI_TRY(const auto names, namesFrom(document, arguments));
    Cut made;
    made.plane = plane;
    if (const Json* name = find(arguments, "name")) {
        made.name = name->get<std::string>();
        if (auto ok = checkNewName(document, made.name); !ok) return tl::unexpected(ok.error());
        if (made.name == names[0] || made.name == names[1]) return fail("name-taken", "A cut cannot be called like a piece, \"" + made.name + "\": choose another name.");
    }

    const std::string& target = text(arguments, "element");
    PartId element = 0, character = 0;
    if (const CharacterSource* whole = document.characterNamed(target)) {
        character = whole->id;
    } else {
        IMOMUSHI_TRY(const auto found, elementOf(document, target));
        element = found->id;
        if (found->piece) character = found->piece->character;
    }
    const bool isNew = character == 0;
    if (isNew) character = makeCharacter(document, element, {});
    const Element* named = names[0].empty() ? nullptr : document.elementNamed(names[0]);
    const PartId holder = named ? named->id : 0;
    IMOMUSHI_TRY(const auto done, addCut(document, character, element, std::move(made), names, progress));
    if (holder != 0 && holder != done.elements[0])
        return fail("name-taken", "The name \"" + names[0] + "\" is taken by an element that is not cut: choose another.");
    if (isNew) {
        const std::string name = checkNewName(document, target) ? target : freeName(document, "whole " + target);
        exchangePart(document.characters, character, [&](CharacterSource& changed) { changed.name = name; });
    }

    const CharacterSource& source = *document.characters.at(character);
    Json answer{{"elements", Json::array()}, {"faces", Json::array()}};
    for (std::size_t i = 0; i < 2; ++i) {
        answer["elements"].push_back(document.elements.at(done.elements[i])->name);
        answer["faces"].push_back(faceText(document, {done.elements[i], done.faces[i]}));
    }
    answer["cut"] = source.cuts[static_cast<std::size_t>(source.cutIndex(done.cut))].name;
    answer["character"] = source.name;
    answer["smallest_angle"] = done.smallestAngle;
    return answer;
}

Result<Json> moveCutCommand(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto found, cutOf(document, text(arguments, "cut")));
    IMOMUSHI_TRY(const auto plane, cutPlaneFrom(arguments));
    IMOMUSHI_TRY(const auto changed, moveCut(document, found.first->id, found.second->id, plane, progress));
    Json stale = Json::array();
    for (const PartId id : changed) stale.push_back(document.elements.at(id)->name);
    return Json{{"stale", std::move(stale)}};
}

Result<Json> removeCutCommand(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto found, cutOf(document, text(arguments, "cut")));
    IMOMUSHI_TRY(const auto changed, removeCut(document, found.first->id, found.second->id, progress));
    return Json{{"stale", Json::array({document.elements.at(changed)->name})}};
}

}  // namespace

void addCutCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey cutKey{"cut", Type::Text, true, "The cut."};
    const char* plane = "{\"origin\": [x,y,z], \"normal\": [x,y,z]}, metres; the origin lies in the section that is meant.";
    registry.addChange("cut",
                       "Cuts an element by a plane, across the one section nearest to its origin, closes both pieces there and joins them. The piece behind the plane goes on as the "
                       "element that it was, with its bones but for those that lie wholly in front. The cut stays one that can be moved and taken out; what is seen is never cut.",
                       {{"element", Type::Text, true, "The element, or a character: whichever of its elements the plane cuts."},
                        {"plane", Type::Object, true, plane},
                        {"names", Type::Array, false, "Names of the two pieces, the one behind the plane first (the element's, and that with the next number)."},
                        {"name", Type::Text, false, "A name for the cut (after the piece in front where names are given, else \"cut 1\", ...)."}},
                       cut);
    registry.addChange("move-cut",
                       "Gives a cut another plane. Only the two elements beside it change; their bones, joint faces and names stay, and what ends at the cut follows it. The same elements "
                       "stay in front, whichever way the normal points.",
                       {cutKey, {"plane", Type::Object, true, plane}}, moveCutCommand);
    registry.addChange("remove-cut", "Takes a cut out: the element behind it takes in the one in front, with its other joint faces and its bones.", {cutKey}, removeCutCommand);
}

}  // namespace imomushi
