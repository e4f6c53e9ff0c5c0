// SPDX-License-Identifier: GPL-3.0-or-later
// Seconds, bytes and milliseconds per frame of a response before it is built.
#include <cblas.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "core/elasticity/dense_lu.h"
#include "core/elasticity/volume_problem.h"
#include "core/meshing/appendages.h"
#include "core/meshing/solved_body.h"
#include "core/reduction/element_response.h"
#include "core/reduction/element_statics.h"

namespace imomushi {
namespace {

BoundaryProblem::Estimate estimateOf(const SolvedSize& size, int columns, int tractions, int threads) {
    return size.volume ? VolumeProblem::estimate(size.nodes, columns + tractions, threads) : BoundaryProblem::estimate(size.nodes, size.triangles, columns, threads, tractions);
}

}  // namespace

ResponseEstimate estimateResponse(const ResponseInput& input) {
    ResponseEstimate out;
    if (!input.mesh) return out;
    for (const JointFace& face : input.faces) out.columns += FaceBasis::on(input.mesh->body, face, input.basis).columns();
    if (input.faces.empty()) return out;
    if (!checkInput(input)) return out;
    const auto body = withoutAppendages(*input.mesh, input.faces, {});
    if (!body) return out;
    const SolvedSize size = solvedSize(body->mesh, body->faces, input.solverMesh, filled(input));
    const int tractions = 3 * std::min<int>(input.touch, static_cast<int>(input.mesh->body.vertices.rows()) / 4);
    const bool loadsApart = (input.loads == BodyLoads::Always || tractions > 0) && !body->appendages.empty();
    BoundaryProblem::Estimate solve = estimateOf(size, out.columns, loadsApart ? 0 : tractions, input.threads);
    if (loadsApart) {
        const SolvedSize whole = solvedSize(input.mesh->body, input.faces, input.solverMesh, filled(input));
        const BoundaryProblem::Estimate again = estimateOf(whole, out.columns, tractions, input.threads);
        solve.seconds += again.seconds;
        solve.bytes = std::max(solve.bytes, again.bytes);
    }
    solve.bytes += 3 * sizeof(double) * static_cast<std::size_t>(input.mesh->body.vertices.rows()) * static_cast<std::size_t>(tractions);
    out.seconds = solve.seconds + estimateOf({size.coarser, 2 * size.coarser, 0, size.volume}, out.columns, 0, input.threads).seconds;
    out.bytes = solve.bytes;

    useSingleThreadedBlas();
    const auto seconds = [](const auto& work) {
        double best = 1e9;
        for (int round = 0; round < 4; ++round) {
            const auto start = std::chrono::steady_clock::now();
            work();
            best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        return best;
    };
    // projectStiffness() of a full basis takes as long as about seven products of its size, half of them bound by memory.
    constexpr int kFewColumns = 300, kSample = 192;
    if (out.columns > kFewColumns) {
        const Eigen::MatrixXd a = Eigen::MatrixXd::Ones(kSample, kSample);
        Eigen::MatrixXd b = a;
        const double product = seconds([&] { cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, kSample, kSample, kSample, 1.0, a.data(), kSample, a.data(), kSample, 0.0, b.data(), kSample); });
        out.seconds += 7.0 * product * std::pow(static_cast<double>(out.columns) / kSample, 3.0);
    }

    // The per-frame product reads each entry of A' once, as float: timed on as much memory, warm.
    const std::size_t entries = 3 * static_cast<std::size_t>(input.mesh->body.vertices.rows()) * static_cast<std::size_t>(out.columns);
    constexpr std::size_t kMax = std::size_t{16} << 20;  // beyond every cache the rate stays the same
    const std::size_t measured = std::min(entries, kMax);
    const std::vector<float> data(measured);
    const double best = seconds([&] { cblas_sdot(static_cast<int>(measured), data.data(), 1, data.data(), 1); });
    out.frameMilliseconds = 1e3 * best * static_cast<double>(entries) / static_cast<double>(measured);
    return out;
}

}  // namespace imomushi
