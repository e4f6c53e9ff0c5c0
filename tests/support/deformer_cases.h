// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/character/welded_surface.h"

/// What deformers are judged by: the same characters and poses for tests, benchmarks and samples.
namespace imomushi {

struct DeformerCase {
    std::string name;
    CharacterInput input;   ///< without responses; far caps are held by their bones
    WeldedSurface surface;       ///< of input: closed
    Pose pose;
    Vec3 seamOrigin = Vec3::Zero(), seamNormal = Vec3::UnitX();  ///< the plane of the joint that is looked at, at rest
};

/// "bend 90", "bend 150", "twist 180", "stretch 250", "squash 40": the cylinder of `folder` (tests/data/reference) in its two halves, radius 1, length 8;
/// "S-bend": a cylinder of that size in three elements, bent 75 degrees to and fro; "branch": a square trunk bent 60 degrees beside and towards a branch.
/// Elements that are the same body share their mesh.
std::vector<DeformerCase> deformerCases(const std::string& folder);
DeformerCase deformerCase(const std::string& folder, const std::string& name);

/// For a cylinder bent in its middle.
DeformerCase bentCylinder(const std::string& folder, double angle);

struct DeformationMeasures {
    double volumeChange = 0.0;   ///< relative to rest
    double worstQuality = 1.0;   ///< least of 4 sqrt(3) area / sum of squared edges of a triangle, over that at rest
    int folds = 0;               ///< edges over which normals turn by more than 120 degrees, and than halfway from rest to right back
    int intersections = 0;       ///< pairs of triangles that meet where they should not, 10,000 at most
    double crease = 0.0, creaseBeside = 0.0;  ///< radians: largest turn of normals over an edge in the seam, and in the two rows on each side
};
/// deformed: all vertices of the surface.
DeformationMeasures measureDeformation(const DeformerCase& which, const Points& deformed);

}  // namespace imomushi
