// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cstdlib>
#include <random>

#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// IMOMUSHI_SOAK_FRAMES asks for more.
int soakFrames() {
    const char* given = std::getenv("IMOMUSHI_SOAK_FRAMES");
    return given ? std::max(1, std::atoi(given)) : 2000;
}

Json vectorJson(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// All effects at once, with numbers from one end of their ranges to the other, drags, fingers and frame rates by chance. The vertices it ends with.
std::vector<float> soak(unsigned seed, int frames) {
    Workbench w;
    w.buildChain();
    for (const char* effect : {"bone-dynamics", "smooth-joints", "bend-warp", "joint-dynamics", "gravity", "inflate", "touch", "ground"})
        w.good({{"do", "enable"}, {"effect", effect}});
    w.good({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", -3.0}});
    w.good({{"do", "precompute"}});
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) { return low + (high - low) * static_cast<double>(random()) / 4294967295.0; };
    const auto place = [&](double reach) { return Vec3(uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)); };
    const char* ends[] = {"a/start", "a/end", "b/end"};
    double farthest = 0.0;
    for (int frame = 0; frame < frames; ++frame) {
        switch (random() % 24) {
            case 0: w.code({{"do", "drag"}, {"endpoint", ends[random() % 3]}, {"to", vectorJson(Vec3(0, 0, 3) + place(6.0))}}); break;
            case 1: w.code({{"do", "drag"}, {"endpoint", ends[random() % 3]}, {"to", vectorJson(place(100.0))}, {"roll", uniform(-10.0, 10.0)}, {"seconds", uniform(0.0, 1.0)}}); break;
            case 2: w.code({{"do", "release"}}); break;
            case 3: w.code({{"do", "touch"}, {"element", random() % 2 ? "A" : "B"}, {"point", vectorJson({0.5, 0.0, 1.5 + 3.0 * (random() % 2)})}, {"to", vectorJson(place(3.0))}}); break;
            case 4: w.code({{"do", "touch"}, {"element", "A"}, {"point", {0.5, 0.0, 1.5}}, {"to", nullptr}}); break;
            case 5: {
                const auto kind = static_cast<EffectKind>(random() % kEffects);
                const auto properties = effectProperties(kind);
                if (properties.empty() || kind == EffectKind::Touch) break;  // patches would need a precompute
                const auto& p = properties[random() % properties.size()];
                double value = random() % 3 ? uniform(p.low, p.high) : random() % 2 ? p.low : p.high;
                if (p.name == "height") value = uniform(-10.0, 2.0);  // a ground as high as can be takes the body there
                w.good({{"do", "set"}, {"target", std::string(effectName(kind))}, {"property", std::string(p.name)}, {"value", p.size == 3 ? Json{value, -value, 0.0} : Json(value)}});
                break;
            }
            default: break;
        }
        const double dt[] = {1.0 / 30.0, 1.0 / 60.0, 1.0 / 144.0, 0.2, 1e-4};
        const Json answer = w.good({{"do", "step"}, {"frames", 1}, {"dt", dt[random() % 5]}});
        REQUIRE(answer["finite"] == true);
        for (int e = 0; e < 2; ++e) {
            const auto surface = w.session.character()->surface(e);
            for (int i = 0; i < 3 * surface.vertices; ++i) farthest = std::max(farthest, static_cast<double>(std::abs(surface.positions[i])));
        }
    }
    CHECK(farthest < 1e6);  // free fall at the strongest gravity that there is goes far; flesh stays on its bones
    w.good({{"do", "release"}});
    w.good({{"do", "rest"}});
    for (const char* effect : {"gravity", "inflate", "ground"}) w.good({{"do", "disable"}, {"effect", effect}});
    w.good({{"do", "step"}, {"frames", 600}});
    std::vector<float> end;
    for (int e = 0; e < 2; ++e) {
        const auto surface = w.session.character()->surface(e);
        const Points& rest = w.session.document().elements.at(w.session.document().elementNamed(e == 0 ? "A" : "B")->id)->mesh->body.vertices;
        for (int i = 0; i < 3 * surface.vertices; ++i) {
            CHECK(std::abs(surface.positions[i] - rest(i / 3, i % 3)) < 1e-4);
            end.push_back(surface.positions[i]);
        }
    }
    return end;
}

}  // namespace

TEST_CASE("effects: all at once under random drags, fingers, numbers and frame rates stay finite, come back to rest and repeat") {
    const int frames = soakFrames();
    CHECK(soak(1, frames) == soak(1, frames));
}
