// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "core/export/gltf_writer.h"

namespace imomushi {

/// The data of live drivers for a rigged character (assets/drivers): they compute the frames of elements and the weights of their targets from the joint points, by the
/// same steps as the studio's own frame. In `extras.imomushi` of the skeleton's node; metres, radians, matrices column by column:
///   version   1
///   points    [{name, rest}]: joint points
///   bones     [{name, start, end, parent, tree, direction, rollSign, length}]: start and end are points; parent: the bone that it hangs on, -1: none;
///             direction: unit, at rest
///   elements  [{name, frame, middle, bones, anchorJoint, anchor, boneLength, faces: [{name, joint, origin, axes, basis, flat, column}], columns,
///             matrix}]: frame: name of its joint in the skeleton; weights of its morph targets = matrix (row by row, #targets x #columns) times v
///   joints    [{point, place, normal, tangent, shrink, led, faces: [{element, face, bone}]}]
/// Elements under a mesh of the scene have no mesh of their own; they say which parts they move (nodes have their number in `extras.part`), and where their targets begin
/// among those of the part:
///   elements  parts: [[part, first]]: weights of the targets from `first` on = matrix times v; where several elements have the same targets, their sum
/// With v as in eq. (5) of Watanabe et al. 2006 (FaceBasis), followed by body loads. Joints take the shape a = b = 1 + shrink * s.
/// Body loads (gravity, inflate, end-stretch), where there are any, as they are in a body at rest; columns follow those of v:
///   gravity   of free fall, m/s^2
///   elements  loads: {column, sizes, most, softness, pressure, forces}: numbers from `column` on are softness * gravity in the axes of the element (with
///             softness), then pressure (with pressure); all of them times most tanh(w / most) / w, w = sum of their absolute values times sizes
///             stretch: {near, end, length, longer, shorter, perMetre}: the first three are more by r tanh(d / r) * perMetre (3 x 3, by columns) times the direction from the point near to
///             the point end in the axes of the element, d = their distance minus length, r = length times longer, where d is negative shorter
/// Smooth joints, where they are on (JointEquilibrium, whose constants these are): S and warping of all joints minimise the sum over elements of
/// 1/2 v^T stiffness v + v^T forces loads, v = of rigid joints + spread times the tables of the joints of its faces, turned:
///   smooth    {entries: per entry of a table [[parameter, share]], parameters, leastStiffness, stretch: [least, most], fold, slope}
///   elements  stiffness: row by row, #v x #v; forces: row by row, #v x #loads; faces: spread: row by row, columns of the face x entries
///   joints    axes, slopes: per place row by row, 2 x warping shapes
/// What moves by itself (dynamics, breath), large motions, fingers and joints of the previous model are not in it.
nlohmann::ordered_json driverData(const GltfContent& content);

}  // namespace imomushi
