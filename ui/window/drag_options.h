// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <functional>

#include "ui/tools/tool_kind.h"

class QWidget;

namespace imomushi {

class ActionSet;
class ToolHost;

/// How things are dragged: the gizmo and its axes, the magnet and where it goes, and flesh that is taken anywhere. Kept in the settings of the studio.
class DragOptions : public QObject {
    Q_OBJECT
public:
    /// `passing`: of which elements flesh may be taken. `settle`: ends what is dragged.
    DragOptions(ActionSet& actions, ToolHost& tools, std::function<bool(const Element&)> passing, std::function<void()> settle, QWidget* window);

    /// The keys of other studios of the industry: W, E and R choose what the gizmo has. Else R turns what is selected, at once, as Blender's does.
    void setIndustryKeys(bool on);

private:
    void tell();
    void askSteps();

    ActionSet& actions_;
    ToolHost& tools_;
    std::function<bool(const Element&)> passing_;
    std::function<void()> settle_;
    QWidget* window_;
    SnapSettings snap_;
    bool anywhere_ = false;
    bool gizmo_ = true;
    bool symmetry_ = false;
    GizmoSpace space_ = GizmoSpace::World;
    GizmoParts parts_ = GizmoParts::All;
    bool industry_ = false;
};

}  // namespace imomushi
