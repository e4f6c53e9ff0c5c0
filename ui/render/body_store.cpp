// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/body_store.h"

#include <algorithm>
#include <cmath>

#include "ui/render/decoded_textures.h"

namespace imomushi::render {

namespace {

using Eigen::Vector3f;

TextureName makeTexture(const std::optional<Image>& image) {
    if (!image) return {};
    GLuint n = 0;
    glGenTextures(1, &n);
    TextureName name(n);
    glBindTexture(GL_TEXTURE_2D, n);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, image->width, image->height, 0, GL_RGBA, GL_UNSIGNED_BYTE, image->rgba.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return name;
}

}  // namespace

std::shared_ptr<const std::vector<TextureName>> BodyStore::texturesOf(const std::shared_ptr<const ElementMesh>& source) const {
    for (const auto& [key, known] : bodies_)
        if (known.textureSource == source) return known.textures;
    auto made = std::make_shared<std::vector<TextureName>>();
    for (const auto& image : takeTextures(source)) made->push_back(makeTexture(image));
    glBindTexture(GL_TEXTURE_2D, 0);
    return made;
}

void BodyStore::create(const Body& body, GpuBody& gpu) {
    const auto& source = body.textures ? body.textures : body.mesh;
    auto textures = texturesOf(source);
    gpu = GpuBody();
    gpu.textureSource = source;
    gpu.textures = std::move(textures);
    gpu.mesh = body.mesh;
    gpu.covered = body.coveredTriangles;
    gpu.geometry = std::make_unique<BodyGeometry>(*body.mesh, body.coveredTriangles.get());
    const BodyGeometry& g = *gpu.geometry;
    gpu.staging.resize(std::size_t(g.vertexCount()) * BodyGeometry::kFloats);

    // Texture coordinates and colours never change.
    const RenderMesh& surface = body.mesh->renderMesh;
    const bool coords = surface.texCoords.rows() == static_cast<Eigen::Index>(surface.bodyVertex.size());
    const bool colors = surface.colors.rows() == static_cast<Eigen::Index>(surface.bodyVertex.size());
    std::vector<float> fixed(std::size_t(g.vertexCount()) * 6);
    for (int i = 0; i < g.vertexCount(); ++i) {
        const int v = g.renderVertex()[i];
        float* out = &fixed[6 * std::size_t(i)];
        out[0] = coords && v >= 0 ? surface.texCoords(v, 0) : 0.0f;
        out[1] = coords && v >= 0 ? surface.texCoords(v, 1) : 0.0f;
        for (int c = 0; c < 4; ++c) {
            const float value = colors && v >= 0 ? surface.colors(v, c) : 1.0f;
            out[2 + c] = std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 1.0f;
        }
    }
    gpu.vertexArray = makeVertexArray();
    glBindVertexArray(gpu.vertexArray);
    gpu.vertices = makeBuffer();
    glBindBuffer(GL_ARRAY_BUFFER, gpu.vertices);
    floatAttribute(0, 3, BodyGeometry::kFloats * sizeof(float), 0);
    floatAttribute(1, 3, BodyGeometry::kFloats * sizeof(float), 3 * sizeof(float), 0);
    gpu.attributes = makeBuffer();
    glBindBuffer(GL_ARRAY_BUFFER, gpu.attributes);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(fixed.size() * sizeof(float)), fixed.data(), GL_STATIC_DRAW);
    floatAttribute(2, 2, 6 * sizeof(float), 0);
    floatAttribute(3, 4, 6 * sizeof(float), 2 * sizeof(float), 0);
    gpu.indices = makeBuffer();
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(g.indices().size() * sizeof(std::uint32_t)), g.indices().data(), GL_STATIC_DRAW);
    gpu.highlight = makeBuffer();
    glBindVertexArray(0);
}

