// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/card_deformer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace imomushi::render {

namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

// Of shaders/drive.glsl: numbers that fit into 16 KiB, the least uniform block there may be, after shape, placement and size.
constexpr int kMostNumbers = 1000, kHeader = 7;
// Bounds: as many clusters, and as many held vertices of a face.
constexpr std::size_t kClusters = 256, kSomeHeld = 64;
enum NormalKind : std::int32_t { kStencil = 0, kHidden = 1, kSeam = 2, kTriangles = 3 };
// Texture units of the passes.
enum Unit { kPoints = 0, kStencils = 1, kStencilParts = 2, kCorners = 3, kResponse = 0, kIntegerResponse = 1, kShapes = 2, kUnits = 4 };

int fours(int n) { return (n + 3) / 4; }

template <class T>
Buffer makeBuffer(GLenum target, const std::vector<T>& data, GLenum usage = GL_STATIC_DRAW) {
    Buffer buffer = render::makeBuffer();
    glBindBuffer(target, buffer);
    glBufferData(target, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(), usage);
    return buffer;
}

TextureName bufferTexture(GLenum format, const Buffer& buffer) {
    GLuint n = 0;
    glGenTextures(1, &n);
    glBindTexture(GL_TEXTURE_BUFFER, n);
    glTexBuffer(GL_TEXTURE_BUFFER, format, buffer);
    glBindTexture(GL_TEXTURE_BUFFER, 0);
    return TextureName(n);
}

void bindBufferTexture(int unit, GLuint texture) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_BUFFER, texture);
}

void unbind() {
    for (int unit = kUnits - 1; unit >= 0; --unit) bindBufferTexture(unit, 0);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, 0);
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    glUseProgram(0);
}

/// One point per vertex, into `buffer`; program, vertices and textures are bound.
void feed(int count, GLuint buffer, std::size_t offset, std::size_t bytes) {
    glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes));
    glEnable(GL_RASTERIZER_DISCARD);
    glBeginTransformFeedback(GL_POINTS);
    glDrawArrays(GL_POINTS, 0, count);
    glEndTransformFeedback();
    glDisable(GL_RASTERIZER_DISCARD);
}

/// Entry of A' (without the scale of its mode).
class Entries {
public:
    explicit Entries(const VertexBlocks& blocks) : blocks_(blocks), columns_(static_cast<std::size_t>(blocks.columns)), pairs_((columns_ + 1) / 2) {}
    [[nodiscard]] float operator()(std::size_t block, std::size_t column, std::size_t lane) const {
        constexpr std::size_t kStride = 3 * kVertexBlock;
        switch (blocks_.format) {
            case ResponseFormat::Float: return static_cast<const float*>(blocks_.response)[(block * columns_ + column) * kStride + lane];
            case ResponseFormat::Half: return static_cast<float>(static_cast<const Eigen::half*>(blocks_.response)[(block * columns_ + column) * kStride + lane]);
            case ResponseFormat::Int16:
                return static_cast<const std::int16_t*>(blocks_.response)[2 * ((block * pairs_ + column / 2) * kStride + lane) + column % 2];
        }
        return 0.0f;
    }

private:
    const VertexBlocks& blocks_;
    const std::size_t columns_, pairs_;
};

/// body(i-th free vertex, block, lane of x)
template <class Body>
void eachFree(const SurfaceRecipe::Element& element, const Body& body) {
    std::size_t block = 0;
    for (std::size_t i = 0; i < element.free->size(); ++i) {
        const std::int32_t v = (*element.free)[i];
        while (v >= element.blocks.first[block] + kVertexBlock) ++block;
        body(i, block, static_cast<std::size_t>(v - element.blocks.first[block]));
    }
}

Vector3f restOf(const SurfaceRecipe::Element& element, std::size_t block, std::size_t lane) {
    const float* x = element.blocks.rest + block * 3 * kVertexBlock + lane;
    return {x[0], x[kVertexBlock], x[2 * kVertexBlock]};
}

