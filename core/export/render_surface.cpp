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
    const RenderMesh& render = mesh.renderMesh;
    const auto faces = mesh.body.triangles.rows();
    std::vector<char> covered(static_cast<std::size_t>(faces), 0), joined(static_cast<std::size_t>(mesh.body.vertices.rows()), 0);
    for (const auto& joint : input.joints)
        for (const auto& f : joint.faces)
            if (f.element == element && joint.faces.size() > 1) {
                for (const auto t : given.faces[static_cast<std::size_t>(f.face)].triangles) covered[static_cast<std::size_t>(t)] = 1;
                for (const auto v : given.faces[static_cast<std::size_t>(f.face)].vertices) joined[static_cast<std::size_t>(v)] = 1;
            }
    const bool hasRenderMesh = render.triangles.rows() == faces && !render.bodyVertex.empty();
    const auto count = static_cast<Eigen::Index>(render.bodyVertex.size());
    const bool hasNormals = hasRenderMesh && render.normals.rows() == count, hasTexCoords = hasRenderMesh && render.texCoords.rows() == count,
               hasColors = hasRenderMesh && render.colors.rows() == count, hasMaterials = hasRenderMesh && static_cast<Eigen::Index>(render.material.size()) == faces;

    RenderSurface out;
    std::vector<std::int32_t> from, known(static_cast<std::size_t>(hasRenderMesh ? count : mesh.body.vertices.rows()), -1);
    std::map<int, std::vector<std::uint32_t>> parts;
    for (Eigen::Index t = 0; t < faces; ++t) {
        if (covered[static_cast<std::size_t>(t)]) continue;
        auto& part = parts[hasMaterials ? render.material[static_cast<std::size_t>(t)] : hasRenderMesh && render.materials.size() == 1 ? 0 : -1];
        for (int c = 0; c < 3; ++c) {
            const std::int32_t v = hasRenderMesh ? render.triangles(t, c) : mesh.body.triangles(t, c);
            auto& number = known[static_cast<std::size_t>(v)];
            if (number < 0) {
                number = static_cast<std::int32_t>(from.size());
                from.push_back(v);
                out.body.push_back(hasRenderMesh ? render.bodyVertex[static_cast<std::size_t>(v)] : v);
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
            const Eigen::Vector3f own = render.normals.row(v).transpose();
            const bool seam = joined[static_cast<std::size_t>(b)] && own.dot(normal) > kSmooth * own.norm();
            if (!seam && own.norm() > 1e-6f) normal = own;
        }
        const float length = normal.norm();
        out.normals.row(i) = length > 1e-6f ? (normal / length).transpose() : Eigen::RowVector3f(0.0f, 1.0f, 0.0f);
        if (hasTexCoords) out.texCoords.row(i) = render.texCoords.row(v);
        if (hasColors) out.colors.row(i) = render.colors.row(v).cwiseMax(0.0f).cwiseMin(1.0f);
    }
    return out;
}

}  // namespace imomushi
