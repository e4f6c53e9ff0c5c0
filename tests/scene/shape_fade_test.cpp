// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/shape_fade.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

struct Drawn {
    std::vector<float> positions;
    render::Scene scene;
    Drawn(const std::shared_ptr<const ElementMesh>& mesh, float raised, std::uint64_t id = 7) {
        for (Eigen::Index v = 0; v < mesh->body.vertices.rows(); ++v)
            for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(mesh->body.vertices(v, k)) + (k == 1 ? raised : 0.0f));
        render::Body body;
        body.id = id;
        body.mesh = mesh;
        body.positions = positions.data();
        scene.bodies.push_back(body);
    }
    /// How far all of it has gone from `from`.
    [[nodiscard]] float raisedFrom(const Drawn& from) const {
        float least = 1e9f, most = -1e9f;
        for (std::size_t i = 1; i < positions.size(); i += 3) {
            least = std::min(least, scene.bodies[0].positions[i] - from.positions[i]);
            most = std::max(most, scene.bodies[0].positions[i] - from.positions[i]);
        }
        CHECK(most - least < 1e-5f);
        return most;
    }
};

std::shared_ptr<const ElementMesh> box() {
    return std::make_shared<const ElementMesh>(ElementMesh{shapes::box(Vec3::Zero(), Vec3::Ones(), 2, 2, 2).mesh, {}});
}

}  // namespace

TEST_CASE("shape fade: the picture begins where it was, comes to what is seen now, steadily, and is then left alone") {
    const auto mesh = box();
    const Drawn before(mesh, 0.0f);
    ShapeFade fade;
    CHECK(!fade.active());
    fade.keep(before.scene);
    float last = -1.0f;
    std::uint64_t revision = 0;
    for (int frame = 0; fade.active() && frame < 100; ++frame) {
        Drawn after(mesh, 0.5f);
        fade.apply(after.scene, ShapeFade::kSeconds / 10.0);
        const float raised = after.raisedFrom(before);
        if (frame == 0) CHECK(raised == doctest::Approx(0.0).epsilon(1e-6));
        CHECK(raised > last);
        CHECK(raised - last < (frame == 0 ? 1.5f : 0.1f));
        if (fade.active()) CHECK(after.scene.bodies[0].revision != revision);  // it is uploaded anew
        revision = after.scene.bodies[0].revision;
        last = raised;
    }
    CHECK(!fade.active());
    CHECK(last == doctest::Approx(0.5));
}

TEST_CASE("shape fade: answers that follow each other quickly do not make it jump either") {
    const auto mesh = box();
    const Drawn before(mesh, 0.0f);
    ShapeFade fade;
    fade.keep(before.scene);
    Drawn first(mesh, 0.5f);
    fade.apply(first.scene, 0.0);
    Drawn half(mesh, 0.5f);
    fade.apply(half.scene, 0.5 * ShapeFade::kSeconds);
    const float there = half.raisedFrom(before);
    CHECK(there == doctest::Approx(0.25));
    fade.keep(half.scene);
    Drawn next(mesh, 3.0f);
    fade.apply(next.scene, 0.0);
    CHECK(next.raisedFrom(before) == doctest::Approx(there));
}

TEST_CASE("shape fade: it follows what goes on moving, and leaves other bodies and other meshes alone") {
    const auto mesh = box();
    const Drawn before(mesh, 0.0f);
    ShapeFade fade;
    fade.keep(before.scene);
    Drawn first(mesh, 0.5f);
    fade.apply(first.scene, 0.0);
    Drawn moved(mesh, 2.5f);
    fade.apply(moved.scene, 0.0);
    CHECK(moved.raisedFrom(before) == doctest::Approx(2.0));

    fade.keep(before.scene);
    Drawn other(mesh, 0.5f, 8), replaced(box(), 0.5f);
    fade.apply(other.scene, 0.0);
    CHECK(other.scene.bodies[0].positions == other.positions.data());
    CHECK(!fade.active());
    fade.keep(before.scene);
    fade.apply(replaced.scene, 0.0);
    CHECK(replaced.scene.bodies[0].positions == replaced.positions.data());
    Drawn late(mesh, 0.5f);
    fade.apply(late.scene, 0.0);
    CHECK(late.scene.bodies[0].positions == late.positions.data());
}