/// A' in fours of modes: per four, per axis, per body vertex; as floats, halves (bits) or integers.
template <class T, class Convert>
std::vector<T> inFours(const SurfaceRecipe::Element& element, int quads, const Convert& convert) {
    const Entries entries(element.blocks);
    const auto n = static_cast<std::size_t>(element.vertices);
    std::vector<T> out(12 * n * static_cast<std::size_t>(quads), T(0));
    eachFree(element, [&](std::size_t i, std::size_t block, std::size_t lane) {
        const auto v = static_cast<std::size_t>((*element.free)[i]);
        for (std::size_t c = 0; c < static_cast<std::size_t>(element.blocks.columns); ++c)
            for (std::size_t axis = 0; axis < 3; ++axis)
                out[4 * ((c / 4 * 3 + axis) * n + v) + c % 4] = convert(entries(block, c, lane + axis * kVertexBlock));
    });
    return out;
}

Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> linearOf(const AffineFloat& a) {
    return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(a.linear);
}
Vector3f shiftOf(const AffineFloat& a) { return Eigen::Map<const Vector3f>(a.shift); }

void writeRows(const AffineFloat& a, float* to) {
    for (int row = 0; row < 3; ++row) {
        std::copy_n(a.linear + 3 * row, 3, to + 4 * row);
        to[4 * row + 3] = a.shift[row];
    }
}

}  // namespace

Result<void> CardDeformer::prepare() {
    auto deform = Program::feedback("deform.vert", {"point"});
    if (!deform) return tl::unexpected(deform.error());
    auto dress = Program::feedback("dress.vert", {"displayPosition", "displayNormal"});
    if (!dress) return tl::unexpected(dress.error());
    if (!nowhere_.resize(1, 1, GL_RGBA8, 0)) return fail("no-opengl", "The graphics driver has no memory for a single pixel: close other programs, or restart.");
    deform_ = std::move(*deform);
    dress_ = std::move(*dress);
    deform_.use();
    deform_.set("response", int(kResponse));
    deform_.set("integerResponse", int(kIntegerResponse));
    deform_.set("shapes", int(kShapes));
    dress_.use();
    dress_.set("points", int(kPoints));
    dress_.set("stencils", int(kStencils));
    dress_.set("stencilParts", int(kStencilParts));
    dress_.set("corners", int(kCorners));
    glUseProgram(0);
    return {};
}

void CardDeformer::forget() {
    id_ = 0;
    taken_ = false;
    parts_.clear();
    normalOf_.clear();
    for (Buffer* buffer : {&points_, &stencils_, &stencilParts_}) *buffer = {};
    for (TextureName* texture : {&pointsTexture_, &stencilsTexture_, &stencilPartsTexture_}) *texture = {};
}

bool CardDeformer::take(const SurfaceRecipe& recipe) {
    if (id_ == recipe.id) return taken_;
    forget();
    id_ = recipe.id;
    GLint texels = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    while (glGetError() != GL_NO_ERROR) {}
    parts_.resize(recipe.elements.size());
    std::int64_t total = 0;
    for (std::size_t e = 0; e < parts_.size(); ++e) {
        const auto& element = recipe.elements[e];
        Part& part = parts_[e];
        part.first = static_cast<int>(total);
        part.vertices = element.vertices;
        part.faces = element.faces;
        part.quads = fours(element.blocks.columns);
        part.shapeQuads = fours(static_cast<int>(element.shapes.rows()));
        part.fits = element.possible && part.quads + part.faces * (4 + 3 * part.shapeQuads) <= kMostNumbers &&
                    std::int64_t{3} * part.quads * part.vertices <= texels;
        if (!part.fits) part.quads = part.shapeQuads = 0;
        // Its normals inside joints are uploaded all the same.
        if (4 * part.faces > kMostNumbers) return false;
        total += element.vertices;
    }
    if (total > texels || total == 0) return false;
    for (std::size_t e = 0; e < parts_.size(); ++e) takeElement(recipe.elements[e], parts_[e]);
    takeNormals(recipe);
    points_ = render::makeBuffer();
    glBindBuffer(GL_TEXTURE_BUFFER, points_);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(total * 4 * static_cast<std::int64_t>(sizeof(float))), nullptr, GL_DYNAMIC_COPY);
    pointsTexture_ = bufferTexture(GL_RGBA32F, points_);
    glBindBuffer(GL_TEXTURE_BUFFER, 0);
    unbind();
    taken_ = glGetError() == GL_NO_ERROR;
    if (!taken_) {
        forget();
        id_ = recipe.id;
    }
    return taken_;
}

