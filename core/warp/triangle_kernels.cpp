// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/warp/triangle_kernels.h"

#include <algorithm>

// Vectors of unknown size (SVE, RISC-V) cannot be kept in structures: ARM uses NEON.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/warp/triangle_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace imomushi {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Half the difference d of principal strains counts as d / (1 + k d^2)^(1/4): exact to second order, .40 instead of .6 (a stretch of 1.8 along, 1/1.8 across), and as
// asinh(4 d) / 4 up to there. Their mean is lessened by the same factor: where all of a pull goes into a thin ankle, it would grow across instead of thinner.
constexpr float kSoftening = 32.0f / 3.0f;
// Mean principal strains stay below this, approached smoothly, and differences at it: a factor of 20.
constexpr float kMaxStrain = 3.0f;
// Rotations do not go farther (radians).
constexpr float kMaxAngle = 7.0f;
// The fit of rotations sees the rotation that the response says as this part of what it fits to: without it collapsed triangles would have none.
constexpr float kGuess = 0.05f;
constexpr float kTiny = 1e-12f;
// Of the parts of a sum: what single precision does not tell from 0.
constexpr float kRounded = 1e-6f;

using D = hn::CappedTag<float, kWarpBatch>;
using V = hn::Vec<D>;
using I = hn::Vec<hn::RebindToSigned<D>>;

HWY_INLINE V set(float x) { return hn::Set(D(), x); }

struct Three {
    V x, y, z;
};
HWY_INLINE Three operator+(const Three& a, const Three& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE Three operator-(const Three& a, const Three& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE Three scaled(V s, const Three& a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }
// s a + b.
HWY_INLINE Three along(V s, const Three& a, const Three& b) { return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)}; }
HWY_INLINE V dot(const Three& a, const Three& b) { return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z))); }
HWY_INLINE Three cross(const Three& a, const Three& b) {
    return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)), hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE V norm(const Three& a) { return hn::Sqrt(dot(a, a)); }
// a b + c d.
HWY_INLINE V twoProducts(V a, V b, V c, V d) { return hn::MulAdd(a, b, hn::Mul(c, d)); }

HWY_INLINE V load(const float* from, std::size_t lane) { return hn::LoadU(D(), from + lane); }
HWY_INLINE void store(V v, float* to, std::size_t lane) { hn::StoreU(v, D(), to + lane); }
HWY_INLINE Three gather(const float* vectors, I at) {
    return {hn::GatherIndex(D(), vectors, at), hn::GatherIndex(D(), vectors + 1, at), hn::GatherIndex(D(), vectors + 2, at)};
}
HWY_INLINE I corner(const WarpBatch& t, int c, std::size_t lane) { return hn::LoadU(hn::RebindToSigned<D>(), t.corner[c] + lane); }
HWY_INLINE Three given(const float* from) { return {set(from[0]), set(from[1]), set(from[2])}; }
HWY_INLINE Three times(const float* rows, const Three& a) { return {dot(given(rows), a), dot(given(rows + 3), a), dot(given(rows + 6), a)}; }

struct Gradient {
    Three w;           // rotation vector
    V e11, e12, e22;   // strain in the axes below
    Three t1, t2;
    V l, p, q;         // sides: l t1 and p t1 + q t2
};

