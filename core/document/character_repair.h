// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/body/body.h"
#include "core/body/repair.h"
#include "core/document/command.h"
#include "core/document/document.h"

// Mending as a change of a document. What is seen of a character or an element is never changed: the body that moves it is made again. A character that came in unmended has
// a wrap around everything until all that is wrong with its mesh is mended; which steps are done follows from its issues.

namespace imomushi {

struct MendRequest {
    std::optional<std::vector<RepairAction>> actions;  ///< none: whatever mends the issues there are
    double detail = 0.0;  ///< of a wrap, in diagonals; 0: chosen from the mesh
};

struct MendReport {
    PartId character = 0;                       ///< 0: an element without anything to mend
    std::vector<MeshIssue> before, after;       ///< what is not mended; places are those of the render model
    std::vector<MeshIssue> done;                ///< fixed
    std::vector<RepairAction> unneeded;         ///< asked for, and nothing asked for them
    std::vector<PartId> changed;                ///< elements whose body changed
};

/// The issues of a character whose body was made of its whole render model: those of its file, and what making the body said.
std::vector<MeshIssue> issuesWith(const std::vector<MeshIssue>& before, const RenderModel& model, std::vector<MeshIssue> ofBody);

/// Of the wrap around a mesh until it is mended, in diagonals: made in a second.
inline constexpr double kPassingDetail = 1.0 / 60.0;

/// What is wrong with a mesh, for a character that comes in as it is. Empty where nothing can be mended.
std::vector<MeshIssue> mendableIssues(const RenderModel& model);

/// Mends the body of a character by bodies of `maker`. Errors: its own and changeBody(), "cancelled".
Result<MendReport> mendCharacter(Document& document, PartId character, const MendRequest& request, const BodyMaker& maker, const Progress& progress);
/// The same of an element: of its character, or of itself, which becomes a character if there is something to mend; its render model is what was seen of it.
Result<MendReport> mendElement(Document& document, PartId element, const MendRequest& request, const BodyMaker& maker, const Progress& progress);

/// The slow work of a command "repair", without the document: asks `maker` for the bodies that the command will ask for. Any thread may run it.
using MendWork = std::function<void(const BodyMaker& maker, const Progress& progress)>;
/// Errors: "bad-value", "no-such-element".
Result<MendWork> mendWork(const Document& document, const Json& repair);

/// The keys of "repair". Errors: "bad-value".
Result<MendRequest> mendRequestFrom(const Json& arguments);

}  // namespace imomushi
