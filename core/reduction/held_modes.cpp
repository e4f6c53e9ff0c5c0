// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/held_modes.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <map>
#include <utility>

#include "core/mesh/topology.h"

namespace imomushi {

namespace {

/// A point of the surface as a combination of body vertices: (vertex, weight).
using Shares = std::vector<std::pair<std::int32_t, double>>;

/// Each held vertex of the solver mesh as a combination of body vertices, ascending. Empty for other vertices, and where decimation removed those around.
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

}  // namespace

HeldModes heldModes(const TriangleMesh& body, std::span<const JointFace> faces, const SolvedBody& solved, const std::vector<FaceBasis>& bases, const std::vector<int>& firstColumn) {
    Eigen::Index held = 0;
    for (const SolverMesh::Patch& face : solved.mesh.faces) held += static_cast<Eigen::Index>(face.vertices.size());
    HeldModes modes{Eigen::MatrixXd::Zero(3 * held, firstColumn.back()), Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(solved.inside.size()), firstColumn.back()), Eigen::MatrixXd::Zero(3 * held, 6)};
    for (std::size_t i = 0; i < solved.inside.size(); ++i) {
        const auto f = static_cast<std::size_t>(solved.inside[i].face);
        const FaceFrame& frame = faces[f].frame;
        modes.inside.block(3 * static_cast<Eigen::Index>(i), firstColumn[f], 3, bases[f].columns()) = frame.axes * bases[f].at(frame.toLocal(body.vertices.row(solved.inside[i].vertex).transpose()));
    }
    const Points& points = solved.mesh.mesh.vertices;
    const Vec3 low = points.colwise().minCoeff().transpose(), high = points.colwise().maxCoeff().transpose();
    modes.middle = 0.5 * (low + high);
    modes.size = (high - low).norm();
    const bool full = std::any_of(bases.begin(), bases.end(), [](const FaceBasis& basis) { return basis.kind == BasisKind::Full; });
    const std::vector<Shares> shares = full ? heldShares(solved) : std::vector<Shares>();
    Eigen::Index row = 0;
    for (std::size_t f = 0; f < bases.size(); ++f) {
        const FaceFrame& frame = solved.faces[f].frame;
        const std::vector<std::int32_t>& ofBody = faces[f].vertices;
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

}  // namespace imomushi
