// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace imomushi {

struct Spectrum {
    double lowest = 0.0, highest = 0.0;  ///< eigenvalues
};

/// Sets the negative eigenvalues of a symmetric matrix (n x n, whole) to zero: the nearest positive semi-definite one in the Frobenius norm
/// (Higham 1988). Returns the spectrum it had. In steps of a few hundredths of a second up to n = 3000, as LAPACK's drivers cannot be cancelled.
/// Errors: "cancelled"; "singular" (not finite).
Result<Spectrum> removeNegativePart(Eigen::MatrixXd& symmetric, const Progress& progress);

}  // namespace imomushi
