// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/paper_growth.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/accuracy/study_frames.h"
#include "core/accuracy/synthetic_response.h"
#include "core/base/clock.h"
#include "core/base/try.h"
#include "core/comparison/paper_caterpillar.h"
#include "core/comparison/previous_model.h"
#include "core/comparison/timing.h"
#include "core/effects/previous_model_job.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

constexpr double kFrameMs = 1000.0 / 60.0;
constexpr double kSecondsOfSize = 1.0;
constexpr int kGrowthRounds = 100;

tl::unexpected<Error> growthCancelled() { return fail(kCancelled, "The comparison was cancelled."); }


int verticesOf(const CharacterInput& input) {
    int count = 0;
    for (const auto& e : input.elements) count += static_cast<int>(e.mesh->body.vertices.rows());
    return count;
}

double frameMs(Character& character, const Progress& progress) {
    StudyFrames frames(character);
    return mediansInTurn(kGrowthRounds, kSecondsOfSize, {[&] { frames(); }}, progress)[0];
}

/// Raises the number of cells around until a frame takes too long, then halves the interval until it is within 4 %.
/// The time of a frame grows with the number of cells around to the power `power`.
Result<Growth> grow(int step, double power, double seconds, const Progress& progress, const std::function<Result<Growth::Point>(int around)>& measure) {
    const auto start = Clock::now();
    Growth out;
    int fits = 0, fails = 0;
    for (int around = 24; progress.cancelled() || fails == 0 || fails - fits > std::max(step, fits / 50);) {
        if (progress.cancelled()) return growthCancelled();
        if (!out.points.empty() && secondsSince(start) > seconds) break;
        IMOMUSHI_TRY(const auto point, measure(around));
        out.points.push_back(point);
        (point.frameMs <= kFrameMs ? fits : fails) = around;
        if (point.frameMs <= kFrameMs) out.most = std::max(out.most, point.vertices);
        if (fits == 0) break;
        if (fails > 0)
            around = (fits + fails) / 2 / step * step;
        else
            // A little beyond what should still fit.
            around = std::clamp(static_cast<int>(1.08 * around * std::pow(kFrameMs / point.frameMs, 1.0 / power)), around + step, 4 * around) / step * step;
        if (around <= fits) break;
        progress.report("measure", std::min(0.95, secondsSince(start) / seconds));
    }
    out.bounded = fails > 0;
    std::sort(out.points.begin(), out.points.end(), [](const auto& a, const auto& b) { return a.vertices < b.vertices; });
    return out;
}

}  // namespace

Result<Growth> growProposed(int threads, double seconds, const Progress& progress) {
    return grow(6, 2.0, seconds, progress, [&](int around) -> Result<Growth::Point> {
        CharacterInput input = paperCaterpillar(around);
        const int vertices = verticesOf(input);
        input.threads = threads;
        IMOMUSHI_TRY(auto character, Character::build(withSyntheticResponses(std::move(input))));
        return Growth::Point{vertices, frameMs(character, progress)};
    });
}

Result<Growth> growPrevious(double seconds, const Progress& progress) {
    return grow(2, 4.0, seconds, progress, [&](int around) -> Result<Growth::Point> {
        CharacterInput input = paperCaterpillar(around);
        const int vertices = verticesOf(input);
        // Elements 0, 1, 3 and 4 are the same body.
        for (const std::size_t e : {0, 2}) input.elements[e].response = syntheticResponse(*input.elements[e].mesh, input.elements[e].faces, BasisKind::Full, false);
        for (const std::size_t e : {1, 3, 4}) input.elements[e].response = input.elements[0].response;
        IMOMUSHI_TRY(auto model, PreviousModel::build(std::move(input), progress));
        return Growth::Point{vertices, frameMs(model.character(), progress)};
    });
}

Result<std::vector<Divergence>> previousDivergence(const ComparedModels& models, const Progress& progress) {
    constexpr double kStiffness[] = {3e3, 3e4, 3e5, 3e6}, kFrame = 1.0 / 60.0;
    constexpr int kPowers = 9, kSteps = 200, kFewestFrames = 15;
    CharacterInput input = withoutEffects(models.input);
    input.basis = BasisKind::Full;
    for (std::size_t e = 0; e < input.elements.size(); ++e) input.elements[e].response = models.full[e];
    PreviousModelEffect settings;
    input.effects.set(settings);
    const Skeleton skeleton = input.skeleton;
    IMOMUSHI_TRY(auto character, Character::build(std::move(input)));
    const Pose rest = restPose(skeleton);
    Pose pulled = rest;
    for (std::size_t p = 0; p < pulled.points.size(); ++p) {
        const double along = static_cast<double>(p) / static_cast<double>(pulled.points.size() - 1);
        pulled.points[p] += Vec3(0.3 * along * along, 0.0, 0.2 * along);
    }
    std::vector<Divergence> out;
    for (const double stiffness : kStiffness) {
        for (int power = 0, stable = 0; power < kPowers && stable < 2; ++power) {
            if (progress.cancelled()) return growthCancelled();
            progress.report("measure", static_cast<double>(out.size()) / (4.0 * kPowers));
            Divergence one;
            one.shearModulus = stiffness;
            one.step = std::ldexp(1.0 / 60.0, -power);
            settings.shearModulus = stiffness;
            settings.step = one.step;
            CharacterEffects effects;
            effects.set(settings);
            character.tune(effects);
            character.stop();
            character.update(rest, 0.0);
            const int frames = std::max(kFewestFrames, kSteps >> power);
            for (int frame = 1; frame <= frames && !one.diverged; ++frame) {
                character.update(pulled, kFrame);
                one.diverged = (character.stats().warnings & static_cast<unsigned>(FrameWarning::Diverged)) != 0;
                one.seconds = frame * kFrame;
                if (one.diverged) break;
                for (std::size_t e = 0; e < models.input.elements.size(); ++e) {
                    const Points& body = models.input.elements[e].mesh->body.vertices;
                    const auto back = character.frame(static_cast<int>(e)).inverse();
                    const auto surface = character.surface(static_cast<int>(e));
                    const double diagonal = diagonalOf(body);
                    for (Eigen::Index v = 0; v < body.rows(); ++v) {
                        const Vec3 now = Eigen::Map<const Eigen::Vector3f>(surface.positions + 3 * v).cast<double>();
                        one.largest = std::max(one.largest, (back * now - Vec3(body.row(v).transpose())).norm() / diagonal);
                    }
                }
            }
            stable = one.diverged ? 0 : stable + 1;
            out.push_back(one);
        }
    }
    return out;
}

}  // namespace imomushi
