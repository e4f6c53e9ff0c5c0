// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/element_response.h"

#include <cblas.h>
#include <lapacke.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "core/elasticity/dense_lu.h"
#include "core/mesh/topology.h"
#include "core/reduction/appendages.h"
#include "core/reduction/display_mapping.h"
#include "core/reduction/negative_part.h"
#include "core/reduction/solved_body.h"
#include "core/reduction/touch_patches.h"
#include "core/reduction/touch_response.h"

namespace imomushi {
namespace {

/// Changes whenever the same input gives other numbers: cached answers of an older solver are then computed again.
constexpr int kSolverVersion = 3;

/// The same for warped faces: what their columns are.
constexpr int kModesVersion = 2;

/// The same for touch.
constexpr int kTouchVersion = 1;

/// Relative ridge on the Gram matrix of the joint modes: modes that a small patch cannot tell apart (three vertices, twelve modes) share
/// the load instead of dividing by zero; regular ones change by rounding.
constexpr double kGramRidge = 1e-13;

/// Of the largest energy among joint parameters that displace their faces equally: rounding.
constexpr double kNoStiffness = 1e-13;

/// A combination of rigid motions belongs to the joint modes when they miss it by no more than a flat face may be out of its plane.
constexpr double kRigidMiss = 2.0 * JointFace::kFlatTolerance;

std::vector<FaceBasis> basesOf(const ResponseInput& input, std::vector<int>& firstColumn) {
    std::vector<FaceBasis> bases;
    firstColumn.assign(1, 0);
    for (const JointFace& face : input.faces) {
        bases.push_back(FaceBasis::on(input.mesh->body, face, input.basis));
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
    problem.tolerance = input.solverMesh.tolerance;
    return problem;
}

BoundaryProblem::Input problemOf(const ResponseInput& input, const SolverMesh& mesh) {
    BoundaryProblem::Input problem;
    problem.mesh = &mesh.mesh;
    for (const SolverMesh::Patch& face : mesh.faces) problem.held.push_back({face.vertices, face.triangles});
    problem.bubbles = mesh.bubbles;
    problem.nu = input.nu;
    problem.threads = input.threads;
    problem.tolerance = input.solverMesh.tolerance;
    return problem;
}

Result<void> checkInput(const ResponseInput& input) {
    if (!input.mesh) return fail("bad-value", "The element has no mesh.");
    if (input.touch < 0 || input.touch > ResponseInput::kMostTouch) return fail("bad-value", "The number of touch patches must lie between 0 and 1024.");
    for (const JointFace& face : input.faces)
        for (const std::int32_t v : face.vertices)
            if (v < 0 || v >= input.mesh->body.vertices.rows())
                return fail("bad-value", "The joint face \"" + face.name + "\" names a vertex that does not exist; choose it again.");
    if (!input.faces.empty()) return BoundaryProblem::check(problemOf(input));
    return {};
}

/// How a vertex of the solver mesh lies between those of the body.
using Shares = std::vector<std::pair<std::int32_t, double>>;

/// Of each vertex of the solver mesh that a face holds: the body's vertices around it with their shares, ascending. None where decimation left out
/// what lies around it.
std::vector<Shares> heldShares(const SolvedBody& solved) {
    const SolverMesh& mesh = solved.mesh;
    std::vector<char> held(static_cast<std::size_t>(mesh.mesh.vertices.rows()));
    for (const SolverMesh::Patch& face : mesh.faces)
        for (const std::int32_t v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    std::vector<Shares> shares(held.size());
    const std::size_t own = solved.bodyVertex.size();
    for (std::size_t v = 0; v < shares.size(); ++v) {
        if (!held[v]) continue;
        if (v < own) {
            if (solved.bodyVertex[v] >= 0) shares[v] = {{solved.bodyVertex[v], 1.0}};
            continue;
        }
        std::map<std::int32_t, double> sum;
        const auto& [of, share] = mesh.origin[v - own];
        for (std::size_t k = 0; k < 3; ++k)
            for (const auto& [vertex, part] : shares[static_cast<std::size_t>(of[k])])
                if (share[k] != 0.0) sum[vertex] += share[k] * part;
        shares[v].assign(sum.begin(), sum.end());
    }
    return shares;
}

/// The vertices of all faces, in the order of BoundaryProblem::solve: C (displacement per joint parameter) and the six rigid motions about the
/// middle of the body, in units of its size.
struct HeldModes {
    Eigen::MatrixXd C;  ///< 3 * #held x g
    Eigen::MatrixXd R;  ///< 3 * #held x 6
    Vec3 middle = Vec3::Zero();
    double size = 1.0;
};

HeldModes heldModes(const ResponseInput& input, const SolvedBody& solved, const std::vector<FaceBasis>& bases, const std::vector<int>& firstColumn) {
    Eigen::Index held = 0;
    for (const SolverMesh::Patch& face : solved.mesh.faces) held += static_cast<Eigen::Index>(face.vertices.size());
    HeldModes modes{Eigen::MatrixXd::Zero(3 * held, firstColumn.back()), Eigen::MatrixXd::Zero(3 * held, 6)};
    const Points& points = solved.mesh.mesh.vertices;
    const Vec3 low = points.colwise().minCoeff().transpose(), high = points.colwise().maxCoeff().transpose();
    modes.middle = 0.5 * (low + high);
    modes.size = (high - low).norm();
    const bool full = std::any_of(bases.begin(), bases.end(), [](const FaceBasis& basis) { return basis.kind == BasisKind::Full; });
    const std::vector<Shares> shares = full ? heldShares(solved) : std::vector<Shares>();
    Eigen::Index row = 0;
    for (std::size_t f = 0; f < bases.size(); ++f) {
        const FaceFrame& frame = solved.faces[f].frame;
        const std::vector<std::int32_t>& ofBody = input.faces[f].vertices;
        for (const std::int32_t v : solved.mesh.faces[f].vertices) {
            const Vec3 p = points.row(v).transpose();
            if (bases[f].kind == BasisKind::Full) {
                for (const auto& [vertex, share] : shares[static_cast<std::size_t>(v)]) {
                    const auto i = std::lower_bound(ofBody.begin(), ofBody.end(), vertex) - ofBody.begin();
                    modes.C.block<3, 3>(row, firstColumn[f] + 3 * i) = share * frame.axes;
                }
            } else {
                modes.C.block(row, firstColumn[f], 3, bases[f].columns()) = frame.axes * bases[f].at(frame.toLocal(p));
            }
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

/// What each load does in all when the body moves along the rigid motions of HeldModes: 6 x BoundaryEquation::kLoads, m^3 and m^2.
Eigen::Matrix<double, 6, BoundaryEquation::kLoads> wholeLoads(const ResponseInput& input, const HeldModes& modes) {
    const TriangleMesh& body = input.mesh->body;
    std::vector<char> covered(static_cast<std::size_t>(body.triangles.rows()));
    for (const JointFace& face : input.faces)
        for (const std::int32_t f : face.triangles) covered[static_cast<std::size_t>(f)] = 1;
    double volume = 0.0;
    Vec3 firstMoment = Vec3::Zero(), pressure = Vec3::Zero(), pressureMoment = Vec3::Zero();
    for (std::int32_t f = 0; f < body.triangles.rows(); ++f) {
        Vec3 corners = Vec3::Zero();
        for (int c = 0; c < 3; ++c) corners += body.vertices.row(body.triangles(f, c)).transpose() - modes.middle;
        const Vec3 area = 0.5 * areaVector(body, f);
        const double cone = area.dot(Vec3(body.vertices.row(body.triangles(f, 0)).transpose()) - modes.middle) / 3.0;  // from the middle to the triangle
        volume += cone;
        firstMoment += cone * corners / 4.0;
        if (covered[static_cast<std::size_t>(f)]) continue;
        pressure += area;
        pressureMoment += (corners / 3.0).cross(area);
    }
    Eigen::Matrix<double, 6, BoundaryEquation::kLoads> out;
    for (int axis = 0; axis < 3; ++axis) {
        out.col(axis).head<3>() = volume * Vec3::Unit(axis);
        out.col(axis).tail<3>() = firstMoment.cross(Vec3::Unit(axis)) / modes.size;
    }
    out.col(3) << pressure, pressureMoment / modes.size;
    return out;
}

/// The mass matrix of linear functions on the faces, times Z (3 * #held x any): int N_a N_b dS, m^2.
Eigen::MatrixXd faceMass(const SolverMesh& mesh, const Eigen::MatrixXd& Z) {
    std::vector<std::int32_t> row(static_cast<std::size_t>(mesh.mesh.vertices.rows()));
    std::vector<Eigen::Triplet<double>> entries;
    std::int32_t next = 0;
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
                    for (int axis = 0; axis < 3; ++axis) entries.emplace_back(rowOf(f, a) + axis, rowOf(f, b) + axis, (a == b ? 2.0 : 1.0) * share);
        }
    }
    Eigen::SparseMatrix<double> mass(Z.rows(), Z.rows());
    mass.setFromTriplets(entries.begin(), entries.end());
    return mass * Z;
}

/// Z <- L Z L^T, or L^-1 Z L^-T, of symmetric Z, with the lower triangle of `L`, some columns at a time. False: cancelled.
bool congruent(const Eigen::MatrixXd& L, bool inverse, Eigen::MatrixXd& Z, const Progress& progress) {
    const auto n = static_cast<int>(Z.rows());
    constexpr int kBatch = 256;
    for (int side = 0; side < 2; ++side) {
        for (int first = 0; first < n; first += kBatch) {
            if (progress.cancelled()) return false;
            const int count = std::min(kBatch, n - first);
            if (inverse)
                cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, n, count, 1.0, L.data(), n, &Z(0, first), n);
            else
                cblas_dtrmm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, n, count, 1.0, L.data(), n, &Z(0, first), n);
        }
        Z.transposeInPlace();
    }
    Z = (0.5 * (Z + Z.transpose())).eval();
    return true;
}

/// Makes K what a stiffness must be: symmetric, zero on rigid motions, without negative energy. W = C^T mass C measures joint
/// parameters by the displacement they make, so that metres and radians need no weights of their own. `loadForces` (g x k) are made to
/// balance `loads` (6 x k, see wholeLoads()) on rigid motions, by the smallest change.
/// Errors: "singular": the input is not positive definite or not finite (a face without area); "cancelled".
Result<void> cleanStiffness(const HeldModes& modes, const SolverMesh& mesh, const Eigen::MatrixXd& loads,
                            Eigen::MatrixXd& K, Eigen::MatrixXd& loadForces, ResponseQuality& quality, const Progress& progress) {
    useSingleThreadedBlas();
    const auto singular = [] { return fail("singular", "The joint modes of a face cannot be told apart; choose larger joint faces."); };
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    const auto g = static_cast<int>(K.rows());
    const double symmetricNorm = (K + K.transpose()).norm();
    quality.asymmetry = symmetricNorm > 0.0 ? (K - K.transpose()).norm() / symmetricNorm : 0.0;

    // In parameters scaled to unit diagonal of W.
    const Eigen::SparseMatrix<double> C = modes.C.sparseView();
    const Eigen::MatrixXd massC = faceMass(mesh, modes.C);
    Eigen::MatrixXd W = C.transpose() * massC;
    const Eigen::VectorXd unit = W.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    W = (unit.asDiagonal() * (0.5 * (W + W.transpose())) * unit.asDiagonal()).eval();
    W.diagonal().array() += kGramRidge;
    Eigen::MatrixXd scaled = unit.asDiagonal() * (0.5 * (K + K.transpose())) * unit.asDiagonal();
    if (progress.cancelled()) return cancelled();

    // Rigid motions among the modes: least squares in the mass norm, then the combinations that are met.
    Eigen::MatrixXd factor = W;
    if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', g, factor.data(), g) != 0) return singular();
    if (progress.cancelled()) return cancelled();
    Eigen::MatrixXd rigid = unit.asDiagonal() * (massC.transpose() * modes.R);
    LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', g, 6, factor.data(), g, rigid.data(), g);
    const Eigen::MatrixXd miss = modes.R - C * (unit.asDiagonal() * rigid);
    Eigen::MatrixXd missed = miss.transpose() * faceMass(mesh, miss), size = modes.R.transpose() * faceMass(mesh, modes.R);
    size.diagonal().array() += 1e-9 * size.trace();  // rotations that a single straight row of vertices cannot show
    Eigen::VectorXd ratio(6);
    if (LAPACKE_dsygv(LAPACK_COL_MAJOR, 1, 'V', 'L', 6, missed.data(), 6, size.data(), 6, ratio.data()) != 0) return singular();
    int found = 0;
    while (found < 6 && ratio[found] <= kRigidMiss * kRigidMiss) ++found;
    if (found > 0) {
        const Eigen::MatrixXd V = rigid * missed.leftCols(found);
        const Eigen::MatrixXd WV = W * V;
        Eigen::MatrixXd gram = V.transpose() * WV, along = WV.transpose();
        if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', found, g, gram.data(), found, along.data(), found) != 0) return singular();
        if (loadForces.size() > 0) {
            const Eigen::MatrixXd forces = unit.asDiagonal() * loadForces;
            // `along` is gram^-1 (W V)^T, so that V^T along^T = I.
            const Eigen::MatrixXd missing = -missed.leftCols(found).transpose() * loads - V.transpose() * forces;
            loadForces = unit.cwiseInverse().asDiagonal() * (forces + along.transpose() * missing);
        }
        // The projector I - V along, on both sides.
        const Eigen::MatrixXd SV = scaled * V, VSV = V.transpose() * SV;
        scaled -= SV * along;
        scaled -= along.transpose() * SV.transpose() - along.transpose() * VSV.transpose() * along;
    }

    // Eigenvalues relative to W; negative ones (of rounding or of a coarse mesh) carry no energy.
    if (!congruent(factor, true, scaled, progress)) return cancelled();
    const auto spectrum = removeNegativePart(scaled, progress);
    if (!spectrum) return tl::make_unexpected(spectrum.error());
    quality.negativeEnergy = spectrum->highest > 0.0 ? std::min(spectrum->lowest, 0.0) / spectrum->highest : 0.0;
    if (!congruent(factor, false, scaled, progress)) return cancelled();
    const Eigen::VectorXd back = unit.cwiseInverse();
    K = back.asDiagonal() * scaled * back.asDiagonal();
    K = (0.5 * (K + K.transpose())).eval();  // to the last bit
    // Parameters that move a body of one face rigidly have no stiffness but that of rounding, which may be negative.
    for (int i = 0; i < g; ++i)
        if (scaled(i, i) <= kNoStiffness * scaled.diagonal().maxCoeff()) {
            K.row(i).setZero();
            K.col(i).setZero();
        }
    if (!K.allFinite()) return singular();
    return {};
}

/// The tractions at the body's vertices, linear in between, with the nodal forces `forces` (3 m x g, in face axes, each vertex 3 i + axis) but for the
/// linear field that balances them: collocation balances forces only as far as it solves. 3 m x g in element axes. Empty: a face without area.
Eigen::MatrixXd nodalTractions(const ResponseInput& input, const HeldModes& modes, const std::vector<int>& firstColumn, const Eigen::MatrixXd& forces) {
    useSingleThreadedBlas();
    const TriangleMesh& body = input.mesh->body;
    const Eigen::Index g = forces.cols();
    Eigen::MatrixXd tractions(forces.rows(), g), R(forces.rows(), 6), massR(forces.rows(), 6), total = Eigen::MatrixXd::Zero(6, g);
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
        const JointFace& face = input.faces[f];
        const auto m = static_cast<Eigen::Index>(face.vertices.size());
        const auto at = [&](std::int32_t triangle, int corner) {
            return std::lower_bound(face.vertices.begin(), face.vertices.end(), body.triangles(triangle, corner)) - face.vertices.begin();
        };
        Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(m, m), x(m, 3 * g);
        for (const std::int32_t t : face.triangles)
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) mass(at(t, a), at(t, b)) += (a == b ? 2.0 : 1.0) / 24.0 * areaVector(body, t).norm();
        for (Eigen::Index i = 0; i < m; ++i) {
            const Eigen::Index row = firstColumn[f] + 3 * i;
            const Eigen::MatrixXd force = face.frame.axes * forces.middleRows(row, 3);
            const Vec3 arm = (Vec3(body.vertices.row(face.vertices[static_cast<std::size_t>(i)]).transpose()) - modes.middle) / modes.size;
            for (int axis = 0; axis < 3; ++axis) {
                x.row(i).segment(axis * g, g) = force.row(axis);
                R.block<3, 1>(row, axis) = Vec3::Unit(axis);
                R.block<3, 1>(row, 3 + axis) = Vec3::Unit(axis).cross(arm);
            }
            total += R.middleRows(row, 3).transpose() * force;
        }
        for (Eigen::Index i = 0; i < m; ++i) {
            massR.middleRows(firstColumn[f] + 3 * i, 3).setZero();
            for (Eigen::Index k = 0; k < m; ++k) massR.middleRows(firstColumn[f] + 3 * i, 3) += mass(i, k) * R.middleRows(firstColumn[f] + 3 * k, 3);
        }
        const auto size = static_cast<lapack_int>(m);
        if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', size, static_cast<lapack_int>(3 * g), mass.data(), size, x.data(), size) != 0) return {};
        for (Eigen::Index i = 0; i < m; ++i)
            for (int axis = 0; axis < 3; ++axis) tractions.row(firstColumn[f] + 3 * i + axis) = x.row(i).segment(axis * g, g);
    }
    Eigen::MatrixXd gram = R.transpose() * massR;
    if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', 6, static_cast<lapack_int>(g), gram.data(), 6, total.data(), 6) != 0) return {};
    tractions -= R * total;
    return tractions;
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
    const Eigen::Index loads = solution.displacement.cols() - held.cols();  // which hold the faces at rest
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * (vertices + bubbles), held.cols() + loads);
    for (std::size_t i = 0; i < freeVertices.size(); ++i)
        out.middleRows(3 * freeVertices[i], 3) = solution.displacement.middleRows(3 * static_cast<Eigen::Index>(i), 3);
    Eigen::Index row = 0;
    for (const SolverMesh::Patch& face : mesh.faces)
        for (const std::int32_t v : face.vertices) {
            out.block(3 * v, 0, 3, held.cols()) = held.middleRows(row, 3);
            row += 3;
        }
    for (Eigen::Index b = 0; b < bubbles; ++b) {
        const auto& [from, to] = mesh.bubbles[static_cast<std::size_t>(b)];
        out.middleRows(3 * (vertices + b), 3) =
            0.5 * (out.middleRows(3 * from, 3) + out.middleRows(3 * to, 3)) + solution.bubbles.middleRows(3 * b, 3);
    }
    return out;
}

