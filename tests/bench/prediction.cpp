// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted against measured milliseconds per frame and seconds of precompute, before and after the precompute, of all samples (or those that are named): every setting of
// a study for which there is time, and effects. The last line tells the largest factors between the two, effects apart. Arguments: seconds for each sample (30), names of samples.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/commands/core_commands.h"
#include "core/reports/accuracy_commands.h"
#include "core/reports/report_commands.h"

using namespace imomushi;

int main(int count, char** arguments) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const double seconds = count > 1 ? std::atof(arguments[1]) : 30.0;
    std::vector<std::string> samples(arguments + std::min(count, 2), arguments + count);
    if (samples.empty()) samples = {"caterpillar", "octopus", "figure"};
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    double worst = 1.0, worstPrecompute = 1.0;
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
        std::printf("%-52s %9s %9s %7s %9s %9s %7s\n", name.c_str(), "ms: pred.", "measured", "factor", "s: pred.", "measured", "factor");
        const auto factor = [](double a, double b) { return std::max(a / b, b / a); };
        for (const auto& p : study->points) {
            if (!p.measured()) continue;
            const double frame = p.predictedMs > 0.0 ? factor(p.predictedMs, p.frameMs) : 0.0, precompute = factor(p.predictedSeconds, p.precomputeSeconds);
            worst = std::max(worst, frame);
            worstPrecompute = std::max(worstPrecompute, precompute);
            std::printf("%-52s %9.4f %9.4f %7.2f %9.2f %9.2f %7.2f\n", settingName(p.setting).c_str(), p.predictedMs, p.frameMs, frame, p.predictedSeconds, p.precomputeSeconds, precompute);
        }
        for (const auto& e : study->effects)
            std::printf("%-52s %9.4f %9.4f %7.2f %s\n", e.effect.c_str(), e.predictedMs, e.measuredMs, e.off(), e.problem.c_str());
    }
    std::printf("largest factor: frames %.2f, precomputes %.2f\n", worst, worstPrecompute);
    return 0;
}
