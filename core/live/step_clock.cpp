// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/step_clock.h"

namespace imomushi {

int StepClock::due(Time now) {
    if (now < next_) return 0;
    const auto late = (now - next_) / length_ + 1;
    const int made = static_cast<int>(late < kMostAtOnce ? late : kMostAtOnce);
    next_ += late * length_;
    leftOut_ += (late - made) * length_;
    return made;
}

}  // namespace imomushi
