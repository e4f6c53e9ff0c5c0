// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/dense_lu.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "core/base/finite.h"
#include "core/base/parallel.h"

namespace imomushi {
namespace {

// Columns of a panel, and of the tiles right of it: narrow enough that two threads stay busy and that a tile of the largest matrices takes
// well under 0.1 s (cancelling), wide enough that packing costs little beside multiplying.
constexpr std::int32_t kPanel = 256;
constexpr std::int32_t kTile = 384;
// Rows of a product with few columns: bound by memory, so small tiles cost nothing.
constexpr std::int32_t kRows = 512, kColumns = 384;

constexpr std::size_t kLargePage = std::size_t{2} << 20;

std::int32_t leadingDimension(std::int32_t size) {
    const std::int32_t lines = (size + 15) / 16;
    return 16 * (lines | 1);  // an odd number of cache lines
}

}  // namespace

void useSingleThreadedBlas() {
    // The tiles of a product are shared out by us. OpenBLAS's own threads would split differently for other numbers of threads, and
    // splitting changes the order of sums; LAPACK's panels too.
    static std::once_flag once;
    std::call_once(once, [] { openblas_set_num_threads(1); });
}

void* allocateLarge(std::size_t bytes) noexcept {
    if (bytes < kLargePage) return std::malloc(bytes);
    const std::size_t pages = (bytes + kLargePage - 1) / kLargePage * kLargePage;
    void* p = pages >= bytes ? std::aligned_alloc(kLargePage, pages) : nullptr;
#ifdef __linux__
    if (p) madvise(p, pages, MADV_HUGEPAGE);  // advice only: fewer page faults and TLB misses
#endif
    return p;
}

template <class T>
LargeArray<T>::LargeArray(std::size_t count) : data_(static_cast<T*>(allocateLarge(std::max<std::size_t>(1, count) * sizeof(T)))) {
    if (!data_) throw std::bad_alloc();
}

template <class T>
void LargeArray<T>::Free::operator()(T* p) const {
    std::free(p);
}

template class LargeArray<float>;
template class LargeArray<double>;

DenseLu::DenseLu(std::int32_t size)
    : size_(size),
      ld_(leadingDimension(size)),
      a_(static_cast<std::size_t>(ld_) * static_cast<std::size_t>(size)),
      pivots_(static_cast<std::size_t>(size)) {}

std::size_t DenseLu::bytesFor(std::int32_t size) {
    return static_cast<std::size_t>(leadingDimension(size)) * static_cast<std::size_t>(size) * sizeof(float);
}

bool DenseLu::factorise(int threads, const Progress& progress) {
    useSingleThreadedBlas();
    const std::int32_t n = size_;
    std::atomic<bool> singular{false};
    const auto factorisePanel = [&](std::int32_t k) {
        const std::int32_t width = std::min(kPanel, n - k);
        const int info = LAPACKE_sgetrf_work(LAPACK_COL_MAJOR, n - k, width, column(k) + k, ld_, pivots_.data() + k);
        if (info > 0) singular = true;
        for (std::int32_t i = k; i < k + width; ++i) pivots_[static_cast<std::size_t>(i)] += k;
    };
    if (progress.cancelled()) return false;
    factorisePanel(0);
    for (std::int32_t k = 0; k + kPanel < n; k += kPanel) {
        // Tile 0 is the next panel, which is factorised by the same thread while others work on the rest.
        const std::int32_t rest = k + kPanel;
        const std::int32_t next = std::min(kPanel, n - rest);
        const std::size_t tiles = 1 + static_cast<std::size_t>((n - rest - next + kTile - 1) / kTile);
        parallelFor(threads, tiles, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                if (progress.cancelled()) return;
                const std::int32_t from = t == 0 ? rest : rest + next + static_cast<std::int32_t>(t - 1) * kTile;
                const std::int32_t width = t == 0 ? next : std::min(kTile, n - from);
                LAPACKE_slaswp_work(LAPACK_COL_MAJOR, width, column(from), ld_, k + 1, rest, pivots_.data(), 1);
                cblas_strsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasUnit, kPanel, width, 1.0f, column(k) + k, ld_,
                            column(from) + k, ld_);
                cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, n - rest, width, kPanel, -1.0f, column(k) + rest, ld_,
                            column(from) + k, ld_, 1.0f, column(from) + rest, ld_);
                if (t == 0) factorisePanel(rest);
            }
        });
        if (progress.cancelled()) return false;
        const double left = static_cast<double>(n - rest) / n;
        progress.report("factorise", 1.0 - left * left * left);
    }
    // The row exchanges of later panels, in the columns left of them.
    const std::size_t panels = static_cast<std::size_t>((n + kPanel - 1) / kPanel);
    parallelFor(threads, panels, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const std::int32_t k = static_cast<std::int32_t>(p) * kPanel;
            if (k + kPanel < n)
                LAPACKE_slaswp_work(LAPACK_COL_MAJOR, kPanel, column(k), ld_, k + kPanel + 1, n, pivots_.data(), 1);
        }
    });
    singular_ = singular;
    return !progress.cancelled();
}

