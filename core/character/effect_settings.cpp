// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/effect_settings.h"

#include <cmath>
#include <sstream>

namespace imomushi {

Result<void> checkNumbers(EffectSettings& settings, std::span<const EffectProperty> properties) {
    for (const EffectProperty& p : properties)
        for (int i = 0; i < p.size; ++i)
            if (const double x = p.at(settings)[i]; !std::isfinite(x) || x < p.low || x > p.high) {
                std::ostringstream message;
                message << '"' << p.name << "\" of the effect \"" << settings.name() << "\" must lie between " << p.low << " and " << p.high << ", and is " << x << '.';
                return fail("bad-value", message.str());
            }
    return {};
}

}  // namespace imomushi
