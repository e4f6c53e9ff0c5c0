// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/vertex_kernels.h"

#include <cstring>

// Four lanes are a vertex below, which vectors of unknown size (SVE, RISC-V) do not promise: ARM uses NEON.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/character/vertex_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace imomushi {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kVertexBlock>;
using V = hn::Vec<D>;

// One vector of vertices of a block, from lane `first` of it.
HWY_INLINE void placeLanes(V x, V y, V z, const Placement& p, const std::int32_t* vertex, std::size_t first, float* positions) {
    const D d;
    const auto row = [&](int i) {
        const float* r = p.rotation + 3 * i;
        return hn::MulAdd(x, hn::Set(d, r[0]), hn::MulAdd(y, hn::Set(d, r[1]), hn::MulAdd(z, hn::Set(d, r[2]), hn::Set(d, p.shift[i]))));
    };
    const V wx = row(0), wy = row(1), wz = row(2);
    const int lanes = static_cast<int>(hn::Lanes(d));
    const std::int32_t* v = vertex + first;
    if (v[lanes - 1] == v[0] + lanes - 1) {  // ascending, so all between follow each other
        hn::StoreInterleaved3(wx, wy, wz, d, positions + 3 * static_cast<std::ptrdiff_t>(v[0]));
        return;
    }
    HWY_ALIGN float out[3 * kVertexBlock];
    hn::StoreInterleaved3(wx, wy, wz, d, out);
    for (int i = 0; i < lanes && v[i] >= 0; ++i) std::memcpy(positions + 3 * static_cast<std::ptrdiff_t>(v[i]), out + 3 * i, 3 * sizeof(float));
}

void evaluateAndPlace(const FreeBlocks& b, const float* v, const Placement& p, float* positions) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    constexpr std::size_t kStride = 3 * kVertexBlock;
    const std::size_t column = kStride, block = kStride * static_cast<std::size_t>(b.columns);
    // Two blocks at a time: six independent sums hide the latency of the additions.
    std::size_t k = 0;
    for (; k + 1 < b.blocks; k += 2) {
        const float* a0 = b.response + k * block;
        const float* a1 = a0 + block;
        for (std::size_t i = 0; i < kVertexBlock; i += lanes) {
            const float* r = b.rest + k * kStride + i;
            V x0 = hn::Load(d, r), y0 = hn::Load(d, r + kVertexBlock), z0 = hn::Load(d, r + 2 * kVertexBlock);
            r += kStride;
            V x1 = hn::Load(d, r), y1 = hn::Load(d, r + kVertexBlock), z1 = hn::Load(d, r + 2 * kVertexBlock);
            for (int c = 0; c < b.columns; ++c) {
                const V w = hn::Set(d, v[c]);
                const float* c0 = a0 + static_cast<std::size_t>(c) * column + i;
                const float* c1 = a1 + static_cast<std::size_t>(c) * column + i;
                x0 = hn::MulAdd(hn::Load(d, c0), w, x0);
                y0 = hn::MulAdd(hn::Load(d, c0 + kVertexBlock), w, y0);
                z0 = hn::MulAdd(hn::Load(d, c0 + 2 * kVertexBlock), w, z0);
                x1 = hn::MulAdd(hn::Load(d, c1), w, x1);
                y1 = hn::MulAdd(hn::Load(d, c1 + kVertexBlock), w, y1);
                z1 = hn::MulAdd(hn::Load(d, c1 + 2 * kVertexBlock), w, z1);
            }
            float* out = b.local + k * kStride + i;
            hn::Store(x0, d, out), hn::Store(y0, d, out + kVertexBlock), hn::Store(z0, d, out + 2 * kVertexBlock);
            out += kStride;
            hn::Store(x1, d, out), hn::Store(y1, d, out + kVertexBlock), hn::Store(z1, d, out + 2 * kVertexBlock);
            placeLanes(x0, y0, z0, p, b.vertex + k * kVertexBlock, i, positions);
            placeLanes(x1, y1, z1, p, b.vertex + (k + 1) * kVertexBlock, i, positions);
        }
    }
    for (; k < b.blocks; ++k)
        for (std::size_t i = 0; i < kVertexBlock; i += lanes) {
            const float* r = b.rest + k * kStride + i;
            V x = hn::Load(d, r), y = hn::Load(d, r + kVertexBlock), z = hn::Load(d, r + 2 * kVertexBlock);
            for (int c = 0; c < b.columns; ++c) {
                const V w = hn::Set(d, v[c]);
                const float* a = b.response + k * block + static_cast<std::size_t>(c) * column + i;
                x = hn::MulAdd(hn::Load(d, a), w, x);
                y = hn::MulAdd(hn::Load(d, a + kVertexBlock), w, y);
                z = hn::MulAdd(hn::Load(d, a + 2 * kVertexBlock), w, z);
            }
            float* out = b.local + k * kStride + i;
            hn::Store(x, d, out), hn::Store(y, d, out + kVertexBlock), hn::Store(z, d, out + 2 * kVertexBlock);
            placeLanes(x, y, z, p, b.vertex + k * kVertexBlock, i, positions);
        }
}

