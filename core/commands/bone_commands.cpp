// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/core_commands.h"
#include "core/commands/handle_commands.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/joints/seam.h"
#include "core/mesh/winding_number.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

constexpr double kLargestBoneRoll = 1e6;  // radians: more turns than anybody counts, and still exact to 1e-10

/// "element/face", "bone/end" or [x,y,z]. `self`: the bone that is being placed; its own ends are no place for it.
Result<Bone::Place> placeFrom(const Document& document, const Json& value, const char* key, PartId self) {
    if (const auto point = vector3(value)) return Bone::Place(*point);
    if (!value.is_string())
        return fail("bad-type", std::string("\"") + key + "\" must be \"element/face\", \"bone/end\" or [x,y,z] within 1e9.");
    const std::string& path = value.get_ref<const std::string&>();
    const std::string first = path.substr(0, path.find('/'));
    if (document.boneNamed(first)) {
        IMOMUSHI_TRY(const auto end, document.endpoint(path));
        if (end.bone == self) return fail("bad-place", "A bone cannot end at itself: place \"" + std::string(key) + "\" elsewhere.");
        return Bone::Place(end);
    }
    const auto face = document.face(path);
    if (!face) {
        if (!document.elementNamed(first))
            return fail("no-such-place", "There is neither an element nor a bone \"" + first + "\" for \"" + key + "\".");
        return tl::unexpected(face.error());
    }
    return Bone::Place(*face);
}

/// Keys that add-bone and edit-bone share, into `bone`.
Result<void> readBone(const Document& document, const Json& arguments, Bone& bone) {
    if (const Json* value = find(arguments, "from")) {
        IMOMUSHI_TRY(bone.start, placeFrom(document, *value, "from", bone.id));
    }
    if (const Json* value = find(arguments, "to")) {
        IMOMUSHI_TRY(bone.end, placeFrom(document, *value, "to", bone.id));
    }
    if (const Json* value = find(arguments, "parent")) {
        if (value->get_ref<const std::string&>().empty()) {
            bone.parent = 0;
        } else {
            IMOMUSHI_TRY(const auto parent, boneOf(document, value->get_ref<const std::string&>()));
            if (parent->id == bone.id) return fail("bad-value", "A bone cannot be its own parent.");
            bone.parent = parent->id;
        }
    }
    if (auto ok = readNumber(arguments, "roll", -kLargestBoneRoll, kLargestBoneRoll, bone.roll); !ok) return tl::unexpected(ok.error());
    return {};
}

Result<void> readElement(const Document& document, const Json& arguments, Bone& bone) {
    const Json* value = find(arguments, "element");
    if (!value) return {};
    if (value->get_ref<const std::string&>().empty()) {
        bone.element = 0;
        return {};
    }
    IMOMUSHI_TRY(const auto element, elementOf(document, value->get_ref<const std::string&>()));
    bone.element = element->id;
    return {};
}

/// Refuses a bone that cannot be part of a forest, and a given parent that does not touch it or hangs on it.
Result<Json> finishBone(DocumentEdit& edit, Bone bone) {
    Document& document = edit.document;
    document.bones.insert_or_assign(bone.id, std::make_shared<const Bone>(bone));
    PartId above = bone.parent;
    for (std::size_t i = 0; above != 0 && i < document.bones.size(); ++i) {
        if (above == bone.id)
            return fail("bad-parent", "The bone \"" + bone.name + "\" cannot hang on \"" + document.bones.at(bone.parent)->name + "\", which hangs on it: choose another parent.");
        above = document.bones.at(above)->parent;
    }
    IMOMUSHI_TRY(const auto planned, edit.planned());
    const CharacterPlan* plan = planned.get();
    const int index = plan->boneIndex(bone.id);
    const auto& skeleton = plan->input.skeleton;
    if (bone.parent != 0) {
        const auto& own = skeleton.bones[static_cast<std::size_t>(index)];
        const auto& parent = skeleton.bones[static_cast<std::size_t>(plan->boneIndex(bone.parent))];
        if (own.start != parent.start && own.start != parent.end && own.end != parent.start && own.end != parent.end)
            return fail("bad-parent", "The bone \"" + bone.name + "\" does not touch its parent \"" + document.bones.at(bone.parent)->name +
                                          "\": start it at \"" + document.bones.at(bone.parent)->name + "/end\".");
    }
    const int parent = skeleton.bones[static_cast<std::size_t>(index)].parent;
    Json answer{{"name", bone.name}, {"element", bone.element ? Json(document.elements.at(bone.element)->name) : Json()},
                {"parent", parent < 0 ? Json() : Json(document.bones.at(plan->bones[static_cast<std::size_t>(parent)])->name)},
                {"length", skeleton.bones[static_cast<std::size_t>(index)].length}, {"start", placeJson(document, bone.start)},
                {"end", placeJson(document, bone.end)}};
    return answer;
}

