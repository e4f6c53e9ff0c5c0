// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/copied_parts.h"

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
    for (const PartId id : parts.elements) {
        const Points& v = document.elements.at(id)->mesh->body.vertices;
        for (Eigen::Index i = 0; i < v.rows(); ++i)
            if (!(placing.point(v.row(i).transpose()).cwiseAbs().maxCoeff() <= kMaxCoordinate))
                return fail("bad-value", std::string("\"") + key + "\" takes \"" + document.elements.at(id)->name + "\" too far away.");
    }
    return {};
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
