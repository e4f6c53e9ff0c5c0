// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace imomushi {

/// The name of the same part on the other side: "arm.L" and "arm.R", "arm_l" and "arm_r" ("-" and " " too, in front as well, and before a number at the end), "LeftArm" and
/// "RightArm", "左腕" and "右腕". One without a side stays as it is. The other side of the other side is the same again.
std::string otherSide(std::string_view name);
/// The same for these two endings alone.
std::string otherSide(std::string_view name, const std::pair<std::string, std::string>& suffixes);

}  // namespace imomushi
