// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cstdlib>
#include <map>
#include <random>

#include "tests/document/workbench.h"
#include "tests/support/plain_sample.h"

using namespace imomushi;

namespace {

/// IMOMUSHI_SOAK_FRAMES asks for more.
int soakFrames(int usual) {
    const char* given = std::getenv("IMOMUSHI_SOAK_FRAMES");
    return given ? std::max(1, std::atoi(given)) : usual;
}

Json vectorJson(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// Effects whose responses are there without another precompute, and those that want one.
const std::vector<std::string> kReady = {"bone-dynamics", "smooth-joints", "bend-warp", "joint-dynamics", "ground"};
const std::vector<std::string> kSolved = {"gravity", "inflate", "touch", "contact"};

/// All these effects at once, with numbers from one end of their ranges to the other, drags, fingers and frame rates by chance. The vertices it ends with,
/// after it came back to rest.
std::vector<float> soak(Workbench& w, std::vector<std::string> effects, unsigned seed, int frames) {
    const Document& document = w.session.document();
    Vec3 low = Vec3::Constant(1e30), high = -low;
    std::vector<std::string> names, ends;
    for (const auto& [id, element] : document.elements) {
        const Points& rest = element->mesh->body.vertices;
        low = low.cwiseMin(rest.colwise().minCoeff().transpose());
        high = high.cwiseMax(rest.colwise().maxCoeff().transpose());
        names.push_back(element->name);
    }
    for (const auto& [id, bone] : document.bones)
        for (const char* end : {"/start", "/end"}) ends.push_back(bone->name + end);
    const Vec3 middle = 0.5 * (low + high);
    const double size = (high - low).norm();

    for (const auto& effect : effects) w.good({{"do", "enable"}, {"effect", effect}});
    w.good({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", low.y()}});
    w.good({{"do", "precompute"}});
    std::mt19937 random(seed);
    const auto uniform = [&](double from, double to) { return from + (to - from) * static_cast<double>(random()) / 4294967295.0; };
    const auto place = [&](double reach) { return Vec3(uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)); };
    const auto one = [&](const std::vector<std::string>& list) { return list[random() % list.size()]; };
    double farthest = 0.0;
    for (int frame = 0; frame < frames; ++frame) {
        switch (random() % 24) {
            case 0: w.code({{"do", "drag"}, {"endpoint", one(ends)}, {"to", vectorJson(middle + place(size))}}); break;
            case 1:
                w.code({{"do", "drag"}, {"endpoint", one(ends)}, {"to", vectorJson(place(20.0 * size))}, {"roll", uniform(-10.0, 10.0)}, {"seconds", uniform(0.0, 1.0)}});
                break;
            case 2: w.code({{"do", "release"}}); break;
            case 3: {
                const auto element = document.elementNamed(one(names));
                const Points& rest = element->mesh->body.vertices;
                const Vec3 point = rest.row(static_cast<Eigen::Index>(random() % static_cast<std::size_t>(rest.rows()))).transpose();
                w.code({{"do", "touch"}, {"element", element->name}, {"point", vectorJson(point)}, {"to", random() % 4 ? vectorJson(point + place(0.3 * size)) : Json()}});
                break;
            }
            case 4: {
                const auto kind = *effectNamed(one(effects));
                const auto properties = effectProperties(kind);
                if (properties.empty()) break;
                const auto& p = properties[random() % properties.size()];
                if (p.name == "patches") break;  // they would need a precompute
                double value = random() % 3 ? uniform(p.low, p.high) : random() % 2 ? p.low : p.high;
                if (p.name == "height") value = uniform(low.y() - size, middle.y());  // a ground as high as can be takes the body there
                w.good({{"do", "set"}, {"target", std::string(effectName(kind))}, {"property", std::string(p.name)}, {"value", p.size == 3 ? Json{value, -value, 0.0} : Json(value)}});
                break;
            }
            default: break;
        }
        const double dt[] = {1.0 / 30.0, 1.0 / 60.0, 1.0 / 144.0, 0.2, 1e-4};
        const Json answer = w.good({{"do", "step"}, {"frames", 1}, {"dt", dt[random() % 5]}});
        REQUIRE(answer["finite"] == true);
        for (std::size_t e = 0; e < names.size(); ++e) {
            const auto surface = w.session.character()->surface(static_cast<int>(e));
            for (int i = 0; i < 3 * surface.vertices; ++i) farthest = std::max(farthest, static_cast<double>(std::abs(surface.positions[i])));
        }
    }
    CHECK(farthest < 1e6);  // free fall at the strongest gravity that there is goes far; flesh stays on its bones
    w.good({{"do", "release"}});
    w.good({{"do", "rest"}});
    for (const char* effect : {"gravity", "inflate", "ground"}) w.code({{"do", "disable"}, {"effect", effect}});
    w.good({{"do", "step"}, {"frames", 600}});
    std::vector<float> end;
    int e = 0;
    double worst = 0.0;
    for (const auto& [id, element] : document.elements) {
        const auto surface = w.session.character()->surface(e++);
        for (int i = 0; i < 3 * surface.vertices; ++i) {
            worst = std::max(worst, std::abs(surface.positions[i] - element->mesh->body.vertices(i / 3, i % 3)));
            end.push_back(surface.positions[i]);
        }
    }
    CHECK(worst < 3e-5 * size);  // a frame is in single precision
    return end;
}

std::vector<std::string> all() {
    std::vector<std::string> effects = kReady;
    effects.insert(effects.end(), kSolved.begin(), kSolved.end());
    return effects;
}

}  // namespace

TEST_CASE("effects: all at once under random drags, fingers, numbers and frame rates stay finite, come back to rest and repeat") {
    std::vector<float> ends[2];
    for (auto& end : ends) {
        Workbench w;
        w.buildChain();
        end = soak(w, all(), 1, soakFrames(2000));
    }
    CHECK(ends[0] == ends[1]);
}

TEST_CASE("effects: every sample survives the same") {
    // What wants a precompute of the whole sample first is left to those who ask for many frames.
    const bool asked = std::getenv("IMOMUSHI_SOAK_FRAMES") != nullptr;
    for (const std::string sample : {"caterpillar", "figure", "octopus", "dragon"}) {
        SUBCASE(sample.c_str()) {
            Workbench w;
            w.good({{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/" + sample + ".imomushi"}});
            for (const Json& line : plainLines(sample)) w.good(line);
            soak(w, asked ? all() : kReady, 2, soakFrames(200));
        }
    }
}
