// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/render/scene.h"

namespace imomushi {

/// A camera that looks along `direction` (from eye to target, any length) and frames all bodies of `scene` tightly. `aspect`: width by height.
/// `fill`: how much of the picture the bodies may fill; the rest is room for the shadow and for the eye. An empty scene is framed as the unit cube on
/// the ground.
render::Camera framed(const render::Scene& scene, const Vec3& direction, double aspect, double fill = 0.84);

/// The direction of the view that a file opens with: from the front, the right and above.
Vec3 threeQuarterDirection();

}  // namespace imomushi
