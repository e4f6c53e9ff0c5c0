// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/document/character_input.h"
#include "core/document/input_mapping.h"
#include "core/input/input_mapper.h"
#include "core/live/live_input.h"

namespace imomushi {

/// What live input makes of a character that is performed: values go in, targets for the next step come out. Rows of the document's table come first; after them, everything has a name of its own
/// by OSC (directNames()). Built once. Taking and stepping neither allocate, lock nor fail; what comes out depends on values, steps and hold() alone.
class InputDriver {
public:
    /// `oscSources`: those whose values may use direct names. Rows whose target is not there drive nothing.
    InputDriver(const Document& document, const CharacterPlan& plan, std::span<const std::string> oscSources);

    /// False: it drives nothing.
    bool take(const InputValue& value) { return mapper_.take(value); }
    /// A step of so many seconds, > 0: the targets that moved, until the next step. Those of handles and ends of bones are taken by the character only where they are held.
    std::span<const LiveInput> step(double seconds);
    /// What this input moves is held from now on where that is, and glides from there. It must be of the last step.
    void hold(const LiveInput& input, const Vec3& at, const Eigen::Quaterniond& rotation, double roll);
    /// Everything glides to rest. For panic.
    void letGo() { mapper_.letGo(); }
    [[nodiscard]] const InputMapper& mapper() const { return mapper_; }

private:
    /// What is moved as one: a handle, an end of a bone, a morph target.
    struct Driven {
        LiveInput input;     ///< as it was given last
        Vec3 rest = Vec3::Zero();
        Vec3 turn = Vec3::Zero();        ///< of a handle, as a rotation vector
        std::array<int, 6> slots{-1, -1, -1, -1, -1, -1};  ///< x y z, turn x y z; of an end roll in place of the turn, of a morph target its weight first
    };
    struct Tables;
    explicit InputDriver(Tables&& tables);
    std::vector<Driven> driven_;
    std::vector<LiveInput> moved_;
    InputMapper mapper_;
};

/// OSC addresses of everything that can be driven, with how many numbers each takes: "/imomushi/handle/NAME/position" 3 (m, world), "/imomushi/handle/NAME/turn" 3 (a rotation vector, radians, from rest),
/// "/imomushi/bone/NAME/end/position" 3, "/imomushi/bone/NAME/end/roll" 1, "/imomushi/morph/CHARACTER/NAME" 1. Names that are too long for a channel (InputName) have none.
struct DirectName {
    std::string address;
    std::array<MappedTarget, 3> targets;
    int count = 0;
};
std::vector<DirectName> directNames(const Document& document);

}  // namespace imomushi
