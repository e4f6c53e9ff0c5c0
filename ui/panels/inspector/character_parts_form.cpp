// SPDX-License-Identifier: GPL-3.0-or-later
// Of the form of a whole character: how its parts follow the body.
#include <QComboBox>
#include <QGridLayout>
#include <QPushButton>
#include <algorithm>
#include <numbers>

#include "core/base/rotation_vector.h"
#include "core/document/attachments.h"
#include "core/mesh/bounds.h"
#include "ui/models/paths.h"
#include "ui/panels/inspector/inspector_forms.h"

namespace imomushi {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// Triangles with a corner in a part.
std::vector<std::int32_t> trianglesOf(const RenderModel& model, const ModelPart& part) {
    const auto& vertices = model.namedParts().verticesOf(part);
    const Triangles& all = model.mesh.body.triangles;
    std::vector<std::int32_t> triangles;
    for (Eigen::Index t = 0; t < all.rows(); ++t)
        if (std::binary_search(vertices.begin(), vertices.end(), all(t, 0))) triangles.push_back(std::int32_t(t));
    return triangles;
}

void enableRows(QGridLayout* rows, bool on) {
    for (int i = 0; i < rows->count(); ++i)
        if (QWidget* widget = rows->itemAt(i)->widget()) widget->setEnabled(on);
}

}  // namespace

void WholeCharacterForm::addParts(const SelectionItem& item) {
    const CharacterSource& character = *characterOf(now(), item);
    const ModelParts& parts = character.model->namedParts();
    for (std::int32_t p = 0; p < std::int32_t(parts.parts.size()); ++p)
        for (std::int32_t s = -1; s < std::int32_t(parts.parts[std::size_t(p)].shells.size()); ++s) parts_.push_back({p, s});
    if (parts_.size() < 2) return;
    addSection(tr("How parts follow"));
    auto* box = new QComboBox(this);
    box->setObjectName(QStringLiteral("parts"));
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(6);
    box->addItem(tr("choose one"));
    for (const ModelPart& part : parts_) box->addItem(QString::fromStdString(parts.nameOf(part)));
    addRow(tr("Part"), box);
    connect(box, &QComboBox::activated, this, [this, item](int index) {
        const CharacterSource* c = characterOf(now(), item);
        if (!c) return;
        chosen_ = index > 0 ? std::optional(parts_[std::size_t(index - 1)]) : std::nullopt;
        Q_EMIT partWanted(c->id, chosen_ ? trianglesOf(*c->model, *chosen_) : std::vector<std::int32_t>());
        refresh();
    });

    QGridLayout* ofPart = grid_;
    const auto own = [this, item]() -> const Attachment* {
        const CharacterSource* c = characterOf(now(), item);
        if (!c || !chosen_) return nullptr;
        const auto known = c->attachments.find(*chosen_);
        return known == c->attachments.end() ? nullptr : &known->second;
    };
    const auto command = [this, item, own](std::optional<std::string> mode) {
        commands::Attach made;
        const CharacterSource* c = characterOf(now(), item);
        made.character = c->name;
        made.part = c->model->namedParts().nameOf(*chosen_);
        made.mode = mode ? *mode : std::string(nameOf(own()));
        return made;
    };
    addChoice<std::string>(tr("Follows"), {{tr("by itself"), "auto"}, {tr("as flesh"), "flesh"}, {tr("rigidly"), "rigid"}},
                           [this, own]() -> std::optional<std::string> { return chosen_ ? std::optional(std::string(nameOf(own()))) : std::nullopt; },
                           [this, command](const std::string& mode) { document_.execute(commands::attach(command(mode))); });
    std::vector<std::pair<QString, PartId>> elements = {{tr("nearest"), 0}};
    for (const PartId id : now().elementsOf(character.id)) elements.emplace_back(QString::fromStdString(now().elements.at(id)->name), id);
    addChoice<PartId>(tr("Element"), elements,
                      [this, own, elements]() -> std::optional<PartId> {
                          const Attachment* a = own();
                          if (!chosen_ || !a) return std::nullopt;
                          const bool there = std::any_of(elements.begin(), elements.end(), [a](const auto& e) { return e.second == a->element; });
                          return there ? a->element : 0;
                      },
                      [this, command](PartId id) {
                          commands::Attach made = command({});
                          if (made.mode == "auto") return;
                          made.element = id == 0 ? std::string() : now().elements.at(id)->name;
                          document_.execute(commands::attach(made));
                      });
    addPivot(item, command);
    addTurn(item);
    follow([this, item, ofPart, box, own] {
        const CharacterSource* c = characterOf(now(), item);
        enableRows(ofPart, chosen_.has_value());
        if (QWidget* element = ofPart->itemAtPosition(ofPart->rowCount() - 1, 1)->widget()) element->setEnabled(own() != nullptr);
        box->setEnabled(c != nullptr);
        const bool rigid = c && chosen_ && isRigid(*c, *chosen_);
        for (QGridLayout* rows : rigidRows_) enableRows(rows, rigid);
    });
}

