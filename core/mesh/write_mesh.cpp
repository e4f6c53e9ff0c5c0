// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/write_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <string>

#include "core/base/atomic_file.h"
#include "core/base/finite.h"

namespace imomushi {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written as the machine's own bytes");

template <class T>
void number(std::string& out, T value) {
    char text[32];
    out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

template <class T>
void raw(std::string& out, T value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    out.append(bytes.data(), bytes.size());
}

std::string obj(const Points& vertices, const Triangles& triangles) {
    std::string out;
    out.reserve(static_cast<std::size_t>(vertices.rows()) * 60 + static_cast<std::size_t>(triangles.rows()) * 20);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        out += 'v';
        for (int k = 0; k < 3; ++k) out += ' ', number(out, vertices(v, k));
        out += '\n';
    }
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        out += 'f';
        for (int k = 0; k < 3; ++k) out += ' ', number(out, triangles(f, k) + 1);
        out += '\n';
    }
    return out;
}

std::string ply(const Points& vertices, const Triangles& triangles) {
    std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex ";
    number(out, vertices.rows());
    out += "\nproperty double x\nproperty double y\nproperty double z\nelement face ";
    number(out, triangles.rows());
    out += "\nproperty list uchar int vertex_indices\nend_header\n";
    for (Eigen::Index v = 0; v < vertices.rows(); ++v)
        for (int k = 0; k < 3; ++k) raw(out, vertices(v, k));
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        out += '\3';
        for (int k = 0; k < 3; ++k) raw(out, triangles(f, k));
    }
    return out;
}

}  // namespace

Result<void> writeMesh(const std::filesystem::path& path, const Points& vertices, const Triangles& triangles) {
    if (!allFinite(vertices))
        return fail("bad-value", "A vertex has a coordinate that is not finite, so '" + path.string() + "' was not written.");
    if (triangles.rows() > 0 && (triangles.minCoeff() < 0 || triangles.maxCoeff() >= vertices.rows()))
        return fail("bad-index", "A triangle refers to a vertex that does not exist, so '" + path.string() + "' was not written.");
    std::string suffix = path.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (suffix == ".obj") return writeFileAtomically(path, obj(vertices, triangles));
    if (suffix == ".ply") return writeFileAtomically(path, ply(vertices, triangles));
    return fail("unknown-format", "Meshes are written as .obj or .ply, and '" + path.string() + "' ends otherwise: choose one of these.");
}

}  // namespace imomushi
