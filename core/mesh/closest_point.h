// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/mesh/mesh.h"

namespace imomushi {

/// Where on a triangle its nearest point to another point lies.
struct ClosestOnTriangle {
    Vec3 weights;         ///< of the corners, >= 0; their sum is 1 on sides and corners
    bool inside = false;  ///< neither on a side nor on a corner: the weights have any positive sum
};

/// The point of triangle a b c that is nearest to p (Ericson, Real-Time Collision Detection, section 5.1.5). Where b and c are the same, that of the segment
/// a b. ab, ac: sides; ap, bp, cp: from the corners to p. Given one by one, for callers that have p as their origin.
inline ClosestOnTriangle closestOnTriangle(const Vec3& ab, const Vec3& ac, const Vec3& ap, const Vec3& bp, const Vec3& cp) {
    const auto ratio = [](double part, double whole) { return whole > 0.0 ? part / whole : 0.0; };
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0.0 && d2 <= 0.0) return {{1.0, 0.0, 0.0}};
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0.0 && d4 <= d3) return {{0.0, 1.0, 0.0}};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        const double t = ratio(d1, d1 - d3);
        return {{1.0 - t, t, 0.0}};
    }
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0.0 && d5 <= d6) return {{0.0, 0.0, 1.0}};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        const double t = ratio(d2, d2 - d6);
        return {{1.0 - t, 0.0, t}};
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        const double t = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return {{0.0, 1.0 - t, t}};
    }
    return {{va, vb, vc}, true};
}

}  // namespace imomushi
