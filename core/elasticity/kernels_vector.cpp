// SPDX-License-Identifier: GPL-3.0-or-later
// The integrals of kernels.cpp for a vector of triangles at a time: compiled once per instruction set, chosen at run time (Highway).
#include <numbers>

#include "core/elasticity/kernels.h"

// Vector types are held in arrays below, which vectors of unknown size (SVE, RISC-V) do not allow: ARM uses NEON.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/elasticity/kernels_vector.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace imomushi {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, TriangleBatch::kPad>;
using V = hn::Vec<D>;

// Lengths are of order one (boundary_problem.cpp scales the body). Below these a logarithm's factor has vanished to rounding.
constexpr double kTinyLength = 1e-30;
constexpr double kTinySquare = 1e-60;
/// Square of the distance from the inside of an edge at which x lies on it: coordinates are rounded.
constexpr double kOnEdgeSquare = 1e-28;

HWY_INLINE V constant(double value) { return hn::Set(D(), value); }

HWY_INLINE V dot(const V* a, const V* b) { return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2]))); }

/// The angle of (x, y) in (-pi, pi]; 0 at the origin.
HWY_INLINE V atan2(V y, V x) {
    const D d;
    const V ay = hn::Abs(y), ax = hn::Abs(x);
    const V big = hn::Max(hn::Max(ay, ax), constant(1e-300)), small = hn::Min(ay, ax);
    V angle = hn::Atan(d, hn::Div(small, big));
    angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(constant(std::numbers::pi / 2), angle), angle);
    angle = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(constant(std::numbers::pi), angle), angle);
    return hn::CopySign(angle, y);
}