// Of displacement over a base, on a free surface: the normal follows without shear.
HWY_INLINE Gradient gradientOf(const WarpBatch& t, std::size_t lane, const float* base, const float* displacement) {
    const I v0 = corner(t, 0, lane), v1 = corner(t, 1, lane), v2 = corner(t, 2, lane);
    const Three b0 = gather(base, v0), e1 = gather(base, v1) - b0, e2 = gather(base, v2) - b0;
    const Three d0 = gather(displacement, v0), u1 = gather(displacement, v1) - d0, u2 = gather(displacement, v2) - d0;
    const V one = set(1.0f), half = set(0.5f);
    Gradient g;
    const Three normal = cross(e1, e2);
    const V area = hn::Max(norm(normal), set(kTiny * kTiny));
    g.l = hn::Max(norm(e1), set(kTiny));
    const V overL = hn::Div(one, g.l);
    g.t1 = scaled(overL, e1);
    const Three n = scaled(hn::Div(one, area), normal);
    g.t2 = cross(n, g.t1);
    g.p = dot(g.t1, e2);
    g.q = hn::Max(hn::Mul(area, overL), set(kTiny));
    const Three d1 = scaled(overL, u1), d2 = scaled(hn::Div(one, g.q), along(hn::Neg(g.p), d1, u2));
    g.e11 = dot(g.t1, d1);
    g.e22 = dot(g.t2, d2);
    const V a = dot(g.t1, d2), b = dot(g.t2, d1);
    g.e12 = hn::Mul(half, hn::Add(a, b));
    g.w = along(dot(n, d2), g.t1, along(hn::Neg(dot(n, d1)), g.t2, scaled(hn::Mul(half, hn::Sub(b, a)), n)));
    return g;
}

// What triangles take over from a face, `part` of them.
HWY_INLINE void followFace(const FaceStrain& face, V part, const Gradient& own, Gradient& g) {
    // Twist about the normal of the face and the shear with it make no crease: they stay.
    const Three n = given(face.normal), w = given(face.w) - own.w;
    g.w = along(part, along(hn::Neg(dot(w, n)), n, w), g.w);
    const Three a = times(face.e, own.t1), b = times(face.e, own.t2);
    const V d11 = hn::Sub(dot(own.t1, a), own.e11), d22 = hn::Sub(dot(own.t2, b), own.e22), d12 = hn::Sub(dot(own.t1, b), own.e12);
    const V x = dot(n, own.t1), y = dot(n, own.t2), squared = twoProducts(x, x, y, y), least = set(1e-3f);  // across the rim
    const V xy = hn::Mul(x, y), difference = hn::Mul(hn::Sub(x, y), hn::Add(x, y)), bounded = hn::Max(squared, least);
    const V shear = hn::Div(twoProducts(xy, hn::Sub(d22, d11), difference, d12), hn::Mul(bounded, bounded));
    const V kept = hn::IfThenElseZero(hn::Gt(squared, least), hn::Mul(part, shear));
    const V twice = hn::Mul(hn::Add(xy, xy), kept);
    g.e11 = hn::Add(g.e11, hn::MulAdd(part, d11, twice));
    g.e22 = hn::Add(g.e22, hn::MulSub(part, d22, twice));
    g.e12 = hn::Add(g.e12, hn::MulSub(part, d12, hn::Mul(difference, kept)));
}

// Turns a by the rotation vector w: sin / angle, (1 - cos) / angle^2.
HWY_INLINE Three turned(const Three& w, V first, V second, const Three& a) {
    const Three wa = cross(w, a);
    return along(first, wa, along(second, cross(w, wa), a));
}

// Of the mean and half the difference of principal strains.
HWY_INLINE V squaredStrain(const Gradient& g) {
    const V mean = hn::Mul(set(0.5f), hn::Add(g.e11, g.e22)), deviation = hn::Mul(set(0.5f), hn::Sub(g.e11, g.e22));
    return hn::MulAdd(mean, mean, twoProducts(deviation, deviation, g.e12, g.e12));
}

struct Target {
    V p1x, p1y, p2x, p2y;
    Three x, y;
};

// exp for |x| <= kMaxStrain, to 1e-3 there and 1e-6 for |x| <= 1.
HWY_INLINE V quickExp(V x) {
    const V y = hn::Mul(set(0.25f), x), even = hn::MulAdd(hn::Mul(y, y), set(1.0f / 12.0f), set(1.0f)), odd = hn::Mul(set(0.5f), y);
    const V part = hn::Div(hn::Add(even, odd), hn::Sub(even, odd)), twice = hn::Mul(part, part);
    return hn::Mul(twice, twice);
}

