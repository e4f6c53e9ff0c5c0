// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>
#include <set>

#include "core/document/character_input.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/panels/inspector/inspector_forms.h"

namespace imomushi {
namespace {

using Kind = SelectionItem::Kind;
constexpr double kDegrees = 180.0 / std::numbers::pi;

QString placeText(const Document& document, const Bone::Place& place) {
    if (const auto* face = std::get_if<FaceRef>(&place)) return QString::fromStdString(pathOf(document, *face));
    if (const auto* end = std::get_if<EndpointRef>(&place)) return QString::fromStdString(pathOf(document, *end));
    return vectorText(std::get<Vec3>(place));
}

/// The bone and all that hang on it, directly or not.
std::set<PartId> subtree(const Document& document, PartId bone) {
    std::set<PartId> found = {bone};
    for (bool grew = true; grew;) {
        grew = false;
        for (const auto& [id, b] : document.bones)
            if (found.contains(b->parent) && found.insert(id).second) grew = true;
    }
    return found;
}

}  // namespace

BoneForm::BoneForm(StudioDocument& document, const Items& items, QWidget* parent) : InspectorForm(document, parent) {
    const SelectionItem one = items.back();
    const bool several = items.size() > 1;
    if (several) {
        addHeading(QStringLiteral("bone"), [n = items.size()] { return tr("%n bone(s)", nullptr, int(n)); }, {});
    } else {
        addHeading(QStringLiteral("bone"), [this, one] { return title(one); }, tr("Bone"));
        addSection();
        addName(one);
        addPlaceInTree(one);
    }
    addSection(tr("Rest"));
    if (!several) addRestPosition(one);
    const auto number = [this](double Bone::*member) {
        return [this, member](const SelectionItem& item) -> std::optional<double> {
            const Bone* b = bone(item);
            return b ? std::optional(b->*member) : std::nullopt;
        };
    };
    const Bone standard;
    addProperty(tr("Roll"), {QStringLiteral("°"), -std::numbers::pi, std::numbers::pi, 1.0, 1, kDegrees, standard.roll}, items, number(&Bone::roll), commands::bone::kRoll);
    addSection(tr("Stretch limits"));
    addProperty(tr("Shortest"), {QStringLiteral("%"), 0.01, 1.0, 1.0, 0, 100.0, standard.minStretch}, items, number(&Bone::minStretch), commands::bone::kMinStretch);
    addProperty(tr("Longest"), {QStringLiteral("%"), 1.0, 10.0, 1.0, 0, 100.0, standard.maxStretch}, items, number(&Bone::maxStretch), commands::bone::kMaxStretch);
    addSection(tr("Turn limits"));
    addProperty(tr("Bend"), {QStringLiteral("°"), 0.0, Skeleton::Bone::kFreeBend, 1.0, 0, kDegrees, standard.maxBend}, items, number(&Bone::maxBend), commands::bone::kMaxBend);
    addProperty(tr("Twist"), {QStringLiteral("°"), 0.0, Skeleton::Bone::kFreeTwist, 1.0, 0, kDegrees, standard.maxTwist}, items, number(&Bone::maxTwist), commands::bone::kMaxTwist);
    addSection(tr("When pulled"));
    addProperty(tr("Stiffness"), {QStringLiteral("×"), 1.0 / Bone::kMaxRatio, Bone::kMaxRatio, 0.1, 3, 1.0, standard.stiffness}, items, number(&Bone::stiffness), commands::bone::kStiffness);
    addProperty(tr("Weight"), {QStringLiteral("×"), 1.0 / Bone::kMaxRatio, Bone::kMaxRatio, 0.1, 3, 1.0, standard.weight}, items, number(&Bone::weight), commands::bone::kWeight);
}

void BoneForm::addPlaceInTree(const SelectionItem& item) {
    const auto below = subtree(now(), item.part);  // a bone cannot hang on these
    std::vector<std::pair<QString, std::string>> parents = {{tr("automatic"), {}}}, elements = {{tr("none"), {}}};
    for (const auto& [id, b] : now().bones)
        if (!below.contains(id)) parents.emplace_back(QString::fromStdString(b->name), b->name);
    for (const auto& [id, e] : now().elements) elements.emplace_back(QString::fromStdString(e->name), e->name);
    addChoice<std::string>(tr("Parent"), parents,
                           [this, item] {
                               const Bone* b = bone(item);
                               return b ? path({Kind::Bone, b->parent, {}, false}) : std::string();
                           },
                           [this, item](const std::string& name) { document_.execute(commands::setBoneParent(path(item), name)); });
    addChoice<std::string>(tr("Runs through"), elements,
                           [this, item] {
                               const Bone* b = bone(item);
                               return b ? path({Kind::Element, b->element, {}, false}) : std::string();
                           },
                           [this, item](const std::string& name) { document_.execute(commands::setBoneElement(path(item), name)); });
}

void BoneForm::addRestPosition(const SelectionItem& item) {
    addFact(tr("Length"), [this, item] {
        const Bone* b = bone(item);
        if (!b) return QStringLiteral("–");
        const auto from = restPosition(now(), b->start), to = restPosition(now(), b->end);
        return from && to ? lengthText((*to - *from).norm()) : QStringLiteral("–");
    });
    addFact(tr("Start"), [this, item] { return bone(item) ? placeText(now(), bone(item)->start) : QString(); });
    addFact(tr("End"), [this, item] { return bone(item) ? placeText(now(), bone(item)->end) : QString(); });
}

}  // namespace imomushi
