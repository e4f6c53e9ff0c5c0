// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/drag_options.h"

#include <QActionGroup>
#include <QSettings>
#include <algorithm>
#include <iterator>
#include <type_traits>
#include <utility>

#include "ui/dialogs/snap_dialog.h"
#include "ui/viewport/tool_host.h"
#include "ui/widgets/action_set.h"

namespace imomushi {
namespace {

struct SnapRow {
    const char* action;
    bool SnapSettings::*member;
};
constexpr SnapRow kSnapRows[] = {{"snap", &SnapSettings::on},           {"snap-grid", &SnapSettings::grid},     {"snap-angle", &SnapSettings::angle}, {"snap-vertices", &SnapSettings::vertices}, {"snap-edges", &SnapSettings::edges},
                                 {"snap-surface", &SnapSettings::surface}, {"snap-middle", &SnapSettings::middle}, {"snap-ends", &SnapSettings::ends}};

const QString kStepKey = QStringLiteral("drag/grid-step"), kAngleKey = QStringLiteral("drag/angle-step"), kAnywhereKey = QStringLiteral("drag/passing-handles"), kGizmoKey = QStringLiteral("drag/gizmo"), kSpaceKey = QStringLiteral("drag/axes"), kSymmetryKey = QStringLiteral("drag/symmetry"), kPartsKey = QStringLiteral("drag/gizmo-parts");
constexpr const char* kParts[] = {"gizmo-all", "gizmo-move", "gizmo-turn", "gizmo-scale"};  // as GizmoParts counts
constexpr const char* kSpaces[] = {"axes-world", "axes-local", "axes-view"};  // as GizmoSpace counts

QString keyOf(const SnapRow& row) { return QStringLiteral("drag/") + QLatin1String(row.action); }

}  // namespace

DragOptions::DragOptions(ActionSet& actions, ToolHost& tools, std::function<bool(const Element&)> passing, std::function<void()> settle, QWidget* window)
    : QObject(window), actions_(actions), tools_(tools), passing_(std::move(passing)), settle_(std::move(settle)), window_(window) {
    const QSettings settings;
    for (const SnapRow& row : kSnapRows) {
        snap_.*row.member = settings.value(keyOf(row), snap_.*row.member).toBool();
        actions[row.action]->setChecked(snap_.*row.member);
        // What is being dragged goes on, and snaps from now on.
        connect(actions[row.action], &QAction::triggered, this, [this, row](bool on) {
            snap_.*row.member = on;
            QSettings().setValue(keyOf(row), on);
            tell();
        });
    }
    const double step = settings.value(kStepKey, snap_.step).toDouble(), angle = settings.value(kAngleKey, snap_.angleStep).toDouble();
    // Anybody may write into the settings.
    if (step >= 0.0 && step <= SnapSettings::kLargestStep) snap_.step = std::max(step, step > 0.0 ? SnapSettings::kSmallestStep : 0.0);
    if (angle >= SnapSettings::kSmallestAngle && angle <= SnapSettings::kLargestAngle) snap_.angleStep = angle;
    connect(actions["snap-steps"], &QAction::triggered, this, [this] { askSteps(); });
    anywhere_ = settings.value(kAnywhereKey, false).toBool();
    actions["passing-handles"]->setChecked(anywhere_);
    connect(actions["passing-handles"], &QAction::triggered, this, [this](bool on) {
        settle_();
        anywhere_ = on;
        QSettings().setValue(kAnywhereKey, on);
        tell();
    });
    gizmo_ = settings.value(kGizmoKey, true).toBool();
    actions["gizmo"]->setChecked(gizmo_);
    connect(actions["gizmo"], &QAction::triggered, this, [this](bool on) {
        gizmo_ = on;
        QSettings().setValue(kGizmoKey, on);
        tell();
    });
    symmetry_ = settings.value(kSymmetryKey, false).toBool();
    actions["symmetry"]->setChecked(symmetry_);
    connect(actions["symmetry"], &QAction::triggered, this, [this](bool on) {
        settle_();
        symmetry_ = on;
        QSettings().setValue(kSymmetryKey, on);
        tell();
    });
    const auto choice = [&](const auto& names, const QString& key, auto& chosen) {
        const int count = int(std::size(names));
        using Chosen = std::remove_reference_t<decltype(chosen)>;
        chosen = Chosen(std::clamp(settings.value(key, 0).toInt(), 0, count - 1));
        auto* group = new QActionGroup(this);
        for (int i = 0; i < count; ++i) {
            QAction* action = actions[names[i]];
            group->addAction(action);
            action->setChecked(int(chosen) == i);
            connect(action, &QAction::triggered, this, [this, i, key, &chosen] {
                settle_();
                chosen = Chosen(i);
                QSettings().setValue(key, i);
                tell();
            });
        }
    };
    choice(kParts, kPartsKey, parts_);
    choice(kSpaces, kSpaceKey, space_);
    tell();
}

void DragOptions::setIndustryKeys(bool on) {
    industry_ = on;
    constexpr const char* kKeys[] = {"", "W", "E", "R"};
    for (std::size_t i = 0; i < std::size(kParts); ++i) actions_.setStandard(kParts[i], on ? kKeys[i] : "");
    tell();
}

void DragOptions::tell() {
    ToolOptions options;
    options.snap = snap_;
    options.gizmo = gizmo_;
    options.space = space_;
    options.parts = parts_;
    options.turnKey = !industry_;
    options.symmetry = symmetry_;
    if (anywhere_) options.passingHandles = passing_;
    tools_.setOptions(std::move(options));
}

void DragOptions::askSteps() {
    settle_();
    auto* dialog = new SnapDialog(snap_, window_);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    connect(dialog, &SnapDialog::changed, this, [this](double step, double angle) {
        snap_.step = step;
        snap_.angleStep = angle;
        QSettings().setValue(kStepKey, step);
        QSettings().setValue(kAngleKey, angle);
        tell();
    });
    dialog->open();
}

}  // namespace imomushi
