// SPDX-License-Identifier: GPL-3.0-or-later
// Places that several meshes share, each rounded to a grid of its own.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <set>

#include "core/io/vertex_grids.h"

using namespace imomushi;

namespace {

double rounded(double x, double step, double from) { return from + std::round((x - from) / step) * step; }

}  // namespace

TEST_CASE("grids: places that two meshes share are one again, at those of the finer grid, and no two places of a mesh become one") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> in(-1.0, 1.0);
    constexpr std::size_t kShared = 200, kOwn = 300;
    const double fine = 1e-4, coarse = 7e-4;
    std::vector<double> points;
    std::vector<double> shared;
    for (std::size_t i = 0; i < 3 * kShared; ++i) shared.push_back(in(random));
    for (const double step : {coarse, fine}) {
        for (const double x : shared) points.push_back(rounded(x, step, step == fine ? 0.123456 : -0.2));
        for (std::size_t i = 0; i < 3 * kOwn; ++i) points.push_back(rounded(in(random), step, 0.0));
    }
    const std::vector<double> before = points;
    const std::size_t half = kShared + kOwn;
    joinGrids(points, {{0, half, coarse}, {half, half, fine}});
    for (std::size_t i = 0; i < 3 * kShared; ++i) CHECK(points[i] == before[3 * half + i]);
    for (std::size_t i = 0; i < 3 * half; ++i) CHECK(points[3 * half + i] == before[3 * half + i]);
    std::set<std::vector<double>> places, were;
    for (std::size_t v = 0; v < half; ++v) {
        places.insert({points[3 * v], points[3 * v + 1], points[3 * v + 2]});
        were.insert({before[3 * v], before[3 * v + 1], before[3 * v + 2]});
        double moved = 0.0;
        for (std::size_t k = 0; k < 3; ++k) moved += std::pow(points[3 * v + k] - before[3 * v + k], 2);
        CHECK(std::sqrt(moved) <= 0.88 * (fine + coarse));
    }
    CHECK(places.size() == were.size());
}

TEST_CASE("grids: numbers that were not rounded stay as they are, however near; what is not finite stays") {
    std::vector<double> points{0.0, 0.0, 0.0, 1e-9, 0.0, 0.0, NAN, INFINITY, 1e300};
    joinGrids(points, {{0, 1, 0.0}, {1, 1, 0.0}});
    CHECK(points[3] == 1e-9);
    joinGrids(points, {{0, 1, 1e-3}, {1, 1, 1e-3}, {2, 1, 1e-3}});
    CHECK(points[3] == 0.0);
    CHECK(std::isnan(points[6]));
    CHECK(points[8] == 1e300);
}

TEST_CASE("grids: two places nearer than a step of another mesh do not both become one of its places") {
    std::vector<double> points{0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 2e-4, 0.0, 0.0};
    joinGrids(points, {{0, 1, 1e-3}, {1, 2, 1e-4}});
    CHECK(points == std::vector<double>{1e-4, 0.0, 0.0, 1e-4, 0.0, 0.0, 2e-4, 0.0, 0.0});
}

TEST_CASE("grids: the bits to which numbers were rounded are seen where they are stored in more") {
    std::mt19937 random(5);
    for (const int bits : {9, 11, 13, 15}) {
        CAPTURE(bits);
        StoredBits seen(32767);
        for (int i = 0; i < 100; ++i) {
            const auto value = static_cast<std::uint32_t>(random() % (1U << static_cast<unsigned>(bits)));
            const std::uint32_t stored = value << static_cast<unsigned>(15 - bits) | value >> static_cast<unsigned>(2 * bits - 15);
            seen.see((i % 2 ? -1.0 : 1.0) * static_cast<double>(stored) / 32767.0);
        }
        CHECK(seen.step() == doctest::Approx(1.0 / ((1 << bits) - 1)));
    }
    StoredBits none(65535);
    for (int i = 0; i < 100; ++i) none.see(static_cast<double>(i * 659) / 65535.0);
    CHECK(none.step() == doctest::Approx(1.0 / 65535.0));
}
