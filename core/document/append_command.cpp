// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/document/session_state.h"
#include "core/document/storage.h"

namespace imomushi {

namespace {

/// Ids and names of another project, as they are in this one.
class Guests {
public:
    Guests(Document& here, const Document& there) : here_(here), there_(there) {}

    PartId idOf(PartId part) {
        if (part == 0) return 0;
        const auto [known, added] = ids_.try_emplace(part, 0);
        if (added) known->second = here_.nextId++;
        return known->second;
    }
    [[nodiscard]] bool has(PartId part) const { return ids_.contains(part); }

    /// A place of a bone; where it refers to what stays behind, where that is at rest.
    Bone::Place placeOf(const Bone::Place& place) {
        if (const auto* face = std::get_if<FaceRef>(&place); face && has(face->element)) return FaceRef{idOf(face->element), face->face};
        if (const auto* end = std::get_if<EndpointRef>(&place); end && has(end->bone)) return EndpointRef{idOf(end->bone), end->atEnd};
        const auto at = restPosition(there_, place);
        return at ? *at : Vec3(Vec3::Zero());
    }

private:
    Document& here_;
    const Document& there_;
    std::map<PartId, PartId> ids_;
};

std::string freeTakeName(const Document& document, const std::string& wish) {
    std::string name = wish;
    for (int n = 2; document.takeNamed(name); ++n) name = wish + " " + std::to_string(n);
    return name;
}

Result<Json> append(Session& session, const Json& arguments, const Progress&) {
    const std::string& path = text(arguments, "path");
    if (path.empty() || path.find('\0') != std::string::npos) return fail("bad-value", "\"path\" is empty or holds a zero byte.");
    const auto project = openProject(path);
    if (!project) return tl::unexpected(project.error());
    const Document& there = project->document;
    std::set<PartId> wanted;
    if (const Json* names = find(arguments, "elements")) {
        for (const Json& name : *names) {
            if (!name.is_string()) return fail("bad-type", "\"elements\" must be names.");
            const auto element = elementOf(there, name.get_ref<const std::string&>());
            if (!element) return tl::unexpected(element.error());
            wanted.insert((*element)->id);
        }
    } else {
        for (const auto& [id, element] : there.elements) wanted.insert(id);
    }
    if (wanted.empty()) return fail("no-element", "There is nothing to append: the other project has no elements, or none was named.");

    Session::State& s = session.state();
    Document& here = session.edit();
    Guests guests(here, there);
    Json answer{{"elements", Json::array()}, {"bones", Json::array()}, {"takes", Json::array()}};
    for (const PartId id : wanted) {
        Element element = *there.elements.at(id);
        element.id = guests.idOf(id);
        element.name = freeName(here, element.name);
        answer["elements"].push_back(element.name);
        if (const auto known = project->responses.find(id); known != project->responses.end()) {
            s.responses.insert(known->second.key, known->second.response);
            s.lastResponses.insert_or_assign(element.id, Session::State::LastResponse{known->second.key, known->second.shape});
            s.pending.responses = true;
        }
        here.elements.emplace(element.id, std::make_shared<const Element>(std::move(element)));
    }
    for (const auto& [id, joint] : there.joints) {
        Joint made;
        for (const FaceRef& face : joint->faces)
            if (wanted.contains(face.element)) made.faces.push_back({guests.idOf(face.element), face.face});
        if (made.faces.size() < 2) continue;
        made.id = guests.idOf(id);
        here.joints.emplace(made.id, std::make_shared<const Joint>(std::move(made)));
    }
    // Bones refer to each other in any order.
    const auto comes = [&](const Bone& bone) { return wanted.size() == there.elements.size() || wanted.contains(bone.element); };
    for (const auto& [id, bone] : there.bones)
        if (comes(*bone)) (void)guests.idOf(id);
    for (const auto& [id, bone] : there.bones) {
        if (!comes(*bone)) continue;
        Bone made = *bone;
        made.id = guests.idOf(id);
        made.name = freeName(here, bone->name);
        made.element = guests.idOf(bone->element);
        made.parent = guests.has(bone->parent) ? guests.idOf(bone->parent) : 0;
        made.start = guests.placeOf(bone->start);
        made.end = guests.placeOf(bone->end);
        answer["bones"].push_back(made.name);
        here.bones.emplace(made.id, std::make_shared<const Bone>(std::move(made)));
    }
    for (const auto& [id, take] : there.takes) {
        if (wanted.size() != there.elements.size()) break;
        Take made = *take;
        made.id = guests.idOf(id);
        made.name = freeTakeName(here, take->name);
        for (Take::Bone& bone : made.bones) bone.bone = guests.idOf(bone.bone);
        for (PartId& element : made.elements) element = guests.idOf(element);
        for (Take::Target& target : made.targets) target.bone = guests.idOf(target.bone);
        answer["takes"].push_back(made.name);
        here.takes.emplace(made.id, std::make_shared<const Take>(std::move(made)));
    }
    return answer;
}

}  // namespace

void addAppendCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.add({"append",
                  "Adds the elements of another project, with their joint faces, joints, bones and results, where they are there. Names that are taken get a number. Whole "
                  "projects bring their takes, which show their poses.",
                  {{"path", Type::Text, true, "A .imomushi file."},
                   {"elements", Type::Array, false, "Names of these elements alone, with the bones through them (all unless given)."}},
                  true, append});
}

}  // namespace imomushi
