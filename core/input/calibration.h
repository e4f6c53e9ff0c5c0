// SPDX-License-Identifier: GPL-3.0-or-later
// What a source says in a few poses, and what it should say there: the Correction that brings one to the other, exactly for one pose, in the mean square for more.
// Poses tell how much only where they differ, in what is said and in what should be: elsewhere they tell no more than how far it is off.
#pragma once

#include <span>

#include "core/input/correction.h"

namespace imomushi {

template <class Value>
struct SaidAndMeant {
    Value said, meant;
};

inline constexpr double kTurnTells = 0.15;        ///< radians: turns that differ by less are the same
inline constexpr double kLargestTurnGain = 4.0;   ///< and its inverse is the least
inline constexpr double kRangeTells = 0.05;       ///< of the range of a control
inline constexpr double kLargestGain = 20.0;      ///< of numbers and places; and its inverse is the least

/// Turns. `inRoom`: it says how it stands in the room, and who performs may face another way; else it is a turn about its parent.
/// One pose, or some that hardly differ: before is the way it faces, about the vertical, or none; the others are the rest, as a sensor is worn or a body stands. Two are met both: they tell before as
/// well, but for a turn about the axis between them, of which it has as little as can be, and a gain. Three tell all of before.
Correction fitTurn(std::span<const SaidAndMeant<Eigen::Quaterniond>> poses, bool inRoom);

/// Places: moved; of two poses and more scaled and turned about the vertical, too. `facing`: that turn where poses do not tell it. `tells`: ways that are shorter are none.
Correction fitPlace(std::span<const SaidAndMeant<Vec3>> poses, const Eigen::Quaterniond& facing, double tells);

/// Single numbers: moved; of two poses and more with a gain. `tells`: numbers that differ by less are the same.
Correction fitNumber(std::span<const SaidAndMeant<double>> poses, double tells);

/// The turn about the vertical that is in a turn; none of one that is half a turn about an axis across.
Eigen::Quaterniond facingOf(const Eigen::Quaterniond& turn);

}  // namespace imomushi
