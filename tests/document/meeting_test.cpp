// SPDX-License-Identifier: GPL-3.0-or-later
// Contact that waits: flesh presses from the first time on that it comes near other flesh, and nothing is paid for what never does.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "core/document/effect_meetings.h"
#include "core/reduction/element_response.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// Three bars of 1 x 1 x 3 m along z, from 0, 6 and 27, each on a bone of its own; the effect waits.
struct Bars {
    explicit Bars(int threads = 1) {
        w.good({{"do", "set"}, {"target", "character"}, {"property", "threads"}, {"value", threads}});
        for (const auto& [name, shape, z] : {std::tuple{"A", "bar0", 0.0}, std::tuple{"B", "bar2", 6.0}, std::tuple{"C", "bar9", 27.0}}) {
            const std::string element = name;
            w.good({{"do", "import-element"}, {"path", shape}, {"name", element}});
            w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
            w.addFace(element, "in", z, -1);
            w.addFace(element, "out", z + 3.0, 1);
            w.good({{"do", "add-bone"}, {"name", "bone " + element}, {"from", element + "/in"}, {"to", element + "/out"}});
            w.good({{"do", "pin"}, {"endpoint", "bone " + element + "/start"}});
            w.good({{"do", "pin"}, {"endpoint", "bone " + element + "/end"}});
        }
        enabled = w.good({{"do", "enable"}, {"effect", "contact"}, {"auto", true}});
        w.good({{"do", "precompute"}});
    }
    /// Moves the first bar beside the second, with its middle so far to the side, m. What step says.
    Json beside(double x, int frames = 60) {
        w.good({{"do", "drag"}, {"endpoint", "bone A/start"}, {"to", {x, 0.0, 6.0}}});
        w.good({{"do", "drag"}, {"endpoint", "bone A/end"}, {"to", {x, 0.0, 9.0}}});
        return w.good({{"do", "step"}, {"frames", frames}});
    }
    [[nodiscard]] PartId id(const char* name) { return w.session.document().elementNamed(name)->id; }
    [[nodiscard]] Eigen::Index patches(const char* name) { return w.session.response(id(name))->touch.columns(); }
    /// m: how far its side towards `sign` x is pressed in, at most.
    [[nodiscard]] double dented(const char* name, int sign) {
        const Points rest = w.session.document().elementNamed(name)->mesh->body.vertices, now = w.session.positionsOf(id(name));
        double most = 0.0;
        for (Eigen::Index v = 0; v < rest.rows(); ++v)
            if (sign * rest(v, 0) > 0.4) most = std::max(most, -sign * (now(v, 0) - rest(v, 0)));
        return most;
    }
    Workbench w;
    Json enabled;
};

}  // namespace

TEST_CASE("contact that waits: nothing is paid before flesh comes near, then its two elements alone get patches and press from the next frame on") {
    Bars bars;
    CHECK(bars.enabled["on"] == Json::array());
    CHECK(bars.enabled["auto"] == true);
    CHECK(bars.enabled["columns"] == 0);
    CHECK(bars.enabled["precompute"] == false);
    for (const char* name : {"A", "B", "C"}) CHECK(bars.patches(name) == 0);

    // Two metres between them.
    CHECK(!bars.beside(3.0).contains("met"));
    CHECK(bars.patches("A") == 0);
    // A tenth of a metre in each other.
    const int steps = bars.w.session.position();
    const Json met = bars.beside(0.9);
    REQUIRE(met.contains("met"));
    CHECK(met["met"] == Json::array({"A", "B"}));
    CHECK(bars.w.session.position() == steps + 2);  // the drags: meeting is no step
    CHECK(bars.patches("A") > 0);
    CHECK(bars.patches("B") > 0);
    CHECK(bars.patches("C") == 0);
    for (const char* name : {"A", "B", "C"}) CHECK(bars.w.session.responseState(bars.id(name)) == Session::ResponseState::Fresh);
    // Together they give way by about the tenth, each by about half of it.
    CHECK(bars.dented("B", 1) > 0.025);
    CHECK(bars.dented("B", 1) < 0.1);
    CHECK(bars.dented("C", 1) == doctest::Approx(0.0).epsilon(1e-9));
    // Known once: nobody meets again.
    CHECK(!bars.beside(3.0).contains("met"));
    CHECK(bars.dented("B", 1) < 1e-6);
    CHECK(!bars.beside(0.9).contains("met"));
    CHECK(bars.dented("B", 1) > 0.025);
}

