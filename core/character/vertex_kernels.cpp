// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/vertex_kernels.h"

#include <algorithm>
#include <cstring>

// Four lanes are a vertex below, which vectors of unknown size (SVE, RISC-V) do not promise: ARM uses NEON.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_SSE4)
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
using DI = hn::RebindToSigned<D>;
using VI = hn::Vec<DI>;
constexpr std::size_t kStride = 3 * kVertexBlock;

struct Three {
    V x, y, z;
};

// Each of these adds A' v to the vertices of block k from lane i on.
struct FloatProduct {
    const float* response;
    const float* weights;
    std::size_t columns;
    HWY_INLINE void add(std::size_t k, std::size_t i, Three& at) const {
        const D d;
        const float* a = response + k * columns * kStride + i;
        for (std::size_t c = 0; c < columns; ++c, a += kStride) {
            const V w = hn::Set(d, weights[c]);
            at.x = hn::MulAdd(hn::Load(d, a), w, at.x);
            at.y = hn::MulAdd(hn::Load(d, a + kVertexBlock), w, at.y);
            at.z = hn::MulAdd(hn::Load(d, a + 2 * kVertexBlock), w, at.z);
        }
    }
};

struct HalfProduct {
    const hwy::float16_t* response;
    const float* weights;
    std::size_t columns;
    HWY_INLINE void add(std::size_t k, std::size_t i, Three& at) const {
        const D d;
        const hn::Rebind<hwy::float16_t, D> dh;
        const hwy::float16_t* a = response + k * columns * kStride + i;
        for (std::size_t c = 0; c < columns; ++c, a += kStride) {
            const V w = hn::Set(d, weights[c]);
            at.x = hn::MulAdd(hn::PromoteTo(d, hn::Load(dh, a)), w, at.x);
            at.y = hn::MulAdd(hn::PromoteTo(d, hn::Load(dh, a + kVertexBlock)), w, at.y);
            at.z = hn::MulAdd(hn::PromoteTo(d, hn::Load(dh, a + 2 * kVertexBlock)), w, at.z);
        }
    }
};

// The sums of products of pairs, lane by lane, of vectors of pairs.
class PairSum {
public:
#if HWY_TARGET == HWY_SCALAR
    HWY_INLINE void add(const std::int16_t* a, const std::int16_t* b) { sum_ += a[0] * b[0] + a[1] * b[1]; }
    [[nodiscard]] HWY_INLINE VI get() const { return hn::Set(DI(), sum_); }

private:
    std::int32_t sum_ = 0;
#else
    HWY_INLINE PairSum() : even_(hn::Zero(DI())), odd_(hn::Zero(DI())) {}  // not left to the compiler, which would forget the target
    HWY_INLINE void add(const std::int16_t* a, const std::int16_t* b) {
        const hn::RepartitionToNarrow<DI> d16;
        std::int32_t pair;
        std::memcpy(&pair, b, sizeof pair);
        even_ = hn::ReorderWidenMulAccumulate(DI(), hn::Load(d16, a), hn::BitCast(d16, hn::Set(DI(), pair)), even_, odd_);
    }
    [[nodiscard]] HWY_INLINE VI get() const { return hn::RearrangeToOddPlusEven(even_, odd_); }

private:
    VI even_, odd_;
#endif
};

struct Int16Product {
    const std::int16_t* response;
    const std::int16_t* weights;
    const float* groups;
    std::size_t pairs;
    HWY_INLINE void add(std::size_t k, std::size_t i, Three& at) const {
        const D d;
        constexpr std::size_t kPairs = kColumnGroup / 2;
        const std::int16_t* a = response + 2 * (k * pairs * kStride + i);
        for (std::size_t first = 0; first < pairs; first += kPairs) {
            PairSum x, y, z;
            for (std::size_t p = first; p < std::min(first + kPairs, pairs); ++p, a += 2 * kStride) {
                x.add(a, weights + 2 * p);
                y.add(a + 2 * kVertexBlock, weights + 2 * p);
                z.add(a + 4 * kVertexBlock, weights + 2 * p);
            }
            const V scale = hn::Set(d, groups[first / kPairs]);
            at.x = hn::MulAdd(hn::ConvertTo(d, x.get()), scale, at.x);
            at.y = hn::MulAdd(hn::ConvertTo(d, y.get()), scale, at.y);
            at.z = hn::MulAdd(hn::ConvertTo(d, z.get()), scale, at.z);
        }
    }
};

