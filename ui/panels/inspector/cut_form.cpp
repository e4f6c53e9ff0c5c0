// SPDX-License-Identifier: GPL-3.0-or-later
#include <QPushButton>
#include <QVBoxLayout>

#include "core/mesh/bounds.h"
#include "ui/models/paths.h"
#include "ui/panels/inspector/inspector_forms.h"
#include "ui/widgets/appearance.h"

namespace imomushi {

CutForm::CutForm(StudioDocument& document, const SelectionItem& item, QWidget* parent) : InspectorForm(document, parent) {
    addHeading(QStringLiteral("cut"), [this, item] { return title(item); }, tr("Cut"));
    addSection();
    addName(item);
    addFact(tr("Character"), [this, item] {
        const CharacterSource* character = characterOf(now(), item);
        return character ? QString::fromStdString(character->name) : QString();
    });
    addFact(tr("Behind it"), [this, item] { return beside(item, false); });
    addFact(tr("In front"), [this, item] { return beside(item, true); });
    addPlane(item);
    auto* remove = new QPushButton(themedIcon(QStringLiteral("trash")), tr("Remove the cut"), this);
    sections_->addWidget(remove);
    connect(remove, &QPushButton::clicked, this, [this, item] { document_.executeSlow({commands::removeCut(path(item))}); });
}

QString CutForm::beside(const SelectionItem& item, bool front) const {
    const CharacterSource* character = characterOf(now(), item);
    if (!character) return {};
    for (const PartId id : now().elementsOf(character->id)) {
        const Element& element = *now().elements.at(id);
        const int side = element.piece->sideIndex(item.part);
        if (side < 0 || element.piece->sides[std::size_t(side)].front != front) continue;
        const QString name = QString::fromStdString(element.name);
        switch (document_.session().responseState(id)) {
            case Session::ResponseState::Fresh: return name;
            case Session::ResponseState::Stale: return tr("%1 · out of date").arg(name);
            case Session::ResponseState::None: return tr("%1 · not precomputed").arg(name);
        }
    }
    return {};
}

std::optional<CutPlane> CutForm::plane(const SelectionItem& item) const {
    const Cut* cut = cutOf(now(), item);
    if (!cut) return std::nullopt;
    CutPlane plane = cut->plane;
    for (const Json& command : document_.underWay())
        if (const auto moved = commands::planeOfMoved(command, cut->name)) plane = *moved;
    return plane;
}

void CutForm::addPlane(const SelectionItem& item) {
    const CharacterSource* character = characterOf(now(), item);
    const double diagonal = character ? diagonalOf(character->body->mesh.vertices) : 1.0;
    static constexpr const char* kAxes[] = {"X", "Y", "Z"};
    const auto command = [this](const SelectionItem& of, const auto& change) {
        CutPlane wanted = plane(of).value_or(CutPlane());
        change(wanted);
        return commands::moveCut(path(of), wanted.origin, wanted.normal);
    };
    addSection(tr("Origin at rest"));
    for (int axis = 0; axis < 3; ++axis)
        addSlowNumber(QLatin1String(kAxes[axis]), {QStringLiteral("m"), -1e6, 1e6, 0.002 * diagonal, 4, 1.0, {}}, {item},
                  [this, axis](const SelectionItem& of) -> std::optional<double> {
                      const auto shown = plane(of);
                      return shown ? std::optional(shown->origin[axis]) : std::nullopt;
                  },
                  [command, axis](const SelectionItem& of, double value) { return command(of, [&](CutPlane& plane) { plane.origin[axis] = value; }); });
    addSection(tr("Normal at rest"));
    for (int axis = 0; axis < 3; ++axis)
        addSlowNumber(QLatin1String(kAxes[axis]), {{}, -1.0, 1.0, 0.01, 3, 1.0, {}}, {item},
                  [this, axis](const SelectionItem& of) -> std::optional<double> {
                      const auto shown = plane(of);
                      return shown ? std::optional(shown->normal.stableNormalized()[axis]) : std::nullopt;
                  },
                  [command, axis](const SelectionItem& of, double value) {
                      return command(of, [&](CutPlane& plane) {
                          plane.normal = plane.normal.stableNormalized();
                          plane.normal[axis] = value;
                      });
                  });
}

}  // namespace imomushi
