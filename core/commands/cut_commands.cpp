// SPDX-License-Identifier: GPL-3.0-or-later
#include <set>
#include <string_view>

#include "core/commands/core_commands.h"
#include "core/document/character_cuts.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/session/document_edit.h"

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

/// What is cut: a whole character, or an element, which becomes one where it is none yet.
struct Target {
    PartId character = 0, element = 0;
    bool isNew = false;
};
Result<Target> targetFrom(Document& document, const std::string& name) {
    Target target;
    if (const CharacterSource* whole = document.characterNamed(name)) {
        target.character = whole->id;
        return target;
    }
    IMOMUSHI_TRY(const auto found, elementOf(document, name));
    target.element = found->id;
    if (found->piece) target.character = found->piece->character;
    target.isNew = target.character == 0;
    if (target.isNew) target.character = makeCharacter(document, target.element, {});
    return target;
}
/// A character that was an element is called like it, where no piece is.
void nameCharacter(Document& document, const Target& target, const std::string& element) {
    if (!target.isNew) return;
    const std::string name = checkNewName(document, element) ? element : freeName(document, "whole " + element);
    exchangePart(document.characters, target.character, [&](CharacterSource& changed) { changed.name = name; });
}

Json madeJson(const Document& document, const MadeCut& made) {
    const CharacterSource& source = *document.characters.at(made.character);
    Json answer{{"elements", Json::array()}, {"faces", Json::array()}};
    for (std::size_t i = 0; i < 2; ++i) {
        answer["elements"].push_back(document.elements.at(made.elements[i])->name);
        answer["faces"].push_back(faceText(document, {made.elements[i], made.faces[i]}));
    }
    answer["cut"] = source.cuts[static_cast<std::size_t>(source.cutIndex(made.cut))].name;
    answer["smallest_angle"] = made.smallestAngle;
    return answer;
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

    const std::string& called = text(arguments, "element");
    IMOMUSHI_TRY(const Target target, targetFrom(document, called));
    const Element* named = names[0].empty() ? nullptr : document.elementNamed(names[0]);
    const PartId holder = named ? named->id : 0;
    IMOMUSHI_TRY(const auto done, addCut(document, target.character, target.element, std::move(made), names, progress));
    if (holder != 0 && holder != done.elements[0])
        return fail("name-taken", "The name \"" + names[0] + "\" is taken by an element that is not cut: choose another.");
    nameCharacter(document, target, called);
    Json answer = madeJson(document, done);
    answer["character"] = document.characters.at(target.character)->name;
    return answer;
}

Result<Json> cutAll(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    const Json& list = arguments.at("cuts");
    if (list.empty()) return fail("bad-value", "\"cuts\" must name at least one plane.");
    std::vector<NewCut> wanted;
    std::set<std::string> taken;
    for (const Json& line : list) {
        if (!line.is_object() || !line.contains("plane") || !line["plane"].is_object()) return fail("missing-key", "Each of \"cuts\" needs the key \"plane\".");
        for (const auto& [key, value] : line.items())
            if (key != "plane" && key != "name" && key != "piece") return fail("unknown-key", "A cut has the keys \"plane\", \"name\" and \"piece\", not \"" + key + "\".");
        NewCut next;
        IMOMUSHI_TRY(next.cut.plane, cutPlaneFrom(line));
        for (const char* key : {"name", "piece"}) {
            const Json* name = find(line, key);
            if (!name) continue;
            if (!name->is_string()) return fail("bad-type", std::string("\"") + key + "\" must be a text.");
            std::string& to = std::string_view(key) == "name" ? next.cut.name : next.names[1];
            to = name->get<std::string>();
            if (auto ok = checkNewName(document, to); !ok) return tl::unexpected(ok.error());
            if (!taken.insert(to).second) return fail("name-taken", "The name \"" + to + "\" is given twice: choose another.");
        }
        wanted.push_back(std::move(next));
    }
    const std::string& called = text(arguments, "element");
    IMOMUSHI_TRY(const Target target, targetFrom(document, called));
    IMOMUSHI_TRY(const auto done, addCuts(document, target.character, target.element, std::move(wanted), true, progress));
    nameCharacter(document, target, called);
    Json answer{{"character", document.characters.at(target.character)->name}, {"cuts", Json::array()}, {"refused", Json::array()}};
    for (const auto& made : done.made) answer["cuts"].push_back(made ? madeJson(document, *made) : Json());
    for (const auto& refused : done.refused) answer["refused"].push_back({{"cut", refused.cut}, {"code", refused.why.code}, {"text", refused.why.message}});
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

/// An element by itself becomes what an import as a whole character would have made of it.
Result<Json> makeCharacterCommand(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto found, elementOf(document, text(arguments, "element")));
    const PartId id = found->id;
    const std::string name = found->name;
    if (found->piece)
        return fail("part-of-character", "The element \"" + name + "\" is a piece of the character \"" + document.characters.at(found->piece->character)->name + "\" already.");
    const PartId character = makeCharacter(document, id, {});
    const std::string body = freeName(document, name + " body");
    exchangePart(document.elements, id, [&](Element& changed) { changed.name = body; });
    exchangePart(document.characters, character, [&](CharacterSource& changed) { changed.name = name; });
    return characterJson(document, *document.characters.at(character));
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
    registry.addChange("cut-all", "Cuts an element by several planes together, as \"cut\" does by one: where they lie to each other matters only once all are made. Cuts that are refused are left out, as long as one is made.",
                       {{"element", Type::Text, true, "The element, or a character: whichever of its elements the planes cut."},
                        {"cuts", Type::Array, true, "[{\"plane\": as for \"cut\", \"name\": of the cut, \"piece\": of the element in front}, ...]; names may be left out."}},
                       cutAll);
    registry.addChange("move-cut",
                       "Gives a cut another plane. Only the two elements beside it change; their bones, joint faces and names stay, and what ends at the cut follows it. The same elements "
                       "stay in front, whichever way the normal points.",
                       {cutKey, {"plane", Type::Object, true, plane}}, moveCutCommand);
    registry.addChange("make-character",
                       "Makes an element of its own a whole character, as import-character would have made of its file: what is seen stays, the element is its body. Joint faces, handles and bones "
                       "stay.",
                       {{"element", Type::Text, true, "The element, which is called after the character from then on; the character has its name."}}, makeCharacterCommand);
    registry.addChange("remove-cut", "Takes a cut out: the element behind it takes in the one in front, with its other joint faces and its bones.", {cutKey}, removeCutCommand);
}

}  // namespace imomushi
