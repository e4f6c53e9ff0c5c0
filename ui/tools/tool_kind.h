// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace imomushi {

struct Element;

/// The tools of the viewport: select; joint faces; bones; handles; pose (drag endpoints and handles); touch (fingers on the surface); a proposal
/// (ToolHost::propose()).
enum class ToolKind { Select, Face, Bone, Handle, Pose, Touch, Proposal };

/// What an artist chose for tools.
struct ToolOptions {
    /// Flesh of these elements that is dragged gets a passing handle there: they are soft within a moment. The nearest bone or handle moves that of others. Empty: of all.
    std::function<bool(const Element&)> passingHandles;
};

}  // namespace imomushi
