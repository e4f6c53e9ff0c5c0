// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/paths.h"

namespace imomushi {
namespace {

template <class Parts>
auto partIn(const Parts& parts, PartId id) {
    const auto found = parts.find(id);
    return found == parts.end() ? nullptr : found->second.get();
}

}  // namespace

const Element* elementOf(const Document& document, const SelectionItem& item) {
    const bool of = item.kind == SelectionItem::Kind::Element || item.kind == SelectionItem::Kind::Face;
    return of ? partIn(document.elements, item.part) : nullptr;
}

const Bone* boneOf(const Document& document, const SelectionItem& item) {
    const bool of = item.kind == SelectionItem::Kind::Bone || item.kind == SelectionItem::Kind::Endpoint;
    return of ? partIn(document.bones, item.part) : nullptr;
}

const CharacterSource* characterOf(const Document& document, const SelectionItem& item) {
    if (item.kind == SelectionItem::Kind::Character) return partIn(document.characters, item.part);
    if (item.kind == SelectionItem::Kind::Cut)
        for (const auto& [id, character] : document.characters)
            if (character->cutIndex(item.part) >= 0) return character.get();
    return nullptr;
}

const Cut* cutOf(const Document& document, const SelectionItem& item) {
    const CharacterSource* character = item.kind == SelectionItem::Kind::Cut ? characterOf(document, item) : nullptr;
    return character ? &character->cuts[std::size_t(character->cutIndex(item.part))] : nullptr;
}

Shown shownOf(const Document& document, const SelectionItem& item) {
    const Element* element = elementOf(document, item);
    if (element && item.kind == SelectionItem::Kind::Face) {
        const int face = element->faceIndex(item.face);
        return face < 0 ? Shown{} : shown(element->faces[std::size_t(face)]);
    }
    if (element) return shown(*element);
    if (const Bone* bone = boneOf(document, item)) return shown(*bone);
    const Cut* cut = cutOf(document, item);
    return cut ? shown(*cut) : Shown{};
}

std::string pathOf(const Document& document, const EndpointRef& end) {
    const Bone* bone = partIn(document.bones, end.bone);
    return bone ? bone->name + (end.atEnd ? "/end" : "/start") : std::string();
}

std::string pathOf(const Document& document, const FaceRef& face) {
    const Element* element = partIn(document.elements, face.element);
    return element ? element->name + "/" + face.face : std::string();
}

std::string pathOf(const Document& document, const SelectionItem& item) {
    const Element* element = elementOf(document, item);
    const Bone* bone = boneOf(document, item);
    switch (item.kind) {
        case SelectionItem::Kind::Element: return element ? element->name : std::string();
        case SelectionItem::Kind::Face: return pathOf(document, FaceRef{item.part, item.face});
        case SelectionItem::Kind::Bone: return bone ? bone->name : std::string();
        case SelectionItem::Kind::Endpoint: return pathOf(document, EndpointRef{item.part, item.atEnd});
        case SelectionItem::Kind::Character: {
            const CharacterSource* character = characterOf(document, item);
            return character ? character->name : std::string();
        }
        case SelectionItem::Kind::Cut: {
            const Cut* cut = cutOf(document, item);
            return cut ? cut->name : std::string();
        }
    }
    return {};
}

const Handle* handleOf(const Document& document, const SelectionItem& item) {
    const Element* element = item.kind == SelectionItem::Kind::Face ? elementOf(document, item) : nullptr;
    return element ? element->handleOf(item.face) : nullptr;
}

bool isPinned(const Document& document, const FaceRef& handle) {
    const auto goal = document.handleGoals.find(handle);
    return goal != document.handleGoals.end() && goal->second.pinned;
}

bool isPinned(const Document& document, const EndpointRef& end) {
    const auto held = document.goals.find(end);
    return held != document.goals.end() && held->second.pinned;
}

}  // namespace imomushi
