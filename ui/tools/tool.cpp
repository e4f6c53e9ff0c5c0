// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/tool.h"

#include "ui/tools/bone_tool.h"
#include "ui/tools/face_tool.h"
#include "ui/tools/handle_tool.h"
#include "ui/tools/pose_tool.h"
#include "ui/tools/select_tool.h"
#include "ui/tools/touch_tool.h"

namespace imomushi {

std::unique_ptr<Tool> makeTool(ToolKind kind, StudioDocument& document) {
    switch (kind) {
        case ToolKind::Face: return std::make_unique<FaceTool>(document);
        case ToolKind::Bone: return std::make_unique<BoneTool>(document);
        case ToolKind::Handle: return std::make_unique<HandleTool>(document);
        case ToolKind::Pose: return std::make_unique<PoseTool>(document);
        case ToolKind::Touch: return std::make_unique<TouchTool>(document);
        case ToolKind::Proposal:  // begins with a proposal, not by itself
        case ToolKind::Select: break;
    }
    return std::make_unique<SelectTool>(document);
}

}  // namespace imomushi