void CardDeformer::takeElement(const SurfaceRecipe::Element& element, Part& part) const {
    part.numbers.resize(4 * static_cast<std::size_t>(kHeader + part.quads + part.faces * (4 + 3 * part.shapeQuads)));
    // As large as the block in the shader, whatever is used of it.
    part.drive = makeBuffer(GL_UNIFORM_BUFFER, std::vector<float>(4 * (kHeader + kMostNumbers), 0.0f), GL_DYNAMIC_DRAW);
    glBindBuffer(GL_UNIFORM_BUFFER, 0);
    if (!part.fits) return;
    const auto n = static_cast<std::size_t>(part.vertices);
    std::vector<float> rest(3 * n, 0.0f);
    std::vector<std::int32_t> held(2 * n, -1);
    eachFree(element, [&](std::size_t i, std::size_t block, std::size_t lane) {
        Eigen::Map<Vector3f>(rest.data() + 3 * static_cast<std::size_t>((*element.free)[i])) = restOf(element, block, lane);
    });
    const auto shapes = static_cast<std::size_t>(element.shapes.rows());
    std::vector<float> shapesOf(std::max<std::size_t>(4 * static_cast<std::size_t>(part.shapeQuads) * element.held.size(), 4), 0.0f);
    std::vector<int> met(static_cast<std::size_t>(part.faces), 0), heldBy(met);
    for (const auto& h : element.held) ++heldBy[static_cast<std::size_t>(h.face)];
    for (std::size_t i = 0; i < element.held.size(); ++i) {
        const auto& h = element.held[i];
        const auto v = static_cast<std::size_t>(h.vertex), f = static_cast<std::size_t>(h.face);
        Eigen::Map<Vector3f>(rest.data() + 3 * v) = h.rest;
        held[2 * v] = h.face;
        held[2 * v + 1] = static_cast<std::int32_t>(i);
        for (std::size_t k = 0; k < shapes; ++k)
            shapesOf[4 * static_cast<std::size_t>(part.shapeQuads) * i + k] = element.shapes(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i));
        if (met[f]++ % (1 + heldBy[f] / static_cast<int>(kSomeHeld)) == 0) part.someHeld.push_back(static_cast<int>(i));
    }
    part.vertexArray = makeVertexArray();
    glBindVertexArray(part.vertexArray);
    part.rest = makeBuffer(GL_ARRAY_BUFFER, rest);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    part.held = makeBuffer(GL_ARRAY_BUFFER, held);
    glEnableVertexAttribArray(1);
    glVertexAttribIPointer(1, 2, GL_INT, 0, nullptr);
    glBindVertexArray(0);

    part.integers = element.blocks.format == ResponseFormat::Int16;
    const int quads = std::max(part.quads, 1);  // never an empty buffer
    switch (element.blocks.format) {
        case ResponseFormat::Float:
            part.response = makeBuffer(GL_TEXTURE_BUFFER, inFours<float>(element, quads, [](float x) { return x; }));
            part.responseTexture = bufferTexture(GL_RGBA32F, part.response);
            break;
        case ResponseFormat::Half:
            part.response = makeBuffer(GL_TEXTURE_BUFFER, inFours<Eigen::half>(element, quads, [](float x) { return Eigen::half(x); }));
            part.responseTexture = bufferTexture(GL_RGBA16F, part.response);
            break;
        case ResponseFormat::Int16:
            part.response = makeBuffer(GL_TEXTURE_BUFFER, inFours<std::int16_t>(element, quads, [](float x) { return static_cast<std::int16_t>(x); }));
            part.responseTexture = bufferTexture(GL_RGBA16I, part.response);
            break;
    }
    part.shapes = makeBuffer(GL_TEXTURE_BUFFER, shapesOf);
    part.shapesTexture = bufferTexture(GL_RGBA32F, part.shapes);

    // Clusters: halves of halves along the longest side.
    std::vector<std::size_t> order(element.free->size()), blockOf(order.size()), laneOf(order.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    eachFree(element, [&](std::size_t i, std::size_t block, std::size_t lane) { blockOf[i] = block, laneOf[i] = lane; });
    const auto at = [&](std::size_t i) { return restOf(element, blockOf[i], laneOf[i]); };
    const std::size_t most = std::max<std::size_t>(order.size() / kClusters, 1);
    const Entries entries(element.blocks);
    const Eigen::Index modes = element.blocks.columns;
    const auto split = [&](const auto& self, std::size_t begin, std::size_t end) -> void {
        Eigen::AlignedBox3f box;
        for (std::size_t i = begin; i < end; ++i) box.extend(at(order[i]));
        if (end - begin > most) {
            Eigen::Index axis = 0;
            box.sizes().maxCoeff(&axis);
            const std::size_t middle = (begin + end) / 2;
            std::nth_element(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(middle),
                             order.begin() + static_cast<std::ptrdiff_t>(end), [&](std::size_t a, std::size_t b) { return at(a)[axis] < at(b)[axis]; });
            self(self, begin, middle);
            self(self, middle, end);
            return;
        }
        Cluster cluster{box, Vector3f::Zero(), Eigen::Matrix3Xf(3, modes), Eigen::Matrix3Xf(3, modes), Eigen::Matrix3Xf::Zero(3, modes)};
        Eigen::Matrix3Xf low = Eigen::Matrix3Xf::Constant(3, modes, std::numeric_limits<float>::max()), high = -low;
        const float share = 1.0f / static_cast<float>(end - begin);
        for (std::size_t i = begin; i < end; ++i) {
            cluster.mean += share * at(order[i]);
            for (Eigen::Index c = 0; c < modes; ++c) {
                const std::size_t block = blockOf[order[i]], lane = laneOf[order[i]], column = static_cast<std::size_t>(c);
                const Vector3f a(entries(block, column, lane), entries(block, column, lane + kVertexBlock), entries(block, column, lane + 2 * kVertexBlock));
                low.col(c) = low.col(c).cwiseMin(a);
                high.col(c) = high.col(c).cwiseMax(a);
                cluster.meanOf.col(c) += share * a;
            }
        }
        cluster.middleOf = 0.5f * (low + high);
        cluster.halfOf = 0.5f * (high - low);
        part.clusters.push_back(std::move(cluster));
    };
    if (!order.empty()) split(split, 0, order.size());
}