/// An element and what is solved in its place: the same without its appendages.
struct Trimmed {
    const ResponseInput* whole = nullptr;
    ResponseInput input;
    TrimmedBody body;
    std::vector<std::int32_t> freeVertices, wholeFree;  ///< ascending: of the trimmed body and of the whole one
};

Result<Trimmed> trimmed(const ResponseInput& whole, const Progress& progress) {
    auto body = withoutAppendages(whole.mesh->body, whole.faces, progress);
    if (!body) return tl::make_unexpected(body.error());
    Trimmed out{&whole, whole, std::move(*body), {}, verticesWithoutFace(whole)};
    if (!out.body.appendages.empty()) {
        out.input.mesh = std::make_shared<ElementMesh>(ElementMesh{out.body.mesh, {}});
        out.input.faces = out.body.faces;
    }
    out.freeVertices = verticesWithoutFace(out.input);
    return out;
}

/// 3 * #wholeFree x k from 3 * #freeVertices x k.
Eigen::MatrixXd onWhole(const Trimmed& element, Eigen::MatrixXd displacement) {
    if (element.body.appendages.empty()) return displacement;
    Eigen::MatrixXd solved = Eigen::MatrixXd::Zero(element.body.mesh.vertices.size(), displacement.cols());
    for (std::size_t i = 0; i < element.freeVertices.size(); ++i) solved.middleRows<3>(3 * element.freeVertices[i]) = displacement.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    const Eigen::MatrixXd all = element.body.onBody(element.whole->mesh->body.vertices, solved);
    displacement.resize(3 * static_cast<Eigen::Index>(element.wholeFree.size()), displacement.cols());
    for (std::size_t i = 0; i < element.wholeFree.size(); ++i) displacement.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = all.middleRows<3>(3 * element.wholeFree[i]);
    return displacement;
}

