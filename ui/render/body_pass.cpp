// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/body_pass.h"

#include "ui/render/marker_geometry.h"

namespace imomushi::render {

using Eigen::Vector3f;

Result<void> BodyPass::prepare() { return linkAll({{&lit_, "body.vert", "body.frag"}, {&highlight_, "body.vert", "highlight.frag"}}); }

void BodyPass::drawLit(const Body& body, const GpuBody& gpu) const {
    lit_.set("opacity", body.opacity);
    lit_.set("hovered", body.hovered && !body.selected ? 1.0f : 0.0f);
    lit_.set("outdated", body.outdated ? 1.0f : 0.0f);
    lit_.set("dataColors", body.dataColors ? 1 : 0);
    const RenderMesh& surface = gpu.mesh->renderMesh;
    const bool ownColor = surface.materials.empty() && surface.colors.rows() == 0;
    glBindVertexArray(gpu.vertexArray);
    for (const BodyGeometry::Range& range : gpu.geometry->ranges()) {
        Vector3f base = ownColor ? body.color : Vector3f::Ones();
        float metallic = 0.0f, roughness = 0.5f;
        GLuint texture = 0;
        if (range.material >= 0) {
            const Material& m = surface.materials[range.material];
            base = m.baseColor.head<3>();
            metallic = m.metallic;
            roughness = m.roughness;
            if (m.baseColorTexture >= 0 && m.baseColorTexture < static_cast<int>(gpu.textures->size())) texture = (*gpu.textures)[static_cast<std::size_t>(m.baseColorTexture)];
        }
        lit_.set("baseColor", base);
        lit_.set("metallic", metallic);
        lit_.set("roughness", roughness);
        lit_.set("textured", texture ? 1 : 0);
        bindTexture(0, texture);
        glDrawElements(GL_TRIANGLES, range.count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(std::size_t(range.first) * sizeof(std::uint32_t)));
    }
}

void BodyPass::drawHighlights(const PassInput& in) const {
    highlight_.use();
    highlight_.set("transform", in.frame.block.viewProjection);
    highlight_.set("tint", selectionColor());
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-1.0f, -2.0f);
    for (std::size_t i = 0; i < in.bodies.size(); ++i) {
        const GpuBody* gpu = in.bodies[i];
        if (!gpu || gpu->highlightedIndices.empty()) continue;
        cullBackFaces(!in.scene.bodies[i].twoSided);
        glBindVertexArray(gpu->vertexArray);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu->highlight);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(gpu->highlightedIndices.size()), GL_UNSIGNED_INT, nullptr);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu->indices);
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
}

void BodyPass::draw(const PassInput& in, GLuint occlusion) const {
    bindTexture(1, occlusion);
    lit_.use();
    lit_.set("transform", in.frame.block.viewProjection);
    lit_.set("baseTexture", 0);
    lit_.set("occlusionMap", 1);
    for (const std::size_t i : in.frame.frontToBack) {
        const Body& body = in.scene.bodies[i];
        if (body.opacity <= 0.99f) continue;
        cullBackFaces(!body.twoSided);
        drawLit(body, *in.bodies[i]);
    }
    glEnable(GL_BLEND);
    // X-ray: only the nearest surface of each body shows, so lay down its depth first.
    for (auto at = in.frame.frontToBack.rbegin(); at != in.frame.frontToBack.rend(); ++at) {
        const Body& body = in.scene.bodies[*at];
        if (body.opacity > 0.99f) continue;
        cullBackFaces(!body.twoSided);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        drawTriangles(*in.bodies[*at]);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        drawLit(body, *in.bodies[*at]);
    }
    drawHighlights(in);
    cullBackFaces(false);
}

}  // namespace imomushi::render