void CardDeformer::takeNormals(const SurfaceRecipe& recipe) {
    std::vector<std::int32_t> stencils;
    std::vector<float> parts;
    normalOf_.clear();
    for (std::size_t e = 0; e < parts_.size(); ++e) {
        const auto& element = recipe.elements[e];
        const std::int32_t first = parts_[e].first;
        for (std::int32_t v = 0; v < element.vertices; ++v) {
            const NormalStencil& s = element.stencils[v];
            stencils.insert(stencils.end(), {first + s.a, first + s.b, first + s.c, first + s.d});
            parts.insert(parts.end(), {s.part[0], s.part[1], element.scale, 0.0f});
            normalOf_.push_back({first + v, kStencil, 0, 0, 0.0f});
        }
        for (const auto& h : element.hidden) normalOf_[static_cast<std::size_t>(first + h.vertex)] = {first + h.vertex, kHidden, h.face, 0, 0.0f};
    }
    for (const auto& s : recipe.seams) {
        Part& part = parts_[static_cast<std::size_t>(s.element)];
        const std::int32_t other = parts_[static_cast<std::size_t>(s.other)].first;
        normalOf_[static_cast<std::size_t>(part.first + s.vertex)] = {part.first + s.vertex, kSeam, other + s.from, other + s.to, s.part};
        if (std::find(part.neighbours.begin(), part.neighbours.end(), s.other) == part.neighbours.end()) part.neighbours.push_back(s.other);
    }
    stencils_ = makeBuffer(GL_TEXTURE_BUFFER, stencils);
    stencilsTexture_ = bufferTexture(GL_RGBA32I, stencils_);
    stencilParts_ = makeBuffer(GL_TEXTURE_BUFFER, parts);
    stencilPartsTexture_ = bufferTexture(GL_RGBA32F, stencilParts_);
}

// ---- frame -----------------------------------------------------------------------------------------------------------

