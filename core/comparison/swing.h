// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/skeleton/skeleton.h"

namespace imomushi {

/// What moves a character while its frames are measured: the far ends of its bones swing about their places of rest, all but the first, so that all of it moves.
struct Swing {
    std::vector<Hold> holds;
    explicit Swing(const Skeleton& skeleton);
    /// t: radians, any.
    void move(double t);

private:
    std::vector<Vec3> middle_;
    double size_ = 0.0;  // m
};

}  // namespace imomushi
