// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/mesh/mesh.h"

namespace imomushi {

/// Coordinates in a document are at most this, m: their sixth powers are still finite, and no character is that far away.
inline constexpr double kMaxCoordinate = 1e9;
/// Numbers in a file that is imported are at most this: any unit may be in it. Beyond, a volume times an area would not be finite.
inline constexpr double kMaxImportedCoordinate = 1e50;

/// An axis-aligned box.
struct Bounds {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    [[nodiscard]] Vec3 size() const { return high - low; }
    [[nodiscard]] double diagonal() const { return size().norm(); }
};

/// The bounding box of points (#V x 3, finite); the origin where there are none.
inline Bounds boundsOf(const Points& points) {
    if (points.rows() == 0) return {};
    return {points.colwise().minCoeff().transpose(), points.colwise().maxCoeff().transpose()};
}

/// The diagonal of the bounding box. It sums squares in another order than Bounds::diagonal() and may differ from it in the last bit: keys and stored responses
/// were made with this one.
inline double diagonalOf(const Points& points) {
    return points.rows() > 0 ? (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm() : 0.0;
}

}  // namespace imomushi