/// One level of the solution: displacement of the body's free vertices (3 #free x k) for prescribed displacements of the held solver vertices.
struct Level {
    Eigen::MatrixXd response, traction;  ///< with loads: their columns last
    Eigen::MatrixXd compliance;          ///< of touch patches, see patchCompliance()
    SolveQuality quality;
    double mappingError = 0.0, shapeError = 0.0;
};

/// `held`: 3 #held x k. The displacement is that of the whole body.
Result<Level> solveLevel(const Trimmed& element, const SolvedBody& solved, const Eigen::MatrixXd& held, const BoundaryProblem::Loads& loads, const Progress& progress) {
    const ResponseInput& input = element.input;
    const std::vector<std::int32_t>& bodyFree = element.freeVertices;
    auto problem = BoundaryProblem::build(problemOf(input, solved.mesh), progress.part(0.0, 0.9));
    if (!problem) return tl::make_unexpected(problem.error());
    auto solution = problem->solve(held, loads, progress.part(0.9, 0.98));
    if (!solution) return tl::make_unexpected(solution.error());
    Level level;
    if (loads.tractions) level.compliance = patchCompliance(solved.mesh, *loads.tractions, problem->freeVertices(), *solution);
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
    level.response = onWhole(element, std::move(level.response));
    level.traction = std::move(solution->traction);
    return level;
}

