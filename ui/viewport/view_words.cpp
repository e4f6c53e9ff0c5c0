// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/view_words.h"

#include <QStringList>

#include "ui/models/paths.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Names of what is selected, as long as they are few; else their number.
constexpr std::size_t kNamed = 3;

QString nameOf(const Document& document, const SelectionItem& item) {
    const QString path = QString::fromStdString(pathOf(document, item));
    if (path.isEmpty()) return {};
    switch (item.kind) {
        case SelectionItem::Kind::Element: return ToolTexts::tr("element “%1”").arg(path);
        case SelectionItem::Kind::Face: return (handleOf(document, item) ? ToolTexts::tr("handle “%1”") : ToolTexts::tr("joint face “%1”")).arg(path);
        case SelectionItem::Kind::Bone: return ToolTexts::tr("bone “%1”").arg(path);
        case SelectionItem::Kind::Endpoint: return ToolTexts::tr("end of a bone “%1”").arg(path);
        case SelectionItem::Kind::Character: return ToolTexts::tr("character “%1”").arg(path);
        case SelectionItem::Kind::Cut: return ToolTexts::tr("cut “%1”").arg(path);
    }
    return {};
}

}  // namespace

QString viewWords(const StudioDocument& document) {
    const QString nothing = ToolTexts::tr("nothing", "is selected or under the pointer");
    const auto& items = document.selection();
    QString selected;
    if (items.size() > kNamed) {
        selected = ToolTexts::tr("%n thing(s)", "that are selected", static_cast<int>(items.size()));
    } else {
        QStringList names;
        for (const SelectionItem& item : items)
            if (const QString name = nameOf(document.document(), item); !name.isEmpty()) names << name;
        selected = names.isEmpty() ? nothing : names.join(ToolTexts::tr(", ", "between names"));
    }
    QString under = document.hovered() ? nameOf(document.document(), *document.hovered()) : QString();
    if (under.isEmpty()) under = nothing;
    return ToolTexts::tr("Selected: %1. Under the pointer: %2").arg(selected, under);
}

}  // namespace imomushi
