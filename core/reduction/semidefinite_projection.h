// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace imomushi {

struct Spectrum {
    double lowest = 0.0, highest = 0.0;  ///< eigenvalues
};

/// Replaces a symmetric matrix (n x n, both triangles stored) by the nearest positive semidefinite one in the Frobenius norm: negative eigenvalues become zero
/// (Higham, Linear Algebra Appl. 103 (1988) 103). Returns the spectrum it had. LAPACK's drivers cannot be cancelled, so the steps are called one by one; each
/// takes a few hundredths of a second up to n = 3000.
/// Errors: "cancelled"; "singular" (not finite).
Result<Spectrum> projectToSemidefinite(Eigen::MatrixXd& symmetric, const Progress& progress);

}  // namespace imomushi