void WholeCharacterForm::addPivot(const SelectionItem& item, const std::function<commands::Attach(std::optional<std::string>)>& command) {
    addSection(tr("Pivot at rest"));
    rigidRows_.push_back(grid_);
    const double diagonal = diagonalOf(characterOf(now(), item)->model->mesh.body.vertices);
    const auto pivot = [this, item]() -> std::optional<Vec3> {
        const CharacterSource* c = characterOf(now(), item);
        return c && chosen_ && isRigid(*c, *chosen_) ? std::optional(pivotOf(*c, *chosen_)) : std::nullopt;
    };
    static constexpr const char* kAxes[] = {"X", "Y", "Z"};
    for (int axis = 0; axis < 3; ++axis)
        addNumber(QLatin1String(kAxes[axis]), {QStringLiteral("m"), -1e6, 1e6, 0.001 * diagonal, 4, 1.0, {}}, {item},
                  [pivot, axis](const SelectionItem&) -> std::optional<double> {
                      const auto at = pivot();
                      return at ? std::optional((*at)[axis]) : std::nullopt;
                  },
                  [pivot, command, axis](const SelectionItem&, double value) {
                      commands::Attach made = command({});
                      made.pivot = pivot().value_or(Vec3::Zero());
                      (*made.pivot)[axis] = value;
                      return commands::attach(made);
                  });
    auto* middle = new QPushButton(tr("Middle of the part"), this);
    addRow(tr("Place at"), middle);
    connect(middle, &QPushButton::clicked, this, [this, command] {
        commands::Attach made = command({});
        made.pivotInMiddle = true;
        document_.execute(commands::attach(made));
    });
}

void WholeCharacterForm::addTurn(const SelectionItem& item) {
    addSection(tr("Turn about the pivot"));
    rigidRows_.push_back(grid_);
    const auto turn = [this, item]() -> std::optional<Vec3> {
        const CharacterSource* c = characterOf(now(), item);
        if (!c || !chosen_ || !isRigid(*c, *chosen_)) return std::nullopt;
        const auto known = now().turns.find({c->id, *chosen_});
        return known == now().turns.end() ? Vec3(Vec3::Zero()) : rotationVector(known->second.target);
    };
    static constexpr const char* kAxes[] = {"X", "Y", "Z"};
    for (int axis = 0; axis < 3; ++axis)
        addNumber(tr("About %1").arg(QLatin1String(kAxes[axis])), {QStringLiteral("°"), -std::numbers::pi, std::numbers::pi, 0.5, 1, kDegreesPerRadian, 0.0}, {item},
                  [turn, axis](const SelectionItem&) -> std::optional<double> {
                      const auto now = turn();
                      return now ? std::optional((*now)[axis]) : std::nullopt;
                  },
                  [this, turn, axis](const SelectionItem& of, double value) {
                      Vec3 vector = turn().value_or(Vec3::Zero());
                      vector[axis] = value;
                      const CharacterSource* c = characterOf(now(), of);
                      return commands::turnPart(c->name, c->model->namedParts().nameOf(*chosen_), rotationOf(vector));
                  });
}

}  // namespace imomushi