/// Index of entry (i, j) of a symmetric 3 x 3 matrix.
constexpr int kSymmetric[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/// Triangles relative to x, one per lane: n, w and, per edge, e, m, t0, s (of both ends), and E0 = int 1/R as in triangleIntegrals().
struct PairGeometry {
    V n[3], w, w2, R[3], e[3][3], m[3][3], t0[3], s0[3], s1[3], E0[3], Om;
};

HWY_INLINE PairGeometry pairGeometry(const TriangleBatch& batch, std::size_t i, const V* x) {
    const D d;
    const V zero = hn::Zero(d), two = constant(2.0);
    const auto load = [&](int f) HWY_ATTR { return hn::LoadU(d, batch.field(f) + i); };
    PairGeometry t;
    V r[3][3], R2[3];
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 3; ++k) r[c][k] = hn::Sub(load(TriangleBatch::kCorner + 3 * c + k), x[k]);
        R2[c] = dot(r[c], r[c]);
        t.R[c] = hn::Sqrt(R2[c]);
    }
    for (int k = 0; k < 3; ++k) t.n[k] = load(TriangleBatch::kNormal + k);

    // Signed height w of x above the plane, from the nearest corner: exactly 0 on a corner.
    V nearest[3];
    const auto nearer1 = hn::Lt(R2[1], R2[0]);
    const auto nearer2 = hn::Lt(R2[2], hn::Min(R2[0], R2[1]));
    for (int k = 0; k < 3; ++k) nearest[k] = hn::IfThenElse(nearer2, r[2][k], hn::IfThenElse(nearer1, r[1][k], r[0][k]));
    t.w = hn::Neg(dot(nearest, t.n));
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3;
        for (int k = 0; k < 3; ++k) t.e[a][k] = load(TriangleBatch::kTangent + 3 * a + k);
        for (int k = 0; k < 3; ++k) {
            const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
            t.m[a][k] = hn::NegMulAdd(t.e[a][k2], t.n[k1], hn::Mul(t.e[a][k1], t.n[k2]));
        }
        const auto firstNearer = hn::Lt(R2[a], R2[b]);
        const V near[3] = {hn::IfThenElse(firstNearer, r[a][0], r[b][0]), hn::IfThenElse(firstNearer, r[a][1], r[b][1]),
                           hn::IfThenElse(firstNearer, r[a][2], r[b][2])};
        t.t0[a] = dot(near, t.m[a]);
        t.s0[a] = dot(r[a], t.e[a]);
        t.s1[a] = dot(r[b], t.e[a]);
        const auto onEdge = hn::And(hn::Lt(hn::Mul(t.s0[a], t.s1[a]), zero),
                                    hn::Lt(hn::MulAdd(t.t0[a], t.t0[a], hn::Mul(t.w, t.w)), constant(kOnEdgeSquare)));
        t.t0[a] = hn::IfThenZeroElse(onEdge, t.t0[a]);
        t.w = hn::IfThenZeroElse(onEdge, t.w);
    }
    t.w2 = hn::Mul(t.w, t.w);

    const V denominator = hn::MulAdd(
        hn::Mul(t.R[0], t.R[1]), t.R[2],
        hn::MulAdd(dot(r[0], r[1]), t.R[2], hn::MulAdd(dot(r[0], r[2]), t.R[1], hn::Mul(dot(r[1], r[2]), t.R[0]))));
    t.Om = hn::Mul(two, atan2(hn::Mul(load(TriangleBatch::kTwiceArea), t.w), denominator));
    t.Om = hn::IfThenElse(hn::Eq(t.w, zero), zero, t.Om);

    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3;
        const V length = load(TriangleBatch::kLength + a);
        const V R02 = hn::MulAdd(t.t0[a], t.t0[a], t.w2);
        const V sumR = hn::Add(t.R[a], t.R[b]);
        // f = ln(big / small) = log1p(excess / small), in three ways that do not cancel: far away by the sum of the distances, near by the ends on
        // one side of the foot of x or on both.
        const V P0 = hn::Max(hn::Add(t.R[a], hn::Abs(t.s0[a])), constant(kTinyLength));
        const V P1 = hn::Max(hn::Add(t.R[b], hn::Abs(t.s1[a])), constant(kTinyLength));
        const auto astride = hn::And(hn::Lt(t.s0[a], zero), hn::Gt(t.s1[a], zero));
        const V flat2 = hn::Max(R02, constant(kTinySquare));
        V small = hn::IfThenElse(astride, flat2, hn::Min(P0, P1));
        V excess = hn::IfThenElse(astride, hn::Max(hn::MulSub(P0, P1, flat2), zero), hn::Sub(hn::Max(P0, P1), hn::Min(P0, P1)));
        const auto far = hn::Gt(sumR, hn::Mul(two, length));
        small = hn::IfThenElse(far, hn::Sub(sumR, length), small);
        excess = hn::IfThenElse(far, hn::Mul(two, length), excess);
        t.E0[a] = hn::Log1p(d, hn::Div(excess, small));
    }
    return t;
}

enum class Adds { Corners, Bubbles, Tractions };

