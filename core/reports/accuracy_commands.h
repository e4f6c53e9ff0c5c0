// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/accuracy/pose_error.h"
#include "core/accuracy/study.h"
#include "core/session/session.h"

namespace imomushi {

/// What the document asks for now, as a point of a study.
AccuracySetting presentSetting(const Document& document);

/// The document's character as studies see it, in standardPoses() and three moments of each take. Its effects are left out but smooth joints, which are a choice of
/// accuracy. Errors: "no-face", "no-bone", those of planCharacter().
Result<ReferenceInput> studiedCharacter(const Session& session);

/// A study of that character, kept in studyFolder(); the effects that were left out are priced apart. Errors: those of studiedCharacter().
Result<StudyInput> studyInput(const Session& session);

/// The character as it is set, with its responses, in the pose that it shows now (wherever effects have taken its bones). Effects are left out as in
/// studies. Errors: those of studiedCharacter(), "not-precomputed".
Result<PoseErrorInput> poseErrorInput(const Session& session);

/// The commands that take over a point, in order; none where it is what the document has. Empty solver meshes of elements that keep their own.
std::vector<Json> settingCommands(const Document& document, const AccuracySetting& setting);

}  // namespace imomushi
