// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/character/character.h"
#include "core/mesh/topology.h"
#include "tests/character/caterpillar.h"

/// Render meshes over characters for tests and benchmarks.
namespace imomushi::embedded {

/// Adds `mesh` over all elements of a row of cylinders along z, `length` long each: a vertex follows the element in whose part of the row it is.
/// Vertices exactly at a vertex of that element's body coincide with it.
inline void addRenderMesh(CharacterInput& input, const TriangleMesh& mesh, double length) {
    const int elements = static_cast<int>(input.elements.size());
    std::vector<std::shared_ptr<EmbeddedPoints>> points(input.elements.size());
    std::vector<std::vector<std::int32_t>> of(input.elements.size());
    auto made = std::make_shared<EmbeddedMesh>();
    made->triangles = mesh.triangles;
    const Points normals = vertexNormals(mesh);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        const int e = std::clamp(static_cast<int>(std::floor(mesh.vertices(v, 2) / length)), 0, elements - 1);
        made->vertices.push_back({e, static_cast<std::int32_t>(of[static_cast<std::size_t>(e)].size()), false});
        of[static_cast<std::size_t>(e)].push_back(static_cast<std::int32_t>(v));
    }
    for (std::size_t e = 0; e < of.size(); ++e) {
        const Points& body = input.elements[e].mesh->body.vertices;
        auto own = std::make_shared<EmbeddedPoints>();
        own->rest.resize(static_cast<Eigen::Index>(of[e].size()), 3);
        own->normals.resize(own->rest.rows(), 3);
        own->bodyVertex.assign(of[e].size(), -1);
        for (std::size_t i = 0; i < of[e].size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            own->rest.row(row) = mesh.vertices.row(of[e][i]);
            own->normals.row(row) = normals.row(of[e][i]);
            for (Eigen::Index b = 0; b < body.rows(); ++b)
                if (body.row(b) == own->rest.row(row)) own->bodyVertex[i] = static_cast<std::int32_t>(b);
        }
        input.elements[e].embedded = own;
    }
    input.renderMeshes.push_back(made);
}

/// A cylinder about z from `low` to `high` without ends, `around` x `rows` + 1 rings.
inline TriangleMesh tube(double radius, double low, double high, int around, int rows) {
    TriangleMesh mesh;
    mesh.vertices.resize(static_cast<Eigen::Index>(around) * (rows + 1), 3);
    mesh.triangles.resize(2 * static_cast<Eigen::Index>(around) * rows, 3);
    Eigen::Index t = 0;
    for (int k = 0; k <= rows; ++k)
        for (int i = 0; i < around; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / around;
            mesh.vertices.row(k * around + i) << radius * std::cos(angle), radius * std::sin(angle), low + (high - low) * k / rows;
            if (k == rows) continue;
            const int j = (i + 1) % around;
            mesh.triangles.row(t++) << k * around + i, k * around + j, (k + 1) * around + j;
            mesh.triangles.row(t++) << k * around + i, (k + 1) * around + j, (k + 1) * around + i;
        }
    return mesh;
}

/// A pose of a chain of bones along z: each but the first bent about x and twisted against the one before, all stretched.
inline Pose chainPose(const Skeleton& skeleton, double bend, double twist, double stretch) {
    Pose pose = restPose(skeleton);
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const auto& bone = skeleton.bones[b];
        if (b > 0) pose.frames[b] = pose.frames[b - 1] * Eigen::Quaterniond(Eigen::AngleAxisd(bend, Vec3::UnitX()));
        pose.points[bone.end] = pose.points[bone.start] + stretch * (pose.frames[b] * (skeleton.points[bone.end] - skeleton.points[bone.start]));
    }
    for (std::size_t p = 0; p < pose.roll.size(); ++p) pose.roll[p] = twist * static_cast<double>(p) / static_cast<double>(pose.roll.size() - 1);
    return pose;
}

}  // namespace imomushi::embedded
