// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/selection_commands.h"

#include <QCoreApplication>
#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <set>

#include "core/document/character_input.h"
#include "core/document/kept_pose.h"
#include "ui/models/commands.h"
#include "ui/models/gesture.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"

namespace imomushi {

using Kind = SelectionItem::Kind;

namespace {

/// Everything of the kind of what was selected last: bones, joint faces, handles, cuts, or elements.
std::vector<SelectionItem> allAlike(const StudioDocument& document) {
    const Document& d = document.document();
    Kind kind = document.selection().empty() ? Kind::Element : document.selection().back().kind;
    if (kind == Kind::Endpoint) kind = Kind::Bone;
    const bool handles = kind == Kind::Face && handleOf(d, document.selection().back());
    std::vector<SelectionItem> items;
    const auto add = [&](const auto& part, SelectionItem item) {
        if (shown(part).picked()) items.push_back(std::move(item));
    };
    if (kind == Kind::Bone) {
        for (const auto& [id, bone] : d.bones) add(*bone, {kind, id, {}, false});
    } else if (kind == Kind::Cut) {
        for (const auto& [id, character] : d.characters)
            for (const Cut& cut : character->cuts) add(cut, {kind, cut.id, {}, false});
    } else {
        for (const auto& [id, element] : d.elements) {
            if (kind != Kind::Face) add(*element, {Kind::Element, id, {}, false});
            else if (shown(*element).picked())
                for (const JointFace& face : element->faces)
                    if ((element->handleOf(face.name) != nullptr) == handles) add(face, {kind, id, face.name, false});
        }
    }
    return items;
}

}  // namespace

void selectAll(StudioDocument& document) { document.select(allAlike(document)); }

namespace {

/// The bones that are selected, or have an end that is.
std::set<PartId> bonesSelected(const StudioDocument& document) {
    std::set<PartId> bones;
    for (const SelectionItem& item : document.selection())
        if (item.kind == Kind::Bone || item.kind == Kind::Endpoint) bones.insert(item.part);
    return bones;
}

void selectBones(StudioDocument& document, const std::set<PartId>& bones) {
    std::vector<SelectionItem> items;
    for (const PartId id : bones) items.push_back({Kind::Bone, id, {}, false});
    document.select(std::move(items));
}

}  // namespace

void invertSelection(StudioDocument& document) {
    std::vector<SelectionItem> items = allAlike(document);
    const std::set<PartId> bones = bonesSelected(document);
    std::erase_if(items, [&](const SelectionItem& item) { return item.kind == Kind::Bone ? bones.contains(item.part) : document.isSelected(item); });
    document.select(std::move(items));
}

void growSelection(StudioDocument& document) {
    const Document& d = document.document();
    const Session& session = document.session();
    if (std::set<PartId> bones = bonesSelected(document); !bones.empty()) {
        std::set<int> points;
        for (const PartId id : bones)
            for (const bool atEnd : {false, true}) points.insert(session.pointIndex({id, atEnd}));
        points.erase(-1);
        for (const auto& [id, bone] : d.bones)
            if (points.contains(session.pointIndex({id, false})) || points.contains(session.pointIndex({id, true}))) bones.insert(id);
        return selectBones(document, bones);
    }
    auto items = document.selection();
    const auto selected = items;
    for (const auto& [id, joint] : d.joints) {
        const auto has = [&](const FaceRef& face) { return std::find(selected.begin(), selected.end(), SelectionItem{Kind::Element, face.element, {}, false}) != selected.end(); };
        if (std::none_of(joint->faces.begin(), joint->faces.end(), has)) continue;
        for (const FaceRef& face : joint->faces)
            if (const SelectionItem item{Kind::Element, face.element, {}, false}; std::find(items.begin(), items.end(), item) == items.end()) items.push_back(item);
    }
    document.select(std::move(items));
}

void selectChain(StudioDocument& document) {
    const std::set<PartId> bones = withChains(document.session().plan(), bonesSelected(document));
    if (!bones.empty()) selectBones(document, bones);
}

namespace {

/// Each part that is selected, an end as its bone, a character as its elements.
std::vector<SelectionItem> partsSelected(const StudioDocument& document) {
    const Document& d = document.document();
    std::vector<SelectionItem> parts;
    const auto add = [&](const SelectionItem& item) {
        if (!pathOf(d, item).empty() && std::ranges::find(parts, item) == parts.end()) parts.push_back(item);
    };
    for (const SelectionItem& item : document.selection()) {
        if (item.kind == Kind::Endpoint) add({Kind::Bone, item.part, {}, false});
        else if (item.kind != Kind::Character) add(item);
        else
            for (const PartId id : d.elementsOf(item.part)) add({Kind::Element, id, {}, false});
    }
    return parts;
}

}  // namespace

bool canHide(const StudioDocument& document) { return !partsSelected(document).empty(); }

void hideSelected(StudioDocument& document) {
    std::vector<Json> wanted;
    for (const SelectionItem& item : partsSelected(document))
        if (shownOf(document.document(), item).visible) wanted.push_back(commands::set(pathOf(document.document(), item), commands::kVisible, false));
    executeTogether(document, wanted);
}

void lockSelected(StudioDocument& document) {
    const auto parts = partsSelected(document);
    const bool unlocks = std::ranges::all_of(parts, [&](const SelectionItem& item) { return shownOf(document.document(), item).locked; });
    std::vector<Json> wanted;
    for (const SelectionItem& item : parts)
        if (shownOf(document.document(), item).locked == unlocks) wanted.push_back(commands::set(pathOf(document.document(), item), commands::kLocked, !unlocks));
    executeTogether(document, wanted);
}

void isolateSelected(StudioDocument& document) {
    const Document& d = document.document();
    std::set<PartId> elements, bones;
    for (const SelectionItem& item : partsSelected(document)) {
        if (item.kind == Kind::Bone) bones.insert(item.part);
        else if (item.kind != Kind::Cut) elements.insert(item.part);
        else if (const CharacterSource* character = characterOf(d, item)) std::ranges::copy(d.elementsOf(character->id), std::inserter(elements, elements.end()));
    }
    if (elements.empty() && bones.empty()) return;
    std::vector<Json> wanted;
    const auto show = [&](const auto& part, bool visible) {
        if (part.visible != visible) wanted.push_back(commands::set(part.name, commands::kVisible, visible));
    };
    if (!elements.empty())
        for (const auto& [id, element] : d.elements) show(*element, elements.contains(id));
    for (const auto& [id, bone] : d.bones) show(*bone, bones.contains(id) || elements.contains(bone->element));
    executeTogether(document, wanted);
}

void showAll(StudioDocument& document) {
    const Document& d = document.document();
    std::vector<Json> wanted;
    const auto show = [&](const auto& part, const std::string& name) {
        if (!part.visible) wanted.push_back(commands::set(name, commands::kVisible, true));
    };
    for (const auto& [id, element] : d.elements) {
        show(*element, element->name);
        for (const JointFace& face : element->faces) show(face, pathOf(d, FaceRef{id, face.name}));
    }
    for (const auto& [id, bone] : d.bones) show(*bone, bone->name);
    for (const auto& [id, character] : d.characters)
        for (const Cut& cut : character->cuts) show(cut, cut.name);
    executeTogether(document, wanted);
}

namespace {

struct SelectionTexts {
    Q_DECLARE_TR_FUNCTIONS(SelectionTexts)
};

/// How commands call what is selected, each once; ends of bones are their bones.
std::vector<std::string> selectedNames(const StudioDocument& document, std::initializer_list<Kind> kinds) {
    std::vector<std::string> names;
    for (SelectionItem item : document.selection()) {
        if (item.kind == Kind::Endpoint) item = {Kind::Bone, item.part, {}, false};
        if (std::find(kinds.begin(), kinds.end(), item.kind) == kinds.end()) continue;
        std::string name = handleOf(document.document(), item) ? item.face : pathOf(document.document(), item);
        if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
    }
    return names;
}

}  // namespace

void selectCopies(StudioDocument& document, const Json& answer) {
    const Document& d = document.document();
    std::vector<SelectionItem> items;
    for (const Json& copy : answer.at("characters"))
        if (const CharacterSource* c = d.characterNamed(copy.at("name").get<std::string>())) items.push_back({Kind::Character, c->id, {}, false});
    for (const Json& copy : answer.at("elements"))
        if (const Element* e = d.elementNamed(copy.at("name").get<std::string>()); e && (!e->piece || answer.at("characters").empty())) items.push_back({Kind::Element, e->id, {}, false});
    if (items.empty())
        for (const Json& copy : answer.at("bones"))
            if (const Bone* b = d.boneNamed(copy.at("name").get<std::string>())) items.push_back({Kind::Bone, b->id, {}, false});
    if (items.empty())
        for (const Json& copy : answer.at("handles"))
            if (const auto handle = d.handle(copy.at("name").get<std::string>())) items.push_back({Kind::Face, handle->element, handle->face, false});
    if (items.empty() && answer.contains("faces"))
        for (const Json& copy : answer["faces"])
            if (const auto face = d.face(copy.at("name").get<std::string>())) items.push_back({Kind::Face, face->element, face->face, false});
    if (items.empty())
        for (const Json& copy : answer.at("cuts"))
            if (const CharacterSource* of = d.characterOfCut(copy.at("name").get<std::string>()))
                items.push_back({Kind::Cut, of->cuts[std::size_t(of->cutIndex(copy.at("name").get<std::string>()))].id, {}, false});
    document.select(std::move(items));
}

std::vector<std::string> copiedNames(const StudioDocument& document) { return selectedNames(document, {Kind::Element, Kind::Character, Kind::Bone, Kind::Face, Kind::Cut}); }

std::string pastedOnto(const StudioDocument& document) {
    const Document& d = document.document();
    std::set<std::string> names;
    for (const SelectionItem& item : document.selection()) {
        if (const CharacterSource* character = characterOf(d, item)) names.insert(character->name);
        else if (const Element* element = elementOf(d, item)) names.insert(element->name);
    }
    return names.size() == 1 ? *names.begin() : std::string();
}

bool canDuplicate(const StudioDocument& document) { return !selectedNames(document, {Kind::Element, Kind::Character, Kind::Bone}).empty(); }
bool canMirror(const StudioDocument& document) { return !selectedNames(document, {Kind::Element, Kind::Character, Kind::Bone, Kind::Face, Kind::Cut}).empty(); }

Replaceable replaceable(const StudioDocument& document) {
    const Document& d = document.document();
    if (document.selection().size() != 1) return {};
    const SelectionItem& item = document.selection().front();
    if (const CharacterSource* character = characterOf(d, item)) return {character->name, true};
    const Element* element = elementOf(d, item);
    if (!element) return {};
    return element->piece ? Replaceable{d.characters.at(element->piece->character)->name, true} : Replaceable{element->name, false};
}

const CharacterSource* chosenCharacter(const StudioDocument& document) {
    const Document& d = document.document();
    for (const SelectionItem& item : document.selection()) {
        if (const CharacterSource* character = characterOf(d, item)) return character;
        const Bone* bone = boneOf(d, item);
        const auto through = d.elements.find(bone ? bone->element : 0);
        const Element* element = through == d.elements.end() ? elementOf(d, item) : through->second.get();
        if (element && element->piece) return d.characters.at(element->piece->character).get();
    }
    return d.characters.size() == 1 ? d.characters.begin()->second.get() : nullptr;
}

SoftWish softWish(const StudioDocument& document) {
    const Document& d = document.document();
    for (const SelectionItem& item : document.selection())
        if (const Element* element = elementOf(d, item); element && !element->piece) return {nullptr, element};
    if (const CharacterSource* character = chosenCharacter(document)) return {character, nullptr};
    return {nullptr, d.elements.size() == 1 ? d.elements.begin()->second.get() : nullptr};
}

void duplicateSelected(StudioDocument& document) {
    SlowStep step;
    step.command = commands::duplicate(selectedNames(document, {Kind::Element, Kind::Character, Kind::Bone}));
    step.done = [&document, was = document.selection()](const Json& answer) {
        if (document.selection() == was) selectCopies(document, answer);  // else somebody has gone on
    };
    document.executeSlow(std::move(step));
}

void mirrorSelected(StudioDocument& document, char axis, std::function<void()> done) {
    SlowStep step;
    step.command = commands::mirror(selectedNames(document, {Kind::Element, Kind::Character, Kind::Bone, Kind::Face, Kind::Cut}), axis);
    step.done = [&document, done = std::move(done), was = document.selection()](const Json& answer) {
        if (document.selection() == was) selectCopies(document, answer);
        const Json& left = answer.at("not_mirrored");
        if (left.empty()) return done ? done() : void();
        const QString why = errorText({left[0].at("code").get<std::string>(), left[0].at("why").get<std::string>()}), name = QString::fromStdString(left[0].at("name").get<std::string>());
        Q_EMIT document.failed(left.size() == 1 ? SelectionTexts::tr("Mirrored, but for “%1”: %2").arg(name, why)
                                                : SelectionTexts::tr("Mirrored, but for %1 parts. “%2”: %3").arg(left.size()).arg(name, why));
    };
    document.executeSlow(std::move(step));
}

void togglePins(StudioDocument& document) {
    const Document& d = document.document();
    std::set<EndpointRef> ends;
    for (const SelectionItem& item : document.selection())
        if (boneOf(d, item)) ends.insert({item.part, item.kind == Kind::Bone || item.atEnd});
    std::vector<Json> wanted;
    for (const SelectionItem& item : document.selection())
        if (handleOf(d, item)) wanted.push_back(commands::setPinned(item.face, !isPinned(d, FaceRef{item.part, item.face})));
    for (const EndpointRef& end : ends) wanted.push_back(commands::setPinned(pathOf(d, end), !isPinned(d, end)));
    executeTogether(document, wanted);
}

std::optional<std::pair<std::string, std::string>> joinSelected(StudioDocument& document) {
    std::vector<std::string> faces;
    for (const SelectionItem& item : document.selection())
        if (item.kind == Kind::Face) faces.push_back(pathOf(document.document(), item));
    if (faces.size() != 2 || !document.execute(commands::join(faces[0], faces[1]))) return std::nullopt;
    return std::pair(faces[0], faces[1]);
}

}  // namespace imomushi
