// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/shadow_pass.h"

#include <cstring>

namespace imomushi::render {

using Eigen::Vector2f;

Result<void> ShadowPass::prepare() {
    triangle_.prepare();
    rawDepth_ = makeDepthSampler(true);
    return linkAll({{&depth_, "body.vert", "depth.frag"},
                    {&height_, "body.vert", "height.frag"},
                    {&groundShadow_, "fullscreen.vert", "ground_shadow.frag"},
                    {&blur_, "fullscreen.vert", "blur.frag"}});
}

bool ShadowPass::resize(bool software) {
    // Texels a side; shadows on the ground are soft.
    const int map = software ? 768 : 2048, ground = software ? 160 : 256;
    return shadowMap_.resize(map, map, 0, GL_DEPTH_COMPONENT24) && shade_.resize(ground, ground, GL_RGBA8, 0) &&
           blurred_.resize(ground, ground, GL_RGBA8, GL_DEPTH_COMPONENT24);
}

void ShadowPass::releaseMemory() {
    for (Target* target : {&shadowMap_, &shade_, &blurred_}) *target = {};
    drawnKey_ = 0;
}

bool ShadowPass::changed(const PassInput& in) {
    std::uint64_t key = 0x9e3779b97f4a7c15u;
    const auto mix = [&](std::uint64_t v) { key = (key ^ v) * 0xff51afd7ed558ccdu + (key >> 29); };
    bool changed = false;
    for (std::size_t i = 0; i < in.bodies.size(); ++i) {
        if (!in.bodies[i]) continue;
        changed = changed || in.bodies[i]->changed;
        mix(in.scene.bodies[i].id);
        mix(in.scene.bodies[i].revision);
        mix(in.scene.bodies[i].opacity > 0.99f);
        mix(reinterpret_cast<std::uintptr_t>(in.bodies[i]->geometry.get()));
    }
    std::uint64_t ground = 0;
    std::memcpy(&ground, &in.scene.ground, sizeof ground);
    mix(ground);
    if (!changed && key == drawnKey_) return false;
    drawnKey_ = key;
    return true;
}

void ShadowPass::draw(const PassInput& in) {
    if (!changed(in)) return;
    const auto casts = [&](std::size_t i) { return in.bodies[i] && in.scene.bodies[i].opacity > 0.5f; };
    glEnable(GL_DEPTH_TEST);
    shadowMap_.bind();
    glClear(GL_DEPTH_BUFFER_BIT);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5f, 2.0f);
    depth_.use();
    depth_.set("transform", in.frame.block.shadow);
    for (std::size_t i = 0; i < in.bodies.size(); ++i)
        if (casts(i)) drawTriangles(*in.bodies[i]);
    glDisable(GL_POLYGON_OFFSET_FILL);

    blurred_.bind();
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    height_.use();
    height_.set("transform", in.frame.heightTransform);
    for (std::size_t i = 0; i < in.bodies.size(); ++i)
        if (casts(i)) drawTriangles(*in.bodies[i]);
    glDisable(GL_DEPTH_TEST);

    shade_.bind();
    groundShadow_.use();
    groundShadow_.set("heightMap", 0);
    groundShadow_.set("shadowDepth", 1);
    bindTexture(0, blurred_.color());
    bindTexture(1, shadowMap_.depth());
    glBindSampler(1, rawDepth_);
    triangle_.draw();
    glBindSampler(1, 0);
    blur_.use();
    blur_.set("image", 0);
    // The contact shadow is as soft as a tenth of the character is wide.
    const float reach = static_cast<float>(0.10 * in.frame.radius) / (2.0f * in.frame.block.patchArea.z());
    blurred_.bind();
    blur_.set("stride", Vector2f(reach, 0.0f));
    bindTexture(0, shade_.color());
    triangle_.draw();
    shade_.bind();
    blur_.set("stride", Vector2f(0.0f, reach));
    bindTexture(0, blurred_.color());
    triangle_.draw();
}

}  // namespace imomushi::render