TEST_CASE("contact that waits: who has met is in the file, is named, and is not chosen by hand") {
    Bars bars;
    bars.beside(0.9, 2);
    const auto file = Workbench::folder() / "met.imomushi";
    bars.w.good({{"do", "save"}, {"path", file.string()}});
    Workbench again;
    again.good({{"do", "open"}, {"path", file.string()}});
    const Effect& effect = again.session.document().effects[EffectKind::Contact];
    CHECK(effect.automatic);
    CHECK(effect.elements.size() == 2);
    CHECK(again.session.document().effects.has(EffectKind::Contact, again.session.document().elementNamed("A")->id));
    CHECK(!again.session.document().effects.has(EffectKind::Contact, again.session.document().elementNamed("C")->id));
    for (const auto& [id, element] : again.session.document().elements) CHECK(again.session.responseState(id) == Session::ResponseState::Fresh);
    CHECK(again.code({{"do", "enable"}, {"effect", "contact"}, {"auto", true}, {"target", "C"}}) == "bad-target");
    CHECK(again.code({{"do", "disable"}, {"effect", "contact"}, {"target", "A"}}) == "bad-target");
    // What is gone does not end the waiting of others.
    for (const char* name : {"A", "B"}) again.good({{"do", "remove-element"}, {"name", name}});
    CHECK(waitsToMeet(again.session.document().effects, EffectKind::Contact));
    CHECK(!again.session.document().effects.has(EffectKind::Contact, again.session.document().elementNamed("C")->id));
    // Always on, on all.
    again.good({{"do", "enable"}, {"effect", "contact"}, {"auto", false}});
    CHECK(again.session.document().effects.has(EffectKind::Contact, again.session.document().elementNamed("C")->id));
}

TEST_CASE("contact: patches of a draft go with the answer that is there, and it presses before its own are computed") {
    Bars bars;
    bars.w.good({{"do", "enable"}, {"effect", "contact"}, {"auto", false}});
    DocumentResponses& responses = bars.w.session.responses();
    for (const char* name : {"A", "B"}) {
        const PartId id = bars.id(name);
        CHECK(responses.lacksPatches(id));
        const auto before = responses.fittingOf(id);
        const ResponseInput input = responses.inputOfDraft(id);
        auto draft = buildResponse(input, Progress());
        REQUIRE(draft);
        responses.bring(id, {responseKey(input), responses.shapeOf(id), std::make_shared<const ElementResponse>(std::move(*draft))});
        CHECK_FALSE(responses.lacksPatches(id));
        CHECK(responses.isDraft(id));
        const auto now = responses.fittingOf(id);
        CHECK(now->response == before->response);
        CHECK(now->touch.columns() > 0);
    }
    CHECK(bars.w.session.responseState(bars.id("A")) == Session::ResponseState::Stale);
    bars.beside(0.9);
    CHECK(bars.dented("B", 1) > 0.02);
    CHECK(bars.dented("B", 1) < 0.1);
    // Its own take their place.
    bars.w.good({{"do", "precompute"}});
    CHECK(bars.w.session.responseState(bars.id("A")) == Session::ResponseState::Fresh);
    CHECK_FALSE(responses.isDraft(bars.id("A")));
}

TEST_CASE("contact that waits: the same bytes for any number of threads, and a body that swings goes on swinging when flesh meets") {
    std::vector<Points> shown;
    for (const int threads : {1, 3}) {
        Bars bars(threads);
        bars.beside(0.9, 30);
        shown.push_back(bars.w.session.positionsOf(bars.id("B")));
    }
    CHECK(shown[0] == shown[1]);

    Bars bars;
    bars.w.good({{"do", "enable"}, {"effect", "bone-dynamics"}});
    bars.w.good({{"do", "unpin"}, {"endpoint", "bone C/end"}});
    bars.beside(3.0, 60);
    bars.w.good({{"do", "drag"}, {"endpoint", "bone C/end"}, {"to", {1.0, 0.0, 29.8}}});
    bars.w.good({{"do", "step"}, {"frames", 60}});
    bars.w.good({{"do", "release"}, {"endpoint", "bone C/end"}});
    bars.w.good({{"do", "step"}, {"frames", 3}});
    const auto end = [&] { return *bars.w.session.positionOf(*bars.w.session.document().endpoint("bone C/end")); };
    // While its end is on its way back, frames with and without a meeting move it about as far.
    Vec3 before = end();
    bars.w.good({{"do", "step"}, {"frames", 1}});
    const double moved = (end() - before).norm();
    REQUIRE(moved > 1e-3);
    before = end();
    const Json met = bars.beside(0.9, 1);
    REQUIRE(met.contains("met"));
    const double next = (end() - before).norm();
    CHECK(next > 0.3 * moved);
    CHECK(next < 3.0 * moved);
    before = end();
    bars.w.good({{"do", "step"}, {"frames", 1}});
    CHECK((end() - before).norm() < 3.0 * next);
    CHECK((end() - before).norm() > 0.1 * next);
}

TEST_CASE("contact that waits: what is joined and bent a little has not met") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "enable"}, {"effect", "contact"}, {"auto", true}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {2.0, 0.0, 5.0}}});
    CHECK(!w.good({{"do", "step"}, {"frames", 30}}).contains("met"));
    CHECK(w.session.document().effects[EffectKind::Contact].elements.empty());
}
