// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// What a source of live input said while who performs stood as the character does: in rest, or in kept poses. calibratedRows() finds from it what is made of all that the source says. It belongs to the
/// rows of the source (InputMapping::calibration): it stays while there is one, whatever it maps.
struct SourceCalibration {
    static constexpr std::size_t kMostPoses = 3;
    static constexpr std::size_t kMostChannels = 4096;  ///< of a pose
    struct Pose {
        std::string name;  ///< of a kept pose; empty: rest
        std::map<std::string, std::vector<double>> said;  ///< the numbers of each channel
        bool operator==(const Pose&) const = default;
    };
    std::vector<Pose> poses;  ///< each once, 1 to 3
    bool operator==(const SourceCalibration&) const = default;
    /// Puts a pose in the place of one of its name, or at the end.
    void put(Pose pose);
};

/// Null: it is not calibrated.
const SourceCalibration* calibrationOf(const Document& document, std::string_view source);
/// Those that are, in the order of the table of mappings.
std::vector<std::string> calibratedSources(const Document& document);
/// Without poses it is none. Does nothing for a source that has no rows.
void setCalibration(Document& document, std::string_view source, SourceCalibration calibration);
/// Calibrations follow a kept pose that gets another name.
void renamePoseInCalibrations(Document& document, std::string_view from, std::string_view to);
/// Without its place in the character nobody can tell what was meant. Answers the sources that had it.
std::vector<std::string> dropPoseFromCalibrations(Document& document, std::string_view pose);

/// {"channel": [numbers], ...}, or a number for one. Errors: "bad-type", "bad-value".
Result<std::map<std::string, std::vector<double>>> saidFrom(const Json& values);
/// As a project keeps them.
Json calibrationsJson(const Document& document);
/// Gives them to the document, whose rows are there. Errors: "bad-calibration".
Result<void> readCalibrations(Document& document, const Json& list);

}  // namespace imomushi
