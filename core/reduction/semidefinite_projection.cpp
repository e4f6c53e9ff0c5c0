// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/semidefinite_projection.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <vector>

#include "core/base/finite.h"
#include "core/base/floating_point_guard.h"
#include "core/elasticity/dense_lu.h"

// Of LAPACK, but neither in lapacke.h nor in lapack.h: reduces the first `nb` columns of a symmetric matrix to tridiagonal form.
extern "C" void dlatrd_(const char* uplo, const lapack_int* n, const lapack_int* nb, double* a, const lapack_int* lda, double* e, double* tau, double* w,
                        const lapack_int* ldw, std::size_t uploLength);

namespace imomushi {

Result<Spectrum> projectToSemidefinite(Eigen::MatrixXd& symmetric, const Progress& progress) {
    useSingleThreadedBlas();
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    const auto notFinite = [] { return fail("singular", "The stiffness of the joints is not finite; choose larger joint faces."); };
    const auto n = static_cast<lapack_int>(symmetric.rows());
    if (n == 0) return Spectrum{};
    if (!allFinite(symmetric)) return notFinite();

    // Tridiagonal form as LAPACK's dsytrd (Dongarra, Hammarling and Sorensen, J. Comput. Appl. Math. 27 (1989) 215), one panel per look at `progress`.
    constexpr lapack_int kPanel = 24;
    Eigen::MatrixXd reduced = symmetric;
    std::vector<double> diagonal(static_cast<std::size_t>(n)), beside(static_cast<std::size_t>(n)), tau(static_cast<std::size_t>(n));
    Eigen::MatrixXd work(n, kPanel);
    lapack_int first = 0;
    for (; n - first > 4 * kPanel; first += kPanel) {
        if (progress.cancelled()) return cancelled();
        const lapack_int rest = n - first;
        double* corner = &reduced(first, first);
        dlatrd_("L", &rest, &kPanel, corner, &n, &beside[static_cast<std::size_t>(first)], &tau[static_cast<std::size_t>(first)], work.data(), &n, 1);
        cblas_dsyr2k(CblasColMajor, CblasLower, CblasNoTrans, rest - kPanel, kPanel, -1.0, corner + kPanel, n, work.data() + kPanel, n, 1.0,
                     &reduced(first + kPanel, first + kPanel), n);
        for (lapack_int j = first; j < first + kPanel; ++j) {
            diagonal[static_cast<std::size_t>(j)] = reduced(j, j);
            reduced(j + 1, j) = beside[static_cast<std::size_t>(j)];
        }
    }
    const auto at = static_cast<std::size_t>(first);
    if (LAPACKE_dsytrd(LAPACK_COL_MAJOR, 'L', n - first, &reduced(first, first), n, &diagonal[at], &beside[at], &tau[at]) != 0) return notFinite();

    std::vector<double> values = diagonal, scratch = beside;
    if (LAPACKE_dsterf(n, values.data(), scratch.data()) != 0) return notFinite();
    const Spectrum out{values.front(), values.back()};
    const auto negative = static_cast<lapack_int>(std::lower_bound(values.begin(), values.end(), 0.0) - values.begin());

    // Subtracts sum lambda v v^T over the negative eigenvalues, some at a time.
    constexpr lapack_int kBatch = 32;
    const FloatingPointGuard guard;
    for (lapack_int from = 0; from < negative; from += kBatch) {
        if (progress.cancelled()) return cancelled();
        const lapack_int count = std::min(kBatch, negative - from);
        std::vector<double> d = diagonal, e = beside, value(static_cast<std::size_t>(n));
        std::vector<lapack_int> support(2 * static_cast<std::size_t>(count));
        Eigen::MatrixXd vectors(n, count);
        lapack_int found = 0;
        lapack_logical tryAccurate = 1;
        if (LAPACKE_dstemr(LAPACK_COL_MAJOR, 'V', 'I', n, d.data(), e.data(), 0.0, 0.0, from + 1, from + count, &found, value.data(), vectors.data(), n, count,
                           support.data(), &tryAccurate) != 0 ||
            found != count ||
            LAPACKE_dormtr(LAPACK_COL_MAJOR, 'L', 'L', 'N', n, count, reduced.data(), n, tau.data(), vectors.data(), n) != 0)
            return notFinite();
        const Eigen::MatrixXd scaled = vectors * Eigen::Map<const Eigen::VectorXd>(value.data(), count).asDiagonal();
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, n, n, count, -1.0, scaled.data(), n, vectors.data(), n, 1.0, symmetric.data(), n);
    }
    return out;
}

}  // namespace imomushi
