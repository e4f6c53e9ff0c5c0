// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/boundary_input.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/finite.h"
#include "core/base/try.h"

namespace imomushi {

namespace {

/// The edges of a mesh that can be solved on.
Result<EdgeTable> checkedEdges(const TriangleMesh& mesh) {
    const Eigen::Index count = mesh.vertices.rows();
    if (count < 4 || mesh.triangles.rows() < 4)
        return fail("not-closed", "The mesh has too few triangles to enclose a body; import a closed surface.");
    if (!allFinite(mesh.vertices))
        return fail("bad-value", "The mesh has a vertex that is not a finite point; repair the mesh.");
    if (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= count)
        return fail("bad-value", "A triangle of the mesh names a vertex that does not exist; repair the mesh.");
    std::vector<char> used(static_cast<std::size_t>(count));
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f)
        for (int c = 0; c < 3; ++c) used[static_cast<std::size_t>(mesh.triangles(f, c))] = 1;
    if (std::find(used.begin(), used.end(), 0) != used.end())
        return fail("bad-value", "The mesh has a vertex that belongs to no triangle; remove it.");
    EdgeTable edges(mesh.triangles);
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() != 2 || uses[0].forward == uses[1].forward)
            return fail("not-closed",
                        "The surface is not closed and evenly oriented at the edge between vertices " + std::to_string(uses[0].low) + " and " +
                            std::to_string(uses[0].high) + "; repair the mesh.");
    }
    return edges;
}

}  // namespace

Result<HeldSurface> heldSurface(const BoundaryProblem::Input& input) {
    if (!input.mesh) return fail("bad-value", "There is no mesh to solve on.");
    if (!std::isfinite(input.nu) || input.nu < 0.0 || input.nu > 0.5) return fail("bad-value", "The Poisson ratio must lie between 0 and 0.5.");
    const TriangleMesh& mesh = *input.mesh;
    IMOMUSHI_TRY(auto edges, checkedEdges(mesh));
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f)
        if (degenerate(mesh, f))
            return fail("bad-value", "Triangle " + std::to_string(f) + " has no area; repair the mesh.");

    const auto vertexCount = static_cast<std::size_t>(mesh.vertices.rows());
    std::vector<int> patchOf(vertexCount, -1);
    if (input.held.empty()) return fail("no-face", "Nothing holds the body; give it a joint face.");
    for (std::size_t i = 0; i < input.held.size(); ++i) {
        const HeldPatch& patch = input.held[i];
        if (patch.vertices.empty() || patch.triangles.empty()) return fail("no-face", "A joint face has no triangles; choose it again.");
        for (const std::int32_t v : patch.vertices) {
            if (v < 0 || static_cast<std::size_t>(v) >= vertexCount)
                return fail("bad-value", "A joint face names a vertex that does not exist; choose it again.");
            int& owner = patchOf[static_cast<std::size_t>(v)];
            if (owner == static_cast<int>(i)) return fail("bad-value", "A joint face names vertex " + std::to_string(v) + " twice; choose it again.");
            if (owner >= 0)
                return fail("shared-rim", "Two joint faces share vertex " + std::to_string(v) +
                                              "; leave at least one edge of free surface between them.");
            owner = static_cast<int>(i);
        }
        std::vector<char> covered(vertexCount);
        for (const std::int32_t f : patch.triangles) {
            if (f < 0 || f >= mesh.triangles.rows())
                return fail("bad-value", "A joint face names a triangle that does not exist; choose it again.");
            for (int c = 0; c < 3; ++c) {
                const auto v = static_cast<std::size_t>(mesh.triangles(f, c));
                if (patchOf[v] != static_cast<int>(i))
                    return fail("bad-value", "A joint face has a triangle with a corner outside of it; choose it again.");
                covered[v] = 1;
            }
        }
        for (const std::int32_t v : patch.vertices)
            if (!covered[static_cast<std::size_t>(v)])
                return fail("bad-value", "A joint face has a vertex without a triangle (" + std::to_string(v) + "); choose it again.");
    }
    if (std::find(patchOf.begin(), patchOf.end(), -1) == patchOf.end())
        return fail("no-free-vertex", "Joint faces cover the whole surface; leave some of it free.");
    return HeldSurface{std::move(patchOf), std::move(edges)};
}

bool hasUnheldPart(const TriangleMesh& mesh, const HeldSurface& surface) {
    int count = 0;
    const std::vector<std::int32_t> component = edgeComponents(mesh.triangles, surface.edges, count);
    if (count == 1) return false;
    const Vec3 origin = mesh.vertices.row(0).transpose();
    std::vector<double> volume(static_cast<std::size_t>(count));
    std::vector<char> held(static_cast<std::size_t>(count));
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
        const auto part = static_cast<std::size_t>(component[static_cast<std::size_t>(f)]);
        volume[part] += areaVector(mesh, f).dot(Vec3(mesh.vertices.row(mesh.triangles(f, 0)).transpose()) - origin) / 6.0;
        for (int c = 0; c < 3; ++c) held[part] |= surface.patchOf[static_cast<std::size_t>(mesh.triangles(f, c))] >= 0;
    }
    for (std::size_t part = 0; part < held.size(); ++part)
        if (volume[part] > 0.0 && !held[part]) return true;
    return false;
}

}  // namespace imomushi
