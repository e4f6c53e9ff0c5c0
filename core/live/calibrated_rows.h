// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/document/character_input.h"
#include "core/document/document.h"
#include "core/input/correction.h"

namespace imomushi {

/// How far at most what a source drives is from where the character has it, when the source says what it said in a calibrated pose. None: nothing of that kind is driven.
struct CalibrationResidual {
    std::optional<double> degrees;  ///< of turns
    std::optional<double> mm;       ///< of places
    std::optional<double> percent;  ///< of the range of weights
};

/// What calibrations of sources make of rows of the document's table. What is three numbers of one channel that turn or place one thing is corrected as one, other numbers each by itself. Triggers,
/// rows that toggle, cycles and effects are left alone: a pose does not say what they should be. Rows are asked for what the pose has, back through their curves.
struct CalibratedRows {
    std::vector<Correction> corrections;
    std::vector<int> correctionOf;  ///< of each row of the table, -1: none
    struct OfPose {
        std::string source, pose;
        std::size_t rows = 0;       ///< that were measured in it
        CalibrationResidual off;
        std::string alike;          ///< another pose (its name, or empty for rest), where isAlike
        bool isAlike = false;       ///< of what the character has elsewhere in that pose, the source says nothing else
    };
    std::vector<OfPose> poses;      ///< of all calibrated sources; those alone that are there
    [[nodiscard]] const OfPose* find(std::string_view source, std::string_view pose) const;  ///< null: it is not calibrated there
};

CalibratedRows calibratedRows(const Document& document, const CharacterPlan& plan);

}  // namespace imomushi
