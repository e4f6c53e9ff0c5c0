// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/free_end.h"

#include <algorithm>

namespace imomushi {

std::optional<FreeEnd> freeEndOf(const CharacterInput& input, std::size_t element) {
    const auto& given = input.elements[element];
    if (static_cast<int>(given.faces.size()) == given.handles) return std::nullopt;
    const auto& bones = input.skeleton.bones;
    const auto isFree = [&](int point) {
        return std::count_if(bones.begin(), bones.end(), [&](const auto& b) { return b.start == point || b.end == point; }) == 1 &&
               std::none_of(input.joints.begin(), input.joints.end(), [&](const auto& j) { return j.point == point; });
    };
    std::optional<FreeEnd> found;
    for (const int b : given.bones) {
        const auto& bone = bones[static_cast<std::size_t>(b)];
        for (const FreeEnd& end : {FreeEnd{bone.end, bone.start}, FreeEnd{bone.start, bone.end}}) {
            if (!isFree(end.end)) continue;
            if (found) return std::nullopt;
            found = end;
        }
    }
    return found;
}

}  // namespace imomushi
