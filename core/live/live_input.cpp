// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/live_input.h"

#include <cassert>

namespace imomushi {

std::pair<const EffectProperty&, int> propertyOf(const LiveInput& input) {
    const auto properties = effectProperties(input.effect);
    assert(!properties.empty() && input.value >= 0);
    int first = 0;
    std::size_t p = 0;
    while (p + 1 < properties.size() && input.value >= first + properties[p].size) first += properties[p++].size;
    return {properties[p], first};
}

}  // namespace imomushi
