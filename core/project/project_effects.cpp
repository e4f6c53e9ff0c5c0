// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <utility>

#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

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
    for (const auto& [name, state] : document.unknown.effects) effects.row(name, state);
    for (const auto& [of, values] : document.unknown.properties) settings.row(of.first, of.second, values[0], values[1], values[2]);
    for (const auto& [name, on] : document.unknown.elements)
        for (const PartId element : on)
            if (document.elements.contains(element)) elements.row(name, element);
}

void readEffects(Database& db, Document& document) {
    // What this program does not know stays as rows.
    const auto known = [](const std::string& effect) {
        require(isUtf8(effect), "a text is not UTF-8");
        return effectNamed(effect);
    };
    UnknownRows& unknown = document.unknown;
    RowReader effects(db, "SELECT * FROM effects");
    while (effects.next()) {
        const std::string name = effects.text();
        const auto state = static_cast<int>(effects.integer(0, 2));
        const auto kind = known(name);
        if (!kind) {
            unknown.effects.emplace(name, state);
            continue;
        }
        require(state < 2 || effectDescriptor(*kind).canBeAutomatic, "an effect cannot be automatic");
        document.effects[*kind].enabled = state > 0;
        document.effects[*kind].automatic = state == 2;
    }
    RowReader settings(db, "SELECT * FROM effect_settings");
    while (settings.next()) {
        const std::string effect = settings.text(), name = readUtf8(settings);
        const auto kind = known(effect);
        const auto properties = kind ? effectProperties(*kind) : std::span<const EffectProperty>();
        const auto property = std::find_if(properties.begin(), properties.end(), [&](const EffectProperty& p) { return p.name == name; });
        if (property == properties.end()) {
            const double x = settings.real(), y = settings.real(), z = settings.real();
            unknown.properties.emplace(std::pair(effect, name), std::array{x, y, z});
            continue;
        }
        for (int i = 0; i < property->size; ++i)
            document.effects[*kind].values[static_cast<std::size_t>(Effects::valueOffset(*kind, name) + i)] = settings.real(property->low, property->high);
    }
    RowReader elements(db, "SELECT * FROM effect_elements");
    while (elements.next()) {
        const std::string effect = elements.text();
        const PartId element = readId(elements);
        require(document.elements.contains(element), "an effect is on an element that is not there");
        const auto kind = known(effect);
        require(!kind || isOfElements(*kind), "an effect is on an element that is not there");
        (kind ? document.effects[*kind].elements : unknown.elements[effect]).insert(element);
    }
}

}  // namespace imomushi
