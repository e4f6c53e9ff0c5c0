// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/names.h"

#include <algorithm>

namespace imomushi {

Result<void> checkNameText(std::string_view name) {
    if (name.empty()) return fail("bad-name", "A name must not be empty: give it at least one character.");
    if (!isUtf8(name)) return fail("bad-name", "The name is not UTF-8: write it in Unicode.");
    if (name.find('/') != std::string_view::npos || name.find('\0') != std::string_view::npos)
        return fail("bad-name", "The name \"" + std::string(name) + "\" holds a \"/\" (or a zero byte), which separates names in paths: choose another.");
    return {};
}

Result<void> checkNewName(const Document& document, std::string_view name) {
    if (auto ok = checkNameText(name); !ok) return ok;
    if (name == "character" || effectNamed(name))
        return fail("bad-name", "The name \"" + std::string(name) + "\" belongs to the program: choose another.");
    if (document.elementNamed(name) || document.boneNamed(name) || document.handle(name) || document.characterNamed(name) || document.characterOfCut(name))
        return fail("name-taken",
                    "The name \"" + std::string(name) + "\" is taken: elements, bones, handles, characters and cuts share one name space, choose another.");
    return {};
}

std::string freeName(const Document& document, std::string_view wish) {
    std::string name(wish);
    if (!isUtf8(name)) name.clear();
    std::replace(name.begin(), name.end(), '/', '_');
    std::replace(name.begin(), name.end(), '\0', '_');
    if (name.empty()) name = "element";
    std::string candidate = name;
    for (int n = 2; !checkNewName(document, candidate); ++n) candidate = name + " " + std::to_string(n);
    return candidate;
}

std::string numberedName(const Document& document, std::string_view name, int first) {
    const std::size_t digits = name.find_last_not_of("0123456789");
    if (digits != std::string_view::npos && digits > 0 && digits + 1 < name.size() && name[digits] == ' ') name = name.substr(0, digits);
    for (int n = first;; ++n)
        if (std::string candidate = std::string(name) + " " + std::to_string(n); checkNewName(document, candidate)) return candidate;
}

std::string freeTakeName(const Document& document, const std::string& wish) {
    std::string name = wish;
    for (int n = 2; document.takeNamed(name); ++n) name = wish + " " + std::to_string(n);
    return name;
}

std::string listNames(const std::vector<std::string>& names) {
    if (names.empty()) return "there are none yet";
    constexpr std::size_t kMax = 12;
    std::string text = names.size() == 1 ? "there is " : "there are ";
    for (std::size_t i = 0; i < std::min(names.size(), kMax); ++i) text += (i ? ", \"" : "\"") + names[i] + "\"";
    if (names.size() > kMax) text += " and " + std::to_string(names.size() - kMax) + " more";
    return text;
}

std::string faceText(const Document& document, const FaceRef& face) {
    const auto found = document.elements.find(face.element);
    return found == document.elements.end() ? std::string() : found->second->name + "/" + face.face;
}

std::string endpointText(const Document& document, const EndpointRef& end) {
    const auto found = document.bones.find(end.bone);
    return found == document.bones.end() ? std::string() : found->second->name + (end.atEnd ? "/end" : "/start");
}

}  // namespace imomushi