void BodyStore::upload(const Body& body, GpuBody& gpu) {
    gpu.geometry->fill(body.positions, body.normals, gpu.staging.data());
    const auto bytes = static_cast<GLsizeiptr>(gpu.staging.size() * sizeof(float));
    glBindBuffer(GL_ARRAY_BUFFER, gpu.vertices);
    // A new store each time: the driver need not wait until the last frame has been drawn.
    glBufferData(GL_ARRAY_BUFFER, bytes, gpu.staging.data(), GL_STREAM_DRAW);
    const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, BodyGeometry::kFloats, Eigen::RowMajor>> all(gpu.staging.data(), gpu.geometry->vertexCount(),
                                                                                                         BodyGeometry::kFloats);
    if (all.rows() > 0) {
        gpu.low = all.leftCols<3>().colwise().minCoeff().transpose();
        gpu.high = all.leftCols<3>().colwise().maxCoeff().transpose();
        gpu.tightBounds = Eigen::AlignedBox3d(gpu.low.cast<double>(), gpu.high.cast<double>());
    }
}

/// Bodies that the GPU deforms.
void BodyStore::deformAll(const Scene& scene, const std::vector<GpuBody*>& drawn) {
    if (!scene.deformInput || deformer_.characterId() != scene.deformInput->id) return;
    deformer_.deform(*scene.deformInput);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        if (!drawn[i] || drawn[i]->surface < 0) continue;
        GpuBody& gpu = *drawn[i];
        const std::uint64_t version = deformer_.version(gpu.surface);
        gpu.changed = gpu.fresh || gpu.deformInput != scene.deformInput->id || gpu.version != version;
        if (gpu.fresh || gpu.deformInput != scene.deformInput->id) gpu.displayMap = {};
        gpu.deformInput = scene.deformInput->id;
        gpu.version = version;
        writeDisplayVertices(scene, drawn, i);
        const auto& bounds = deformer_.bounds(gpu.surface);
        gpu.low = bounds.conservative.min();
        gpu.high = bounds.conservative.max();
        gpu.tightBounds = bounds.tight.cast<double>();
        gpu.fresh = false;
    }
}

void BodyStore::writeDisplayVertices(const Scene& scene, const std::vector<GpuBody*>& drawn, std::size_t i) {
    GpuBody& gpu = *drawn[i];
    const auto bodyAt = [&](int b) { return b >= 0 && b < static_cast<int>(drawn.size()) ? drawn[static_cast<std::size_t>(b)] : nullptr; };
    // The normals of hard edges depend on the bodies that are welded to it, and these are few: made anew when one is another than before.
    const auto eachSeam = [&](const auto& act) {
        for (const Seam& seam : scene.seams)
            for (const bool first : {true, false}) {
                if (static_cast<std::size_t>(first ? seam.a : seam.b) != i || !seam.welded) continue;
                const GpuBody* other = bodyAt(first ? seam.b : seam.a);
                if (other && other->surface >= 0) act(seam, *other, first);
            }
    };
    std::size_t n = 0;
    bool same = gpu.displayMap.count > 0;
    eachSeam([&](const Seam& seam, const GpuBody& other, bool) {
        same = same && n < gpu.seams.size() && gpu.seams[n] == std::pair(static_cast<const void*>(seam.welded.get()), static_cast<const BodyGeometry*>(other.geometry.get()));
        ++n;
    });
    if (!same || n != gpu.seams.size()) {
        gpu.seams.clear();
        std::vector<GpuDeformer::Neighbour> neighbours;
        eachSeam([&](const Seam& seam, const GpuBody& other, bool first) {
            gpu.seams.emplace_back(seam.welded.get(), other.geometry.get());
            neighbours.push_back({other.geometry.get(), other.surface, *seam.welded});
            if (!first)
                for (auto& [own, its] : neighbours.back().welded) std::swap(own, its);
        });
        gpu.displayMap = deformer_.makeDisplayMap(deformer_.shownBy(gpu.surface, scene.bodies[i].modelVertices), *gpu.geometry, neighbours);
        gpu.changed = true;
    }
    if (!gpu.changed) return;
    glBindBuffer(GL_ARRAY_BUFFER, gpu.vertices);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(gpu.staging.size() * sizeof(float)), nullptr, GL_DYNAMIC_COPY);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    deformer_.writeDisplayVertices(gpu.surface, gpu.displayMap, gpu.vertices);
}

