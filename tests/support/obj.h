// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// The positions and triangles of one of our own OBJ files, as they are. Throws std::runtime_error with its name.
inline TriangleMesh readObj(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path + " cannot be read.");
    std::vector<double> points;
    std::vector<std::int32_t> corners;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string key;
        words >> key;
        if (key == "v")
            for (double x; words >> x;) points.push_back(x);
        if (key == "f")
            for (std::string corner; words >> corner;) corners.push_back(std::stoi(corner) - 1);
    }
    TriangleMesh mesh;
    mesh.vertices = Eigen::Map<const Points>(points.data(), static_cast<Eigen::Index>(points.size() / 3), 3);
    mesh.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
    return mesh;
}

}  // namespace imomushi
