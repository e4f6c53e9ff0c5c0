// SPDX-License-Identifier: GPL-3.0-or-later
// Flesh of a sample on the ground, with contact.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/document/workbench.h"
#include "tests/support/plain_sample.h"

using namespace imomushi;

namespace {

/// The sample caterpillar with bone dynamics, gravity and a ground under its feet, and what else is named; after `frames`.
struct Floor {
    Floor(const std::shared_ptr<ResponseStore>& store, const std::vector<std::string>& others, int frames) : w(store) {
        w.good({{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}});
        for (const Json& line : plainLines("caterpillar")) w.good(line);
        for (const auto& [id, element] : w.session.document().elements) {
            const Points& rest = element->mesh->body.vertices;
            low = low.cwiseMin(rest.colwise().minCoeff().transpose());
            high = high.cwiseMax(rest.colwise().maxCoeff().transpose());
        }
        w.good({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", low.y()}});
        for (const char* effect : {"bone-dynamics", "gravity", "ground"}) w.good({{"do", "enable"}, {"effect", effect}});
        for (const auto& effect : others) w.good({{"do", "enable"}, {"effect", effect}});
        w.good({{"do", "precompute"}});
        w.good({{"do", "step"}, {"frames", frames}});
    }
    [[nodiscard]] Points vertices() {
        const Character& c = *w.session.character();
        Eigen::Index count = 0;
        for (const auto& element : c.input().elements) count += element.mesh->body.vertices.rows();
        Points out(count, 3);
        count = 0;
        for (int e = 0; e < static_cast<int>(c.input().elements.size()); ++e) {
            const Points at = c.positions(e);
            out.middleRows(count, at.rows()) = at;
            count += at.rows();
        }
        return out;
    }
    Workbench w;
    Vec3 low = Vec3::Constant(1e30), high = -low;
};

}  // namespace

TEST_CASE("caterpillar on the ground with contact: its weight presses its flesh up, not sideways, and sleeps when its bones have come to rest") {
    const auto store = std::make_shared<ResponseStore>();
    for (const std::vector<std::string>& others : {std::vector<std::string>{}, {"bend-warp"}}) {
        CAPTURE(others.size());
        std::vector<std::string> with = others;
        with.emplace_back("contact");
        Floor plain(store, others, 240), pressed(store, with, 240);
        const Points before = plain.vertices(), after = pressed.vertices(), moved = after - before;
        const double size = (plain.high - plain.low).norm();
        const Vec3 mean = moved.colwise().mean().transpose();
        MESSAGE("flesh moved " << mean.transpose() / size << " sizes; lowest " << before.col(1).minCoeff() - plain.low.y() << " m without contact, "
                               << after.col(1).minCoeff() - plain.low.y() << " m with it");
        CHECK(std::hypot(mean.x(), mean.z()) <= 0.002 * size);
        CHECK(after.col(1).minCoeff() - plain.low.y() >= -0.01 * (plain.high.y() - plain.low.y()));

        // Nothing of it is made again.
        const auto revisions = [&] {
            std::vector<std::uint64_t> out;
            Character& c = *pressed.w.session.character();
            for (int e = 0; e < static_cast<int>(c.input().elements.size()); ++e) out.push_back(c.surface(e).revision);
            return out;
        };
        bool asleep = false;
        for (int i = 0; i < 20 && !asleep; ++i) {
            pressed.w.good({{"do", "step"}, {"frames", 100}});
            const auto seen = revisions();
            const Points rested = pressed.vertices();
            pressed.w.session.stepFrame(1.0 / 60.0);
            asleep = revisions() == seen && pressed.vertices() == rested;
        }
        CHECK(asleep);
    }
}
