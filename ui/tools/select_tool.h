// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/tools/tool.h"

namespace imomushi {

/// Click selects, Shift+click adds or takes away, a click on nothing clears; Delete removes what is selected.
class SelectTool : public Tool {
public:
    using Tool::Tool;
    void press(const PointerEvent& e) override;
    void move(const PointerEvent& e) override;
    bool key(int key, Qt::KeyboardModifiers modifiers) override;
    [[nodiscard]] QString hint() const override;
};

/// Selects `item` as a click with these modifiers does.
void selectByClick(StudioDocument& document, const std::optional<SelectionItem>& item, Qt::KeyboardModifiers modifiers);

/// Removes everything that is selected, in one undo step; all or nothing. False: nothing was selected or something refused (failed() said why).
bool removeSelection(StudioDocument& document);

}  // namespace imomushi
