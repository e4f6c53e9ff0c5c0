// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <utility>

#include "core/mesh/mend_surface.h"
#include "core/mesh/render_vertices.h"
#include "core/mesh/shells.h"

namespace imomushi {
namespace {

constexpr int kMaxBodies = 1024;

/// The materials and textures that these faces wear, in the order of the file.
void takeMaterials(const MendSurface& s, const std::vector<std::int32_t>& faces, RenderMesh& render) {
    if (s.renderMesh.material.empty()) return;
    std::vector<std::int32_t> material(s.renderMesh.materials.size(), -1), texture(s.renderMesh.textures.size(), -1);
    for (const std::int32_t f : faces) material[at(s.faces[at(f)].material)] = 0;
    for (std::size_t m = 0; m < material.size(); ++m) {
        if (material[m] < 0) continue;
        material[m] = static_cast<std::int32_t>(render.materials.size());
        Material& worn = render.materials.emplace_back(s.renderMesh.materials[m]);
        if (worn.baseColorTexture < 0) continue;
        std::int32_t& t = texture[at(worn.baseColorTexture)];
        if (t < 0) {
            t = static_cast<std::int32_t>(render.textures.size());
            render.textures.push_back(s.renderMesh.textures[at(worn.baseColorTexture)]);
        }
        worn.baseColorTexture = t;
    }
    for (const std::int32_t f : faces) render.material.push_back(material[at(s.faces[at(f)].material)]);
}

ElementMesh extract(const MendSurface& s, const std::vector<std::int32_t>& faces) {
    ElementMesh mesh;
    std::vector<std::int32_t> number(static_cast<std::size_t>(s.points.rows()), -1);
    for (const std::int32_t f : faces)
        for (const std::int32_t v : s.faces[at(f)].v) number[at(v)] = 0;
    std::int32_t vertices = 0;
    for (std::int32_t& n : number)
        if (n == 0) n = vertices++;
    mesh.body.vertices.resize(vertices, 3);
    for (std::size_t v = 0; v < number.size(); ++v)
        if (number[v] >= 0) mesh.body.vertices.row(number[v]) = s.points.row(static_cast<Eigen::Index>(v));
    mesh.body.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t i = 0; i < faces.size(); ++i)
        for (int k = 0; k < 3; ++k)
            mesh.body.triangles(static_cast<Eigen::Index>(i), k) = number[at(s.faces[at(faces[i])].v[static_cast<std::size_t>(k)])];
    RenderMesh& render = mesh.renderMesh;
    takeMaterials(s, faces, render);
    if (!s.attributes) {
        render.bodyVertex.resize(at(vertices));
        std::iota(render.bodyVertex.begin(), render.bodyVertex.end(), 0);
        render.triangles = mesh.body.triangles;
        return mesh;
    }
    render.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
    RenderVertices chosen(s.renderMesh);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const MendFace& face = s.faces[at(faces[i])];
        const Vec3 out = areaVector(mesh.body, static_cast<std::int32_t>(i));
        for (std::size_t k = 0; k < 3; ++k) {
            const bool flipped = face.turned && s.renderMesh.normals.rows() > 0 && s.renderMesh.normals.row(face.r[k]).cast<double>().dot(out) < 0.0;
            render.triangles(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = chosen.add(number[at(face.v[k])], face.r[k], flipped);
        }
    }
    chosen.write(render);
    return mesh;
}

}  // namespace

MendResult makeBodies(MendSurface& s, bool split) {
    MendResult result;
    int count = 0;
    const Triangles triangles = s.triangles();
    const EdgeTable edges(triangles);
    const std::vector<std::int32_t> component = edgeComponents(triangles, edges, count);
    const std::vector<char> sound = soundComponents(triangles, edges, component, count);
    std::vector<std::int32_t> shellOf(at(count), -1), components;  // component -> shell -> component
    for (std::int32_t c = 0; c < count; ++c)
        if (sound[at(c)]) {
            shellOf[at(c)] = static_cast<std::int32_t>(components.size());
            components.push_back(c);
        }
    std::vector<std::int32_t> shellOfFace(s.faces.size());
    for (std::size_t f = 0; f < s.faces.size(); ++f) shellOfFace[f] = shellOf[at(component[f])];
    const Shells shells = findShells({s.points, triangles}, shellOfFace, static_cast<int>(components.size()));
    std::size_t inverted = 0;
    for (const Shells::Shell& shell : shells.shells) {
        if (!shell.inverted()) continue;
        ++inverted;
        for (const std::int32_t f : shell.triangles) s.faces[at(f)].turn();
    }
    if (inverted > 0)
        s.say("inverted", counted(inverted, "surface that faced inside out was", "surfaces that faced inside out were") + " turned.", inverted);

    std::vector<std::int32_t> bodyOf(at(count), 0);
    int bodies = s.faces.empty() ? 0 : 1;
    if (split && count > kMaxBodies) {
        s.say("components", "The mesh has " + std::to_string(count) + " separate surfaces, too many for one element each; it was not split.",
            at(count));
        s.issues.back().severity = Severity::Warning;
        s.issues.back().fixed = false;
    } else if (split) {
        bodies = 0;
        for (std::int32_t c = 0; c < count; ++c) {
            const bool cavity = shellOf[at(c)] >= 0 && shells.shells[at(shellOf[at(c)])].cavity();
            bodyOf[at(c)] = cavity ? -1 : bodies++;
        }
        for (std::int32_t c = 0; c < count; ++c)
            if (bodyOf[at(c)] < 0) bodyOf[at(c)] = bodyOf[at(components[at(shells.shells[at(shellOf[at(c)])].parent)])];
    }
    std::vector<std::vector<std::int32_t>> members(at(bodies));
    for (std::size_t f = 0; f < s.faces.size(); ++f) members[at(bodyOf[at(component[f])])].push_back(static_cast<std::int32_t>(f));
    for (const auto& faces : members) {
        MendedBody body;
        body.mesh = extract(s, faces);
        body.part = s.faces[at(faces.front())].part;
        body.issues = checkMesh(body.mesh.body);
        const MeshFacts facts = meshFacts(body.mesh.body);
        body.components = facts.components;
        body.closed = facts.closed && facts.outward &&
                      std::none_of(body.issues.begin(), body.issues.end(), [](const MeshIssue& i) { return i.severity == Severity::Error; });
        result.bodies.push_back(std::move(body));
    }
    result.mended = std::move(s.issues);
    return result;
}

}  // namespace imomushi
