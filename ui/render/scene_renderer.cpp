// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/scene_renderer.h"

#include <epoxy/gl.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "ui/render/body_geometry.h"
#include "ui/render/card_deformer.h"
#include "ui/render/gl.h"
#include "ui/render/image.h"
#include "ui/render/marker_geometry.h"

namespace imomushi::render {

namespace {

using Eigen::Matrix4f;
using Eigen::Vector2f;
using Eigen::Vector3f;
using Eigen::Vector4f;

/// shaders/frame.glsl, std140.
struct FrameBlock {
    Matrix4f viewProjection, view, shadow;
    Vector4f eye, forward, keyDirection, viewport, sphere, ground, patchArea, lines, projection, right, above;
};

// The key light: from the left, above and in front, so that the three-quarter view from the right shows light and shade.
const Vec3 kKeyDirection = Vec3(-0.42, 0.86, 0.52).normalized();
// Radius of the shadow's penumbra relative to the width of the shadow map.
constexpr float kPenumbra = 0.007f;
// How far along its normal a point is moved before it is looked up in the shadow map, in scene radii: more than the facets of a coarse mesh lie
// beside the smooth surface they stand for, less than anything that casts a shadow of its own.
constexpr double kShadowOffset = 0.009;
// How far the shadow map reaches along the light, in scene radii behind the centre: the ground below a raised character.
constexpr double kShadowDepth = 3.0;
constexpr int kSamples = 4;

struct GpuBody {
    std::shared_ptr<const ElementMesh> mesh;
    std::shared_ptr<const std::vector<std::int32_t>> covered;
    std::unique_ptr<BodyGeometry> geometry;
    VertexArray vertexArray;
    Buffer vertices, look, indices, marked;
    std::vector<std::int32_t> markedTriangles;
    std::vector<std::uint32_t> markedIndices;
    std::vector<TextureName> textures;  ///< 0: could not be decoded
    std::vector<float> staging;
    std::uint64_t revision = 0;
    const float* positions = nullptr;
    Vector3f low = Vector3f::Zero(), high = Vector3f::Zero();
    Eigen::AlignedBox3d about;  ///< the same box; of the card's bodies, whose `low` and `high` lie a little outside, a closer one
    int element = -1;           ///< of the recipe, where the card makes it
    std::uint64_t recipe = 0, version = 0;
    CardDeformer::Dress dress;
    /// What the dress was made for.
    std::vector<std::pair<const void*, const BodyGeometry*>> seams;
    bool fresh = true;    ///< never filled
    bool changed = false; ///< in this frame
    bool welded = false;  ///< a seam touches it
    bool used = false;    ///< in this frame
};

TextureName makeTexture(const Texture& texture) {
    const auto image = decodeImage(texture.bytes);
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

class Renderer final : public SceneRenderer {
public:
    Result<void> prepare();
    void draw(const Scene& scene, unsigned target, int width, int height) override;
    Pick pick(const Scene& scene, int width, int height, int x, int y) override;
    bool take(const SurfaceRecipe& recipe) override;
    bool deforms(int element) const override { return deformer_.fits(element); }
    bool software() const override { return software_; }
    void forget() override;

private:
    void takeBodies(const Scene& scene);
    void dressBodies(const Scene& scene);
    void dressBody(const Scene& scene, std::size_t i);
    void makeBody(const Body& body, GpuBody& gpu);
    void fillBody(const Body& body, GpuBody& gpu);
    void setFrame(const Scene& scene, int width, int height);
    void drawShadows(const Scene& scene);
    void drawSurface(const Scene& scene);
    void scissor(const Target& target) const;
    void drawBody(const Scene& scene, std::size_t i, bool depthOnly);
    void drawMarkers(const Scene& scene, int height);
    void drawOutlines(const Scene& scene, unsigned target, int width, int height);
    void drawAll(const GpuBody& gpu) const {
        glBindVertexArray(gpu.vertexArray);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(gpu.geometry->indices().size()), GL_UNSIGNED_INT, nullptr);
    }
    void fullscreen() const {
        glBindVertexArray(empty_);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    static void bindTexture(int unit, GLuint texture) {
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        glBindTexture(GL_TEXTURE_2D, texture);
    }

    // Texels a side; shadows on the ground are soft.
    [[nodiscard]] int groundShade() const { return software_ ? 160 : 256; }
    [[nodiscard]] int shadowSize() const { return software_ ? 768 : 2048; }
    bool software_ = false;  ///< no graphics card: cheaper shadows and occlusion
    Program body_, shadow_, surface_, mask_, identity_, marked_, height_, groundShadow_, blur_, occlusion_, occlusionBlur_, solid_,
        line_, point_, compose_, outline_;
    Buffer frame_, solidBuffer_, lineBuffer_, pointBuffer_;
    VertexArray empty_, solidArray_, lineArray_, pointArray_;
    GLuint compareSampler_ = 0, rawSampler_ = 0;
    Target picture_, resolved_, shadowMap_, shade_, shadeSwap_, surfaceMap_, occlusionMap_, occlusionSwap_, maskSamples_, maskMap_, pickTarget_;

    CardDeformer deformer_;
    std::map<std::pair<std::uint64_t, int>, GpuBody> bodies_;
    std::vector<GpuBody*> drawn_;  ///< of scene.bodies; null: nothing to draw
    MarkerGeometry markers_;
    FrameBlock block_;
    Vec3 centre_ = Vec3::Zero();
    double radius_ = 1.0;
    Eigen::AlignedBox2f box_;  ///< what bodies and markers cover of the picture, 0...1 from the lower left
    std::vector<std::size_t> order_;  ///< bodies, nearest first
    std::uint64_t shadowStamp_ = 0;
    Matrix4f heightTransform_;

public:
    ~Renderer() override {
        glDeleteSamplers(1, &compareSampler_);
        glDeleteSamplers(1, &rawSampler_);
    }
};

void instanced(GLuint location, int size, std::size_t stride, std::size_t offset, GLuint divisor) {
    glEnableVertexAttribArray(location);
    glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride), reinterpret_cast<const void*>(offset));
    glVertexAttribDivisor(location, divisor);
}

Result<void> Renderer::prepare() {
    const char* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    const std::string renderer = name ? name : "";
    software_ = renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos || renderer.find("swrast") != std::string::npos;

    struct Wanted {
        Program* program;
        const char *vertex, *fragment;
    };
    for (const Wanted& w : std::initializer_list<Wanted>{{&body_, "body.vert", "body.frag"},
                                                         {&shadow_, "body.vert", "depth.frag"},
                                                         {&surface_, "body.vert", "surface.frag"},
                                                         {&mask_, "body.vert", "flat.frag"},
                                                         {&identity_, "body.vert", "identity.frag"},
                                                         {&marked_, "body.vert", "marked.frag"},
                                                         {&height_, "body.vert", "height.frag"},
                                                         {&groundShadow_, "fullscreen.vert", "ground_shadow.frag"},
                                                         {&blur_, "fullscreen.vert", "blur.frag"},
                                                         {&occlusion_, "fullscreen.vert", "occlusion.frag"},
                                                         {&occlusionBlur_, "fullscreen.vert", "occlusion_blur.frag"},
                                                         {&solid_, "solid.vert", "solid.frag"},
                                                         {&line_, "line.vert", "line.frag"},
                                                         {&point_, "point.vert", "point.frag"},
                                                         {&compose_, "fullscreen.vert", "compose.frag"},
                                                         {&outline_, "fullscreen.vert", "outline.frag"}}) {
        auto program = Program::link(w.vertex, w.fragment);
        if (!program) return tl::unexpected(program.error());
        *w.program = std::move(*program);
    }

    if (auto ready = deformer_.prepare(); !ready) return ready;

    frame_ = makeBuffer();
    glBindBuffer(GL_UNIFORM_BUFFER, frame_);
    glBufferData(GL_UNIFORM_BUFFER, sizeof(FrameBlock), nullptr, GL_DYNAMIC_DRAW);
    empty_ = makeVertexArray();

    solidArray_ = makeVertexArray();
    solidBuffer_ = makeBuffer();
    glBindVertexArray(solidArray_);
    glBindBuffer(GL_ARRAY_BUFFER, solidBuffer_);
    instanced(0, 3, sizeof(SolidVertex), offsetof(SolidVertex, position), 0);
    instanced(1, 3, sizeof(SolidVertex), offsetof(SolidVertex, normal), 0);
    instanced(2, 4, sizeof(SolidVertex), offsetof(SolidVertex, color), 0);
    instanced(3, 1, sizeof(SolidVertex), offsetof(SolidVertex, behind), 0);

    lineArray_ = makeVertexArray();
    lineBuffer_ = makeBuffer();
    glBindVertexArray(lineArray_);
    glBindBuffer(GL_ARRAY_BUFFER, lineBuffer_);
    instanced(0, 3, sizeof(LineSegment), offsetof(LineSegment, before), 1);
    instanced(1, 3, sizeof(LineSegment), offsetof(LineSegment, from), 1);
    instanced(2, 3, sizeof(LineSegment), offsetof(LineSegment, to), 1);
    instanced(3, 3, sizeof(LineSegment), offsetof(LineSegment, after), 1);
    instanced(4, 4, sizeof(LineSegment), offsetof(LineSegment, color), 1);
    instanced(5, 3, sizeof(LineSegment), offsetof(LineSegment, widths), 1);

    pointArray_ = makeVertexArray();
    pointBuffer_ = makeBuffer();
    glBindVertexArray(pointArray_);
    glBindBuffer(GL_ARRAY_BUFFER, pointBuffer_);
    instanced(0, 3, sizeof(PointSprite), offsetof(PointSprite, centre), 1);
    instanced(1, 3, sizeof(PointSprite), offsetof(PointSprite, shape), 1);
    instanced(2, 4, sizeof(PointSprite), offsetof(PointSprite, color), 1);
    glBindVertexArray(0);

    glGenSamplers(1, &compareSampler_);
    glSamplerParameteri(compareSampler_, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(compareSampler_, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glSamplerParameteri(compareSampler_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glSamplerParameteri(compareSampler_, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glGenSamplers(1, &rawSampler_);
    glSamplerParameteri(rawSampler_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glSamplerParameteri(rawSampler_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    const float one[4] = {1, 1, 1, 1};
    for (const GLuint sampler : {compareSampler_, rawSampler_}) {
        glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
        glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
        glSamplerParameterfv(sampler, GL_TEXTURE_BORDER_COLOR, one);
    }
    if (glGetError() != GL_NO_ERROR) return fail("no-opengl", "The graphics driver does not do what OpenGL 3.3 asks for: update it.");
    return {};
}

// ---- bodies ----------------------------------------------------------------------------------------------------------

void Renderer::makeBody(const Body& body, GpuBody& gpu) {
    gpu = GpuBody();
    gpu.mesh = body.mesh;
    gpu.covered = body.coveredTriangles;
    gpu.geometry = std::make_unique<BodyGeometry>(*body.mesh, body.coveredTriangles.get());
    const BodyGeometry& g = *gpu.geometry;
    gpu.staging.resize(std::size_t(g.vertexCount()) * BodyGeometry::kFloats);

    // Texture coordinates and colours never change.
    const Look& look = body.mesh->look;
    const bool coords = look.texCoords.rows() == static_cast<Eigen::Index>(look.bodyVertex.size());
    const bool colors = look.colors.rows() == static_cast<Eigen::Index>(look.bodyVertex.size());
    std::vector<float> fixed(std::size_t(g.vertexCount()) * 6);
    for (int i = 0; i < g.vertexCount(); ++i) {
        const int v = g.lookVertex()[i];
        float* out = &fixed[6 * std::size_t(i)];
        out[0] = coords && v >= 0 ? look.texCoords(v, 0) : 0.0f;
        out[1] = coords && v >= 0 ? look.texCoords(v, 1) : 0.0f;
        for (int c = 0; c < 4; ++c) {
            const float value = colors && v >= 0 ? look.colors(v, c) : 1.0f;
            out[2 + c] = std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 1.0f;
        }
    }
    gpu.vertexArray = makeVertexArray();
    glBindVertexArray(gpu.vertexArray);
    gpu.vertices = makeBuffer();
    glBindBuffer(GL_ARRAY_BUFFER, gpu.vertices);
    instanced(0, 3, BodyGeometry::kFloats * sizeof(float), 0, 0);
    instanced(1, 3, BodyGeometry::kFloats * sizeof(float), 3 * sizeof(float), 0);
    gpu.look = makeBuffer();
    glBindBuffer(GL_ARRAY_BUFFER, gpu.look);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(fixed.size() * sizeof(float)), fixed.data(), GL_STATIC_DRAW);
    instanced(2, 2, 6 * sizeof(float), 0, 0);
    instanced(3, 4, 6 * sizeof(float), 2 * sizeof(float), 0);
    gpu.indices = makeBuffer();
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(g.indices().size() * sizeof(std::uint32_t)), g.indices().data(), GL_STATIC_DRAW);
    gpu.marked = makeBuffer();
    glBindVertexArray(0);
    for (const Texture& t : look.textures) gpu.textures.push_back(makeTexture(t));
    glBindTexture(GL_TEXTURE_2D, 0);
}

void Renderer::fillBody(const Body& body, GpuBody& gpu) {
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
        gpu.about = Eigen::AlignedBox3d(gpu.low.cast<double>(), gpu.high.cast<double>());
    }
}

bool Renderer::take(const SurfaceRecipe& recipe) {
    const NoFloatingPointTraps quiet;
    return deformer_.take(recipe);
}

/// Bodies that the card makes.
void Renderer::dressBodies(const Scene& scene) {
    if (!scene.recipe || deformer_.id() != scene.recipe->id) return;
    deformer_.deform(*scene.recipe);
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        if (!drawn_[i] || drawn_[i]->element < 0) continue;
        GpuBody& gpu = *drawn_[i];
        const std::uint64_t version = deformer_.version(gpu.element);
        gpu.changed = gpu.fresh || gpu.recipe != scene.recipe->id || gpu.version != version;
        if (gpu.fresh || gpu.recipe != scene.recipe->id) gpu.dress = {};
        gpu.recipe = scene.recipe->id;
        gpu.version = version;
        dressBody(scene, i);
        const auto& bounds = deformer_.bounds(gpu.element);
        gpu.low = bounds.holds.min();
        gpu.high = bounds.holds.max();
        gpu.about = bounds.about.cast<double>();
        gpu.fresh = false;
    }
}

void Renderer::dressBody(const Scene& scene, std::size_t i) {
    GpuBody& gpu = *drawn_[i];
    const auto bodyAt = [&](int b) { return b >= 0 && b < static_cast<int>(drawn_.size()) ? drawn_[static_cast<std::size_t>(b)] : nullptr; };
    // The normals of hard edges depend on the bodies that are welded to it, and these are few: made anew when one is another than before.
    const auto eachSeam = [&](const auto& act) {
        for (const Seam& seam : scene.seams)
            for (const bool first : {true, false}) {
                if (static_cast<std::size_t>(first ? seam.a : seam.b) != i || !seam.welded) continue;
                const GpuBody* other = bodyAt(first ? seam.b : seam.a);
                if (other && other->element >= 0) act(seam, *other, first);
            }
    };
    std::size_t n = 0;
    bool same = gpu.dress.count > 0;
    eachSeam([&](const Seam& seam, const GpuBody& other, bool) {
        same = same && n < gpu.seams.size() && gpu.seams[n] == std::pair(static_cast<const void*>(seam.welded.get()), static_cast<const BodyGeometry*>(other.geometry.get()));
        ++n;
    });
    if (!same || n != gpu.seams.size()) {
        gpu.seams.clear();
        std::vector<CardDeformer::Neighbour> neighbours;
        eachSeam([&](const Seam& seam, const GpuBody& other, bool first) {
            gpu.seams.emplace_back(seam.welded.get(), other.geometry.get());
            neighbours.push_back({other.geometry.get(), other.element, *seam.welded});
            if (!first)
                for (auto& [own, its] : neighbours.back().welded) std::swap(own, its);
        });
        gpu.dress = deformer_.makeDress(gpu.element, *gpu.geometry, neighbours);
        gpu.changed = true;
    }
    if (!gpu.changed) return;
    glBindBuffer(GL_ARRAY_BUFFER, gpu.vertices);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(gpu.staging.size() * sizeof(float)), nullptr, GL_DYNAMIC_COPY);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    deformer_.dress(gpu.element, gpu.dress, gpu.vertices);
}

void Renderer::takeBodies(const Scene& scene) {
    for (auto& [key, gpu] : bodies_) gpu.used = gpu.welded = false;
    drawn_.clear();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Body& body = scene.bodies[i];
        const int element = scene.recipe && deformer_.id() == scene.recipe->id ? body.recipeElement : -1;
        if (!body.mesh || (!body.positions && element < 0) || body.mesh->body.triangles.rows() == 0) {
            drawn_.push_back(nullptr);
            continue;
        }
        int copies = 0;
        for (std::size_t j = 0; j < i; ++j) copies += scene.bodies[j].id == body.id;
        GpuBody& gpu = bodies_[{body.id, copies}];
        if (gpu.mesh != body.mesh || gpu.covered != body.coveredTriangles) makeBody(body, gpu);
        gpu.used = true;
        if (gpu.element != element) gpu.fresh = true;
        gpu.element = element;
        gpu.changed = gpu.fresh || gpu.revision != body.revision || gpu.positions != body.positions;
        gpu.revision = body.revision;
        gpu.positions = body.positions;
        drawn_.push_back(&gpu);
    }
    std::erase_if(bodies_, [](const auto& entry) { return !entry.second.used; });
    dressBodies(scene);

    // Normals across a seam depend on both sides, so a body is filled again when a neighbour changed.
    const auto bodyAt = [&](int i) { return i >= 0 && i < static_cast<int>(drawn_.size()) && drawn_[i] && drawn_[i]->element < 0 ? drawn_[i] : nullptr; };
    for (const Seam& seam : scene.seams) {
        GpuBody *a = bodyAt(seam.a), *b = bodyAt(seam.b);
        if (a && b && (a->changed || b->changed)) a->welded = b->welded = true;
    }
    for (std::size_t i = 0; i < drawn_.size(); ++i)
        if (drawn_[i] && drawn_[i]->element < 0 && (drawn_[i]->changed || drawn_[i]->welded)) drawn_[i]->geometry->sumNormals(scene.bodies[i].positions);
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
    for (std::size_t i = 0; i < drawn_.size(); ++i)
        if (drawn_[i] && drawn_[i]->element < 0 && (drawn_[i]->changed || drawn_[i]->welded)) {
            fillBody(scene.bodies[i], *drawn_[i]);
            drawn_[i]->fresh = false;
        }

    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        if (!drawn_[i]) continue;
        GpuBody& gpu = *drawn_[i];
        const std::vector<std::int32_t>* wanted = scene.bodies[i].markedTriangles;
        if (wanted ? gpu.markedTriangles == *wanted : gpu.markedTriangles.empty()) continue;
        gpu.markedTriangles = wanted ? *wanted : std::vector<std::int32_t>();
        gpu.markedIndices.clear();
        for (const std::int32_t f : gpu.markedTriangles)
            if (f >= 0 && f < gpu.mesh->body.triangles.rows()) gpu.markedIndices.insert(gpu.markedIndices.end(), gpu.geometry->corners(f), gpu.geometry->corners(f) + 3);
        glBindVertexArray(0);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.marked);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(gpu.markedIndices.size() * sizeof(std::uint32_t)), gpu.markedIndices.data(), GL_DYNAMIC_DRAW);
    }
}