/// What is asked for besides the joint modes: body loads, then touch patches, with all faces at rest.
struct WantedLoads {
    const ResponseInput* input = nullptr;  ///< the whole element
    TouchPatches patches;
    Eigen::MatrixXd tractions;             ///< of the patches on the mesh that is solved

    void place(const SolvedBody& solved) {
        if (patches.count() > 0) tractions = patchTractions(patches, input->mesh->body, input->faces, solved);
    }
    [[nodiscard]] BoundaryProblem::Loads columns() const { return {input->loads, patches.count() > 0 ? &tractions : nullptr}; }
    /// What they do in all, 6 x k.
    [[nodiscard]] Eigen::MatrixXd whole(const SolverMesh& mesh, const HeldModes& modes) const {
        const Eigen::Index body = input->loads ? BoundaryEquation::kLoads : 0;
        Eigen::MatrixXd out(6, body + 3 * patches.count());
        if (body > 0) out.leftCols(body) = wholeLoads(*input, modes);
        if (patches.count() > 0) out.rightCols(3 * patches.count()) = wholeTractions(mesh, tractions, modes.middle, modes.size);
        return out;
    }
};

/// Loads solved on the whole body: they act on appendages, which bend under them.
struct Loads {
    Eigen::MatrixXd displacement, forces, compliance, whole;  ///< 3 #free x k, g x k, see TouchResponse, 6 x k about the middle of `modes`
};
Result<Loads> loadsOnWhole(const ResponseInput& input, WantedLoads& wanted, const HeldModes& modes, const ElementResponse& response, const Progress& progress) {
    const Trimmed whole{&input, input, {}, response.freeVertices, response.freeVertices};
    const auto solved = solvedBody(input.mesh->body, input.faces, input.solverMesh, progress.part(0.0, 0.1));
    if (!solved) return tl::make_unexpected(solved.error());
    wanted.place(*solved);
    const Eigen::MatrixXd C = heldModes(input, *solved, response.bases, response.firstColumn).C;
    auto level = solveLevel(whole, *solved, C, wanted.columns(), progress.part(0.1, 1.0));
    if (!level) return tl::make_unexpected(level.error());
    const Eigen::Index count = wanted.columns().columns();
    return Loads{level->response.rightCols(count), C.transpose() * faceMass(solved->mesh, level->traction.rightCols(count)), std::move(level->compliance),
                 wanted.whole(solved->mesh, modes)};
}

