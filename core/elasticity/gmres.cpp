// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/gmres.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/finite.h"
#include "core/base/parallel.h"

namespace imomushi {

namespace {

using FloatArray = std::vector<float>;

/// Steps until a restart: the basis takes kGmresColumns * kSteps vectors.
constexpr std::int32_t kSteps = 25;
/// Single-precision bases gain at most this factor per restart.
constexpr double kStepGain = 1e-4;
constexpr int kRestarts = 20;
/// A restart that gains less than this factor has met the limit of single precision or of the preconditioner.
constexpr double kWorthwhileRestart = 0.7;

}  // namespace

bool gmres(const HierarchicalMatrix& matrix, const HodlrFactorisation& preconditioner, Eigen::MatrixXd& right, Eigen::MatrixXd& x, double goal,
           int& iterations, int threads, const Progress& progress) {
    const std::int32_t n = matrix.size(), k = static_cast<std::int32_t>(right.cols());
    const auto size = static_cast<std::size_t>(n) * static_cast<std::size_t>(k);
    const auto column = [n](auto* base, std::int32_t c) { return base + static_cast<std::size_t>(c) * static_cast<std::size_t>(n); };
    const Eigen::VectorXd rightNorm = right.colwise().norm();
    Eigen::MatrixXd& residual = right;
    const Eigen::MatrixXd b = right;
    x.setZero(n, k);
    std::vector<FloatArray> basis;
    FloatArray z(size);
    std::vector<double> product(size);
    // Of one right-hand side: the Hessenberg matrix h, turned upper triangular by Givens rotations, and its right side g.
    struct LeastSquares {
        std::vector<double> h, g, cosine, sine;
        std::int32_t steps = 0;
        bool done = false;
        double beta = 0.0, aim = 0.0;  // norm of the residual at the restart; relative residual to reach
    };
    std::vector<LeastSquares> small(static_cast<std::size_t>(k));
    double worst = 1.0;
    for (int restart = 0; restart < kRestarts; ++restart) {
        if (basis.empty()) basis.emplace_back(size);
        bool any = false;
        for (std::int32_t c = 0; c < k; ++c) {
            LeastSquares& s = small[static_cast<std::size_t>(c)];
            s = {};
            s.beta = residual.col(c).norm();
            s.done = !(s.beta > goal * rightNorm[c]);
            if (s.done) {
                std::fill_n(column(basis[0].data(), c), n, 0.0f);
                continue;
            }
            any = true;
            s.aim = std::max(0.5 * goal * rightNorm[c] / s.beta, kStepGain);
            s.h.assign(static_cast<std::size_t>((kSteps + 1) * kSteps), 0.0);
            s.g.assign(kSteps + 1, 0.0);
            s.g[0] = 1.0;
            s.cosine.assign(kSteps, 0.0);
            s.sine.assign(kSteps, 0.0);
            float* v = column(basis[0].data(), c);
            const double* r = column(residual.data(), c);
            for (std::int32_t i = 0; i < n; ++i) v[i] = static_cast<float>(r[i] / s.beta);
        }
        if (!any) break;
        for (std::int32_t j = 0; j < kSteps; ++j) {
            if (static_cast<std::size_t>(j) + 1 >= basis.size()) basis.emplace_back(size);
            z = basis[static_cast<std::size_t>(j)];
            if (!preconditioner.solve(z.data(), k, threads, progress)) return false;
            if (!matrix.multiply(matrix.blocks(), z.data(), product.data(), k, false, threads, progress)) return false;
            ++iterations;
            parallelFor(threads, static_cast<std::size_t>(k), 1, [&](std::size_t c_, std::size_t) {
                const auto c = static_cast<std::int32_t>(c_);
                LeastSquares& s = small[c_];
                float* w = column(basis[static_cast<std::size_t>(j) + 1].data(), c);
                if (s.done || progress.cancelled()) {
                    std::fill_n(w, n, 0.0f);
                    return;
                }
                const double* from = column(product.data(), c);
                for (std::int32_t i = 0; i < n; ++i) w[i] = static_cast<float>(from[i]);
                double* h = s.h.data() + j * (kSteps + 1);
                const double before = static_cast<double>(cblas_snrm2(n, w, 1));
                for (std::int32_t i = 0; i <= j; ++i) {
                    const float* v = column(basis[static_cast<std::size_t>(i)].data(), c);
                    const float dot = cblas_sdot(n, v, 1, w, 1);
                    h[i] = static_cast<double>(dot);
                    cblas_saxpy(n, -dot, v, 1, w, 1);
                }
                const double norm = static_cast<double>(cblas_snrm2(n, w, 1));
                h[j + 1] = norm;
                for (std::int32_t i = 0; i < j; ++i) {
                    const double above = h[i], below = h[i + 1];
                    h[i] = s.cosine[static_cast<std::size_t>(i)] * above + s.sine[static_cast<std::size_t>(i)] * below;
                    h[i + 1] = s.cosine[static_cast<std::size_t>(i)] * below - s.sine[static_cast<std::size_t>(i)] * above;
                }
                const auto J = static_cast<std::size_t>(j);
                const double length = std::hypot(h[j], h[j + 1]);
                if (!(length > 0.0) || !std::isfinite(length)) {
                    s.done = true;
                    std::fill_n(w, n, 0.0f);
                    return;
                }
                s.cosine[J] = h[j] / length;
                s.sine[J] = h[j + 1] / length;
                h[j] = length;
                s.g[J + 1] = -s.sine[J] * s.g[J];
                s.g[J] *= s.cosine[J];
                s.steps = j + 1;
                if (std::abs(s.g[J + 1]) <= s.aim || norm <= kStepGain * 1e-2 * before) {
                    s.done = true;
                    std::fill_n(w, n, 0.0f);
                    return;
                }
                cblas_sscal(n, static_cast<float>(1.0 / norm), w, 1);
            });
            if (progress.cancelled()) return false;
            double slowest = goal;
            for (std::int32_t c = 0; c < k; ++c) {
                const LeastSquares& s = small[static_cast<std::size_t>(c)];
                if (!s.done) slowest = std::max(slowest, std::abs(s.g[static_cast<std::size_t>(j) + 1]) * s.beta / rightNorm[c]);
            }
            if (std::all_of(small.begin(), small.end(), [](const LeastSquares& s) { return s.done; })) break;
            progress.report("solve", std::clamp(std::log(slowest) / std::log(goal), 0.0, 1.0));
        }
        parallelFor(threads, static_cast<std::size_t>(k), 1, [&](std::size_t c_, std::size_t) {
            if (progress.cancelled()) return;
            const auto c = static_cast<std::int32_t>(c_);
            LeastSquares& s = small[c_];
            float* to = column(z.data(), c);
            std::fill_n(to, n, 0.0f);
            for (std::int32_t i = s.steps; i-- > 0;) {
                for (std::int32_t l = i + 1; l < s.steps; ++l) s.g[static_cast<std::size_t>(i)] -= s.h[static_cast<std::size_t>(l * (kSteps + 1) + i)] * s.g[static_cast<std::size_t>(l)];
                s.g[static_cast<std::size_t>(i)] /= s.h[static_cast<std::size_t>(i * (kSteps + 1) + i)];
            }
            for (std::int32_t i = 0; i < s.steps; ++i)
                cblas_saxpy(n, static_cast<float>(s.g[static_cast<std::size_t>(i)]), column(basis[static_cast<std::size_t>(i)].data(), c), 1, to, 1);
        });
        if (progress.cancelled() || !preconditioner.solve(z.data(), k, threads, progress)) return false;
        if (!allFinite(z)) break;
        Eigen::MatrixXd next = x;
        for (std::int32_t c = 0; c < k; ++c) next.col(c) += Eigen::Map<const Eigen::VectorXf>(column(z.data(), c), n).cast<double>() * small[static_cast<std::size_t>(c)].beta;
        Eigen::Map<Eigen::MatrixXf>(z.data(), n, k) = next.cast<float>();
        if (!matrix.multiply(matrix.blocks(), z.data(), product.data(), k, false, threads, progress)) return false;
        Eigen::MatrixXd nextResidual = b - Eigen::Map<const Eigen::MatrixXd>(product.data(), n, k);
        double reached = 0.0;
        for (std::int32_t c = 0; c < k; ++c)
            if (rightNorm[c] > 0.0) reached = std::max(reached, nextResidual.col(c).norm() / rightNorm[c]);
        if (!(reached < worst)) break;
        const bool gains = reached < kWorthwhileRestart * worst;
        x.swap(next);
        residual.swap(nextResidual);
        worst = reached;
        if (worst <= goal || !gains) break;
    }
    return true;
}

std::size_t gmresBytes(std::int32_t nodes, std::size_t ranks) {
    const double n = 3.0 * nodes, batch = kGmresColumns;
    return static_cast<std::size_t>(n * batch * ((kSteps + 2) * sizeof(float) + 6 * sizeof(double)) + static_cast<double>(ranks) * batch * sizeof(float));
}

}  // namespace imomushi
