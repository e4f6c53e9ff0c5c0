// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/render_surface.h"

#include <algorithm>
#include <map>

namespace imomushi {

namespace {

// A normal of the file that differs from the smooth one by more than this marks a sharp edge of the artist: it is kept.
constexpr float kSmooth = 0.7f;  // cosine

}  // namespace

RenderSurface renderSurface(const CharacterInput& input, int element, const float* normals) {
    const auto& given = input.elements[static_cast<std::size_t>(element)];
    const ElementMesh& mesh = *given.mesh;
    const Look& look = mesh.look;
    const auto faces = mesh.body.triangles.rows();
    std::vector<char> covered(static_cast<std::size_t>(faces), 0), joined(static_cast<std::size_t>(mesh.body.vertices.rows()), 0);
    for (const auto& joint : input.joints)
        for (const auto& f : joint.faces)
            if (f.element == element && joint.faces.size() > 1) {
                for (const auto t : given.faces[static_cast<std::size_t>(f.face)].triangles) covered[static_cast<std::size_t>(t)] = 1;
                for (const auto v : given.faces[static_cast<std::size_t>(f.face)].vertices) joined[static_cast<std::size_t>(v)] = 1;
            }
    const bool hasLook = look.triangles.rows() == faces && !look.bodyVertex.empty();
    const auto count = static_cast<Eigen::Index>(look.bodyVertex.size());
    const bool hasNormals = hasLook && look.normals.rows() == count, hasTexCoords = hasLook && look.texCoords.rows() == count,
               hasColors = hasLook && look.colors.rows() == count, hasMaterials = hasLook && static_cast<Eigen::Index>(look.material.size()) == faces;

    RenderSurface out;
    std::vector<std::int32_t> from, known(static_cast<std::size_t>(hasLook ? count : mesh.body.vertices.rows()), -1);
    std::map<int, std::vector<std::uint32_t>> parts;
    for (Eigen::Index t = 0; t < faces; ++t) {
        if (covered[static_cast<std::size_t>(t)]) continue;
        auto& part = parts[hasMaterials ? look.material[static_cast<std::size_t>(t)] : hasLook && look.materials.size() == 1 ? 0 : -1];
        for (int c = 0; c < 3; ++c) {
            const std::int32_t v = hasLook ? look.triangles(t, c) : mesh.body.triangles(t, c);
            auto& number = known[static_cast<std::size_t>(v)];
            if (number < 0) {
                number = static_cast<std::int32_t>(from.size());
                from.push_back(v);
                out.body.push_back(hasLook ? look.bodyVertex[static_cast<std::size_t>(v)] : v);
            }
            part.push_back(static_cast<std::uint32_t>(number));
        }
    }
    for (auto& [material, triangles] : parts) out.parts.push_back({material, std::move(triangles)});
    const auto vertices = static_cast<Eigen::Index>(from.size());
    out.normals.resize(vertices, 3);
    if (hasTexCoords) out.texCoords.resize(vertices, 2);
    if (hasColors) out.colors.resize(vertices, 4);
    for (Eigen::Index i = 0; i < vertices; ++i) {
        const std::int32_t v = from[static_cast<std::size_t>(i)], b = out.body[static_cast<std::size_t>(i)];
        Eigen::Vector3f normal(normals[3 * b], normals[3 * b + 1], normals[3 * b + 2]);
        if (hasNormals) {
            const Eigen::Vector3f own = look.normals.row(v).transpose();
            const bool seam = joined[static_cast<std::size_t>(b)] && own.dot(normal) > kSmooth * own.norm();
            if (!seam && own.norm() > 1e-6f) normal = own;
        }
        const float length = normal.norm();
        out.normals.row(i) = length > 1e-6f ? (normal / length).transpose() : Eigen::RowVector3f(0.0f, 1.0f, 0.0f);
        if (hasTexCoords) out.texCoords.row(i) = look.texCoords.row(v);
        if (hasColors) out.colors.row(i) = look.colors.row(v).cwiseMax(0.0f).cwiseMin(1.0f);
    }
    return out;
}

}  // namespace imomushi
