// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <string>
#include <utility>

#include "core/document/command_support.h"
#include "core/io/import.h"

// Keys of the commands that read meshes.

namespace imomushi {

/// One of some texts. Errors: "bad-value" with the texts there are.
template <class Value>
Result<Value> choiceFrom(const Json& arguments, const char* key, std::initializer_list<std::pair<const char*, Value>> values, Value otherwise) {
    const Json* given = find(arguments, key);
    if (!given) return otherwise;
    std::string known;
    for (const auto& [name, value] : values) {
        if (*given == name) return value;
        known += std::string(known.empty() ? "\"" : ", \"") + name + "\"";
    }
    return fail("bad-value", std::string("\"") + key + "\" must be one of " + known + ".");
}

/// "path", "unit", "up", and that "name" is free. Errors: "bad-value", those of checkNewName().
Result<ImportRequest> importRequestFrom(const Document& document, const Json& arguments);

/// Why a body cannot be an element: its first error, or that it is open.
Error importRefusal(const ImportedBody& body);

}  // namespace imomushi
