// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/character/effect_settings.h"
#include "core/mesh/mesh.h"

namespace imomushi {

struct Document;

/// Identity of a part within one document; never used again after the part is gone. 0: none.
using PartId = std::uint64_t;

/// What a scene may ask for beyond the static pose (the manual's effects). All are off until they are enabled; one that is off has no state, no columns
/// and no row in the statistics. effects.cpp describes each effect in one row of a table.
enum class EffectKind { BoneDynamics, SmoothJoints, BendWarp, EndStretch, JointDynamics, PreviousModel, Gravity, Inflate, Touch, Contact, Ground, kCount };
inline constexpr std::size_t kEffects = static_cast<std::size_t>(EffectKind::kCount);

struct Effect {
    bool enabled = false;
    bool automatic = false;      ///< enabled, and acts only where and while a pose calls for it (EffectDescriptor::canBeAutomatic)
    std::set<PartId> elements;   ///< the elements it acts on; empty: all, with automatic contact none yet (effect_meetings.h)
    std::vector<double> values;  ///< of effectProperties(), vectors as three numbers
    bool operator==(const Effect&) const = default;
};

/// The effects of a document with their settings, which stay while an effect is off.
class Effects {
public:
    /// All off, with the values that they have at first.
    Effects();

    [[nodiscard]] const Effect& operator[](EffectKind kind) const { return all_[static_cast<std::size_t>(kind)]; }
    Effect& operator[](EffectKind kind) { return all_[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] bool has(EffectKind kind) const { return (*this)[kind].enabled; }
    /// Enabled, and on this element.
    [[nodiscard]] bool has(EffectKind kind, PartId element) const;

    /// The value of a property that exists.
    [[nodiscard]] double number(EffectKind kind, std::string_view property) const;
    [[nodiscard]] Vec3 vector(EffectKind kind, std::string_view property) const;
    /// All numbers of an effect, as those who act on them know them.
    [[nodiscard]] std::shared_ptr<EffectSettings> settings(EffectKind kind) const;
    /// `T`: the settings of `kind`. Takes no memory.
    template <class T>
    [[nodiscard]] T settings(EffectKind kind) const {
        T made;
        read(kind, made);
        return made;
    }
    /// The same numbers into settings of `kind`.
    void read(EffectKind kind, EffectSettings& settings) const;
    /// Where the values of a property begin in Effect::values, -1: there is no such property.
    static int valueOffset(EffectKind kind, std::string_view property);

    bool operator==(const Effects&) const = default;

private:
    std::array<Effect, kEffects> all_;
};

/// Columns of A' that effects ask of the response of an element (EffectSettings::ask(), ResponseInput).
struct EffectColumns {
    int loads = 0;
    int patches = 0;  ///< of touch
    [[nodiscard]] int count() const { return loads + 3 * patches; }
    bool operator==(const EffectColumns&) const = default;
};

/// Which part of a character an effect acts on.
enum class EffectScope {
    Bones,       ///< before the character is deformed (Performance)
    Character,   ///< its joints, or all of it
    Elements,    ///< elements; some alone, if asked for
};

/// One effect: all that the document, its commands and the studio know of it. A function that is null has nothing to say.
struct EffectDescriptor {
    EffectScope scope = EffectScope::Character;
    bool seesFlesh = false;  ///< of bones: a job tells it of each frame where flesh is
    int maxColumnsRead = std::numeric_limits<int>::max();  ///< largest number of its columns that one frame reads, to predict frame times
    /// It needs the tractions of responses in the basis "full".
    bool tractions = false;
    /// It follows from how a character moves in time: an export without a take drops it.
    bool dependsOnMotion = false;
    /// It can wait until a pose calls for it, on each element as far as it does, and costs nothing meanwhile.
    bool canBeAutomatic = false;
    /// Predicted time per frame without its columns, as a number of pairs (collocation point, triangle); machineRates() has the time of a pair on this
    /// machine. The studio shows measured times once frames pass. Null: negligible. Effects on bones add a trial run (Performance::predict()).
    double (*pairs)(const Document&) = nullptr;

    /// It has a job in the frames of a character.
    [[nodiscard]] constexpr bool isOnCharacter() const { return scope != EffectScope::Bones || seesFlesh; }

    // What its settings say of it (effect_settings.h).
    EffectKind kind = EffectKind::kCount;
    std::string_view name = {};  ///< of commands and files; elements and bones cannot have it, so that one name says what a command means
    const char *title = "", *help = "";
    std::span<const EffectProperty> properties = {};          ///< in the order of Effect::values
    std::shared_ptr<EffectSettings> (*settings)() = nullptr;  ///< with the values that it has at first
};

/// By kind.
const EffectDescriptor& effectDescriptor(EffectKind kind);
inline std::string_view effectName(EffectKind kind) { return effectDescriptor(kind).name; }
inline std::span<const EffectProperty> effectProperties(EffectKind kind) { return effectDescriptor(kind).properties; }
/// Whether the effect can be asked for on some elements alone.
inline bool isOfElements(EffectKind kind) { return effectDescriptor(kind).scope == EffectScope::Elements; }
/// Nullopt: there is no such effect.
std::optional<EffectKind> effectNamed(std::string_view name);

/// What the effects that are on ask of the response of an element; `as`: as if this one were on there, or off.
EffectColumns columnsAsked(const Effects& effects, PartId element, std::optional<std::pair<EffectKind, bool>> as = std::nullopt);
/// What one effect asks for, by itself.
EffectColumns columnsOf(const Effects& effects, EffectKind kind);
/// Whether the same effects act on the same elements of a character, on the same responses: what differs can be tuned while it moves.
bool sameOnCharacter(const Effects& a, const Effects& b);
/// The effects of a document that act on elements and joints, by their numbers.
CharacterEffects characterEffects(const Document& document);
/// Settings of one of these effects get the numbers that it has now. Takes no memory.
void readNumbers(const Effects& effects, EffectKind kind, EffectSettings& settings);

}  // namespace imomushi
