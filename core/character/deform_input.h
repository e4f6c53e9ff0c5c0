// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/character/vertex_kernels.h"

namespace imomushi {

/// Data to deform the surfaces outside of Character::update(), for example on a graphics card:
/// constant tables, and per element the numbers of the frame, about as many as joint parameters. Pointers are into the character, and valid as long as it.
///
/// Free vertices:  x = placement(shape(rest) + sum over modes of weight * response)      (VertexBlocks; m, world)
///                 with a joint part  + (linear part of joints[face] - linear part of placement) offset
/// Held vertices:  x = joints[place](rest) + sum over shapes of warping[place] * shape
/// Vertices of a render mesh are those of elements: of their bodies, and points embedded in them (EmbeddedTables).
/// Normals:        of stencils from those positions; on seams the direction of own + across, see Seam; hidden ones are those of their face.
struct DeformInput {
    struct Held {
        std::int32_t vertex = 0;
        int place = 0;                                   ///< a face of the element, or behind all of these an attached part
        Eigen::Vector3f rest = Eigen::Vector3f::Zero();  ///< m, from the rest place of its joint, or the pivot of its part
    };
    /// Of a free vertex: see EmbeddedMapping::JointPart.
    struct JointPart {
        std::int32_t vertex = 0;
        int face = 0;
        Eigen::Vector3f offset = Eigen::Vector3f::Zero();  ///< m
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
        std::vector<AffineFloat> joints;          ///< per place
        std::vector<float> warping;               ///< per place, per axis, per shape; world, without unit
        std::vector<Eigen::Vector3f> faceNormals; ///< per face: unit, world, of hidden vertices
    };
    struct Element {
        bool possible = false;                ///< Character::deformExternally() is not refused
        bool external = false;                ///< true: deformed outside in this frame; false: `positions` are up to date, under a render mesh only the vertices that it needs, until surface() is called
        const float* positions = nullptr;     ///< #vertices x 3, m, world
        int vertices = 0;                     ///< of the body, then a gap and embedded points where it has them
        int bodyVertices = 0, faces = 0;
        int places = 0;                       ///< faces, then attached parts
        float scale = 1.0f;                   ///< of normals, see findNormals()
        VertexBlocks blocks;
        std::vector<std::int32_t> free;       ///< ascending
        std::vector<JointPart> jointParts;    ///< ascending by vertex, at most one each
        std::vector<Held> held;               ///< together with `free` every vertex once, but for the gap
        Eigen::MatrixXf shapes;               ///< #shapes x #held, m
        std::vector<Hidden> hidden;
        const NormalStencil* stencils = nullptr;  ///< per body vertex
        Frame frame;
    };
    /// A render mesh. Where one of its elements is external, its surface is to be made by who deforms these.
    struct Mesh {
        struct Vertex {
            std::int32_t element = 0, vertex = 0;
        };
        std::vector<Vertex> vertices;
        std::vector<std::int32_t> elements;       ///< that it has vertices of, ascending
        const NormalStencil* stencils = nullptr;  ///< per vertex, of vertices of the mesh
        float scale = 1.0f;
    };
    /// In this frame.
    [[nodiscard]] bool external(const Mesh& mesh) const {
        return std::any_of(mesh.elements.begin(), mesh.elements.end(), [this](std::int32_t e) { return elements[static_cast<std::size_t>(e)].external; });
    }
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
    std::vector<Mesh> meshes;                     ///< per render mesh
    std::vector<Seam> seams;
};

}  // namespace imomushi
