// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/character/character.h"
#include "tests/support/shapes.h"

/// Characters for tests and benchmarks: cylinders along z in a row.
namespace imomushi::caterpillar {

struct Shape {
    int elements = 5;
    double radius = 0.5, length = 1.0;  ///< of each element, m
    std::vector<int> around = {12};     ///< vertices per ring, element by element, repeating
    std::vector<int> along = {4};       ///< rows of cells, element by element, repeating
    bool tips = false;                  ///< faces at the two far ends, held by their bones
    BasisChoice basis;
    bool precomputed = true;
    bool mirrored = false;      ///< every second element is, so that faces that meet have the same triangles
    double dome = 0.0;          ///< everything is shifted along z by this times the squared distance from the axis, 1/m: faces are not flat
};

inline JointFace faceOf(const TriangleMesh& mesh, const shapes::Patch& patch, const std::string& name) {
    JointFace face = jointFaceByVertices(mesh, patch.vertices).value();
    face.name = name;
    return face;
}

inline void precompute(CharacterInput& input) {
    for (auto& element : input.elements) {
        ResponseInput in;
        in.mesh = element.mesh;
        in.faces = element.faces;
        in.nu = element.nu;
        in.basis = input.basis;
        in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};  // how a character moves does not depend on how well its elements are solved
        element.response = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
    }
}

/// Welds the vertices of faces 0 and 1 that are at the same place.
inline void weld(const CharacterInput& input, CharacterInput::Joint& joint) {
    const auto vertex = [&](int side, std::int32_t v) -> Vec3 {
        return input.elements[joint.faces[side].element].mesh->body.vertices.row(v).transpose();
    };
    const auto face = [&](int side) -> const JointFace& { return input.elements[joint.faces[side].element].faces[joint.faces[side].face]; };
    for (const auto a : face(0).vertices)
        for (const auto b : face(1).vertices)
            if ((vertex(0, a) - vertex(1, b)).norm() < 1e-6 * face(0).size) joint.welded.emplace_back(a, b);
}

inline CharacterInput make(const Shape& shape) {
    CharacterInput input;
    input.basis = shape.basis;
    const int n = shape.elements;
    for (int i = 0; i <= n; ++i) input.skeleton.points.emplace_back(0, 0, i * shape.length);
    for (int i = 0; i < n; ++i) {
        input.skeleton.bones.push_back({i, i + 1, i - 1, shape.length});
        auto body = shapes::moved(shapes::cylinder(shape.radius, shape.length, shape.around[i % shape.around.size()],
                                                   shape.along[i % shape.along.size()]),
                                  Eigen::Matrix3d::Identity(), Vec3(0, 0, i * shape.length));
        if (shape.mirrored && i % 2 == 1) {
            body.mesh.vertices.col(2) = ((2 * i + 1) * shape.length - body.mesh.vertices.col(2).array()).matrix().eval();
            body.mesh.triangles.col(1).swap(body.mesh.triangles.col(2));
            std::swap(body.ends[0], body.ends[1]);
        }
        body.mesh.vertices.col(2) += shape.dome * body.mesh.vertices.leftCols<2>().rowwise().squaredNorm();
        CharacterInput::Element element;
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body = body.mesh;
        element.mesh = mesh;
        element.bones = {i};
        if (i > 0 || shape.tips) element.faces.push_back(faceOf(body.mesh, body.ends[0], "low"));
        if (i + 1 < n || shape.tips) element.faces.push_back(faceOf(body.mesh, body.ends[1], "high"));
        element.leadsJointPlanes = n > 2 && element.faces.size() == 1;
        input.elements.push_back(element);
    }
    for (int i = 0; i + 1 < n; ++i) {
        CharacterInput::Joint joint;
        joint.point = i + 1;
        joint.faces = {{i, static_cast<int>(input.elements[i].faces.size()) - 1, i}, {i + 1, 0, i + 1}};
        weld(input, joint);
        input.joints.push_back(joint);
    }
    if (shape.tips) {
        input.joints.push_back({0, {{0, 0, 0}}, {}});
        input.joints.push_back({n, {{n - 1, 1, n - 1}}, {}});
    }
    if (shape.precomputed) precompute(input);
    return input;
}

}  // namespace imomushi::caterpillar
