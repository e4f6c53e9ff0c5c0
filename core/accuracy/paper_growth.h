// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/comparison/model_table.h"

namespace imomushi {

/// Frames of the paper's caterpillar, made finer and finer until a frame takes longer than a 60th of a second.
struct Growth {
    struct Point {
        int vertices = 0;
        double frameMs = 0.0;  ///< median: inverse kinematics, joints, product, positions, normals
    };
    std::vector<Point> points;  ///< by vertices
    int most = 0;               ///< vertices of the largest that was fast enough, 0: none
    bool bounded = false;       ///< a larger one was too slow; otherwise there was no time to find one
};

/// The proposed model (basis "paper", float) on so many threads, or the previous model on one. Responses are synthetic (synthetic_response.h): a frame costs the same, and no machine
/// could solve so many vertices. `seconds`: of growing, at most about. Errors: "cancelled", "no-memory".
Result<Growth> growProposed(int threads, double seconds, const Progress& progress);
Result<Growth> growPrevious(double seconds, const Progress& progress);

/// Where the explicit joint dynamics of the previous model diverge: the paper's caterpillar, stretched and bent at once, watched for 200 steps and at least a quarter of a
/// second: what is unstable grows by some factor with every step.
struct Divergence {
    double shearModulus = 0.0, step = 0.0;  ///< Pa, s
    bool diverged = false;
    double seconds = 0.0;                   ///< until it did
    double largest = 0.0;                   ///< displacement of a vertex from rest in the frame of its element, in diagonals, before it did
};
/// For each stiffness halved steps from a 60th of a second on, until two in a row are stable. `models`: of the caterpillar. Errors: "cancelled".
Result<std::vector<Divergence>> previousDivergence(const ComparedModels& models, const Progress& progress);

}  // namespace imomushi
