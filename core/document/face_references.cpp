// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/face_references.h"

#include <algorithm>
#include <string>

#include "core/document/command_support.h"
#include "core/document/effect_meetings.h"

namespace imomushi {

namespace {

/// Bones that `changes` for are replaced by copies that `change` was done to.
template <class Changes, class Change>
void changeBones(Document& document, Changes&& changes, Change&& change) {
    std::vector<PartId> ids;
    for (const auto& [id, bone] : document.bones)
        if (changes(*bone)) ids.push_back(id);
    for (const PartId id : ids) exchangePart(document.bones, id, change);
}

}  // namespace

Result<void> checkFree(const Document& document, const FaceRef& face) {
    const Element& element = *document.elements.at(face.element);
    const std::string path = "\"" + element.name + "/" + face.face + "\"";
    if (element.handleOf(face.face)) return fail("face-fixed", path + " is a handle: set its \"point\" instead.");
    if (element.piece && std::any_of(element.piece->sides.begin(), element.piece->sides.end(), [&](const CutSide& side) { return side.face == face.face; }))
        return fail("face-fixed", path + " is the face of a cut: move the cut instead.");
    if (document.jointOf(face)) return fail("face-fixed", path + " is joined, and would leave the other face: unjoin it first.");
    return {};
}

void leaveJoint(Document& document, const FaceRef& face) {
    const Joint* joint = document.jointOf(face);
    if (!joint) return;
    const PartId id = joint->id;
    exchangePart(document.joints, id, [&](Joint& changed) { std::erase(changed.faces, face); });
    if (document.joints.at(id)->faces.size() < 2) document.joints.erase(id);
}

void freeBones(Document& document, const std::vector<FaceRef>& faces) {
    const auto refers = [&](const Bone::Place& place) {
        const auto* face = std::get_if<FaceRef>(&place);
        return face && std::find(faces.begin(), faces.end(), *face) != faces.end();
    };
    changeBones(document, [&](const Bone& bone) { return refers(bone.start) || refers(bone.end); },
                [&](Bone& bone) {
                    for (Bone::Place* place : {&bone.start, &bone.end}) {
                        if (!refers(*place)) continue;
                        const auto& ref = std::get<FaceRef>(*place);
                        const Element& element = *document.elements.at(ref.element);
                        *place = Bone::Place(element.faces[static_cast<std::size_t>(element.faceIndex(ref.face))].frame.origin);
                    }
                });
}

void replaceFace(Document& document, const FaceRef& from, const FaceRef& to) {
    if (const Joint* joint = document.jointOf(from))
        exchangePart(document.joints, joint->id, [&](Joint& changed) { std::replace(changed.faces.begin(), changed.faces.end(), from, to); });
    if (auto goal = document.handleGoals.extract(from)) {
        goal.key() = to;
        document.handleGoals.insert(std::move(goal));
    }
    const Bone::Place was(from);
    changeBones(document, [&](const Bone& bone) { return bone.start == was || bone.end == was; },
                [&](Bone& bone) {
                    for (Bone::Place* place : {&bone.start, &bone.end})
                        if (*place == was) *place = Bone::Place(to);
                });
}

void dropElement(Document& document, PartId element, PartId heir) {
    std::vector<FaceRef> faces;
    for (const JointFace& face : document.elements.at(element)->faces) faces.push_back({element, face.name});
    for (const FaceRef& face : faces) {
        leaveJoint(document, face);
        document.handleGoals.erase(face);
    }
    freeBones(document, faces);
    changeBones(document, [&](const Bone& bone) { return bone.element == element; }, [&](Bone& bone) { bone.element = heir; });
    for (std::size_t k = 0; k < kEffects; ++k) {
        Effect& effect = document.effects[static_cast<EffectKind>(k)];
        if (effect.elements.erase(element) > 0 && effect.elements.empty() && !waitsToMeet(document.effects, static_cast<EffectKind>(k))) effect.enabled = false;
    }
    std::erase_if(document.touches, [&](const Touch& touch) { return touch.element == element; });
    document.elements.erase(element);
}

}  // namespace imomushi
