// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "core/document/document.h"
#include "core/effects/body_loads_job.h"

namespace imomushi {

/// What the flesh of an element is like, as numbers of the element. The document keeps the numbers alone: which preset an element has follows from them.
struct MaterialPreset {
    std::string_view name;  ///< of commands
    const char* title;      ///< IMOMUSHI_TEXT("MaterialPreset", ...)
    double nu = Element().nu, stiffness = Element().stiffness, density = Element().density, damping = Element().damping;

    /// How far a character of it sags under gravity with the effect's default numbers, over its height. Measured on the samples in samples_test.
    [[nodiscard]] double sag() const { return GravityEffect::kDefaultSag * density / (CharacterInput::Element::kStandardDensity * stiffness); }
    void apply(Element& element) const;
    [[nodiscard]] bool isOf(const Element& element) const;
};

/// The first has the numbers that elements have at first.
extern const std::array<MaterialPreset, 5> kMaterialPresets;

/// Null: there is none of this name.
const MaterialPreset* materialPreset(std::string_view name);
/// Null: the element has numbers of its own.
const MaterialPreset* materialPresetOf(const Element& element);
/// "standard", "jelly", ...
std::string materialPresetNames();

}  // namespace imomushi
