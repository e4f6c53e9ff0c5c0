// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "core/export/gltf_writer.h"

namespace imomushi {

/// What moves a rigged character live (assets/drivers): from joint points to the frames of elements and the weights of their targets, by the steps of the
/// studio's own frame. In `extras.imomushi` of the skeleton's node; metres, radians, matrices column by column:
///   version   1
///   points    [{name, rest}]: joint points
///   bones     [{name, start, end, parent, tree, direction, rollSign, length}]: start and end are points; parent: the bone that it hangs on, -1: none;
///             direction: unit, at rest
///   elements  [{name, frame, middle, bones, anchorJoint, anchor, boneLength, faces: [{name, joint, origin, axes, basis, flat, column}], columns,
///             matrix}]: frame: name of its joint in the skeleton; weights of its morph targets = matrix (row by row, #targets x #columns) times v
///   joints    [{point, place, normal, tangent, shrink, led, faces: [{element, face, bone}]}]
/// With v as in eq. (5) of Watanabe et al. 2006 (FaceBasis). Joints take the shape a = b = 1 + shrink * s; what smooth joints, body loads and other effects
/// add is not in it.
nlohmann::ordered_json driverData(const GltfContent& content);

}  // namespace imomushi
