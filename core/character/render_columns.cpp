// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/render_columns.h"

#include <array>
#include <vector>

#include "core/base/parallel.h"

namespace imomushi {

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

/// 3 #body vertices x weights.
MatrixXd bodyColumns(const ElementRuntime& runtime) {
    const auto& given = runtime.input;
    const Eigen::Index own = runtime.columns(), loads = static_cast<Eigen::Index>(given.tables.loads.size());
    MatrixXd out = MatrixXd::Zero(3 * static_cast<Eigen::Index>(runtime.vertices), own + loads);
    if (!given.response) return out;
    for (std::size_t i = 0; i < runtime.free.size(); ++i) {
        const Eigen::Index to = 3 * runtime.free[i], from = 3 * static_cast<Eigen::Index>(i);
        out.block(to, 0, 3, own) = given.response->response.middleRows<3>(from);
        for (Eigen::Index l = 0; l < loads; ++l) out.block<3, 1>(to, own + l) = given.response->loads.block<3, 1>(from, given.tables.loads[static_cast<std::size_t>(l)]);
    }
    forHeldVertices(given, [&](std::int32_t v, int column, const MatrixXd& block) { out.block(3 * v, column, 3, block.cols()) = block; });
    return out;
}

/// Per column of a face: the linear part of its motion, in the axes of the element. The normal of a flat face turns as its plane does.
std::vector<Matrix3d> linearParts(const JointFace& face, const FaceBasis& basis) {
    std::vector<Matrix3d> out;
    if (basis.kind == BasisKind::Full) return out;
    const MatrixXd middle = basis.at(Vec3::Zero());
    std::array<MatrixXd, 3> moved;
    for (std::size_t k = 0; k < 3; ++k) moved[k] = basis.at(Vec3::Unit(static_cast<Eigen::Index>(k))) - middle;
    for (Eigen::Index c = 0; c < basis.plainColumns(); ++c) {
        Matrix3d local;
        for (std::size_t k = 0; k < 3; ++k) local.col(static_cast<Eigen::Index>(k)) = moved[k].col(c);
        if (basis.flat) {
            local.col(2).setZero();
            if (c == 3 || c == 4) local(c - 3, 2) = -1.0;
        }
        out.emplace_back(face.frame.axes * local * face.frame.axes.transpose());
    }
    return out;
}

void addJointParts(const ElementRuntime& runtime, MatrixXd& out) {
    const auto& given = runtime.input;
    if (!given.response) return;
    std::vector<std::vector<Matrix3d>> linear;
    for (std::size_t f = 0; f < given.faces.size(); ++f) linear.push_back(linearParts(given.faces[f], given.response->bases[f]));
    for (const auto& part : runtime.embedded->mapping.jointParts()) {
        const auto face = static_cast<std::size_t>(part.face);
        const Eigen::Index row = 3 * runtime.embedded->rows[static_cast<std::size_t>(part.point)], first = given.response->firstColumn[face];
        for (std::size_t c = 0; c < linear[face].size(); ++c) out.block<3, 1>(row, first + static_cast<Eigen::Index>(c)) += linear[face][c] * part.offset;
    }
}

void placeAttached(const ElementRuntime& runtime, MatrixXd& out) {
    const auto& points = *runtime.input.embedded;
    const auto& tables = *runtime.embedded;
    for (std::size_t a = 0; a < points.attached.size(); ++a) {
        const auto frame = static_cast<Eigen::Index>(3 * tables.frameOf(a));
        for (Eigen::Index c = 0; c < out.cols(); ++c) {
            const Vec3 pivot = out.col(c).segment<3>(frame);
            Matrix3d gradient;
            for (Eigen::Index k = 0; k < 3; ++k) gradient.col(k) = (out.col(c).segment<3>(frame + 3 * (k + 1)) - pivot) / tables.reach;
            const Matrix3d turn = 0.5 * (gradient - gradient.transpose());
            for (const auto i : points.attached[a].points)
                out.col(c).segment<3>(3 * (static_cast<Eigen::Index>(tables.first) + i)) = pivot + turn * (points.rest.row(i).transpose() - points.attached[a].pivot);
        }
    }
}

}  // namespace

MatrixXd vertexColumns(const ElementRuntime& runtime) {
    const MatrixXd body = bodyColumns(runtime);
    if (!runtime.embedded) return body;
    const auto& tables = *runtime.embedded;
    MatrixXd out = MatrixXd::Zero(3 * static_cast<Eigen::Index>(tables.first + tables.count), body.cols());
    out.topRows(body.rows()) = body;
    const MatrixXd followed = tables.mapping.apply(body, hardwareThreads());
    for (std::size_t i = 0; i < tables.rows.size(); ++i) out.middleRows<3>(3 * tables.rows[i]) = followed.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    addJointParts(runtime, out);
    placeAttached(runtime, out);
    return out;
}

}  // namespace imomushi
