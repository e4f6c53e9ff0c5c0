// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>

#include "core/input/input_value.h"

namespace imomushi {

/// What a control of a source says.
inline InputValue valueOf(const std::string& source, const std::string& channel, std::initializer_list<double> numbers) {
    InputValue made;
    made.source = InputName(source);
    made.channel = InputName(channel);
    std::copy(numbers.begin(), numbers.end(), made.numbers.begin());
    made.count = static_cast<int>(numbers.size());
    return made;
}

}  // namespace imomushi
