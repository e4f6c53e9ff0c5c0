// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/normal_targets.h"

#include <Eigen/Geometry>
#include <map>

#include "core/mesh/vertex_corners.h"
#include "core/mesh/weld.h"

namespace imomushi {

namespace {

// Triangles whose normals are farther from that of a vertex than this are beyond a hard edge.
constexpr double kCrease = 0.643;  // cosine of 50 degrees

std::vector<std::vector<float>> ofBody(const TriangleMesh& body, const RenderSurface& surface, const ElementMorphs& morphs) {
    std::vector<std::vector<float>> out;
    for (Eigen::Index t = 0; t < morphs.targets.cols(); ++t) {
        // d(area vector) = e1 x de2 + de1 x e2, over the length of the vertex's own sum.
        Points sum = Points::Zero(body.vertices.rows(), 3), change = sum;
        for (Eigen::Index f = 0; f < body.triangles.rows(); ++f) {
            const std::int32_t a = body.triangles(f, 0), b = body.triangles(f, 1), c = body.triangles(f, 2);
            const auto rest = [&](std::int32_t v) -> Vec3 { return morphs.rest.row(v).transpose(); };
            const auto moved = [&](std::int32_t v) -> Vec3 { return morphs.targets.col(t).segment<3>(3 * v).cast<double>(); };
            const Vec3 e1 = rest(b) - rest(a), e2 = rest(c) - rest(a), d1 = moved(b) - moved(a), d2 = moved(c) - moved(a);
            const Vec3 area = e1.cross(e2), d = e1.cross(d2) + d1.cross(e2);
            for (const std::int32_t v : {a, b, c}) {
                sum.row(v) += area.transpose();
                change.row(v) += d.transpose();
            }
        }
        auto& target = out.emplace_back(3 * surface.vertices());
        for (std::size_t i = 0; i < surface.vertices(); ++i) {
            const std::int32_t v = surface.rows[i];
            const double length = sum.row(v).norm();
            Vec3 d = Vec3::Zero();
            if (length > 0.0) {
                const Vec3 n = sum.row(v).transpose() / length;
                d = change.row(v).transpose() / length;
                d -= n * n.dot(d);
            }
            for (int k = 0; k < 3; ++k) target[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(d[k]);
        }
    }
    return out;
}

/// The triangles at the places of the vertices of a mesh, per place.
class Surroundings {
public:
    explicit Surroundings(const TriangleMesh& mesh)
        : mesh_(mesh), first_(weldExact(mesh.vertices, std::vector<char>(static_cast<std::size_t>(mesh.vertices.rows()), 1), {})), welded_(mesh.triangles) {
        for (Eigen::Index i = 0; i < welded_.size(); ++i) welded_.data()[i] = first_[static_cast<std::size_t>(welded_.data()[i])];
        corners_ = VertexCorners({welded_.data(), static_cast<std::size_t>(welded_.size())}, first_.size());
    }
    /// Those that face as `normal` does, or else all.
    [[nodiscard]] std::vector<std::int32_t> facing(std::int32_t vertex, const Vec3& normal) const {
        std::vector<std::int32_t> all, some;
        for (const auto corner : corners_.at(first_[static_cast<std::size_t>(vertex)])) {
            const std::int32_t t = corner / 3;
            const auto at = [&](int k) -> Vec3 { return mesh_.vertices.row(mesh_.triangles(t, k)).transpose(); };
            const Vec3 area = (at(1) - at(0)).cross(at(2) - at(0));
            all.push_back(t);
            if (area.dot(normal) > kCrease * area.norm()) some.push_back(t);
        }
        return some.empty() ? all : some;
    }

private:
    const TriangleMesh& mesh_;
    std::vector<std::int32_t> first_;
    Triangles welded_;
    VertexCorners corners_;
};

std::vector<std::vector<float>> ofPart(const GltfContent& content, const RenderSurface& surface) {
    const auto mesh = static_cast<std::size_t>(surface.mesh);
    const TriangleMesh& file = content.scene.meshes[mesh].model->mesh.body;
    const auto& vertices = content.motion.meshVertices[mesh];
    const Surroundings around(file);
    std::vector<std::vector<std::int32_t>> near;
    for (std::size_t i = 0; i < surface.vertices(); ++i) near.push_back(around.facing(surface.seen[i], surface.normals.row(static_cast<Eigen::Index>(i)).cast<double>().transpose()));

    const auto movers = content.movers(surface);
    const Eigen::Index count = content.targets(movers);
    std::vector<std::vector<float>> out;
    for (Eigen::Index t = 0; t < count; ++t) {
        std::map<std::int32_t, Eigen::Index> column;  // per element that the target moves
        for (const auto& mover : movers)
            if (t >= mover.first && t < mover.first + content.morphs[static_cast<std::size_t>(mover.element)].targets.cols()) column[mover.element] = t - mover.first;
        const auto moved = [&](std::int32_t v) -> Vec3 {
            const auto& at = vertices[static_cast<std::size_t>(v)];
            const auto known = column.find(at.element);
            if (known == column.end()) return Vec3::Zero();
            return content.morphs[static_cast<std::size_t>(at.element)].targets.col(known->second).segment<3>(3 * at.row).cast<double>();
        };
        auto& target = out.emplace_back(3 * surface.vertices(), 0.0f);
        for (std::size_t i = 0; i < surface.vertices(); ++i) {
            Vec3 sum = Vec3::Zero(), change = sum;
            for (const auto f : near[i]) {
                const std::int32_t a = file.triangles(f, 0), b = file.triangles(f, 1), c = file.triangles(f, 2);
                const auto rest = [&](std::int32_t v) -> Vec3 { return file.vertices.row(v).transpose(); };
                const Vec3 e1 = rest(b) - rest(a), e2 = rest(c) - rest(a), d1 = moved(b) - moved(a), d2 = moved(c) - moved(a);
                sum += e1.cross(e2);
                change += e1.cross(d2) + d1.cross(e2);
            }
            const double length = sum.norm();
            if (!(length > 0.0)) continue;
            // The normal of the file turns as that of the triangles does.
            const Vec3 n = sum / length, turn = n.cross(change / length);
            const Vec3 own = surface.normals.row(static_cast<Eigen::Index>(i)).cast<double>().transpose(), d = turn.cross(own);
            for (int k = 0; k < 3; ++k) target[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(d[k]);
        }
    }
    return out;
}

}  // namespace

std::vector<std::vector<float>> normalTargets(const GltfContent& content, const RenderSurface& surface) {
    if (surface.element < 0) return ofPart(content, surface);
    const auto e = static_cast<std::size_t>(surface.element);
    return ofBody(content.scene.character.elements[e].mesh->body, surface, content.morphs[e]);
}

}  // namespace imomushi
