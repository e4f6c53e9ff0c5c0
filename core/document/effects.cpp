// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/effects.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "core/character/element_runtime.h"
#include "core/document/bone_effects.h"
#include "core/document/character_input.h"
#include "core/document/effect_meetings.h"
#include "core/effects/bend_warp_job.h"
#include "core/effects/body_loads_job.h"
#include "core/effects/contact_job.h"
#include "core/effects/end_stretch.h"
#include "core/effects/ground_job.h"
#include "core/effects/joint_dynamics_job.h"
#include "core/effects/previous_model_job.h"
#include "core/effects/smooth_joints_job.h"
#include "core/effects/touch_job.h"

namespace imomushi {

namespace {

// Pairs (EffectDescriptor::pairs) of a joint with its in-plane stretch alone; what it costs more with warping modes, by their number and its square (smooth
// joints); of a joint with dynamics; of a warped vertex; of an entry of a matrix of tractions; of a vertex that the ground may meet.
constexpr double kJointPairs = 26.0, kWarpingPairs = 40.0, kModePairs = 1.0, kModesPairs = 0.86, kDynamicPairs = 13.0, kWarpPairs = 1.45, kTractionPairs = 0.006, kGroundPairs = 0.3;

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

template <class T>
constexpr auto kProperties = T::properties();

/// The row of the effect that `T` are the settings of.
template <class T>
constexpr EffectDescriptor row(EffectKind kind, EffectDescriptor effect = {}) {
    effect.kind = kind;
    effect.name = T::kName;
    effect.title = T::kTitle;
    effect.help = T::kHelp;
    effect.properties = kProperties<T>;
    effect.settings = []() -> std::shared_ptr<EffectSettings> { return std::make_shared<T>(); };
    return effect;
}

double groundPairs(const Document& document) {
    double points = 0.0;
    for (const auto& [id, element] : document.elements) points += std::min(2.0 * GroundJob::kPerPoint, static_cast<double>(element->mesh->body.vertices.rows()));
    return kGroundPairs * points;
}

double jointDynamicsPairs(const Document& document) { return kDynamicPairs * jointsOf(document); }

// By kind.
constexpr EffectDescriptor kTable[] = {
    row<BoneDynamicsEffect>(EffectKind::BoneDynamics, {.scope = EffectScope::Bones, .dependsOnMotion = true}),
    row<SmoothJointsEffect>(EffectKind::SmoothJoints, {.pairs = smoothJointsPairs}),
    row<BendWarpEffect>(EffectKind::BendWarp, {.scope = EffectScope::Elements, .canBeAutomatic = true, .pairs = bendWarpPairs}),
    row<EndStretchEffect>(EffectKind::EndStretch, {.scope = EffectScope::Elements}),
    row<JointDynamicsEffect>(EffectKind::JointDynamics, {.dependsOnMotion = true, .pairs = jointDynamicsPairs}),
    row<PreviousModelEffect>(EffectKind::PreviousModel, {.tractions = true, .dependsOnMotion = true, .pairs = previousModelPairs}),
    row<GravityEffect>(EffectKind::Gravity, {.scope = EffectScope::Elements}),
    row<InflateEffect>(EffectKind::Inflate, {.scope = EffectScope::Elements}),
    // Fingers read the columns of the patches around them, about a dozen; what presses, those of two bodies.
    row<TouchEffect>(EffectKind::Touch, {.scope = EffectScope::Elements, .maxColumnsRead = 36}),
    row<ContactEffect>(EffectKind::Contact, {.scope = EffectScope::Elements, .maxColumnsRead = 36, .canBeAutomatic = true}),
    row<GroundEffect>(EffectKind::Ground, {.scope = EffectScope::Bones, .seesFlesh = true, .pairs = groundPairs}),
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

EffectColumns columnsAsked(const Effects& effects, PartId element, std::optional<std::pair<EffectKind, bool>> as) {
    ElementTables asked;
    for (const EffectDescriptor& d : kTable) {
        if (d.scope != EffectScope::Elements) continue;  // others ask nothing of elements
        if (as && as->first == d.kind ? as->second : effects.has(d.kind, element)) effects.settings(d.kind)->ask(asked);
    }
    return {static_cast<int>(asked.loads.size()), asked.patches};
}

EffectColumns columnsOf(const Effects& effects, EffectKind kind) {
    ElementTables asked;
    effects.settings(kind)->ask(asked);
    return {static_cast<int>(asked.loads.size()), asked.patches};
}

bool sameOnCharacter(const Effects& a, const Effects& b) {
    for (const EffectDescriptor& d : kTable) {
        if (!d.isOnCharacter()) continue;
        if (a.has(d.kind) != b.has(d.kind)) return false;
        if (!a.has(d.kind)) continue;
        if (a[d.kind].elements != b[d.kind].elements || a[d.kind].automatic != b[d.kind].automatic) return false;
        for (const EffectProperty& p : d.properties)
            if (p.rebuilds && a.number(d.kind, p.name) != b.number(d.kind, p.name)) return false;
    }
    return true;
}

void readNumbers(const Effects& effects, EffectKind kind, EffectSettings& settings) {
    effects.read(kind, settings);
    // What waits has few elements that could be pressed in: the ground holds all of them by bones alone.
    if (kind != EffectKind::Contact || settings.automatic || !effects.has(EffectKind::Ground)) return;
    auto& contact = static_cast<ContactEffect&>(settings);
    const auto ground = effects.settings<GroundEffect>(EffectKind::Ground);
    contact.ground = ground.plane();
    contact.groundFriction = ground.friction;
}

CharacterEffects characterEffects(const Document& document) {
    CharacterEffects made;
    for (const EffectDescriptor& d : kTable) {
        if (!d.isOnCharacter() || !document.effects.has(d.kind)) continue;
        auto settings = document.effects.settings(d.kind);
        if (!document.effects[d.kind].elements.empty() || waitsToMeet(document.effects, d.kind))
            for (const auto& [id, element] : document.elements) settings->elements.push_back(document.effects.has(d.kind, id));
        readNumbers(document.effects, d.kind, *settings);
        made.set(std::move(settings));
    }
    return made;
}

Effects::Effects() {
    for (const EffectDescriptor& d : kTable) {
        const auto settings = d.settings();
        auto& values = (*this)[d.kind].values;
        for (const EffectProperty& p : d.properties) values.insert(values.end(), p.at(*settings), p.at(*settings) + p.size);
    }
}

std::shared_ptr<EffectSettings> Effects::settings(EffectKind kind) const {
    auto settings = effectDescriptor(kind).settings();
    read(kind, *settings);
    return settings;
}

void Effects::read(EffectKind kind, EffectSettings& settings) const {
    settings.automatic = (*this)[kind].automatic;
    const double* value = (*this)[kind].values.data();
    for (const EffectProperty& p : effectDescriptor(kind).properties) {
        std::copy_n(value, p.size, p.at(settings));
        value += p.size;
    }
}

bool Effects::has(EffectKind kind, PartId element) const {
    const Effect& effect = (*this)[kind];
    return effect.enabled && (effect.elements.empty() ? !waitsToMeet(*this, kind) : effect.elements.contains(element));
}

int Effects::valueOffset(EffectKind kind, std::string_view property) {
    int at = 0;
    for (const EffectProperty& p : effectProperties(kind)) {
        if (p.name == property) return at;
        at += p.size;
    }
    return -1;
}

double Effects::number(EffectKind kind, std::string_view property) const {
    const int at = valueOffset(kind, property);
    assert(at >= 0);
    return (*this)[kind].values[static_cast<std::size_t>(at)];
}

Vec3 Effects::vector(EffectKind kind, std::string_view property) const {
    const int at = valueOffset(kind, property);
    assert(at >= 0);
    return Vec3::Map((*this)[kind].values.data() + at);
}

}  // namespace imomushi
