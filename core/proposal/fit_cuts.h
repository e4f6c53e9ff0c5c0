// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/body/cut.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A cut that is to be tried on a body.
struct WishedCut {
    CutPlane plane;
    double reach = 0.0;  ///< m, how far it may be moved along its normal
    int twin = -1;       ///< the cut that is its mirror image and stays it, -1: none
    std::optional<Vec3> tip;  ///< m, a place on the surface that must come to lie beyond it, seen from the root
    int moves = 2;  ///< how often it may be moved; then it is left out: others push it to and fro
};

/// What becomes of it.
struct FittedCut {
    bool kept = true;
    CutPlane plane;      ///< where it works, together with the others that are kept
    double moved = 0.0;  ///< m along its normal
    double share = 0.0;  ///< of the body's volume, of the piece in front of it
    std::string code, why;  ///< why it was moved or left out, see CutRefusal; "small": the piece in front of it has less than the least share; "other-limb": its tip lies elsewhere
};

/// Tries cuts together (cutBody()) until they work: one that is refused is moved to the nearest place that works, if that is within reach, else left out. Where
/// two touch, the later one gives way; normals point away from the root, cuts nearer to it come first. `mirror`: of twins. `least`: smallest share of the volume of a
/// piece, 0...1. Nothing is changed. Errors: "not-closed", "cancelled".
Result<std::vector<FittedCut>> fitCuts(const TriangleMesh& body, std::span<const WishedCut> cuts, const std::optional<CutPlane>& mirror, double least, const Progress& progress);

}  // namespace imomushi
