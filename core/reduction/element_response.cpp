// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/element_response.h"

#include <cblas.h>
#include <lapacke.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "core/elasticity/dense_lu.h"
#include "core/mesh/topology.h"

namespace imomushi {
namespace {

/// Changes whenever the same input gives other numbers: cached answers of an older solver are then computed again.
constexpr int kSolverVersion = 1;

/// Relative ridge on the Gram matrix of the joint modes: modes that a small patch cannot tell apart (three vertices, twelve modes) share
/// the load instead of dividing by zero; regular ones change by rounding.
constexpr double kGramRidge = 1e-13;

/// A combination of rigid motions belongs to the joint modes when they miss it by no more than a flat face may be out of its plane.
constexpr double kRigidMiss = 2.0 * JointFace::kFlatTolerance;

std::vector<FaceBasis> basesOf(const ResponseInput& input, std::vector<int>& firstColumn) {
    std::vector<FaceBasis> bases;
    firstColumn.assign(1, 0);
    for (const JointFace& face : input.faces) {
        bases.push_back({input.basis, face.flat()});
        firstColumn.push_back(firstColumn.back() + bases.back().columns());
    }
    return bases;
}

BoundaryProblem::Input problemOf(const ResponseInput& input) {
    BoundaryProblem::Input problem;
    problem.mesh = &input.mesh->body;
    for (const JointFace& face : input.faces) problem.held.push_back({face.vertices, face.triangles});
    problem.nu = input.nu;
    problem.threads = input.threads;
    return problem;
}

Result<void> checkInput(const ResponseInput& input) {
    if (!input.mesh) return fail("bad-value", "The element has no mesh.");
    for (const JointFace& face : input.faces)
        for (const std::int32_t v : face.vertices)
            if (v < 0 || v >= input.mesh->body.vertices.rows())
                return fail("bad-value", "The joint face \"" + face.name + "\" names a vertex that does not exist; choose it again.");
    return {};
}

/// The vertices of all faces, in the order of BoundaryProblem::solve: C (displacement per joint parameter) and the six rigid motions about the
/// middle of the body, in units of its size.
struct HeldModes {
    Eigen::MatrixXd C;  ///< 3 * #held x g
    Eigen::MatrixXd R;  ///< 3 * #held x 6
};

HeldModes heldModes(const ResponseInput& input, const std::vector<FaceBasis>& bases, const std::vector<int>& firstColumn) {
    Eigen::Index held = 0;
    for (const JointFace& face : input.faces) held += static_cast<Eigen::Index>(face.vertices.size());
    HeldModes modes{Eigen::MatrixXd::Zero(3 * held, firstColumn.back()), Eigen::MatrixXd::Zero(3 * held, 6)};
    const Points& points = input.mesh->body.vertices;
    const Vec3 low = points.colwise().minCoeff().transpose(), high = points.colwise().maxCoeff().transpose();
    Eigen::Index row = 0;
    for (std::size_t f = 0; f < bases.size(); ++f) {
        const FaceFrame& frame = input.faces[f].frame;
        for (const std::int32_t v : input.faces[f].vertices) {
            const Vec3 p = points.row(v).transpose();
            modes.C.block(row, firstColumn[f], 3, bases[f].columns()) = frame.axes * bases[f].at(frame.toLocal(p));
            const Vec3 arm = (p - 0.5 * (low + high)) / (high - low).norm();
            for (int axis = 0; axis < 3; ++axis) {
                modes.R(row + axis, axis) = 1.0;
                modes.R.block<3, 1>(row, 3 + axis) = Vec3::Unit(axis).cross(arm);
            }
            row += 3;
        }
    }
    return modes;
}

/// The mass matrix of linear functions on the faces, times Z (3 * #held x any): int N_a N_b dS, m^2.
Eigen::MatrixXd faceMass(const ResponseInput& input, const Eigen::MatrixXd& Z) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(Z.rows(), Z.cols());
    std::vector<Eigen::Index> row(static_cast<std::size_t>(input.mesh->body.vertices.rows()));
    Eigen::Index next = 0;
    for (const JointFace& face : input.faces) {
        for (const std::int32_t v : face.vertices) {
            row[static_cast<std::size_t>(v)] = next;
            next += 3;
        }
        const auto rowOf = [&](std::int32_t f, int corner) { return row[static_cast<std::size_t>(input.mesh->body.triangles(f, corner))]; };
        for (const std::int32_t f : face.triangles) {
            const double share = 0.5 * areaVector(input.mesh->body, f).norm() / 12.0;
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b)
                    out.middleRows(rowOf(f, a), 3) += (a == b ? 2.0 : 1.0) * share * Z.middleRows(rowOf(f, b), 3);
        }
    }
    return out;
}

