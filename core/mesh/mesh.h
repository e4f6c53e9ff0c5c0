// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/triangle_mesh.h"
#include "core/base/vec3.h"

namespace imomushi {

/// A picture that came in with a mesh, as its encoded bytes (PNG, JPEG, ...).
struct Texture {
    std::string name;
    std::string mimeType;
    std::vector<std::uint8_t> bytes;
};

/// How a part of a surface is shaded (metallic-roughness, as in glTF). Colours are linear RGBA, 0...1.
struct Material {
    std::string name;
    Eigen::Vector4f baseColor = Eigen::Vector4f(0.8f, 0.8f, 0.8f, 1.0f);
    float metallic = 0.0f;
    float roughness = 0.6f;
    int baseColorTexture = -1;  ///< into RenderMesh::textures, -1: none
};

/// What the artist sees of a body: its render vertices, which are body vertices split where normals, texture coordinates or colours
/// jump. Optional attributes have zero rows where the file had none.
struct RenderMesh {
    std::vector<std::int32_t> bodyVertex;  ///< #R: the body vertex of each render vertex
    Triangles triangles;                   ///< #F x 3 render vertices; triangle f is body triangle f
    Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> normals;   ///< #R x 3 or 0 x 3; empty: smooth normals of the body
    Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor> texCoords;  ///< #R x 2 or 0 x 2; origin top left (glTF)
    Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor> colors;     ///< #R x 4 or 0 x 4, linear RGBA
    std::vector<std::int32_t> material;    ///< #F into materials, or empty: no material
    std::vector<Material> materials;
    std::vector<Texture> textures;
};

class MeshConnectivity;

/// Of ElementMesh alone: a place for the connectivity of its body. A copy begins empty, since the copy may be changed.
struct KeptConnectivity {
    KeptConnectivity() = default;
    KeptConnectivity(const KeptConnectivity&) noexcept {}
    KeptConnectivity& operator=(const KeptConnectivity&) noexcept {
        kept.store(nullptr);
        return *this;
    }
    std::atomic<std::shared_ptr<const MeshConnectivity>> kept;
};

/// One body with its render mesh: what an element is made of. Body vertices keep the order of the file (a weld keeps the lowest index).
struct ElementMesh {
    TriangleMesh body;  ///< closed and outward-oriented in every element of a document
    RenderMesh renderMesh;

    /// Edges, corners, normals and facts of the body, made when first asked for and kept with this object (mesh/connectivity.h). Any thread may ask; afterwards the
    /// body must not change.
    [[nodiscard]] const MeshConnectivity& connectivity() const;
    mutable KeptConnectivity connectivity_ = {};  ///< use connectivity()
};

}  // namespace imomushi