void BodyStore::update(const Scene& scene, std::vector<GpuBody*>& drawn) {
    for (auto& [key, gpu] : bodies_) gpu.used = gpu.welded = false;
    drawn.clear();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Body& body = scene.bodies[i];
        const int surface = scene.deformInput && deformer_.characterId() == scene.deformInput->id ? body.deformSurface : -1;
        int copies = 0;
        for (std::size_t j = 0; j < i; ++j) copies += scene.bodies[j].id == body.id;
        const std::pair key(body.id, copies);
        if (!body.visible || !body.mesh || (!body.positions && surface < 0) || body.mesh->body.triangles.rows() == 0) {
            if (const auto known = bodies_.find(key); !body.visible && known != bodies_.end()) known->second.used = true;
            drawn.push_back(nullptr);
            continue;
        }
        GpuBody& gpu = bodies_[key];
        if (gpu.mesh != body.mesh || gpu.covered != body.coveredTriangles) create(body, gpu);
        gpu.used = true;
        if (gpu.surface != surface) gpu.fresh = true;
        gpu.surface = surface;
        gpu.changed = gpu.fresh || gpu.revision != body.revision || gpu.positions != body.positions;
        gpu.revision = body.revision;
        gpu.positions = body.positions;
        drawn.push_back(&gpu);
    }
    std::erase_if(bodies_, [](const auto& entry) { return !entry.second.used; });
    deformAll(scene, drawn);
    uploadAll(scene, drawn);
    for (std::size_t i = 0; i < drawn.size(); ++i)
        if (drawn[i]) uploadHighlight(scene.bodies[i].highlightedTriangles, *drawn[i]);
}

/// Bodies whose positions the processor computes.
void BodyStore::uploadAll(const Scene& scene, const std::vector<GpuBody*>& drawn) {
    // Normals across a seam depend on both sides, so a body is filled again when a neighbour changed.
    const auto bodyAt = [&](int i) { return i >= 0 && i < static_cast<int>(drawn.size()) && drawn[i] && drawn[i]->surface < 0 ? drawn[i] : nullptr; };
    for (const Seam& seam : scene.seams) {
        GpuBody *a = bodyAt(seam.a), *b = bodyAt(seam.b);
        if (a && b && (a->changed || b->changed)) a->welded = b->welded = true;
    }
    for (std::size_t i = 0; i < drawn.size(); ++i)
        if (drawn[i] && drawn[i]->surface < 0 && (drawn[i]->changed || drawn[i]->welded)) drawn[i]->geometry->sumNormals(scene.bodies[i].positions);
    for (const Seam& seam : scene.seams) {
        GpuBody *a = bodyAt(seam.a), *b = bodyAt(seam.b);
        if (!a || !b || !seam.welded) continue;
        // A neighbour that did not change keeps the sums of its last frame; only those that are filled again take part.
        const bool fillA = a->changed || a->welded, fillB = b->changed || b->welded;
        for (const auto& [va, vb] : *seam.welded) {
            const int ga = a->geometry->seamGroup(va), gb = b->geometry->seamGroup(vb);
            if (ga < 0 || gb < 0) continue;
            if (fillA) a->geometry->addToNormal(ga, b->geometry->sum(gb));
            if (fillB) b->geometry->addToNormal(gb, a->geometry->sum(ga));
        }
    }
    for (std::size_t i = 0; i < drawn.size(); ++i)
        if (drawn[i] && drawn[i]->surface < 0 && (drawn[i]->changed || drawn[i]->welded)) {
            upload(scene.bodies[i], *drawn[i]);
            drawn[i]->fresh = false;
        }
}

void BodyStore::uploadHighlight(const std::vector<std::int32_t>* triangles, GpuBody& gpu) {
    if (triangles ? gpu.highlightedTriangles == *triangles : gpu.highlightedTriangles.empty()) return;
    gpu.highlightedTriangles = triangles ? *triangles : std::vector<std::int32_t>();
    gpu.highlightedIndices.clear();
    for (const std::int32_t f : gpu.highlightedTriangles)
        if (f >= 0 && f < gpu.mesh->body.triangles.rows()) gpu.highlightedIndices.insert(gpu.highlightedIndices.end(), gpu.geometry->corners(f), gpu.geometry->corners(f) + 3);
    // Not as elements: that binding belongs to a vertex array, and without one it is an error in a core profile.
    glBindBuffer(GL_COPY_WRITE_BUFFER, gpu.highlight);
    glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(gpu.highlightedIndices.size() * sizeof(std::uint32_t)), gpu.highlightedIndices.data(), GL_DYNAMIC_DRAW);
}

void BodyStore::clear() {
    bodies_.clear();
    deformer_.clear();
}

}  // namespace imomushi::render
