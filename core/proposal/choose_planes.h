// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/body/cut.h"
#include "core/body/section.h"

namespace imomushi {

/// A cut for which one of several planes is to be chosen.
struct PlaneWish {
    std::vector<CutPlane> planes;  ///< to be tried first; normals away from the root, unit. The first is chosen where it works unless another one misplaces clearly less
    std::vector<CutPlane> more;    ///< to be tried where none of them goes together with those of other cuts
    std::vector<double> own;       ///< #V of the body, 0...1: how much of a vertex's flesh belongs beyond the cut
    int parent = -1;               ///< the next cut towards the root, -1: none
    int twin = -1;                 ///< the cut that gets the mirrored planes, -1: none
};

/// Chooses a plane for each cut such that all of them work together: sections do not meet, what lies beyond a cut lies beyond the cuts towards the root as well, no piece is small. Of the planes that do, the
/// one that misplaces least flesh; a plane counts only if it misplaces less than no cut at all. As many cuts as possible get one; the search starts in several orders. `volume`: #V, flesh beneath each
/// vertex in parts of the whole; `least`: of a piece, in the same parts; `mirror`: of twins. Per cut the plane, none: there is none. The same arguments give the same planes.
std::vector<std::optional<CutPlane>> choosePlanes(const CutSurface& surface, std::span<const double> volume, std::span<const PlaneWish> cuts,
                                                  const std::optional<CutPlane>& mirror, double least, const Progress& progress);

}  // namespace imomushi
