// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/document/document.h"
#include "core/mesh/rig.h"

namespace imomushi {

/// A face that a VRM file has ready: weights of morph targets.
struct AvatarExpression {
    std::string name;                                    ///< of a preset of VRM 1.0 ("aa", "blink", "happy"), or the file's own
    std::vector<std::pair<std::string, double>> morphs;  ///< targets by their names, and how much of each, 0 ... 1
};

/// What of Rig::avatar is used here (vrm_reader.h says all of it). What does not fit is left out: a project may say anything.
struct AvatarFacts {
    std::string version;                                         ///< "0.x" or "1.0"; empty: it is no avatar
    std::vector<std::pair<std::string, std::string>> licence;    ///< fields and what they say, in the order of the file
    std::vector<AvatarExpression> expressions;
    std::size_t springs = 0;
    bool firstPerson = false, lookAt = false;
};
AvatarFacts avatarFacts(const Rig& rig);

/// Which of its expressions a character shows whole: -1: none of them moves anything; nothing: a part of one, or several.
std::optional<int> shownExpression(const Document& document, const CharacterSource& character, const std::vector<AvatarExpression>& expressions);

}  // namespace imomushi
