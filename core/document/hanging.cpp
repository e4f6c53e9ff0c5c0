// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/hanging.h"

#include <limits>
#include <map>

#include "core/base/union_find.h"
#include "core/document/character_input.h"
#include "core/mesh/connectivity.h"

namespace imomushi {

HangingParts hangingTogether(const Document& document, const std::set<PartId>& parts) {
    std::map<PartId, int> places;  // no two parts have one id
    for (const auto& [id, element] : document.elements) places.emplace(id, static_cast<int>(places.size()));
    for (const auto& [id, character] : document.characters) places.emplace(id, static_cast<int>(places.size()));
    for (const auto& [id, bone] : document.bones) places.emplace(id, static_cast<int>(places.size()));
    UnionFind sets(places.size());
    const auto unite = [&](PartId a, PartId b) {
        const auto one = places.find(a), other = places.find(b);
        if (one != places.end() && other != places.end()) sets.unite(one->second, other->second);
    };
    for (const auto& [id, element] : document.elements) {
        if (element->piece) unite(id, element->piece->character);
        for (const Handle& handle : element->handles)
            if (handle.bone) unite(id, handle.bone->bone);
    }
    for (const auto& [id, joint] : document.joints)
        for (const FaceRef& face : joint->faces) unite(joint->faces.front().element, face.element);
    for (const auto& [id, bone] : document.bones) {
        unite(id, bone->element);
        unite(id, bone->parent);
        for (const Bone::Place& place : {bone->start, bone->end}) {
            if (const auto* face = std::get_if<FaceRef>(&place)) unite(id, face->element);
            if (const auto* end = std::get_if<EndpointRef>(&place)) unite(id, end->bone);
        }
    }
    std::set<int> wanted;
    for (const PartId part : parts)
        if (const auto place = places.find(part); place != places.end()) wanted.insert(sets.find(place->second));
    HangingParts out;
    for (const auto& [id, place] : places) {
        if (!wanted.contains(sets.find(place))) continue;
        (document.elements.contains(id) ? out.elements : document.bones.contains(id) ? out.bones : out.characters).insert(id);
    }
    return out;
}

Vec3 middleOf(const Document& document, const HangingParts& parts) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (const PartId id : parts.elements) {
        const Bounds& box = document.elements.at(id)->mesh->connectivity().box();
        low = low.cwiseMin(box.low);
        high = high.cwiseMax(box.high);
    }
    if (parts.elements.empty())
        for (const PartId id : parts.bones)
            for (const Bone::Place& place : {document.bones.at(id)->start, document.bones.at(id)->end})
                if (const auto at = restPosition(document, place)) low = low.cwiseMin(*at), high = high.cwiseMax(*at);
    return (high.array() < low.array()).any() ? Vec3(Vec3::Zero()) : Vec3(0.5 * (low + high));
}

}  // namespace imomushi