// ---- frame -----------------------------------------------------------------------------------------------------------

Matrix4f orthographic(const Vec3& centre, const Vec3& towardsLight, const Vec3& up, double halfWidth, double before, double behind) {
    const Vec3 back = towardsLight.normalized(), right = up.cross(back).normalized(), above = back.cross(right);
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.block<1, 3>(0, 0) = right.transpose() / halfWidth;
    m.block<1, 3>(1, 0) = above.transpose() / halfWidth;
    m.block<1, 3>(2, 0) = -2.0 / (before + behind) * back.transpose();
    m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * centre;
    m(2, 3) += (before - behind) / (before + behind);
    return m.cast<float>();
}

void Renderer::setFrame(const Scene& scene, int width, int height) {
    Eigen::AlignedBox3d box;
    for (const GpuBody* gpu : drawn_)
        if (gpu) box.extend(gpu->about);
    if (box.isEmpty())
        for (const Marker& m : scene.markers) box.extend(m.from);
    if (box.isEmpty()) box = Eigen::AlignedBox3d(Vec3(-1, scene.ground, -1), Vec3(1, scene.ground + 1, 1));
    centre_ = box.center();
    radius_ = std::max(0.5 * box.diagonal().norm(), 1e-6);

    const Camera& camera = scene.camera;
    const double distance = (camera.eye - camera.target).norm();
    const double reach = camera.orthographic ? camera.orthoHeight : distance;
    const double fadeRadius = 5.0 * radius_ + 2.5 * reach;
    const Eigen::Matrix4d view = camera.view();
    const double aspect = static_cast<double>(width) / height;
    double held = radius_;
    for (const GpuBody* gpu : drawn_)
        if (gpu && gpu->element >= 0) held = std::max(held, (gpu->high.cast<double>() - centre_).cwiseMax(centre_ - gpu->low.cast<double>()).norm());
    for (const Marker& m : scene.markers) held = std::max({held, (m.from - centre_).norm() * 1.2, (m.to - centre_).norm() * 1.2});
    const Eigen::Matrix4d projection = camera.projection(aspect, centre_, held);

    FrameBlock& b = block_;
    b.view = view.cast<float>();
    b.viewProjection = (projection * view).cast<float>();
    // The light's up axis: anything but its own direction.
    b.shadow = orthographic(centre_, kKeyDirection, Vec3::UnitZ(), radius_ * 1.02, radius_ * 1.02, radius_ * kShadowDepth);
    const Vec3 forward = -view.block<1, 3>(2, 0).transpose();
    b.eye << camera.eye.cast<float>(), camera.orthographic ? 1.0f : 0.0f;
    b.forward << forward.cast<float>(), scene.pixelRatio;
    b.keyDirection << kKeyDirection.cast<float>(), kPenumbra;
    b.viewport << static_cast<float>(width), static_cast<float>(height), 1.0f / static_cast<float>(width), 1.0f / static_cast<float>(height);
    b.sphere << centre_.cast<float>(), static_cast<float>(radius_);
    b.ground << static_cast<float>(scene.ground), scene.grid ? 1.0f : 0.0f, scene.groundShadow ? 1.0f : 0.0f, scene.darkTheme ? 1.0f : 0.0f;
    // The shadow of the highest point falls this far beside the character.
    const double top = std::max(centre_.y() + radius_ - scene.ground, 0.0);
    const double cast = std::min(top / kKeyDirection.y(), 3.0 * radius_);
    const Vec3 middle = centre_ - 0.5 * cast * kKeyDirection;
    b.patchArea << static_cast<float>(middle.x()), static_cast<float>(middle.z()), static_cast<float>(1.25 * radius_ + 0.5 * cast), static_cast<float>(0.35 * radius_);
    heightTransform_ = orthographic(Vec3(middle.x(), scene.ground, middle.z()), -Vec3::UnitY(), Vec3::UnitZ(), 1.25 * radius_ + 0.5 * cast,
                                    radius_ * 2.0, b.patchArea.w());
    const double decade = std::log10(std::max(reach * 0.5, 1e-6));
    const double whole = std::floor(decade), fine = std::pow(10.0, whole - 1.0);
    b.lines << static_cast<float>(fine), static_cast<float>(10.0 * fine), static_cast<float>(decade - whole), static_cast<float>(fadeRadius);
    const double h = camera.orthographic ? 0.5 * camera.orthoHeight : std::tan(0.5 * camera.fov);
    b.projection << static_cast<float>(h * aspect), static_cast<float>(h), static_cast<float>(kShadowOffset * radius_), 0.0f;

    b.right << view.block<1, 3>(0, 0).transpose().cast<float>(), scene.solidGround ? 1.0f : 0.0f;
    b.above << view.block<1, 3>(1, 0).transpose().cast<float>(), 0.0f;

    box_.setEmpty();
    const auto cover = [&](const Vec3& low, const Vec3& high, double pixels) {
        for (int k = 0; k < 8; ++k) {
            const Vec3 p((k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z());
            const Eigen::Vector4d c = projection * view * p.homogeneous();
            if (c.w() < 1e-3 * radius_ && !camera.orthographic) {
                box_ = Eigen::AlignedBox2f(Vector2f::Zero(), Vector2f::Ones());
                return;
            }
            const Eigen::Vector2d s = c.head<2>() / c.w() * 0.5 + Eigen::Vector2d(0.5, 0.5), margin(pixels / width, pixels / height);
            box_.extend((s - margin).cast<float>());
            box_.extend((s + margin).cast<float>());
        }
    };
    order_.clear();
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        if (!drawn_[i]) continue;
        cover(drawn_[i]->low.cast<double>(), drawn_[i]->high.cast<double>(), 1.0);
        order_.push_back(i);
    }
    const auto near = [&](std::size_t i) { return forward.cast<float>().dot(drawn_[i]->low + drawn_[i]->high); };
    std::sort(order_.begin(), order_.end(), [&](std::size_t i, std::size_t j) { return std::pair(near(i), i) < std::pair(near(j), j); });
    for (const Marker& m : scene.markers) {
        const double length = (m.to - m.from).norm();
        const Vec3 r = Vec3::Constant(m.shape == Marker::Shape::Bone ? 0.1 * length : m.shape == Marker::Shape::PlaneGizmo ? 1.5 * length : 0.0);
        const double pixels = 24.0 * scene.pixelRatio;
        if (m.shape == Marker::Shape::FaceOutline)
            for (const Vec3& p : m.outline) cover(p, p, pixels);
        else if (m.shape == Marker::Shape::Bone || m.shape == Marker::Shape::PlaneGizmo || m.shape == Marker::Shape::Axis)
            cover(m.from.cwiseMin(m.to) - r, m.from.cwiseMax(m.to) + r, pixels);
        else
            cover(m.from, m.from, pixels);
    }
    box_ = box_.intersection(Eigen::AlignedBox2f(Vector2f::Zero(), Vector2f::Ones()));
    if (box_.isEmpty()) box_ = Eigen::AlignedBox2f(Vector2f::Zero(), Vector2f::Zero());

    glBindBuffer(GL_UNIFORM_BUFFER, frame_);
    glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof b, &b);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_);
}

