// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <vector>

#include "core/character/character.h"
#include "core/document/effects.h"

namespace imomushi {

/// What an effect and a setting of it are called, and what they do in one sentence, translated.
QString effectTitle(EffectKind effect);
QString effectHelp(EffectKind effect);
QString effectPropertyTitle(const EffectProperty& property);
QString effectPropertyHelp(const EffectProperty& property);

/// What frames have to say, by FrameWarning.
struct WarningText {
    FrameWarning warning;
    bool severe = false;  ///< the character is not where it should be, or something must be changed
    QString text;         ///< translated, one sentence
};
/// Of those whose bit is set, the worst first.
std::vector<WarningText> warningTexts(unsigned warnings);

/// ms: less than this is told as below 0.01.
inline constexpr double kShownMs = 0.005;
/// 0.0421 -> "0.04 ms": of a frame.
QString frameTimeText(double milliseconds);

}  // namespace imomushi