bool DenseLu::solveTriangle(float* x, std::int32_t columns, bool upper, bool transposed, int threads, const Progress& progress) const {
    const std::int32_t n = size_;
    const bool forward = upper == transposed;
    const std::int32_t panels = (n + kPanel - 1) / kPanel;
    const CBLAS_TRANSPOSE trans = transposed ? CblasTrans : CblasNoTrans;
    for (std::int32_t p = 0; p < panels; ++p) {
        if (progress.cancelled()) return false;
        const std::int32_t k = (forward ? p : panels - 1 - p) * kPanel;
        const std::int32_t width = std::min(kPanel, n - k);
        cblas_strsm(CblasColMajor, CblasLeft, upper ? CblasUpper : CblasLower, trans, upper ? CblasNonUnit : CblasUnit, width, columns, 1.0f,
                    column(k) + k, ld_, x + k, n);
        const std::int32_t first = forward ? k + width : 0, count = forward ? n - first : k;
        parallelFor(threads, static_cast<std::size_t>((count + kRows - 1) / kRows), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                const std::int32_t row = first + static_cast<std::int32_t>(t) * kRows;
                const std::int32_t rows = std::min(kRows, first + count - row);
                const float* a = transposed ? column(row) + k : column(k) + row;
                if (columns == 1)
                    cblas_sgemv(CblasColMajor, trans, transposed ? width : rows, transposed ? rows : width, -1.0f, a, ld_, x + k, 1, 1.0f,
                                x + row, 1);
                else
                    cblas_sgemm(CblasColMajor, trans, CblasNoTrans, rows, columns, width, -1.0f, a, ld_, x + k, n, 1.0f, x + row, n);
            }
        });
    }
    return true;
}

bool DenseLu::solve(float* x, std::int32_t columns, bool transposed, int threads, const Progress& progress) const {
    useSingleThreadedBlas();
    if (transposed) {
        if (!solveTriangle(x, columns, true, true, threads, progress) || !solveTriangle(x, columns, false, true, threads, progress))
            return false;
        LAPACKE_slaswp_work(LAPACK_COL_MAJOR, columns, x, size_, 1, size_, const_cast<std::int32_t*>(pivots_.data()), -1);
        return true;
    }
    LAPACKE_slaswp_work(LAPACK_COL_MAJOR, columns, x, size_, 1, size_, const_cast<std::int32_t*>(pivots_.data()), 1);
    return solveTriangle(x, columns, false, false, threads, progress) && solveTriangle(x, columns, true, false, threads, progress);
}

bool DenseLu::reciprocalCondition(double norm1, int threads, const Progress& progress, double& rcond) const {
    rcond = 0.0;
    if (singular_ || !(norm1 > 0.0)) return true;
    // Higham's estimator of |A^-1|_1 by reverse communication, so that it can be cancelled between and in its solves.
    const auto n = static_cast<std::size_t>(size_);
    // OpenBLAS's sasum adds in another order where the address is aligned otherwise: memory of fixed alignment repeats to the byte.
    const LargeArray<float> v(n), x(n);
    std::vector<std::int32_t> sign(n);
    std::array<std::int32_t, 3> state{};
    std::int32_t kase = 0;
    float inverseNorm = 0.0f;
    do {
        LAPACKE_slacn2_work(size_, v.data(), x.data(), sign.data(), &inverseNorm, &kase, state.data());
        if (kase != 0 && !solve(x.data(), 1, kase == 2, threads, progress)) return false;
        if (!allFinite(x.data(), static_cast<std::size_t>(n))) return true;  // singular to single precision
    } while (kase != 0);
    if (inverseNorm > 0.0f) rcond = 1.0 / (norm1 * static_cast<double>(inverseNorm));
    return true;
}

double measureProductRate() {
    useSingleThreadedBlas();
    constexpr std::int32_t kHeight = 1024;
    const std::vector<float> a(static_cast<std::size_t>(kHeight * kPanel), 0.5f), b(static_cast<std::size_t>(kPanel * kTile), 0.5f);
    std::vector<float> c(static_cast<std::size_t>(kHeight * kTile));
    double best = 1e30;
    for (int round = 0; round < 4; ++round) {
        const auto start = std::chrono::steady_clock::now();
        cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, kHeight, kTile, kPanel, -1.0f, a.data(), kHeight, b.data(), kPanel, 0.0f,
                    c.data(), kHeight);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return 2.0 * kHeight * kTile * kPanel / best;
}

bool subtractProduct(const double* a, std::size_t ld, std::int32_t rows, std::int32_t inner, const double* b, std::int32_t columns,
                     double* c, bool replace, int threads, const Progress& progress) {
    useSingleThreadedBlas();
    if (rows == 0 || columns == 0) return true;
    parallelFor(threads, static_cast<std::size_t>((rows + kRows - 1) / kRows), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            for (std::int32_t first = 0; first < columns; first += kColumns) {
                if (progress.cancelled()) return;
                const std::int32_t row = static_cast<std::int32_t>(t) * kRows;
                const std::size_t at = static_cast<std::size_t>(first);
                // Stored by rows, A is the transpose of what the BLAS sees.
                cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, std::min(kRows, rows - row), std::min(kColumns, columns - first), inner, -1.0,
                            a + static_cast<std::size_t>(row) * ld, static_cast<std::int32_t>(ld), b + at * static_cast<std::size_t>(inner), inner,
                            replace ? 0.0 : 1.0, c + at * static_cast<std::size_t>(rows) + row, rows);
            }
    });
    return !progress.cancelled();
}

}  // namespace imomushi
