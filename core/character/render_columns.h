// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/character/element_runtime.h"

namespace imomushi {

/// Where the vertices of an element (EmbeddedTables) move in its axes per unit of its weights (v, then loads): 3 #vertices x weights, m. Exact for those that
/// are a product. To first order beside joints, where points have a part of their own (EmbeddedMapping::JointPart), and for attached parts; without that part in
/// the basis "full".
Eigen::MatrixXd vertexColumns(const ElementRuntime& runtime);

}  // namespace imomushi
