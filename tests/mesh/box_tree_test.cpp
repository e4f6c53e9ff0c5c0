// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/box_tree.h"

#include <doctest/doctest.h>

#include <random>
#include <set>
#include <utility>

using namespace imomushi;

namespace {

std::vector<Bounds> someBoxes(std::mt19937& random, std::size_t count) {
    std::uniform_real_distribution<double> place(-1.0, 1.0), size(0.0, 0.3);
    std::vector<Bounds> out;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 low(place(random), place(random), place(random));
        out.push_back({low, low + Vec3(size(random), size(random), size(random))});
    }
    return out;
}

using Pairs = std::set<std::pair<int, int>>;

}  // namespace

TEST_CASE("box tree: it finds the pairs of boxes that are near, each once, also where they went somewhere else") {
    std::mt19937 random(3);
    for (const std::size_t count : {0u, 1u, 2u, 3u, 40u, 111u}) {
        CAPTURE(count);
        auto boxes = someBoxes(random, count);
        const auto others = someBoxes(random, 30);
        BoxTree tree(boxes);
        const BoxTree other(others);
        for (const double within : {0.0, 0.1, 0.5}) {
            Pairs own, across, ownWanted, acrossWanted;
            for (std::size_t i = 0; i < count; ++i) {
                for (std::size_t k = i + 1; k < count; ++k)
                    if (BoxTree::squaredDistance(boxes[i], boxes[k]) <= within * within) ownWanted.emplace(i, k);
                for (std::size_t k = 0; k < others.size(); ++k)
                    if (BoxTree::squaredDistance(boxes[i], others[k]) <= within * within) acrossWanted.emplace(i, k);
            }
            tree.near(within, [&](int i, int k) { CHECK(own.emplace(i, k).second); });
            tree.near(other, within, [&](int i, int k) { CHECK(across.emplace(i, k).second); });
            CHECK(own == ownWanted);
            CHECK(across == acrossWanted);
            boxes = someBoxes(random, count);
            tree.follow(boxes);
        }
    }
}

TEST_CASE("box tree: a search that comes nearer finds the nearest pair, and one that has enough ends") {
    std::mt19937 random(4);
    const auto boxes = someBoxes(random, 60), others = someBoxes(random, 50);
    const BoxTree tree(boxes), other(others);
    double nearest = 1e9, wanted = 1e9;
    for (const Bounds& a : boxes)
        for (const Bounds& b : others) wanted = std::min(wanted, std::sqrt(BoxTree::squaredDistance(a, b)));
    tree.near(other, nearest, [&](int i, int k) {
        nearest =
            std::min(nearest, std::sqrt(BoxTree::squaredDistance(boxes[static_cast<std::size_t>(i)], others[static_cast<std::size_t>(k)])));
    });
    CHECK(nearest == wanted);
    double within = 10.0;
    int seen = 0;
    tree.near(within, [&](int, int) {
        ++seen;
        within = -1.0;
    });
    CHECK(seen == 1);
}
