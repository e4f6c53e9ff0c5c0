// SPDX-License-Identifier: GPL-3.0-or-later
#include <QColorDialog>
#include <QComboBox>
#include <QCoreApplication>
#include <QGridLayout>
#include <QLocale>
#include <QToolButton>
#include <algorithm>

#include "core/base/colour.h"
#include "core/document/material_preset.h"
#include "core/mesh/connectivity.h"
#include "ui/models/effect_texts.h"
#include "ui/models/texts.h"
#include "ui/panels/inspector/inspector_forms.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/switch.h"

namespace imomushi {

ElementForm::ElementForm(StudioDocument& document, const Items& items, QWidget* parent) : InspectorForm(document, parent) {
    const SelectionItem one = items.back();
    const bool several = items.size() > 1;
    if (several) {
        addHeading(QStringLiteral("element"), [n = items.size()] { return tr("%n element(s)", nullptr, int(n)); }, {});
    } else {
        addHeading(QStringLiteral("element"), [this, one] { return title(one); }, tr("Element"));
        addSection();
        addName(one);
    }
    addMaterial(items);
    addEffects(items);
    addMesh(items);
    if (several) {
        addSection(tr("Precompute"));
        addSolverMesh(items);
    } else {
        addPrecompute(one);
    }
}

void ElementForm::addMaterial(const Items& items) {
    addSection(tr("Material"));
    addPreset(items);
    const auto number = [this](double Element::*member) {
        return [this, member](const SelectionItem& item) -> std::optional<double> {
            const Element* e = element(item);
            return e ? std::optional(e->*member) : std::nullopt;
        };
    };
    const Element standard;
    addProperty(tr("Poisson ratio"), {{}, 0.0, 0.5, 0.005, 3, 1.0, standard.nu}, items, number(&Element::nu), commands::element::kPoissonRatio);
    addProperty(tr("Stiffness"), {QStringLiteral("×"), 1e-3, 1e3, 0.02, 3, 1.0, standard.stiffness}, items, number(&Element::stiffness), commands::element::kStiffness);
    addProperty(tr("Density"), {QStringLiteral("kg/m³"), 1.0, 1e5, 10.0, 1, 1.0, standard.density}, items, number(&Element::density), commands::element::kDensity);
    addProperty(tr("Damping"), {QStringLiteral("×"), 0.0, Element::kMaxDamping, 0.05, 2, 1.0, standard.damping}, items, number(&Element::damping), commands::element::kDamping);
    addColor(items);
    addJointPlanes(items);
}

void ElementForm::addPreset(const Items& items) {
    std::vector<std::pair<QString, std::string>> choices;
    for (const MaterialPreset& preset : kMaterialPresets)
        choices.emplace_back(tr("%1: sags %2 %").arg(QCoreApplication::translate("MaterialPreset", preset.title), QLocale().toString(100.0 * preset.sag(), 'f', 0)), preset.name);
    const auto common = [this, items] {
        return commonValue(items, [this](const SelectionItem& item) -> std::optional<std::string> {
            const Element* e = element(item);
            if (!e) return std::nullopt;
            const MaterialPreset* preset = materialPresetOf(*e);
            return std::string(preset ? preset->name : "");  // "": numbers of its own
        });
    };
    auto* box = addChoice<std::string>(tr("Preset"), choices, common, [this, items](const std::string& name) {
        std::vector<Json> wanted;
        for (const SelectionItem& item : items) wanted.push_back(commands::set(path(item), commands::element::kPreset, name));
        executeTogether(document_, wanted);
    });
    box->setObjectName(QStringLiteral("materialPreset"));
    box->setToolTip(tr("Sets the four numbers below. The sag is that of a whole character of this material under default gravity, as a share of its height; the size does not matter."));
    follow([box, common] { box->setPlaceholderText(common() == std::string() ? tr("Custom") : QString()); });
}

void ElementForm::addColor(const Items& items) {
    auto* swatch = new QToolButton(this);
    swatch->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    swatch->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    addRow(tr("Colour"), swatch);
    const auto color = [this, one = items.back()] {
        const Element* e = element(one);
        const auto srgb = [](double linear) { return float(srgbFromLinear(linear)); };
        return e ? QColor::fromRgbF(srgb(e->color.x()), srgb(e->color.y()), srgb(e->color.z())) : QColor();
    };
    connect(swatch, &QToolButton::clicked, this, [this, items, color] {
        const QColor chosen = QColorDialog::getColor(color(), this, tr("Colour of the element"));
        if (!chosen.isValid()) return;
        std::vector<Json> wanted;
        for (const SelectionItem& item : items) wanted.push_back(commands::set(path(item), commands::element::kColor, chosen.name().toStdString()));
        executeTogether(document_, wanted);
    });
    follow([swatch, color] {
        const QColor shown = color();
        swatch->setStyleSheet(QStringLiteral("background: %1; border: 1px solid %2; border-radius: %3px; min-height: %4px; padding: 0px;")
                                  .arg(shown.name(), themeColor(Appearance::Role::Line).name())
                                  .arg(px(6))
                                  .arg(px(22)));
        swatch->setToolTip(shown.name());
    });
}

void ElementForm::addJointPlanes(const Items& items) {
    static constexpr const char* kPlanes[] = {"auto", "bisector", "element"};  // by Element::jointPlanes
    addChoice<std::string>(tr("Joint planes"), {{tr("Automatic"), kPlanes[0]}, {tr("Halfway between bones"), kPlanes[1]}, {tr("Turn with the element"), kPlanes[2]}},
                           [this, items] {
                               return commonValue(items, [this](const SelectionItem& item) -> std::optional<std::string> {
                                   const Element* e = element(item);
                                   return e ? std::optional<std::string>(kPlanes[int(e->jointPlanes)]) : std::nullopt;
                               });
                           },
                           [this, items](const std::string& value) {
                               std::vector<Json> wanted;
                               for (const SelectionItem& item : items) wanted.push_back(commands::set(path(item), commands::element::kJointPlanes, value));
                               executeTogether(document_, wanted);
                           });
}

void ElementForm::addEffects(const Items& items) {
    addSection(tr("Effects here"));
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        if (!isOfElements(effect)) continue;
        auto* button = new Switch(this);
        addRow(effectTitle(effect), button);
        button->setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
        grid_->setAlignment(button, Qt::AlignLeft | Qt::AlignVCenter);
        button->setToolTip(effectHelp(effect));
        const auto everywhere = [this, items, effect] {
            return std::all_of(items.begin(), items.end(), [&](const SelectionItem& item) { return element(item) && document_.turnedOn(effect, item.part); });
        };
        connect(button, &Switch::clicked, this, [this, items, effect, everywhere] {
            const bool on = !everywhere();
            std::vector<Json> wanted;
            for (const SelectionItem& item : items)
                if (element(item) && document_.turnedOn(effect, item.part) != on) wanted.push_back(commands::setEnabled(effect, on, path(item)));
            if (wanted.size() == 1) document_.executeSlow({wanted.front()});
            else executeTogether(document_, wanted);
        });
        follow([button, everywhere] { button->setChecked(everywhere()); });
    }
}

void ElementForm::addMesh(const Items& items) {
    addSection(tr("Mesh"));
    const auto sum = [this, items](auto count) {
        qlonglong n = 0;
        for (const SelectionItem& item : items)
            if (const Element* e = element(item)) n += qlonglong(count(*e));
        return QLocale().toString(n);
    };
    addFact(tr("Vertices"), [sum] { return sum([](const Element& e) { return e.mesh->body.vertices.rows(); }); });
    addFact(tr("Triangles"), [sum] { return sum([](const Element& e) { return e.mesh->body.triangles.rows(); }); });
    addFact(tr("Joint faces"), [sum] { return sum([](const Element& e) { return e.faces.size(); }); });
    const Element* e = items.size() == 1 ? element(items.back()) : nullptr;
    if (!e) return;
    const MeshFacts& facts = e->mesh->connectivity().facts();
    const Vec3 size = facts.high - facts.low;
    addFact(tr("Size"), [size] { return QStringLiteral("%1 × %2 × %3").arg(lengthText(size.x()), lengthText(size.y()), lengthText(size.z())); });
    addFact(tr("Volume"), [volume = facts.volume] { return volumeText(volume); });
}

}  // namespace imomushi
