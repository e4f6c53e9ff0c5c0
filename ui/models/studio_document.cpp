// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/studio_document.h"

#include <algorithm>

#include "ui/models/texts.h"

namespace imomushi {

StudioDocument::StudioDocument(const CommandRegistry& registry, QObject* parent) : QObject(parent), session_(registry) {
    session_.setListener([this](const Session::Change& change) {
        if (change.structure) {
            // What is gone cannot stay selected; listeners of structureChanged() may already rely on that.
            std::erase_if(selection_, [this](const SelectionItem& item) { return !exists(item); });
            if (hovered_ && !exists(*hovered_)) hovered_.reset();
            Q_EMIT structureChanged();
            Q_EMIT selectionChanged();
        }
        if (change.pose) Q_EMIT poseChanged();
        if (change.responses) Q_EMIT responsesChanged();
        if (change.file) Q_EMIT fileChanged();
    });
}

bool StudioDocument::exists(const SelectionItem& item) const {
    const Document& d = document();
    switch (item.kind) {
        case SelectionItem::Kind::Element:
            return d.elements.contains(item.part);
        case SelectionItem::Kind::Face: {
            const auto found = d.elements.find(item.part);
            return found != d.elements.end() && found->second->faceIndex(item.face) >= 0;
        }
        case SelectionItem::Kind::Bone:
        case SelectionItem::Kind::Endpoint:
            return d.bones.contains(item.part);
    }
    return false;
}

Result<Json> StudioDocument::execute(const Json& command, bool quiet) {
    auto answer = session_.execute(command);
    Q_EMIT historyChanged();
    if (!answer && !quiet) Q_EMIT failed(errorText(answer.error()));
    return answer;
}

void StudioDocument::select(std::vector<SelectionItem> items) {
    std::erase_if(items, [this](const SelectionItem& item) { return !exists(item); });
    if (items == selection_) return;
    selection_ = std::move(items);
    Q_EMIT selectionChanged();
}

bool StudioDocument::isSelected(const SelectionItem& item) const {
    return std::find(selection_.begin(), selection_.end(), item) != selection_.end();
}

void StudioDocument::setHovered(std::optional<SelectionItem> item) {
    if (item == hovered_) return;
    hovered_ = std::move(item);
    Q_EMIT hoverChanged();
}

}  // namespace imomushi
