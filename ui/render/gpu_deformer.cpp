// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/gpu_deformer.h"

#include <algorithm>
#include <cstring>

#include "ui/render/vertex_block_reader.h"
#include "ui/render/vertex_feedback.h"

namespace imomushi::render {

namespace {

using Eigen::Vector3f;

// Of shaders/element_frame.glsl: vectors that fit into 16 KiB, the least size of a uniform block that OpenGL promises, after shape, placement and size.
constexpr int kMaxVectors = 1000, kHeader = 7;
enum ResponseUnit { kResponse = 0, kIntegerResponse = 1, kShapes = 2 };

/// Vectors of four that hold n numbers.
int vectorsFor(int n) { return (n + 3) / 4; }

/// A' with four modes to a texel: per texel of modes, per axis, per vertex.
template <class T, class Convert>
std::vector<T> packModes(const DeformInput::Element& element, int modeVectors, const Convert& convert) {
    const VertexBlockReader reader(element);
    const auto n = static_cast<std::size_t>(element.vertices);
    std::vector<T> out(12 * n * static_cast<std::size_t>(modeVectors), T(0));
    reader.forEachFreeVertex([&](std::size_t i, const auto& place) {
        const auto v = static_cast<std::size_t>(element.free[i]);
        for (std::size_t c = 0; c < reader.modes(); ++c)
            for (std::size_t axis = 0; axis < 3; ++axis) out[4 * ((c / 4 * 3 + axis) * n + v) + c % 4] = convert(reader.response(place, c, axis));
    });
    return out;
}

void writeRows(const AffineFloat& a, float* to) {
    for (int row = 0; row < 3; ++row) {
        std::copy_n(a.linear + 3 * row, 3, to + 4 * row);
        to[4 * row + 3] = a.shift[row];
    }
}

}  // namespace

Result<void> GpuDeformer::prepare() {
    auto deform = Program::feedback("deform.vert", {"point"});
    if (!deform) return tl::unexpected(deform.error());
    if (auto ready = display_.prepare(); !ready) return ready;
    if (!unused_.resize(1, 1, GL_RGBA8, 0)) return fail("no-opengl", "The graphics driver has no memory for a single pixel: close other programs, or restart.");
    deform_ = std::move(*deform);
    deform_.use();
    deform_.set("response", int(kResponse));
    deform_.set("integerResponse", int(kIntegerResponse));
    deform_.set("shapes", int(kShapes));
    glUseProgram(0);
    return {};
}

void GpuDeformer::clear() {
    id_ = 0;
    uploaded_ = false;
    elements_.clear();
    meshes_.clear();
    display_.clear();
    positions_ = {};
    positionsTexture_ = {};
}

bool GpuDeformer::upload(const DeformInput& deformInput) {
    if (id_ == deformInput.id) return uploaded_;
    clear();
    id_ = deformInput.id;
    GLint texels = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    for (int i = 0; i < 8 && glGetError() != GL_NO_ERROR; ++i) {}  // a lost context reports errors for ever
    elements_.resize(deformInput.elements.size());
    std::int64_t total = 0;
    std::vector<std::int32_t> firsts;
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const auto& element = deformInput.elements[e];
        ElementBuffers& own = elements_[e];
        own.first = static_cast<int>(total);
        firsts.push_back(own.first);
        own.vertices = element.vertices;
        own.faces = element.faces;
        own.places = element.places;
        own.modeVectors = vectorsFor(element.blocks.columns);
        own.shapeVectors = vectorsFor(static_cast<int>(element.shapes.rows()));
        own.supported = element.possible && own.modeVectors + own.places * (4 + 3 * own.shapeVectors) <= kMaxVectors &&
                        std::int64_t{3} * own.modeVectors * own.vertices <= texels;
        if (!own.supported) own.modeVectors = own.shapeVectors = 0;
        // Its normals inside joints are uploaded all the same.
        if (4 * own.places > kMaxVectors) return false;
        total += element.vertices;
    }
    std::int64_t stencils = total;
    for (const auto& mesh : deformInput.meshes) stencils += static_cast<std::int64_t>(mesh.vertices.size());
    if (stencils > texels || total == 0) return false;
    for (std::size_t e = 0; e < elements_.size(); ++e) uploadElement(deformInput.elements[e], elements_[e]);
    for (const auto& s : deformInput.seams) {
        auto& neighbours = elements_[static_cast<std::size_t>(s.element)].neighbours;
        if (std::find(neighbours.begin(), neighbours.end(), s.other) == neighbours.end()) neighbours.push_back(s.other);
    }
    for (const auto& mesh : deformInput.meshes) {
        meshes_.push_back({mesh.elements});
        for (const auto& v : mesh.vertices) elements_[static_cast<std::size_t>(v.element)].seen.push_back(v.vertex);
    }
    for (ElementBuffers& own : elements_) {
        std::sort(own.seen.begin(), own.seen.end());
        own.seen.erase(std::unique(own.seen.begin(), own.seen.end()), own.seen.end());
    }
    display_.upload(deformInput, std::move(firsts));
    positions_ = makeBuffer();
    glBindBuffer(GL_TEXTURE_BUFFER, positions_);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(total * 4 * static_cast<std::int64_t>(sizeof(float))), nullptr, GL_DYNAMIC_COPY);
    positionsTexture_ = makeBufferTexture(GL_RGBA32F, positions_);
    glBindBuffer(GL_TEXTURE_BUFFER, 0);
    unbindVertexFeedback();
    uploaded_ = glGetError() == GL_NO_ERROR;
    if (!uploaded_) {
        clear();
        id_ = deformInput.id;
    }
    return uploaded_;
}

