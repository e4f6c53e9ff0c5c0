// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/congruence.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/base/decompositions.h"

namespace imomushi {
namespace {

/// Seconds per entry of A': measured 4e-9 within the caches, 1.6e-8 beyond them.
constexpr double kSecondsPerEntry = 1e-8;

/// All but coordinates: none where they differ, true where the triangles are turned round.
std::optional<bool> turnedRound(const ResponseInput& a, const ResponseInput& b) {
    if (!a.mesh || !b.mesh || a.faces.empty() || a.faces.size() != b.faces.size()) return std::nullopt;
    if (a.nu != b.nu || a.basis != b.basis || a.loads != b.loads || a.touch != b.touch || !(a.solverMesh == b.solverMesh)) return std::nullopt;
    const TriangleMesh &x = a.mesh->body, &y = b.mesh->body;
    if (x.vertices.rows() != y.vertices.rows() || x.triangles.rows() != y.triangles.rows()) return std::nullopt;
    for (std::size_t f = 0; f < a.faces.size(); ++f) {
        const JointFace &p = a.faces[f], &q = b.faces[f];
        if (p.flat() != q.flat() || p.vertices != q.vertices || p.triangles != q.triangles) return std::nullopt;
    }
    if (x.triangles == y.triangles) return false;
    if (x.triangles.col(0) == y.triangles.col(0) && x.triangles.col(1) == y.triangles.col(2) && x.triangles.col(2) == y.triangles.col(1)) return true;
    return std::nullopt;
}

/// 3 * #vertices x g_f: displacement of the vertices of a face per joint parameter, in world axes.
Eigen::MatrixXd modesOf(const ResponseInput& input, std::size_t f) {
    const JointFace& face = input.faces[f];
    const FaceBasis basis = FaceBasis::on(input.mesh->body, face, input.basis);
    Eigen::MatrixXd C(3 * static_cast<Eigen::Index>(face.vertices.size()), basis.columns());
    for (std::size_t i = 0; i < face.vertices.size(); ++i) {
        const Vec3 p = input.mesh->body.vertices.row(face.vertices[i]).transpose();
        C.middleRows(3 * static_cast<Eigen::Index>(i), 3) = face.frame.axes * basis.at(face.frame.toLocal(p), static_cast<int>(i));
    }
    return C;
}

/// Turns or reflects the vectors in the rows 3 i ... 3 i + 2.
template <class Matrix>
void turn(const Eigen::Matrix3d& rotation, Matrix& vectors) {
    const Eigen::Matrix<typename Matrix::Scalar, 3, 3> R = rotation.cast<typename Matrix::Scalar>();
    for (Eigen::Index row = 0; row < vectors.rows(); row += 3) vectors.template middleRows<3>(row) = (R * vectors.template middleRows<3>(row)).eval();
}

/// The same in the columns.
template <class Matrix>
void turnColumns(const Eigen::Matrix3d& rotation, Matrix& vectors) {
    const Eigen::Matrix<typename Matrix::Scalar, 3, 3> R = rotation.cast<typename Matrix::Scalar>();
    for (Eigen::Index column = 0; column < vectors.cols(); column += 3)
        vectors.template middleCols<3>(column) = (vectors.template middleCols<3>(column) * R.transpose()).eval();
}

}  // namespace

std::optional<Congruence> findCongruence(const ResponseInput& from, const ResponseInput& to) {
    const std::optional<bool> mirrored = turnedRound(from, to);
    if (!mirrored) return std::nullopt;
    const Points &x = from.mesh->body.vertices, &y = to.mesh->body.vertices;
    const Eigen::RowVector3d size = x.colwise().maxCoeff() - x.colwise().minCoeff();
    const double diagonal = size.norm();
    if (!(diagonal > 0.0)) return std::nullopt;
    // Relative to the middles and the size: no digits are lost far from the origin, no square leaves the range.
    const Eigen::RowVector3d middleX = x.colwise().mean(), middleY = y.colwise().mean();
    const Points p = (x.rowwise() - middleX) / diagonal, q = (y.rowwise() - middleY) / diagonal;
    // The rotation (or reflection) that brings p nearest to q in the mean square (Kabsch 1976; Umeyama 1991 on mirrors).
    auto [u, v, values] = singularValuesOf(q.transpose() * p);
    if (((u * v.transpose()).determinant() < 0.0) != *mirrored) u.col(2) = -u.col(2);
    Congruence out;
    out.mirrored = *mirrored;
    out.rotation = u * v.transpose();
    out.miss = (p * out.rotation.transpose() - q).rowwise().norm().maxCoeff();
    if (!(out.miss <= Congruence::kMiss)) return std::nullopt;
    out.shift = middleY.transpose() - out.rotation * middleX.transpose();

    for (std::size_t f = 0; f < from.faces.size(); ++f) {
        out.bases.push_back(FaceBasis::on(to.mesh->body, to.faces[f], to.basis));
        if (from.basis == BasisKind::Full) {
            // Each vertex by itself, exactly.
            const Eigen::Matrix3d turned = from.faces[f].frame.axes.transpose() * out.rotation.transpose() * to.faces[f].frame.axes;
            const auto count = static_cast<Eigen::Index>(from.faces[f].vertices.size());
            Eigen::MatrixXd N = Eigen::MatrixXd::Zero(3 * count, 3 * count);
            for (Eigen::Index i = 0; i < count; ++i) N.block<3, 3>(3 * i, 3 * i) = turned;
            out.columns.push_back(std::move(N));
            continue;
        }
        Eigen::MatrixXd C = modesOf(from, f), wanted = modesOf(to, f);
        turn(out.rotation.transpose(), wanted);
        const Eigen::VectorXd unit = C.colwise().norm().cwiseMax(1e-300).cwiseInverse();
        C = (C * unit.asDiagonal()).eval();
        Eigen::MatrixXd N = leastSquares(C, wanted);
        for (Eigen::Index c = 0; c < wanted.cols(); ++c) {
            const double whole = wanted.col(c).norm();
            if (whole > 0.0) out.modeMiss = std::max(out.modeMiss, (C * N.col(c) - wanted.col(c)).norm() / whole);
        }
        out.columns.push_back(unit.asDiagonal() * N);
    }
    if (!(out.modeMiss <= Congruence::kModeMiss)) return std::nullopt;
    return out;
}

Result<ElementResponse> Congruence::carry(const ElementResponse& from) const {
    const auto no = [] { return fail("bad-value", "The response to share is not one of a congruent element; precompute that one again."); };
    if (from.bases.size() != columns.size() || from.firstColumn.size() != columns.size() + 1) return no();
    for (std::size_t f = 0; f < columns.size(); ++f)
        if (columns[f].rows() != from.bases[f].columns()) return no();
    ElementResponse out = from;
    out.bases = bases;
    for (std::size_t f = 0; f < columns.size(); ++f) {
        const Eigen::Index first = from.firstColumn[f], count = columns[f].cols();
        out.response.middleCols(first, count) = from.response.middleCols(first, count) * columns[f];
        out.stiffness.middleCols(first, count) = from.stiffness.middleCols(first, count) * columns[f];
        if (from.tractions.size() > 0) out.tractions.middleCols(first, count) = from.tractions.middleCols(first, count) * columns[f];
    }
    turn(rotation, out.response);
    turn(rotation, out.tractions);
    if (from.loads.size() > 0) {
        turn(rotation, out.loads);
        out.loads.leftCols<3>() = (out.loads.leftCols<3>() * rotation.transpose()).eval();
        out.loadForces.leftCols<3>() = (from.loadForces.leftCols<3>() * rotation.transpose()).eval();
        const Eigen::MatrixXd forces = out.loadForces;
        for (std::size_t f = 0; f < columns.size(); ++f)
            out.loadForces.middleRows(from.firstColumn[f], columns[f].cols()) = columns[f].transpose() * forces.middleRows(from.firstColumn[f], columns[f].rows());
    }
    if (from.touch.columns() > 0) {
        turn(rotation, out.touch.displacement);
        turnColumns(rotation, out.touch.displacement);
        turn(rotation, out.touch.compliance);
        turnColumns(rotation, out.touch.compliance);
        out.touch.compliance = (0.5 * (out.touch.compliance + out.touch.compliance.transpose())).eval();
        turnColumns(rotation, out.touch.gradients);
        for (Eigen::Index i = 0; i < out.touch.gradients.rows(); i += 9)
            for (Eigen::Index c = 0; c < out.touch.gradients.cols(); ++c) {
                Eigen::Matrix<float, 3, 3, Eigen::RowMajor> gradient(out.touch.gradients.data() + c * out.touch.gradients.rows() + i);
                const Eigen::Matrix3f R = rotation.cast<float>();
                gradient = (R * gradient * R.transpose()).eval();
                out.touch.gradients.block<9, 1>(i, c) = gradient.reshaped<Eigen::RowMajor>();
            }
        Eigen::MatrixXd forces = from.touch.forces;
        turnColumns(rotation, forces);
        for (std::size_t f = 0; f < columns.size(); ++f)
            out.touch.forces.middleRows(from.firstColumn[f], columns[f].cols()) = columns[f].transpose() * forces.middleRows(from.firstColumn[f], columns[f].rows());
    }
    const Eigen::MatrixXd half = out.stiffness;
    for (std::size_t f = 0; f < columns.size(); ++f) {
        const Eigen::Index first = from.firstColumn[f], count = columns[f].cols();
        out.stiffness.middleRows(first, count) = columns[f].transpose() * half.middleRows(first, count);
    }
    out.stiffness = (0.5 * (out.stiffness + out.stiffness.transpose())).eval();
    return out;
}

ResponseEstimate carryEstimate(const ResponseEstimate& solved, const ResponseInput& to) {
    ResponseEstimate out = solved;
    const double entries = 3.0 * static_cast<double>(to.mesh->body.vertices.rows()) * (solved.columns + 3 * to.touch);
    out.seconds = kSecondsPerEntry * entries;
    out.bytes = static_cast<std::size_t>(2.0 * sizeof(double) * entries);
    return out;
}

}  // namespace imomushi