void place(const FreeBlocks& b, const Placement& p, float* positions) {
    const D d;
    for (std::size_t k = 0; k < b.blocks; ++k)
        for (std::size_t i = 0; i < kVertexBlock; i += hn::Lanes(d)) {
            const float* l = b.local + k * 3 * kVertexBlock + i;
            placeLanes(hn::Load(d, l), hn::Load(d, l + kVertexBlock), hn::Load(d, l + 2 * kVertexBlock), p, b.vertex + k * kVertexBlock, i,
                       positions);
        }
}

void sumNormals(const float* positions, const std::int32_t* triangles, std::size_t count, float scale, float* sums, std::size_t vertices) {
#if HWY_TARGET == HWY_SCALAR
    std::memset(sums, 0, 4 * vertices * sizeof(float));
    for (std::size_t f = 0; f < count; ++f) {
        const std::int32_t* corner = triangles + 3 * f;
        const float* p = positions + 3 * static_cast<std::ptrdiff_t>(corner[0]);
        float a[3], b[3];
        for (int i = 0; i < 3; ++i) {
            a[i] = (positions[3 * static_cast<std::ptrdiff_t>(corner[1]) + i] - p[i]) * scale;
            b[i] = (positions[3 * static_cast<std::ptrdiff_t>(corner[2]) + i] - p[i]) * scale;
        }
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < 3; ++i)
                sums[4 * static_cast<std::ptrdiff_t>(corner[c]) + i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    }
#else
    const hn::FixedTag<float, 4> d;
    const hn::FixedTag<std::int32_t, 4> di;
    HWY_ALIGN static constexpr std::int32_t kNext[4] = {1, 2, 0, 3};
    const auto next = hn::IndicesFromVec(d, hn::Load(di, kNext));
    const auto zero = hn::Zero(d);
    for (std::size_t i = 0; i < vertices; ++i) hn::Store(zero, d, sums + 4 * i);
    const auto size = hn::Set(d, scale);
    for (std::size_t f = 0; f < count; ++f) {
        const std::ptrdiff_t i = triangles[3 * f], j = triangles[3 * f + 1], k = triangles[3 * f + 2];
        const auto p = hn::LoadU(d, positions + 3 * i);
        const auto a = hn::Mul(hn::Sub(hn::LoadU(d, positions + 3 * j), p), size);
        const auto b = hn::Mul(hn::Sub(hn::LoadU(d, positions + 3 * k), p), size);
        const auto an = hn::TableLookupLanes(a, next), bn = hn::TableLookupLanes(b, next);
        const auto normal = hn::TableLookupLanes(hn::NegMulAdd(an, b, hn::Mul(a, bn)), next);
        float* si = sums + 4 * i;
        float* sj = sums + 4 * j;
        float* sk = sums + 4 * k;
        hn::Store(hn::Add(hn::Load(d, si), normal), d, si);
        hn::Store(hn::Add(hn::Load(d, sj), normal), d, sj);
        hn::Store(hn::Add(hn::Load(d, sk), normal), d, sk);
    }
#endif
}

void normalise(const float* sums, float* normals, std::size_t vertices) {
    const D d;
    // Sums are of about (edge / size of the element)^2: below this a vertex has no area around it.
    const V tiny = hn::Set(d, 1e-30f), one = hn::Set(d, 1.0f);
    for (std::size_t i = 0; i < vertices; i += hn::Lanes(d)) {
        V x, y, z, w;
        hn::LoadInterleaved4(d, sums + 4 * i, x, y, z, w);
        const V square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
        const auto none = hn::Lt(square, tiny);
        const V factor = hn::Div(one, hn::Sqrt(hn::Max(square, tiny)));
        hn::StoreInterleaved3(hn::IfThenZeroElse(none, hn::Mul(x, factor)), hn::IfThenZeroElse(none, hn::Mul(y, factor)),
                              hn::IfThenElse(none, one, hn::Mul(z, factor)), d, normals + 3 * i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace imomushi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace imomushi {

HWY_EXPORT(evaluateAndPlace);
HWY_EXPORT(place);
HWY_EXPORT(sumNormals);
HWY_EXPORT(normalise);

void evaluateAndPlace(const FreeBlocks& blocks, const float* v, const Placement& placement, float* positions) {
    HWY_DYNAMIC_DISPATCH(evaluateAndPlace)(blocks, v, placement, positions);
}
void place(const FreeBlocks& blocks, const Placement& placement, float* positions) {
    HWY_DYNAMIC_DISPATCH(place)(blocks, placement, positions);
}
void sumNormals(const float* positions, const std::int32_t* triangles, std::size_t count, float scale, float* sums, std::size_t vertices) {
    HWY_DYNAMIC_DISPATCH(sumNormals)(positions, triangles, count, scale, sums, vertices);
}
void normalise(const float* sums, float* normals, std::size_t vertices) { HWY_DYNAMIC_DISPATCH(normalise)(sums, normals, vertices); }

}  // namespace imomushi
#endif
