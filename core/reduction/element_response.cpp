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
#include "core/reduction/display_mapping.h"
#include "core/reduction/solved_body.h"

namespace imomushi {
namespace {

/// Changes whenever the same input gives other numbers: cached answers of an older solver are then computed again.
constexpr int kSolverVersion = 2;

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

BoundaryProblem::Input problemOf(const ResponseInput& input, const SolverMesh& mesh) {
    BoundaryProblem::Input problem;
    problem.mesh = &mesh.mesh;
    for (const SolverMesh::Patch& face : mesh.faces) problem.held.push_back({face.vertices, face.triangles});
    problem.bubbles = mesh.bubbles;
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
    if (!input.faces.empty()) return BoundaryProblem::check(problemOf(input));
    return {};
}

/// The vertices of all faces, in the order of BoundaryProblem::solve: C (displacement per joint parameter) and the six rigid motions about the
/// middle of the body, in units of its size.
struct HeldModes {
    Eigen::MatrixXd C;  ///< 3 * #held x g
    Eigen::MatrixXd R;  ///< 3 * #held x 6
};

HeldModes heldModes(const SolvedBody& solved, const std::vector<FaceBasis>& bases, const std::vector<int>& firstColumn) {
    Eigen::Index held = 0;
    for (const SolverMesh::Patch& face : solved.mesh.faces) held += static_cast<Eigen::Index>(face.vertices.size());
    HeldModes modes{Eigen::MatrixXd::Zero(3 * held, firstColumn.back()), Eigen::MatrixXd::Zero(3 * held, 6)};
    const Points& points = solved.mesh.mesh.vertices;
    const Vec3 low = points.colwise().minCoeff().transpose(), high = points.colwise().maxCoeff().transpose();
    Eigen::Index row = 0;
    for (std::size_t f = 0; f < bases.size(); ++f) {
        const FaceFrame& frame = solved.faces[f].frame;
        for (const std::int32_t v : solved.mesh.faces[f].vertices) {
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
Eigen::MatrixXd faceMass(const SolverMesh& mesh, const Eigen::MatrixXd& Z) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(Z.rows(), Z.cols());
    std::vector<Eigen::Index> row(static_cast<std::size_t>(mesh.mesh.vertices.rows()));
    Eigen::Index next = 0;
    for (const SolverMesh::Patch& face : mesh.faces) {
        for (const std::int32_t v : face.vertices) {
            row[static_cast<std::size_t>(v)] = next;
            next += 3;
        }
        const auto rowOf = [&](std::int32_t f, int corner) { return row[static_cast<std::size_t>(mesh.mesh.triangles(f, corner))]; };
        for (const std::int32_t f : face.triangles) {
            const double share = 0.5 * areaVector(mesh.mesh, f).norm() / 12.0;
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
bool cleanStiffness(const HeldModes& modes, const SolverMesh& mesh, Eigen::MatrixXd& K, ResponseQuality& quality) {
    useSingleThreadedBlas();
    const auto g = static_cast<int>(K.rows());
    const double symmetricNorm = (K + K.transpose()).norm();
    quality.asymmetry = symmetricNorm > 0.0 ? (K - K.transpose()).norm() / symmetricNorm : 0.0;

    // In parameters scaled to unit diagonal of W.
    const Eigen::MatrixXd massC = faceMass(mesh, modes.C);
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
    Eigen::MatrixXd missed = miss.transpose() * faceMass(mesh, miss), size = modes.R.transpose() * faceMass(mesh, modes.R);
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

/// The displacement of the held vertices of the solver mesh, 3 * #held x 1, from that of the body's vertices, #V x 3: linear in between.
Eigen::MatrixXd heldDisplacement(const SolvedBody& solved, const Points& body) {
    const SolverMesh& mesh = solved.mesh;
    Points all(mesh.mesh.vertices.rows(), 3);
    const auto own = static_cast<Eigen::Index>(solved.bodyVertex.size());
    for (Eigen::Index v = 0; v < own; ++v) {
        const std::int32_t from = solved.bodyVertex[static_cast<std::size_t>(v)];
        all.row(v).setZero();
        if (from >= 0) all.row(v) = body.row(from);  // vertices of faces are never moved by decimation
    }
    for (Eigen::Index v = own; v < all.rows(); ++v) {
        const auto& [of, share] = mesh.origin[static_cast<std::size_t>(v - own)];
        all.row(v) = share[0] * all.row(of[0]) + share[1] * all.row(of[1]) + share[2] * all.row(of[2]);
    }
    std::vector<double> out;
    for (const SolverMesh::Patch& face : mesh.faces)
        for (const std::int32_t v : face.vertices)
            for (int k = 0; k < 3; ++k) out.push_back(all(v, k));
    return Eigen::Map<const Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

/// Displacement at all nodes that are seen of a solved body: its vertices, then the middles of its bubbles' edges.
Eigen::MatrixXd seenDisplacement(const SolverMesh& mesh, const std::vector<std::int32_t>& freeVertices, const Eigen::MatrixXd& held,
                                 const BoundaryProblem::Solution& solution) {
    const Eigen::Index vertices = mesh.mesh.vertices.rows(), bubbles = static_cast<Eigen::Index>(mesh.bubbles.size());
    Eigen::MatrixXd out(3 * (vertices + bubbles), held.cols());
    for (std::size_t i = 0; i < freeVertices.size(); ++i)
        out.middleRows(3 * freeVertices[i], 3) = solution.displacement.middleRows(3 * static_cast<Eigen::Index>(i), 3);
    Eigen::Index row = 0;
    for (const SolverMesh::Patch& face : mesh.faces)
        for (const std::int32_t v : face.vertices) {
            out.middleRows(3 * v, 3) = held.middleRows(row, 3);
            row += 3;
        }
    for (Eigen::Index b = 0; b < bubbles; ++b) {
        const auto& [from, to] = mesh.bubbles[static_cast<std::size_t>(b)];
        out.middleRows(3 * (vertices + b), 3) =
            0.5 * (out.middleRows(3 * from, 3) + out.middleRows(3 * to, 3)) + solution.bubbles.middleRows(3 * b, 3);
    }
    return out;
}

/// One level of the solution: displacement of the body's free vertices (3 #free x k) for prescribed displacements of the held solver vertices.
struct Level {
    Eigen::MatrixXd response, traction;
    SolveQuality quality;
    double mappingError = 0.0, shapeError = 0.0;
};

/// `held`: 3 #held x k. `bodyFree`: the body's free vertices, ascending.
Result<Level> solveLevel(const ResponseInput& input, const SolvedBody& solved, const std::vector<std::int32_t>& bodyFree, const Eigen::MatrixXd& held,
                         const Progress& progress) {
    auto problem = BoundaryProblem::build(problemOf(input, solved.mesh), progress.part(0.0, 0.9));
    if (!problem) return tl::make_unexpected(problem.error());
    auto solution = problem->solve(held, progress.part(0.9, 0.98));
    if (!solution) return tl::make_unexpected(solution.error());
    Level level;
    level.quality = problem->quality();
    if (!solved.decimated) {
        // The solver mesh begins with the body's vertices, and both lists ascend.
        level.response = solution->displacement.topRows(3 * static_cast<Eigen::Index>(bodyFree.size()));
    } else {
        const SolverMesh seen = halvedAtBubbles(solved.mesh);
        std::vector<char> leaveOut(static_cast<std::size_t>(input.mesh->body.vertices.rows()), 1);
        for (const std::int32_t v : bodyFree) leaveOut[static_cast<std::size_t>(v)] = 0;
        std::vector<std::int32_t> heldTriangles;
        for (const SolverMesh::Patch& face : seen.faces) heldTriangles.insert(heldTriangles.end(), face.triangles.begin(), face.triangles.end());
        auto map = DisplayMapping::build({&input.mesh->body, leaveOut, &seen.mesh, heldTriangles, input.threads}, progress);
        if (!map) return tl::make_unexpected(map.error());
        auto mapped = map->apply(seenDisplacement(solved.mesh, problem->freeVertices(), held, *solution), input.nu, input.threads, progress);
        if (!mapped) return tl::make_unexpected(mapped.error());
        level.response = std::move(mapped->displacement);
        if (mapped->error.size() > 0) level.mappingError = mapped->error.norm() / std::sqrt(static_cast<double>(mapped->error.size()));
        level.shapeError = map->distance().shape;
    }
    level.traction = std::move(solution->traction);
    return level;
}

/// The error of `fine` by its difference from a coarser level, relative to the motion of free and held vertices together, root mean square over the
/// columns. Negative where no coarser level can be made.
Result<double> estimateError(const ResponseInput& input, const SolvedBody& solved, const std::vector<std::int32_t>& bodyFree,
                             const std::vector<FaceBasis>& bases, const std::vector<int>& firstColumn, const Eigen::MatrixXd& held,
                             const Eigen::MatrixXd& fine, const Progress& progress) {
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    const auto coarser = coarserLevel(input.mesh->body, input.faces, solved, progress);
    if (progress.cancelled()) return cancelled();
    if (!coarser) return -1.0;
    const HeldModes modes = heldModes(coarser->body, bases, firstColumn);
    const auto level = solveLevel(input, coarser->body, bodyFree, modes.C, progress);
    if (progress.cancelled()) return cancelled();
    if (!level) return -1.0;
    double sum = 0.0;
    for (Eigen::Index c = 0; c < held.cols(); ++c) {
        const double size = fine.col(c).squaredNorm() / static_cast<double>(fine.rows()) + held.col(c).squaredNorm() / static_cast<double>(held.rows());
        if (size > 0.0) sum += (fine.col(c) - level->response.col(c)).squaredNorm() / static_cast<double>(fine.rows()) / size;
    }
    return coarser->share * std::sqrt(sum / static_cast<double>(held.cols()));
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
    hasher.number(static_cast<int>(input.solverMesh.kind));
    hasher.number(input.solverMesh.count);
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
    auto solved = solvedBody(input.mesh->body, input.faces, input.solverMesh, progress.part(0.0, 0.1));
    if (!solved) return tl::make_unexpected(solved.error());
    const SolverMesh& mesh = solved->mesh;
    const HeldModes modes = heldModes(*solved, response.bases, response.firstColumn);
    response.freeVertices = verticesWithoutFace(input);
    auto level = solveLevel(input, *solved, response.freeVertices, modes.C, progress.part(0.1, 0.95));
    if (!level) return tl::make_unexpected(level.error());
    auto error = estimateError(input, *solved, response.freeVertices, response.bases, response.firstColumn, modes.C, level->response,
                               progress.part(0.95, 1.0));
    if (!error) return tl::make_unexpected(error.error());
    response.response = std::move(level->response);
    response.stiffness = modes.C.transpose() * faceMass(mesh, level->traction);
    ResponseQuality& quality = response.quality;
    quality.solve = level->quality;
    quality.solverVertices = static_cast<int>(mesh.mesh.vertices.rows());
    quality.solverNodes = solved->nodes();
    quality.decimated = solved->decimated;
    quality.error = *error;
    quality.mappingError = level->mappingError;
    quality.shapeError = level->shapeError;
    if (g > 0 && !cleanStiffness(modes, mesh, response.stiffness, response.quality))
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
    if (!checkInput(input)) return out;
    const SolvedSize size = solvedSize(input.mesh->body, input.faces, input.solverMesh);
    const BoundaryProblem::Estimate solve = BoundaryProblem::estimate(size.nodes, size.triangles, out.columns, input.threads);
    out.seconds = solve.seconds;
    out.bytes = solve.bytes;

    // The product reads each entry of A' once, as float: measured on as much memory, warm.
    useSingleThreadedBlas();
    const std::size_t entries = 3 * static_cast<std::size_t>(input.mesh->body.vertices.rows()) * static_cast<std::size_t>(out.columns);
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
    for (std::size_t f = 0; f < input.faces.size(); ++f)
        if (faceDisplacement[f].rows() != static_cast<Eigen::Index>(input.faces[f].vertices.size()))
            return fail("bad-value", "The displacements of a joint face do not match its vertices.");
    auto solved = solvedBody(input.mesh->body, input.faces, input.solverMesh, progress.part(0.0, 0.1));
    if (!solved) return tl::make_unexpected(solved.error());
    Points out = Points::Zero(input.mesh->body.vertices.rows(), 3);
    for (std::size_t f = 0; f < input.faces.size(); ++f)
        for (std::size_t i = 0; i < input.faces[f].vertices.size(); ++i) out.row(input.faces[f].vertices[i]) = faceDisplacement[f].row(static_cast<Eigen::Index>(i));
    const Eigen::MatrixXd held = heldDisplacement(*solved, out);
    const std::vector<std::int32_t> freeVertices = verticesWithoutFace(input);
    auto level = solveLevel(input, *solved, freeVertices, held, progress.part(0.1, 1.0));
    if (!level) return tl::make_unexpected(level.error());
    for (std::size_t i = 0; i < freeVertices.size(); ++i)
        out.row(freeVertices[i]) = level->response.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0).transpose();
    return out;
}

}  // namespace imomushi
