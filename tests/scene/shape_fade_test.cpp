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

TEST_CASE("shape fade: a body that waits stays as it was, and fades from there when it waits no more, or too long") {
    const auto mesh = box();
    const Drawn before(mesh, 0.0f);
    for (const bool forever : {false, true}) {
        ShapeFade fade;
        fade.keep(before.scene);
        double seconds = 0.0;
        float last = 0.0f;
        const double step = 0.05;
        for (int frame = 0; frame < 100 && fade.active(); ++frame, seconds += step) {
            Drawn after(mesh, 0.5f);
            const bool waits = forever || seconds < 0.4;
            fade.apply(after.scene, frame == 0 ? 0.0 : step, [waits](std::uint64_t body) { return waits && body == 7; });
            const float raised = after.raisedFrom(before);
            if (seconds < (forever ? ShapeFade::kLongestWait : 0.4)) CHECK(raised == 0.0f);
            CHECK(raised >= last);
            CHECK(raised - last < 0.15f);
            last = raised;
        }
        CHECK(last == doctest::Approx(0.5));
        CHECK(seconds > (forever ? ShapeFade::kLongestWait : 0.4) + ShapeFade::kSeconds);
        CHECK(seconds < (forever ? ShapeFade::kLongestWait : 0.4) + ShapeFade::kSeconds + 4.0 * step);
    }
}

TEST_CASE("shape fade: parts of a model that is divided anew begin where its vertices were, bodies that are forgotten jump") {
    const auto mesh = box();
    const auto count = static_cast<std::int32_t>(mesh->body.vertices.rows());
    const auto part = [&](std::int32_t first, std::int32_t last) {
        ElementMesh made;
        made.body.vertices = mesh->body.vertices.middleRows(first, last - first);
        return std::make_shared<const ElementMesh>(std::move(made));
    };
    const auto numbers = [](std::int32_t first, std::int32_t last) {
        std::vector<std::int32_t> all;
        for (std::int32_t v = first; v < last; ++v) all.push_back(v);
        return all;
    };
    const auto drawn = [&](std::int32_t cut, float low, float high, std::vector<std::vector<std::int32_t>>& which) {
        which = {numbers(0, cut), numbers(cut, count)};
        std::vector<Drawn> both;
        both.emplace_back(part(0, cut), low, 1);
        both.emplace_back(part(cut, count), high, 2);
        render::Scene scene;
        for (std::size_t i = 0; i < 2; ++i) {
            both[i].scene.bodies[0].positions = both[i].positions.data();
            both[i].scene.bodies[0].textures = mesh;
            both[i].scene.bodies[0].modelVertices = &which[i];
        }
        return both;
    };
    std::vector<std::vector<std::int32_t>> whichBefore, whichAfter;
    const auto before = drawn(8, 1.0f, 2.0f, whichBefore);
    auto after = drawn(12, 5.0f, 6.0f, whichAfter);
    render::Scene seen, now;
    for (const auto& d : before) seen.bodies.push_back(d.scene.bodies[0]);
    for (const auto& d : after) now.bodies.push_back(d.scene.bodies[0]);
    ShapeFade fade;
    fade.keep(seen);
    auto first = now;
    fade.apply(first, 0.0);
    const auto height = [&](const render::Body& body, std::int32_t v) { return body.positions[3 * v + 1] - static_cast<float>(mesh->body.vertices((*body.modelVertices)[static_cast<std::size_t>(v)], 1)); };
    CHECK(height(first.bodies[0], 7) == doctest::Approx(1.0));
    CHECK(height(first.bodies[0], 8) == doctest::Approx(2.0));  // it belonged to the other
    CHECK(height(first.bodies[1], 0) == doctest::Approx(2.0));

    fade.keep(seen);
    fade.retain([](std::uint64_t body) { return body == 1; });
    auto second = now;
    fade.apply(second, 0.0);
    CHECK(height(second.bodies[0], 8) == doctest::Approx(2.0));
    CHECK(height(second.bodies[1], 0) == doctest::Approx(6.0));
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
