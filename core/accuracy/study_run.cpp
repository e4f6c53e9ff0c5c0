// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>

#include "core/accuracy/frame_prediction.h"
#include "core/accuracy/machine.h"
#include "core/accuracy/pose_error.h"
#include "core/accuracy/study.h"
#include "core/accuracy/study_frames.h"
#include "core/accuracy/study_store.h"
#include "core/accuracy/synthetic_response.h"
#include "core/base/clock.h"
#include "core/base/try.h"
#include "core/comparison/model_table.h"
#include "core/comparison/previous_model.h"
#include "core/comparison/timing.h"
#include "core/effects/smooth_joints_job.h"
#include "core/effects/touch_job.h"

namespace imomushi {

namespace {


constexpr double kSeconds = 1.2;       // of one measurement of frames
constexpr double kQuickSeconds = 0.3;  // the same in a study of a few seconds
constexpr double kQuickStudy = 20.0;   // s
/// Of the time a study may take: for the reference.
constexpr double kReferenceShare = 0.5;
/// A precompute that is quicker than this (s) is done three times, and the median counts.
constexpr double kQuickPrecompute = 0.5;
constexpr const char* kNoMemory = "no-memory";
/// A full solution of more than this is not kept for whoever might ask for it later.
constexpr std::size_t kKeptBytes = std::size_t{512} << 20;

tl::unexpected<Error> cancelled() { return fail(kCancelled, "The study was cancelled."); }

std::vector<ResponseInput> solvedAs(const StudyInput& input, const AccuracySetting& setting) {
    auto out = input.reference.elements;
    for (auto& in : out) {
        in.basis = setting.previous ? BasisChoice(BasisKind::Full) : setting.basis;
        in.solverMesh = setting.mesh.on(static_cast<int>(in.mesh->body.vertices.rows()), in.solverMesh);
        in.loads = BodyLoads::None;
        in.touch = 0;
    }
    return out;
}

CharacterInput characterAs(const StudyInput& input, const AccuracySetting& setting) {
    CharacterInput out = withoutEffects(input.reference.character);
    out.threads = input.reference.character.threads;
    out.basis = setting.basis;
    if (setting.smoothJoints) out.effects.set(SmoothJointsEffect{});
    out.format = setting.format;
    for (auto& e : out.elements) e.response = nullptr;
    return out;
}

/// Runs a study: what its steps share.
class Runner {
public:
    Runner(const StudyInput& input, const StudyListener& listener, const Progress& progress)
        : input_(input), listener_(listener), progress_(progress), store_(input.store, studyKey(input)), start_(Clock::now()) {
        study_ = knownStudy(input);
        spentBefore_ = study_.seconds;
        for (const AccuracySetting& setting : studiedSettings(input.present))
            if (std::none_of(study_.points.begin(), study_.points.end(), [&](const AccuracyPoint& p) { return p.setting == setting; })) study_.points.emplace_back().setting = setting;
    }