void GpuDeformer::uploadElement(const DeformInput::Element& element, ElementBuffers& own) const {
    own.frameNumbers.resize(4 * static_cast<std::size_t>(kHeader + own.modeVectors + own.places * (4 + 3 * own.shapeVectors)));
    // As large as the block in the shader, whatever is used of it.
    own.frame = makeBuffer(GL_UNIFORM_BUFFER, std::vector<float>(4 * (kHeader + kMaxVectors), 0.0f), GL_DYNAMIC_DRAW);
    glBindBuffer(GL_UNIFORM_BUFFER, 0);
    if (!own.supported) return;
    const auto n = static_cast<std::size_t>(own.vertices);
    std::vector<float> rest(3 * n, 0.0f);
    std::vector<std::int32_t> held(2 * n, -1);
    const VertexBlockReader reader(element);
    reader.forEachFreeVertex([&](std::size_t i, const auto& place) {
        Eigen::Map<Vector3f>(rest.data() + 3 * static_cast<std::size_t>(element.free[i])) = reader.rest(place);
    });
    const auto shapes = static_cast<std::size_t>(element.shapes.rows()), stride = 4 * static_cast<std::size_t>(own.shapeVectors);
    std::vector<float> shapesOf(std::max<std::size_t>(stride * element.held.size(), 4), 0.0f);
    for (std::size_t i = 0; i < element.held.size(); ++i) {
        const auto& h = element.held[i];
        const auto v = static_cast<std::size_t>(h.vertex);
        Eigen::Map<Vector3f>(rest.data() + 3 * v) = h.rest;
        held[2 * v] = h.place;
        held[2 * v + 1] = static_cast<std::int32_t>(i);
        for (std::size_t k = 0; k < shapes; ++k) shapesOf[stride * i + k] = element.shapes(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i));
    }
    std::vector<float> offsets(element.jointParts.empty() ? 0 : 3 * n, 0.0f);
    for (const auto& part : element.jointParts) {
        const auto v = static_cast<std::size_t>(part.vertex);
        held[2 * v + 1] = part.face;
        Eigen::Map<Vector3f>(offsets.data() + 3 * v) = part.offset;
    }
    own.vertexArray = makeVertexArray();
    glBindVertexArray(own.vertexArray);
    own.rest = makeBuffer(GL_ARRAY_BUFFER, rest);
    floatAttribute(0, 3, 0, 0);
    own.held = makeBuffer(GL_ARRAY_BUFFER, held);
    glEnableVertexAttribArray(1);
    glVertexAttribIPointer(1, 2, GL_INT, 0, nullptr);
    if (!offsets.empty()) {
        own.offsets = makeBuffer(GL_ARRAY_BUFFER, offsets);
        floatAttribute(2, 3, 0, 0);
    }
    glBindVertexArray(0);

    own.integers = element.blocks.format == ResponseFormat::Int16;
    const int vectors = std::max(own.modeVectors, 1);  // never an empty buffer
    switch (element.blocks.format) {
        case ResponseFormat::Float:
            own.response = makeBuffer(GL_TEXTURE_BUFFER, packModes<float>(element, vectors, [](float x) { return x; }));
            own.responseTexture = makeBufferTexture(GL_RGBA32F, own.response);
            break;
        case ResponseFormat::Half:
            own.response = makeBuffer(GL_TEXTURE_BUFFER, packModes<Eigen::half>(element, vectors, [](float x) { return Eigen::half(x); }));
            own.responseTexture = makeBufferTexture(GL_RGBA16F, own.response);
            break;
        case ResponseFormat::Int16:
            own.response = makeBuffer(GL_TEXTURE_BUFFER, packModes<std::int16_t>(element, vectors, [](float x) { return static_cast<std::int16_t>(x); }));
            own.responseTexture = makeBufferTexture(GL_RGBA16I, own.response);
            break;
    }
    own.shapes = makeBuffer(GL_TEXTURE_BUFFER, shapesOf);
    own.shapesTexture = makeBufferTexture(GL_RGBA32F, own.shapes);
    own.boundsOf.prepare(element);
}

