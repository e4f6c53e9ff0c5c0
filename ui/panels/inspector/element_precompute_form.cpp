// SPDX-License-Identifier: GPL-3.0-or-later
#include <QLocale>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/document/body_error.h"
#include "ui/models/texts.h"
#include "ui/panels/inspector/inspector_forms.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

using MeshKind = SolverMeshSetting::Kind;

QString percentText(double share) { return ElementForm::tr("%1 %").arg(QLocale().toString(100.0 * share, 'g', 2)); }
QString scientific(double value) { return value == 0.0 ? QStringLiteral("0") : QLocale().toString(value, 'e', 1); }

/// What a kind of solver mesh begins with on `element`: half or twice the vertices of the body.
SolverMeshSetting firstSetting(MeshKind kind, const Element& element) {
    const auto vertices = int(std::min<Eigen::Index>(element.mesh->body.vertices.rows(), SolverMeshSetting::kMax));
    int count = 0;
    if (kind == MeshKind::Refined) count = std::min(2 * vertices, SolverMeshSetting::kMax);
    if (kind == MeshKind::Decimated) count = std::max(vertices / 2, SolverMeshSetting::kFewest);
    if (kind == MeshKind::Volume) count = SolverMeshSetting::kVolumeVertices;
    return {kind, count};
}

}  // namespace

void ElementForm::addSolverMesh(const Items& items) {
    // The setting that all share.
    const auto common = [this, items] {
        return commonValue(items, [this](const SelectionItem& item) -> std::optional<SolverMeshSetting> {
            const Element* e = element(item);
            return e ? std::optional(e->solverMesh) : std::nullopt;
        });
    };
    const auto command = [this](const SelectionItem& item, const SolverMeshSetting& setting) {
        return commands::set(path(item), commands::element::kSolverMesh, solverMeshName(setting));
    };
    // Gives each element the setting that `change` makes of its own.
    const auto changeAll = [this, items, command](auto change) {
        std::vector<Json> wanted;
        for (const SelectionItem& item : items) {
            const Element* e = element(item);
            if (!e) continue;
            if (const SolverMeshSetting setting = change(*e); !(setting == e->solverMesh)) wanted.push_back(command(item, setting));
        }
        executeTogether(document_, wanted);
    };
    addChoice<MeshKind>(tr("Solver mesh"),
                        {{tr("Default"), MeshKind::Default}, {tr("Best"), MeshKind::Best}, {tr("As it is"), MeshKind::AsIs}, {tr("Refined"), MeshKind::Refined}, {tr("Decimated"), MeshKind::Decimated}, {tr("Draft"), MeshKind::Draft}, {tr("Tetrahedra"), MeshKind::Volume}},
                        [common]() -> std::optional<MeshKind> {
                            const auto setting = common();
                            return setting ? std::optional(setting->kind) : std::nullopt;
                        },
                        [changeAll](MeshKind kind) { changeAll([kind](const Element& e) { return e.solverMesh.kind == kind ? e.solverMesh : firstSetting(kind, e); }); });
    const auto counted = [common] {
        const auto setting = common();
        return setting && setting->count > 0;
    };
    if (counted())
        addNumber(tr("To vertices"), {{}, SolverMeshSetting::kFewest, SolverMeshSetting::kMax, 10.0, 0, 1.0, {}}, items,
                  [this](const SelectionItem& item) -> std::optional<double> {
                      const Element* e = element(item);
                      return e ? std::optional(double(e->solverMesh.count)) : std::nullopt;
                  },
                  [this, command](const SelectionItem& item, double value) {
                      const Element* e = element(item);
                      SolverMeshSetting setting = e ? e->solverMesh : SolverMeshSetting{MeshKind::Refined};
                      setting.count = int(std::lround(value));
                      return command(item, setting);
                  });
    follow([this, counted, hadCount = counted()] {
        if (counted() != hadCount) askForRows();  // again while a gesture keeps the rows from being made
    });
}

bool ElementForm::hasFaces(const SelectionItem& item) const {
    const Element* e = element(item);
    return e && !e->faces.empty();
}

const Element* ElementForm::sharedWith(const SelectionItem& item) const {
    const auto* shared = hasFaces(item) ? document_.session().sharedResponse(item.part) : nullptr;
    return shared ? element({SelectionItem::Kind::Element, shared->from, {}, false}) : nullptr;
}

void ElementForm::addShared(const SelectionItem& item) {
    if (!sharedWith(item)) return;
    addFact(tr("Shared with"), [this, item] {
        const Element* other = sharedWith(item);
        return other ? QString::fromStdString(other->name) : QString();
    });
}

