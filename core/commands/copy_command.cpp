// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "core/commands/copied_parts.h"
#include "core/commands/core_commands.h"
#include "core/commands/pasted_parts.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/document/face_references.h"
#include "core/document/names.h"
#include "core/project/project_file.h"
#include "core/session/document_edit.h"
#include "core/session/session_access.h"

// "copy": parts of a document as commands that "paste" gives to this document or to another one.

namespace imomushi {

namespace {

/// Results go with copied elements up to this size, bytes: more would take seconds to write, while somebody waits; they are computed again then.
constexpr std::size_t kMostResults = std::size_t{128} << 20;

/// What is to be copied, by its names.
struct CopyWish {
    CopiedParts whole;  ///< characters and elements, in a file; bones that are copied by commands
    std::set<FaceRef> faces;
    std::set<std::pair<PartId, PartId>> cuts;  ///< character, cut
    std::set<EffectKind> effects;
};

Result<CopyWish> copyWish(const Document& document, const Json& arguments) {
    CopyWish wish;
    static const Json none = Json::array();
    const Json* names = find(arguments, "names");
    for (const Json& given : names ? *names : none) {
        if (!given.is_string()) return fail("bad-type", "\"names\" must be names.");
        const std::string& name = given.get_ref<const std::string&>();
        if (const auto effect = effectNamed(name)) {
            wish.effects.insert(*effect);
        } else if (const CharacterSource* character = document.characterNamed(name)) {
            wish.whole.addCharacter(document, character->id);
        } else if (const Element* element = document.elementNamed(name)) {
            wish.whole.addElement(document, *element);
        } else if (const Bone* bone = document.boneNamed(name)) {
            wish.whole.bones.insert(bone->id);
        } else if (const CharacterSource* of = document.characterOfCut(name)) {
            wish.cuts.emplace(of->id, of->cuts[static_cast<std::size_t>(of->cutIndex(name))].id);
        } else if (const auto handle = document.handle(name)) {
            wish.faces.insert(*handle);
        } else if (name.find('/') != std::string::npos) {
            IMOMUSHI_TRY(const auto face, document.face(name));
            wish.faces.insert(face);
        } else {
            return fail("no-such-target", "There is no element, character, bone, cut, handle or effect \"" + name + "\"; joint faces are named \"element/face\".");
        }
    }
    return wish;
}

/// A project of these elements and characters alone, with the bones through them.
Project projectOf(SessionAccess& access, CopiedParts parts) {
    const Document& from = access.document();
    Project made;
    DocumentEdit edit(made.document, access.live, access.responses, access.services);
    PartCopier::Options options;
    std::size_t bytes = 0;
    const auto& last = access.responses.last();
    for (const PartId id : parts.elements)
        if (const auto known = last.find(id); known != last.end() && known->second.response) bytes += known->second.response->bytes();
    if (bytes <= kMostResults)
        options.response = [&last](PartId id) {
            const auto known = last.find(id);
            return known == last.end() ? nullptr : &known->second;
        };
    parts.bones.clear();
    parts.addBones(from);
    PartCopier copier(edit, from, std::move(options));
    copier.copyCharacters(parts.characters, parts.elements);
    copier.copyElements(parts.elements, parts.bones);
    copier.copyJoints();
    copier.copyBones(parts.bones);
    for (const auto& [id, response] : edit.brought()) made.responses.insert_or_assign(id, response);
    return made;
}

Json boneJson(const Document& d, const Bone& bone, const std::set<PartId>& copied) {
    Json line{{"do", "add-bone"}, {"name", bone.name}};
    if (bone.element != 0) line["element"] = d.elements.at(bone.element)->name;
    line["from"] = placeJson(d, bone.start);
    line["to"] = placeJson(d, bone.end);
    if (copied.contains(bone.parent)) line["parent"] = d.bones.at(bone.parent)->name;
    if (bone.roll != 0.0) line["roll"] = bone.roll;
    Json hint = Json::object();
    for (const auto& [key, place] : {std::pair("from", &bone.start), std::pair("to", &bone.end)})
        if (const auto at = restPosition(d, *place)) hint[key] = json(*at);
    line[kPasteHint] = std::move(hint);
    return line;
}

/// What "add-bone" has no keys for, where it is not as at first.
void addBoneSettings(const Bone& bone, Json& commands) {
    const Bone standard;
    const auto tell = [&](const char* property, double Bone::*member) {
        if (bone.*member != standard.*member) commands.push_back({{"do", "set"}, {"target", bone.name}, {"property", property}, {"value", bone.*member}});
    };
    tell("min-stretch", &Bone::minStretch);
    tell("max-stretch", &Bone::maxStretch);
    tell("max-bend", &Bone::maxBend);
    tell("max-twist", &Bone::maxTwist);
    tell("stiffness", &Bone::stiffness);
    tell("weight", &Bone::weight);
}

/// Bones after those that they end at or hang on.
std::vector<PartId> inOrder(const Document& d, const std::set<PartId>& bones) {
    std::vector<PartId> order;
    std::set<PartId> seen;
    const auto visit = [&](auto&& self, PartId id) -> void {
        if (!bones.contains(id) || !seen.insert(id).second) return;
        const Bone& bone = *d.bones.at(id);
        self(self, bone.parent);
        for (const Bone::Place* place : {&bone.start, &bone.end})
            if (const auto* end = std::get_if<EndpointRef>(place)) self(self, end->bone);
        order.push_back(id);
    };
    for (const PartId id : bones) visit(visit, id);
    return order;
}

Json faceCommand(const Document& d, const FaceRef& ref) {
    const Element& element = *d.elements.at(ref.element);
    const JointFace& face = faceOf(d, ref);
    Json hint{{"body", shapeOfBody(element.mesh->body)}};
    Json line;
    if (const Handle* handle = element.handleOf(ref.face)) {
        line = {{"do", "handle"}, {"element", element.name}, {"name", handle->face}, {"point", json(handle->point)}, {"radius", handle->radius}};
        if (handle->bone) line["bone"] = endpointText(d, *handle->bone);
        if (const auto at = corners(element.mesh->body, handle->point)) hint["at"] = *at;
    } else {
        line = {{"do", "add-joint-face"}, {"element", element.name}, {"name", face.name}, {"vertices", face.vertices}};
        hint["plane"] = {{"origin", json(face.frame.origin)}, {"normal", json(Vec3(face.frame.axes.col(2)))}};
    }
    line[kPasteHint] = std::move(hint);
    return line;
}

void addEffect(const Document& d, EffectKind kind, Json& commands) {
    const Effect& effect = d.effects[kind];
    const std::string name(effectName(kind));
    for (const EffectProperty& p : effectProperties(kind))
        commands.push_back({{"do", "set"}, {"target", name}, {"property", std::string(p.name)}, {"value", p.size == 3 ? json(d.effects.vector(kind, p.name)) : Json(d.effects.number(kind, p.name))}});
    if (!effect.enabled) return commands.push_back({{"do", "disable"}, {"effect", name}});
    Json line{{"do", "enable"}, {"effect", name}};
    if (effectDescriptor(kind).canBeAutomatic) line["auto"] = effect.automatic;
    if (effect.elements.empty() || effect.automatic) return commands.push_back(std::move(line));
    commands.push_back({{"do", "disable"}, {"effect", name}});
    for (const auto& [id, element] : d.elements)
        if (effect.elements.contains(id)) {
            line["target"] = element->name;
            commands.push_back(line);
        }
}

Result<Json> copy(SessionAccess& access, const Json& arguments, const Progress&) {
    const Document& d = access.document();
    IMOMUSHI_TRY(auto wish, copyWish(d, arguments));
    Json commands = Json::array();
    const CopiedParts& whole = wish.whole;
    if (!whole.elements.empty()) {
        if (!arguments.contains("path")) return fail("missing-key", "Elements and characters are copied into a file: give \"copy\" a \"path\" that ends in .imomushi.");
        IMOMUSHI_TRY(const auto path, outputPath(arguments, "path", {".imomushi"}));
        access.responses.refresh();
        const Project project = projectOf(access, whole);
        if (auto saved = saveProject(path, project); !saved) return tl::unexpected(saved.error());
        commands.push_back({{"do", "append"}, {"path", path.string()}, {"beside", true}});
    }
    const auto comes = [&](PartId element) { return whole.elements.contains(element); };
    std::set<PartId> bones = whole.bones;
    std::erase_if(bones, [&](PartId id) { return comes(d.bones.at(id)->element); });
    for (const auto& [character, id] : wish.cuts) {
        const CharacterSource& source = *d.characters.at(character);
        if (whole.characters.contains(character)) continue;
        for (const Cut& cut : source.cuts)
            if (cut.id == id)
                commands.push_back({{"do", "cut"}, {"element", source.name}, {"plane", {{"origin", json(cut.plane.origin)}, {"normal", json(cut.plane.normal)}}}, {"name", cut.name}});
    }
    for (const FaceRef& face : wish.faces)
        if (!comes(face.element) && !d.elements.at(face.element)->handleOf(face.face)) commands.push_back(faceCommand(d, face));
    for (const PartId id : inOrder(d, bones)) {
        commands.push_back(boneJson(d, *d.bones.at(id), bones));
        addBoneSettings(*d.bones.at(id), commands);
    }
    for (const FaceRef& face : wish.faces)
        if (!comes(face.element) && d.elements.at(face.element)->handleOf(face.face)) commands.push_back(faceCommand(d, face));
    for (const EffectKind effect : wish.effects) addEffect(d, effect, commands);
    if (commands.empty()) return fail("nothing-to-copy", "There is nothing to copy: name elements, characters, bones, cuts, handles, joint faces or effects.");
    return Json{{"commands", std::move(commands)}};
}

}  // namespace

void addCopyCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("copy",
                       "Answers commands that make parts of the document again, for \"paste\", here or in another project: bones with their parents and limits, joint faces, handles, cuts, "
                       "effects with their settings. Elements and characters go into a file with the bones through them and their results.",
                       {{"names", Type::Array, true, "Names of elements, characters, bones, cuts, handles and effects, joint faces as \"element/face\"."},
                        {"path", Type::Text, false, "The file for elements and characters, which ends in .imomushi."}},
                       copy);
}

}  // namespace imomushi
