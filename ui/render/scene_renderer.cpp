// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/scene_renderer.h"

#include <epoxy/gl.h>

#include <chrono>
#include <limits>

#include "core/base/floating_point_guard.h"
#include "ui/render/body_pass.h"
#include "ui/render/body_store.h"
#include "ui/render/frame.h"
#include "ui/render/gl.h"
#include "ui/render/marker_geometry.h"
#include "ui/render/marker_pass.h"
#include "ui/render/occlusion_pass.h"
#include "ui/render/outline_pass.h"
#include "ui/render/pass.h"
#include "ui/render/pick_pass.h"
#include "ui/render/shadow_pass.h"

namespace imomushi::render {

void scissorToContent(const Frame& frame, const Target& target) {
    using Eigen::Vector2f;
    glEnable(GL_SCISSOR_TEST);
    const Vector2f size(static_cast<float>(target.width()), static_cast<float>(target.height()));
    const Vector2f low = (frame.content.min().cwiseProduct(size).array() - 1.0f).floor(), high = (frame.content.max().cwiseProduct(size).array() + 1.0f).ceil();
    glScissor(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(high.x() - low.x()), static_cast<int>(high.y() - low.y()));
}

namespace {

void resetState() {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glEnable(GL_MULTISAMPLE);  // Qt's painter leaves it off
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LEQUAL);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glClearColor(0, 0, 0, 0);
    glClearDepth(1.0);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glBlendEquation(GL_FUNC_ADD);
    for (int unit = 2; unit >= 0; --unit) {
        bindTexture(unit, 0);
        glBindSampler(static_cast<GLuint>(unit), 0);
    }
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    glUseProgram(0);
}

constexpr int kSamples = 4;

class Renderer final : public SceneRenderer {
public:
    Result<void> prepare();
    void draw(const Scene& scene, unsigned target, int width, int height) override;
    Pick pick(const Scene& scene, int width, int height, int x, int y) override;
    bool uploadCharacter(const DeformInput& deformInput) override;
    [[nodiscard]] double uploadMs() const override { return uploadMs_; }
    [[nodiscard]] bool deforms(int element) const override { return store_.deformer().supports(element); }
    [[nodiscard]] bool software() const override { return software_; }
    void releaseMemory() override;

private:
    /// Uploads what changed of the scene and the uniform block Frame.
    /// Per pixel of pictures whose edges are smoothed.
    [[nodiscard]] int samplesOf(const Scene& scene) const;
    PassInput update(const Scene& scene, int width, int height);
    void drawWhole(const Scene& scene, unsigned target, int width, int height);
    void drawPicture(const PassInput& in);
    void compose(const PassInput& in, unsigned target) const;

    bool software_ = false;
    Program compose_;
    FullscreenTriangle triangle_;
    Buffer frameBlock_;
    Target samples_, picture_;  ///< linear colour, premultiplied by alpha
    Target halved_;             ///< the finished picture of a halved scene
    ShadowPass shadows_;
    OcclusionPass occlusion_;
    BodyPass bodies_;
    MarkerPass markers_;
    OutlinePass outlines_;
    PickPass picking_;

    BodyStore store_;
    double uploadMs_ = 0.0;
    std::vector<GpuBody*> drawn_;  ///< of scene.bodies; null: nothing to draw
    Frame frame_;
};

Result<void> Renderer::prepare() {
    software_ = isSoftwareRenderer();
    if (auto ready = linkAll({{&compose_, "fullscreen.vert", "compose.frag"}}); !ready) return ready;
    for (const auto& ready : {shadows_.prepare(), occlusion_.prepare(), bodies_.prepare(), markers_.prepare(), outlines_.prepare(), picking_.prepare(), store_.prepare()})
        if (!ready) return ready;
    triangle_.prepare();
    frameBlock_ = makeBuffer();
    glBindBuffer(GL_UNIFORM_BUFFER, frameBlock_);
    glBufferData(GL_UNIFORM_BUFFER, sizeof(FrameBlock), nullptr, GL_DYNAMIC_DRAW);
    if (glGetError() != GL_NO_ERROR) return fail("no-opengl", "The graphics driver does not do what OpenGL 3.3 asks for: update it.");
    return {};
}

bool Renderer::uploadCharacter(const DeformInput& deformInput) {
    const FloatingPointGuard guard;
    return store_.deformer().upload(deformInput);
}

int Renderer::samplesOf(const Scene& scene) const { return software_ && !scene.smooth ? 1 : kSamples; }

PassInput Renderer::update(const Scene& scene, int width, int height) {
    const auto start = std::chrono::steady_clock::now();
    store_.update(scene, drawn_);
    uploadMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    frame_.set(scene, drawn_, width, height);
    glBindBuffer(GL_UNIFORM_BUFFER, frameBlock_);
    glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof frame_.block, &frame_.block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, frameBlock_);
    return {scene, frame_, drawn_, width, height, software_, samplesOf(scene)};
}

