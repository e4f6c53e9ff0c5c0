// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fstream>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh/topology.h"
#include "core/reduction/element_response.h"
#include "core/warp/bend_warp.h"

/// Elements whose faces are moved by hand, for tests and benchmarks of the bend warp.
namespace imomushi::warped {

inline std::shared_ptr<ElementMesh> readObj(const std::string& path) {
    auto mesh = std::make_shared<ElementMesh>();
    std::vector<double> points;
    std::vector<std::int32_t> corners;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream in(line);
        std::string key;
        in >> key;
        if (key == "v")
            for (double x = 0; points.size() % 3 != 3 && in >> x;) points.push_back(x);
        if (key == "f")
            for (std::string corner; in >> corner;) corners.push_back(std::stoi(corner) - 1);
    }
    mesh->body.vertices = Eigen::Map<const Points>(points.data(), static_cast<Eigen::Index>(points.size() / 3), 3);
    mesh->body.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
    return mesh;
}

/// An element between the planes at the two ends of axis 0 (x) or 2 (z), or with the faces given.
struct Element {
    ResponseInput input;
    std::shared_ptr<const ElementResponse> response;
    std::vector<std::int32_t> blocks;
    std::unique_ptr<BendWarp> warp;
    std::vector<float> local;

    Element(const ResponseInput& in) : Element(in, buildResponse(in, {}).value()) {}
    Element(ResponseInput in, ElementResponse solved) : input(std::move(in)), response(std::make_shared<const ElementResponse>(std::move(solved))) {
        for (const auto v : response->freeVertices)
            if (blocks.empty() || v >= blocks.back() + BendWarp::kBlock) blocks.push_back(v);
        local.assign(3 * BendWarp::kBlock * blocks.size(), 0.0f);
        warp = std::make_unique<BendWarp>(BendWarp::build(body(), input.faces, *response, input.nu, blocks, Vec3::Zero(), {}).value());
    }
    [[nodiscard]] const TriangleMesh& body() const { return input.mesh->body; }

    [[nodiscard]] Points heldPlaces(const std::vector<FaceMotion>& motions) const {
        Points out(static_cast<Eigen::Index>(warp->heldVertices().size()), 3);
        Eigen::Index row = 0;
        for (std::size_t f = 0; f < motions.size(); ++f)
            for (const auto v : input.faces[f].vertices)
                out.row(row++) = (motions[f].linear * body().vertices.row(v).transpose() + motions[f].shift).transpose();
        return out;
    }
    /// All vertices by the warp.
    Points bend(const std::vector<FaceMotion>& motions, const Eigen::VectorXd& warping, const Points& held) {
        warp->evaluate(motions, warping, held, local.data());
        Points out = body().vertices;
        std::size_t k = 0;
        for (const auto v : response->freeVertices) {
            while (blocks[k] + BendWarp::kBlock <= v) ++k;
            for (int axis = 0; axis < 3; ++axis)
                out(v, axis) = static_cast<double>(local[(3 * k + axis) * BendWarp::kBlock + (v - blocks[k])]);
        }
        for (std::size_t i = 0; i < warp->heldVertices().size(); ++i)
            out.row(warp->heldVertices()[i]) = held.row(static_cast<Eigen::Index>(i));
        return out;
    }
    Points bend(const std::vector<FaceMotion>& motions) {
        return bend(motions, Eigen::VectorXd::Zero(response->columns()), heldPlaces(motions));
    }

    /// All vertices by A' v, with the true positions of the faces.
    [[nodiscard]] Points linear(const std::vector<FaceMotion>& motions) const {
        Eigen::VectorXd v = Eigen::VectorXd::Zero(response->columns());
        for (std::size_t f = 0; f < motions.size(); ++f) {
            const auto& frame = input.faces[f].frame;
            JointMap map;
            map.linear = frame.axes.transpose() * motions[f].linear * frame.axes;
            map.shift = frame.axes.transpose() * (motions[f].linear * frame.origin + motions[f].shift - frame.origin);
            double lost = 0.0;
            response->bases[f].coefficients(map, localVertices(body(), input.faces[f]), input.faces[f].size,
                                            v.data() + response->firstColumn[f], lost);
        }
        const Eigen::VectorXd u = response->response * v;
        Points out = body().vertices;
        for (std::size_t i = 0; i < response->freeVertices.size(); ++i)
            out.row(response->freeVertices[i]) += u.segment<3>(3 * static_cast<Eigen::Index>(i)).transpose();
        const Points held = heldPlaces(motions);
        for (std::size_t i = 0; i < warp->heldVertices().size(); ++i)
            out.row(warp->heldVertices()[i]) = held.row(static_cast<Eigen::Index>(i));
        return out;
    }
};

/// Turns a face by a rotation vector about its origin, after stretching it, and shifts it.
inline FaceMotion motion(const JointFace& face, const Vec3& turn, const Vec3& shift,
                         const Eigen::Matrix3d& stretch = Eigen::Matrix3d::Identity()) {
    const double angle = turn.norm();
    FaceMotion m;
    if (angle > 0.0) m.rotation = Eigen::Quaterniond(std::cos(angle / 2), 0, 0, 0), m.rotation.vec() = std::sin(angle / 2) / angle * turn;
    m.linear = m.rotation.toRotationMatrix() * stretch;
    m.shift = face.frame.origin + shift - m.linear * face.frame.origin;
    return m;
}

inline ResponseInput between(std::shared_ptr<ElementMesh> mesh, int axis, double nu,
                             const SolverMeshSetting& solver = {SolverMeshSetting::Kind::AsIs, 0}) {
    ResponseInput in;
    const auto& x = mesh->body.vertices;
    const double low = x.col(axis).minCoeff(), high = x.col(axis).maxCoeff();
    for (const double end : {low, high}) {
        std::vector<std::int32_t> vertices;
        for (Eigen::Index v = 0; v < x.rows(); ++v)
            if (std::abs(x(v, axis) - end) < 1e-6 * (high - low)) vertices.push_back(static_cast<std::int32_t>(v));
        in.faces.push_back(jointFaceByVertices(mesh->body, vertices).value());
    }
    in.mesh = std::move(mesh);
    in.nu = nu;
    in.solverMesh = solver;
    return in;
}

/// 4 sqrt(3) area / sum of squared edges of a triangle.
inline double quality(const Points& x, const Triangles& triangles, Eigen::Index t) {
    const Vec3 a = x.row(triangles(t, 0)).transpose(), b = x.row(triangles(t, 1)).transpose(), c = x.row(triangles(t, 2)).transpose();
    return 2.0 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm());
}

/// The worst, relative to rest.
inline double worstQuality(const Points& rest, const Points& x, const Triangles& triangles) {
    double worst = 1.0;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) worst = std::min(worst, quality(x, triangles, t) / quality(rest, triangles, t));
    return worst;
}

}  // namespace imomushi::warped
