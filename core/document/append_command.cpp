// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <utility>

#include "core/document/command_support.h"
#include "core/document/document_edit.h"
#include "core/document/names.h"
#include "core/document/project_file.h"
#include "core/reduction/congruence.h"

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

    /// A handle comes under another name.
    void call(const FaceRef& handle, const std::string& name) { names_.insert_or_assign(handle, name); }
    [[nodiscard]] std::string nameOf(const FaceRef& face) const {
        const auto known = names_.find(face);
        return known == names_.end() ? face.face : known->second;
    }

    /// A place of a bone; where it refers to what stays behind, where that is at rest.
    Bone::Place placeOf(const Bone::Place& place) {
        if (const auto* face = std::get_if<FaceRef>(&place); face && has(face->element)) return FaceRef{idOf(face->element), nameOf(*face)};
        if (const auto* end = std::get_if<EndpointRef>(&place); end && has(end->bone)) return EndpointRef{idOf(end->bone), end->atEnd};
        const auto at = restPosition(there_, place);
        return at ? *at : Vec3(Vec3::Zero());
    }

private:
    Document& here_;
    const Document& there_;
    std::map<PartId, PartId> ids_;
    std::map<FaceRef, std::string> names_;
};

/// An element that stands elsewhere.
Element moved(const Element& element, const Vec3& offset) {
    Element out = element;
    ElementMesh mesh = *element.mesh;
    mesh.body.vertices.rowwise() += offset.transpose();
    out.mesh = std::make_shared<const ElementMesh>(std::move(mesh));
    for (JointFace& face : out.faces) face.frame.origin += offset;
    for (Handle& handle : out.handles) handle.point += offset;
    return out;
}

/// A character that stands elsewhere. Without an offset it shares its mesh and its body.
CharacterSource moved(const CharacterSource& character, const Vec3& offset) {
    CharacterSource out = character;
    if (offset == Vec3::Zero()) return out;
    RenderModel model = *character.model;
    Body body = *character.body;
    model.mesh.body.vertices.rowwise() += offset.transpose();
    body.mesh.vertices.rowwise() += offset.transpose();
    for (Vec3& place : body.report.gaps.places) place += offset;
    for (Cut& cut : out.cuts) cut.plane.origin += offset;
    if (out.rig) {
        Rig rig = *out.rig;
        Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
        place.topRightCorner<3, 1>() = offset;
        placeRig(rig, place);
        out.rig = std::make_shared<const Rig>(std::move(rig));
    }
    for (auto& [part, attachment] : out.attachments)
        if (attachment.pivot) *attachment.pivot += offset;
    out.model = std::make_shared<const RenderModel>(std::move(model));
    out.body = std::make_shared<const Body>(std::move(body));
    return out;
}

/// Numbers of a motion x -> linear * x + shift of a body that stands elsewhere at rest and moves as before there.
void shift(double* at, const Eigen::Matrix3d& linear, const Vec3& offset) {
    Eigen::Map<Vec3> to(at);
    to += offset - linear * offset;
}

void moveTake(Take& take, const Vec3& offset) {
    std::vector<std::vector<double>> poses, shapes;
    for (std::size_t f = 0; f < take.times.size(); ++f) {
        auto& pose = poses.emplace_back(take.poses.width());
        take.poses.at(f, pose.data());
        for (int p = 0; p < take.points; ++p) Eigen::Map<Vec3>(pose.data() + 3 * p) += offset;
        auto& shape = shapes.emplace_back(take.shapes.width());
        take.shapes.at(f, shape.data());
        for (std::size_t e = 0; e < take.layout.elements.size(); ++e) {
            double* at = shape.data() + take.layout.element(e);
            shift(at + 4, Eigen::Map<const Eigen::Quaterniond>(at).toRotationMatrix(), offset);
        }
        for (int j = 0; j < take.layout.joints; ++j) {
            double* at = shape.data() + take.layout.joint(j) + 4;
            shift(at + 9, Eigen::Map<const Eigen::Matrix3d>(at), offset);
        }
    }
    take.poses = FrameNumbers(poses);
    take.shapes = FrameNumbers(shapes);
    for (Take::Target& target : take.targets)
        if (target.held) target.to += offset;
}

/// Gives an element of this document its place, and its response with it: one does not depend on where a body stands. `known`: of the element as it stood.
void moveElement(DocumentEdit& edit, PartId id, const Vec3& offset, const StoredResponse* known) {
    const DocumentResponses& responses = edit.responses();
    const ResponseInput from = responses.inputOf(id);
    const ContentKey key = responses.keyOf(id), shape = responses.shapeOf(id);
    exchangePart(edit.document.elements, id, [&](Element& element) { element = moved(element, offset); });
    if (!known || (key != known->key && shape != known->shape)) return;
    const auto congruence = findCongruence(from, responses.inputOf(id));
    if (!congruence) return;
    auto carried = congruence->carry(*known->response);
    if (!carried) return;
    ContentKey carriedKey = responses.keyOf(id);
    if (key != known->key) {  // it only fits, and no precompute would give it: neither has another one its key
        ContentHasher hasher;
        hasher.text("carried");
        hasher.text(known->key.hex());
        hasher.text(carriedKey.hex());
        carriedKey = hasher.key();
    }
    edit.bring(id, {carriedKey, responses.shapeOf(id), std::make_shared<const ElementResponse>(std::move(*carried))});
}

std::string freeTakeName(const Document& document, const std::string& wish) {
    std::string name = wish;
    for (int n = 2; document.takeNamed(name); ++n) name = wish + " " + std::to_string(n);
    return name;
}

