// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/select_tool.h"

#include <algorithm>

#include "ui/models/commands.h"
#include "ui/models/gesture.h"
#include "ui/models/paths.h"
#include "ui/picking/picking.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// It can be dragged.
bool isGrip(const StudioDocument& document, const SelectionItem& item) {
    return item.kind == SelectionItem::Kind::Endpoint || handleOf(document.document(), item);
}

/// Points of a lasso are so far apart, logical pixels.
constexpr double kLassoPixels = 4.0;

bool isBone(const SelectionItem& item) { return item.kind == SelectionItem::Kind::Bone; }

}  // namespace

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

namespace {

/// None: it went with something else.
std::optional<Json> removal(const Document& d, const SelectionItem& item) {
    if (item.kind == SelectionItem::Kind::Bone) {
        const auto bone = d.bones.find(item.part);
        return bone == d.bones.end() ? std::nullopt : std::optional(commands::removeBone(bone->second->name));
    }
    if (item.kind == SelectionItem::Kind::Cut) {
        const Cut* cut = cutOf(d, item);
        return cut ? std::optional(commands::removeCut(cut->name)) : std::nullopt;
    }
    if (item.kind == SelectionItem::Kind::Character) {
        const CharacterSource* character = characterOf(d, item);
        return character ? std::optional(commands::removeElement(character->name)) : std::nullopt;
    }
    const auto element = d.elements.find(item.part);
    if (element == d.elements.end()) return std::nullopt;
    if (item.kind != SelectionItem::Kind::Face) return commands::removeElement(element->second->name);
    return element->second->faceIndex(item.face) < 0 ? std::nullopt : std::optional(commands::removeJointFace(pathOf(d, FaceRef{item.part, item.face})));
}

}  // namespace

