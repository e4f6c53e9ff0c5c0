// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/render_surface.h"

#include <algorithm>
#include <map>
#include <set>

namespace imomushi {

namespace {

// A normal of the file that differs from the smooth one by more than this marks a sharp edge of the artist: it is kept.
constexpr float kSmooth = 0.7f;  // cosine

Eigen::RowVector3f unit(const Eigen::Vector3f& normal) {
    const float length = normal.norm();
    return length > 1e-6f ? Eigen::RowVector3f((normal / length).transpose()) : Eigen::RowVector3f(0.0f, 1.0f, 0.0f);
}

}  // namespace

RenderSurface renderSurface(const ExportScene& scene, int element, const float* normals) {
    const CharacterInput& input = scene.character;
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
    out.element = element;
    out.name = out.materialName = scene.elements[static_cast<std::size_t>(element)];
    out.look = &render;
    out.color = scene.colors[static_cast<std::size_t>(element)];
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
                out.rows.push_back(hasRenderMesh ? render.bodyVertex[static_cast<std::size_t>(v)] : v);
            }
            part.push_back(static_cast<std::uint32_t>(number));
        }
    }
    out.elements.assign(out.rows.size(), element);
    for (auto& [material, triangles] : parts) out.parts.push_back({material, std::move(triangles)});
    const auto vertices = static_cast<Eigen::Index>(from.size());
    out.normals.resize(vertices, 3);
    if (hasTexCoords) out.texCoords.resize(vertices, 2);
    if (hasColors) out.colors.resize(vertices, 4);
    for (Eigen::Index i = 0; i < vertices; ++i) {
        const std::int32_t v = from[static_cast<std::size_t>(i)], b = out.rows[static_cast<std::size_t>(i)];
        Eigen::Vector3f normal(normals[3 * b], normals[3 * b + 1], normals[3 * b + 2]);
        if (hasNormals) {
            const Eigen::Vector3f own = render.normals.row(v).transpose();
            const bool seam = joined[static_cast<std::size_t>(b)] && own.dot(normal) > kSmooth * own.norm();
            if (!seam && own.norm() > 1e-6f) normal = own;
        }
        out.normals.row(i) = unit(normal);
        if (hasTexCoords) out.texCoords.row(i) = render.texCoords.row(v);
        if (hasColors) out.colors.row(i) = render.colors.row(v).cwiseMax(0.0f).cwiseMin(1.0f);
    }
    return out;
}

std::vector<RenderSurface> partSurfaces(const ExportScene& scene, const Motion& motion, int mesh, int first, const float* normals) {
    const auto index = static_cast<std::size_t>(mesh);
    const RenderModel& model = *scene.meshes[index].model;
    const RenderMesh& render = model.mesh.renderMesh;
    const TriangleMesh& file = model.mesh.body;
    const auto faces = file.triangles.rows();
    const bool split = render.triangles.rows() == faces && !render.bodyVertex.empty();
    const Triangles& triangles = split ? render.triangles : file.triangles;
    const auto count = split ? static_cast<Eigen::Index>(render.bodyVertex.size()) : file.vertices.rows();
    const bool hasNormals = split && render.normals.rows() == count, hasTexCoords = split && render.texCoords.rows() == count, hasColors = split && render.colors.rows() == count,
               hasMaterials = split && static_cast<Eigen::Index>(render.material.size()) == faces;

    // A sheet has what one material has of a part.
    struct Sheet {
        int part = 0, material = -1;
        std::vector<std::int32_t> triangles, vertices;
    };
    std::vector<Sheet> sheets;
    std::map<std::pair<int, int>, std::size_t> known;
    for (Eigen::Index t = 0; t < faces; ++t) {
        const int part = model.part[static_cast<std::size_t>(t)];
        const int material = hasMaterials ? render.material[static_cast<std::size_t>(t)] : split && render.materials.size() == 1 ? 0 : -1;
        const auto [at, isNew] = known.emplace(std::pair(part, material), sheets.size());
        if (isNew) sheets.push_back({part, material, {}, {}});
        sheets[at->second].triangles.push_back(static_cast<std::int32_t>(t));
    }
    std::stable_sort(sheets.begin(), sheets.end(), [](const Sheet& a, const Sheet& b) { return a.part < b.part; });
    std::vector<std::int32_t> last(static_cast<std::size_t>(count), -1);  // the last sheet that has a vertex
    for (std::size_t k = 0; k < sheets.size(); ++k)
        for (const auto t : sheets[k].triangles)
            for (int c = 0; c < 3; ++c) {
                sheets[k].vertices.push_back(triangles(t, c));
                last[static_cast<std::size_t>(triangles(t, c))] = static_cast<std::int32_t>(k);
            }
    for (std::size_t v = 0; !sheets.empty() && v < last.size(); ++v) {
        if (last[v] >= 0) continue;
        last[v] = v > 0 ? last[v - 1] : 0;
        sheets[static_cast<std::size_t>(last[v])].vertices.push_back(static_cast<std::int32_t>(v));
    }

    std::vector<RenderSurface> out;
    std::vector<std::set<int>> movers(model.parts.size());
    for (Sheet& sheet : sheets) {
        auto& own = sheet.vertices;
        std::sort(own.begin(), own.end());
        own.erase(std::unique(own.begin(), own.end()), own.end());
        RenderSurface& to = out.emplace_back();
        to.name = model.parts[static_cast<std::size_t>(sheet.part)];
        to.mesh = mesh;
        to.part = first + sheet.part;
        to.look = &render;
        to.materialName = scene.meshes[index].name;
        if (!scene.meshes[index].elements.empty()) to.color = scene.colors[static_cast<std::size_t>(scene.meshes[index].elements.front())];
        const auto vertices = static_cast<Eigen::Index>(own.size());
        to.normals.resize(vertices, 3);
        if (hasTexCoords) to.texCoords.resize(vertices, 2);
        if (hasColors) to.colors.resize(vertices, 4);
        for (Eigen::Index i = 0; i < vertices; ++i) {
            const std::int32_t v = own[static_cast<std::size_t>(i)], b = split ? render.bodyVertex[static_cast<std::size_t>(v)] : v;
            const auto& moved = motion.meshVertices[index][static_cast<std::size_t>(b)];
            to.elements.push_back(moved.element);
            to.rows.push_back(moved.row);
            to.seen.push_back(b);
            movers[static_cast<std::size_t>(sheet.part)].insert(moved.element);
            Eigen::Vector3f normal(normals[3 * b], normals[3 * b + 1], normals[3 * b + 2]);
            if (hasNormals && render.normals.row(v).norm() > 1e-6f) normal = render.normals.row(v).transpose();
            to.normals.row(i) = unit(normal);
            if (hasTexCoords) to.texCoords.row(i) = render.texCoords.row(v);
            if (hasColors) to.colors.row(i) = render.colors.row(v).cwiseMax(0.0f).cwiseMin(1.0f);
        }
        auto& part = to.parts.emplace_back();
        part.material = sheet.material;
        for (const auto t : sheet.triangles)
            for (int c = 0; c < 3; ++c) part.triangles.push_back(static_cast<std::uint32_t>(std::lower_bound(own.begin(), own.end(), triangles(t, c)) - own.begin()));
    }
    for (RenderSurface& surface : out) {
        const auto& all = movers[static_cast<std::size_t>(surface.part - first)];
        surface.movers.assign(all.begin(), all.end());
    }
    return out;
}

}  // namespace imomushi
