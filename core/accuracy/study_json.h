// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/accuracy/study.h"

namespace imomushi {

/// The table as JSON; what is unknown is null.
nlohmann::ordered_json studyJson(const AccuracyStudy& study);
/// Points, effects and the figures of the reference from it. Nothing of it is trusted: what does not fit is left out.
AccuracyStudy studyFromJson(const nlohmann::ordered_json& json);

/// One row per point, with titles; unknown cells are empty.
std::string studyCsv(const AccuracyStudy& study);

}  // namespace imomushi