HWY_INLINE Target targetOf(const Gradient& g) {
    const V one = set(1.0f), half = set(0.5f);
    // exp of the strain, in two dimensions: exp(mean) (cosh d + sinh d / d deviation).
    const V deviation = hn::Mul(half, hn::Sub(g.e11, g.e22)), squared = twoProducts(deviation, deviation, g.e12, g.e12), d = hn::Sqrt(squared);
    const V softening = hn::Div(one, hn::Sqrt(hn::Sqrt(hn::MulAdd(set(kSoftening), squared, one))));
    const V softer = hn::Min(set(kMaxStrain), hn::Mul(d, softening));
    const V sum = hn::Mul(hn::Mul(half, softening), hn::Add(g.e11, g.e22)), most = hn::Mul(sum, set(1.0f / kMaxStrain));
    const V mean = hn::Div(sum, hn::Sqrt(hn::MulAdd(most, most, one)));
    const V grown = quickExp(softer), shrunk = hn::Div(one, grown), size = quickExp(mean), halfSize = hn::Mul(half, size), least = set(1e-6f);
    const V c = hn::Mul(halfSize, hn::Add(grown, shrunk));
    const V s = hn::IfThenElse(hn::Gt(d, least), hn::Div(hn::Mul(halfSize, hn::Sub(grown, shrunk)), hn::Max(d, least)), size);
    const V a11 = hn::MulAdd(s, deviation, c), a22 = hn::NegMulAdd(s, deviation, c), a12 = hn::Mul(s, g.e12);
    // Half the curl of a displacement is a rotation while strains are small. Where they are large, surfaces turn by slope over length: less by (1 + strain^4)^(1/4), which is
    // exact to fourth order. Elsewhere at most kMaxAngle. From an eighth of the angle by doubling, to 1e-5.
    const V angle2 = dot(g.w, g.w), limit = set(kMaxAngle * kMaxAngle);
    const V strain2 = squaredStrain(g);
    const V less = hn::Div(one, hn::Sqrt(hn::Sqrt(hn::MulAdd(strain2, strain2, one))));
    const V part = hn::Min(less, hn::Div(set(kMaxAngle), hn::Sqrt(hn::Max(angle2, limit))));
    const V x = hn::Mul(hn::Mul(angle2, hn::Mul(part, part)), set(1.0f / 64.0f));
    V sine = hn::NegMulAdd(x, hn::NegMulAdd(x, hn::NegMulAdd(x, set(1.0f / 5040.0f), set(1.0f / 120.0f)), set(1.0f / 6.0f)), one);
    V cosine = hn::NegMulAdd(
        x, hn::NegMulAdd(x, hn::NegMulAdd(x, hn::NegMulAdd(x, set(1.0f / 40320.0f), set(1.0f / 720.0f)), set(1.0f / 24.0f)), half), one);
    V before = sine;
    for (int doubling = 0; doubling < 3; ++doubling) {
        before = sine;
        sine = hn::Mul(sine, cosine);
        cosine = hn::MulSub(hn::Add(cosine, cosine), cosine, one);
    }
    const V first = hn::Mul(sine, part), second = hn::Mul(half, hn::Mul(hn::Mul(before, before), hn::Mul(part, part)));
    return {hn::Mul(a11, g.l),
            hn::Mul(a12, g.l),
            twoProducts(a11, g.p, a12, g.q),
            twoProducts(a12, g.p, a22, g.q),
            turned(g.w, first, second, g.t1),
            turned(g.w, first, second, g.t2)};
}

// c11 a + c12 b, where a is nearly b in a needle, whose c11 is nearly -c12: by what the two differ by.
HWY_INLINE Three weighed(V c11, V c12, const Three& a, const Three& b) { return along(hn::Add(c11, c12), a, scaled(hn::Neg(c12), a - b)); }

