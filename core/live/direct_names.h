// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/document/input_mapping.h"

namespace imomushi {

/// OSC addresses of everything that can be driven, with how many numbers each takes: "/imomushi/handle/NAME/position" 3 (m, world), "/imomushi/handle/NAME/turn" 3 (a rotation vector, radians, from rest),
/// "/imomushi/bone/NAME/end/position" 3, "/imomushi/bone/NAME/end/roll" 1, "/imomushi/morph/CHARACTER/NAME" 1, "/imomushi/pose/NAME" 1, "/imomushi/cycle/NAME/amount" 1, "/imomushi/cycle/NAME/speed" 1, "/imomushi/effect/NAME/PROPERTY" 1 or 3 (of effects that are on). Names that are too long for a channel (InputName) have none.
struct DirectName {
    std::string address;
    std::array<MappedTarget, 3> targets;
    int count = 0;
};
std::vector<DirectName> directNames(const Document& document);
/// The same as messages of OSC, "/imomushi/name" for each and "/imomushi/names" with their number: the answer to InputListener::kListAddress.
std::vector<std::string> nameMessages(const Document& document);

}  // namespace imomushi
