// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/proposal/limb_tree.h"
#include "core/body/section.h"

// Of proposeFromShape() alone. Lengths are in diagonals.
namespace imomushi {

/// A place along a limb, and the section of the body across it there.
struct LimbStation {
    double way = 0.0;            ///< from the beginning of the limb's line
    Vec3 at = Vec3::Zero();      ///< the middle of the section
    Vec3 normal = Vec3::UnitX(); ///< unit, along the limb
    double radius = 0.0;         ///< of the disc of the same area; 0: there is no section
};

/// Where a limb is cut: first at its neck, the narrowest place near where it leaves the flesh of its hub; then into pieces whose length is `perPiece` of their
/// thicknesses, at most `most` pieces, at bends and narrow places near equal parts. Empty: it is too short for a cut.
std::vector<LimbStation> cutsOfLimb(const CutSurface& surface, const Hub& hub, const Limb& limb, double perPiece, int most);

/// Where a chain is cut, outward from its middle: both limbs of the root, into an odd number of pieces of equal length.
std::vector<std::vector<LimbStation>> cutsOfChain(const CutSurface& surface, const Hub& root, double perPiece, int most);

}  // namespace imomushi
