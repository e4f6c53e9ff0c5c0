// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// The tools of the viewport: select; joint faces; bones; pose (drag endpoints); touch (fingers on the surface).
enum class ToolKind { Select, Face, Bone, Pose, Touch };

}  // namespace imomushi
