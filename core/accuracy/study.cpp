// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/study.h"

#include <algorithm>
#include <cstdlib>

#include "core/accuracy/machine.h"
#include "core/accuracy/pareto.h"
#include "core/accuracy/study_store.h"

namespace imomushi {

namespace {

constexpr int kVersion = 3;  // of stored figures: whenever the same input would give others
/// Differences of frames below this are those of the clock and the machine, ms.
constexpr double kMinMs = 1e-3;

/// Points by one of their costs.
std::vector<Trade> tradesBy(double AccuracyPoint::*cost, const std::vector<AccuracyPoint>& points) {
    std::vector<Trade> trades;
    for (const auto& p : points) trades.push_back({p.*cost, p.relative, p.relative >= 0.0 && p.*cost >= 0.0});
    return trades;
}

}  // namespace

double EffectPoint::off() const {
    const double more = std::max(predictedMs, measuredMs), less = std::min(predictedMs, measuredMs);
    return less < 0.0 || more < kMinMs ? -1.0 : more / std::max(less, kMinMs);
}

std::vector<std::size_t> AccuracyStudy::frontPerFrame() const { return paretoFront(tradesBy(&AccuracyPoint::frameMs, points)); }
std::vector<std::size_t> AccuracyStudy::frontInPrecompute() const { return paretoFront(tradesBy(&AccuracyPoint::precomputeSeconds, points)); }

void AccuracyStudy::markDominated() {
    const auto perFrame = dominated(tradesBy(&AccuracyPoint::frameMs, points)), inPrecompute = dominated(tradesBy(&AccuracyPoint::precomputeSeconds, points));
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i].dominatedPerFrame = perFrame[i] != 0;
        points[i].dominatedInPrecompute = inPrecompute[i] != 0;
    }
}

int AccuracyStudy::best(double ms) const {
    int out = -1;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points[i].relative >= 0.0 && points[i].measured() && points[i].frameMs <= ms && (out < 0 || points[i].relative < points[static_cast<std::size_t>(out)].relative)) out = static_cast<int>(i);
    return out;
}

ContentKey studyKey(const StudyInput& input) {
    ContentHasher hasher;
    hasher.number(kVersion);
    hasher.text(machineName());
    hasher.text(settingName(input.present));
    const auto add = [&](const ContentKey& key) {
        hasher.number(key.high);
        hasher.number(key.low);
    };
    add(referenceKey(input.reference));
    for (ResponseInput in : input.reference.elements) {
        in.basis = BasisKind::Affine;
        in.loads = BodyLoads::None;
        in.touch = 0;
        add(responseKey(in));
    }
    hasher.number(input.reference.character.threads);
    for (const auto& pose : input.reference.poses) {
        hasher.text(pose.name);
        for (const Vec3& p : pose.pose.points) hasher.array(std::span<const double>(p.data(), 3));
        for (const auto& q : pose.pose.frames) hasher.array(std::span<const double>(q.coeffs().data(), 4));
        hasher.array(std::span<const double>(pose.pose.roll));
    }
    return hasher.key();
}

AccuracyStudy knownStudy(const StudyInput& input) {
    AccuracyStudy study = StudyStore(input.store, studyKey(input)).load(input.reference);
    study.machine = machineName();
    study.poses.clear();
    for (const auto& pose : input.reference.poses) study.poses.push_back(pose.name);
    // The settings of this version of studies, with the figures that are known.
    std::vector<AccuracyPoint> points;
    for (const AccuracySetting& setting : studiedSettings(input.present)) {
        AccuracyPoint point;
        for (const auto& known : study.points)
            if (known.setting == setting) point = known;
        point.setting = setting;
        points.push_back(std::move(point));
    }
    study.points = std::move(points);
    study.complete = std::all_of(study.points.begin(), study.points.end(), [](const AccuracyPoint& p) { return p.measured() || p.problem; });
    study.markDominated();
    return study;
}

std::filesystem::path studyFolder() {
    const char* cache = std::getenv("XDG_CACHE_HOME");
    if (cache && *cache) return std::filesystem::path(cache) / "imomushi" / "accuracy";
    const char* home = std::getenv("HOME");
    return home && *home ? std::filesystem::path(home) / ".cache" / "imomushi" / "accuracy" : std::filesystem::path();
}

}  // namespace imomushi
