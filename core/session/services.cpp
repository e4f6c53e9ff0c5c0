// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/services.h"

#include "core/project/project_versions.h"
#include "core/session/proposal_request.h"

namespace imomushi {

Services coreServices() {
    const auto make = [](const RenderModel& model, const Rig* rig, const BodySetting& setting, const Progress& progress) { return makeBody(model, rig, setting, progress); };
    return {importFile, importCharacter, make, proposeFor, loadProject, storeProject};
}

}  // namespace imomushi
