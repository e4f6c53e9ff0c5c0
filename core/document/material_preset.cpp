// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/material_preset.h"

#include <algorithm>

namespace imomushi {

// Poisson ratios: gelatine and rubber hardly change their volume, .49 is what tetrahedra take; stuffing gives way sideways. Densities: of water, natural rubber,
// stuffing with its cover, skeletal muscle. Stiffness follows from how far each is to sag: 6, 1, 4 and 2 % (MaterialPreset::sag()). Damping: with the default
// ratio of joint dynamics, .2, jelly wobbles (.08), rubber rings a little, muscle settles in a swing or two (.4), and plush does not swing back (1).
const std::array<MaterialPreset, 5> kMaterialPresets = {{
    {"standard", IMOMUSHI_TEXT("MaterialPreset", "Standard")},
    {"jelly", IMOMUSHI_TEXT("MaterialPreset", "Jelly"), 0.49, 0.5, 1000.0, 0.4},
    {"rubber", IMOMUSHI_TEXT("MaterialPreset", "Rubber"), 0.49, 2.79, 930.0, 0.75},
    {"plush", IMOMUSHI_TEXT("MaterialPreset", "Plush"), 0.3, 0.15, 200.0, 5.0},
    {"muscle", IMOMUSHI_TEXT("MaterialPreset", "Muscle"), 0.45, 1.59, 1060.0, 2.0},
}};

void MaterialPreset::apply(Element& element) const {
    element.nu = nu;
    element.stiffness = stiffness;
    element.density = density;
    element.damping = damping;
}

bool MaterialPreset::isOf(const Element& element) const {
    return element.nu == nu && element.stiffness == stiffness && element.density == density && element.damping == damping;
}

const MaterialPreset* materialPreset(std::string_view name) {
    const auto found = std::find_if(kMaterialPresets.begin(), kMaterialPresets.end(), [name](const MaterialPreset& p) { return p.name == name; });
    return found == kMaterialPresets.end() ? nullptr : &*found;
}

const MaterialPreset* materialPresetOf(const Element& element) {
    const auto found = std::find_if(kMaterialPresets.begin(), kMaterialPresets.end(), [&element](const MaterialPreset& p) { return p.isOf(element); });
    return found == kMaterialPresets.end() ? nullptr : &*found;
}

std::string materialPresetNames() {
    std::string names;
    for (const MaterialPreset& p : kMaterialPresets) names += (names.empty() ? "\"" : ", \"") + std::string(p.name) + "\"";
    return names;
}

}  // namespace imomushi
