// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/scene_renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

#include "ui/render/body_store.h"
#include "ui/render/frame.h"
#include "ui/render/gl.h"
#include "ui/render/marker_geometry.h"

namespace imomushi::render {

namespace {

using Eigen::Matrix4f;
using Eigen::Vector2f;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr int kSamples = 4;

class Renderer final : public SceneRenderer {
public:
    Result<void> prepare();
    void draw(const Scene& scene, unsigned target, int width, int height) override;
    Pick pick(const Scene& scene, int width, int height, int x, int y) override;
    bool take(const SurfaceRecipe& recipe) override;
    [[nodiscard]] double uploadMs() const override { return uploadMs_; }
    bool deforms(int element) const override { return bodies_.deformer().fits(element); }
    bool software() const override { return software_; }
    void forget() override;

private:
    void takeScene(const Scene& scene, int width, int height);
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
    Buffer frameBlock_, solidBuffer_, lineBuffer_, pointBuffer_;
    VertexArray empty_, solidArray_, lineArray_, pointArray_;
    GLuint compareSampler_ = 0, rawSampler_ = 0;
    Target picture_, resolved_, shadowMap_, shade_, shadeSwap_, surfaceMap_, occlusionMap_, occlusionSwap_, maskSamples_, maskMap_, pickTarget_;

    BodyStore bodies_;
    double uploadMs_ = 0.0;
    std::vector<GpuBody*> drawn_;  ///< of scene.bodies; null: nothing to draw
    MarkerGeometry markers_;
    Frame frame_;
    std::uint64_t shadowStamp_ = 0;

public:
    ~Renderer() override {
        glDeleteSamplers(1, &compareSampler_);
        glDeleteSamplers(1, &rawSampler_);
    }
};

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

    if (auto ready = bodies_.prepare(); !ready) return ready;

    frameBlock_ = makeBuffer();
    glBindBuffer(GL_UNIFORM_BUFFER, frameBlock_);
    glBufferData(GL_UNIFORM_BUFFER, sizeof(FrameBlock), nullptr, GL_DYNAMIC_DRAW);
    empty_ = makeVertexArray();

    solidArray_ = makeVertexArray();
    solidBuffer_ = makeBuffer();
    glBindVertexArray(solidArray_);
    glBindBuffer(GL_ARRAY_BUFFER, solidBuffer_);
    floatAttribute(0, 3, sizeof(SolidVertex), offsetof(SolidVertex, position));
    floatAttribute(1, 3, sizeof(SolidVertex), offsetof(SolidVertex, normal));
    floatAttribute(2, 4, sizeof(SolidVertex), offsetof(SolidVertex, color));
    floatAttribute(3, 1, sizeof(SolidVertex), offsetof(SolidVertex, behind));

    lineArray_ = makeVertexArray();
    lineBuffer_ = makeBuffer();
    glBindVertexArray(lineArray_);
    glBindBuffer(GL_ARRAY_BUFFER, lineBuffer_);
    floatAttribute(0, 3, sizeof(LineSegment), offsetof(LineSegment, before), 1);
    floatAttribute(1, 3, sizeof(LineSegment), offsetof(LineSegment, from), 1);
    floatAttribute(2, 3, sizeof(LineSegment), offsetof(LineSegment, to), 1);
    floatAttribute(3, 3, sizeof(LineSegment), offsetof(LineSegment, after), 1);
    floatAttribute(4, 4, sizeof(LineSegment), offsetof(LineSegment, color), 1);
    floatAttribute(5, 3, sizeof(LineSegment), offsetof(LineSegment, widths), 1);

