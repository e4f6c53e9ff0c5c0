// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/base/utf8.h"
#include "core/document/document.h"

namespace imomushi {

/// Whether `name` can be the name of an element, bone or face at all. Errors: "bad-name".
Result<void> checkNameText(std::string_view name);
/// Whether a new element, bone, handle, character or cut can be called `name`. Errors: "bad-name", "name-taken".
Result<void> checkNewName(const Document& document, std::string_view name);
/// `wish`, made a possible name and unique by a number at its end.
std::string freeName(const Document& document, std::string_view wish);

/// `name` with the first number that is free, from `first` on, instead of the one at its end: "arm" and "arm 2" give "arm 3".
std::string numberedName(const Document& document, std::string_view name, int first = 2);

/// `wish`, or that with the first number that makes it the name of no take.
std::string freeTakeName(const Document& document, const std::string& wish);

/// 'the names are "a", "b"', for messages; few of many.
std::string listNames(const std::vector<std::string>& names);

/// "element/face", "bone/start"
std::string faceText(const Document& document, const FaceRef& face);
std::string endpointText(const Document& document, const EndpointRef& end);

}  // namespace imomushi
