// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
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

/// Where in a frame jobs run, in this order; what is there by then, and what a job may change (frame.h).
enum class Stage {
    Joints,       ///< turn, rotation (the same as a matrix), place and in-plane stretch of joints; rotation and frame of elements
    JointMaps,    ///< maps of joints, which were made from these
    Loads,        ///< v of elements under these maps; columns after v, forces on joints
    FaceOffsets,  ///< displacements of single vertices of joint faces; v with them
    Equilibrium,  ///< maps of joints and v, final
    Weights,      ///< all weights of elements are final; whether positions before placement are needed
    LocalShape,   ///< what is evaluated is decided; positions before placement instead of a product
    Dents,        ///< positions of free vertices; changes of them
    Placed,       ///< positions of all body vertices, final
    Normals,      ///< normals of bodies
    kCount
};

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

    [[nodiscard]] std::span<const Stage> stages() const { return stages_; }
    /// The part of the job that belongs to one of stages(). Frame::stopped: it forgets its motion first.
    virtual void run(Stage stage, Frame& frame) = 0;
    /// New numbers that are valid (EffectSettings::validate()), perhaps of another effect.
    virtual void tune(const EffectSettings&) {}
    /// It changes nothing by itself: the next frame of the same pose is the same.
    [[nodiscard]] virtual bool resting(const Frame&) const { return true; }
    /// Bytes that a frame reads and writes for it, beyond the tables of elements.
    [[nodiscard]] virtual std::size_t bytes() const { return 0; }
    /// Sets the times of its effects in the statistics of the frame that ends, of one effect unless overridden. `ms`: of all its stages.
    virtual void report(Frame& frame, double ms) const;

protected:
    /// effect: its name. stages: those in which it runs.
    FrameJob(std::string_view effect, std::vector<Stage> stages) : effect_(effect), stages_(std::move(stages)) {}
    FrameJob(FrameJob&&) noexcept = default;

private:
    friend class FrameJobs;
    std::string_view effect_;
    std::vector<Stage> stages_;
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
    EffectJob(T settings, std::vector<Stage> stages) : FrameJob(T::kName, std::move(stages)), settings_(std::move(settings)) {}
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
        for (const Stage stage : job.stages()) at_[static_cast<std::size_t>(stage)].push_back(&job);
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

    void begin() {
        for (const auto& job : all_) job->ms_ = 0.0;
    }
    void run(Stage stage, Frame& frame) {
        for (FrameJob* job : at_[static_cast<std::size_t>(stage)]) {
            const auto start = std::chrono::steady_clock::now();
            job->run(stage, frame);
            job->ms_ += milliseconds(start, std::chrono::steady_clock::now());
        }
    }
    void report(Frame& frame) const {
        for (const auto& job : all_) job->report(frame, job->ms_);
    }
    void tune(const CharacterEffects& effects) {
        for (const auto& settings : effects) {
            if (!settings->validate()) continue;
            for (const auto& job : all_) job->tune(*settings);
        }
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
    std::vector<std::unique_ptr<FrameJob>> all_;
    std::array<std::vector<FrameJob*>, static_cast<std::size_t>(Stage::kCount)> at_;
};

}  // namespace imomushi
