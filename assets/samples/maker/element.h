// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "character.h"
#include "remesh.h"

namespace imomushi::samples {

/// A meshed joint disc, the same for both neighbours: rim points first (counter-clockwise seen along -normal), then the inner ones.
struct Disc {
    Mesh mesh;  ///< wound for the normal of the joint
    int rim = 0;
};

Disc meshDisc(const JointSpec& joint, const Shape& shape);

/// The closed surface of one element: its joint discs, and the shape between them. Coordinates are float values.
Mesh meshElement(const CharacterSpec& character, int element, const std::vector<Disc>& discs);

}  // namespace imomushi::samples