/// `wish`, or with a number, which no part and no other face of the element has.
std::string freeHandleName(const Document& document, const Element& element, const std::string& wish) {
    std::string name = freeName(document, wish);
    for (int n = 2; name != wish && element.faceIndex(name) >= 0; ++n) name = freeName(document, wish + " " + std::to_string(n));
    return name;
}

Result<Json> append(DocumentEdit& edit, const Json& arguments, const Progress&) {
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
    // Characters come whole: what is seen of one follows all of its elements.
    for (const auto& [id, element] : there.elements)
        if (wanted.contains(id) && element->piece)
            for (const PartId piece : there.elementsOf(element->piece->character)) wanted.insert(piece);
    if (wanted.empty()) return fail("no-element", "There is nothing to append: the other project has no elements, or none was named.");

    Vec3 offset = Vec3::Zero();
    if (const Json* given = find(arguments, "offset")) {
        offset = *vector3(*given);
        for (const PartId id : wanted)
            if (const Points& v = there.elements.at(id)->mesh->body.vertices; v.rows() > 0 && !((v.rowwise() + offset.transpose()).cwiseAbs().maxCoeff() <= kMaxCoordinate))
                return fail("bad-value", "\"offset\" takes the elements too far away.");
    }

    Document& here = edit.document;
    Guests guests(here, there);
    Json answer{{"elements", Json::array()}, {"bones", Json::array()}, {"handles", Json::array()}, {"takes", Json::array()}, {"renamed", Json::array()}};
    const auto tellName = [&](const std::string& name, const std::string& wish) {
        if (name != wish) answer["renamed"].push_back({{"from", wish}, {"to", name}});
    };
    const auto tell = [&](const char* list, const std::string& name, const std::string& wish) {
        answer[list].push_back(name);
        tellName(name, wish);
    };
    for (const auto& [id, character] : there.characters) {
        if (!wanted.contains(there.elementsOf(id).front())) continue;
        CharacterSource made = moved(*character, offset);
        made.id = guests.idOf(id);
        for (auto& [part, attachment] : made.attachments)
            attachment.element = wanted.contains(attachment.element) ? guests.idOf(attachment.element) : PartId(0);
        made.name = freeName(here, character->name);
        tellName(made.name, character->name);
        const PartId known = made.id;
        std::vector<Cut> cuts = std::exchange(made.cuts, {});
        here.characters.emplace(known, std::make_shared<const CharacterSource>(std::move(made)));
        for (Cut& cut : cuts) {  // one by one, so that no two get one name
            const std::string wish = cut.name;
            cut.id = guests.idOf(cut.id);
            cut.name = freeName(here, wish);
            tellName(cut.name, wish);
            exchangePart(here.characters, known, [&](CharacterSource& changed) { changed.cuts.push_back(std::move(cut)); });
        }
    }
    const auto comes = [&](const Bone& bone) { return wanted.size() == there.elements.size() || wanted.contains(bone.element); };
    for (const PartId id : wanted) {
        Element element = *there.elements.at(id);
        const std::vector<Handle> handles = std::exchange(element.handles, {});
        element.id = guests.idOf(id);
        if (element.piece) {
            element.piece->character = guests.idOf(element.piece->character);
            for (CutSide& side : element.piece->sides) side.cut = guests.idOf(side.cut);
        }
        element.name = freeName(here, element.name);
        tell("elements", element.name, there.elements.at(id)->name);
        const auto known = project->responses.find(id);
        const StoredResponse* response = known == project->responses.end() ? nullptr : &known->second;
        const PartId made = element.id;
        here.elements.emplace(made, std::make_shared<const Element>(std::move(element)));
        for (Handle handle : handles) {
            const FaceRef was{id, handle.face};
            handle.face = freeHandleName(here, *here.elements.at(made), was.face);
            if (handle.bone && comes(*there.bones.at(handle.bone->bone)))
                handle.bone->bone = guests.idOf(handle.bone->bone);
            else
                handle.bone.reset();
            guests.call(was, handle.face);
            tell("handles", handle.face, was.face);
            exchangePart(here.elements, made, [&](Element& changed) {
                changed.faces[static_cast<std::size_t>(changed.faceIndex(was.face))].name = handle.face;
                changed.handles.push_back(std::move(handle));
            });
        }
        if (offset != Vec3::Zero()) {
            moveElement(edit, made, offset, response);
        } else if (response) {
            edit.bring(made, *response);
        }
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
        for (Bone::Place* place : {&made.start, &made.end})
            if (auto* at = std::get_if<Vec3>(place)) *at += offset;
        tell("bones", made.name, bone->name);
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
        if (offset != Vec3::Zero()) moveTake(made, offset);
        tell("takes", made.name, take->name);
        here.takes.emplace(made.id, std::make_shared<const Take>(std::move(made)));
    }
    return answer;
}

}  // namespace

void addAppendCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("append",
                       "Adds the elements of another project, with their joint faces, joints, bones and results, where they are there or beside that. Names that are "
                       "taken get a number, which is told. Characters come with all of their elements. Whole projects bring their takes, which show their poses.",
                       {{"path", Type::Text, true, "A .imomushi file."},
                        {"offset", Type::Vector3, false, "Metres that they are shifted by, with their bones and takes ([0,0,0])."},
                        {"elements", Type::Array, false, "Names of these elements alone, with the bones through them (all unless given)."}},
                       append);
}

}  // namespace imomushi