    Result<AccuracyStudy> run() {
        if (input_.reference.character.skeleton.bones.empty()) return fail("no-bone", "There is no bone to move the character by: add bones first.");
        if (study_.reference) {
            // With much more time than before a finer reference is affordable: then all errors are measured again. Half the time leaves room for the variation of estimates.
            ReferenceInput in = referenceInput();
            in.seconds *= 0.5;
            const auto mesh = referenceMesh(in);
            if (mesh && referenceRank(solverMeshName({*mesh, 0})) > referenceRank(study_.reference->mesh)) {
                study_.reference.reset();
                for (auto& p : study_.points) {
                    AccuracyPoint again;
                    again.setting = p.setting;
                    p = std::move(again);
                }
            }
        }
        if (auto ok = predict(); !ok) return tl::unexpected(ok.error());
        const auto waiting = [](const AccuracyPoint& p) { return !p.measured() && !p.problem; };
        const bool any = std::any_of(study_.points.begin(), study_.points.end(), waiting);
        if (any && !study_.reference)
            if (auto ok = refer(); !ok) return tl::unexpected(ok.error());
        if (auto ok = calibrate(); !ok) return tl::unexpected(ok.error());
        double done = 0.0, all = 0.0;
        for (const auto& p : study_.points) all += waiting(p) ? std::max(0.0, p.predictedSeconds) + 1.0 : 0.0;
        for (auto& p : study_.points) {
            if (!waiting(p)) continue;
            if (progress_.cancelled()) return cancelled();
            const double cost = std::max(0.0, p.predictedSeconds);
            if (&p != &study_.points.front() && input_.seconds > 0.0 && secondsSince(start_) + cost > input_.seconds) continue;  // stays waiting
            const auto part = progress_.part(0.4 + 0.55 * done / all, 0.4 + 0.55 * (done + cost + 1.0) / all);
            part.report("measure", 0.0);
            if (auto ok = measure(p, part); !ok) {
                if (ok.error().code == kCancelled) return tl::unexpected(ok.error());
                p.problem = ok.error();
            }
            done += cost + 1.0;
            tell();
            if (&p == &study_.points.front())
                if (auto ok = priceAll(); !ok) return tl::unexpected(ok.error());
        }
        if (auto ok = priceAll(); !ok) return tl::unexpected(ok.error());
        study_.complete = std::none_of(study_.points.begin(), study_.points.end(), waiting);
        tell();
        return study_;
    }

private:
    [[nodiscard]] double frameSeconds() const { return input_.seconds > 0.0 && input_.seconds <= kQuickStudy ? kQuickSeconds : kSeconds; }

    void tell() {
        study_.markDominated();
        study_.seconds = spentBefore_ + secondsSince(start_);
        store_.save(study_);
        if (listener_) listener_(study_);
    }

    /// The mean machineShare() so far: other load comes and goes within seconds.
    double share() {
        shares_.push_back(machineShare(input_.reference.elements.front().threads));
        double sum = 0.0;
        for (const double s : shares_) sum += s;
        return sum / static_cast<double>(shares_.size());
    }

    Result<void> predict() {
        const double now = share();
        for (auto& p : study_.points) {
            if (progress_.cancelled()) return cancelled();
            if (p.predictedSeconds >= 0.0) continue;
            const auto cost = estimateElements(solvedAs(input_, p.setting));
            p.predictedSeconds = cost.seconds / now;
            p.precomputeBytes = static_cast<double>(cost.bytes);
            if (p.setting.previous) continue;
            const auto ms = predictFrame(characterAs(input_, p.setting), progress_);
            if (ms) p.predictedMs = *ms;
            if (!ms && ms.error().code == kCancelled) return tl::unexpected(ms.error());
        }
        tell();
        return {};
    }

    [[nodiscard]] ReferenceInput referenceInput() const {
        ReferenceInput in = input_.reference;
        if (input_.seconds > 0.0) in.seconds = kReferenceShare * input_.seconds;
        return in;
    }

    Result<void> refer() {
        const Progress progress = progress_.part(0.05, 0.4);
        auto made = input_.keeper ? input_.keeper->reference(referenceInput(), kKeptBytes, progress) : buildReference(referenceInput(), progress);
        if (made)
            study_.reference = std::move(*made);
        else if (made.error().code != kNoMemory)
            return tl::unexpected(made.error());
        tell();
        return {};
    }

    /// Builds the calibration character: the default setting with synthetic responses, so that its frame takes about as long as the others.
    Result<void> calibrate() {
        CharacterInput c = characterAs(input_, {});
        IMOMUSHI_TRY(auto built, Character::build(withSyntheticResponses(std::move(c))));
        calibration_.emplace(std::move(built));
        calibrationFrames_.emplace(*calibration_);
        rescale(quietSpreads(frameSeconds(), {[this] { (*calibrationFrames_)(); }}, progress_)[0].median);
        return {};
    }