void Renderer::drawShadows(const Scene& scene) {
    // Shadows depend on geometry only; turning the camera leaves them as they are.
    std::uint64_t stamp = 0x9e3779b97f4a7c15u;
    const auto mix = [&](std::uint64_t v) { stamp = (stamp ^ v) * 0xff51afd7ed558ccdu + (stamp >> 29); };
    bool changed = false;
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        if (!drawn_[i]) continue;
        changed = changed || drawn_[i]->changed;
        mix(scene.bodies[i].id);
        mix(scene.bodies[i].revision);
        mix(scene.bodies[i].opacity > 0.99f);
        mix(reinterpret_cast<std::uintptr_t>(drawn_[i]->geometry.get()));
    }
    std::uint64_t ground = 0;
    std::memcpy(&ground, &scene.ground, sizeof ground);
    mix(ground);
    if (!changed && stamp == shadowStamp_) return;
    shadowStamp_ = stamp;

    const auto casts = [&](std::size_t i) { return drawn_[i] && scene.bodies[i].opacity > 0.5f; };
    glEnable(GL_DEPTH_TEST);
    shadowMap_.bind();
    glClear(GL_DEPTH_BUFFER_BIT);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5f, 2.0f);
    shadow_.use();
    shadow_.set("transform", block_.shadow);
    for (std::size_t i = 0; i < drawn_.size(); ++i)
        if (casts(i)) drawAll(*drawn_[i]);
    glDisable(GL_POLYGON_OFFSET_FILL);

    shadeSwap_.bind();
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    height_.use();
    height_.set("transform", heightTransform_);
    for (std::size_t i = 0; i < drawn_.size(); ++i)
        if (casts(i)) drawAll(*drawn_[i]);
    glDisable(GL_DEPTH_TEST);

    shade_.bind();
    groundShadow_.use();
    groundShadow_.set("heightMap", 0);
    groundShadow_.set("shadowDepth", 1);
    bindTexture(0, shadeSwap_.color());
    bindTexture(1, shadowMap_.depth());
    glBindSampler(1, rawSampler_);
    fullscreen();
    glBindSampler(1, 0);
    blur_.use();
    blur_.set("image", 0);
    // The contact shadow is as soft as a tenth of the character is wide.
    const float reach = static_cast<float>(0.10 * radius_) / (2.0f * block_.patchArea.z());
    shadeSwap_.bind();
    blur_.set("stride", Vector2f(reach, 0.0f));
    bindTexture(0, shade_.color());
    fullscreen();
    shade_.bind();
    blur_.set("stride", Vector2f(0.0f, reach));
    bindTexture(0, shadeSwap_.color());
    fullscreen();
}

