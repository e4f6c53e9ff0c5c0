// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/accuracy/study.h"
#include "core/document/session.h"

namespace imomushi {

/// What the document asks for now, as a point of a study.
AccuracySetting presentSetting(const Document& document);

/// A study of the document's character: standardPoses() and three moments of each take; kept in studyFolder(). The document's effects are left out but
/// smooth joints, which are a choice of accuracy; the others are priced apart. Errors: "no-face", "no-bone", those of planCharacter().
Result<StudyInput> studyInput(Session& session);

/// The commands that take over a point, in order; none where it is what the document has. Empty solver meshes of elements that keep their own.
std::vector<Json> settingCommands(const Document& document, const AccuracySetting& setting);

}  // namespace imomushi
