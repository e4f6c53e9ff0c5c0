// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/export/motion.h"

namespace imomushi {

/// What has vertices of its own in a file, with attributes and materials of the imported one: the render mesh of an element without the triangles inside joints, or what one
/// material has of a part of a mesh of the scene.
struct RenderSurface {
    std::string name;
    int element = -1;                    ///< -1: of a part
    int mesh = -1;                       ///< of the scene
    int part = -1;                       ///< among those of all meshes; its surfaces follow each other
    std::vector<int> movers;             ///< elements that move vertices of the part, ascending
    const RenderMesh* look = nullptr;    ///< materials and textures
    std::string materialName;            ///< where there is none in the file; and
    Eigen::Vector3f color = Eigen::Vector3f::Ones();  ///< linear RGB
    std::vector<std::int32_t> elements;  ///< per vertex: the one that moves it
    std::vector<std::int32_t> rows;      ///< per vertex: which of those that go out of its element (Motion::Seen)
    std::vector<std::int32_t> seen;      ///< of a part, per vertex: its vertex of the mesh of the scene
    [[nodiscard]] std::size_t vertices() const { return rows.size(); }
    Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> normals;    ///< unit, at rest, smooth across joints
    Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor> texCoords;  ///< no rows: none
    Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor> colors;     ///< no rows: none
    struct Part {
        int material = -1;                     ///< of the render mesh, -1: none
        std::vector<std::uint32_t> triangles;  ///< three vertices each
    };
    std::vector<Part> parts;  ///< none is empty
};

/// `normals`: of body vertices in the positions that are written (Character::surface()), x 3.
RenderSurface renderSurface(const ExportScene& scene, int element, const float* normals);

/// The parts of a mesh of the scene in the order of the file, and within them materials as they first appear: as in a glTF file. Each has its vertices in the order of the
/// file, those that no triangle uses with the one before them. `first`: number of the first part. `normals`: of vertices of the mesh (Character::renderSurface()), for files without.
std::vector<RenderSurface> partSurfaces(const ExportScene& scene, const Motion& motion, int mesh, int first, const float* normals);

}  // namespace imomushi
