// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "core/body/cgal/cap.h"
#include "core/body/cut.h"
#include "core/body/section.h"

namespace imomushi {

/// A section with the triangles of its caps.
struct PreparedCut {
    Section section;
    PlaneRegion region;
};

/// A cut that was asked for, and what became of it alone.
struct TriedCut {
    CutPlane plane;
    Result<PreparedCut> prepared;
};

/// The pieces that sections make of a body, see cutBody(). Refusals: "cuts-touch", "does-not-separate", "empty-piece", "section-touches-itself".
/// `only`: makes and judges the pieces beside this cut alone, -1: all.
tl::expected<std::vector<BodyPiece>, CutRefusal> assemblePieces(const CutSurface& surface, std::span<const PreparedCut> cuts, int only = -1);

/// Whether two of the cuts touch: the first refusal "cuts-touch" of assemblePieces(). Sections may lack their triangles.
std::optional<CutRefusal> findTouching(const CutSurface& surface, std::span<const PreparedCut> cuts);

}  // namespace imomushi