/// The error of `fine` by its difference from a coarser level, relative to the motion of free and held vertices together, root mean square over the
/// joint modes. Of a full basis the affine motions of its faces are compared, which is what other bases have as modes. Negative where no
/// coarser level can be made.
Result<double> estimateError(const Trimmed& element, const SolvedBody& solved, const ElementResponse& response, const Eigen::MatrixXd& C,
                             const Eigen::MatrixXd& fineResponse, const Progress& progress) {
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    const ResponseInput& input = element.input;
    const auto coarser = coarserLevel(input.mesh->body, input.faces, solved, progress);
    if (progress.cancelled()) return cancelled();
    if (!coarser) return -1.0;
    ResponseInput compared = input;
    if (input.basis == BasisKind::Full) compared.basis = BasisKind::Affine;
    std::vector<int> firstColumn;
    const std::vector<FaceBasis> bases = basesOf(compared, firstColumn);
    const HeldModes modes = heldModes(compared, coarser->body, bases, firstColumn);
    const auto level = solveLevel(element, coarser->body, modes.C, {}, progress);
    if (progress.cancelled()) return cancelled();
    if (!level) return -1.0;
    Eigen::MatrixXd held = C, fine = fineResponse.leftCols(response.columns());
    if (input.basis == BasisKind::Full) {
        Eigen::MatrixXd affine = Eigen::MatrixXd::Zero(response.columns(), firstColumn.back());
        for (std::size_t f = 0; f < bases.size(); ++f) {
            const Points rest = localVertices(input.mesh->body, input.faces[f]);
            for (Eigen::Index i = 0; i < rest.rows(); ++i)
                affine.block(response.firstColumn[f] + 3 * i, firstColumn[f], 3, bases[f].columns()) = bases[f].at(rest.row(i).transpose());
        }
        held = (held * affine).eval();
        fine = (fine * affine).eval();
    }
    double sum = 0.0;
    for (Eigen::Index c = 0; c < held.cols(); ++c) {
        const double size = fine.col(c).squaredNorm() / static_cast<double>(fine.rows()) + held.col(c).squaredNorm() / static_cast<double>(held.rows());
        if (size > 0.0) sum += (fine.col(c) - level->response.col(c)).squaredNorm() / static_cast<double>(fine.rows()) / size;
    }
    return coarser->share * std::sqrt(sum / static_cast<double>(held.cols()));
}

}  // namespace

