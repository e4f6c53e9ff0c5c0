// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

/// The pieces that sections make of a body, see cutBody(). Refusals: "cuts-touch", "does-not-separate", "empty-piece", "section-touches-itself".
tl::expected<std::vector<BodyPiece>, CutRefusal> assemblePieces(const CutSurface& surface, std::span<const PreparedCut> cuts);

}  // namespace imomushi
