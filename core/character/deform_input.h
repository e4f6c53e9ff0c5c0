// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/character/vertex_kernels.h"

namespace imomushi {

/// With what others than Character::update() deform the surfaces of a character, on a graphics card: what never changes, and per element
/// the numbers of the frame, of which there are as many as joint parameters. Pointers are into the character, and valid as long as it.
///
/// Free vertices:  x = placement(shape(rest) + sum over modes of weight * response)      (VertexBlocks; m, world)
/// Held vertices:  x = joints[face](rest) + sum over shapes of warping[face] * shape
/// Normals:        of stencils from those positions; on seams the direction of own + across, see Seam; hidden ones are those of their face.
struct DeformInput {
    struct Held {
        std::int32_t vertex = 0;
        int face = 0;
        Eigen::Vector3f rest = Eigen::Vector3f::Zero();  ///< m, from the rest place of its joint
    };
    /// All triangles around this vertex are inside a joint.
    struct Hidden {
        std::int32_t vertex = 0;
        int face = 0;
    };
    struct Frame {
        std::uint64_t revision = 0;               ///< changes when the positions do
        AffineFloat shape{}, placement{};
        std::vector<float> weights;               ///< per mode: m per unit of an entry of VertexBlocks::response
        std::vector<AffineFloat> joints;          ///< per face
        std::vector<float> warping;               ///< per face, per axis, per shape; world, without unit
        std::vector<Eigen::Vector3f> faceNormals; ///< per face: unit, world, of hidden vertices
    };
    struct Element {
        bool possible = false;                ///< Character::deformExternally() is not refused
        bool external = false;                ///< in this frame; else `positions` are up to date, once surface() was asked for where a render mesh is seen
        const float* positions = nullptr;     ///< #vertices x 3, m, world
        int vertices = 0, faces = 0;
        float scale = 1.0f;                   ///< of normals, see findNormals()
        VertexBlocks blocks;
        std::size_t blockCount = 0;
        const std::vector<std::int32_t>* free = nullptr;
        std::vector<Held> held;               ///< together with `free` every body vertex once
        Eigen::MatrixXf shapes;               ///< #shapes x #held, m
        std::vector<Hidden> hidden;
        const NormalStencil* stencils = nullptr;  ///< per vertex
        Frame frame;
    };
    /// The normal of a vertex on a seam: with n the stencil normals, n[vertex] + (1 - part) n[from] + part n[to], of unit length; n[vertex] alone where
    /// that is shorter than kNoSeamNormal.
    struct Seam {
        int element = 0, other = 0;
        std::int32_t vertex = 0, from = 0, to = 0;  ///< of element, other, other
        float part = 0.0f;
    };
    static constexpr float kNoSeamNormal = 1e-3f;

    std::uint64_t id = 0;  ///< of the character: no other one in this process has it
    std::vector<Element> elements;
    std::vector<Seam> seams;
};

}  // namespace imomushi
