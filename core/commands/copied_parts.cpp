// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/copied_parts.h"

#include <algorithm>

#include "core/document/command_support.h"

namespace imomushi {

void CopiedParts::addCharacter(const Document& document, PartId character) {
    characters.insert(character);
    for (const PartId id : document.elementsOf(character)) elements.insert(id);
}

void CopiedParts::addElement(const Document& document, const Element& element) {
    if (element.piece)
        addCharacter(document, element.piece->character);
    else
        elements.insert(element.id);
}

void CopiedParts::addBones(const Document& document) {
    for (const auto& [id, bone] : document.bones)
        if (elements.contains(bone->element)) bones.insert(id);
}

Result<void> checkPlaces(const Document& document, const CopiedParts& parts, const Placing& placing, const char* key) {
    const auto within = [&](const Vec3& place) { return placing.point(place).cwiseAbs().maxCoeff() <= kMaxCoordinate; };
    const auto allWithin = [&](const Points& places) {
        for (Eigen::Index i = 0; i < places.rows(); ++i)
            if (!within(places.row(i).transpose())) return false;
        return true;
    };
    const auto tooFar = [&](const std::string& name) { return fail("bad-value", std::string("\"") + key + "\" takes \"" + name + "\" too far away."); };
    for (const PartId id : parts.elements)
        if (const Element& element = *document.elements.at(id); !allWithin(element.mesh->body.vertices)) return tooFar(element.name);
    for (const PartId id : parts.bones) {
        const Bone& bone = *document.bones.at(id);
        for (const Bone::Place& place : {bone.start, bone.end})
            if (const auto at = restPosition(document, place); at && !within(*at)) return tooFar(bone.name);
    }
    for (const PartId id : parts.characters) {
        const CharacterSource& character = *document.characters.at(id);
        bool all = allWithin(character.model->mesh.body.vertices) && allWithin(character.body->mesh.vertices);
        for (const Cut& cut : character.cuts) all = all && within(cut.plane.origin);
        if (character.rig)
            for (const RigBone& bone : character.rig->bones) all = all && within(bone.head) && within(bone.tail);
        for (const auto& [part, attachment] : character.attachments) all = all && (!attachment.pivot || within(*attachment.pivot));
        if (!all) return tooFar(character.name);
    }
    return {};
}

double besideBones(const Vec3& low, const Vec3& high) {
    constexpr double kWidth = 1.1, kSize = 0.25;  // of the width along x, and of the diagonal, where they are slender
    return std::max(kWidth * (high - low).x(), kSize * (high - low).norm());
}

std::function<const StoredResponse*(PartId)> lastResponses(const DocumentEdit& edit) {
    return [&last = edit.responses().last()](PartId id) -> const StoredResponse* {
        const auto known = last.find(id);
        return known == last.end() ? nullptr : &known->second;
    };
}

void findElements(Document& document, const Document& from, const PartCopier& copier) {
    for (const auto& [name, original] : copier.bones) {
        const Bone& made = *document.boneNamed(name);
        if (made.element != 0 || from.boneNamed(original)->element == 0) continue;
        const PartId through = elementThrough(document, made);
        exchangePart(document.bones, made.id, [&](Bone& bone) { bone.element = through; });
    }
}

Json copiesJson(const PartCopier& copier) {
    Json answer;
    const auto tell = [&](const char* key, const PartCopier::Names& names) {
        answer[key] = Json::array();
        for (const auto& [name, from] : names) answer[key].push_back({{"name", name}, {"from", from}});
    };
    tell("elements", copier.elements);
    tell("characters", copier.characters);
    tell("cuts", copier.cuts);
    tell("handles", copier.handles);
    tell("bones", copier.bones);
    return answer;
}

}  // namespace imomushi