    /// A calibration frame took `ms`. Where none was ever as quick, the machine was disturbed before: figures that were measured then are scaled down by the same factor.
    void rescale(double ms) {
        if (ms <= 0.0 || (study_.calibrationMs > 0.0 && ms >= study_.calibrationMs)) return;
        const double share = study_.calibrationMs > 0.0 ? ms / study_.calibrationMs : 1.0;
        study_.calibrationMs = ms;
        for (auto& p : study_.points)
            if (p.measured()) p.frameMs *= share, p.frameP99Ms *= share;
        for (auto& e : study_.effects)
            if (e.measuredMs >= 0.0) e.measuredMs *= share;
    }

    /// Median and 99th percentile of each loop, scaled to the quickest that the machine has been in this study.
    std::vector<Spread> inTurn(std::vector<std::function<void()>> loops) {
        loops.insert(loops.begin(), [this] { (*calibrationFrames_)(); });
        auto spreads = quietSpreads(frameSeconds(), loops, progress_);
        const double calibration = spreads[0].median;
        spreads.erase(spreads.begin());
        if (calibration <= 0.0) return spreads;
        rescale(calibration);
        for (Spread& s : spreads) s.median *= study_.calibrationMs / calibration, s.p99 *= study_.calibrationMs / calibration;
        return spreads;
    }

    Result<void> measure(AccuracyPoint& p, const Progress& progress) {
        const auto inputs = solvedAs(input_, p.setting);
        if (p.precomputeBytes > input_.reference.bytes)
            return fail(kNoMemory, "Its precompute would need more memory than a study may take.");
        IMOMUSHI_TRY(auto solved, solutions(inputs, p, progress));
        CharacterInput given = characterAs(input_, p.setting);
        for (std::size_t e = 0; e < solved.size(); ++e) given.elements[e].response = solved[e];
        const auto& poses = input_.reference.poses;
        if (p.setting.previous) {
            IMOMUSHI_TRY(auto model, PreviousModel::build(std::move(given), progress));
            p.frameBytes = static_cast<double>(model.matrixBytes());
            return measureFrames(p, model.character(), [&](std::size_t i) -> Result<ErrorSum> {
                IMOMUSHI_TRY(const auto statics, model.statics(poses[i].pose, progress));
                return errorOf(model.character(), statics, *study_.reference, i);
            });
        }
        IMOMUSHI_TRY(auto character, Character::build(std::move(given)));
        p.frameBytes = 0.0;
        for (std::size_t e = 0; e < solved.size(); ++e) {
            const auto memory = character.memory(static_cast<int>(e));
            p.frameBytes += static_cast<double>(memory.response + memory.surface);
        }
        return measureFrames(p, character, [&](std::size_t i) -> Result<ErrorSum> {
            character.update(poses[i].pose);
            return errorOf(character, *study_.reference, i);
        });
    }

    /// `errorIn`: of a pose of the reference, by its number.
    Result<void> measureFrames(AccuracyPoint& p, Character& character, const std::function<Result<ErrorSum>(std::size_t)>& errorIn) {
        if (study_.reference) {
            ErrorSum sum;
            p.errors.clear();
            for (std::size_t i = 0; i < input_.reference.poses.size(); ++i) {
                if (progress_.cancelled()) return cancelled();
                IMOMUSHI_TRY(const auto one, errorIn(i));
                p.errors.push_back(one.error());
                sum.add(one);
            }
            p.relative = sum.error().relative;
            p.percent = sum.error().percent;
        }
        StudyFrames frames(character);
        const Spread ms = inTurn({[&] { frames(); }})[0];
        if (progress_.cancelled()) return cancelled();
        p.frameMs = ms.median;
        p.frameP99Ms = ms.p99;
        return {};
    }

