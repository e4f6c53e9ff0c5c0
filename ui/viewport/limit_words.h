// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <vector>

#include "core/base/vec3.h"

namespace imomushi {

class Session;

/// Why the end of a bone is not where it is dragged to, translated.
struct LimitWord {
    Vec3 at = Vec3::Zero();  ///< where that end is, m, world
    QString text;
};
/// Of all ends that are dragged and do not come to their targets.
std::vector<LimitWord> limitWords(const Session& session);

}  // namespace imomushi