/// Makes K what a stiffness must be: symmetric, zero on rigid motions, without negative energy. W = C^T mass C measures joint
/// parameters by the displacement they make, so that metres and radians need no weights of their own.
/// False: LAPACK found the input not positive definite or not finite (a face without area).
bool cleanStiffness(const HeldModes& modes, const ResponseInput& input, Eigen::MatrixXd& K, ResponseQuality& quality) {
    useSingleThreadedBlas();
    const auto g = static_cast<int>(K.rows());
    const double symmetricNorm = (K + K.transpose()).norm();
    quality.asymmetry = symmetricNorm > 0.0 ? (K - K.transpose()).norm() / symmetricNorm : 0.0;

    // In parameters scaled to unit diagonal of W.
    const Eigen::MatrixXd massC = faceMass(input, modes.C);
    Eigen::MatrixXd W = modes.C.transpose() * massC;
    const Eigen::VectorXd unit = W.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    W = (unit.asDiagonal() * (0.5 * (W + W.transpose())) * unit.asDiagonal()).eval();
    W.diagonal().array() += kGramRidge;
    Eigen::MatrixXd scaled = unit.asDiagonal() * (0.5 * (K + K.transpose())) * unit.asDiagonal();

    // Rigid motions among the modes: least squares in the mass norm, then the combinations that are met.
    Eigen::MatrixXd factor = W;
    if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', g, factor.data(), g) != 0) return false;
    Eigen::MatrixXd rigid = unit.asDiagonal() * (massC.transpose() * modes.R);
    LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', g, 6, factor.data(), g, rigid.data(), g);
    const Eigen::MatrixXd miss = modes.R - modes.C * (unit.asDiagonal() * rigid);
    Eigen::MatrixXd missed = miss.transpose() * faceMass(input, miss), size = modes.R.transpose() * faceMass(input, modes.R);
    size.diagonal().array() += 1e-9 * size.trace();  // rotations that a single straight row of vertices cannot show
    Eigen::VectorXd ratio(6);
    if (LAPACKE_dsygv(LAPACK_COL_MAJOR, 1, 'V', 'L', 6, missed.data(), 6, size.data(), 6, ratio.data()) != 0) return false;
    int found = 0;
    while (found < 6 && ratio[found] <= kRigidMiss * kRigidMiss) ++found;
    if (found > 0) {
        const Eigen::MatrixXd V = rigid * missed.leftCols(found);
        Eigen::MatrixXd gram = V.transpose() * W * V;
        Eigen::MatrixXd along = (W * V).transpose();
        if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', found, g, gram.data(), found, along.data(), found) != 0) return false;
        const Eigen::MatrixXd projector = Eigen::MatrixXd::Identity(g, g) - V * along;
        scaled = (projector.transpose() * scaled * projector).eval();
    }

    // Eigenvalues relative to W; negative ones (of rounding or of a coarse mesh) carry no energy.
    Eigen::MatrixXd vectors = scaled, metric = W;
    Eigen::VectorXd values(g);
    if (LAPACKE_dsygv(LAPACK_COL_MAJOR, 1, 'V', 'L', g, vectors.data(), g, metric.data(), g, values.data()) != 0) return false;
    const double largest = values[g - 1];
    quality.negativeEnergy = largest > 0.0 ? std::min(values[0], 0.0) / largest : 0.0;
    if (values[0] < 0.0) {
        const Eigen::MatrixXd WV = W * vectors;
        scaled = WV * values.cwiseMax(0.0).asDiagonal() * WV.transpose();
    }
    const Eigen::VectorXd back = unit.cwiseInverse();
    K = back.asDiagonal() * scaled * back.asDiagonal();
    K = (0.5 * (K + K.transpose())).eval();
    return std::all_of(K.data(), K.data() + K.size(), [](double x) { return std::isfinite(x); });
}

std::vector<std::int32_t> verticesWithoutFace(const ResponseInput& input) {
    std::vector<char> held(static_cast<std::size_t>(input.mesh->body.vertices.rows()));
    for (const JointFace& face : input.faces)
        for (const std::int32_t v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    std::vector<std::int32_t> out;
    for (std::size_t v = 0; v < held.size(); ++v)
        if (!held[v]) out.push_back(static_cast<std::int32_t>(v));
    return out;
}

}  // namespace

std::size_t ElementResponse::bytes() const {
    return sizeof(double) * static_cast<std::size_t>(response.size() + stiffness.size()) + sizeof(std::int32_t) * freeVertices.size();
}

ContentKey responseKey(const ResponseInput& input) {
    ContentHasher hasher;
    hasher.number(kSolverVersion);
    hasher.number(input.nu);
    hasher.number(static_cast<int>(input.basis));
    const TriangleMesh& body = input.mesh->body;
    hasher.array(std::span<const double>(body.vertices.data(), static_cast<std::size_t>(body.vertices.size())));
    hasher.array(std::span<const std::int32_t>(body.triangles.data(), static_cast<std::size_t>(body.triangles.size())));
    hasher.number(input.faces.size());
    for (const JointFace& face : input.faces) {
        hasher.array(std::span<const std::int32_t>(face.vertices));
        hasher.array(std::span<const std::int32_t>(face.triangles));
        hasher.array(std::span<const double>(face.frame.origin.data(), 3));
        hasher.array(std::span<const double>(face.frame.axes.data(), 9));
        hasher.number(static_cast<int>(face.flat()));
    }
    return hasher.key();
}