/// Limits drawing to what bodies and markers cover: most of the picture is background.
void Renderer::scissor(const Target& target) const {
    glEnable(GL_SCISSOR_TEST);
    const Vector2f size(static_cast<float>(target.width()), static_cast<float>(target.height()));
    const Vector2f low = (box_.min().cwiseProduct(size).array() - 1.0f).floor(), high = (box_.max().cwiseProduct(size).array() + 1.0f).ceil();
    glScissor(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(high.x() - low.x()), static_cast<int>(high.y() - low.y()));
}

void Renderer::drawSurface(const Scene& scene) {
    surfaceMap_.bind();
    const float nothing[4] = {0.0f, 0.0f, 0.0f, 1e30f};
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClear(GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    surface_.use();
    surface_.set("transform", block_.viewProjection);
    for (const std::size_t i : order_)
        if (scene.bodies[i].opacity > 0.99f) drawAll(*drawn_[i]);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);

    scissor(occlusionSwap_);
    occlusionSwap_.bind();
    occlusion_.use();
    occlusion_.set("surface", 0);
    occlusion_.set("radius", static_cast<float>(0.17 * radius_));
    occlusion_.set("taps", software_ ? 7 : 14);
    occlusion_.set("shadowMap", 1);
    bindTexture(0, surfaceMap_.color());
    bindTexture(1, shadowMap_.depth());
    glBindSampler(1, compareSampler_);
    fullscreen();
    glBindSampler(1, 0);
    occlusionMap_.bind();
    occlusionBlur_.use();
    occlusionBlur_.set("surface", 0);
    occlusionBlur_.set("occlusion", 1);
    occlusionBlur_.set("spread", software_ ? 1.0f : 1.5f);
    occlusionBlur_.set("texel", Vector2f(1.0f / static_cast<float>(occlusionMap_.width()), 1.0f / static_cast<float>(occlusionMap_.height())));
    bindTexture(1, occlusionSwap_.color());
    fullscreen();
    glDisable(GL_SCISSOR_TEST);
}

