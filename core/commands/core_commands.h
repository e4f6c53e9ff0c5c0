// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/command.h"

namespace imomushi {

/// All commands but those that report (addReportCommands()) and draw. Adds to `registry`.
void addCoreCommands(CommandRegistry& registry);

// Each adds some commands to a registry.
void addFileCommands(CommandRegistry& registry);      // new, open, save, save-script, list
void addImportCommands(CommandRegistry& registry);    // import-element, import-character
void addRigCommands(CommandRegistry& registry);       // import-skeleton, take-clip
void addRepairCommands(CommandRegistry& registry);    // repair
void addAppendCommand(CommandRegistry& registry);     // append
void addDuplicateCommand(CommandRegistry& registry);  // duplicate
void addMirrorCommand(CommandRegistry& registry);
void addTransformCommand(CommandRegistry& registry);  // transform
void addCopyCommand(CommandRegistry& registry);       // copy
void addPasteCommand(CommandRegistry& registry);      // paste
void addReplaceCommand(CommandRegistry& registry);    // replace-mesh
void addElementCommands(CommandRegistry& registry);   // add-joint-face, join, unjoin, remove-element, remove-joint-face
void addCutCommands(CommandRegistry& registry);       // cut, move-cut, remove-cut
void addProposalCommands(CommandRegistry& registry);  // propose
void addMakeSoftCommand(CommandRegistry& registry);   // make-soft
void addHandleCommands(CommandRegistry& registry);    // handle, remove-handle
void addAttachCommands(CommandRegistry& registry);    // attach, turn-part
void addMorphCommands(CommandRegistry& registry);     // morph
void addAvatarCommands(CommandRegistry& registry);    // express
void addBoneCommands(CommandRegistry& registry);      // add-bone, edit-bone, remove-bone
void addPropertyCommands(CommandRegistry& registry);  // set, rename
void addEffectCommands(CommandRegistry& registry);    // enable, disable
void addKeptPoseCommands(CommandRegistry& registry);  // keep-pose, apply-pose, mirror-pose, rest-bones, rename-pose, remove-pose
void addCycleCommands(CommandRegistry& registry);     // add-cycle, suggest-cycles, rename-cycle, remove-cycle
void addMappingCommands(CommandRegistry& registry);   // map-input, unmap-input, suggest-mappings, save-mappings, load-mappings
void addCalibrationCommands(CommandRegistry& registry);  // calibrate-source, clear-calibration
void addPoseCheckCommands(CommandRegistry& registry); // check-pose
void addSolveCommands(CommandRegistry& registry);     // estimate, precompute, deform-element
void addPoseCommands(CommandRegistry& registry);      // pin, unpin, drag, release, touch, rest, step
void addTakeCommands(CommandRegistry& registry);      // record, play, rename-take, duplicate-take, trim-take, remove-take
void addExportCommands(CommandRegistry& registry);    // export
void addHistoryCommands(CommandRegistry& registry);   // undo, redo
void addMeasureCommands(CommandRegistry& registry);   // measure, write-mesh

}  // namespace imomushi
