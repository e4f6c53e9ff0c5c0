// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/body/cut.h"
#include "core/mesh/mesh.h"
#include "core/proposal/surface_tips.h"

// Of proposeFromShape() alone. Lengths are in diagonals: bodies here have a bounding box of diagonal 1.
namespace imomushi {

struct Hub;

/// A line through flesh, from a hub outward to a tip or another hub.
struct Limb {
    int point = 0;               ///< of the hub, where it begins
    std::vector<Vec3> line;      ///< from the hub's point to the tip, on the surface, or the first point of `end`
    std::vector<double> radius;  ///< per point of the line, of the largest ball in the body
    double share = 0.0;          ///< of the flesh, with what hangs on it, 0...1
    std::vector<Hub> end;        ///< one or none: a tip
    int side = 0;                ///< of a body with a mirror plane: 1 in front of it, -1 behind, 0 in it
    int twin = -1;               ///< limb of the same hub that is its mirror image, -1: none
    double hidden = 0.0;         ///< length of the line within the hub: up to the fork of the skeleton where it leaves the hub's other lines, and out of the flesh there
    double own = 0.0;            ///< length of the line, up to the tip, that surely lies outside of the flesh that the limb grows from; 0: not known
    double beyond = 0.0;         ///< length of what went on in its line before others were found to grow from it
    int lost = -1;               ///< tip of the surface that the skeleton lost, -1: it is of the skeleton
    bool stump = false;          ///< what is left of a limb beyond those that grow from it, too short to be one: only its tip counts

    [[nodiscard]] const Vec3& tip() const { return line.back(); }
    [[nodiscard]] double length() const;
};

/// Where limbs meet: the trunk, a head with ears, a hand.
struct Hub {
    std::vector<Vec3> points;    ///< one, or the two ends of its line: in the first the limb begins that leads here
    std::vector<double> radius;  ///< per point
    std::vector<Limb> limbs;
};

/// The limbs of a body. A body without any that has one long line (a snake) has a root with two limbs from its middle, `chain`.
struct LimbTree {
    Hub root;
    bool chain = false;
    bool blob = false;  ///< neither limbs nor length: root has a point and no limb
    struct LeftOut {
        Vec3 place;
        double share = 0.0;
        std::string why;
    };
    std::vector<LeftOut> leftOut;  ///< branches of the skeleton that are no limbs
    int rings = 0;                 ///< of the skeleton that were opened
};

/// `mesh`: of evenMesh(). `up`: unit, in its coordinates. `least`: the smallest share of the flesh of a limb, 0...1. Errors: those of flowSkeleton().
Result<LimbTree> findLimbs(const TriangleMesh& mesh, const Vec3& up, double least, const Progress& progress);

/// A branch is a limb where it stands out of the flesh that it grows from by this much: in diagonals, and in its own thicknesses.
inline constexpr double kLeastReach = 0.035, kLeastSlenderness = 0.6;
/// A limb has left its hub's flesh outside this part of the hub's ball.
inline constexpr double kOutside = 0.6;

/// Adds the limbs that the skeleton lost: tips of the surface that no limb ends in. Each grows from the hub or limb whose flesh is nearest to its base; a limb gets a hub there.
/// `mesh`: that of the tips. `without`: per tip, 1: it is left out. False: none was added.
bool addLostLimbs(LimbTree& tree, const TriangleMesh& mesh, const SurfaceTips& tips, const std::vector<char>& without, double least);

/// Makes the tree its own mirror image: limbs are paired, one of each pair becomes the image of the other; what lies across the plane is laid into it.
void symmetrise(LimbTree& tree, const CutPlane& plane);

/// The point at a way along a line, m.
Vec3 pointAlong(const std::vector<Vec3>& line, double way);
double lengthOf(const std::vector<Vec3>& line);

}  // namespace imomushi