std::size_t ElementResponse::bytes() const {
    return sizeof(double) * static_cast<std::size_t>(response.size() + stiffness.size() + tractions.size() + loads.size() + loadForces.size()) + sizeof(std::int32_t) * freeVertices.size() +
           touch.bytes();
}

ContentKey responseKey(const ResponseInput& input) {
    ContentHasher hasher;
    hasher.number(kSolverVersion);
    hasher.number(input.nu);
    hasher.number(static_cast<int>(input.basis.kind));
    if (input.basis.kind == BasisKind::Modes) {
        hasher.number(input.basis.modes);
        hasher.number(kModesVersion);
    }
    hasher.number(static_cast<int>(input.solverMesh.kind));
    hasher.number(input.solverMesh.count);
    if (input.solverMesh.tolerance != SolverMeshSetting::kUsualTolerance) hasher.number(input.solverMesh.tolerance);
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
    if (input.loads) hasher.text("loads");
    if (input.touch > 0) {
        hasher.text("touch");
        hasher.number(kTouchVersion);
        hasher.number(input.touch);
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
    auto element = trimmed(input, progress.part(0.0, 0.02));
    if (!element) return tl::make_unexpected(element.error());
    auto solved = solvedBody(element->input.mesh->body, element->input.faces, input.solverMesh, progress.part(0.02, 0.1));
    if (!solved) return tl::make_unexpected(solved.error());
    const SolverMesh& mesh = solved->mesh;
    const HeldModes modes = heldModes(element->input, *solved, response.bases, response.firstColumn);
    response.freeVertices = element->wholeFree;
    WantedLoads wanted{&input, {}, {}};
    if (input.touch > 0) wanted.patches = touchPatches(input.mesh->body, input.faces, input.touch);
    const bool anyLoads = input.loads || wanted.patches.count() > 0, loadsApart = anyLoads && !element->body.appendages.empty();
    if (anyLoads && !loadsApart) wanted.place(*solved);
    auto level = solveLevel(*element, *solved, modes.C, anyLoads && !loadsApart ? wanted.columns() : BoundaryProblem::Loads{},
                            progress.part(0.1, loadsApart ? 0.5 : 0.95));
    if (!level) return tl::make_unexpected(level.error());
    auto error = estimateError(*element, *solved, response, modes.C, level->response, progress.part(0.95, 1.0));
    if (!error) return tl::make_unexpected(error.error());
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    response.stiffness = Eigen::SparseMatrix<double>(modes.C.sparseView()).transpose() * faceMass(mesh, level->traction);
    response.response = std::move(level->response);
    Loads loads;
    if (loadsApart) {
        auto whole = loadsOnWhole(input, wanted, modes, response, progress.part(0.5, 0.95));
        if (!whole) return tl::make_unexpected(whole.error());
        loads = std::move(*whole);
    } else if (anyLoads) {
        const Eigen::Index count = wanted.columns().columns();
        loads = {response.response.rightCols(count), response.stiffness.rightCols(count), std::move(level->compliance), wanted.whole(mesh, modes)};
        response.response.conservativeResize(Eigen::NoChange, g);
        response.stiffness.conservativeResize(Eigen::NoChange, g);
    }
    if (progress.cancelled()) return cancelled();
    if (input.basis == BasisKind::Full) response.tractions = nodalTractions(input, modes, response.firstColumn, response.stiffness);
    if (progress.cancelled()) return cancelled();
    ResponseQuality& quality = response.quality;
    quality.solve = level->quality;
    quality.solverVertices = static_cast<int>(mesh.mesh.vertices.rows());
    quality.solverNodes = solved->nodes();
    quality.decimated = solved->decimated;
    quality.error = *error;
    quality.mappingError = level->mappingError;
    quality.shapeError = level->shapeError;
    if (auto clean = cleanStiffness(modes, mesh, loads.whole, response.stiffness, loads.forces, response.quality, progress); !clean)
        return tl::make_unexpected(clean.error());
    if (input.loads) {
        response.loads = loads.displacement.leftCols(BoundaryEquation::kLoads);
        response.loadForces = loads.forces.leftCols(BoundaryEquation::kLoads);
    }
    if (const Eigen::Index columns = 3 * wanted.patches.count(); columns > 0) {
        response.touch.patches = std::move(wanted.patches);
        response.touch.displacement = loads.displacement.rightCols(columns).cast<float>();
        response.touch.forces = loads.forces.rightCols(columns);
        response.touch.compliance = std::move(loads.compliance);
        if (auto ok = finishTouch(input.mesh->body, input.faces, response.freeVertices, input.nu, input.threads, response.touch, progress); !ok)
            return tl::make_unexpected(ok.error());
    }
    if (input.basis == BasisKind::Full && response.tractions.size() == 0)
        return fail("singular", "A joint face has no area; choose a larger one.");
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
    const auto body = withoutAppendages(input.mesh->body, input.faces, {});
    if (!body) return out;
    const SolvedSize size = solvedSize(body->mesh, body->faces, input.solverMesh);
    out.hierarchical = BoundaryProblem::hierarchical(size.nodes);
    const int tractions = 3 * std::min<int>(input.touch, static_cast<int>(input.mesh->body.vertices.rows()) / 4);
    const bool loadsApart = (input.loads || tractions > 0) && !body->appendages.empty();
    BoundaryProblem::Estimate solve = BoundaryProblem::estimate(size.nodes, size.triangles, out.columns, input.threads, loadsApart ? 0 : tractions);
    if (loadsApart) {
        const SolvedSize whole = solvedSize(input.mesh->body, input.faces, input.solverMesh);
        const BoundaryProblem::Estimate again = BoundaryProblem::estimate(whole.nodes, whole.triangles, out.columns, input.threads, tractions);
        solve.seconds += again.seconds;
        solve.bytes = std::max(solve.bytes, again.bytes);
    }
    solve.bytes += 3 * sizeof(double) * static_cast<std::size_t>(input.mesh->body.vertices.rows()) * static_cast<std::size_t>(tractions);
    out.seconds = solve.seconds + BoundaryProblem::estimate(size.coarser, 2 * size.coarser, out.columns, input.threads).seconds;
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
    // Cleaning the stiffness of a full basis takes as long as about seven products of its size, half of them bound by memory.
    constexpr int kFewColumns = 300, kSample = 192;
    if (out.columns > kFewColumns) {
        const Eigen::MatrixXd a = Eigen::MatrixXd::Ones(kSample, kSample);
        Eigen::MatrixXd b = a;
        const double product = seconds([&] { cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, kSample, kSample, kSample, 1.0, a.data(), kSample, a.data(), kSample, 0.0, b.data(), kSample); });
        out.seconds += 7.0 * product * std::pow(static_cast<double>(out.columns) / kSample, 3.0);
    }

    // The product reads each entry of A' once, as float: measured on as much memory, warm.
    const std::size_t entries = 3 * static_cast<std::size_t>(input.mesh->body.vertices.rows()) * static_cast<std::size_t>(out.columns);
    constexpr std::size_t kMost = std::size_t{16} << 20;  // beyond every cache: the rate stays the same
    const std::size_t measured = std::min(entries, kMost);
    const std::vector<float> data(measured);
    const double best = seconds([&] { cblas_sdot(static_cast<int>(measured), data.data(), 1, data.data(), 1); });
    out.frameMilliseconds = 1e3 * best * static_cast<double>(entries) / static_cast<double>(measured);
    return out;
}

