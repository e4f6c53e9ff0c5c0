// SPDX-License-Identifier: GPL-3.0-or-later
// Large boundary equations in hierarchical form: seconds per stage, peak memory, residuals, and how far the estimate was off.
//   bench_hierarchical_solver [vertices] [cylinder|bar|plate] [tolerance] [goal] [Poisson ratio] [threads]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>

#include "core/elasticity/boundary_equation.h"
#include "core/elasticity/hierarchical_solver.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

double peakMegabytes() {
    std::ifstream file("/proc/self/status");
    for (std::string key; file >> key;)
        if (key == "VmHWM:") {
            double kilobytes = 0.0;
            file >> kilobytes;
            return kilobytes / 1024.0;
        }
    return 0.0;
}

double processSeconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

shapes::Body bodyOf(const std::string& name, double vertices) {
    if (name == "bar") {
        const int n = static_cast<int>(std::lround(std::sqrt(vertices / 14.0)));
        return shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 3.0}, n, n, 3 * n);
    }
    if (name == "plate") {
        const int n = static_cast<int>(std::lround(std::sqrt(vertices / 2.08)));
        return shapes::box({-0.5, -0.005, 0.0}, {0.5, 0.005, 1.0}, n, 1, n);
    }
    const int around = static_cast<int>(std::lround(std::sqrt(vertices / 0.87)));
    return shapes::cylinder(1.0, 3.0, around, around / 2);
}

}  // namespace

int main(int argc, char** argv) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const double wanted = argc > 1 ? std::atof(argv[1]) : 2000;
    const std::string shape = argc > 2 ? argv[2] : "cylinder";
    HierarchicalSolver::Options options;
    options.tolerance = argc > 3 ? std::atof(argv[3]) : options.tolerance;
    const double goal = argc > 4 ? std::atof(argv[4]) : 1e-5;
    const double nu = argc > 5 ? std::atof(argv[5]) : 0.45;
    options.threads = argc > 6 ? std::atoi(argv[6]) : 2;

    const auto body = bodyOf(shape, wanted);
    std::vector<HeldPatch> held;
    std::vector<Vec3> heldAt;
    for (const auto& end : body.ends) {
        held.push_back({end.vertices, end.triangles});
        for (const std::int32_t v : end.vertices) heldAt.push_back(body.mesh.vertices.row(v).transpose());
    }
    const auto source = std::make_shared<BoundaryEquation>(body.mesh, held, std::span<const std::array<std::int32_t, 2>>{}, nu);
    // The rigid motions of either end.
    Eigen::MatrixXd prescribed = Eigen::MatrixXd::Zero(3 * source->heldCount(), 12);
    for (std::size_t j = 0; j < heldAt.size(); ++j) {
        const int first = j < held[0].vertices.size() ? 0 : 6;
        const Vec3& p = heldAt[j];
        const auto row = static_cast<Eigen::Index>(3 * j);
        for (int k = 0; k < 3; ++k) {
            prescribed(row + k, first + k) = 1.0;
            prescribed(row + (k + 1) % 3, first + 3 + k) = -p[(k + 2) % 3];
            prescribed(row + (k + 2) % 3, first + 3 + k) = p[(k + 1) % 3];
        }
    }
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::time_point from) { return std::chrono::duration<double>(Clock::now() - from).count(); };
    auto start = Clock::now();
    Eigen::MatrixXd x = source->rightHandSides(prescribed, options.threads, {});
    std::printf("%s, %d vertices, nu %g, tolerance %g, %d threads\n", shape.c_str(), source->nodes(), nu, options.tolerance, options.threads);
    std::printf("right-hand sides         %.2f s\n", seconds(start));
    start = Clock::now();
    const auto estimate = HierarchicalSolver::estimate(*source, options, static_cast<std::int32_t>(x.cols()), goal, {});
    if (!estimate) return std::puts(estimate.error().message.c_str()), 1;
    const double estimating = seconds(start), before = peakMegabytes();
    start = Clock::now();
    const double spent = processSeconds();
    auto solver = HierarchicalSolver::build(source, options, {});
    if (!solver) return std::puts(solver.error().message.c_str()), 1;
    const HierarchicalSolver::Quality& q = solver->quality();
    std::printf("assembly                 %.2f s, %.0f MB, %.1f %% of dense\n", q.assembleSeconds, static_cast<double>(q.matrixBytes) / 1e6, 100.0 * q.compression);
    std::printf("factorisation            %.2f s, %.0f MB\n", q.factoriseSeconds, static_cast<double>(q.factorBytes) / 1e6);
    const auto solved = solver->solve(x, goal, {});
    const double total = seconds(start), computed = (processSeconds() - spent) / options.threads;
    std::printf("solution                 %.2f s, %d steps for %d columns, %d times corrected, true residual %.1e\n", q.solveSeconds, q.iterations,
                static_cast<int>(x.cols()), q.corrections, q.residual);
    if (!solved) std::puts(solved.error().message.c_str());
    std::printf("all                      %.2f s, of processor time per thread %.2f s (estimated in %.2f s: %.2f s, ratio %.2f)\n", total, computed,
                estimating, estimate->seconds, estimate->seconds / computed);
    const double own = static_cast<double>(q.matrixBytes + q.factorBytes + q.solveBytes) / 1e6;
    std::printf("memory                   %.0f MB (estimated %.0f MB, ratio %.2f), peak of the process %.0f MB (%.0f before)\n", own,
                static_cast<double>(estimate->bytes) / 1e6, static_cast<double>(estimate->bytes) / 1e6 / own, peakMegabytes(), before);
    return 0;
}
