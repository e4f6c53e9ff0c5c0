// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/widgets/action_set.h"

namespace imomushi {

/// All actions of the studio, with their icons, texts and standard shortcuts. MainWindow says what they do.
class StudioActions : public ActionSet {
public:
    explicit StudioActions(QWidget* window);
};

/// The actions that choose the theme, by Appearance::Theme.
inline constexpr const char* kThemeActions[] = {"theme-dark", "theme-light", "theme-contrast"};

}  // namespace imomushi
