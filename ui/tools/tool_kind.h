// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// The tools of the viewport: select; joint faces; bones; handles; pose (drag endpoints and handles); touch (fingers on the surface).
enum class ToolKind { Select, Face, Bone, Handle, Pose, Touch };

}  // namespace imomushi
