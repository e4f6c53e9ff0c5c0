// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/synthetic_response.h"

#include <cmath>

#include "core/effects/body_loads_job.h"

namespace imomushi {

std::shared_ptr<const ElementResponse> syntheticResponse(const ElementMesh& mesh, const std::vector<JointFace>& faces, const BasisChoice& basis, bool loads) {
    auto out = std::make_shared<ElementResponse>();
    const Points& rest = mesh.body.vertices;
    std::vector<char> held(static_cast<std::size_t>(rest.rows()), 0);
    out->firstColumn = {0};
    for (const JointFace& face : faces) {
        for (const auto v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
        out->bases.push_back(FaceBasis::on(mesh.body, face, basis));
        out->firstColumn.push_back(out->firstColumn.back() + out->bases.back().columns());
    }
    for (std::size_t v = 0; v < held.size(); ++v)
        if (!held[v]) out->freeVertices.push_back(static_cast<std::int32_t>(v));
    const Eigen::Index columns = out->columns(), count = static_cast<Eigen::Index>(out->freeVertices.size());
    out->response = Eigen::MatrixXd::Zero(3 * count, columns);
    out->stiffness = Eigen::MatrixXd::Identity(columns, columns);
    if (basis == BasisKind::Full) out->tractions = Eigen::MatrixXd::Identity(columns, columns);
    if (loads) {
        out->loads = Eigen::MatrixXd::Constant(3 * count, ElementResponse::kLoads, 1e-3);
        for (Eigen::Index i = 0; i < count; ++i) out->loads.middleRows<3>(3 * i) *= std::sin(static_cast<double>(i));
        out->loadForces = Eigen::MatrixXd::Zero(columns, ElementResponse::kLoads);
    }
    for (Eigen::Index i = 0; i < count; ++i) {
        const Vec3 x = rest.row(out->freeVertices[static_cast<std::size_t>(i)]).transpose();
        std::vector<double> near;
        double all = 0.0;
        for (const JointFace& face : faces) {
            const double distance = std::abs(face.frame.toLocal(x).z()) / face.size + 1e-3;
            all += near.emplace_back(1.0 / (distance * distance));
        }
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const FaceBasis& b = out->bases[f];
            auto part = out->response.block(3 * i, out->firstColumn[f], 3, b.columns());
            if (b.kind == BasisKind::Full)
                for (int k = 0; k < b.vertices; ++k) part.middleCols<3>(3 * k) = faces[f].frame.axes * (std::cos(static_cast<double>(i + k)) * near[f] / all / b.vertices);
            else {
                // As in true responses: rigid motions of all faces are those of the element, and other motions of all faces are not affine ones of it.
                const Vec3 p = faces[f].frame.toLocal(x);
                Eigen::Matrix<double, 3, Eigen::Dynamic> modes = b.at(p);
                modes(0, 3) -= p.z();
                modes(1, 4) -= p.z();
                const double share = near[f] / all;
                modes.leftCols<3>() *= share;
                part = share * (faces[f].frame.axes * modes);
            }
        }
    }
    return out;
}

CharacterInput withSyntheticResponses(CharacterInput input) {
    const auto* gravity = input.effects.find<GravityEffect>();
    const auto* inflate = input.effects.find<InflateEffect>();
    for (std::size_t i = 0; i < input.elements.size(); ++i) {
        auto& e = input.elements[i];
        const bool loads = (gravity && gravity->on(i)) || (inflate && inflate->on(i));
        e.response = e.faces.empty() ? nullptr : syntheticResponse(*e.mesh, e.faces, input.basis, loads);
    }
    return input;
}

}  // namespace imomushi
