// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/base/progress.h"
#include "core/comparison/model_table.h"

namespace imomushi {

/// A caterpillar of the size in the paper (Watanabe et al. 2006): five cylinders along z, radius .5 m, length 1 m each, 1978 vertices in all, a bone
/// through each, joined face to face, its two ends held by their bones. Responses are left null; elements 0, 1, 3 and 4 are the same body, moved.
/// `around`: vertices around a cylinder, at least 12; other than the paper's 24, all cells are finer by as much.
/// `elements`: at least 1; more than five repeat those.
CharacterInput paperCaterpillar(int around = 24, int elements = 5);

/// The same with the responses of both models. Solved on its own triangles: neither model's cost depends on how well its elements are solved.
/// Errors: those of buildResponse().
Result<ComparedModels> solvedPaperCaterpillar(const Progress& progress);

/// A closed cylinder about z from z = low to low + length: `around` vertices per ring, `along` rows of cells, caps of about square cells with a vertex
/// in their middle.
TriangleMesh closedCylinder(double radius, double low, double length, int around, int along);

}  // namespace imomushi
