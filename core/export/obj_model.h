// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/render_model.h"

namespace imomushi {

/// Writes what is seen of a character as Wavefront OBJ: all vertices in the order of the file (shortest decimals that read back as the same doubles), then its triangles in their
/// order with parts as groups ("g", as objects would divide the vertices), materials, texture coordinates and normals. Those are as many as render vertices.
///   vertices  #vertices of the model x 3, m
///   normals   of vertices, x 3, or null: those of the file
///   materials a file of writeObjMaterials() that lies beside, or empty
/// Errors: "not-writable".
Result<void> writeObjModel(const std::filesystem::path& path, const RenderModel& model, const Points& vertices, const float* normals, const std::filesystem::path& materials);

/// The materials and textures of a model beside `path`, with its name: a.mtl, a_1.png. The files that were written, .mtl first; none: it has no materials. Errors: "not-writable".
Result<std::vector<std::filesystem::path>> writeObjMaterials(const std::filesystem::path& path, const RenderModel& model);

}  // namespace imomushi