    pointArray_ = makeVertexArray();
    pointBuffer_ = makeBuffer();
    glBindVertexArray(pointArray_);
    glBindBuffer(GL_ARRAY_BUFFER, pointBuffer_);
    floatAttribute(0, 3, sizeof(PointSprite), offsetof(PointSprite, centre), 1);
    floatAttribute(1, 3, sizeof(PointSprite), offsetof(PointSprite, shape), 1);
    floatAttribute(2, 4, sizeof(PointSprite), offsetof(PointSprite, color), 1);
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

bool Renderer::take(const SurfaceRecipe& recipe) {
    const NoFloatingPointTraps quiet;
    return bodies_.deformer().take(recipe);
}

void Renderer::takeScene(const Scene& scene, int width, int height) {
    const auto start = std::chrono::steady_clock::now();
    bodies_.take(scene, drawn_);
    uploadMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    frame_.set(scene, drawn_, width, height);
    glBindBuffer(GL_UNIFORM_BUFFER, frameBlock_);
    glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof frame_.block, &frame_.block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, frameBlock_);
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
    shadow_.set("transform", frame_.block.shadow);
    for (std::size_t i = 0; i < drawn_.size(); ++i)
        if (casts(i)) drawAll(*drawn_[i]);
    glDisable(GL_POLYGON_OFFSET_FILL);

    shadeSwap_.bind();
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    height_.use();
    height_.set("transform", frame_.heightTransform);
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
    const float reach = static_cast<float>(0.10 * frame_.radius) / (2.0f * frame_.block.patchArea.z());
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
    const Vector2f low = (frame_.covered.min().cwiseProduct(size).array() - 1.0f).floor(), high = (frame_.covered.max().cwiseProduct(size).array() + 1.0f).ceil();
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
    surface_.set("transform", frame_.block.viewProjection);
    for (const std::size_t i : frame_.order)
        if (scene.bodies[i].opacity > 0.99f) drawAll(*drawn_[i]);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);

    scissor(occlusionSwap_);
    occlusionSwap_.bind();
    occlusion_.use();
    occlusion_.set("surface", 0);
    occlusion_.set("radius", static_cast<float>(0.17 * frame_.radius));
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
            const Vector4f c = frame_.block.viewProjection * p.homogeneous();
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
    mask_.set("transform", frame_.block.viewProjection);
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

    takeScene(scene, width, height);
    drawShadows(scene);
    drawSurface(scene);

    picture_.bind();
    glEnable(GL_FRAMEBUFFER_SRGB);
    glEnable(GL_DEPTH_TEST);
    scissor(picture_);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    bindTexture(1, occlusionMap_.color());
    body_.use();
    body_.set("transform", frame_.block.viewProjection);
    body_.set("baseTexture", 0);
    body_.set("occlusionMap", 1);
    // Bodies are closed and outward: what faces away is hidden.
    glEnable(GL_CULL_FACE);
    for (const std::size_t i : frame_.order)
        if (scene.bodies[i].opacity > 0.99f) drawBody(scene, i, false);
    glEnable(GL_BLEND);
    // X-ray: only the nearest surface of each body shows, so lay down its depth first.
    for (auto at = frame_.order.rbegin(); at != frame_.order.rend(); ++at) {
        const std::size_t i = *at;
        if (scene.bodies[i].opacity > 0.99f) continue;
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        drawBody(scene, i, true);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        drawBody(scene, i, false);
    }
    marked_.use();
    marked_.set("transform", frame_.block.viewProjection);
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
    bodies_.forget();
    drawn_.clear();
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
        takeScene(scene, width, height);
        pickTarget_.bind();
        const GLuint nothing[4] = {0, 0, 0, 0};
        glClearBufferuiv(GL_COLOR, 0, nothing);
        glClear(GL_DEPTH_BUFFER_BIT);
        glEnable(GL_DEPTH_TEST);
        const double cx = 2.0 * (x + 0.5) / width - 1.0, cy = 1.0 - 2.0 * (y + 0.5) / height;
        Eigen::Matrix4d zoom = Eigen::Matrix4d::Identity();
        zoom(0, 0) = width, zoom(0, 3) = -cx * width;
        zoom(1, 1) = height, zoom(1, 3) = -cy * height;
        const Matrix4f transform = (zoom * frame_.block.viewProjection.cast<double>()).cast<float>();
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
                    bodies_.deformer().read(drawn_[found[0] - 1]->element, v, 1, p.data());
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
