// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/document.h"

namespace imomushi {

/// Estimated error of an element's answers that comes from its body: a wrap is not what is seen. Relative to the motion of the body, root mean square, as ResponseQuality::error; to be
/// added to it. From the distance of the file's vertices of this element from the wrap, over the radius of a bar with as much volume to its surface as the element's body.
/// 0 of an element without a character and of exact and mended bodies, which are made of the file's own triangles: what lies in holes that were closed nobody knows.
/// Negative: not known, as the wrap is coarser than kKnownDetail. Up to there the estimate is 0.7 to 2.2 times the error on seven bodies; of a wrap of detail 0.05 it was a third.
/// Takes some ten milliseconds.
inline constexpr double kKnownDetail = 0.03;  ///< BodyReport::detail, diagonals; those chosen from the mesh are 0.001 to 0.003
double bodyError(const Document& document, const Element& element);

}  // namespace imomushi