// ---- frame -----------------------------------------------------------------------------------------------------------

void GpuDeformer::uploadFrame(const DeformInput::Element& element, ElementBuffers& own) {
    const auto& frame = element.frame;
    float* out = own.frameNumbers.data();
    writeRows(frame.shape, out);
    writeRows(frame.placement, out + 12);
    const std::int32_t size[4] = {own.modeVectors, own.vertices, own.shapeVectors, own.integers ? 1 : 0};
    std::memcpy(out + 24, size, sizeof size);
    out += 4 * kHeader;
    if (own.supported) std::copy(frame.weights.begin(), frame.weights.end(), out);
    out += 4 * own.modeVectors;
    const auto shapes = own.supported ? static_cast<std::size_t>(element.shapes.rows()) : 0;
    for (std::size_t f = 0; f < static_cast<std::size_t>(own.places); ++f, out += 16 + 12 * own.shapeVectors) {
        writeRows(frame.joints[f], out);
        if (f < frame.faceNormals.size()) std::copy_n(frame.faceNormals[f].data(), 3, out + 12);
        for (std::size_t k = 0; k < shapes; ++k)
            for (std::size_t axis = 0; axis < 3; ++axis) out[16 + 12 * (k / 4) + 4 * axis + k % 4] = frame.warping[(3 * f + axis) * shapes + k];
    }
    const auto bytes = own.frameNumbers.size() * sizeof(float);
    glBindBuffer(GL_UNIFORM_BUFFER, own.frame);
    glBufferSubData(GL_UNIFORM_BUFFER, 0, static_cast<GLsizeiptr>(bytes), own.frameNumbers.data());
    stats_.uploaded += bytes;
}