void Renderer::drawBody(const Scene& scene, std::size_t i, bool depthOnly) {
    const Body& body = scene.bodies[i];
    const GpuBody& gpu = *drawn_[i];
    if (depthOnly) {
        drawAll(gpu);
        return;
    }
    body_.set("opacity", body.opacity);
    body_.set("hovered", body.hovered && !body.selected ? 1.0f : 0.0f);
    body_.set("dimmed", body.dimmed ? 1.0f : 0.0f);
    const Look& look = gpu.mesh->look;
    const bool ownColor = look.materials.empty() && look.colors.rows() == 0;
    glBindVertexArray(gpu.vertexArray);
    for (const BodyGeometry::Range& range : gpu.geometry->ranges()) {
        Vector3f base = ownColor ? body.color : Vector3f::Ones();
        float metallic = 0.0f, roughness = 0.5f;
        GLuint texture = 0;
        if (range.material >= 0) {
            const Material& m = look.materials[range.material];
            base = m.baseColor.head<3>();
            metallic = m.metallic;
            roughness = m.roughness;
            if (m.baseColorTexture >= 0 && m.baseColorTexture < static_cast<int>(gpu.textures.size())) texture = gpu.textures[m.baseColorTexture];
        }
        body_.set("baseColor", base);
        body_.set("metallic", metallic);
        body_.set("roughness", roughness);
        body_.set("textured", texture ? 1 : 0);
        bindTexture(0, texture);
        glDrawElements(GL_TRIANGLES, range.count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(std::size_t(range.first) * sizeof(std::uint32_t)));
    }
}

