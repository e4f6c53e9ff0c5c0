// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/select_tool.h"

#include <algorithm>

#include "ui/tools/gesture.h"
#include "ui/tools/picking.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {

void selectByClick(StudioDocument& document, const std::optional<SelectionItem>& item, Qt::KeyboardModifiers modifiers) {
    if (!(modifiers & Qt::ShiftModifier)) {
        document.select(item ? std::vector<SelectionItem>{*item} : std::vector<SelectionItem>{});
        return;
    }
    if (!item) return;
    auto items = document.selection();
    const auto found = std::find(items.begin(), items.end(), *item);
    if (found == items.end())
        items.push_back(*item);
    else
        items.erase(found);
    document.select(std::move(items));
}

bool removeSelection(StudioDocument& document) {
    // Bones before the faces they end at, faces before their elements: each name is looked up while it still exists.
    std::vector<SelectionItem> items = document.selection();
    for (SelectionItem& item : items)
        if (item.kind == SelectionItem::Kind::Endpoint) item = {SelectionItem::Kind::Bone, item.part, {}, false};
    const auto rank = [](const SelectionItem& item) {
        return item.kind == SelectionItem::Kind::Bone ? 0 : item.kind == SelectionItem::Kind::Face ? 1 : 2;
    };
    std::stable_sort(items.begin(), items.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
    if (items.empty()) return false;
    Gesture gesture(document);
    for (const SelectionItem& item : items) {
        const Document& d = document.document();
        Json command;
        if (item.kind == SelectionItem::Kind::Bone) {
            const auto bone = d.bones.find(item.part);
            if (bone == d.bones.end()) continue;
            command = {{"do", "remove-bone"}, {"name", bone->second->name}};
        } else {
            const auto element = d.elements.find(item.part);
            if (element == d.elements.end()) continue;
            if (item.kind == SelectionItem::Kind::Face) {
                if (element->second->faceIndex(item.face) < 0) continue;
                command = {{"do", "remove-joint-face"}, {"face", pathOf(d, FaceRef{item.part, item.face})}};
            } else {
                command = {{"do", "remove-element"}, {"name", element->second->name}};
            }
        }
        if (!document.execute(command)) return false;
    }
    gesture.commit();
    return true;
}

void SelectTool::press(const PointerEvent& e) {
    if (e.button != Qt::LeftButton || busy()) return;
    const auto item = pickItem(document_.session(), e);
    if (item && item->kind == SelectionItem::Kind::Endpoint && !(e.modifiers & Qt::ShiftModifier))
        pose_.press(e);
    else
        selectByClick(document_, item, e.modifiers);
}

void SelectTool::move(const PointerEvent& e) {
    if (busy())
        pose_.move(e);
    else if (e.buttons == Qt::NoButton)
        document_.setHovered(pickItem(document_.session(), e));
}

bool SelectTool::key(int key, Qt::KeyboardModifiers modifiers) {
    if (busy()) return pose_.key(key, modifiers);
    if (key != Qt::Key_Delete && key != Qt::Key_Backspace) return false;
    return removeSelection(document_);
}

QString SelectTool::hint() const {
    if (busy()) return pose_.hint();
    if (document_.hovered() && document_.hovered()->kind == SelectionItem::Kind::Endpoint)
        return ToolTexts::tr("Click: select · Drag: pose");
    if (document_.selection().empty()) return ToolTexts::tr("Click: select · Shift+click: add");
    return ToolTexts::tr("Click: select · Shift+click: add · Delete: remove");
}

}  // namespace imomushi