// The rotation that brings the target nearest to sides x1, x2: a polar decomposition of 3 x 2.
HWY_INLINE void fit(V c11, V c12, V c22, const Three& x1, const Three& x2, Target& target) {
    const V one = set(1.0f), guess = set(kGuess);
    // Each edge by its own weight: the sum over corners loses all digits in a needle. What rounding leaves of slivers that are flat is no less than kRounded of its parts.
    const V dx = hn::Sub(target.p1x, target.p2x), dy = hn::Sub(target.p1y, target.p2y);
    const V e1 = hn::Mul(hn::Add(c11, c12), twoProducts(target.p1x, target.p1x, target.p1y, target.p1y)), e2 = hn::Mul(hn::Add(c22, c12), twoProducts(target.p2x, target.p2x, target.p2y, target.p2y)),
            e12 = hn::Neg(hn::Mul(c12, twoProducts(dx, dx, dy, dy)));
    const V energy = hn::Mul(set(0.5f), hn::Add(hn::Add(e1, e2), e12)), parts = hn::Add(hn::Add(hn::Abs(e1), hn::Abs(e2)), hn::Abs(e12));
    const V over = hn::Div(one, hn::Max(energy, hn::MulAdd(set(kRounded), parts, set(1e-30f))));
    const Three f1 = scaled(over, weighed(c11, c12, x1, x2)), f2 = scaled(over, weighed(c22, c12, x2, x1));
    const Three a = along(target.p1x, f1, along(target.p2x, f2, scaled(guess, target.x))), b = along(target.p1y, f1, along(target.p2y, f2, scaled(guess, target.y)));
    const V aa = dot(a, a), bb = dot(b, b), ab = dot(a, b);
    const V root = hn::Sqrt(hn::Max(hn::MulSub(aa, bb, hn::Mul(ab, ab)), set(1e-4f * kGuess * kGuess)));
    const V trace = hn::Sqrt(hn::Add(hn::Add(aa, bb), hn::Add(root, root))), by = hn::Div(one, hn::Mul(root, trace)), less = hn::Neg(ab);
    target.x = scaled(by, along(hn::Add(bb, root), a, scaled(less, b)));
    target.y = scaled(by, along(hn::Add(aa, root), b, scaled(less, a)));
}

// The forces of a batch, vector after vector.
struct Forces {
    alignas(64) float f1[4 * kWarpBatch], f2[4 * kWarpBatch];
};

HWY_INLINE void pull(V c11, V c12, V c22, const Three& x1, const Three& x2, const Target& target, Forces& out, std::size_t lane) {
    const Three d1 = along(target.p1x, target.x, scaled(target.p1y, target.y)) - x1, d2 = along(target.p2x, target.x, scaled(target.p2y, target.y)) - x2;
    const Three f1 = weighed(c11, c12, d1, d2), f2 = weighed(c22, c12, d2, d1);
    const V nothing = hn::Zero(D());
    hn::StoreInterleaved4(f1.x, f1.y, f1.z, nothing, D(), out.f1 + 4 * lane);
    hn::StoreInterleaved4(f2.x, f2.y, f2.z, nothing, D(), out.f2 + 4 * lane);
}

// One triangle after the other: they share vertices.
HWY_INLINE void scatter(const WarpBatch& t, const Forces& forces, float* force) {
    for (int i = 0; i < kWarpBatch; ++i) {
        float *v0 = force + t.corner[0][i], *v1 = force + t.corner[1][i], *v2 = force + t.corner[2][i];
        const float *f1 = forces.f1 + 4 * i, *f2 = forces.f2 + 4 * i;
        for (int c = 0; c < 4; ++c) v0[c] -= f1[c] + f2[c];
        for (int c = 0; c < 4; ++c) v1[c] += f1[c];
        for (int c = 0; c < 4; ++c) v2[c] += f2[c];
    }
}

