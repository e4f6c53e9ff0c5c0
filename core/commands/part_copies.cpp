// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/part_copies.h"

#include <algorithm>
#include <cmath>

#include "core/document/command_support.h"
#include "core/document/names.h"

namespace imomushi {

namespace {

/// Ends of bones nearer to a place than this, of the largest coordinate or 1 m, are at it.
constexpr double kThere = 1e-6;

/// `wish`, or where that is taken with the next free number in place of its own: a copy of "leg 2" is "leg 3".
template <class Free>
std::string nextName(const std::string& wish, Free&& isFree) {
    constexpr std::size_t kDigits = 6;  // longer ones are no count
    if (isFree(wish)) return wish;
    const std::size_t space = wish.find_last_not_of("0123456789");
    const bool counted = space != std::string::npos && space > 0 && wish[space] == ' ' && space + 1 < wish.size() && wish.size() - space - 1 <= kDigits;
    const std::string stem = counted ? wish.substr(0, space) : wish;
    for (int n = counted ? std::stoi(wish.substr(space + 1)) + 1 : 2;; ++n)
        if (std::string name = stem + " " + std::to_string(n); isFree(name)) return name;
}

std::string nextName(const Document& document, const std::string& wish) {
    return nextName(wish, [&](const std::string& name) { return checkNewName(document, name).has_value(); });
}

/// Which no other face of the element has, either: but that of the handle itself, `own`.
std::string nextHandleName(const Document& document, const Element& element, const std::string& own, const std::string& wish) {
    return nextName(wish, [&](const std::string& name) { return checkNewName(document, name) && (name == own || element.faceIndex(name) < 0); });
}

/// The end of a bone, or the joint face that is no handle, at this place.
std::optional<Bone::Place> placeAt(const Document& document, const Vec3& point) {
    const auto there = [&](const Vec3& p) { return (p - point).norm() <= kThere * std::max(1.0, point.cwiseAbs().maxCoeff()); };
    for (const auto& [id, bone] : document.bones)
        for (const bool atEnd : {false, true})
            if (const auto p = restPosition(document, atEnd ? bone->end : bone->start); p && there(*p)) return Bone::Place(EndpointRef{id, atEnd});
    for (const auto& [id, element] : document.elements)
        for (const JointFace& face : element->faces)
            if (!element->handleOf(face.name) && there(face.frame.origin)) return Bone::Place(FaceRef{id, face.name});
    return std::nullopt;
}

}  // namespace

// ---- copies -------------------------------------------------------------------------------------------------------------

PartId PartCopier::idOf(PartId part) {
    if (part == 0) return 0;
    const auto [known, added] = ids_.try_emplace(part, 0);
    if (added) known->second = edit_.document.nextId++;
    return known->second;
}

std::optional<FaceRef> PartCopier::faceOf(const FaceRef& face) const {
    const auto known = faces_.find(face);
    return known == faces_.end() ? std::nullopt : std::optional(known->second);
}

void PartCopier::copyCharacters(const std::set<PartId>& wanted, const std::set<PartId>& with) {
    Document& here = edit_.document;
    for (const PartId id : wanted) {
        const CharacterSource& character = *from_.characters.at(id);
        CharacterSource made = placed(character, placing());
        made.id = idOf(id);
        for (auto& [part, attachment] : made.attachments) attachment.element = with.contains(attachment.element) ? idOf(attachment.element) : PartId(0);
        if (made.rig && placing().mirrors()) {  // its bones change sides as those of the document do
            Rig rig = *made.rig;
            std::set<std::string> names;
            for (RigBone& bone : rig.bones) names.insert(bone.name = nameFor(bone.name));
            if (names.size() == rig.bones.size()) made.rig = std::make_shared<const Rig>(std::move(rig));
        }
        made.name = nextName(here, nameFor(character.name));
        characters.emplace_back(made.name, character.name);
        const PartId known = made.id;
        std::vector<Cut> planes = std::exchange(made.cuts, {});
        here.characters.emplace(known, std::make_shared<const CharacterSource>(std::move(made)));
        for (Cut& cut : planes) {  // one by one, so that no two get one name
            const std::string wish = cut.name;
            cut.id = idOf(cut.id);
            cut.name = nextName(here, nameFor(wish));
            cuts.emplace_back(cut.name, wish);
            exchangePart(here.characters, known, [&](CharacterSource& changed) { changed.cuts.push_back(std::move(cut)); });
        }
    }
}

void PartCopier::copyElements(const std::set<PartId>& wanted, const std::set<PartId>& withBones) {
    Document& here = edit_.document;
    for (const PartId bone : withBones) idOf(bone);  // in their order, which decides what is a root, whatever handle names one first
    for (const PartId id : wanted) {
        const Element& original = *from_.elements.at(id);
        Element element = original;
        const std::vector<Handle> discs = std::exchange(element.handles, {});
        element.id = idOf(id);
        for (JointFace& face : element.faces) {
            if (!original.handleOf(face.name)) face.name = nameFor(face.name);
            faces_.insert_or_assign(FaceRef{id, original.faces[static_cast<std::size_t>(&face - element.faces.data())].name}, FaceRef{element.id, face.name});
        }
        if (element.piece) {
            element.piece->character = idOf(element.piece->character);
            for (CutSide& side : element.piece->sides) {
                side.cut = idOf(side.cut);
                if (!side.face.empty()) side.face = nameFor(side.face);
            }
        }
        element.name = nextName(here, nameFor(original.name));
        elements.emplace_back(element.name, original.name);
        const StoredResponse* response = options_.response ? options_.response(id) : nullptr;
        const PartId made = element.id;
        here.elements.emplace(made, std::make_shared<const Element>(std::move(element)));
        if (options_.within)
            for (std::size_t k = 0; k < kEffects; ++k)
                if (auto& on = here.effects[static_cast<EffectKind>(k)].elements; on.contains(id)) on.insert(made);
        for (Handle handle : discs) {
            const FaceRef was{id, handle.face};
            handle.face = nextHandleName(here, *here.elements.at(made), was.face, nameFor(was.face));
            if (handle.bone && (withBones.contains(handle.bone->bone) || has(handle.bone->bone)))
                handle.bone->bone = idOf(handle.bone->bone);
            else
                handle.bone.reset();
            faces_.insert_or_assign(was, FaceRef{made, handle.face});
            handles.emplace_back(handle.face, was.face);
            exchangePart(here.elements, made, [&](Element& changed) {
                changed.faces[static_cast<std::size_t>(original.faceIndex(was.face))].name = handle.face;
                changed.handles.push_back(std::move(handle));
            });
        }
        if (placing().moves())
            placeElement(edit_, made, placing(), response);
        else if (response)
            edit_.bring(made, *response);
    }
}

void PartCopier::copyJoints() {
    for (const auto& [id, joint] : from_.joints) {
        Joint made;
        for (const FaceRef& face : joint->faces)
            if (const auto copy = faceOf(face)) made.faces.push_back(*copy);
        if (made.faces.size() < 2) continue;
        made.id = idOf(id);
        edit_.document.joints.emplace(made.id, std::make_shared<const Joint>(std::move(made)));
    }
}

Bone::Place PartCopier::placeOf(const Bone::Place& place, bool& hangs) {
    hangs = true;
    if (const auto* face = std::get_if<FaceRef>(&place))
        if (const auto copy = faceOf(*face)) return *copy;
    if (const auto* end = std::get_if<EndpointRef>(&place); end && has(end->bone)) return EndpointRef{idOf(end->bone), end->atEnd};
    const auto at = restPosition(from_, place);
    const Vec3 point = placing().point(at ? *at : Vec3(Vec3::Zero()));
    if (std::holds_alternative<Vec3>(place)) return point;
    if (options_.within)
        if (const auto there = placeAt(from_, point)) return *there;
    hangs = false;
    return point;
}

void PartCopier::copyBones(const std::set<PartId>& wanted) {
    Document& here = edit_.document;
    for (const PartId id : wanted) (void)idOf(id);  // bones refer to each other in any order
    for (const PartId id : wanted) {
        const Bone& bone = *from_.bones.at(id);
        Bone made = bone;
        made.id = idOf(id);
        made.name = nextName(here, nameFor(bone.name));
        made.element = has(bone.element) ? idOf(bone.element) : PartId(0);
        made.parent = has(bone.parent) ? idOf(bone.parent) : 0;
        if (placing().mirrors()) made.roll = -made.roll;
        for (const bool atEnd : {false, true}) {
            bool hangs = true;
            (atEnd ? made.end : made.start) = placeOf(atEnd ? bone.end : bone.start, hangs);
            if (!hangs) loose.push_back(made.name + (atEnd ? "/end" : "/start"));
        }
        bones.emplace_back(made.name, bone.name);
        here.bones.emplace(made.id, std::make_shared<const Bone>(std::move(made)));
    }
    if (options_.within) copyPins(wanted);
}

void PartCopier::copyPins(const std::set<PartId>& wanted) {
    Document& here = edit_.document;
    for (const auto& [end, goal] : from_.goals) {
        if (!goal.pinned || !wanted.contains(end.bone)) continue;
        EndpointGoal made;
        made.pinned = true;
        made.target = placing().point(goal.target);
        made.roll = goal.roll && placing().mirrors() ? std::optional(-*goal.roll) : goal.roll;
        if (goal.rotation) {
            Eigen::Matrix3d way;  // orthogonal
            for (int i = 0; i < 3; ++i) way.col(i) = placing().point(Vec3::Unit(i)) - placing().point(Vec3::Zero());
            const Eigen::Quaterniond turned(way * Eigen::Quaterniond(goal.rotation->data()).toRotationMatrix() * way.transpose());
            made.rotation = std::array{turned.x(), turned.y(), turned.z(), turned.w()};
        }
        here.goals.insert_or_assign(EndpointRef{idOf(end.bone), end.atEnd}, made);
    }
    for (const auto& [handle, goal] : from_.handleGoals) {
        const auto copy = faceOf(handle);
        if (!goal.pinned || !copy) continue;
        HandleGoal made;
        made.pinned = made.target.held = true;
        made.target.at = placing().point(goal.target.at);
        // Axes of turns are seen in a mirror the other way round.
        const Vec3 axis = (placing().mirrors() ? -1.0 : 1.0) * (placing().linear * goal.target.rotation.vec());
        made.target.rotation = Eigen::Quaterniond(goal.target.rotation.w(), axis.x(), axis.y(), axis.z());
        here.handleGoals.insert_or_assign(*copy, made);
    }
}

}  // namespace imomushi