Result<Points> solveFull(const ResponseInput& input, const std::vector<Points>& faceDisplacement, const Progress& progress) {
    if (auto ok = checkInput(input); !ok) return tl::make_unexpected(ok.error());
    if (faceDisplacement.size() != input.faces.size()) return fail("bad-value", "Give the displacements of every joint face.");
    for (std::size_t f = 0; f < input.faces.size(); ++f)
        if (faceDisplacement[f].rows() != static_cast<Eigen::Index>(input.faces[f].vertices.size()))
            return fail("bad-value", "The displacements of a joint face do not match its vertices.");
    auto element = trimmed(input, progress.part(0.0, 0.02));
    if (!element) return tl::make_unexpected(element.error());
    auto solved = solvedBody(element->input.mesh->body, element->input.faces, input.solverMesh, progress.part(0.02, 0.1));
    if (!solved) return tl::make_unexpected(solved.error());
    Points out = Points::Zero(input.mesh->body.vertices.rows(), 3), prescribed = Points::Zero(element->input.mesh->body.vertices.rows(), 3);
    for (std::size_t f = 0; f < input.faces.size(); ++f)
        for (std::size_t i = 0; i < input.faces[f].vertices.size(); ++i) {
            const auto u = faceDisplacement[f].row(static_cast<Eigen::Index>(i));
            out.row(input.faces[f].vertices[i]) = u;
            prescribed.row(element->input.faces[f].vertices[i]) = u;
        }
    auto level = solveLevel(*element, *solved, heldDisplacement(*solved, prescribed), {}, progress.part(0.1, 1.0));
    if (!level) return tl::make_unexpected(level.error());
    for (std::size_t i = 0; i < element->wholeFree.size(); ++i)
        out.row(element->wholeFree[i]) = level->response.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0).transpose();
    return out;
}

}  // namespace imomushi
