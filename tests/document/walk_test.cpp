// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/document/workbench.h"
#include "tests/support/plain_sample.h"

using namespace imomushi;

namespace {

struct Walk {
    double largestMove = 0.0;  ///< of any vertex in one frame, m
    double largestGap = 0.0;   ///< m
    bool finite = true;
    std::vector<float> last;   ///< positions after the last frame
};

/// Drags endpoints by `stepLength` per frame at 60 Hz: around, and in every fourth stretch straight away, far out of reach.
Walk walk(Session& session, int frames, double stepLength) {
    Walk result;
    const auto run = [&](const Json& command) {
        const auto answer = session.execute(command);
        if (!answer) FAIL(command.dump() << ": " << answer.error().message);
        return *answer;
    };
    const Document& document = session.document();
    std::vector<std::string> ends;
    for (const auto& [id, bone] : document.bones) ends.push_back(bone->name + "/end");
    std::mt19937 random(11);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
    const int elements = static_cast<int>(document.elements.size());
    std::vector<std::vector<float>> before(static_cast<std::size_t>(elements));
    std::string end;
    Vec3 target = Vec3::Zero(), away = Vec3::UnitX();
    for (int frame = 0; frame < frames; ++frame) {
        if (frame % 250 == 0) {
            run({{"do", "release"}});
            end = ends[random() % ends.size()];
            const Json at = run({{"do", "measure"}, {"what", "position"}, {"endpoint", end}})["value"];
            target = Vec3(at[0].get<double>(), at[1].get<double>(), at[2].get<double>());
            away = Vec3(uniform(), uniform(), uniform()).normalized();
        }
        const Vec3 direction = frame / 250 % 4 == 3 ? away : Vec3(uniform(), uniform(), uniform()).normalized();
        target += stepLength * direction;
        run({{"do", "drag"}, {"endpoint", end}, {"to", {target.x(), target.y(), target.z()}}, {"seconds", 1.0 / 60.0}});
        session.stepFrame(1.0 / 60.0);
        const Character& character = *session.character();
        for (int e = 0; e < elements; ++e) {
            const auto surface = character.surface(e);
            auto& was = before[static_cast<std::size_t>(e)];
            // Plain numbers, by pointers: twenty million vertices in a test that is not optimised.
            const float *now = surface.positions, *end = now + 3 * surface.vertices, *last = was.empty() ? now : was.data(), *normal = surface.normals;
            float largest = 0.0f, sum = 0.0f;
            for (; now != end; now += 3, last += 3, normal += 3) {
                const float x = now[0] - last[0], y = now[1] - last[1], z = now[2] - last[2], square = x * x + y * y + z * z;
                if (square > largest) largest = square;
                sum += square + normal[0] + normal[1] + normal[2];  // not finite as soon as one is not
            }
            result.finite = result.finite && std::isfinite(sum);
            result.largestMove = std::max(result.largestMove, std::sqrt(static_cast<double>(largest)));
            was.assign(surface.positions, surface.positions + 3 * surface.vertices);
        }
        if (frame % 50 == 0) result.largestGap = std::max(result.largestGap, run({{"do", "measure"}, {"what", "gap"}})["value"].get<double>());
    }
    for (const auto& positions : before) result.last.insert(result.last.end(), positions.begin(), positions.end());
    return result;
}

}  // namespace

TEST_CASE("caterpillar: a random walk of 10,000 drags stays finite and closed, moves no vertex in a jump, and repeats to the byte") {
    const auto sample = std::filesystem::path(IMOMUSHI_SAMPLES) / "caterpillar.imomushi";
    std::vector<float> first;
    for (const int threads : {1, 2}) {
        Workbench w;
        w.good({{"do", "open"}, {"path", sample.string()}});
        for (const Json& line : plainLines("caterpillar")) w.good(line);
        w.good({{"do", "set"}, {"target", "character"}, {"property", "threads"}, {"value", threads}});
        const Json bounds = w.good({{"do", "measure"}, {"what", "bounds"}})["value"];
        const double length = bounds["high"][0].get<double>() - bounds["low"][0].get<double>();
        const Walk result = walk(w.session, 10'000, 0.01 * length);
        MESSAGE("largest move " << result.largestMove / (0.01 * length) << " drag steps, largest gap " << result.largestGap << " m");
        CHECK(result.finite);
        CHECK(result.largestGap <= 1e-12 * length);
        CHECK(result.largestMove <= 10.0 * 0.01 * length);
        if (threads == 1) first = result.last;
        CHECK(result.last == first);
    }
}
