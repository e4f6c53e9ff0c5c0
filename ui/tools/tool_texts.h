// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QCoreApplication>

namespace imomushi {

/// What tools say, in the language of the studio: ToolTexts::tr("...").
struct ToolTexts {
    Q_DECLARE_TR_FUNCTIONS(ToolTexts)
};

}  // namespace imomushi
