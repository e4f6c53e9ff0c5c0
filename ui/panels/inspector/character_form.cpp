// SPDX-License-Identifier: GPL-3.0-or-later
#include <QLocale>

#include "core/base/parallel.h"
#include "ui/models/body_texts.h"
#include "ui/models/texts.h"
#include "ui/panels/inspector/inspector_forms.h"

namespace imomushi {

CharacterForm::CharacterForm(StudioDocument& document, QWidget* parent) : InspectorForm(document, parent) {
    addHeading(QStringLiteral("character"), [] { return tr("Character"); }, {});
    addSection();
    const auto choose = [this](auto property) {
        return [this, property](const auto& value) { document_.execute(commands::set(commands::character::kTarget, property, value)); };
    };
    addChoice<std::string>(tr("Joint shapes"),
                           {{tr("None"), "affine"},
                            {tr("None, without twist"), "paper"},
                            {QStringLiteral("6"), "modes:6"},
                            {QStringLiteral("12"), "modes:12"},
                            {QStringLiteral("24"), "modes:24"},
                            {tr("All"), "full"}},
                           [this] { return basisName(now().settings.basis); }, choose(commands::character::kBasis));
    addChoice<std::string>(tr("Number format"), {{tr("Float (4 bytes)"), "float"}, {tr("Half (2 bytes)"), "half"}, {tr("Integer (2 bytes)"), "int16"}},
                           [this] { return formatName(now().settings.format); }, choose(commands::character::kFormat));
    addFact(tr("Format error"), [this] {
        const Character* character = document_.session().character();
        return character ? tr("%1 %").arg(QLocale().toString(100.0 * character->formatError(), 'g', 2)) : QStringLiteral("–");
    });
    std::vector<std::pair<QString, int>> threads = {{tr("All (%1)").arg(hardwareThreads()), 0}};
    for (int n = 1; n <= hardwareThreads(); ++n) threads.emplace_back(QString::number(n), n);
    addChoice<int>(tr("Threads"), threads, [this] { return now().settings.threads; }, choose(commands::character::kThreads));
    std::vector<std::pair<QString, int>> rates;
    for (const int rate : CharacterSettings::kRates) rates.emplace_back(tr("%1 Hz").arg(rate), rate);
    addChoice<int>(tr("Steps per second"), rates, [this] { return now().settings.rate; }, choose(commands::character::kRate));

    addNumber(tr("Trunk stays upright"), {{}, 0.0, CharacterSettings::kMostFollow, 0.01, 2, 1.0, 0.0}, {SelectionItem{}},
              [this](const SelectionItem&) { return std::optional(now().settings.bodyFollows); },
              [](const SelectionItem&, double value) { return commands::set(commands::character::kTarget, commands::character::kBodyFollows, value); });

    addSection(tr("Contents"));
    addFact(tr("Elements"), [this] { return QLocale().toString(qlonglong(now().elements.size())); });
    addFact(tr("Joints"), [this] { return QLocale().toString(qlonglong(now().joints.size())); });
    addFact(tr("Bones"), [this] { return QLocale().toString(qlonglong(now().bones.size())); });
    addFact(tr("Vertices"), [this] { return QLocale().toString(verticesOf(now())); });
    addFact(tr("Precomputed"), [this] {
        int fresh = 0, all = 0;
        double bytes = 0.0;
        for (const auto& [id, e] : now().elements) {
            if (e->faces.empty()) continue;
            ++all;
            if (document_.session().responseState(id) != Session::ResponseState::Fresh) continue;
            ++fresh;
            if (const auto response = document_.session().response(id)) bytes += double(response->bytes());
        }
        return all == 0 ? tr("nothing to do") : tr("%1 of %2, %3").arg(fresh).arg(all).arg(bytesText(bytes));
    });
}

}  // namespace imomushi