void CardDeformer::fillDrive(const SurfaceRecipe::Element& element, Part& part) {
    const auto& frame = element.frame;
    float* out = part.numbers.data();
    writeRows(frame.shape, out);
    writeRows(frame.placement, out + 12);
    const std::int32_t size[4] = {part.quads, part.vertices, part.shapeQuads, part.integers ? 1 : 0};
    std::memcpy(out + 24, size, sizeof size);
    out += 4 * kHeader;
    if (part.fits) std::copy(frame.weights.begin(), frame.weights.end(), out);
    out += 4 * part.quads;
    const auto shapes = part.fits ? static_cast<std::size_t>(element.shapes.rows()) : 0;
    for (std::size_t f = 0; f < static_cast<std::size_t>(part.faces); ++f, out += 16 + 12 * part.shapeQuads) {
        writeRows(frame.joints[f], out);
        std::copy_n(frame.faceNormals[f].data(), 3, out + 12);
        for (std::size_t k = 0; k < shapes; ++k)
            for (std::size_t axis = 0; axis < 3; ++axis) out[16 + 12 * (k / 4) + 4 * axis + k % 4] = frame.warping[(3 * f + axis) * shapes + k];
    }
    const auto bytes = part.numbers.size() * sizeof(float);
    glBindBuffer(GL_UNIFORM_BUFFER, part.drive);
    glBufferSubData(GL_UNIFORM_BUFFER, 0, static_cast<GLsizeiptr>(bytes), part.numbers.data());
    stats_.uploaded += bytes;
}

// Of each cluster: all places between the least and the greatest that its modes reach.
void CardDeformer::bound(const SurfaceRecipe::Element& element, Part& part) {
    part.bounds = {};
    const auto& frame = element.frame;
    const Matrix3f shape = linearOf(frame.shape), placed = linearOf(frame.placement);
    const Eigen::Map<const Eigen::VectorXf> weights(frame.weights.data(), static_cast<Eigen::Index>(frame.weights.size()));
    for (const Cluster& c : part.clusters) {
        const Vector3f offset = shiftOf(frame.shape) + c.middleOf * weights;
        const Vector3f middle = placed * (shape * c.rest.center() + offset) + shiftOf(frame.placement);
        const Vector3f half = placed.cwiseAbs() * (shape.cwiseAbs() * (0.5f * c.rest.sizes()) + c.halfOf * weights.cwiseAbs());
        part.bounds.holds.extend(middle - half);
        part.bounds.holds.extend(middle + half);
        part.bounds.about.extend(placed * (shape * c.mean + shiftOf(frame.shape) + c.meanOf * weights) + shiftOf(frame.placement));
    }
    const auto shapes = element.shapes.rows();
    const auto place = [&](std::size_t i) -> Vector3f {
        const auto& h = element.held[i];
        const auto f = static_cast<std::size_t>(h.face);
        Vector3f p = linearOf(frame.joints[f]) * h.rest + shiftOf(frame.joints[f]);
        if (shapes > 0)
            p += Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic, Eigen::RowMajor>>(frame.warping.data() + 3 * f * static_cast<std::size_t>(shapes), 3, shapes) *
                 element.shapes.col(static_cast<Eigen::Index>(i));
        return p;
    };
    for (std::size_t i = 0; i < element.held.size(); ++i) part.bounds.holds.extend(place(i));
    for (const int i : part.someHeld) part.bounds.about.extend(place(static_cast<std::size_t>(i)));
}

void CardDeformer::deform(const SurfaceRecipe& recipe) {
    stats_ = {};
    for (std::size_t e = 0; e < parts_.size(); ++e) {
        const auto& element = recipe.elements[e];
        Part& part = parts_[e];
        part.changed = part.fresh || part.revision != element.frame.revision;
        if (!part.changed) continue;
        part.fresh = false;
        part.revision = element.frame.revision;
        fillDrive(element, part);
        if (element.elsewhere && part.fits) {
            ++stats_.deformed;
            bound(element, part);
            continue;
        }
        ++stats_.copied;
        const auto n = static_cast<std::size_t>(part.vertices);
        staging_.resize(4 * n);
        part.bounds = {};
        for (std::size_t v = 0; v < n; ++v) {
            const Eigen::Map<const Vector3f> p(element.positions + 3 * v);
            Eigen::Map<Eigen::Vector4f>(staging_.data() + 4 * v) << p, 1.0f;
            part.bounds.holds.extend(p);
        }
        part.bounds.about = part.bounds.holds;
        glBindBuffer(GL_ARRAY_BUFFER, points_);
        glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(16 * static_cast<std::size_t>(part.first)), static_cast<GLsizeiptr>(16 * n), staging_.data());
        stats_.uploaded += 16 * n;
    }
    nowhere_.bind();
    deform_.use();
    for (std::size_t e = 0; e < parts_.size(); ++e) {
        const Part& part = parts_[e];
        if (!part.changed || !recipe.elements[e].elsewhere || !part.fits) continue;
        glBindBufferBase(GL_UNIFORM_BUFFER, 1, part.drive);
        bindBufferTexture(kResponse, part.integers ? 0 : GLuint(part.responseTexture));
        bindBufferTexture(kIntegerResponse, part.integers ? GLuint(part.responseTexture) : 0);
        bindBufferTexture(kShapes, part.shapesTexture);
        glBindVertexArray(part.vertexArray);
        feed(part.vertices, points_, 16 * static_cast<std::size_t>(part.first), 16 * static_cast<std::size_t>(part.vertices));
    }
    for (Part& part : parts_) {
        bool changed = part.changed;
        for (const int other : part.neighbours) changed = changed || parts_[static_cast<std::size_t>(other)].changed;
        if (changed) ++part.version;
    }
    unbind();
}

