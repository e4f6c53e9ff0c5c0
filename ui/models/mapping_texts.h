// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <optional>
#include <string>
#include <vector>

#include "core/document/input_mapping.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// What a mapping drives, in words.
struct TargetText {
    QString thing;        ///< "tip"; of what is not there, the target as it is written
    QString number;       ///< "up (Y)"; empty where it is not there
    QString unit;         ///< "m", "°", or none
    double factor = 1.0;  ///< shown = value * factor
    bool there = false;
    bool trigger = false; ///< it lets something happen: several rows may
    QString mark;         ///< the number in a few signs, "Y ↕"; empty: it has only words
    [[nodiscard]] QString text() const;
    [[nodiscard]] QString briefText() const;  ///< for narrow columns: "tip  Y ↕"
};
TargetText targetText(const Document& document, const std::string& target);

/// "1.25 m", "-30°"
QString targetValueText(const TargetText& target, double value);

/// Who sends, in words: the device where it is the first of its kind, else its name.
QString sourceText(const std::string& source);
/// A control in words: "/fader/1", "LeftUpperArm, turn X".
QString channelText(const InputMapping& mapping);
QString protocolText(InputProtocol protocol);

/// One thing whose numbers can be driven: a handle, a bone, a character with morph targets.
struct DrivenThing {
    QString title, icon;  ///< icon: name of a line icon
    std::vector<std::pair<QString, std::string>> numbers;  ///< title and target
};
std::vector<DrivenThing> drivenThings(const Document& document);
/// The target that is meant by what is selected; empty: none is.
std::string targetOf(const Document& document, const SelectionItem& item);

/// How far a target goes at first, in its unit: a part of the size of the character, some degrees, a whole weight. `twoSided`: the control has its rest in its middle.
std::pair<double, double> usualReach(const Document& document, const MappedTarget& target, bool twoSided);

}  // namespace imomushi
