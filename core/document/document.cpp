// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/document.h"

#include <algorithm>

#include "core/document/names.h"

namespace imomushi {

namespace {

template <class Parts>
const typename Parts::mapped_type::element_type* named(const Parts& parts, std::string_view name) {
    for (const auto& [id, part] : parts)
        if (part->name == name) return part.get();
    return nullptr;
}

template <class Parts>
std::vector<std::string> namesOf(const Parts& parts) {
    std::vector<std::string> names;
    for (const auto& [id, part] : parts) names.push_back(part->name);
    return names;
}

/// "before/after" at the first slash: names of elements and bones hold none.
std::pair<std::string_view, std::string_view> split(std::string_view path) {
    const auto slash = path.find('/');
    if (slash == std::string_view::npos) return {path, {}};
    return {path.substr(0, slash), path.substr(slash + 1)};
}

}  // namespace

int CharacterSource::cutIndex(PartId cut) const {
    const auto found = std::find_if(cuts.begin(), cuts.end(), [&](const Cut& c) { return c.id == cut; });
    return found == cuts.end() ? -1 : static_cast<int>(found - cuts.begin());
}

int CharacterSource::cutIndex(std::string_view cut) const {
    const auto found = std::find_if(cuts.begin(), cuts.end(), [&](const Cut& c) { return c.name == cut; });
    return found == cuts.end() ? -1 : static_cast<int>(found - cuts.begin());
}

int CharacterPiece::sideIndex(PartId cut) const {
    const auto found = std::find_if(sides.begin(), sides.end(), [&](const CutSide& s) { return s.cut == cut; });
    return found == sides.end() ? -1 : static_cast<int>(found - sides.begin());
}

int Element::faceIndex(std::string_view face) const {
    for (std::size_t i = 0; i < faces.size(); ++i)
        if (faces[i].name == face) return static_cast<int>(i);
    return -1;
}

CutSide* Element::sideOf(std::string_view face) {
    if (!piece) return nullptr;
    const auto found = std::find_if(piece->sides.begin(), piece->sides.end(), [&](const CutSide& side) { return side.face == face; });
    return found == piece->sides.end() ? nullptr : &*found;
}

const Handle* Element::handleOf(std::string_view face) const {
    const auto found = std::find_if(handles.begin(), handles.end(), [face](const Handle& handle) { return handle.face == face; });
    return found == handles.end() ? nullptr : &*found;
}

HandlePose HandleGoal::now() const {
    if (!(elapsed < seconds)) return target;
    const double done = elapsed / seconds;
    return {from.at + done * (target.at - from.at), from.rotation.slerp(done, target.rotation).normalized(), target.held};
}

Eigen::Quaterniond TurnGoal::now() const { return elapsed < seconds ? from.slerp(elapsed / seconds, target).normalized() : target; }

std::optional<FaceRef> Document::handle(std::string_view path) const {
    const auto [elementName, faceName] = split(path);
    for (const auto& [id, element] : elements) {
        if (!faceName.empty() && element->name != elementName) continue;
        if (const Handle* found = element->handleOf(faceName.empty() ? path : faceName)) return FaceRef{id, found->face};
    }
    return std::nullopt;
}

const Element* Document::elementNamed(std::string_view name) const { return named(elements, name); }
const Bone* Document::boneNamed(std::string_view name) const { return named(bones, name); }
const CharacterSource* Document::characterNamed(std::string_view name) const { return named(characters, name); }
const Take* Document::takeNamed(std::string_view name) const { return named(takes, name); }

const CharacterSource* Document::characterOfCut(std::string_view cut) const {
    for (const auto& [id, character] : characters)
        if (character->cutIndex(cut) >= 0) return character.get();
    return nullptr;
}

std::vector<PartId> Document::elementsOf(PartId character) const {
    std::vector<PartId> ids;
    for (const auto& [id, element] : elements)
        if (element->piece && element->piece->character == character) ids.push_back(id);
    return ids;
}

const Joint* Document::jointOf(const FaceRef& face) const {
    for (const auto& [id, joint] : joints)
        if (std::find(joint->faces.begin(), joint->faces.end(), face) != joint->faces.end()) return joint.get();
    return nullptr;
}

Result<FaceRef> Document::face(std::string_view path) const {
    const auto [elementName, faceName] = split(path);
    const Element* element = elementNamed(elementName);
    if (!element)
        return fail("no-such-element",
                    "There is no element \"" + std::string(elementName) + "\"; " + listNames(namesOf(elements)) + ".");
    if (element->faceIndex(faceName) < 0) {
        std::vector<std::string> names;
        for (const JointFace& f : element->faces) names.push_back(f.name);
        return fail("no-such-face", "The element \"" + element->name + "\" has no joint face \"" + std::string(faceName) +
                                        "\"; " + listNames(names) + ".");
    }
    return FaceRef{element->id, std::string(faceName)};
}

Result<EndpointRef> Document::endpoint(std::string_view path) const {
    const auto [boneName, end] = split(path);
    const Bone* bone = boneNamed(boneName);
    if (!bone)
        return fail("no-such-bone",
                    "There is no bone \"" + std::string(boneName) + "\"; " + listNames(namesOf(bones)) + ".");
    if (end != "start" && end != "end")
        return fail("bad-value", "\"" + std::string(path) + "\" is no endpoint: write \"" + bone->name + "/start\" or \"" +
                                     bone->name + "/end\".");
    return EndpointRef{bone->id, end == "end"};
}

}  // namespace imomushi
