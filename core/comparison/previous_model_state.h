// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/character/aligned_buffer.h"
#include "core/character/normal_stencils.h"
#include "core/comparison/previous_model.h"
#include "core/dynamics/explicit_joint_dynamics.h"

namespace imomushi {

using Eigen::Matrix3d;

/// A Character whose elements are rigid places the joint faces as bones want them: it gives the target of each joint-face vertex. What a vertex does beyond its target is
/// its offset, in the axes of the joint as bones carry it; welded vertices share one. Target plus offset is the displacement that the matrix of each element is
/// multiplied with.
struct PreviousModel::State {
    struct Node {  // a joint-face vertex, or welded ones of both faces
        Vec3 rest = Vec3::Zero();
        double area = 0.0;
    };
    struct Joint {
        int element = 0;  // of its first face
        std::vector<Node> nodes;
        std::vector<std::int32_t> vertices;  // of the first face, as its first nodes
        Vec3 middle = Vec3::Zero();          // of these, at rest
        Matrix3d axes = Matrix3d::Identity();  // rest to world, as bones carry the joint: offsets are in these
        Eigen::VectorXd force;              // of the tractions on offsets
        Eigen::MatrixXd held;               // 3 #nodes x 6, orthonormal with areas as weights
        std::vector<ExplicitJointDynamics> dynamics;  // one
    };
    struct FaceVertex {
        std::int32_t vertex = 0;
        int joint = 0, node = 0;
        double area = 0.0;
        Matrix3d axes = Matrix3d::Identity();  // of its face: those of the columns of the response
    };
    struct Element {
        std::vector<FaceVertex> held;  // in the order of columns
        std::vector<std::int32_t> free;
        Points rest;
        double scale = 1.0;
        Eigen::MatrixXf matrix;        // (3 #free + 3 #held) x 3 #held, all in the rest axes of the element
        Eigen::VectorXf x, y;
        std::vector<NormalStencil> stencils;
        AlignedBuffer<float> positions, normals;
        double stiffness = 1.0;
    };

    explicit State(Character given) : carrier(std::move(given)) {}

    Character carrier;
    std::vector<std::shared_ptr<const ElementResponse>> responses;
    std::vector<Joint> joints;
    std::vector<Element> elements;
    double overhead = 0.0;

    void prepare(const CharacterInput& input);
    void orient();
    Result<void> weigh();
    [[nodiscard]] double fastest();
    void feed(std::size_t e, const Eigen::Isometry3d& frame, const float* targets);
    void pull(std::size_t e, const Eigen::Isometry3d& frame);
    void place(std::size_t e, const Eigen::Isometry3d& frame);
};

}  // namespace imomushi