template <Adds kAdds>
double addBlocksOf(const TriangleBatch& batch, const Vec3& x, double nu, double* HWY_RESTRICT h, double* HWY_RESTRICT g) {
    const D d;
    constexpr int kLanes = TriangleBatch::kPad;
    const V zero = hn::Zero(d), half = constant(0.5), one = constant(1.0);
    const V dFactor = constant(1.0 / (4.0 * std::numbers::pi));
    const V mFactor = constant(1.0 / (8.0 * std::numbers::pi * (1.0 - nu)));
    const V gFactor = constant(1.0 / (16.0 * std::numbers::pi * (1.0 - nu)));
    const V isotropicM = constant(1.0 - 2.0 * nu), isotropicG = constant(3.0 - 4.0 * nu);
    const V xv[3] = {constant(x[0]), constant(x[1]), constant(x[2])};
    V sumD = zero;
    constexpr bool kWithG = kAdds == Adds::Tractions, kWithBubbles = kAdds == Adds::Bubbles;
    HWY_ALIGN double hBlocks[3][9][kLanes];
    HWY_ALIGN double bubbleBlocks[3][9][kLanes];
    HWY_ALIGN double gBlocks[3][6][kLanes];

    for (std::size_t i = 0; i < batch.paddedSize(); i += hn::Lanes(d)) {
        const auto load = [&](int f) HWY_ATTR { return hn::LoadU(d, batch.field(f) + i); };
        const PairGeometry seen = pairGeometry(batch, i, xv);
        const auto &n = seen.n, &R = seen.R, &t0 = seen.t0, &s0 = seen.s0, &s1 = seen.s1, &E0 = seen.E0;
        const auto &e = seen.e, &m = seen.m;
        const V w = seen.w, w2 = seen.w2, Om = seen.Om;

        V I0 = hn::Neg(hn::Mul(w, Om));
        V q[3] = {zero, zero, zero};
        V edges[6] = {zero, zero, zero, zero, zero, zero};  // sum of t0 f m m^T + (R1 - R0) (e m^T + m e^T) / 2
        V E1[3], E2[3], J[3];
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3;
            const V length = load(TriangleBatch::kLength + a);
            const V f = E0[a], sumR = hn::Add(R[a], R[b]);
            E1[a] = hn::Div(hn::Mul(length, hn::Add(s0[a], s1[a])), sumR);  // R1 - R0
            if constexpr (kWithG || kWithBubbles) {
                const V ends = hn::MulSub(s1[a], R[b], hn::Mul(s0[a], R[a])), side = hn::Mul(hn::MulAdd(t0[a], t0[a], w2), f);
                J[a] = hn::Mul(half, hn::Add(ends, side));
                E2[a] = hn::Mul(half, hn::Sub(ends, side));
            }
            const V t0f = hn::Mul(t0[a], f);
            I0 = hn::Add(I0, t0f);
            for (int k = 0; k < 3; ++k) q[k] = hn::NegMulAdd(m[a][k], f, q[k]);
            V along[3];  // t0 f m + (R1 - R0) e, whose symmetric product with m is wanted
            const V halfE1 = hn::Mul(half, E1[a]), halfT0f = hn::Mul(half, t0f);
            for (int k = 0; k < 3; ++k) along[k] = hn::MulAdd(halfT0f, m[a][k], hn::Mul(halfE1, e[a][k]));
            for (int k = 0; k < 3; ++k)
                for (int l = k; l < 3; ++l)
                    edges[kSymmetric[k][l]] =
                        hn::Add(edges[kSymmetric[k][l]], hn::MulAdd(along[k], m[a][l], hn::Mul(m[a][k], along[l])));
        }

        V Q[6], S[6], M[6];
        const V wOm = hn::Mul(w, Om);
        for (int k = 0; k < 3; ++k)
            for (int l = k; l < 3; ++l) {
                const int s = kSymmetric[k][l];
                const V nn = hn::Mul(n[k], n[l]);
                const V projector = k == l ? hn::Sub(one, nn) : hn::Neg(nn);
                Q[s] = hn::MulSub(I0, projector, edges[s]);
                const V nq = hn::MulAdd(n[k], q[l], hn::Mul(q[k], n[l]));
                S[s] = hn::MulAdd(wOm, nn, hn::NegMulAdd(w, nq, Q[s]));
                M[s] = hn::Mul(mFactor, k == l ? hn::MulAdd(isotropicM, I0, S[s]) : S[s]);
            }

        V height[3];
        for (int a = 0; a < 3; ++a) {
            const int o = (a + 1) % 3;  // the edge opposite to corner a
            height[a] = load(TriangleBatch::kHeight + o);
            const V Da = hn::Mul(height[a], hn::MulSub(t0[o], Om, hn::Mul(w, dot(m[o], q))));
            sumD = hn::Add(sumD, Da);
            const V diagonal = hn::Mul(dFactor, Da);
            const V k3[3] = {hn::Mul(height[a], e[o][0]), hn::Mul(height[a], e[o][1]), hn::Mul(height[a], e[o][2])};
            for (int row = 0; row < 3; ++row) {
                const V* Mr[3] = {&M[kSymmetric[row][0]], &M[kSymmetric[row][1]], &M[kSymmetric[row][2]]};
                for (int column = 0; column < 3; ++column) {
                    const int c1 = (column + 1) % 3, c2 = (column + 2) % 3;
                    // - M [k3]x, as g n^T - n g^T = -[k3]x
                    V block = hn::MulSub(*Mr[c2], k3[c1], hn::Mul(*Mr[c1], k3[c2]));
                    if (row == column) block = hn::Add(block, diagonal);
                    hn::Store(block, d, hBlocks[a][3 * row + column]);
                }
            }
        }

        if constexpr (kWithG || kWithBubbles) {
            V L[3] = {zero, zero, zero};
            for (int a = 0; a < 3; ++a)
                for (int k = 0; k < 3; ++k) L[k] = hn::MulAdd(m[a][k], J[a], L[k]);
            // Per corner: N_a at the projection of x and its gradient, Q g, g.q, and the factor times (isotropic int N_a / R I + int N_a r r^T / R^3).
            V atX[3], gradient[3][3], Qg[3][3], gq[3], linear[3][6];
            const V factor = kWithG ? gFactor : mFactor, isotropic = kWithG ? isotropicG : isotropicM;
            for (int a = 0; a < 3; ++a) {
                const int o = (a + 1) % 3;
                for (int k = 0; k < 3; ++k) gradient[a][k] = hn::Neg(hn::Mul(height[a], m[o][k]));
                const V* ga = gradient[a];
                atX[a] = hn::Mul(height[a], t0[o]);
                const V gL = dot(ga, L);
                gq[a] = dot(ga, q);
                V T[6];  // int (gradient . rho) rho rho^T / R^3
                for (int k = 0; k < 3; ++k)
                    for (int l = k; l < 3; ++l) {
                        const V nn = hn::Mul(n[k], n[l]);
                        const V gl = hn::MulAdd(L[k], ga[l], hn::Mul(ga[k], L[l]));
                        T[kSymmetric[k][l]] = hn::MulAdd(half, gl, hn::Mul(gL, k == l ? hn::Sub(one, nn) : hn::Neg(nn)));
                    }
                for (int b = 0; b < 3; ++b) {
                    const V gm = dot(ga, m[b]), ge = dot(ga, e[b]);
                    const V cross = hn::Mul(t0[b], E1[b]);
                    const V alongM = hn::Mul(half, hn::MulAdd(gm, hn::Mul(hn::Mul(t0[b], t0[b]), E0[b]), hn::Mul(cross, ge)));
                    const V alongE = hn::Mul(half, hn::MulAdd(cross, gm, hn::Mul(ge, E2[b])));
                    V along[3];
                    for (int k = 0; k < 3; ++k) along[k] = hn::MulAdd(alongM, m[b][k], hn::Mul(alongE, e[b][k]));
                    for (int k = 0; k < 3; ++k)
                        for (int l = k; l < 3; ++l)
                            T[kSymmetric[k][l]] = hn::Sub(T[kSymmetric[k][l]], hn::MulAdd(along[k], m[b][l], hn::Mul(m[b][k], along[l])));
                }
                for (int k = 0; k < 3; ++k) {
                    const V row[3] = {Q[kSymmetric[k][0]], Q[kSymmetric[k][1]], Q[kSymmetric[k][2]]};
                    Qg[a][k] = dot(row, ga);
                }
                const V ofOne = hn::MulAdd(atX[a], I0, gL);  // int N_a / R
                const V w2gq = hn::Mul(w2, gq[a]);
                for (int k = 0; k < 3; ++k)
                    for (int l = k; l < 3; ++l) {
                        const int s = kSymmetric[k][l];
                        const V nQg = hn::MulAdd(n[k], Qg[a][l], hn::Mul(Qg[a][k], n[l]));
                        V entry = hn::NegMulAdd(w, nQg, hn::MulAdd(atX[a], S[s], T[s]));
                        entry = hn::MulAdd(w2gq, hn::Mul(n[k], n[l]), entry);
                        if (k == l) entry = hn::MulAdd(isotropic, ofOne, entry);
                        linear[a][s] = hn::Mul(factor, entry);
                    }
            }
            if constexpr (kWithG)
                for (int a = 0; a < 3; ++a)
                    for (int s = 0; s < 6; ++s) hn::Store(linear[a][s], d, gBlocks[a][s]);
            if constexpr (kWithBubbles) {
                const V four = constant(4.0);
                for (int a = 0; a < 3; ++a) {
                    const int b = (a + 1) % 3, ea = (a + 1) % 3, eb = (b + 1) % 3;  // edges opposite to a and b
                    const V inPlane = hn::MulAdd(atX[a], gq[b], hn::MulAdd(atX[b], gq[a], dot(gradient[a], Qg[b])));
                    const V layer = hn::Mul(four, hn::MulAdd(hn::Mul(atX[a], atX[b]), Om, hn::Mul(w, inPlane)));
                    const V diagonal = hn::Mul(dFactor, layer);
                    const V ha = hn::Mul(four, height[a]), hb = hn::Mul(four, height[b]);
                    const V ka[3] = {hn::Mul(ha, e[ea][0]), hn::Mul(ha, e[ea][1]), hn::Mul(ha, e[ea][2])};
                    const V kb[3] = {hn::Mul(hb, e[eb][0]), hn::Mul(hb, e[eb][1]), hn::Mul(hb, e[eb][2])};
                    for (int row = 0; row < 3; ++row)
                        for (int column = 0; column < 3; ++column) {
                            const int c1 = (column + 1) % 3, c2 = (column + 2) % 3;
                            const int r1 = kSymmetric[row][c1], r2 = kSymmetric[row][c2];
                            // - (N_a M) [kb]x - (N_b M) [ka]x
                            V block = hn::MulSub(linear[a][r2], kb[c1], hn::Mul(linear[a][r1], kb[c2]));
                            block = hn::MulAdd(linear[b][r2], ka[c1], hn::NegMulAdd(linear[b][r1], ka[c2], block));
                            if (row == column) block = hn::Add(block, diagonal);
                            hn::Store(block, d, bubbleBlocks[a][3 * row + column]);
                        }
                }
            }
        }

        const auto scatter = [&](const std::int32_t* column, const double (*blocks)[kLanes]) HWY_ATTR {
            for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
                double* block = h + 9 * static_cast<std::ptrdiff_t>(column[lane]);
                for (int k = 0; k < 9; ++k) block[k] += blocks[k][lane];
            }
        };
        for (int a = 0; a < 3; ++a) {
            scatter(batch.corner(a) + i, hBlocks[a]);
            if constexpr (kWithBubbles) scatter(batch.bubble(a) + i, bubbleBlocks[a]);
            if constexpr (kWithG) {
                const std::int32_t* column = batch.traction(a) + i;
                for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
                    double* block = g + 9 * static_cast<std::ptrdiff_t>(column[lane]);
                    for (int k = 0; k < 3; ++k)
                        for (int l = 0; l < 3; ++l) block[3 * k + l] += gBlocks[a][kSymmetric[k][l]][lane];
                }
            }
        }
    }
    HWY_ALIGN double lanes[kLanes];
    hn::Store(sumD, d, lanes);
    double sum = 0.0;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) sum += lanes[lane];
    return sum;
}