float pullToResponse(const WarpBatch* batches, std::size_t count, const FollowBatch* follow, std::size_t followCount, const FaceStrain* faces,
                     const float* base, const float* displacement, const float* at, TargetBatch* targets, float* force) {
    Forces forces;
    std::size_t first = 0;
    V largest = hn::Zero(D());
    for (std::size_t k = 0; k < count; ++k) {
        const WarpBatch& t = batches[k];
        std::size_t last = first;
        while (last < followCount && static_cast<std::size_t>(follow[last].batch) == k) ++last;
        for (std::size_t lane = 0; lane < kWarpBatch; lane += hn::Lanes(D())) {
            const Gradient own = gradientOf(t, lane, base, displacement);
            Gradient g = own;
            for (std::size_t f = first; f < last; ++f)
                followFace(faces[follow[f].face], hn::Mul(load(follow[f].part, lane), set(faces[follow[f].face].weight)), own, g);
            const Target target = targetOf(g);
            const Three x0 = gather(at, corner(t, 0, lane)), x1 = gather(at, corner(t, 1, lane)) - x0, x2 = gather(at, corner(t, 2, lane)) - x0;
            pull(load(t.c11, lane), load(t.c12, lane), load(t.c22, lane), x1, x2, target, forces, lane);
            TargetBatch& to = targets[k];
            store(target.p1x, to.p1x, lane), store(target.p1y, to.p1y, lane), store(target.p2x, to.p2x, lane), store(target.p2y, to.p2y, lane);
            store(target.x.x, to.x[0], lane), store(target.x.y, to.x[1], lane), store(target.x.z, to.x[2], lane);
            store(target.y.x, to.y[0], lane), store(target.y.y, to.y[1], lane), store(target.y.z, to.y[2], lane);
            const V strain = hn::Sqrt(squaredStrain(g));
            store(strain, to.strain, lane);
            largest = hn::Max(largest, strain);
        }
        scatter(t, forces, force);
        first = last;
    }
    return hn::GetLane(hn::MaxOfLanes(D(), largest));
}

void pullToFit(const WarpBatch* batches, std::size_t count, const float* at, const TargetBatch* targets, float* force) {
    Forces forces;
    for (std::size_t k = 0; k < count; ++k) {
        const WarpBatch& t = batches[k];
        const TargetBatch& from = targets[k];
        for (std::size_t lane = 0; lane < kWarpBatch; lane += hn::Lanes(D())) {
            Target target{load(from.p1x, lane), load(from.p1y, lane), load(from.p2x, lane), load(from.p2y, lane),
                      {load(from.x[0], lane), load(from.x[1], lane), load(from.x[2], lane)},
                      {load(from.y[0], lane), load(from.y[1], lane), load(from.y[2], lane)}};
            const V c11 = load(t.c11, lane), c12 = load(t.c12, lane), c22 = load(t.c22, lane);
            const Three x0 = gather(at, corner(t, 0, lane)), x1 = gather(at, corner(t, 1, lane)) - x0, x2 = gather(at, corner(t, 2, lane)) - x0;
            fit(c11, c12, c22, x1, x2, target);
            pull(c11, c12, c22, x1, x2, target, forces, lane);
        }
        scatter(t, forces, force);
    }
}

void addRotations(const WarpBatch* batches, std::size_t triangles, const float* base, const float* displacement, float* sum) {
    for (std::size_t k = 0; k * kWarpBatch < triangles; ++k)
        for (std::size_t lane = 0; lane < kWarpBatch; lane += hn::Lanes(D())) {
            const Gradient g = gradientOf(batches[k], lane, base, displacement);
            float w[4 * kWarpBatch];
            hn::StoreInterleaved4(g.w.x, g.w.y, g.w.z, hn::Zero(D()), D(), w);
            const std::size_t from = k * kWarpBatch + lane, count = std::min(hn::Lanes(D()), triangles > from ? triangles - from : 0);
            for (std::size_t i = 0; i < count; ++i)
                for (int c = 0; c < 3; ++c) sum[c] += w[4 * i + static_cast<std::size_t>(c)];
        }
}

