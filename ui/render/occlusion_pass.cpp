// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/occlusion_pass.h"

namespace imomushi::render {

using Eigen::Vector2f;

Result<void> OcclusionPass::prepare() {
    triangle_.prepare();
    shadowSampler_ = makeDepthSampler(false);
    return linkAll({{&surfaceProgram_, "body.vert", "surface.frag"},
                    {&occlusionProgram_, "fullscreen.vert", "occlusion.frag"},
                    {&blurProgram_, "fullscreen.vert", "occlusion_blur.frag"}});
}

bool OcclusionPass::resize(int width, int height, bool software) {
    const int part = software ? 2 : 1;
    const int w = (width + part - 1) / part, h = (height + part - 1) / part;
    if (!surface_.resize(w, h, GL_RG32F, GL_DEPTH_COMPONENT24) || !occlusion_.resize(w, h, GL_RG8, 0) || !noisy_.resize(w, h, GL_RG8, 0)) return false;
    glBindTexture(GL_TEXTURE_2D, surface_.color());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return true;
}

void OcclusionPass::releaseMemory() {
    for (Target* target : {&surface_, &noisy_, &occlusion_}) *target = {};
}

void OcclusionPass::draw(const PassInput& in, GLuint shadowMap) {
    surface_.bind();
    const float nothing[4] = {1e30f, 0.0f, 0.0f, 0.0f};
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClear(GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    surfaceProgram_.use();
    surfaceProgram_.set("transform", in.frame.block.viewProjection);
    for (const std::size_t i : in.frame.frontToBack) {
        const Body& body = in.scene.bodies[i];
        if (body.opacity <= 0.99f) continue;
        cullBackFaces(!body.twoSided);
        drawTriangles(*in.bodies[i]);
    }
    cullBackFaces(false);
    glDisable(GL_DEPTH_TEST);

    scissorToContent(in.frame, noisy_);
    noisy_.bind();
    occlusionProgram_.use();
    occlusionProgram_.set("surface", 0);
    occlusionProgram_.set("radius", static_cast<float>(0.17 * in.frame.radius));
    occlusionProgram_.set("taps", in.software ? 7 : 14);
    occlusionProgram_.set("shadowMap", 1);
    bindTexture(0, surface_.color());
    bindTexture(1, shadowMap);
    glBindSampler(1, shadowSampler_);
    triangle_.draw();
    glBindSampler(1, 0);
    occlusion_.bind();
    blurProgram_.use();
    blurProgram_.set("surface", 0);
    blurProgram_.set("occlusion", 1);
    blurProgram_.set("spread", in.software ? 1.0f : 1.5f);
    blurProgram_.set("texel", Vector2f(1.0f / static_cast<float>(occlusion_.width()), 1.0f / static_cast<float>(occlusion_.height())));
    bindTexture(1, noisy_.color());
    triangle_.draw();
    glDisable(GL_SCISSOR_TEST);
}

}  // namespace imomushi::render
