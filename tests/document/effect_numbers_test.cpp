// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "core/document/effects.h"

using namespace imomushi;

TEST_CASE("effects: what effects act by are the numbers of the document, at first their own defaults, and within their ranges") {
    Effects effects;
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto kind = static_cast<EffectKind>(k);
        CAPTURE(std::string(effectName(kind)));
        CHECK(effects.settings(kind)->name() == effectName(kind));
        CHECK(effects.settings(kind)->validate());
        std::size_t at = 0;
        for (const EffectProperty& p : effectProperties(kind))
            for (int i = 0; i < p.size; ++i, ++at) {
                CAPTURE(std::string(p.name));
                double& value = effects[kind].values[at];
                const double first = value;
                CHECK(p.at(*effects.settings(kind))[i] == first);
                value = p.high;
                CHECK(p.at(*effects.settings(kind))[i] == p.high);
                CHECK(effects.settings(kind)->validate());
                for (const double wrong : {2.0 * p.high + 1.0, p.low - 1.0, std::numeric_limits<double>::quiet_NaN()}) {
                    value = wrong;
                    const auto refused = effects.settings(kind)->validate();
                    REQUIRE(!refused);
                    CHECK(refused.error().message.find(p.name) != std::string::npos);
                }
                value = first;
            }
        CHECK(at == effects[kind].values.size());
    }
    CHECK(effects == Effects());
}