class Affine {
public:
    HWY_INLINE explicit Affine(const AffineFloat& a) : a_(a) {}
    HWY_INLINE Three operator()(const Three& at) const { return {row(0, at), row(1, at), row(2, at)}; }

private:
    [[nodiscard]] HWY_INLINE V row(int i, const Three& at) const {
        const D d;
        const float* r = a_.linear + 3 * i;
        return hn::MulAdd(at.x, hn::Set(d, r[0]), hn::MulAdd(at.y, hn::Set(d, r[1]), hn::MulAdd(at.z, hn::Set(d, r[2]), hn::Set(d, a_.shift[i]))));
    }
    const AffineFloat a_;
};

HWY_INLINE void store(const Three& at, float* positions) { hn::StoreInterleaved3(at.x, at.y, at.z, D(), positions); }

HWY_INLINE Three loadThree(const float* from) {
    const D d;
    return {hn::Load(d, from), hn::Load(d, from + kVertexBlock), hn::Load(d, from + 2 * kVertexBlock)};
}

template <class Product>
void evaluateWith(const Product& product, const VertexBlocks& b, const AffineFloat& shape, const AffineFloat& placement, std::size_t begin, std::size_t end, float* local,
                  float* positions) {
    const D d;
    const Affine shaped(shape), placed(placement);
    for (std::size_t k = begin; k < end; ++k)
        for (std::size_t i = 0; i < kVertexBlock; i += hn::Lanes(d)) {
            Three at = shaped(loadThree(b.rest + k * kStride + i));
            product.add(k, i, at);
            if (local) {
                float* out = local + k * kStride + i;
                hn::Store(at.x, d, out), hn::Store(at.y, d, out + kVertexBlock), hn::Store(at.z, d, out + 2 * kVertexBlock);
            }
            store(placed(at), positions + 3 * (static_cast<std::size_t>(b.first[k]) + i));
        }
}

void evaluateAndPlace(const VertexBlocks& b, const Weights& w, const AffineFloat& placement, std::size_t begin, std::size_t end, float* local,
                      float* positions) {
    const auto columns = static_cast<std::size_t>(b.columns);
    switch (b.format) {
        case ResponseFormat::Float:
            return evaluateWith(FloatProduct{static_cast<const float*>(b.response), w.columns, columns}, b, w.affine, placement, begin, end, local, positions);
        case ResponseFormat::Half:
            return evaluateWith(HalfProduct{static_cast<const hwy::float16_t*>(b.response), w.columns, columns}, b, w.affine, placement, begin, end, local,
                                positions);
        case ResponseFormat::Int16:
            return evaluateWith(Int16Product{static_cast<const std::int16_t*>(b.response), w.pairs, w.groups, (columns + 1) / 2}, b, w.affine, placement, begin,
                                end, local, positions);
    }
}

void place(const float* local, const std::int32_t* first, const AffineFloat& placement, std::size_t begin, std::size_t end, float* positions) {
    const Affine placed(placement);
    for (std::size_t k = begin; k < end; ++k)
        for (std::size_t i = 0; i < kVertexBlock; i += hn::Lanes(D()))
            store(placed(loadThree(local + k * kStride + i)), positions + 3 * (static_cast<std::size_t>(first[k]) + i));
}