void GpuDeformer::uploadPositions(const DeformInput::Element& element, ElementBuffers& own) {
    const auto n = static_cast<std::size_t>(own.vertices);
    staging_.resize(4 * n);
    own.bounds = {};
    for (std::size_t v = 0; v < n; ++v) {
        const Eigen::Map<const Vector3f> p(element.positions + 3 * v);
        Eigen::Map<Eigen::Vector4f>(staging_.data() + 4 * v) << p, 1.0f;
        if (own.seen.empty()) own.bounds.conservative.extend(p);
    }
    for (const auto v : own.seen) own.bounds.conservative.extend(Eigen::Map<const Vector3f>(element.positions + 3 * static_cast<std::ptrdiff_t>(v)));
    own.bounds.tight = own.bounds.conservative;
    glBindBuffer(GL_ARRAY_BUFFER, positions_);
    glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(16 * static_cast<std::size_t>(own.first)), static_cast<GLsizeiptr>(16 * n), staging_.data());
    stats_.uploaded += 16 * n;
}

void GpuDeformer::deform(const DeformInput& deformInput) {
    stats_ = {};
    for (ElementBuffers& own : elements_) own.needed = own.seen.empty();
    for (const auto& mesh : deformInput.meshes)
        for (const auto e : mesh.elements) elements_[static_cast<std::size_t>(e)].needed = elements_[static_cast<std::size_t>(e)].needed || deformInput.external(mesh);
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const auto& element = deformInput.elements[e];
        ElementBuffers& own = elements_[e];
        own.changed = own.needed && (own.fresh || own.revision != element.frame.revision);
        if (!own.changed) continue;
        own.fresh = false;
        own.revision = element.frame.revision;
        uploadFrame(element, own);
        if (element.external && own.supported) {
            ++stats_.deformed;
            own.bounds = own.boundsOf.at(element);
        } else {
            ++stats_.copied;
            uploadPositions(element, own);
        }
    }
    unused_.bind();
    deform_.use();
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const ElementBuffers& own = elements_[e];
        if (!own.changed || !deformInput.elements[e].external || !own.supported) continue;
        glBindBufferBase(GL_UNIFORM_BUFFER, 1, own.frame);
        bindBufferTexture(kResponse, own.integers ? 0 : GLuint(own.responseTexture));
        bindBufferTexture(kIntegerResponse, own.integers ? GLuint(own.responseTexture) : 0);
        bindBufferTexture(kShapes, own.shapesTexture);
        glBindVertexArray(own.vertexArray);
        runVertexFeedback(own.vertices, positions_, 16 * static_cast<std::size_t>(own.first), 16 * static_cast<std::size_t>(own.vertices));
    }
    for (ElementBuffers& own : elements_) {
        bool changed = own.changed;
        for (const int other : own.neighbours) changed = changed || elements_[static_cast<std::size_t>(other)].changed;
        if (changed) ++own.version;
    }
    for (MeshState& mesh : meshes_) {
        bool changed = false;
        for (const auto e : mesh.elements) changed = changed || elements_[static_cast<std::size_t>(e)].changed;
        if (!changed) continue;
        ++mesh.version;
        mesh.bounds = {};
        for (const auto e : mesh.elements) {
            mesh.bounds.conservative.extend(elements_[static_cast<std::size_t>(e)].bounds.conservative);
            mesh.bounds.tight.extend(elements_[static_cast<std::size_t>(e)].bounds.tight);
        }
    }
    unbindVertexFeedback();
}

void GpuDeformer::writeDisplayVertices(int surface, const DisplayMap& map, GLuint vertices) const {
    // Render meshes read no numbers of an element.
    const auto element = static_cast<std::size_t>(isMesh(surface) ? meshOf(surface).elements.front() : surface);
    unused_.bind();
    display_.write(map, elements_[element].frame, positionsTexture_, vertices);
}

void GpuDeformer::readBack(int element, int first, int count, float* positions) const { read(elements_[static_cast<std::size_t>(element)].first + first, count, positions); }

void GpuDeformer::read(int first, int count, float* positions) const {
    std::vector<float> four(4 * static_cast<std::size_t>(count));
    glBindBuffer(GL_ARRAY_BUFFER, positions_);
    glGetBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(16) * first, static_cast<GLsizeiptr>(16) * count, four.data());
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) std::copy_n(&four[4 * i], 3, positions + 3 * i);
}

}  // namespace imomushi::render
