// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "ui/render/body_geometry.h"
#include "ui/render/gpu_deformer.h"
#include "ui/render/gl.h"
#include "ui/render/scene.h"

namespace imomushi::render {

/// A body in the memory of the graphics card.
struct GpuBody {
    std::shared_ptr<const ElementMesh> mesh;
    std::shared_ptr<const std::vector<std::int32_t>> covered;
    std::unique_ptr<BodyGeometry> geometry;
    VertexArray vertexArray;
    Buffer vertices, attributes, indices, highlight;
    std::vector<std::int32_t> highlightedTriangles;
    std::vector<std::uint32_t> highlightedIndices;
    std::shared_ptr<const ElementMesh> textureSource;
    std::shared_ptr<const std::vector<TextureName>> textures;  ///< 0: could not be decoded
    std::vector<float> staging;
    std::uint64_t revision = 0;
    const float* positions = nullptr;
    Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();  ///< a box that holds it, world, m
    Eigen::AlignedBox3d tightBounds;  ///< the same box; of bodies that the GPU deforms, whose `low` and `high` lie a little outside, a closer one
    int surface = -1;           ///< of the deform input, where the GPU deforms it; -1: positions are uploaded
    std::uint64_t deformInput = 0, version = 0;
    GpuDeformer::DisplayMap displayMap;
    /// The seams that `displayMap` was made for.
    std::vector<std::pair<const void*, const BodyGeometry*>> seams;
    bool fresh = true;    ///< never filled
    bool changed = false; ///< in this frame
    bool welded = false;  ///< a seam touches it
    bool used = false;    ///< in this frame
};

/// The bodies of a scene on the graphics card. What changed since the last update is uploaded or deformed again, normals across seams included; bodies that are
/// gone are deleted.
class BodyStore {
public:
    /// Errors: those of GpuDeformer.
    Result<void> prepare() { return deformer_.prepare(); }
    /// `drawn`: of scene.bodies; null: nothing to draw.
    void update(const Scene& scene, std::vector<GpuBody*>& drawn);
    void clear();
    [[nodiscard]] GpuDeformer& deformer() { return deformer_; }
    [[nodiscard]] const GpuDeformer& deformer() const { return deformer_; }

private:
    void create(const Body& body, GpuBody& gpu);
    /// Those of a body, which another one may have made.
    [[nodiscard]] std::shared_ptr<const std::vector<TextureName>> texturesOf(const std::shared_ptr<const ElementMesh>& source) const;
    static void upload(const Body& body, GpuBody& gpu);
    static void uploadHighlight(const std::vector<std::int32_t>* triangles, GpuBody& gpu);
    static void uploadAll(const Scene& scene, const std::vector<GpuBody*>& drawn);
    void deformAll(const Scene& scene, const std::vector<GpuBody*>& drawn);
    void writeDisplayVertices(const Scene& scene, const std::vector<GpuBody*>& drawn, std::size_t i);

    GpuDeformer deformer_;
    std::map<std::pair<std::uint64_t, int>, GpuBody> bodies_;  ///< by id, and which of the bodies of that id
};

}  // namespace imomushi::render
