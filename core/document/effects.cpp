// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/effects.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "core/character/character_effects.h"
#include "core/document/character_input.h"

namespace imomushi {

namespace {

constexpr std::array<double, 3> one(double x) { return {x, 0.0, 0.0}; }

// Frequencies and ratios as in BoneSpring and JointDynamics.
constexpr EffectProperty kBoneDynamics[] = {
    {"stretch-hertz", "Hz", 0.01, 1000.0, one(5.0), 1, "how fast bones swing in their length"},
    {"stretch-damping", "", 0.0, 10.0, one(0.4), 1, "damping ratio of their length"},
    {"swing-hertz", "Hz", 0.01, 1000.0, one(2.5), 1, "how fast the angles between bones swing"},
    {"swing-damping", "", 0.0, 10.0, one(0.3), 1, "damping ratio of the angles"},
    {"roll-hertz", "Hz", 0.01, 1000.0, one(3.0), 1, "how fast bones swing about themselves"},
    {"roll-damping", "", 0.0, 10.0, one(0.3), 1, "damping ratio of that"},
    {"return-hertz", "Hz", 0.0, 1000.0, one(0.5), 1, "how fast a body that nothing holds comes back; 0: it floats and falls (so it does above the ground)"},
};
constexpr EffectProperty kJointDynamics[] = {
    {"hertz", "Hz", 0.01, 1000.0, one(4.0), 1, "of the softest way in which a joint jiggles"},
    {"damping", "", 0.0, 10.0, one(0.2), 1, "damping ratio"},
};
constexpr EffectProperty kPreviousModel[] = {
    {"step", "s", 1e-6, 1.0, one(1.0 / 600.0), 1, "time step of the explicit integration"},
    {"damping", "1/s", 0.0, 1e6, one(4.0), 1, "of the velocities of joint-face vertices"},
    {"shear-modulus", "Pa", 1e-3, 1e12, one(3000.0), 1, "of elements with stiffness 1"},
};
constexpr EffectProperty kGravity[] = {
    {"acceleration", "m/s^2", -1e6, 1e6, {0.0, -9.81, 0.0}, 3, "of free fall, in the world"},
    {"shear-modulus", "Pa", 1e-3, 1e12, one(3000.0), 1, "of elements with stiffness 1: softer flesh sags more"},
    {"inertia", "", 0.0, 10.0, one(1.0), 1, "how much of its own acceleration the flesh feels; 0: none"},
};
constexpr EffectProperty kInflate[] = {
    {"pressure", "", -10.0, 10.0, one(0.1), 1, "over the shear modulus; positive puffs up"},
    {"breath", "", 0.0, 10.0, one(0.0), 1, "how much the pressure rises and falls with each breath"},
    {"breath-hertz", "Hz", 0.0, 100.0, one(0.25), 1, "breaths per second"},
};
constexpr EffectProperty kTouch[] = {
    {"patches", "", 8.0, 256.0, one(48.0), 1, "how many patches of the surface fingers act on; more makes finer dents", true, true},
    {"friction", "", 0.0, 10.0, one(1.0), 1, "Coulomb's coefficient between a finger and the surface"},
    {"release", "s", 0.0, 10.0, one(0.15), 1, "in which a dent goes back after a finger lifts"},
};
constexpr EffectProperty kGround[] = {
    {"height", "m", -1e9, 1e9, one(0.0), 1, "of the plane"},
    {"friction", "", 0.0, 10.0, one(0.6), 1, "Coulomb's coefficient, with bone dynamics"},
};

// Pairs (EffectDescriptor::pairs) of a joint with its in-plane stretch alone; what it costs more with warping modes, by their number and its square (smooth
// joints); of a joint with dynamics; of a warped vertex; of an entry of a matrix of tractions.
constexpr double kJointPairs = 26.0, kWarpingPairs = 40.0, kModePairs = 1.0, kModesPairs = 0.86, kDynamicPairs = 13.0, kWarpPairs = 1.45, kTractionPairs = 0.006;

double jointsOf(const Document& document) {
    const auto planned = planCharacter(document);
    return planned ? static_cast<double>(planned->joints.size()) : 0.0;
}

double smoothJointsPairs(const Document& document) {
    const double modes = document.settings.basis == BasisKind::Full ? BasisChoice::kMaxModes : document.settings.basis.modes;
    const double warping = modes > 0.0 ? kWarpingPairs + modes * (kModePairs + modes * kModesPairs) : 0.0;
    return jointsOf(document) * (kJointPairs + warping);
}

double bendWarpPairs(const Document& document) {
    const Effect& effect = document.effects[EffectKind::BendWarp];
    double vertices = 0.0;
    for (const auto& [id, element] : document.elements)
        if (!element->faces.empty() && (!effect.enabled || document.effects.has(EffectKind::BendWarp, id)))
            vertices += static_cast<double>(element->mesh->body.vertices.rows());
    return kWarpPairs * vertices;
}

double previousModelPairs(const Document& document) {
    const double stepsPerFrame = 1.0 / (60.0 * document.effects.number(EffectKind::PreviousModel, "step"));
    double entries = 0.0;
    for (const auto& [id, element] : document.elements) {
        double columns = 0.0;
        for (const JointFace& face : element->faces) columns += 3.0 * static_cast<double>(face.vertices.size());
        entries += columns * columns;
    }
    return kTractionPairs * stepsPerFrame * entries;
}

using Made = std::shared_ptr<EffectSettings>;

Made gravity(const Effects& effects) {
    auto made = std::make_shared<GravityEffect>();
    made->acceleration = effects.vector(EffectKind::Gravity, "acceleration");
    made->inertia = effects.number(EffectKind::Gravity, "inertia");
    made->shearModulus = effects.number(EffectKind::Gravity, "shear-modulus");
    return made;
}

Made inflate(const Effects& effects) {
    auto made = std::make_shared<InflateEffect>();
    made->pressure = effects.number(EffectKind::Inflate, "pressure");
    made->breath = effects.number(EffectKind::Inflate, "breath");
    made->breathHertz = effects.number(EffectKind::Inflate, "breath-hertz");
    return made;
}

Made jointDynamics(const Effects& effects) {
    return std::make_shared<JointDynamicsEffect>(effects.number(EffectKind::JointDynamics, "hertz"), effects.number(EffectKind::JointDynamics, "damping"));
}

Made previousModel(const Effects& effects) {
    auto made = std::make_shared<PreviousModelEffect>();
    made->step = effects.number(EffectKind::PreviousModel, "step");
    made->damping = effects.number(EffectKind::PreviousModel, "damping");
    made->shearModulus = effects.number(EffectKind::PreviousModel, "shear-modulus");
    return made;
}

Made touch(const Effects& effects) {
    auto made = std::make_shared<TouchEffect>();
    made->friction = effects.number(EffectKind::Touch, "friction");
    made->releaseSeconds = effects.number(EffectKind::Touch, "release");
    return made;
}

template <class T>
Made plain(const Effects&) {
    return std::make_shared<T>();
}

int patches(const Effects& effects) { return static_cast<int>(std::lround(effects.number(EffectKind::Touch, "patches"))); }

// By kind.
constexpr EffectDescriptor kTable[] = {
    {.kind = EffectKind::BoneDynamics, .name = "bone-dynamics", .scope = EffectScope::Bones, .properties = kBoneDynamics},
    {.kind = EffectKind::SmoothJoints, .name = SmoothJointsEffect::kName, .settings = plain<SmoothJointsEffect>, .pairs = smoothJointsPairs},
    {.kind = EffectKind::BendWarp, .name = BendWarpEffect::kName, .scope = EffectScope::Elements, .settings = plain<BendWarpEffect>, .pairs = bendWarpPairs},
    {.kind = EffectKind::JointDynamics, .name = JointDynamicsEffect::kName, .properties = kJointDynamics, .settings = jointDynamics,
     .pairs = [](const Document& document) { return kDynamicPairs * jointsOf(document); }},
    {.kind = EffectKind::PreviousModel, .name = PreviousModelEffect::kName, .properties = kPreviousModel, .settings = previousModel, .tractions = true,
     .pairs = previousModelPairs},
    {.kind = EffectKind::Gravity, .name = GravityEffect::kName, .scope = EffectScope::Elements, .properties = kGravity, .settings = gravity,
     .ask = [](const Effects&, EffectColumns& columns) { columns.loads = true; }, .columns = [](const Effects&) { return 3; }},
    {.kind = EffectKind::Inflate, .name = InflateEffect::kName, .scope = EffectScope::Elements, .properties = kInflate, .settings = inflate,
     .ask = [](const Effects&, EffectColumns& columns) { columns.loads = true; }, .columns = [](const Effects&) { return 1; }},
    // Fingers read the columns of the patches around them, about a dozen.
    {.kind = EffectKind::Touch, .name = TouchEffect::kName, .scope = EffectScope::Elements, .properties = kTouch, .settings = touch,
     .ask = [](const Effects& effects, EffectColumns& columns) { columns.patches = patches(effects); },
     .columns = [](const Effects& effects) { return 3 * patches(effects); }, .mostRead = 36},
    {.kind = EffectKind::Ground, .name = "ground", .scope = EffectScope::Bones, .properties = kGround},
};
static_assert(std::size(kTable) == kEffects);
static_assert([] {
    for (std::size_t k = 0; k < kEffects; ++k)
        if (kTable[k].kind != static_cast<EffectKind>(k)) return false;
    return true;
}());

}  // namespace

const EffectDescriptor& effectDescriptor(EffectKind kind) { return kTable[static_cast<std::size_t>(kind)]; }

std::optional<EffectKind> effectNamed(std::string_view name) {
    const auto found = std::find_if(std::begin(kTable), std::end(kTable), [name](const EffectDescriptor& d) { return d.name == name; });
    return found == std::end(kTable) ? std::nullopt : std::optional(found->kind);
}

EffectColumns columnsAsked(const Effects& effects, PartId element, EffectKind without) {
    EffectColumns asked;
    for (const EffectDescriptor& d : kTable)
        if (d.ask && d.kind != without && effects.has(d.kind, element)) d.ask(effects, asked);
    return asked;
}

bool sameOnCharacter(const Effects& a, const Effects& b) {
    for (const EffectDescriptor& d : kTable) {
        if (d.scope == EffectScope::Bones) continue;
        if (a.has(d.kind) != b.has(d.kind)) return false;
        if (!a.has(d.kind)) continue;
        if (a[d.kind].elements != b[d.kind].elements) return false;
        for (const EffectProperty& p : d.properties)
            if (p.rebuilds && a.number(d.kind, p.name) != b.number(d.kind, p.name)) return false;
    }
    return true;
}

CharacterEffects characterEffects(const Document& document) {
    CharacterEffects made;
    for (const EffectDescriptor& d : kTable) {
        if (!d.settings || !document.effects.has(d.kind)) continue;
        auto settings = d.settings(document.effects);
        if (!document.effects[d.kind].elements.empty())
            for (const auto& [id, element] : document.elements) settings->elements.push_back(document.effects.has(d.kind, id));
        made.set(std::move(settings));
    }
    return made;
}

Effects::Effects() {
    for (std::size_t k = 0; k < kEffects; ++k)
        for (const EffectProperty& property : effectProperties(static_cast<EffectKind>(k)))
            all_[k].values.insert(all_[k].values.end(), property.initial.begin(), property.initial.begin() + property.size);
}

bool Effects::has(EffectKind kind, PartId element) const {
    const Effect& effect = (*this)[kind];
    return effect.enabled && (effect.elements.empty() || effect.elements.contains(element));
}

int Effects::place(EffectKind kind, std::string_view property) {
    int at = 0;
    for (const EffectProperty& p : effectProperties(kind)) {
        if (p.name == property) return at;
        at += p.size;
    }
    return -1;
}

double Effects::number(EffectKind kind, std::string_view property) const {
    const int at = place(kind, property);
    assert(at >= 0);
    return (*this)[kind].values[static_cast<std::size_t>(at)];
}

Vec3 Effects::vector(EffectKind kind, std::string_view property) const {
    const int at = place(kind, property);
    assert(at >= 0);
    return Vec3::Map((*this)[kind].values.data() + at);
}

}  // namespace imomushi
