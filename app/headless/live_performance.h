// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/input/input_triggers.h"
#include "core/input/raw_inputs.h"
#include "core/live/input_driver.h"
#include "core/session/session_access.h"

namespace imomushi {

/// A character that is performed by live input: packets go in, steps are made. What it does depends on packets and steps alone, so that a recording of them does it again.
class LivePerformance {
public:
    /// `seconds`: of a step. Errors: "no-element", those of LiveCharacter::built().
    static Result<LivePerformance> begin(SessionAccess& access, std::vector<RawSource> sources, double seconds);
    /// What came from a source; who asks for the list of names (InputListener::kListAddress) is told by `asked`.
    void take(std::size_t source, std::int64_t nanoseconds, std::span<const std::byte> bytes, const std::function<void()>& asked = {});
    /// After an error only cancel() may follow. Errors: those of the command "drag", of pressWhatMet().
    Result<void> step(const Progress& progress);
    /// How many steps from now on would change nothing, if nothing came.
    [[nodiscard]] std::size_t restingSteps() const;
    /// So many of these are left out.
    void rest(std::size_t steps);
    /// Leaves what was driven in the document, as one step. Errors: those of "drag" and "morph".
    Result<Json> end(const Progress& progress);
    /// Takes back what it did.
    void cancel() noexcept;
    [[nodiscard]] std::size_t steps() const { return steps_; }  ///< with those that were left out

private:
    LivePerformance(SessionAccess& access, std::vector<RawSource> sources, double seconds, InputDriver driver);
    /// A command takes hold of what an input moves, where that is.
    Result<void> hold(const LiveInput& input, const Progress& progress);
    Result<Json> execute(const Json& command, const Progress& progress);

    SessionAccess* access_;
    std::vector<RawSource> sources_;
    std::vector<std::unique_ptr<InputDecoder>> decoders_;
    InputDriver driver_;
    InputTriggers triggers_;
    std::vector<MappedTarget> happens_;  // by row of these
    double seconds_;
    std::size_t steps_ = 0, rested_ = 0;  // of these
    bool changed_ = false;           // a command was executed
    std::vector<LiveInput> driven_;  // what was moved so far, as it is
    std::set<PartId> known_;         // elements that had met
    Json met_ = Json::array();
};

}  // namespace imomushi
