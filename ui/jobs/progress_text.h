// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>

namespace imomushi {

class BackgroundJob;

/// "Assembling · 12 s left"; the stage alone while the time left is unknown.
QString progressText(const BackgroundJob& job);

}  // namespace imomushi
