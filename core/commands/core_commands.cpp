// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/core_commands.h"

namespace imomushi {

void addCoreCommands(CommandRegistry& registry) {
    addFileCommands(registry);
    addImportCommands(registry);
    addRigCommands(registry);
    addRepairCommands(registry);
    addAppendCommand(registry);
    addDuplicateCommand(registry);
    addMirrorCommand(registry);
    addTransformCommand(registry);
    addCopyCommand(registry);
    addPasteCommand(registry);
    addReplaceCommand(registry);
    addElementCommands(registry);
    addCutCommands(registry);
    addProposalCommands(registry);
    addMakeSoftCommand(registry);
    addHandleCommands(registry);
    addAttachCommands(registry);
    addMorphCommands(registry);
    addAvatarCommands(registry);
    addBoneCommands(registry);
    addPropertyCommands(registry);
    addEffectCommands(registry);
    addKeptPoseCommands(registry);
    addCycleCommands(registry);
    addMappingCommands(registry);
    addCalibrationCommands(registry);
    addPoseCheckCommands(registry);
    addSolveCommands(registry);
    addPoseCommands(registry);
    addTakeCommands(registry);
    addExportCommands(registry);
    addHistoryCommands(registry);
    addMeasureCommands(registry);
}

}  // namespace imomushi
