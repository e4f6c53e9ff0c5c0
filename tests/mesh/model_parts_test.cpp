// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/mesh/render_model.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// A shape per part, one after the other.
RenderModel modelOf(const std::vector<std::pair<std::string, TriangleMesh>>& shapes) {
    RenderModel model;
    TriangleMesh& all = model.mesh.body;
    for (const auto& [name, mesh] : shapes) {
        const auto v = static_cast<std::int32_t>(all.vertices.rows());
        const auto t = all.triangles.rows();
        all.vertices.conservativeResize(v + mesh.vertices.rows(), 3);
        all.vertices.bottomRows(mesh.vertices.rows()) = mesh.vertices;
        all.triangles.conservativeResize(t + mesh.triangles.rows(), 3);
        all.triangles.bottomRows(mesh.triangles.rows()) = mesh.triangles.array() + v;
        model.part.resize(static_cast<std::size_t>(all.triangles.rows()), static_cast<std::int32_t>(model.parts.size()));
        model.parts.push_back(name);
    }
    return model;
}

TriangleMesh pairOf(const TriangleMesh& mesh, const Vec3& apart) {
    TriangleMesh both;
    both.vertices.resize(2 * mesh.vertices.rows(), 3);
    both.vertices << mesh.vertices, mesh.vertices.rowwise() + apart.transpose();
    both.triangles.resize(2 * mesh.triangles.rows(), 3);
    both.triangles << mesh.triangles, mesh.triangles.array() + static_cast<std::int32_t>(mesh.vertices.rows());
    return both;
}

}  // namespace

TEST_CASE("model parts: every part and every shell has a name of its own, which finds it again") {
    const TriangleMesh ball = shapes::sphere(0.1, 1).mesh;
    const RenderModel model = modelOf({{"head", shapes::sphere(1.0, 1).mesh}, {"eye", ball}, {"eye", ball}, {"eye (2)", ball}, {"teeth", pairOf(ball, {1, 0, 0})}});
    const ModelParts& parts = model.namedParts();
    REQUIRE(parts.parts.size() == 5);
    const char* names[] = {"head", "eye", "eye (3)", "eye (2)", "teeth"};
    for (std::int32_t p = 0; p < 5; ++p) {
        CHECK(parts.nameOf({p, -1}) == names[p]);
        CHECK(parts.find(names[p]) == ModelPart{p, -1});
        CHECK(parts.parts[static_cast<std::size_t>(p)].shells.size() == (p == 4 ? 2u : 0u));
    }
    CHECK(parts.find("teeth#2") == ModelPart{4, 1});
    CHECK(parts.nameOf({4, 0}) == "teeth#1");
    CHECK(!parts.find("teeth#3"));
    CHECK(!parts.find("head#1"));
    CHECK(!parts.find("mouth"));
    CHECK(parts.contains({4, 1}));
    CHECK(!parts.contains({4, 2}));
    CHECK(!parts.contains({5, -1}));
    CHECK(!parts.contains({0, 0}));
    CHECK(&model.namedParts() == &parts);
}

TEST_CASE("model parts: each vertex is of one part, and shells hang together by vertices at one place") {
    // Each triangle with corners of its own: the shells are the same.
    TriangleMesh split = pairOf(shapes::sphere(0.5, 1).mesh, {3, 0, 0});
    Points corners(split.triangles.size(), 3);
    for (Eigen::Index i = 0; i < split.triangles.size(); ++i) {
        corners.row(i) = split.vertices.row(split.triangles.data()[i]);
        split.triangles.data()[i] = static_cast<std::int32_t>(i);
    }
    split.vertices = corners;
    const RenderModel model = modelOf({{"body", shapes::bar(2).mesh}, {"eyes", split}});
    const ModelParts& parts = model.namedParts();
    std::vector<int> seen(static_cast<std::size_t>(model.mesh.body.vertices.rows()), 0);
    for (const auto& part : parts.parts)
        for (const std::int32_t v : part.vertices) ++seen[static_cast<std::size_t>(v)];
    for (const int n : seen) CHECK(n == 1);
    REQUIRE(parts.parts[1].shells.size() == 2);
    CHECK(parts.parts[1].shells[0].size() + parts.parts[1].shells[1].size() == parts.parts[1].vertices.size());
    for (const std::int32_t v : parts.verticesOf({1, 1})) CHECK(model.mesh.body.vertices(v, 0) > 2.0);

    // A vertex that two parts use is of the first; one that none uses of the part before it.
    RenderModel shared = modelOf({{"a", shapes::bar(1).mesh}, {"b", shapes::bar(1).mesh}});
    const auto own = static_cast<std::int32_t>(shapes::bar(1).mesh.vertices.rows());
    shared.mesh.body.triangles(shared.mesh.body.triangles.rows() - 1, 0) = 0;
    shared.mesh.body.vertices.conservativeResize(2 * own + 1, 3);
    shared.mesh.body.vertices.row(2 * own).setConstant(9.0);
    CHECK(shared.namedParts().parts[0].vertices.size() == static_cast<std::size_t>(own));
    CHECK(shared.namedParts().parts[1].vertices.back() == 2 * own);

    // Scattered triangles are no shells.
    TriangleMesh soup;
    soup.vertices.resize(3 * 65, 3);
    soup.triangles.resize(65, 3);
    for (std::int32_t i = 0; i < 3 * 65; ++i) {
        soup.vertices.row(i) << i, i * i % 7, i % 3;
        soup.triangles.data()[i] = i;
    }
    CHECK(modelOf({{"soup", soup}}).namedParts().parts[0].shells.empty());
    RenderModel empty;
    CHECK(empty.namedParts().parts.empty());
}
