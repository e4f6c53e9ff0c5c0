// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/accuracy/reference.h"
#include "core/accuracy/setting.h"
#include "core/base/hash.h"

namespace imomushi {

class FullSolutionKeeper;

/// What one setting costs and gets wrong, measured on this machine. Negative: unknown, or not measured yet.
struct AccuracyPoint {
    AccuracySetting setting;
    double precomputeSeconds = -1.0;
    double precomputeBytes = -1.0;     ///< peak, estimated
    double frameBytes = -1.0;          ///< A' and what else a frame reads and writes, all elements
    double frameMs = -1.0, frameP99Ms = -1.0;  ///< whole frame: inverse kinematics, joints, product, positions, normals
    double predictedMs = -1.0;         ///< the same, before the precompute
    double predictedSeconds = -1.0;    ///< of the precompute, before it
    double relative = -1.0, percent = -1.0;  ///< over all poses, as in PoseError
    std::vector<PoseError> errors;     ///< per pose
    std::optional<Error> problem;      ///< why it was not measured; none: it was, or is waiting
    bool dominatedPerFrame = false, dominatedInPrecompute = false;
    [[nodiscard]] bool measured() const { return frameMs >= 0.0; }  ///< the error stays unknown where there is no reference
};

/// What an effect adds to a frame of the present setting. Negative: unknown.
struct EffectPoint {
    std::string effect;
    double predictedMs = -1.0, measuredMs = -1.0;
    std::string problem;               ///< why it was not measured; empty: it was
    /// How far the prediction was off, as a factor of at least 1; negative: unknown, or both are less than can be measured.
    [[nodiscard]] double off() const;
};

/// A character for which the study is made.
struct StudyInput {
    ReferenceInput reference;          ///< the character with its present basis, joints and format, and how its elements are solved
    AccuracySetting present;
    /// An effect, the present character that has it alone, and what it is predicted to cost. Frames with and without it are measured with synthetic responses, since most effects
    /// would need a precompute of their own; only fingers press on true responses, one of them on the element of most vertices.
    struct Effect {
        std::string name;
        double predictedMs = 0.0;
        CharacterInput with;
        /// What it makes of the pose that inverse kinematics found, before the character takes it (bone dynamics, ground). Empty: nothing.
        std::function<const Pose&(double seconds, const Pose& kinematic, std::span<const IkGoal> goals)> step;
        std::string unknown;           ///< why it cannot be measured; empty: it can
    };
    std::vector<Effect> effects;
    double seconds = 0.0;              ///< that the study may take about, 0: as long as it takes
    std::shared_ptr<FullSolutionKeeper> keeper;  ///< of the full solution, null: it is thrown away
    std::filesystem::path store;       ///< folder where figures are kept, empty: nowhere
};

/// The whole table. Points stay in the order in which they were tried.
struct AccuracyStudy {
    std::vector<AccuracyPoint> points;
    std::vector<EffectPoint> effects;
    std::vector<std::string> poses;    ///< names
    std::optional<Reference> reference;
    std::string machine;               ///< processor and number of threads
    bool complete = false;             ///< nothing is waiting
    double seconds = 0.0;              ///< spent, over all runs
    double calibrationMs = 0.0;        ///< the least that a calibration frame took, see runStudy(); 0: not measured yet

    /// Errors (relative) below this are those of the reference rather than of a point: they cannot be told apart. 0: unknown.
    [[nodiscard]] double floor() const { return reference ? std::max({0.0, reference->relative, reference->faceRelative}) : 0.0; }
    /// Points that are not dominated, cheapest first; a known error and a known cost are needed.
    [[nodiscard]] std::vector<std::size_t> frontPerFrame() const;
    [[nodiscard]] std::vector<std::size_t> frontInPrecompute() const;
    [[nodiscard]] int present() const { return points.empty() ? -1 : 0; }  ///< index of the present setting
    /// Sets which points are dominated.
    void markDominated();
    /// The point of least error whose frame takes at most `ms`, -1: none.
    [[nodiscard]] int best(double ms) const;
};

/// Everything that the figures depend on: elements, skeleton, joints, poses, present setting, machine and the version of studies.
ContentKey studyKey(const StudyInput& input);

/// Called with the study whenever a point, an effect or the reference was added.
using StudyListener = std::function<void(const AccuracyStudy&)>;

/// Measures what `input.store` does not have yet and stores each figure at once, so that a cancelled study continues later. Every frame time is
/// measured in turn with the same calibration frames (the character in the default setting with synthetic responses), in the quietest quarter of the time. What is kept is its ratio to
/// the calibration frame then, times the least that a calibration frame ever took in the study: figures are those of an undisturbed machine, and two studies can be compared.
/// Errors: those of buildReference() other than "no-memory" (then errors stay unknown), "no-bone", "cancelled".
Result<AccuracyStudy> runStudy(const StudyInput& input, const StudyListener& listener, const Progress& progress);

/// The study as far as it is stored, without measuring anything: all points, those without figures included.
AccuracyStudy knownStudy(const StudyInput& input);

/// Where studies are kept unless told otherwise: XDG_CACHE_HOME or ~/.cache, imomushi/accuracy. A measurement belongs to a machine and not to a project, so it
/// does not travel with the file. Empty: no home.
std::filesystem::path studyFolder();

}  // namespace imomushi
