// SPDX-License-Identifier: GPL-3.0-or-later
#include <QLocale>
#include <QPushButton>
#include <QVBoxLayout>

#include "core/commands/handle_commands.h"
#include "core/mesh/bounds.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/panels/inspector/inspector_forms.h"
#include "ui/widgets/appearance.h"

namespace imomushi {

HandleForm::HandleForm(StudioDocument& document, const SelectionItem& item, QWidget* parent) : InspectorForm(document, parent) {
    addHeading(QStringLiteral("handle"), [item] { return QString::fromStdString(item.face); }, tr("Handle"));
    addSection();
    addName(item);
    addFact(tr("Element"), [this, item] { return title({SelectionItem::Kind::Element, item.part, {}, false}); });
    addFact(tr("State"), [this, item] {
        const HandleGoal* g = goal(item);
        return !g || !g->target.held ? tr("free") : g->pinned ? tr("pinned") : tr("held");
    });
    std::vector<std::pair<QString, std::string>> ends = {{tr("its element"), {}}};
    for (const auto& [id, bone] : now().bones)
        for (const bool atEnd : {false, true}) {
            const std::string path = pathOf(now(), EndpointRef{id, atEnd});
            ends.emplace_back(QString::fromStdString(path), path);
        }
    addChoice<std::string>(tr("Moves with"), ends,
                           [this, item]() -> std::optional<std::string> {
                               const Handle* h = handle(item);
                               return h && h->bone ? pathOf(now(), *h->bone) : std::string();
                           },
                           [this, item](const std::string& end) { document_.execute(commands::set(item.face, commands::handle::kBone, end)); });
    addDisc(item);
    addPlace(item);
    addButtons(item);
}

const Handle* HandleForm::handle(const SelectionItem& item) const { return handleOf(now(), item); }

const JointFace* HandleForm::face(const SelectionItem& item) const {
    const Element* e = element(item);
    const int i = e ? e->faceIndex(item.face) : -1;
    return i < 0 ? nullptr : &e->faces[std::size_t(i)];
}

const HandleGoal* HandleForm::goal(const SelectionItem& item) const {
    const auto found = now().handleGoals.find({item.part, item.face});
    return found == now().handleGoals.end() ? nullptr : &found->second;
}

void HandleForm::addDisc(const SelectionItem& item) {
    addSection(tr("Disc"));
    const double diagonal = element(item) ? diagonalOf(element(item)->mesh->body.vertices) : 1.0;
    addNumber(tr("Radius"), {QStringLiteral("m"), 0.0, kLargestHandleRadius * diagonal, 0.002 * diagonal, 4, 1.0, {}}, {item},
              [this](const SelectionItem& of) -> std::optional<double> {
                  const Handle* h = handle(of);
                  return h ? std::optional(h->radius) : std::nullopt;
              },
              [](const SelectionItem& of, double value) { return commands::set(of.face, commands::handle::kRadius, value); });
    addFact(tr("Vertices"), [this, item] { return face(item) ? QLocale().toString(qlonglong(face(item)->vertices.size())) : QString(); });
    addFact(tr("Planarity error"), [this, item] { return face(item) ? lengthText(face(item)->planarityError) : QString(); });
}

void HandleForm::addPlace(const SelectionItem& item) {
    addSection(tr("Target"));
    static constexpr const char* kAxes[] = {"X", "Y", "Z"};
    const auto shown = [this](const SelectionItem& of) -> std::optional<HandlePose> {
        if (const HandleGoal* g = goal(of); g && g->target.held) return g->target;
        const auto pose = document_.session().poseOf({of.part, of.face});
        return pose ? std::optional(*pose) : std::nullopt;
    };
    for (int axis = 0; axis < 3; ++axis)
        addNumber(QLatin1String(kAxes[axis]), {QStringLiteral("m"), -1e6, 1e6, 0.005, 4, 1.0, {}}, {item},
                  [shown, axis](const SelectionItem& of) -> std::optional<double> {
                      const auto pose = shown(of);
                      return pose ? std::optional(pose->at[axis]) : std::nullopt;
                  },
                  [shown, axis](const SelectionItem& of, double value) {
                      HandlePose pose = shown(of).value_or(HandlePose{});
                      pose.at[axis] = value;
                      return commands::dragHandle(of.face, pose.at, pose.rotation);
                  });
}

void HandleForm::addButtons(const SelectionItem& item) {
    auto* buttons = new QHBoxLayout;
    auto* pin = new QPushButton(themedIcon(QStringLiteral("pin")), {}, this);
    auto* release = new QPushButton(themedIcon(QStringLiteral("release")), tr("Release"), this);
    auto* remove = new QPushButton(themedIcon(QStringLiteral("trash")), tr("Remove"), this);
    for (QPushButton* button : {pin, release, remove}) buttons->addWidget(button);
    sections_->addLayout(buttons);
    const auto pinned = [this, item] { return isPinned(now(), FaceRef{item.part, item.face}); };
    connect(pin, &QPushButton::clicked, this, [this, item, pinned] { document_.execute(commands::setPinned(item.face, !pinned())); });
    connect(release, &QPushButton::clicked, this, [this, item] { document_.execute(commands::release(item.face)); });
    connect(remove, &QPushButton::clicked, this, [this, item] { document_.execute(commands::removeHandle(item.face)); });
    follow([this, item, pin, release, pinned] {
        pin->setText(pinned() ? tr("Unpin") : tr("Pin"));
        const HandleGoal* g = goal(item);
        release->setEnabled(g && g->target.held);
    });
}

}  // namespace imomushi
