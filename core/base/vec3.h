// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace imomushi {

/// A point or a direction, m unless said otherwise.
using Vec3 = Eigen::Vector3d;

}  // namespace imomushi
