// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/skin_kernels.h"

// For comparison on machines with vectors of a known size of four lanes or more.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/comparison/skin_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace imomushi {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

#if HWY_TARGET == HWY_SCALAR
void skinByMatrix(const LinearSkin& skin, std::size_t begin, std::size_t end, float* positions) {
    for (std::size_t v = begin; v < end; ++v)
        for (int row = 0; row < 3; ++row) {
            float sum = 0.0f;
            for (int k = 0; k < 4; ++k)
                for (int c = 0; c < 4; ++c) sum += skin.weights[4 * v + k] * skin.matrices[skin.offsets[4 * v + k] + 4 * c + row] * skin.rest[4 * v + c];
            positions[3 * v + row] = sum;
        }
}
#else
template <int kRegisters>
HWY_INLINE void skinVertex(const LinearSkin& skin, std::size_t v, float* positions) {
    const D d;
    const std::uint16_t* offset = skin.offsets + 4 * v;
    const float* weight = skin.weights + 4 * v;
    // Written out: the compiler would keep a loop of four.
    const auto matrix = [&](int k) { return skin.matrices + offset[k]; };
    const float *m0 = matrix(0), *m1 = matrix(1), *m2 = matrix(2), *m3 = matrix(3);
    const V w0 = hn::Set(d, weight[0]), w1 = hn::Set(d, weight[1]), w2 = hn::Set(d, weight[2]), w3 = hn::Set(d, weight[3]);
    const auto blend = [&](int r) HWY_ATTR {
        const int at = 16 / kRegisters * r;
        return hn::MulAdd(hn::Load(d, m0 + at), w0, hn::MulAdd(hn::Load(d, m1 + at), w1, hn::MulAdd(hn::Load(d, m2 + at), w2, hn::Mul(hn::Load(d, m3 + at), w3))));
    };
    if constexpr (kRegisters == 1) {
        // x x x x y y y y z z z z 1 1 1 1
        HWY_ALIGN static constexpr std::int32_t kSpread[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
        const hn::RebindToSigned<D> di;
        const V point = hn::TableLookupLanes(hn::LoadDup128(d, skin.rest + 4 * v), hn::IndicesFromVec(d, hn::Load(di, kSpread)));
        const V all = hn::Mul(blend(0), point);
        const hn::Half<D> half;
        const auto two = hn::Add(hn::LowerHalf(half, all), hn::UpperHalf(half, all));
        const hn::Half<decltype(half)> quarter;
        hn::StoreU(hn::Add(hn::LowerHalf(quarter, two), hn::UpperHalf(quarter, two)), quarter, positions + 3 * v);
    } else if constexpr (kRegisters == 2) {
        const hn::RebindToSigned<D> di;
        HWY_ALIGN static constexpr std::int32_t kLow[8] = {0, 0, 0, 0, 1, 1, 1, 1}, kHigh[8] = {2, 2, 2, 2, 3, 3, 3, 3};
        const V point = hn::LoadDup128(d, skin.rest + 4 * v);
        const V all = hn::MulAdd(blend(0), hn::TableLookupLanes(point, hn::IndicesFromVec(d, hn::Load(di, kLow))),
                                 hn::Mul(blend(1), hn::TableLookupLanes(point, hn::IndicesFromVec(d, hn::Load(di, kHigh)))));
        const hn::Half<D> half;
        hn::StoreU(hn::Add(hn::LowerHalf(half, all), hn::UpperHalf(half, all)), half, positions + 3 * v);
    } else {
        const float* p = skin.rest + 4 * v;
        hn::StoreU(hn::MulAdd(blend(0), hn::Set(d, p[0]), hn::MulAdd(blend(1), hn::Set(d, p[1]), hn::MulAdd(blend(2), hn::Set(d, p[2]), blend(3)))), d,
                   positions + 3 * v);
    }
}

// The fourth lane that is stored belongs to the next vertex, which comes later.
void skinByMatrix(const LinearSkin& given, std::size_t begin, std::size_t end, float* positions) {
    const LinearSkin skin = given;  // kept in registers: positions could be part of it otherwise
    for (std::size_t v = begin; v < end; ++v) skinVertex<16 / static_cast<int>(hn::MaxLanes(D()))>(skin, v, positions);
}
#endif

void skinByGather(const LinearSkinBlocks& skin, std::size_t blocks, float* positions) {
    const D d;
    const hn::RebindToSigned<D> di;
    for (std::size_t b = 0; b < blocks; ++b)
        for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
            const float* rest = skin.rest + 48 * b + i;
            const V x = hn::Load(d, rest), y = hn::Load(d, rest + 16), z = hn::Load(d, rest + 32);
            const auto weighted = [&](int k, int row) HWY_ATTR {
                const auto at = hn::Load(di, skin.offsets + 64 * b + 16 * k + i);
                const float* m = skin.matrices + row;
                return hn::Mul(hn::Load(d, skin.weights + 64 * b + 16 * k + i),
                               hn::MulAdd(hn::GatherIndex(d, m, at), x,
                                          hn::MulAdd(hn::GatherIndex(d, m + 4, at), y, hn::MulAdd(hn::GatherIndex(d, m + 8, at), z, hn::GatherIndex(d, m + 12, at)))));
            };
            const auto sum = [&](int row) HWY_ATTR {
                return hn::Add(hn::Add(weighted(0, row), weighted(1, row)), hn::Add(weighted(2, row), weighted(3, row)));
            };
            hn::StoreInterleaved3(sum(0), sum(1), sum(2), d, positions + 3 * (16 * b + i));
        }
}

}  // namespace HWY_NAMESPACE
}  // namespace imomushi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace imomushi {

HWY_EXPORT(skinByMatrix);
HWY_EXPORT(skinByGather);

void skinByMatrix(const LinearSkin& skin, std::size_t begin, std::size_t end, float* positions) {
    HWY_DYNAMIC_DISPATCH(skinByMatrix)(skin, begin, end, positions);
}
void skinByGather(const LinearSkinBlocks& skin, std::size_t blocks, float* positions) { HWY_DYNAMIC_DISPATCH(skinByGather)(skin, blocks, positions); }

}  // namespace imomushi
#endif
