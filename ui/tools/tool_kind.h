// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace imomushi {

struct Element;

/// The tools of the viewport: select; joint faces; bones; handles; pose (drag endpoints and handles); touch (fingers on the surface); a proposal
/// (ToolHost::propose()).
enum class ToolKind { Select, Face, Bone, Handle, Pose, Touch, Proposal };

/// Where drags go to.
struct SnapSettings {
    bool on = false;  ///< Ctrl turns it round while something is dragged
    bool grid = true, angle = true, vertices = false, edges = false, surface = false, middle = false, ends = false;
    double step = 0.0;                            ///< of the grid, m; 0: as fine as it is seen
    double angleStep = 3.14159265358979 / 12.0;   ///< radians
    static constexpr double kSmallestStep = 1e-6, kLargestStep = 1e3, kSmallestAngle = 1e-3, kLargestAngle = 3.14159265358979;
    bool operator==(const SnapSettings&) const = default;
};

/// The axes of the gizmo, and of X, Y and Z while something is dragged: of the world, of what is selected, of the view.
enum class GizmoSpace { World, Local, View };

/// What the gizmo has: all that it may do there, or what moves, turns or scales alone.
enum class GizmoParts { All, Move, Turn, Scale };

/// What an artist chose for tools.
struct ToolOptions {
    /// Flesh of these elements that is dragged gets a passing handle there: they are soft within a moment. The nearest bone or handle moves that of others. Empty: of all.
    std::function<bool(const Element&)> passingHandles = {};
    SnapSettings snap = {};
    bool gizmo = true;
    GizmoSpace space = GizmoSpace::World;
    GizmoParts parts = GizmoParts::All;
    bool turnKey = true;    ///< R turns what is selected, as G moves it; else R chooses what the gizmo has
    bool symmetry = false;  ///< what is placed, edited and posed on one side is so on the other (Symmetry)
};

}  // namespace imomushi
