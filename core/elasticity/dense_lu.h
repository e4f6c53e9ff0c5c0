// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/progress.h"

namespace imomushi {

/// As std::malloc, which std::free gives back, but what is large gets large pages where the system has them. Uninitialised; null: there is none.
void* allocateLarge(std::size_t bytes) noexcept;

/// Memory for a large matrix, in large pages where the system has them; not initialised.
template <class T>
class LargeArray {
public:
    LargeArray() = default;
    /// Throws std::bad_alloc.
    explicit LargeArray(std::size_t count);
    [[nodiscard]] T* data() const { return data_.get(); }

private:
    struct Free {
        void operator()(T* p) const;
    };
    std::unique_ptr<T, Free> data_;
};

/// The LU factorisation, with partial pivoting, of a dense single-precision matrix stored by columns; what LAPACK's sgetrf does, but it can be
/// cancelled, and the bytes do not depend on the number of threads: every call of the BLAS runs on one thread (set for the whole process
/// on first use) and works on a tile whose bounds depend on the size alone; the threads share the tiles.
class DenseLu {
public:
    DenseLu() = default;
    /// size x size, uninitialised; the leading dimension leaves a gap so that columns do not fall on the same cache lines. Throws std::bad_alloc.
    explicit DenseLu(std::int32_t size);

    [[nodiscard]] std::int32_t size() const { return size_; }
    [[nodiscard]] float* column(std::int32_t j) const { return a_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(ld_); }
    [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(ld_) * static_cast<std::size_t>(size_) * sizeof(float); }
    static std::size_t bytesFor(std::int32_t size);

    /// Replaces the matrix by its factors. False: cancelled. An exactly singular matrix is noted, see singular().
    bool factorise(int threads, const Progress& progress);
    [[nodiscard]] bool singular() const { return singular_; }

    /// X := A^-1 X or A^-T X; X is size x columns, by columns without gaps. False: cancelled.
    bool solve(float* x, std::int32_t columns, bool transposed, int threads, const Progress& progress) const;

    /// Estimates 1 / (|A| |A^-1|) in the 1-norm from the 1-norm of A, as LAPACK's sgecon does. False: cancelled.
    bool reciprocalCondition(double norm1, int threads, const Progress& progress, double& rcond) const;

private:
    bool solveTriangle(float* x, std::int32_t columns, bool upper, bool transposed, int threads, const Progress& progress) const;

    std::int32_t size_ = 0, ld_ = 0;
    LargeArray<float> a_;
    std::vector<std::int32_t> pivots_;  ///< as LAPACK's ipiv, 1-based
    bool singular_ = false;
};

/// C (rows x columns) := C - A B for double precision, A by rows with leading dimension `ld`, B and C by columns without gaps; or C := -A B
/// when `replace`. Tiled like DenseLu. False: cancelled.
bool subtractProduct(const double* a, std::size_t ld, std::int32_t rows, std::int32_t inner, const double* b, std::int32_t columns,
                     double* c, bool replace, int threads, const Progress& progress);

/// Floating-point operations per second that one thread reaches in the products inside DenseLu, measured now (a few ms).
double measureProductRate();

/// Makes every BLAS call of this process run on its caller's thread. DenseLu and subtractProduct() call it themselves.
void useSingleThreadedBlas();

}  // namespace imomushi
