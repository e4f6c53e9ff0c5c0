// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/character/effect_settings.h"

namespace imomushi {

inline double milliseconds(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

/// Data of a frame (frame.h), as jobs read and write it.
enum class FrameData : std::uint16_t {
    Joints = 1 << 0,       ///< JointState: rotation, rotationMatrix, at, stretch
    JointMaps = 1 << 1,    ///< JointState: map, warping, part
    Elements = 1 << 2,     ///< ElementState: rotation, frame
    Parameters = 1 << 3,   ///< ElementState: v
    Loads = 1 << 4,        ///< ElementState: withLoads after v, jointForces
    FaceOffsets = 1 << 5,  ///< Frame: offsets
    Wants = 1 << 6,        ///< ElementState: wantsLocal, wantsHere
    Local = 1 << 7,        ///< ElementState: local
    Forces = 1 << 8,       ///< ElementState: patchForces, fingerDents
    Positions = 1 << 9,    ///< ElementState: positions
    Normals = 1 << 10,     ///< ElementState: normals
    Ground = 1 << 11,      ///< ElementState: aloft; Frame: up. For the next frame
};
/// Some of it.
struct FrameDataSet {
    std::uint16_t bits = 0;
    constexpr FrameDataSet() = default;
    constexpr FrameDataSet(FrameData one) : bits(static_cast<std::uint16_t>(one)) {}
    [[nodiscard]] constexpr bool has(FrameData one) const { return (bits & static_cast<std::uint16_t>(one)) != 0; }
    [[nodiscard]] constexpr bool within(FrameDataSet all) const { return (bits & ~all.bits) == 0; }
    friend constexpr FrameDataSet operator|(FrameDataSet a, FrameDataSet b) {
        a.bits = static_cast<std::uint16_t>(a.bits | b.bits);
        return a;
    }
};
constexpr FrameDataSet operator|(FrameData a, FrameData b) { return FrameDataSet(a) | FrameDataSet(b); }

/// Where in a frame jobs run, in this order. What is known by then, and what a job may change there: stageAllows().
enum class Stage {
    Joints,       ///< joints and elements are where the pose has them
    JointMaps,    ///< maps of joints are made from that
    Loads,        ///< v follows from these maps
    FaceOffsets,  ///< loads are known; vertices of joint faces may move by themselves
    Equilibrium,  ///< maps of joints and v become final
    Weights,      ///< all weights of elements are final; who needs positions before placement says so
    LocalShape,   ///< positions before placement, instead of a product; positions may serve as scratch memory
    Dents,        ///< forces on patches by these positions
    Placed,       ///< positions of all body vertices are final
    Normals,      ///< normals of bodies are final
    kCount
};

/// What a job reads and writes in one stage, besides what it keeps itself. A test compares writes with what changes; reads are the word of the job.
struct StageUse {
    Stage stage;
    FrameDataSet reads, writes;
};
/// What jobs may read and write in a stage.
StageUse stageAllows(Stage stage);

/// One row of statistics.
struct EffectTime {
    std::string_view effect;
    double ms = 0.0;
};

/// What an effect does in a frame: one job in one file, which reads and writes the plain data of a Frame and keeps a state of its own. Jobs of effects that a
/// character does not have do not exist. Built once. run() neither allocates, locks nor fails; tune() is called between frames.
class FrameJob {
public:
    FrameJob(const FrameJob&) = delete;
    FrameJob& operator=(const FrameJob&) = delete;
    virtual ~FrameJob() = default;

    [[nodiscard]] std::string_view effect() const { return effect_; }
    /// The stages in which it runs, ascending, with all that it reads and writes there.
    [[nodiscard]] std::span<const StageUse> uses() const { return uses_; }
    /// The part of the job that belongs to one of its stages. Frame::stopped: it forgets its motion first.
    virtual void run(Stage stage, Frame& frame) = 0;
    /// New numbers that are valid (EffectSettings::validate()), perhaps of another effect.
    virtual void tune(const EffectSettings&) {}
    /// True: the next frame of the same pose would be the same, so that steps may stop.
    [[nodiscard]] virtual bool resting(const Frame&) const { return true; }
    /// Bytes that a frame reads and writes for it, beyond the tables of elements.
    [[nodiscard]] virtual std::size_t bytes() const { return 0; }
    /// Sets the times of its effects in the statistics of the frame that ends, of one effect unless overridden. `ms`: of all its stages.
    virtual void report(Frame& frame, double ms) const;

protected:
    /// effect: its name.
    FrameJob(std::string_view effect, std::vector<StageUse> uses) : effect_(effect), uses_(std::move(uses)) {}
    FrameJob(FrameJob&&) noexcept = default;

private:
    friend class FrameJobs;
    std::string_view effect_;
    std::vector<StageUse> uses_;
    double ms_ = 0.0;
};

/// The job of effect `T` alone, which keeps its numbers.
template <class T>
class EffectJob : public FrameJob {
public:
    void tune(const EffectSettings& settings) final {
        if (const T* asked = settingsAs<T>(settings); asked && take(*asked)) settings_ = *asked;
    }

protected:
    EffectJob(T settings, std::vector<StageUse> uses) : FrameJob(T::kName, std::move(uses)), settings_(std::move(settings)) {}
    /// New numbers, before settings() has them. False: they are refused, and the old ones stay.
    virtual bool take(const T&) { return true; }
    [[nodiscard]] const T& settings() const { return settings_; }

private:
    T settings_;
};

/// The jobs of a character, by stage.
class FrameJobs {
public:
    /// Adds a job; of a kind that is there already, returns that one.
    template <class Job, class... Arguments>
    Job& add(Arguments&&... arguments) {
        if (Job* known = find<Job>()) return *known;
        auto made = std::make_unique<Job>(std::forward<Arguments>(arguments)...);
        Job& job = *made;
        for (const StageUse& use : job.uses()) at_[static_cast<std::size_t>(use.stage)].push_back(&job);
        all_.push_back(std::move(made));
        return job;
    }
    /// Null: there is none.
    template <class Job>
    [[nodiscard]] Job* find() const {
        for (const auto& job : all_)
            if (auto* found = dynamic_cast<Job*>(job.get())) return found;
        return nullptr;
    }

    /// While a character is built: the jobs of those before it, whose tables its own may take over.
    void setFormer(std::vector<const FrameJobs*> former) { former_ = std::move(former); }
    template <class Job>
    [[nodiscard]] std::vector<const Job*> former() const {
        std::vector<const Job*> found;
        for (const FrameJobs* jobs : former_)
            if (const Job* job = jobs->find<Job>()) found.push_back(job);
        return found;
    }

    /// Whether each job keeps to what its stages allow. Errors: "internal".
    [[nodiscard]] Result<void> validate() const;
    /// Calls `seen` before (`done` false) and after each part of a job, for tests.
    using Seen = std::function<void(const FrameJob& job, const StageUse& use, const Frame& frame, bool done)>;
    void watch(Seen seen) { seen_ = std::move(seen); }

    void begin() {
        for (const auto& job : all_) job->ms_ = 0.0;
    }
    void run(Stage stage, Frame& frame) {
        for (FrameJob* job : at_[static_cast<std::size_t>(stage)]) {
            if (seen_) tell(*job, stage, frame, false);
            const auto start = std::chrono::steady_clock::now();
            job->run(stage, frame);
            job->ms_ += milliseconds(start, std::chrono::steady_clock::now());
            if (seen_) tell(*job, stage, frame, true);
        }
    }
    void report(Frame& frame) const {
        for (const auto& job : all_) job->report(frame, job->ms_);
    }
    void tune(const CharacterEffects& effects) {
        for (const auto& settings : effects) {
            if (!settings->validate()) continue;
            tune(*settings);
        }
    }
    /// Of one effect, whose numbers are within their ranges. Takes no memory where it acts on the same elements.
    void tune(const EffectSettings& settings) {
        for (const auto& job : all_) job->tune(settings);
    }
    [[nodiscard]] bool resting(const Frame& frame) const {
        for (const auto& job : all_)
            if (!job->resting(frame)) return false;
        return true;
    }
    [[nodiscard]] std::size_t bytes() const {
        std::size_t sum = 0;
        for (const auto& job : all_) sum += job->bytes();
        return sum;
    }

private:
    void tell(const FrameJob& job, Stage stage, const Frame& frame, bool done) const;
    std::vector<std::unique_ptr<FrameJob>> all_;
    Seen seen_;  // empty: nobody watches
    std::array<std::vector<FrameJob*>, static_cast<std::size_t>(Stage::kCount)> at_;
    std::vector<const FrameJobs*> former_;
};

}  // namespace imomushi