template <class T>
void stream(const Buffer& buffer, const std::vector<T>& data) {
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(), GL_STREAM_DRAW);
}

void Renderer::drawMarkers(const Scene& scene, int height) {
    markers_.build(scene, height);
    // Bodies dim markers through the surface map, so markers only sort among themselves.
    glClear(GL_DEPTH_BUFFER_BIT);
    bindTexture(0, surfaceMap_.color());
    solid_.use();
    solid_.set("surface", 0);
    glBindVertexArray(solidArray_);
    if (!markers_.bones.empty()) {
        stream(solidBuffer_, markers_.bones);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(markers_.bones.size()));
    }
    if (!markers_.sheets.empty()) {
        stream(solidBuffer_, markers_.sheets);
        glDepthMask(GL_FALSE);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(markers_.sheets.size()));
        glDepthMask(GL_TRUE);
    }
    glDisable(GL_DEPTH_TEST);
    if (!markers_.lines.empty()) {
        stream(lineBuffer_, markers_.lines);
        line_.use();
        line_.set("surface", 0);
        glBindVertexArray(lineArray_);
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(markers_.lines.size()));
    }
    if (!markers_.points.empty()) {
        stream(pointBuffer_, markers_.points);
        point_.use();
        point_.set("surface", 0);
        glBindVertexArray(pointArray_);
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(markers_.points.size()));
    }
}

