// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/touch/touch_contact.h"
#include "tests/support/shapes.h"

/// Elements to touch, precomputed once per program.
namespace imomushi::touching {

struct Touched {
    TriangleMesh mesh;
    std::vector<JointFace> faces;
    std::shared_ptr<const ElementResponse> response;

    [[nodiscard]] double size() const { return (mesh.vertices.colwise().maxCoeff() - mesh.vertices.colwise().minCoeff()).norm(); }
    [[nodiscard]] TouchContact contact(const TouchSettings& settings = {}) const {
        return TouchContact::build(TouchSurface::build({mesh, {}}, faces, response).value(), settings).value();
    }
    [[nodiscard]] std::array<Vec3, 3> corners(std::int32_t triangle) const {
        std::array<Vec3, 3> out;
        for (int c = 0; c < 3; ++c) out[static_cast<std::size_t>(c)] = mesh.vertices.row(mesh.triangles(triangle, c)).transpose();
        return out;
    }
    /// #V x 3, by the forces of the contact.
    [[nodiscard]] Points displacement(const TouchContact& contact) const {
        const Eigen::VectorXd u = response->touch.displacement.cast<double>() * contact.patchForces();
        Points out = Points::Zero(mesh.vertices.rows(), 3);
        for (std::size_t i = 0; i < response->freeVertices.size(); ++i)
            out.row(response->freeVertices[i]) = u.segment<3>(3 * static_cast<Eigen::Index>(i)).transpose();
        return out;
    }
    [[nodiscard]] Vec3 at(const TouchContact::Point& p, const Points& vertices) const {
        Vec3 out = Vec3::Zero();
        for (int c = 0; c < 3; ++c) out += p.barycentric[c] * vertices.row(mesh.triangles(p.triangle, c)).transpose();
        return out;
    }
};

inline ResponseInput inputOf(const TriangleMesh& mesh, const std::vector<shapes::Patch>& held, int touch, double nu = 0.45,
                             SolverMeshSetting solver = {SolverMeshSetting::Kind::AsIs, 0}) {
    ResponseInput input;
    auto element = std::make_shared<ElementMesh>();
    element->body = mesh;
    input.mesh = element;
    for (std::size_t f = 0; f < held.size(); ++f) {
        input.faces.push_back(jointFaceByVertices(mesh, held[f].vertices).value());
        input.faces.back().name = "face " + std::to_string(f);
    }
    input.nu = nu;
    input.touch = touch;
    input.solverMesh = solver;
    return input;
}

inline Touched precompute(const ResponseInput& input) {
    return {input.mesh->body, input.faces, std::make_shared<const ElementResponse>(buildResponse(input, {}).value())};
}

/// A part of a caterpillar: a cylinder about z of radius 0.5 and length 1, held at both ends.
inline const Touched& segment() {
    static const Touched out = [] {
        const auto body = shapes::cylinder(0.5, 1.0, 24, 8);
        return precompute(inputOf(body.mesh, body.ends, 24));
    }();
    return out;
}

/// A sphere of radius 1 held where z < -0.85.
inline shapes::Body heldSphere(int levels) {
    auto body = shapes::sphere(1.0, levels);
    body.ends.push_back(shapes::patchWhere(body.mesh, [](const Vec3& p) { return p.z() < -0.85; }));
    return body;
}
inline const Touched& ball() {
    static const Touched out = [] {
        const auto body = heldSphere(3);
        return precompute(inputOf(body.mesh, body.ends, 32));
    }();
    return out;
}

/// A plate of 1 x 0.08 x 1.5, held at z = 0.
inline const Touched& fin() {
    static const Touched out = [] {
        auto body = shapes::box(Vec3(-0.5, -0.04, 0.0), Vec3(0.5, 0.04, 1.5), 10, 1, 15);
        body.ends.resize(1);
        return precompute(inputOf(body.mesh, body.ends, 32));
    }();
    return out;
}

/// A sphere of radius 1 with a concentric cavity of radius 0.6, held where z < -0.85.
inline const Touched& shell() {
    static const Touched out = [] {
        auto outer = heldSphere(3);
        const auto inner = shapes::inverted(shapes::sphere(0.6, 2));
        const auto n = static_cast<std::int32_t>(outer.mesh.vertices.rows());
        TriangleMesh mesh;
        mesh.vertices.resize(n + inner.mesh.vertices.rows(), 3);
        mesh.vertices << outer.mesh.vertices, inner.mesh.vertices;
        mesh.triangles.resize(outer.mesh.triangles.rows() + inner.mesh.triangles.rows(), 3);
        mesh.triangles << outer.mesh.triangles, (inner.mesh.triangles.array() + n).matrix();
        return precompute(inputOf(mesh, outer.ends, 32));
    }();
    return out;
}

inline std::vector<std::pair<std::string, const Touched*>> all() {
    return {{"segment", &segment()}, {"ball", &ball()}, {"fin", &fin()}, {"shell", &shell()}};
}

}  // namespace imomushi::touching