bool removeSelection(StudioDocument& document) {
    // Bones before the faces they end at, faces before cuts and their elements, these before their characters: each name is looked up while it still exists.
    std::vector<SelectionItem> items = document.selection();
    for (SelectionItem& item : items)
        if (item.kind == SelectionItem::Kind::Endpoint) item = {SelectionItem::Kind::Bone, item.part, {}, false};
    const auto rank = [](const SelectionItem& item) {
        switch (item.kind) {
            case SelectionItem::Kind::Bone:
            case SelectionItem::Kind::Endpoint: return 0;
            case SelectionItem::Kind::Face: return 1;
            case SelectionItem::Kind::Cut: return 2;
            case SelectionItem::Kind::Element: return 3;
            case SelectionItem::Kind::Character: break;
        }
        return 4;
    };
    std::stable_sort(items.begin(), items.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
    const auto has = [&](SelectionItem::Kind kind) { return std::ranges::find(items, kind, &SelectionItem::kind) != items.end(); };
    if (has(SelectionItem::Kind::Cut) && (has(SelectionItem::Kind::Element) || has(SelectionItem::Kind::Character))) {
        // A cut takes one of its pieces along, so that what is left to remove is known only then.
        Gesture gesture(document);
        for (const SelectionItem& item : items)
            if (const auto command = removal(document.document(), item); command && !document.execute(*command)) return false;
        gesture.commit();
        return true;
    }
    std::vector<Json> commands;
    for (const SelectionItem& item : items)
        if (auto command = removal(document.document(), item); command && std::ranges::find(commands, *command) == commands.end()) commands.push_back(std::move(*command));
    if (commands.empty()) return false;
    document.executeSlow({commands.size() == 1 ? commands.front() : Json(commands)});
    return true;
}

void SelectTool::press(const PointerEvent& e) {
    if (e.button != Qt::LeftButton) return;
    if (cut_.modal()) return cut_.keep();
    if (body_.modal()) return (void)body_.keep();
    if (pose_.modal()) return pose_.press(e);
    if (busy()) return;
    // What is selected is what is meant.
    if (pose_.gizmoPart(e) != render::GizmoPart::None) return pose_.press(e);
    if (const auto part = body_.gizmoPart(e); part != render::GizmoPart::None && body_.press(part, e)) return;
    if (!(e.modifiers & Qt::ShiftModifier) && cut_.press(e)) return;
    const auto item = pickItem(document_.session(), e);
    if (item && isGrip(document_, *item) && !(e.modifiers & Qt::ShiftModifier)) return pose_.press(e);
    if (!(e.modifiers & Qt::ShiftModifier) && !(item && isBone(*item)) && part_.press(e)) return;
    auto before = document_.selection();
    selectByClick(document_, item, e.modifiers);
    if (!item) drag_ = Drag{{e.x, e.y}, {e.x, e.y}, (e.modifiers & Qt::ControlModifier) != 0, {QPointF(e.x, e.y)}, std::move(before), document_.selection()};
}

void SelectTool::move(const PointerEvent& e) {
    last_ = e;
    if (drag_) {
        drag_->to = {e.x, e.y};
        if (drag_->free) {
            if ((drag_->to - drag_->loop.last()).manhattanLength() >= kLassoPixels) drag_->loop << drag_->to;
            return;
        }
        auto items = drag_->kept;
        if (const auto area = box())
            for (const SelectionItem& item : itemsWithin(document_.session(), e, *area))
                if (std::find(items.begin(), items.end(), item) == items.end()) items.push_back(item);
        document_.select(std::move(items));
    } else if (body_.busy()) {
        body_.move(e);
    } else if (cut_.busy()) {
        cut_.move(e);
    } else if (part_.busy()) {
        part_.move(e);
    } else if (busy()) {
        pose_.move(e);
    } else if (overGizmo_ = e.buttons == Qt::NoButton && pose_.gizmoPart(e) != render::GizmoPart::None; overGizmo_) {
        overCut_ = false;
        part_.leave();
        pose_.move(e);
    } else if (e.buttons == Qt::NoButton) {
        pose_.leaveGizmo();
        const auto part = body_.gizmoPart(e);
        body_.hover(part);
        if (part != render::GizmoPart::None) {
            overCut_ = false;
            part_.leave();
            return document_.setHovered(std::nullopt);
        }
        const auto item = pickItem(document_.session(), e);
        overCut_ = cut_.over(e);
        if (overCut_ || (item && (isGrip(document_, *item) || isBone(*item))))
            part_.leave();
        else
            part_.hover(e);
        document_.setHovered(overCut_ ? document_.selection().front() : item);
    }
}

void SelectTool::release(const PointerEvent& e) {
    if (cut_.busy()) {
        const bool clicked = e.button == Qt::LeftButton && !cut_.moved();
        cut_.release(e);
        if (clicked) selectByClick(document_, pickItem(document_.session(), e), e.modifiers);
        return;
    }
    if (body_.busy()) {
        if (body_.modal() || e.button != Qt::LeftButton) return;
        if (!body_.keep()) selectByClick(document_, pickItem(document_.session(), e), e.modifiers);
        return;
    }
    if (part_.busy()) {
        const bool clicked = e.button == Qt::LeftButton && !part_.moved();
        part_.release(e);
        if (clicked) selectByClick(document_, pickItem(document_.session(), e), e.modifiers);
        return;
    }
    if (!drag_) return pose_.release(e);
    if (e.button != Qt::LeftButton) return;
    // A loop is whole once it is let go.
    if (const QPolygonF loop = lasso(); !loop.isEmpty()) {
        auto items = drag_->kept;
        for (const SelectionItem& item : itemsWithin(document_.session(), e, loop))
            if (std::find(items.begin(), items.end(), item) == items.end()) items.push_back(item);
        document_.select(std::move(items));
    }
    drag_.reset();
}

void SelectTool::cancel() {
    cut_.cancel();
    part_.cancel();
    body_.cancel();
    if (!drag_) return pose_.cancel();
    document_.select(std::move(drag_->before));
    drag_.reset();
}

QPolygonF SelectTool::lasso() const { return drag_ && drag_->free && drag_->loop.size() > 2 ? drag_->loop : QPolygonF(); }

std::optional<QRectF> SelectTool::box() const {
    if (!drag_ || drag_->free || (drag_->to - drag_->from).manhattanLength() < kDragPixels) return std::nullopt;
    return QRectF(drag_->from, drag_->to).normalized();
}

bool SelectTool::key(int key, Qt::KeyboardModifiers modifiers, const QString& text) {
    if (drag_) return true;
    if (cut_.busy()) return cut_.key(key, text);
    if (part_.busy()) return part_.key(key, text);
    if (body_.busy()) return body_.key(key, modifiers, text);
    if (busy()) return pose_.key(key, modifiers, text);
    if (key == Qt::Key_G && modifiers == Qt::NoModifier && last_) return body_.begin(BodyDrag::Does::Moves, *last_) || cut_.begin(false, *last_) || pose_.grabSelected(*last_);
    if (key == Qt::Key_R && modifiers == Qt::NoModifier && last_ && turnKey_) return body_.begin(BodyDrag::Does::Turns, *last_) || cut_.begin(true, *last_) || pose_.grabSelected(*last_, true);
    if (key == Qt::Key_S && modifiers == Qt::NoModifier && last_) return body_.begin(BodyDrag::Does::Scales, *last_);
    if (key != Qt::Key_Delete && key != Qt::Key_Backspace) return false;
    return removeSelection(document_);
}

bool SelectTool::wants(int key) const {
    if (cut_.busy()) return key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z;
    if (body_.busy()) return key == Qt::Key_G || key == Qt::Key_R || key == Qt::Key_S || key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z;
    if (busy()) return pose_.wants(key);
    const bool turns = key == Qt::Key_R && turnKey_;
    if ((key == Qt::Key_G || key == Qt::Key_S || turns) && last_ && body_.chosen()) return true;
    return (key == Qt::Key_G || turns) && last_ && document_.selection().size() == 1 && (cutOf(document_.document(), document_.selection().front()) || pose_.gripSelected());
}

QString SelectTool::hint() const {
    if (drag_) return drag_->free ? ToolTexts::tr("Release: select what the loop touches · Esc: cancel") : ToolTexts::tr("Release: select what the box touches · Esc: cancel");
    if (cut_.busy() || overCut_) return cut_.hint();
    if (const QString body = body_.hint(); !body.isEmpty()) return body;
    if (const QString part = part_.hint(); !part.isEmpty()) return part;
    if (busy() || overGizmo_) return pose_.hint();
    if (document_.hovered() && isGrip(document_, *document_.hovered()))
        return ToolTexts::tr("Click: select · Drag: pose");
    if (document_.selection().empty()) return ToolTexts::tr("Click or drag a box: select · Ctrl+drag: lasso · Shift: add");
    if (body_.chosen()) return ToolTexts::tr("Click or drag a box: select · G, R, S: move, turn, scale · Delete: remove");
    return ToolTexts::tr("Click or drag a box: select · Ctrl+drag: lasso · Shift: add · Delete: remove");
}

}  // namespace imomushi