void Renderer::drawOutlines(const Scene& scene, unsigned target, int width, int height) {
    // Only the part of the picture around what is outlined is touched.
    Eigen::AlignedBox2f box;
    bool everywhere = false;
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        if (!drawn_[i] || !(scene.bodies[i].selected || scene.bodies[i].hovered)) continue;
        for (int k = 0; k < 8; ++k) {
            const Vector3f p((k & 1 ? drawn_[i]->high : drawn_[i]->low).x(), (k & 2 ? drawn_[i]->high : drawn_[i]->low).y(), (k & 4 ? drawn_[i]->high : drawn_[i]->low).z());
            const Vector4f c = block_.viewProjection * p.homogeneous();
            if (c.w() < 1e-6f) everywhere = true;
            else box.extend(Vector2f((c.x() / c.w() * 0.5f + 0.5f) * static_cast<float>(width), (c.y() / c.w() * 0.5f + 0.5f) * static_cast<float>(height)));
        }
    }
    if (box.isEmpty() && !everywhere) return;
    const float margin = 4.0f * scene.pixelRatio + 1.0f;
    const auto clamped = [&](float v, int high) { return static_cast<int>(std::clamp(v, 0.0f, static_cast<float>(high))); };
    const int x0 = everywhere ? 0 : clamped(box.min().x() - margin, width), y0 = everywhere ? 0 : clamped(box.min().y() - margin, height);
    const int x1 = everywhere ? width : clamped(box.max().x() + margin, width), y1 = everywhere ? height : clamped(box.max().y() + margin, height);
    if (x1 <= x0 || y1 <= y0) return;
    if (!maskSamples_.resize(width, height, GL_RG8, 0, kSamples) || !maskMap_.resize(width, height, GL_RG8, 0)) return;

    maskSamples_.bind();
    glClear(GL_COLOR_BUFFER_BIT);
    glEnable(GL_SCISSOR_TEST);
    glScissor(x0, y0, x1 - x0, y1 - y0);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    mask_.use();
    mask_.set("transform", block_.viewProjection);
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        if (!drawn_[i] || !(scene.bodies[i].selected || scene.bodies[i].hovered)) continue;
        mask_.set("value", scene.bodies[i].selected ? Vector4f(1, 0, 0, 0) : Vector4f(0, 1, 0, 0));
        drawAll(*drawn_[i]);
    }
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, maskSamples_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, maskMap_.framebuffer());
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);

    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, width, height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(x0, y0, x1 - x0, y1 - y0);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    outline_.use();
    outline_.set("mask", 0);
    outline_.set("selectedColor", selectionColor());
    outline_.set("hoveredColor", hoverColor());
    bindTexture(0, maskMap_.color());
    fullscreen();
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
}

void resetState() {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LEQUAL);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glClearColor(0, 0, 0, 0);
    glClearDepth(1.0);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glBlendEquation(GL_FUNC_ADD);
    for (int unit = 2; unit >= 0; --unit) {
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        glBindTexture(GL_TEXTURE_2D, 0);
        glBindSampler(static_cast<GLuint>(unit), 0);
    }
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    glUseProgram(0);
}

void Renderer::draw(const Scene& scene, unsigned target, int width, int height) {
    if (width < 1 || height < 1) return;
    const NoFloatingPointTraps quiet;
    resetState();
    const int part = software_ ? 2 : 1;
    const int w = (width + part - 1) / part, h = (height + part - 1) / part;
    const bool memory = picture_.resize(width, height, GL_SRGB8_ALPHA8, GL_DEPTH_COMPONENT24, kSamples) && resolved_.resize(width, height, GL_SRGB8_ALPHA8, 0) &&
                        shadowMap_.resize(shadowSize(), shadowSize(), 0, GL_DEPTH_COMPONENT24) && shade_.resize(groundShade(), groundShade(), GL_RGBA8, 0) &&
                        shadeSwap_.resize(groundShade(), groundShade(), GL_RGBA8, GL_DEPTH_COMPONENT24) && surfaceMap_.resize(w, h, GL_RGBA32F, GL_DEPTH_COMPONENT24) &&
                        occlusionMap_.resize(w, h, GL_RG8, 0) && occlusionSwap_.resize(w, h, GL_RG8, 0);
    if (!memory) {
        // Nothing sensible can be shown without memory; the last picture stays.
        glBindFramebuffer(GL_FRAMEBUFFER, target);
        return;
    }
    glBindTexture(GL_TEXTURE_2D, surfaceMap_.color());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);

    takeBodies(scene);
    setFrame(scene, width, height);
    drawShadows(scene);
    drawSurface(scene);

    picture_.bind();
    glEnable(GL_FRAMEBUFFER_SRGB);
    glEnable(GL_DEPTH_TEST);
    scissor(picture_);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    bindTexture(1, occlusionMap_.color());
    body_.use();
    body_.set("transform", block_.viewProjection);
    body_.set("baseTexture", 0);
    body_.set("occlusionMap", 1);
    // Bodies are closed and outward: what faces away is hidden.
    glEnable(GL_CULL_FACE);
    for (const std::size_t i : order_)
        if (scene.bodies[i].opacity > 0.99f) drawBody(scene, i, false);
    glEnable(GL_BLEND);
    // X-ray: only the nearest surface of each body shows, so lay down its depth first.
    for (auto at = order_.rbegin(); at != order_.rend(); ++at) {
        const std::size_t i = *at;
        if (scene.bodies[i].opacity > 0.99f) continue;
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        drawBody(scene, i, true);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        drawBody(scene, i, false);
    }
    marked_.use();
    marked_.set("transform", block_.viewProjection);
    marked_.set("tint", selectionColor());
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-1.0f, -2.0f);
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        if (!drawn_[i] || drawn_[i]->markedIndices.empty()) continue;
        glBindVertexArray(drawn_[i]->vertexArray);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, drawn_[i]->marked);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(drawn_[i]->markedIndices.size()), GL_UNSIGNED_INT, nullptr);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, drawn_[i]->indices);
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDisable(GL_CULL_FACE);
    if (!scene.markers.empty()) drawMarkers(scene, height);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);

    glBindFramebuffer(GL_READ_FRAMEBUFFER, picture_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.framebuffer());
    glClear(GL_COLOR_BUFFER_BIT);
    scissor(resolved_);
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);

    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, width, height);
    compose_.use();
    compose_.set("picture", 0);
    compose_.set("transparent", scene.transparentBackground ? 1 : 0);
    compose_.set("shade", 1);
    compose_.set("middle", Vector2f(static_cast<float>(scene.camera.target.x()), static_cast<float>(scene.camera.target.z())));
    bindTexture(0, resolved_.color());
    bindTexture(1, shade_.color());
    fullscreen();
    drawOutlines(scene, target, width, height);
    resetState();
}

