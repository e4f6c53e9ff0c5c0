// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/selection_commands.h"

#include <set>

#include "ui/models/commands.h"
#include "ui/models/gesture.h"
#include "ui/models/paths.h"

namespace imomushi {

using Kind = SelectionItem::Kind;

void selectAllElements(StudioDocument& document) {
    std::vector<SelectionItem> items;
    for (const auto& [id, element] : document.document().elements)
        if (element->visible && !element->locked) items.push_back({Kind::Element, id, {}, false});
    document.select(std::move(items));
}

void hideSelected(StudioDocument& document) {
    std::vector<Json> wanted;
    for (const SelectionItem& item : document.selection())
        if (const Element* element = item.kind == Kind::Element ? elementOf(document.document(), item) : nullptr) wanted.push_back(commands::set(element->name, commands::element::kVisible, false));
    executeTogether(document, wanted);
}

void showAll(StudioDocument& document) {
    std::vector<Json> wanted;
    for (const auto& [id, element] : document.document().elements)
        if (!element->visible) wanted.push_back(commands::set(element->name, commands::element::kVisible, true));
    executeTogether(document, wanted);
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