// Sums of each lane of a batch, added up in one order: the same on machines with wider or narrower vectors.
struct LaneSums {
    alignas(64) float of[kWarpBatch] = {};
    HWY_INLINE void add(V v, std::size_t lane) { store(hn::Add(load(of, lane), v), of, lane); }
    [[nodiscard]] double sum() const {
        double all = 0.0;
        for (const float x : of) all += static_cast<double>(x);
        return all;
    }
};

struct Corners {
    Three x0, x1, x2;
};
HWY_INLINE Corners cornersOf(const SurfaceBatch& t, std::size_t lane, const float* vectors) {
    const auto of = [&](int c) { return gather(vectors, hn::LoadU(hn::RebindToSigned<D>(), t.corner[c] + lane)); };
    return {of(0), of(1), of(2)};
}

void addNormals(const SurfaceBatch* batches, std::size_t count, const float* at, float* normals) {
    alignas(64) float found[4 * kWarpBatch];
    for (std::size_t k = 0; k < count; ++k) {
        const SurfaceBatch& t = batches[k];
        for (std::size_t lane = 0; lane < kWarpBatch; lane += hn::Lanes(D())) {
            const auto [x0, x1, x2] = cornersOf(t, lane, at);
            const Three n = cross(x1 - x0, x2 - x0);
            hn::StoreInterleaved4(n.x, n.y, n.z, norm(n), D(), found + 4 * lane);
        }
        for (int i = 0; i < kWarpBatch; ++i)
            for (const auto& corner : t.corner)
                for (int c = 0; c < 4; ++c) normals[corner[i] + c] += found[4 * i + c];
    }
}

VolumeCurve volumeCurve(const SurfaceBatch* batches, std::size_t count, const float* at, const float* way) {
    LaneSums volume, slope, square, cube;
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t lane = 0; lane < kWarpBatch; lane += hn::Lanes(D())) {
            const auto [x0, x1, x2] = cornersOf(batches[k], lane, at);
            const auto [w0, w1, w2] = cornersOf(batches[k], lane, way);
            const Three places = cross(x1, x2), both = cross(x1, w2) + cross(w1, x2), ways = cross(w1, w2);
            volume.add(dot(x0, places), lane);
            slope.add(hn::Add(dot(w0, places), dot(x0, both)), lane);
            square.add(hn::Add(dot(w0, both), dot(x0, ways)), lane);
            cube.add(dot(w0, ways), lane);
        }
    return {volume.sum() / 6.0, slope.sum() / 6.0, square.sum() / 6.0, cube.sum() / 6.0};
}

}  // namespace HWY_NAMESPACE
}  // namespace imomushi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace imomushi {

HWY_EXPORT(pullToResponse);
HWY_EXPORT(pullToFit);
HWY_EXPORT(addRotations);
HWY_EXPORT(addNormals);
HWY_EXPORT(volumeCurve);

float pullToResponse(const WarpBatch* batches, std::size_t count, const FollowBatch* follow, std::size_t followCount, const FaceStrain* faces,
                     const float* base, const float* displacement, const float* at, TargetBatch* targets, float* force) {
    return HWY_DYNAMIC_DISPATCH(pullToResponse)(batches, count, follow, followCount, faces, base, displacement, at, targets, force);
}

void pullToFit(const WarpBatch* batches, std::size_t count, const float* at, const TargetBatch* targets, float* force) {
    HWY_DYNAMIC_DISPATCH(pullToFit)(batches, count, at, targets, force);
}

void addRotations(const WarpBatch* batches, std::size_t triangles, const float* base, const float* displacement, float* sum) {
    HWY_DYNAMIC_DISPATCH(addRotations)(batches, triangles, base, displacement, sum);
}

void addNormals(const SurfaceBatch* batches, std::size_t count, const float* at, float* normals) {
    HWY_DYNAMIC_DISPATCH(addNormals)(batches, count, at, normals);
}

VolumeCurve volumeCurve(const SurfaceBatch* batches, std::size_t count, const float* at, const float* way) {
    return HWY_DYNAMIC_DISPATCH(volumeCurve)(batches, count, at, way);
}

}  // namespace imomushi
#endif