Result<Json> addBone(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    if (auto ok = checkNewName(document, text(arguments, "name")); !ok) return tl::unexpected(ok.error());
    Bone bone;
    bone.id = document.nextId++;
    bone.name = text(arguments, "name");
    if (auto ok = readBone(document, arguments, bone); !ok) return tl::unexpected(ok.error());
    if (arguments.contains("element")) {
        if (auto ok = readElement(document, arguments, bone); !ok) return tl::unexpected(ok.error());
    } else {
        bone.element = elementThrough(document, bone);
    }
    return finishBone(edit, std::move(bone));
}

Result<Json> editBone(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto found, boneOf(document, text(arguments, "name")));
    Bone bone = *found;
    if (auto ok = readBone(document, arguments, bone); !ok) return tl::unexpected(ok.error());
    if (auto ok = readElement(document, arguments, bone); !ok) return tl::unexpected(ok.error());
    return finishBone(edit, std::move(bone));
}

Result<Json> removeBone(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto found, boneOf(document, text(arguments, "name")));
    const std::shared_ptr<const Bone> gone = found;
    document.bones.erase(gone->id);
    // What ended at this bone stays where it is.
    std::vector<PartId> ids;
    for (const auto& [id, bone] : document.bones) ids.push_back(id);
    for (const PartId id : ids) {
        const auto refers = [&](const Bone::Place& place) {
            const auto* end = std::get_if<EndpointRef>(&place);
            return end && end->bone == gone->id;
        };
        const Bone& bone = *document.bones.at(id);
        if (!refers(bone.start) && !refers(bone.end) && bone.parent != gone->id) continue;
        exchangePart(document.bones, id, [&](Bone& changed) {
            const auto replace = [&](Bone::Place& place) {
                if (refers(place)) place = Bone::Place(std::get<EndpointRef>(place).atEnd ? gone->end : gone->start);
            };
            replace(changed.start);
            replace(changed.end);
            if (changed.parent == gone->id) changed.parent = gone->parent;
        });
    }
    // A parent that no longer touches is none.
    IMOMUSHI_TRY(const auto planned, edit.planned());
    const CharacterPlan* plan = planned.get();
    for (const PartId id : ids) {
        const Bone& bone = *document.bones.at(id);
        if (bone.parent == 0) continue;
        const auto& a = plan->input.skeleton.bones[static_cast<std::size_t>(plan->boneIndex(id))];
        const auto& b = plan->input.skeleton.bones[static_cast<std::size_t>(plan->boneIndex(bone.parent))];
        if (a.start != b.start && a.start != b.end && a.end != b.start && a.end != b.end)
            exchangePart(document.bones, id, [](Bone& changed) { changed.parent = 0; });
    }
    std::erase_if(document.goals, [&](const auto& held) { return held.first.bone == gone->id; });
    releaseHandlesOf(document, gone->id);
    return Json::object();
}

}  // namespace

PartId elementThrough(const Document& document, const Bone& bone) {
    const auto* startFace = std::get_if<FaceRef>(&bone.start);
    const auto* endFace = std::get_if<FaceRef>(&bone.end);
    if (startFace && endFace && startFace->element == endFace->element) return startFace->element;
    const auto start = restPosition(document, bone.start), end = restPosition(document, bone.end);
    if (start && end) {
        const Vec3 middle = 0.5 * (*start + *end);
        for (const auto& [id, element] : document.elements)
            if (windingNumber(element->mesh->body, middle) > 0.5) return id;
    }
    if (endFace) return endFace->element;
    if (startFace) return startFace->element;
    return 0;
}

void addBoneCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const char* place = "\"element/face\" (its centroid), \"bone/start\", \"bone/end\" or [x,y,z] in metres at rest.";
    registry.addChange("add-bone",
                       "Adds a bone from joint point to joint point. Bones that share a point form a tree, whose first bone is the root.",
                       {{"name", Type::Text, true, "A name that no element or bone has."},
                        {"element", Type::Text, false, "The element that it runs through (found from its ends unless given; \"\": none)."},
                        {"from", Type::Any, true, std::string("Where it starts: ") + place},
                        {"to", Type::Any, true, std::string("Where it ends: ") + place},
                        {"parent", Type::Text, false, "A bone that shares a joint point with it (found unless given)."},
                        {"roll", Type::Number, false, "Radians about its direction at rest (0)."}},
                       addBone);
    registry.addChange("edit-bone",
                       "Changes a bone; keys that are left out stay as they are.",
                       {{"name", Type::Text, true, "The bone."},
                        {"element", Type::Text, false, "The element that it runs through (\"\": none)."},
                        {"from", Type::Any, false, std::string("Where it starts: ") + place},
                        {"to", Type::Any, false, std::string("Where it ends: ") + place},
                        {"parent", Type::Text, false, "A bone that shares a joint point with it (\"\": found from the joint points)."},
                        {"roll", Type::Number, false, "Radians about its direction at rest."}},
                       editBone);
    registry.addChange("remove-bone",
                       "Removes a bone; bones that ended at it stay where they are.",
                       {{"name", Type::Text, true, "The bone."}},
                       removeBone);
}

}  // namespace imomushi
