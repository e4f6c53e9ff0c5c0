// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// Of a JSON value that a file says, of which nothing is believed: the member of an object; null where the value is no object, or has none of that name.
template <class Json>
const Json& jsonMember(const Json& object, const char* key) {
    static const Json nothing;
    if (!object.is_object()) return nothing;
    const auto found = object.find(key);
    return found == object.end() ? nothing : *found;
}

}  // namespace imomushi
