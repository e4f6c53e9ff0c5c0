// SPDX-License-Identifier: GPL-3.0-or-later
// The joint face that is selected, changed by keys and the brush; and what the face tool says.
#include <algorithm>
#include <iterator>

#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/tools/face_tool.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {

std::optional<FaceRef> FaceTool::edited() const {
    if (plane_ || !element_) return std::nullopt;
    auto face = freeFace(document_);
    return face && face->element == element_ ? face : std::nullopt;
}

void FaceTool::lookAgain() {
    clearPreview();
    if (last_) move(PointerEvent(*last_));
}

void FaceTool::grow(int rings) {
    document_.execute(commands::growJointFace(pathOf(document_.document(), *edited()), rings));
    lookAgain();
}

void FaceTool::flood() {
    const FaceRef ref = *edited();
    const Element& of = *document_.document().elements.at(ref.element);
    const auto region = flatRegion(of, seed_, nullptr);
    if (!region) return (void)Q_EMIT document_.failed(errorText(region.error()));
    const auto& own = of.faces[std::size_t(of.faceIndex(ref.face))].vertices;
    std::vector<std::int32_t> both;
    std::set_union(own.begin(), own.end(), region->vertices.begin(), region->vertices.end(), std::back_inserter(both));
    if (both != own) document_.execute(commands::editJointFace(pathOf(document_.document(), ref), both));
    lookAgain();
}

bool FaceTool::editKey(int key, Qt::KeyboardModifiers modifiers) {
    if (key == Qt::Key_Plus || key == Qt::Key_Minus)
        grow(key == Qt::Key_Plus ? 1 : -1);
    else if (key == Qt::Key_L && modifiers == Qt::NoModifier)
        flood();
    else if (key == Qt::Key_C && modifiers == Qt::NoModifier && last_ && brush_.begin(PointerEvent(*last_)))
        clearPreview();
    else
        return false;
    return true;
}

bool FaceTool::brushKey(int key) {
    if (brush_.painting()) return true;
    switch (key) {
        case Qt::Key_BracketLeft: brush_.widen(-1); return true;
        case Qt::Key_BracketRight: brush_.widen(1); return true;
        case Qt::Key_C:
        case Qt::Key_Return:
        case Qt::Key_Enter:
            brush_.end();
            lookAgain();
            return true;
        default: return false;
    }
}

QString FaceTool::editHint() const {
    const auto face = edited();
    if (!face) return face_ && refusal_.isEmpty() ? staleClause(document_, element_) : QString();
    return QStringLiteral(" · ") + ToolTexts::tr("+ −: “%1” larger, smaller · C: brush · L: add what is flat here").arg(QString::fromStdString(face->face)) + staleClause(document_, element_);
}

QString FaceTool::hint() const {
    if (brush_.on()) return brush_.hint();
    if (drag_.busy() || overCut_) return drag_.hint();
    if (edit_) return edit_->turns ? ToolTexts::tr("Click or Enter: the plane stands so · Type an angle · G: move · Shift: fine · Ctrl: snap · Esc: back") : ToolTexts::tr("Click or Enter: the plane lies here · Type a number · R: turn · Shift: fine · Ctrl: snap · Esc: back");
    if (cut_) {
        if (plane_) return ToolTexts::tr("Enter or click: cut here · G, R: move, turn · X, Y, Z: axis · Esc: cancel");
        return ToolTexts::tr("Click: cut across · Shift+click: plane · ↑: a patch of the surface instead") + editHint();
    }
    if (plane_) {
        const Element* of = element();
        const QString width = of ? lengthText(tolerance(*of)) : QString();
        if (!refusal_.isEmpty()) return refusal_ + QStringLiteral(" · ") + ToolTexts::tr("↑ ↓: tolerance (%1) · Esc: cancel").arg(width);
        return ToolTexts::tr("Enter or click: make the face · G, R: move, turn · X, Y, Z: axis · ↑ ↓: tolerance (%1) · Esc: cancel").arg(width) + editHint();
    }
    if (!refusal_.isEmpty()) return refusal_ + editHint();
    if (!existing_.empty()) {
        if (const auto face = edited(); face && face->face == existing_) return editHint().mid(3);
        return ToolTexts::tr("Click: select the joint face \"%1\"").arg(QString::fromStdString(existing_)) + editHint();
    }
    if (face_) {
        const Element* of = element();
        return ToolTexts::tr("Click: joint face of %n vertices", nullptr, int(face_->vertices.size())) + QStringLiteral(" · ") +
               ToolTexts::tr("↑ ↓: tolerance (%1) · Shift+click: plane").arg(of ? lengthText(tolerance(*of)) : QString()) + editHint();
    }
    return ToolTexts::tr("Click a flat region: joint face · Shift+click: plane · Ctrl: look behind the surface");
}

}  // namespace imomushi