// The normal of vertex v, not yet of unit length, and a fourth lane of anything.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void rawNormal(const float* positions, std::size_t v, const NormalStencil& stencil, float scale, float* out) {
    float t[3], s[3];
    for (int i = 0; i < 3; ++i) {
        const auto point = [&](std::int32_t p) { return positions[3 * static_cast<std::ptrdiff_t>(p) + i]; };
        const float c = point(stencil.c), e = positions[3 * v + i] - c;
        t[i] = (point(stencil.a) - point(stencil.b) + stencil.part[0] * e) * scale;
        s[i] = (point(stencil.d) - c + stencil.part[1] * e) * scale;
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = t[j] * s[k] - t[k] * s[j];
    }
}
#else
HWY_INLINE void rawNormal(const float* positions, std::size_t v, const NormalStencil& stencil, float scale, float* out) {
    const hn::FixedTag<float, 4> d;
    const hn::FixedTag<std::int32_t, 4> di;
    HWY_ALIGN static constexpr std::int32_t kNext[4] = {1, 2, 0, 3};
    const auto next = hn::IndicesFromVec(d, hn::Load(di, kNext));
    const auto size = hn::Set(d, scale);
    const auto point = [&](std::int32_t i) HWY_ATTR { return hn::LoadU(d, positions + 3 * static_cast<std::ptrdiff_t>(i)); };
    const auto c = point(stencil.c), e = hn::Sub(hn::LoadU(d, positions + 3 * v), c);
    const auto t = hn::Mul(hn::MulAdd(e, hn::Set(d, stencil.part[0]), hn::Sub(point(stencil.a), point(stencil.b))), size);
    const auto s = hn::Mul(hn::MulAdd(e, hn::Set(d, stencil.part[1]), hn::Sub(point(stencil.d), c)), size);
    const auto tn = hn::TableLookupLanes(t, next), sn = hn::TableLookupLanes(s, next);
    hn::Store(hn::TableLookupLanes(hn::NegMulAdd(tn, s, hn::Mul(t, sn)), next), d, out);
}
#endif

void findNormals(const float* positions, const NormalStencil* stencils, float scale, std::size_t begin, std::size_t end, float* normals) {
    const D d;
    const V tiny = hn::Set(d, 1e-30f), one = hn::Set(d, 1.0f);
    HWY_ALIGN float raw[4 * kVertexBlock];
    for (std::size_t first = begin; first < end; first += kVertexBlock) {
        for (std::size_t i = 0; i < kVertexBlock; ++i) rawNormal(positions, first + i, stencils[first + i], scale, raw + 4 * i);
        for (std::size_t i = 0; i < kVertexBlock; i += hn::Lanes(d)) {
            V x, y, z, w;
            hn::LoadInterleaved4(d, raw + 4 * i, x, y, z, w);
            const V square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
            const auto none = hn::Lt(square, tiny);
            const V factor = hn::Div(one, hn::Sqrt(hn::Max(square, tiny)));
            hn::StoreInterleaved3(hn::IfThenZeroElse(none, hn::Mul(x, factor)), hn::IfThenZeroElse(none, hn::Mul(y, factor)),
                                  hn::IfThenElse(none, one, hn::Mul(z, factor)), d, normals + 3 * (first + i));
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace imomushi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace imomushi {

HWY_EXPORT(evaluateAndPlace);
HWY_EXPORT(place);
HWY_EXPORT(findNormals);

void evaluateAndPlace(const VertexBlocks& blocks, const Weights& weights, const AffineFloat& placement, std::size_t begin, std::size_t end,
                      float* local, float* positions) {
    HWY_DYNAMIC_DISPATCH(evaluateAndPlace)(blocks, weights, placement, begin, end, local, positions);
}
void place(const float* local, const std::int32_t* first, const AffineFloat& placement, std::size_t begin, std::size_t end, float* positions) {
    HWY_DYNAMIC_DISPATCH(place)(local, first, placement, begin, end, positions);
}
void findNormals(const float* positions, const NormalStencil* stencils, float scale, std::size_t begin, std::size_t end, float* normals) {
    HWY_DYNAMIC_DISPATCH(findNormals)(positions, stencils, scale, begin, end, normals);
}

}  // namespace imomushi
#endif