void ElementForm::addPrecompute(const SelectionItem& item) {
    addSection(tr("Precompute"));
    addFact(tr("State"), [this, item] {
        if (!hasFaces(item)) return tr("needs a joint face");
        switch (document_.session().responseState(item.part)) {
            case Session::ResponseState::Fresh: return tr("Up to date");
            case Session::ResponseState::Stale: return document_.session().responses().isDraft(item.part) ? tr("Draft") : tr("Out of date");
            case Session::ResponseState::None: break;
        }
        return tr("Not yet");
    });
    if (!hasFaces(item)) {
        follow([this, item] {
            if (hasFaces(item)) askForRows();
        });
        return;
    }
    addSolverMesh({item});
    const auto response = [this, item] { return hasFaces(item) ? document_.session().response(item.part) : nullptr; };
    if (response()) addResponse(item);
    else addEstimate(item);
    // Which rows there are follows the state.
    const auto rows = [this, item, response] {
        const auto r = response();
        return std::tuple(hasFaces(item), r != nullptr, r && r->quality.decimated, sharedWith(item) != nullptr);
    };
    follow([this, rows, had = rows()] {
        if (rows() != had) askForRows();
    });
}

void ElementForm::addResponse(const SelectionItem& item) {
    const auto response = [this, item] { return hasFaces(item) ? document_.session().response(item.part) : nullptr; };
    const auto fact = [this, response](const QString& label, std::function<QString(const ElementResponse&)> say) {
        addFact(label, [response, say = std::move(say)] {
            const auto r = response();
            return r ? say(*r) : QStringLiteral("–");
        });
    };
    fact(tr("Estimated error"), [](const ElementResponse& r) { return r.quality.error < 0.0 ? tr("not known") : percentText(r.quality.error); });
    if (response()->quality.decimated) {
        fact(tr("Mapping error"), [](const ElementResponse& r) { return percentText(r.quality.mappingError); });
        fact(tr("Shape error"), [](const ElementResponse& r) { return percentText(r.quality.shapeError); });
    }
    if (const double ofBody = bodyError(document_.document(), *document_.document().elements.at(item.part)); ofBody != 0.0) {
        fact(tr("Error of the wrap"), [ofBody](const ElementResponse&) { return ofBody < 0.0 ? tr("not known") : percentText(ofBody); });
        fact(tr("Total error"), [ofBody](const ElementResponse& r) {
            return r.quality.error < 0.0 || ofBody < 0.0 ? tr("not known") : percentText(r.quality.error + r.quality.mappingError + ofBody);
        });
    }
    fact(tr("Time taken"), [](const ElementResponse& r) { return r.quality.seconds > 0.0 ? durationText(r.quality.seconds) : tr("not known"); });  // files do not tell
    addShared(item);
    fact(tr("Solved on"), [](const ElementResponse& r) {
        const QLocale locale;
        const QString vertices = tr("%1 vertices").arg(locale.toString(r.quality.solverVertices));
        return r.quality.solverNodes == r.quality.solverVertices ? vertices : tr("%1, %2 nodes").arg(vertices, locale.toString(r.quality.solverNodes));
    });
    fact(tr("Columns"), [](const ElementResponse& r) { return QLocale().toString(r.columns()); });
    fact(tr("Memory"), [](const ElementResponse& r) { return bytesText(double(r.bytes())); });
    fact(tr("Residual"), [](const ElementResponse& r) { return scientific(r.quality.solve.residual); });
    fact(tr("Condition"), [](const ElementResponse& r) { return scientific(r.quality.solve.rcond); });
    fact(tr("Asymmetry"), [](const ElementResponse& r) { return tr("%1 %").arg(QLocale().toString(100.0 * r.quality.asymmetry, 'f', 2)); });
}

void ElementForm::addEstimate(const SelectionItem& item) {
    // Measured on the reference bodies (see solvedBody()); only solving tells of the others.
    addFact(tr("Typical error"), [this, item] {
        const Element* e = element(item);
        switch (e ? e->solverMesh.kind : MeshKind::Refined) {
            case MeshKind::Default: return tr("below %1").arg(percentText(0.02));
            case MeshKind::Best: return tr("below %1").arg(percentText(0.01));
            case MeshKind::AsIs: return tr("up to %1").arg(percentText(0.23));
            default: return tr("known afterwards");
        }
    });
    addFact(tr("Will take"), [this, item] {
        if (!hasFaces(item)) return QStringLiteral("–");
        const ResponseEstimate* estimate = document_.estimateOf(item.part);
        return estimate ? tr("about %1, %2").arg(durationText(estimate->seconds), bytesText(double(estimate->bytes))) : QStringLiteral("…");
    });
    addShared(item);
    auto* button = new QPushButton(themedIcon(QStringLiteral("precompute"), Appearance::Role::OnAccent), tr("Precompute"), this);
    button->setProperty("primary", true);
    connect(button, &QPushButton::clicked, this, &InspectorForm::precomputeWanted);
    sections_->addWidget(button);
}

}  // namespace imomushi
