// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/display_vertices.h"

#include <cstddef>

#include "ui/render/vertex_feedback.h"

namespace imomushi::render {

namespace {
enum NormalKind : std::int32_t { kStencil = 0, kHidden = 1, kSeam = 2, kTriangles = 3 };
enum Unit { kPositions = 0, kStencils = 1, kStencilParts = 2, kCorners = 3 };
}  // namespace

Result<void> DisplayVertices::prepare() {
    auto program = Program::feedback("display_vertices.vert", {"displayPosition", "displayNormal"});
    if (!program) return tl::unexpected(program.error());
    program_ = std::move(*program);
    program_.use();
    program_.set("positions", int(kPositions));
    program_.set("stencils", int(kStencils));
    program_.set("stencilParts", int(kStencilParts));
    program_.set("corners", int(kCorners));
    glUseProgram(0);
    return {};
}

void DisplayVertices::clear() {
    first_.clear();
    sources_.clear();
    stencils_ = {}, stencilParts_ = {};
    stencilsTexture_ = {}, stencilPartsTexture_ = {};
}

void DisplayVertices::upload(const DeformInput& deformInput, std::vector<std::int32_t> firsts) {
    first_ = std::move(firsts);
    std::vector<std::int32_t> stencils;
    std::vector<float> parts;
    sources_.clear();
    for (std::size_t e = 0; e < deformInput.elements.size(); ++e) {
        const auto& element = deformInput.elements[e];
        const std::int32_t first = first_[e];
        for (std::int32_t v = 0; v < element.vertices; ++v) {
            // Embedded points have none of their element.
            const NormalStencil s = v < element.bodyVertices ? element.stencils[v] : NormalStencil();
            stencils.insert(stencils.end(), {first + s.a, first + s.b, first + s.c, first + s.d});
            parts.insert(parts.end(), {s.part[0], s.part[1], element.scale, 0.0f});
            sources_.push_back({first + v, kStencil, first + v, 0, 0.0f});
        }
        for (const auto& h : element.hidden) sources_[static_cast<std::size_t>(first + h.vertex)] = {first + h.vertex, kHidden, h.face, 0, 0.0f};
    }
    for (const auto& s : deformInput.seams) {
        const std::int32_t vertex = first_[static_cast<std::size_t>(s.element)] + s.vertex, other = first_[static_cast<std::size_t>(s.other)];
        sources_[static_cast<std::size_t>(vertex)] = {vertex, kSeam, other + s.from, other + s.to, s.part};
    }
    for (const auto& mesh : deformInput.meshes) {
        first_.push_back(static_cast<std::int32_t>(sources_.size()));
        const auto at = [&](std::int32_t v) {
            const auto& vertex = mesh.vertices[static_cast<std::size_t>(v)];
            return first_[static_cast<std::size_t>(vertex.element)] + vertex.vertex;
        };
        for (std::int32_t v = 0; v < static_cast<std::int32_t>(mesh.vertices.size()); ++v) {
            const NormalStencil& s = mesh.stencils[v];
            sources_.push_back({at(v), kStencil, static_cast<std::int32_t>(sources_.size()), 0, 0.0f});
            stencils.insert(stencils.end(), {at(s.a), at(s.b), at(s.c), at(s.d)});
            parts.insert(parts.end(), {s.part[0], s.part[1], mesh.scale, 0.0f});
        }
    }
    stencils_ = makeBuffer(GL_TEXTURE_BUFFER, stencils);
    stencilsTexture_ = makeBufferTexture(GL_RGBA32I, stencils_);
    stencilParts_ = makeBuffer(GL_TEXTURE_BUFFER, parts);
    stencilPartsTexture_ = makeBufferTexture(GL_RGBA32F, stencilParts_);
}

const DisplayVertices::Source& DisplayVertices::sourceOf(const Shown& shown, std::int32_t vertex) const {
    const std::int32_t v = shown.vertices ? (*shown.vertices)[static_cast<std::size_t>(vertex)] : vertex;
    return sources_[static_cast<std::size_t>(first_[static_cast<std::size_t>(shown.surface)] + v)];
}

DisplayVertices::Map DisplayVertices::makeMap(const Shown& shown, const BodyGeometry& geometry, const std::vector<Neighbour>& neighbours) const {
    // Where the triangles of each group begin, and how many there are.
    std::vector<std::pair<std::int32_t, std::int32_t>> triangles;
    std::vector<std::int32_t> corners;
    std::vector<Source> sources;
    const auto add = [&](const BodyGeometry& from, int group, const Shown& of) {
        for (const auto t : from.groupTriangles(group))
            for (int c = 0; c < 3; ++c) corners.push_back(sourceOf(of, from.triangles()(t, c)).vertex);
    };
    // Vertices of `geometry` that are welded to others, by their group.
    std::vector<std::vector<std::pair<const Neighbour*, int>>> welded;
    for (const Neighbour& n : neighbours)
        for (const auto& [own, its] : n.welded) {
            const int g = geometry.seamGroup(own), other = n.geometry->seamGroup(its);
            if (g < 0 || other < 0) continue;
            if (welded.size() <= static_cast<std::size_t>(g)) welded.resize(static_cast<std::size_t>(g) + 1);
            welded[static_cast<std::size_t>(g)].emplace_back(&n, other);
        }
    for (int i = 0; i < geometry.vertexCount(); ++i) {
        Source s = sourceOf(shown, geometry.bodyVertex()[static_cast<std::size_t>(i)]);
        if (const int group = geometry.group(i); group >= 0) {
            const auto g = static_cast<std::size_t>(group);
            if (triangles.size() <= g) triangles.resize(g + 1, {-1, 0});
            if (triangles[g].first < 0) {
                const auto begin = static_cast<std::int32_t>(corners.size() / 3);
                add(geometry, group, shown);
                if (g < welded.size())
                    for (const auto& [neighbour, other] : welded[g]) add(*neighbour->geometry, other, {neighbour->element, nullptr});
                triangles[g] = {begin, static_cast<std::int32_t>(corners.size() / 3) - begin};
            }
            s.kind = kTriangles;
            s.one = triangles[g].first;
            s.two = triangles[g].second;
        }
        sources.push_back(s);
    }
    if (corners.empty()) corners.push_back(0);
    Map map;
    map.count = geometry.vertexCount();
    map.vertexArray = makeVertexArray();
    glBindVertexArray(map.vertexArray);
    map.sources = makeBuffer(GL_ARRAY_BUFFER, sources);
    glEnableVertexAttribArray(0);
    glVertexAttribIPointer(0, 4, GL_INT, sizeof(Source), nullptr);
    floatAttribute(1, 1, sizeof(Source), offsetof(Source, part));
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    map.corners = makeBuffer(GL_TEXTURE_BUFFER, corners);
    map.cornersTexture = makeBufferTexture(GL_R32I, map.corners);
    glBindBuffer(GL_TEXTURE_BUFFER, 0);
    return map;
}

void DisplayVertices::write(const Map& map, GLuint elementFrame, GLuint positions, GLuint vertices) const {
    program_.use();
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, elementFrame);
    bindBufferTexture(kPositions, positions);
    bindBufferTexture(kStencils, stencilsTexture_);
    bindBufferTexture(kStencilParts, stencilPartsTexture_);
    bindBufferTexture(kCorners, map.cornersTexture);
    glBindVertexArray(map.vertexArray);
    runVertexFeedback(map.count, vertices, 0, static_cast<std::size_t>(map.count) * BodyGeometry::kFloats * sizeof(float));
    unbindVertexFeedback();
}

}  // namespace imomushi::render
