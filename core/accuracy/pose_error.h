// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>

#include "core/accuracy/reference.h"

namespace imomushi {

/// A character as it is set, in one pose.
struct PoseErrorInput {
    ReferenceInput reference;  ///< its only pose is the one that is asked for
    CharacterInput shown;      ///< with its responses, without effects but smooth joints
};

/// How far it is from the full solution there.
struct PoseErrors {
    PoseError error;
    Reference reference;                    ///< in that pose
    std::vector<Points> shown;              ///< per element #body vertices x 3, world, m
    std::vector<std::vector<float>> field;  ///< see errorField()
    double seconds = 0.0;                   ///< without the full solution itself
    std::size_t bytes = 0;                  ///< that the full solution keeps
};

/// Keeps the full solution of a character, so that one pose after the other takes a moment. Basis, number format and solver meshes of the character may change meanwhile.
/// Safe to be used from several threads, one of which works at a time.
class FullSolutionKeeper {
public:
    /// Errors: those of FullSolution and of Character::build; "cancelled".
    Result<PoseErrors> measure(const PoseErrorInput& input, const Progress& progress);
    /// As buildReference(); a solution of more than `bytes` is not kept.
    Result<Reference> reference(const ReferenceInput& input, std::size_t bytes, const Progress& progress);
    /// There is a solution for this character. Does not wait.
    [[nodiscard]] bool knows(const ContentKey& reference) const;

private:
    Result<void> solve(const ReferenceInput& input, const Progress& progress);
    void name(const ContentKey& key);

    std::mutex work_;
    mutable std::mutex mutex_;  ///< of key_
    ContentKey key_;
    std::optional<FullSolution> solution_;
};

}  // namespace imomushi
