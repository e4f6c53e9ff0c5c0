// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/document/project_rows.h"
#include "core/document/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kEffectTables = R"(
CREATE TABLE effects (effect TEXT PRIMARY KEY, enabled INTEGER);
CREATE TABLE effect_elements (effect TEXT, element INTEGER, PRIMARY KEY (effect, element));
CREATE TABLE effect_settings (effect TEXT, property TEXT, x REAL, y REAL, z REAL, PRIMARY KEY (effect, property));
)";

}  // namespace

void createEffectTables(Database& db) { db.run(kEffectTables); }

void writeEffects(Database& db, const Document& document) {
    RowWriter effects(db, "INSERT INTO effects VALUES (?,?)"), elements(db, "INSERT INTO effect_elements VALUES (?,?)"),
        settings(db, "INSERT INTO effect_settings VALUES (?,?,?,?,?)");
    for (std::size_t k = 0; k < kEffects; ++k) {
        const Effect& effect = document.effects[static_cast<EffectKind>(k)];
        const std::string name(effectName(static_cast<EffectKind>(k)));
        effects.row(name, effect.automatic ? 2 : effect.enabled ? 1 : 0);  // 2: automatic
        const double* at = effect.values.data();
        for (const EffectProperty& p : effectProperties(static_cast<EffectKind>(k))) {
            settings.row(name, std::string(p.name), at[0], p.size == 3 ? at[1] : 0.0, p.size == 3 ? at[2] : 0.0);
            at += p.size;
        }
        for (const PartId element : effect.elements) elements.row(name, element);
    }
}

void readEffects(Database& db, Document& document) {
    const auto kindOf = [](RowReader& rows) {
        const auto kind = effectNamed(rows.text());
        require(kind.has_value(), "an effect is unknown");
        return *kind;
    };
    RowReader effects(db, "SELECT * FROM effects");
    while (effects.next()) {
        const EffectKind kind = kindOf(effects);
        const auto state = effects.integer(0, 2);
        require(state < 2 || effectDescriptor(kind).canBeAutomatic, "an effect cannot be automatic");
        document.effects[kind].enabled = state > 0;
        document.effects[kind].automatic = state == 2;
    }
    RowReader settings(db, "SELECT * FROM effect_settings");
    bool sag = false;
    while (settings.next()) {
        const EffectKind kind = kindOf(settings);
        const std::string name = settings.text();
        const auto properties = effectProperties(kind);
        const auto property = std::find_if(properties.begin(), properties.end(), [&](const EffectProperty& p) { return p.name == name; });
        require(property != properties.end(), "a setting of an effect is unknown");
        sag = sag || (kind == EffectKind::Gravity && name == "sag");
        for (int i = 0; i < property->size; ++i)
            document.effects[kind].values[static_cast<std::size_t>(Effects::place(kind, name) + i)] = settings.real(property->low, property->high);
    }
    // Files from before the sag keep every number, set or not: the modulus that it had at first, where there is no gravity, was never chosen.
    if (Effect& gravity = document.effects[EffectKind::Gravity]; !sag && !gravity.enabled) {
        double& modulus = gravity.values[static_cast<std::size_t>(Effects::place(EffectKind::Gravity, "shear-modulus"))];
        if (modulus == 3000.0) modulus = 0.0;
    }
    RowReader elements(db, "SELECT * FROM effect_elements");
    while (elements.next()) {
        const EffectKind kind = kindOf(elements);
        const PartId element = readId(elements);
        require(isOfElements(kind) && document.elements.contains(element), "an effect is on an element that is not there");
        document.effects[kind].elements.insert(element);
    }
}

}  // namespace imomushi
