// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/outline_pass.h"

#include <algorithm>
#include <optional>

#include "ui/render/marker_geometry.h"

namespace imomushi::render {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;
using Eigen::Vector4f;

bool outlined(const PassInput& in, std::size_t i) { return in.bodies[i] && (in.scene.bodies[i].selected || in.scene.bodies[i].hovered); }

/// Device pixels from the lower left.
struct PixelBox {
    int x0, y0, x1, y1;
    void scissor() const {
        glEnable(GL_SCISSOR_TEST);
        glScissor(x0, y0, x1 - x0, y1 - y0);
    }
};

/// The part of the picture around all that is outlined; none: nothing of it is seen.
std::optional<PixelBox> outlinedPart(const PassInput& in) {
    Eigen::AlignedBox2f box;
    bool everywhere = false;
    for (std::size_t i = 0; i < in.bodies.size(); ++i) {
        if (!outlined(in, i)) continue;
        const GpuBody& gpu = *in.bodies[i];
        for (int k = 0; k < 8; ++k) {
            const Vector3f p((k & 1 ? gpu.high : gpu.low).x(), (k & 2 ? gpu.high : gpu.low).y(), (k & 4 ? gpu.high : gpu.low).z());
            const Vector4f c = in.frame.block.viewProjection * p.homogeneous();
            if (c.w() < 1e-6f) everywhere = true;
            else box.extend(Vector2f((c.x() / c.w() * 0.5f + 0.5f) * static_cast<float>(in.width), (c.y() / c.w() * 0.5f + 0.5f) * static_cast<float>(in.height)));
        }
    }
    if (everywhere) return PixelBox{0, 0, in.width, in.height};
    if (box.isEmpty()) return std::nullopt;
    const float margin = 4.0f * in.scene.unit() + 1.0f;
    const auto clamped = [](float v, int high) { return static_cast<int>(std::clamp(v, 0.0f, static_cast<float>(high))); };
    const PixelBox part{clamped(box.min().x() - margin, in.width), clamped(box.min().y() - margin, in.height), clamped(box.max().x() + margin, in.width),
                        clamped(box.max().y() + margin, in.height)};
    return part.x1 > part.x0 && part.y1 > part.y0 ? std::optional(part) : std::nullopt;
}

}  // namespace

Result<void> OutlinePass::prepare() {
    triangle_.prepare();
    return linkAll({{&mask_, "body.vert", "flat.frag"}, {&outline_, "fullscreen.vert", "outline.frag"}});
}

void OutlinePass::releaseMemory() { samples_ = {}, resolved_ = {}; }

void OutlinePass::draw(const PassInput& in, unsigned target) {
    const auto part = outlinedPart(in);
    if (!part || !samples_.resize(in.width, in.height, GL_RG8, 0, in.samples) || !resolved_.resize(in.width, in.height, GL_RG8, 0)) return;

    samples_.bind();
    glClear(GL_COLOR_BUFFER_BIT);
    part->scissor();
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    mask_.use();
    mask_.set("transform", in.frame.block.viewProjection);
    for (std::size_t i = 0; i < in.bodies.size(); ++i) {
        if (!outlined(in, i)) continue;
        mask_.set("value", in.scene.bodies[i].selected ? Vector4f(1, 0, 0, 0) : Vector4f(0, 1, 0, 0));
        drawTriangles(*in.bodies[i]);
    }
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, samples_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.framebuffer());
    glBlitFramebuffer(0, 0, in.width, in.height, 0, 0, in.width, in.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);

    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, in.width, in.height);
    part->scissor();
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    outline_.use();
    outline_.set("mask", 0);
    outline_.set("selectedColor", selectionColor());
    outline_.set("hoveredColor", hoverColor());
    bindTexture(0, resolved_.color());
    triangle_.draw();
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
}

}  // namespace imomushi::render