double addBlocks(const TriangleBatch& batch, const Vec3& x, double nu, double* h, double* g) {
    if (g) return addBlocksOf<Adds::Tractions>(batch, x, nu, h, g);
    return batch.hasBubbles() ? addBlocksOf<Adds::Bubbles>(batch, x, nu, h, g) : addBlocksOf<Adds::Corners>(batch, x, nu, h, g);
}

LoadBlocks sumLoads(const TriangleBatch& batch, const Vec3& x, double nu) {
    const D d;
    const V zero = hn::Zero(d), half = constant(0.5), isotropic = constant(3.0 - 4.0 * nu);
    const V xv[3] = {constant(x[0]), constant(x[1]), constant(x[2])};
    V outer[3][3], inner = zero, pressure[3] = {zero, zero, zero};  // sums of n L^T and n . L, L = int r / R
    for (auto& row : outer)
        for (V& entry : row) entry = zero;
    for (std::size_t i = 0; i < batch.paddedSize(); i += hn::Lanes(d)) {
        const PairGeometry t = pairGeometry(batch, i, xv);
        V I0 = hn::Neg(hn::Mul(t.w, t.Om)), q[3] = {zero, zero, zero}, L[3] = {zero, zero, zero};
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3;
            I0 = hn::MulAdd(t.t0[a], t.E0[a], I0);
            const V ends = hn::MulSub(t.s1[a], t.R[b], hn::Mul(t.s0[a], t.R[a]));
            const V J = hn::Mul(half, hn::MulAdd(hn::MulAdd(t.t0[a], t.t0[a], t.w2), t.E0[a], ends));
            for (int k = 0; k < 3; ++k) {
                q[k] = hn::NegMulAdd(t.m[a][k], t.E0[a], q[k]);
                L[k] = hn::MulAdd(t.m[a][k], J, L[k]);
            }
        }
        const auto real = hn::Gt(hn::LoadU(d, batch.field(TriangleBatch::kHeight) + i), zero);
        const V wI0 = hn::Mul(t.w, I0), along = hn::MulAdd(isotropic, I0, hn::Mul(t.w, t.Om));
        inner = hn::Sub(inner, hn::IfThenElseZero(real, wI0));
        for (int k = 0; k < 3; ++k) {
            const V nk = hn::IfThenElseZero(real, t.n[k]);
            // S n = -w int r / R^3
            pressure[k] = hn::Add(pressure[k], hn::MulSub(along, nk, hn::IfThenElseZero(real, hn::Mul(t.w, q[k]))));
            for (int l = 0; l < 3; ++l) outer[k][l] = hn::MulAdd(nk, hn::NegMulAdd(wI0, t.n[l], L[l]), outer[k][l]);
        }
    }
    const auto sum = [&](V v) HWY_ATTR {
        HWY_ALIGN double lanes[TriangleBatch::kPad];
        hn::Store(v, d, lanes);
        double total = 0.0;
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) total += lanes[lane];
        return total;
    };
    LoadBlocks out;
    const double trace = sum(inner);
    for (int k = 0; k < 3; ++k) {
        out.pressure[k] = sum(pressure[k]) / (16.0 * std::numbers::pi * (1.0 - nu));
        for (int l = 0; l < 3; ++l) out.force(k, l) = ((k == l ? trace : 0.0) - sum(outer[k][l]) / (2.0 * (1.0 - nu))) / (8.0 * std::numbers::pi);
    }
    return out;
}

}  // namespace HWY_NAMESPACE
}  // namespace imomushi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace imomushi {
HWY_EXPORT(addBlocks);
double addBlocks(const TriangleBatch& batch, const Vec3& x, double nu, double* h, double* g) {
    return HWY_DYNAMIC_DISPATCH(addBlocks)(batch, x, nu, h, g);
}
HWY_EXPORT(sumLoads);
LoadBlocks sumLoads(const TriangleBatch& batch, const Vec3& x, double nu) { return HWY_DYNAMIC_DISPATCH(sumLoads)(batch, x, nu); }
}  // namespace imomushi
#endif