void Renderer::drawPicture(const PassInput& in) {
    samples_.bind();
    glEnable(GL_FRAMEBUFFER_SRGB);
    glEnable(GL_DEPTH_TEST);
    scissorToContent(in.frame, samples_);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    bodies_.draw(in, occlusion_.occlusion());
    if (!in.scene.markers.empty()) markers_.draw(in, occlusion_.surface());
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);

    glBindFramebuffer(GL_READ_FRAMEBUFFER, samples_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture_.framebuffer());
    glClear(GL_COLOR_BUFFER_BIT);
    scissorToContent(in.frame, picture_);
    glBlitFramebuffer(0, 0, in.width, in.height, 0, 0, in.width, in.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
}

void Renderer::compose(const PassInput& in, unsigned target) const {
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, in.width, in.height);
    compose_.use();
    compose_.set("picture", 0);
    compose_.set("transparent", in.scene.transparentBackground ? 1 : 0);
    compose_.set("shade", 1);
    compose_.set("middle", Eigen::Vector2f(static_cast<float>(in.scene.camera.target.x()), static_cast<float>(in.scene.camera.target.z())));
    bindTexture(0, picture_.color());
    bindTexture(1, shadows_.groundShade());
    triangle_.draw();
}

void Renderer::draw(const Scene& scene, unsigned target, int width, int height) {
    if (width < 1 || height < 1) return;
    const FloatingPointGuard guard;
    resetState();
    const int w = (width + 1) / 2, h = (height + 1) / 2;
    if (!scene.halved || !halved_.resize(w, h, GL_RGBA8, 0)) {
        drawWhole(scene, target, width, height);
        return;
    }
    drawWhole(scene, halved_.framebuffer(), w, h);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, halved_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target);
    glBlitFramebuffer(0, 0, w, h, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, target);
}

void Renderer::drawWhole(const Scene& scene, unsigned target, int width, int height) {
    const bool memory = samples_.resize(width, height, GL_SRGB8_ALPHA8, GL_DEPTH_COMPONENT24, samplesOf(scene)) && picture_.resize(width, height, GL_SRGB8_ALPHA8, 0) &&
                        shadows_.resize(software_) && occlusion_.resize(width, height, software_);
    if (!memory) {
        // Nothing sensible can be shown without memory; the last picture stays.
        glBindFramebuffer(GL_FRAMEBUFFER, target);
        return;
    }
    const PassInput in = update(scene, width, height);
    shadows_.draw(in);
    occlusion_.draw(in, shadows_.shadowMap());
    drawPicture(in);
    compose(in, target);
    outlines_.draw(in, target);
    resetState();
}

void Renderer::releaseMemory() {
    store_.clear();
    drawn_.clear();
    samples_ = {}, picture_ = {}, halved_ = {};
    shadows_.releaseMemory();
    occlusion_.releaseMemory();
    outlines_.releaseMemory();
}

SceneRenderer::Pick Renderer::pick(const Scene& scene, int width, int height, int x, int y) {
    Pick answer;
    if (width < 1 || height < 1 || x < 0 || y < 0 || x >= width || y >= height) return answer;
    const FloatingPointGuard guard;
    GLint before = 0, viewport[4] = {};
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
    glGetIntegerv(GL_VIEWPORT, viewport);
    resetState();
    double bodyDepth = std::numeric_limits<double>::infinity();
    if (picking_.resize()) {
        const PickPass::Hit hit = picking_.bodyAt(update(scene, width, height), store_.deformer(), x, y);
        if (hit.body >= 0) {
            answer = {scene.bodies[static_cast<std::size_t>(hit.body)].id, hit.triangle, hit.point, false};
            bodyDepth = hit.depth;
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
    const FloatingPointGuard guard;
    if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 33)
        return fail("no-opengl", "The graphics driver offers no OpenGL 3.3: update it, or install Mesa's software driver.");
    auto renderer = std::make_unique<Renderer>();
    if (const auto ready = renderer->prepare(); !ready) return tl::unexpected(ready.error());
    return std::unique_ptr<SceneRenderer>(std::move(renderer));
}

}  // namespace imomushi::render