void Renderer::forget() {
    bodies_.clear();
    drawn_.clear();
    deformer_.forget();
    for (Target* target : {&picture_, &resolved_, &shadowMap_, &shade_, &shadeSwap_, &surfaceMap_, &occlusionMap_, &occlusionSwap_, &maskSamples_, &maskMap_})
        *target = {};
    shadowStamp_ = 0;
}

SceneRenderer::Pick Renderer::pick(const Scene& scene, int width, int height, int x, int y) {
    Pick answer;
    if (width < 1 || height < 1 || x < 0 || y < 0 || x >= width || y >= height) return answer;
    const NoFloatingPointTraps quiet;
    GLint before = 0, viewport[4] = {};
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
    glGetIntegerv(GL_VIEWPORT, viewport);
    resetState();
    const Camera& camera = scene.camera;
    double bodyDepth = std::numeric_limits<double>::infinity();

    // A picture of that one pixel.
    if (pickTarget_.resize(1, 1, GL_RG32UI, GL_DEPTH_COMPONENT24)) {
        takeBodies(scene);
        setFrame(scene, width, height);
        pickTarget_.bind();
        const GLuint nothing[4] = {0, 0, 0, 0};
        glClearBufferuiv(GL_COLOR, 0, nothing);
        glClear(GL_DEPTH_BUFFER_BIT);
        glEnable(GL_DEPTH_TEST);
        const double cx = 2.0 * (x + 0.5) / width - 1.0, cy = 1.0 - 2.0 * (y + 0.5) / height;
        Eigen::Matrix4d zoom = Eigen::Matrix4d::Identity();
        zoom(0, 0) = width, zoom(0, 3) = -cx * width;
        zoom(1, 1) = height, zoom(1, 3) = -cy * height;
        const Matrix4f transform = (zoom * block_.viewProjection.cast<double>()).cast<float>();
        identity_.use();
        identity_.set("transform", transform);
        for (std::size_t i = 0; i < drawn_.size(); ++i) {
            if (!drawn_[i] || !scene.bodies[i].pickable) continue;
            identity_.set("body", static_cast<unsigned>(i + 1));
            drawAll(*drawn_[i]);
        }
        GLuint found[2] = {0, 0};
        glReadPixels(0, 0, 1, 1, GL_RG_INTEGER, GL_UNSIGNED_INT, found);
        if (found[0] > 0 && found[0] <= drawn_.size()) {
            const Body& body = scene.bodies[found[0] - 1];
            answer.id = body.id;
            answer.triangle = drawn_[found[0] - 1]->geometry->bodyTriangle(static_cast<int>(found[1]));
            // The point: where the ray meets the plane of the triangle.
            const Eigen::Matrix4d view = camera.view();
            const Eigen::Matrix3d axes = view.block<3, 3>(0, 0).transpose();
            const double h = camera.orthographic ? 0.5 * camera.orthoHeight : std::tan(0.5 * camera.fov);
            const double px = cx * h * width / height, py = cy * h;
            const Vec3 origin = camera.orthographic ? Vec3(camera.eye + axes * Vec3(px, py, 0.0)) : camera.eye;
            const Vec3 ray = camera.orthographic ? Vec3(-axes.col(2)) : Vec3(axes * Vec3(px, py, -1.0));
            Vec3 corner[3];
            for (int c = 0; c < 3; ++c) {
                const std::int32_t v = body.mesh->body.triangles(answer.triangle, c);
                Vector3f p;
                if (drawn_[found[0] - 1]->element >= 0)
                    deformer_.read(drawn_[found[0] - 1]->element, v, 1, p.data());
                else
                    p = Eigen::Map<const Vector3f>(body.positions + 3 * v);
                corner[c] = p.cast<double>();
            }
            const Vec3 n = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
            const double slope = n.dot(ray);
            answer.point = std::abs(slope) > 1e-12 * n.norm() * ray.norm() ? Vec3(origin + n.dot(corner[0] - origin) / slope * ray)
                                                                            : Vec3((corner[0] + corner[1] + corner[2]) / 3.0);
            bodyDepth = -(view.row(2).dot(answer.point.homogeneous()));
        }
    }
    Vec3 point;
    const int marker = pickMarker(scene, width, height, x + 0.5, y + 0.5, bodyDepth, point);
    if (marker >= 0) answer = {scene.markers[marker].id, -1, point, true};
    resetState();
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
    glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
    return answer;
}

}  // namespace

Result<std::unique_ptr<SceneRenderer>> SceneRenderer::create() {
    const NoFloatingPointTraps quiet;
    if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 33)
        return fail("no-opengl", "The graphics driver offers no OpenGL 3.3: update it, or install Mesa's software driver.");
    auto renderer = std::make_unique<Renderer>();
    if (const auto ready = renderer->prepare(); !ready) return tl::unexpected(ready.error());
    return std::unique_ptr<SceneRenderer>(std::move(renderer));
}

}  // namespace imomushi::render
