// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>

#include "core/accuracy/setting.h"

namespace imomushi {

/// A setting in the language of the studio.
QString settingText(const AccuracySetting& setting);
/// Figures of a study; a dash where they are unknown (negative).
QString shareText(double share);         ///< 1: all
QString diagonalText(double percent);
QString millisecondsText(double ms);
QString secondsText(double seconds);

}  // namespace imomushi
