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

/// Where a bone's end takes its place from: itself, or the end of another bone that it is at.
EndpointRef ownerOf(const Document& document, EndpointRef end) {
    for (std::size_t i = 0; i < document.bones.size(); ++i) {
        const auto found = document.bones.find(end.bone);
        if (found == document.bones.end()) break;
        const auto* other = std::get_if<EndpointRef>(end.atEnd ? &found->second->end : &found->second->start);
        if (!other) break;
        end = *other;
    }
    return end;
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
    if (!several) addLength(one);
    const auto number = [this](double Bone::*member) {
        return [this, member](const SelectionItem& item) -> std::optional<double> {
            const Bone* b = bone(item);
            return b ? std::optional(b->*member) : std::nullopt;
        };
    };
    const Bone standard;
    addProperty(tr("Roll"), {QStringLiteral("°"), -std::numbers::pi, std::numbers::pi, 1.0, 1, kDegrees, standard.roll}, items, number(&Bone::roll), commands::bone::kRoll);
    if (!several)
        for (const bool atEnd : {false, true}) addEnd(one, atEnd);
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

void BoneForm::addLength(const SelectionItem& item) {
    addFact(tr("Length"), [this, item] {
        const Bone* b = bone(item);
        if (!b) return QStringLiteral("–");
        const auto from = restPosition(now(), b->start), to = restPosition(now(), b->end);
        return from && to ? lengthText((*to - *from).norm()) : QStringLiteral("–");
    });
}

/// What the end is at, and where; numbers move all bones that meet there, as a drag does.
void BoneForm::addEnd(const SelectionItem& item, bool atEnd) {
    addSection(atEnd ? tr("End at rest") : tr("Start at rest"));
    const auto placeOf = [this, item, atEnd]() -> std::optional<Bone::Place> {
        const Bone* b = bone(item);
        return b ? std::optional(atEnd ? b->end : b->start) : std::nullopt;
    };
    const auto restOf = [this, placeOf]() -> std::optional<Vec3> {
        const auto place = placeOf();
        if (!place) return std::nullopt;
        const auto at = restPosition(now(), *place);
        return at ? std::optional(*at) : std::nullopt;
    };
    std::vector<std::pair<QString, std::string>> places = {{tr("a point"), {}}};
    const auto add = [&](const std::string& path) { places.emplace_back(QString::fromStdString(path), path); };
    const auto below = subtree(now(), item.part);  // these begin where it is
    for (const auto& [id, b] : now().bones)
        for (const bool end : {false, true})
            if (!below.contains(id)) add(pathOf(now(), EndpointRef{id, end}));
    for (const auto& [id, e] : now().elements)
        for (const JointFace& face : e->faces)
            if (!e->handleOf(face.name)) add(pathOf(now(), FaceRef{id, face.name}));
    addChoice<std::string>(atEnd ? tr("End") : tr("Start"), places,
                           [this, placeOf]() -> std::optional<std::string> {
                               const auto place = placeOf();
                               if (!place) return std::nullopt;
                               if (const auto* face = std::get_if<FaceRef>(&*place)) return pathOf(now(), *face);
                               if (const auto* end = std::get_if<EndpointRef>(&*place)) return pathOf(now(), *end);
                               return std::string();
                           },
                           [this, item, atEnd, restOf](const std::string& place) {
                               if (!place.empty()) document_.execute(commands::placeEnd(path(item), atEnd, place));
                               else if (const auto at = restOf()) document_.execute(commands::placeEnd(path(item), atEnd, *at));
                           });
    static constexpr const char* kAxes[] = {"X", "Y", "Z"};
    for (int axis = 0; axis < 3; ++axis)
        addNumber(QLatin1String(kAxes[axis]), {QStringLiteral("m"), -1e6, 1e6, 0.005, 4, 1.0, {}}, {item},
                  [restOf, axis](const SelectionItem&) -> std::optional<double> {
                      const auto at = restOf();
                      return at ? std::optional((*at)[axis]) : std::nullopt;
                  },
                  [this, atEnd, restOf, axis](const SelectionItem& of, double value) {
                      Vec3 at = restOf().value_or(Vec3::Zero());
                      at[axis] = value;
                      const EndpointRef owner = ownerOf(now(), {of.part, atEnd});
                      return commands::placeEnd(path({Kind::Bone, owner.bone, {}, false}), owner.atEnd, at);
                  });
}

}  // namespace imomushi
