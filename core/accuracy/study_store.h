// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/accuracy/study.h"

namespace imomushi {

/// The figures of one study in a folder, one file for the table and one for the reference's positions. What cannot be read counts as not there; what cannot be written is
/// measured again some day.
class StudyStore {
public:
    /// Empty folder: keeps nothing.
    StudyStore(std::filesystem::path folder, const ContentKey& key);
    void save(const AccuracyStudy& study);
    /// `input`: what the reference must fit.
    [[nodiscard]] AccuracyStudy load(const ReferenceInput& input) const;

private:
    std::filesystem::path table_, positions_;
    bool savedPositions_ = false;
};

}  // namespace imomushi