Result<ElementResponse> buildResponse(const ResponseInput& input, const Progress& progress) {
    if (auto ok = checkInput(input); !ok) return tl::make_unexpected(ok.error());
    const auto start = std::chrono::steady_clock::now();
    ElementResponse response;
    response.bases = basesOf(input, response.firstColumn);
    const int g = response.columns();
    if (input.faces.empty()) {
        response.freeVertices = verticesWithoutFace(input);
        response.response.resize(3 * static_cast<Eigen::Index>(response.freeVertices.size()), 0);
        response.stiffness.resize(0, 0);
        return response;
    }
    auto problem = BoundaryProblem::build(problemOf(input), progress.part(0.0, 0.9));
    if (!problem) return tl::make_unexpected(problem.error());
    const HeldModes modes = heldModes(input, response.bases, response.firstColumn);
    auto solution = problem->solve(modes.C, progress.part(0.9, 1.0));
    if (!solution) return tl::make_unexpected(solution.error());
    response.freeVertices = problem->freeVertices();
    response.response = std::move(solution->displacement);
    response.stiffness = modes.C.transpose() * faceMass(input, solution->traction);
    response.quality.solve = problem->quality();
    if (g > 0 && !cleanStiffness(modes, input, response.stiffness, response.quality))
        return fail("singular", "The joint modes of a face cannot be told apart; choose larger joint faces.");
    response.quality.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return response;
}

ResponseEstimate estimateResponse(const ResponseInput& input) {
    ResponseEstimate out;
    if (!input.mesh) return out;
    std::vector<int> firstColumn;
    basesOf(input, firstColumn);
    out.columns = firstColumn.back();
    if (input.faces.empty()) return out;
    const auto vertices = static_cast<int>(input.mesh->body.vertices.rows());
    const BoundaryProblem::Estimate solve = BoundaryProblem::estimate(vertices, static_cast<int>(input.mesh->body.triangles.rows()), out.columns, input.threads);
    out.seconds = solve.seconds;
    out.bytes = solve.bytes;

    // The product reads each entry of A' once, as float: measured on as much memory, warm.
    useSingleThreadedBlas();
    const std::size_t entries = 3 * static_cast<std::size_t>(vertices) * static_cast<std::size_t>(out.columns);
    constexpr std::size_t kMost = std::size_t{16} << 20;  // beyond every cache: the rate stays the same
    const std::size_t measured = std::min(entries, kMost);
    const std::vector<float> data(measured);
    double best = 1e9;
    for (int round = 0; round < 4; ++round) {
        const auto start = std::chrono::steady_clock::now();
        cblas_sdot(static_cast<int>(measured), data.data(), 1, data.data(), 1);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    out.frameMilliseconds = 1e3 * best * static_cast<double>(entries) / static_cast<double>(measured);
    return out;
}

Result<Points> solveFull(const ResponseInput& input, const std::vector<Points>& faceDisplacement, const Progress& progress) {
    if (auto ok = checkInput(input); !ok) return tl::make_unexpected(ok.error());
    if (faceDisplacement.size() != input.faces.size()) return fail("bad-value", "Give the displacements of every joint face.");
    auto problem = BoundaryProblem::build(problemOf(input), progress.part(0.0, 0.9));
    if (!problem) return tl::make_unexpected(problem.error());
    Points out = Points::Zero(input.mesh->body.vertices.rows(), 3);
    Eigen::Index rows = 0;
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
        const auto& vertices = input.faces[f].vertices;
        if (faceDisplacement[f].rows() != static_cast<Eigen::Index>(vertices.size()))
            return fail("bad-value", "The displacements of a joint face do not match its vertices.");
        for (std::size_t i = 0; i < vertices.size(); ++i) out.row(vertices[i]) = faceDisplacement[f].row(static_cast<Eigen::Index>(i));
        rows += faceDisplacement[f].rows();
    }
    Eigen::MatrixXd held(3 * rows, 1);
    Eigen::Index row = 0;
    for (const Points& face : faceDisplacement)
        for (Eigen::Index i = 0; i < face.rows(); ++i, row += 3) held.block<3, 1>(row, 0) = face.row(i).transpose();
    auto solution = problem->solve(held, progress.part(0.9, 1.0));
    if (!solution) return tl::make_unexpected(solution.error());
    const auto& freeVertices = problem->freeVertices();
    for (std::size_t i = 0; i < freeVertices.size(); ++i)
        out.row(freeVertices[i]) = solution->displacement.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0).transpose();
    return out;
}

}  // namespace imomushi
