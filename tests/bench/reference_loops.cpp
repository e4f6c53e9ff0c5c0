// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reference_loops.h"

#include <cstring>

// These loops are for comparison on machines with vectors of a known size of four lanes or more.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/reference_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace imomushi::reference {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

void triad(float* a, const float* b, const float* c, float s, std::size_t count) {
    const D d;
    const V factor = hn::Set(d, s);
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) hn::Store(hn::MulAdd(hn::Load(d, c + i), factor, hn::Load(d, b + i)), d, a + i);
}

HWY_INLINE void unit(V& x, V& y, V& z) {
    const D d;
    const V square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const V factor = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Max(square, hn::Set(d, 1e-30f))));
    x = hn::Mul(x, factor), y = hn::Mul(y, factor), z = hn::Mul(z, factor);
}

void normalsOfTriangles(const float* positions, const std::int32_t* triangles, std::size_t count, float* sums, float* normals, std::size_t vertices) {
    std::memset(sums, 0, 4 * vertices * sizeof(float));
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t f = 0; f < count; ++f) {
        const std::int32_t* corner = triangles + 3 * f;
        const float *p = positions + 3 * corner[0], *q = positions + 3 * corner[1], *r = positions + 3 * corner[2];
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const float n = (q[j] - p[j]) * (r[k] - p[k]) - (q[k] - p[k]) * (r[j] - p[j]);
            for (int c = 0; c < 3; ++c) sums[4 * corner[c] + i] += n;
        }
    }
#else
    const hn::FixedTag<float, 4> d4;
    const hn::FixedTag<std::int32_t, 4> di4;
    HWY_ALIGN static constexpr std::int32_t kNext[4] = {1, 2, 0, 3};
    const auto next = hn::IndicesFromVec(d4, hn::Load(di4, kNext));
    for (std::size_t f = 0; f < count; ++f) {
        const std::ptrdiff_t i = triangles[3 * f], j = triangles[3 * f + 1], k = triangles[3 * f + 2];
        const auto p = hn::LoadU(d4, positions + 3 * i);
        const auto a = hn::Sub(hn::LoadU(d4, positions + 3 * j), p), b = hn::Sub(hn::LoadU(d4, positions + 3 * k), p);
        const auto n = hn::TableLookupLanes(hn::NegMulAdd(hn::TableLookupLanes(a, next), b, hn::Mul(a, hn::TableLookupLanes(b, next))), next);
        for (const auto v : {i, j, k}) hn::Store(hn::Add(hn::Load(d4, sums + 4 * v), n), d4, sums + 4 * v);
    }
#endif
    const D d;
    for (std::size_t v = 0; v < vertices; v += hn::Lanes(d)) {
        V x, y, z, w;
        hn::LoadInterleaved4(d, sums + 4 * v, x, y, z, w);
        unit(x, y, z);
        hn::StoreInterleaved3(x, y, z, d, normals + 3 * v);
    }
}

void normalise(float* normals, std::size_t vertices) {
    const D d;
    for (std::size_t v = 0; v < vertices; v += hn::Lanes(d)) {
        V x, y, z;
        hn::LoadInterleaved3(d, normals + 3 * v, x, y, z);
        unit(x, y, z);
        hn::StoreInterleaved3(x, y, z, d, normals + 3 * v);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace imomushi::reference
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace imomushi::reference {

HWY_EXPORT(triad);
HWY_EXPORT(normalsOfTriangles);
HWY_EXPORT(normalise);

void triad(float* a, const float* b, const float* c, float s, std::size_t count) { HWY_DYNAMIC_DISPATCH(triad)(a, b, c, s, count); }
void normalsOfTriangles(const float* positions, const std::int32_t* triangles, std::size_t count, float* sums, float* normals, std::size_t vertices) {
    HWY_DYNAMIC_DISPATCH(normalsOfTriangles)(positions, triangles, count, sums, normals, vertices);
}
void normalise(float* normals, std::size_t vertices) { HWY_DYNAMIC_DISPATCH(normalise)(normals, vertices); }

}  // namespace imomushi::reference
#endif