CardDeformer::Dress CardDeformer::makeDress(int element, const BodyGeometry& geometry, const std::vector<Neighbour>& neighbours) const {
    const std::int32_t first = parts_[static_cast<std::size_t>(element)].first;
    // Where the triangles of each group begin, and how many there are.
    std::vector<std::pair<std::int32_t, std::int32_t>> triangles;
    std::vector<std::int32_t> corners;
    std::vector<Source> sources;
    const auto add = [&corners](const BodyGeometry& from, int group, std::int32_t base) {
        for (const auto t : from.groupTriangles(group))
            for (int c = 0; c < 3; ++c) corners.push_back(base + from.triangles()(t, c));
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
        Source s = normalOf_[static_cast<std::size_t>(first + geometry.bodyVertex()[static_cast<std::size_t>(i)])];
        if (const int group = geometry.group(i); group >= 0) {
            const auto g = static_cast<std::size_t>(group);
            if (triangles.size() <= g) triangles.resize(g + 1, {-1, 0});
            if (triangles[g].first < 0) {
                const auto begin = static_cast<std::int32_t>(corners.size() / 3);
                add(geometry, group, first);
                if (g < welded.size())
                    for (const auto& [neighbour, other] : welded[g]) add(*neighbour->geometry, other, parts_[static_cast<std::size_t>(neighbour->element)].first);
                triangles[g] = {begin, static_cast<std::int32_t>(corners.size() / 3) - begin};
            }
            s.kind = kTriangles;
            s.one = triangles[g].first;
            s.two = triangles[g].second;
        }
        sources.push_back(s);
    }
    if (corners.empty()) corners.push_back(0);
    Dress out;
    out.count = geometry.vertexCount();
    out.vertexArray = makeVertexArray();
    glBindVertexArray(out.vertexArray);
    out.source = makeBuffer(GL_ARRAY_BUFFER, sources);
    glEnableVertexAttribArray(0);
    glVertexAttribIPointer(0, 4, GL_INT, sizeof(Source), nullptr);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, sizeof(Source), reinterpret_cast<const void*>(offsetof(Source, part)));
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    out.corners = makeBuffer(GL_TEXTURE_BUFFER, corners);
    out.cornersTexture = bufferTexture(GL_R32I, out.corners);
    glBindBuffer(GL_TEXTURE_BUFFER, 0);
    return out;
}

void CardDeformer::dress(int element, const Dress& dress, GLuint vertices) const {
    nowhere_.bind();
    dress_.use();
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, parts_[static_cast<std::size_t>(element)].drive);
    bindBufferTexture(kPoints, pointsTexture_);
    bindBufferTexture(kStencils, stencilsTexture_);
    bindBufferTexture(kStencilParts, stencilPartsTexture_);
    bindBufferTexture(kCorners, dress.cornersTexture);
    glBindVertexArray(dress.vertexArray);
    feed(dress.count, vertices, 0, static_cast<std::size_t>(dress.count) * BodyGeometry::kFloats * sizeof(float));
    unbind();
}

void CardDeformer::read(int element, int first, int count, float* positions) const {
    std::vector<float> four(4 * static_cast<std::size_t>(count));
    glBindBuffer(GL_ARRAY_BUFFER, points_);
    glGetBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(16) * (parts_[static_cast<std::size_t>(element)].first + first), static_cast<GLsizeiptr>(16) * count, four.data());
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) std::copy_n(&four[4 * i], 3, positions + 3 * i);
}

}  // namespace imomushi::render
