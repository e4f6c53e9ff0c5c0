// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted against measured milliseconds per frame, before and after the precompute, of all samples (or those that are named): every setting of a study for which there is
// time. The last line is the largest factor between the two. Arguments: seconds for each sample (30), names of samples.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/document/accuracy_commands.h"

using namespace imomushi;

int main(int count, char** arguments) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const double seconds = count > 1 ? std::atof(arguments[1]) : 30.0;
    std::vector<std::string> samples(arguments + std::min(count, 2), arguments + count);
    if (samples.empty()) samples = {"caterpillar", "octopus", "figure"};
    CommandRegistry registry;
    addCoreCommands(registry);
    double worst = 1.0;
    for (const auto& name : samples) {
        Session session(registry);
        if (const auto opened = session.execute({{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/" + name + ".imomushi"}}); !opened) {
            std::fprintf(stderr, "%s\n", opened.error().message.c_str());
            return 1;
        }
        auto input = studyInput(session).value();
        input.seconds = seconds;
        input.store.clear();
        const auto study = runStudy(input, {}, {});
        if (!study) {
            std::fprintf(stderr, "%s: %s\n", name.c_str(), study.error().message.c_str());
            return 1;
        }
        std::printf("%-60s %10s %10s %8s\n", name.c_str(), "predicted", "measured", "factor");
        for (const auto& p : study->points) {
            if (!p.measured() || p.predictedMs <= 0.0) continue;
            const double factor = std::max(p.predictedMs / p.frameMs, p.frameMs / p.predictedMs);
            worst = std::max(worst, factor);
            std::printf("%-60s %10.4f %10.4f %8.2f\n", settingName(p.setting).c_str(), p.predictedMs, p.frameMs, factor);
        }
    }
    std::printf("largest factor %.2f\n", worst);
    return 0;
}