    /// Responses are kept while the next settings may need them: formats and smooth joints change none.
    Result<std::vector<std::shared_ptr<const ElementResponse>>> solutions(const std::vector<ResponseInput>& inputs, AccuracyPoint& p, const Progress& progress) {
        ContentHasher hasher;
        for (const auto& in : inputs) {
            const ContentKey key = responseKey(in);
            hasher.number(key.high);
            hasher.number(key.low);
        }
        const ContentKey key = hasher.key();
        auto& kept = kept_[key];
        if (kept.responses.empty()) {
            // The load of the machine may have changed since the study began.
            kept.predicted = estimateElements(inputs).seconds / share();
            std::vector<double> seconds;
            do {
                auto solved = solveElements(inputs, progress);
                if (!solved) {
                    kept_.erase(key);
                    return tl::unexpected(solved.error());
                }
                double sum = 0.0;
                for (const double s : solved->seconds) sum += s;
                seconds.push_back(sum);
                kept.responses = std::move(solved->responses);
            } while (seconds.size() < 3 && seconds.back() < kQuickPrecompute);
            std::sort(seconds.begin(), seconds.end());
            kept.seconds = seconds[seconds.size() / 2];
        }
        p.precomputeSeconds = kept.seconds;
        p.predictedSeconds = kept.predicted;
        auto out = kept.responses;
        // Which settings still need them?
        const bool again = std::any_of(study_.points.begin(), study_.points.end(), [&](const AccuracyPoint& other) {
            return &other != &p && !other.measured() && !other.problem && other.setting.mesh == p.setting.mesh && other.setting.previous == p.setting.previous &&
                   (other.setting.previous || other.setting.basis == p.setting.basis);
        });
        if (!again) kept_.erase(key);
        return out;
    }

    /// What is not known yet.
    Result<void> priceAll() {
        for (const auto& effect : input_.effects) {
            if (progress_.cancelled()) return cancelled();
            const auto known = std::find_if(study_.effects.begin(), study_.effects.end(), [&](const EffectPoint& e) { return e.effect == effect.name; });
            if (known != study_.effects.end()) {
                if (known->measuredMs >= 0.0 || !effect.unknown.empty()) continue;
                study_.effects.erase(known);
            }
            if (auto point = price(effect)) study_.effects.push_back(std::move(*point));
            tell();
        }
        return {};
    }

    Result<EffectPoint> price(const StudyInput::Effect& effect) {
        EffectPoint out{effect.name, effect.predictedMs, -1.0, effect.unknown};
        if (!effect.unknown.empty()) return out;
        CharacterInput given = effect.with, plain = characterAs(input_, input_.present);
        if (given.effects.has<TouchEffect>()) {
            for (std::size_t e = 0; e < given.elements.size(); ++e) plain.elements[e].response = given.elements[e].response;
        } else {
            if (effect.name == SmoothJointsEffect::kName) plain.effects.erase<SmoothJointsEffect>();
            given = withSyntheticResponses(std::move(given));
            plain = withSyntheticResponses(std::move(plain));
        }
        IMOMUSHI_TRY(auto on, Character::build(std::move(given)));
        IMOMUSHI_TRY(auto off, Character::build(std::move(plain)));
        StudyFrames a(on, &effect), b(off);
        const auto both = inTurn({[&] { a(); }, [&] { b(); }});
        out.measuredMs = std::max(0.0, both[0].median - both[1].median);
        return out;
    }

    const StudyInput& input_;
    const StudyListener& listener_;
    const Progress& progress_;
    StudyStore store_;
    Clock::time_point start_;
    AccuracyStudy study_;
    double spentBefore_ = 0.0;
    std::vector<double> shares_;
    std::optional<Character> calibration_;
    std::optional<StudyFrames> calibrationFrames_;
    struct Kept {
        std::vector<std::shared_ptr<const ElementResponse>> responses;
        double seconds = 0.0, predicted = 0.0;
    };
    std::map<ContentKey, Kept> kept_;
};

}  // namespace

Result<AccuracyStudy> runStudy(const StudyInput& input, const StudyListener& listener, const Progress& progress) {
    return Runner(input, listener, progress).run();
}

}  // namespace imomushi
