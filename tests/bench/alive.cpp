// SPDX-License-Identifier: GPL-3.0-or-later
// The price of alive: processor time of a frame of each sample, with the effects that it opens with and without them, at rest and while the end of a limb is dragged about.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "core/commands/core_commands.h"
#include "core/session/session.h"
#include "tests/support/plain_sample.h"

using namespace imomushi;

namespace {

double processorMs() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Sample {
    const char* name;
    const char* end;  // that is dragged
};

struct Price {
    bool asleep = false;  // at rest nobody has to step frames
    double resting = 0.0, dragged = 0.0;  // ms, the middle of many frames
    std::string effects;  // their parts of the last frame that was dragged
};

Price priceOf(const CommandRegistry& registry, const Sample& sample, bool alive) {
    Session session(registry);
    const auto good = [&](const nlohmann::ordered_json& command) {
        if (const auto done = session.execute(command); !done) std::fprintf(stderr, "%s\n", done.error().message.c_str());
    };
    good({{"do", "open"}, {"path", std::string(IMOMUSHI_SAMPLES "/") + sample.name + ".imomushi"}});
    if (!alive)
        for (const auto& line : plainLines(sample.name)) good(line);
    const auto middle = [&](int frames, const auto& before) {
        std::vector<double> times;
        for (int i = 0; i < frames; ++i) {
            before(i);
            const double start = processorMs();
            session.stepFrame(1.0 / 60.0);
            times.push_back(processorMs() - start);
        }
        std::nth_element(times.begin(), times.begin() + frames / 2, times.end());
        return times[static_cast<std::size_t>(frames / 2)];
    };
    Price price;
    price.resting = middle(100, [](int) {});
    price.asleep = !session.moving();
    const auto end = session.document().endpoint(sample.end);
    if (!end) return price;
    const Vec3 at = *session.positionOf(*end);
    double size = 0.0;
    for (const auto& [id, element] : session.document().elements)
        size = std::max(size, element->mesh->body.vertices.col(1).maxCoeff());
    price.dragged = middle(400, [&](int i) {
        const double t = 0.05 * i;
        const Vec3 to = at + 0.15 * size * Vec3(std::sin(t), std::sin(0.7 * t), std::sin(0.31 * t));
        good({{"do", "drag"}, {"endpoint", sample.end}, {"to", {to.x(), to.y(), to.z()}}, {"seconds", 1.0 / 60.0}});
    });
    for (std::size_t k = 0; k < kEffects; ++k)
        if (const auto ms = session.effectMilliseconds(static_cast<EffectKind>(k))) {
            char text[80];
            std::snprintf(text, sizeof text, " %s %.3f", std::string(effectName(static_cast<EffectKind>(k))).c_str(), *ms);
            price.effects += text;
        }
    return price;
}

}  // namespace

int main() {
    CommandRegistry registry;
    addCoreCommands(registry);
    std::printf("processor time of a frame, ms\n%-12s %-6s %9s %9s %9s   %s\n", "sample", "alive", "asleep", "at rest", "dragged", "of it, in the last frame");
    for (const Sample& sample : {Sample{"caterpillar", "head-bone/end"}, Sample{"figure", "hand-bone.L/end"}, Sample{"octopus", "arm1-tip-bone/end"}, Sample{"dragon", "arm.L/end"}})
        for (const bool alive : {false, true}) {
            const Price price = priceOf(registry, sample, alive);
            std::printf("%-12s %-6s %9s %9.4f %9.4f  %s\n", sample.name, alive ? "yes" : "no", price.asleep ? "yes" : "no", price.resting, price.dragged, price.effects.c_str());
        }
    return 0;
}
