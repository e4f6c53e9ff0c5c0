// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace imomushi::samples {

/// A textured triangle mesh as glTF holds it.
struct RenderMesh {
    std::vector<Eigen::Vector3f> positions, normals;
    std::vector<Eigen::Vector2f> texCoords;
    std::vector<std::array<int, 3>> triangles;
    std::vector<unsigned char> png;
};

void writeGlb(const RenderMesh& mesh, const std::string& name, const std::filesystem::path& path);

}  // namespace imomushi::samples
