// SPDX-License-Identifier: GPL-3.0-or-later
// What the flesh of elements is like: presets, and what their numbers do to a character that moves.
#include <doctest/doctest.h>

#include "core/document/material_preset.h"
#include "tests/document/tamper.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

Json set(const std::string& target, const char* property, const Json& value) { return {{"do", "set"}, {"target", target}, {"property", property}, {"value", value}}; }

/// The farthest that a vertex of an element is from where it is at rest, after a frame.
double farthest(Workbench& w, const char* name) {
    w.good({{"do", "step"}, {"frames", 1}});
    const PartId id = w.session.document().elementNamed(name)->id;
    return (w.session.character()->positions(w.session.elementIndex(id)) - w.session.document().elements.at(id)->mesh->body.vertices).rowwise().norm().maxCoeff();
}

}  // namespace

TEST_CASE("materials: a preset is one step that sets four numbers, known again from these alone, and others are refused") {
    Workbench w;
    w.buildChain();
    const auto a = [&]() -> const Element& { return *w.session.document().elementNamed("A"); };
    REQUIRE(materialPresetOf(a()));
    CHECK(materialPresetOf(a())->name == "standard");
    for (const MaterialPreset& preset : kMaterialPresets) {
        CAPTURE(preset.name);
        if (preset.name == "standard") continue;
        const int before = w.session.position();
        w.good(set("A", "preset", preset.name));
        CHECK(w.session.position() == before + 1);
        REQUIRE(materialPresetOf(a()));
        CHECK(materialPresetOf(a())->name == preset.name);
        CHECK(a().nu == preset.nu);
        CHECK(a().stiffness == preset.stiffness);
        CHECK(a().density == preset.density);
        CHECK(a().damping == preset.damping);
        for (const char* property : {"nu", "stiffness", "density", "damping"}) {
            w.good(set("A", property, 0.123));
            CHECK(materialPresetOf(a()) == nullptr);
            w.good({{"do", "undo"}});
        }
        CHECK(materialPresetOf(a())->name == preset.name);
        const auto path = Workbench::folder() / "preset.imomushi";
        w.good({{"do", "save"}, {"path", path.string()}});
        Workbench other;
        other.good({{"do", "open"}, {"path", path.string()}});
        REQUIRE(materialPresetOf(*other.session.document().elementNamed("A")));
        CHECK(materialPresetOf(*other.session.document().elementNamed("A"))->name == preset.name);
        CHECK(materialPresetOf(*other.session.document().elementNamed("B"))->name == "standard");
        w.good({{"do", "undo"}});
        CHECK(materialPresetOf(a())->name == "standard");
    }
    w.good(set("A", "preset", "jelly"));
    w.good(set("A", "preset", "standard"));
    CHECK(materialPresetOf(a())->name == "standard");
    CHECK(w.code(set("A", "preset", "custom")) == "bad-value");
    CHECK(w.code(set("A", "preset", 1)) == "bad-type");
    CHECK(w.code(set("A", "damping", -0.1)) == "bad-value");
    CHECK(w.code(set("A", "damping", 101)) == "bad-value");
    CHECK(w.code(set("a", "preset", "jelly")) == "no-such-property");
}

TEST_CASE("materials: damping is in the file, and a broken one is damage") {
    Workbench w;
    w.buildChain();
    w.good(set("B", "damping", 3));
    const auto path = Workbench::folder() / "damping.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    Workbench other;
    other.good({{"do", "open"}, {"path", path.string()}});
    CHECK(other.session.document().elementNamed("B")->damping == 3.0);
    CHECK(other.session.document().elementNamed("A")->damping == 1.0);
    CHECK(other.content() == w.content());
    for (const char* bad : {"damping=-1", "damping=101"}) {
        CAPTURE(bad);
        const auto copy = Workbench::folder() / "bad.imomushi";
        std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
        sql(copy, std::string("UPDATE elements SET ") + bad);
        sign(copy);
        const auto opened = openProject(copy);
        REQUIRE_FALSE(opened);
        CHECK(opened.error().code == "damaged");
    }
}

TEST_CASE("materials: how far flesh sags follows from its own stiffness and density, without a frame's delay, and not from those of its neighbours") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "enable"}, {"effect", "gravity"}});
    w.good(set("gravity", "sag", 0.001));  // so little that the bound of loads hardly counts
    const double a = farthest(w, "A"), b = farthest(w, "B");
    REQUIRE(a > 0.0);
    w.good(set("A", "stiffness", 0.5));
    CHECK(farthest(w, "A") == doctest::Approx(2.0 * a).epsilon(1e-3));
    CHECK(farthest(w, "B") == doctest::Approx(b).epsilon(1e-3));
    w.good(set("A", "density", 3000));
    CHECK(farthest(w, "A") == doctest::Approx(6.0 * a).epsilon(1e-2));
    CHECK(farthest(w, "B") == doctest::Approx(b).epsilon(1e-3));
}

TEST_CASE("materials: a joint between flesh that is damped more comes to rest sooner") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "enable"}, {"effect", "joint-dynamics"}});
    const auto framesOfRest = [&] {
        w.good({{"do", "rest"}});
        w.good({{"do", "drag"}, {"endpoint", "a/end"}, {"to", {0.3, 0, 3}}});
        int frames = 0;
        do w.good({{"do", "step"}, {"frames", 1}});
        while (++frames < 2000 && w.session.moving());
        return frames;
    };
    const int plain = framesOfRest();
    w.good(set("B", "damping", 0.5));
    CHECK(framesOfRest() > plain);
    for (const char* element : {"A", "B"}) w.good(set(element, "damping", 3));
    CHECK(framesOfRest() < plain);
}
