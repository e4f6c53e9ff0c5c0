// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cstdio>

#include "tests/support/allocations.h"
#include "tests/support/shapes.h"
#include "tests/warp/bent_bodies.h"

using namespace imomushi;
using namespace imomushi::warped;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const std::string kReference = IMOMUSHI_TEST_DATA "/reference/";

Element& rightHalf() {
    static Element e(between(readObj(kReference + "bend_cylinder_right.obj"), 0, 0.49, {SolverMeshSetting::Kind::Default, 0}));
    return e;
}

}  // namespace

TEST_CASE("a half of a bent cylinder") {
    auto& e = rightHalf();
    for (const double angle : {45.0, 90.0, 120.0, 150.0}) {
        const std::vector<FaceMotion> m{motion(e.input.faces[0], Vec3(0, 0, -0.5 * angle * kDegree), Vec3::Zero()), motion(e.input.faces[1], Vec3::Zero(), Vec3::Zero())};
        const Points x = e.bend(m);
        std::printf("%g: volume %.3f%% quality %.3f\n", angle, 100 * (volume(x, e.body().triangles) / volume(e.body().vertices, e.body().triangles) - 1),
                    worstQuality(e.body().vertices, x, e.body().triangles));
    }
}
