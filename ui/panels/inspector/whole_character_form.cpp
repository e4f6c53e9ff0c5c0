// SPDX-License-Identifier: GPL-3.0-or-later
#include <QLocale>
#include <QPushButton>
#include <algorithm>

#include "core/document/avatar.h"
#include "core/document/morph_weights.h"
#include "core/mesh/bounds.h"
#include "ui/models/body_texts.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/panels/inspector/inspector_forms.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

/// Gaps that get a row of their own; the list of issues has all.
constexpr std::size_t kGapRows = 6;
/// Weight per pixel of a drag: a hundred for the whole of a target.
constexpr double kMorphStep = 0.01;

}  // namespace

WholeCharacterForm::WholeCharacterForm(StudioDocument& document, const SelectionItem& item, QWidget* parent) : InspectorForm(document, parent) {
    addHeading(QStringLiteral("character"), [this, item] { return title(item); }, tr("Character"));
    addSection();
    addName(item);
    const CharacterSource* character = characterOf(now(), item);
    if (!character) return;
    follow([this, item, made = character->body, model = character->model] {
        const CharacterSource* c = characterOf(now(), item);
        if (c && (c->body != made || c->model != model)) askForRows();
    });
    addBody(*character);
    addGaps(*character);
    addSection(tr("Contents"));
    const auto count = [](qlonglong n) { return QLocale().toString(n); };
    const TriangleMesh& mesh = character->model->mesh.body;
    addFact(tr("Parts"), [count, n = character->model->parts.size()] { return count(qlonglong(n)); });
    addFact(tr("Vertices"), [count, n = mesh.vertices.rows()] { return count(n); });
    addFact(tr("Triangles"), [count, n = mesh.triangles.rows()] { return count(n); });
    addFact(tr("Elements"), [this, count, id = character->id] { return count(qlonglong(now().elementsOf(id).size())); });
    addFact(tr("Cuts"), [this, item] {
        const CharacterSource* c = characterOf(now(), item);
        QStringList names;
        for (std::size_t i = 0; c && i < c->cuts.size(); ++i) names << QString::fromStdString(c->cuts[i].name);
        return names.isEmpty() ? tr("none") : names.join(QStringLiteral(", "));
    });
    addAvatar(item);
    addMorphs(item);
    addParts(item);
}

void WholeCharacterForm::addBody(const CharacterSource& character) {
    const Body& body = *character.body;
    const BodyReport& report = body.report;
    const double diagonal = diagonalOf(character.model->mesh.body.vertices);
    addSection(tr("Body"));
    addFact(tr("Made"), [how = report.how] { return bodyKindText(how); });
    addFact(tr("Vertices"), [n = body.mesh.vertices.rows()] { return QLocale().toString(qlonglong(n)); });
    const auto distance = [diagonal](double share) { return share == 0.0 ? tr("none") : tr("%1 (%2)").arg(lengthText(share * diagonal), diagonalShareText(share)); };
    addFact(tr("Distance"), [distance, d = report.distanceRms] { return distance(d); });
    addFact(tr("Largest distance"), [distance, d = report.distanceLargest] { return distance(d); });
    addFact(tr("Volume error"), [e = report.volumeError] { return e < 0.0 ? tr("unknown: the mesh encloses none") : tr("%1 %").arg(QLocale().toString(100.0 * e, 'g', 2)); });
    if (report.detail > 0.0) addFact(tr("Detail"), [d = report.detail] { return diagonalShareText(d); });
    if (report.components > 1) addFact(tr("Separate surfaces"), [n = report.components] { return QLocale().toString(n); });
}

void WholeCharacterForm::addMorphs(const SelectionItem& item) {
    const CharacterSource& character = *characterOf(now(), item);
    if (character.model->morphs.empty()) return;
    addSection(tr("Morph targets"));
    for (std::size_t t = 0; t < character.model->morphs.size(); ++t) {
        const MorphTarget& target = character.model->morphs[t];
        addNumber(QString::fromStdString(target.name), {{}, -kLargestMorphWeight, kLargestMorphWeight, kMorphStep, 3, 1.0, target.atRest}, {item},
                  [this, name = target.name](const SelectionItem& of) -> std::optional<double> {
                      const CharacterSource* c = characterOf(now(), of);
                      const int known = c ? c->model->morphIndex(name) : -1;
                      return known < 0 ? std::nullopt : std::optional(morphWeight(now(), *c, known));
                  },
                  [this, name = target.name](const SelectionItem& of, double weight) { return commands::morph(characterOf(now(), of)->name, name, weight); });
    }
}

void WholeCharacterForm::addAvatar(const SelectionItem& item) {
    const CharacterSource& character = *characterOf(now(), item);
    const AvatarFacts facts = character.rig ? avatarFacts(*character.rig) : AvatarFacts();
    if (facts.version.empty()) return;
    addSection(tr("Avatar (VRM %1)").arg(QString::fromStdString(facts.version)));
    if (!facts.expressions.empty()) {
        std::vector<std::pair<QString, int>> choices = {{tr("none"), -1}};
        for (std::size_t i = 0; i < facts.expressions.size(); ++i) choices.emplace_back(QString::fromStdString(facts.expressions[i].name), int(i));
        const auto shown = [this, item, all = facts.expressions]() -> std::optional<int> {
            const CharacterSource* c = characterOf(now(), item);
            if (!c) return std::nullopt;
            return shownExpression(now(), *c, all);
        };
        addChoice<int>(tr("Expression"), choices, shown, [this, item, all = facts.expressions](const int& i) {
            document_.execute(commands::express(characterOf(now(), item)->name, all[std::size_t(std::max(i, 0))].name, i < 0 ? 0.0 : 1.0));
        });
    }
    addFact(tr("Humanoid bones"), [n = character.rig->roles.size()] { return QLocale().toString(qlonglong(n)); });
    if (facts.springs > 0) addFact(tr("Springs"), [n = facts.springs] { return tr("%n, kept for export", nullptr, int(n)); });
    addSection(tr("Licence of the avatar"));
    // The fields are the file's own words, in any language.
    for (const auto& [field, said] : facts.licence)
        addFact(QString::fromStdString(field), [text = QString::fromStdString(said)] { return text; });
}

void WholeCharacterForm::addGaps(const CharacterSource& character) {
    const ClosedGaps& gaps = character.body->report.gaps;
    if (gaps.places.empty()) return;
    addSection(tr("Gaps that the body closes"));
    addFact(tr("Walls"), [a = gaps.area] { return tr("%1 % of the surface").arg(QLocale().toString(100.0 * a, 'g', 2)); });
    addFact(tr("Width"), [g = gaps] { return tr("%1 to %2").arg(diagonalShareText(g.narrowest), diagonalShareText(g.widest)); });
    for (std::size_t i = 0; i < std::min(gaps.places.size(), kGapRows); ++i) {
        auto* show = new QPushButton(themedIcon(QStringLiteral("frame")), tr("Show"), this);
        addRow(tr("Place %1").arg(i + 1), show);
        connect(show, &QPushButton::clicked, this, [this, id = character.id, place = gaps.places[i]] { Q_EMIT placeWanted(id, place); });
    }
    if (gaps.places.size() > kGapRows) addFact(tr("More"), [n = gaps.places.size() - kGapRows] { return tr("%n more in the list of issues", nullptr, int(n)); });
}

}  // namespace imomushi
