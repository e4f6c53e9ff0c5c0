// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/base/formatted.h"
#include "core/commands/core_commands.h"
#include "core/commands/handle_commands.h"
#include "core/document/command_support.h"
#include "core/document/face_references.h"
#include "core/document/names.h"
#include "core/joints/grown_vertices.h"
#include "core/joints/seam.h"
#include "core/mesh/bounds.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

/// How far from the plane a corner may lie unless the command says: relative to the diagonal of the element.
constexpr double kPlaneTolerance = 1e-4;
/// More rings than any body has between two of its faces.
constexpr double kMostRings = 10'000.0;

Result<std::vector<std::int32_t>> indicesFrom(const Json& value, Eigen::Index count) {
    std::vector<std::int32_t> indices;
    for (const Json& part : value) {
        const double index = part.is_number() ? part.get<double>() : -1.0;
        if (index != std::floor(index) || index < 0.0 || index >= static_cast<double>(count))
            return fail("bad-index", "\"vertices\" must hold whole numbers from 0 to " + std::to_string(count - 1) + ".");
        indices.push_back(static_cast<std::int32_t>(index));
    }
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    return indices;
}

Result<JointFace> faceInPlane(const TriangleMesh& body, const Json& plane, const Json& arguments) {
    IMOMUSHI_TRY(const auto given, planeFrom(plane));
    const double size = diagonalOf(body.vertices);
    double tolerance = kPlaneTolerance * size;
    if (auto ok = readNumber(arguments, "tolerance", 0.0, size, tolerance); !ok) return tl::unexpected(ok.error());
    return jointFaceByPlane(body, given.origin(), given.normal(), tolerance);
}

Result<JointFace> faceOfIndices(const TriangleMesh& body, const Json& vertices) {
    IMOMUSHI_TRY(const auto indices, indicesFrom(vertices, body.vertices.rows()));
    return jointFaceByVertices(body, indices);
}

Result<JointFace> grownFace(const TriangleMesh& body, const JointFace& face, const Json& grow) {
    IMOMUSHI_TRY(const double rings, numberWithin(grow, "grow", -kMostRings, kMostRings));
    if (rings == 0.0) return fail("bad-value", "\"grow\" must not be 0: name the rings of vertices to add, or below 0 to take away.");
    const auto vertices = grownVertices(body, face.vertices, static_cast<int>(rings));
    if (vertices.empty()) return fail("nothing-left", "Nothing would be left of the face: take fewer rings away.");
    return jointFaceByVertices(body, vertices);
}

/// A face has a ring of free triangles about it. `instead`: of which it takes the place.
Result<void> checkApart(const Element& of, const JointFace& face, std::string_view instead = {}) {
    for (const JointFace& other : of.faces) {
        if (other.name == instead) continue;
        std::vector<std::int32_t> shared;
        std::set_intersection(other.vertices.begin(), other.vertices.end(), face.vertices.begin(), face.vertices.end(),
                              std::back_inserter(shared));
        if (!shared.empty())
            return fail("shared-rim", "The face would share " + std::to_string(shared.size()) + " vertices with the joint face \"" + other.name +
                                          "\": one ring of free triangles must lie between two faces.");
    }
    if (face.vertices.size() == static_cast<std::size_t>(of.mesh->body.vertices.rows()))
        return fail("no-free-vertex", "The face would hold every vertex of the element: leave some of its surface free.");
    return {};
}

Json patchJson(const JointFace& face) {
    return {{"vertices", face.vertices.size()}, {"triangles", face.triangles.size()}, {"indices", face.vertices},
            {"frame", json(face.frame)}, {"planarity_error", face.planarityError}, {"flat", face.flat()}, {"area", face.area},
            {"size", face.size}};
}

Result<Json> addJointFace(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto element, elementOf(document, text(arguments, "element")));
    const std::string& name = text(arguments, "name");
    if (auto ok = checkNameText(name); !ok) return tl::unexpected(ok.error());
    if (element->faceIndex(name) >= 0)
        return fail("name-taken", "The element \"" + element->name + "\" has a joint face \"" + name + "\" already: choose another name.");
    const TriangleMesh& body = element->mesh->body;
    const Json* plane = find(arguments, "plane");
    const Json* vertices = find(arguments, "vertices");
    if ((plane != nullptr) == (vertices != nullptr)) return fail("missing-key", "\"add-joint-face\" needs either \"plane\" or \"vertices\".");
    Result<JointFace> face = fail("no-patch", "");
    if (plane) {
        face = faceInPlane(body, *plane, arguments);
    } else {
        if (arguments.contains("tolerance")) return fail("unknown-key", "\"tolerance\" goes with \"plane\" only.");
        face = faceOfIndices(body, *vertices);
    }
    if (!face) return tl::unexpected(face.error());
    if (auto ok = checkApart(*element, *face); !ok) return tl::unexpected(ok.error());
    face->name = name;
    Json answer = patchJson(*face);
    exchangePart(document.elements, element->id, [&](Element& changed) { changed.faces.push_back(std::move(*face)); });
    return answer;
}

Result<Json> editJointFace(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto ref, document.face(text(arguments, "face")));
    const Element& element = *document.elements.at(ref.element);
    const JointFace& was = faceOf(document, ref);
    if (auto ok = checkFree(document, ref); !ok) return tl::unexpected(ok.error());
    const TriangleMesh& body = element.mesh->body;
    const Json *plane = find(arguments, "plane"), *vertices = find(arguments, "vertices"), *grow = find(arguments, "grow");
    if ((plane ? 1 : 0) + (vertices ? 1 : 0) + (grow ? 1 : 0) != 1) return fail("missing-key", "\"edit-joint-face\" needs one of \"plane\", \"vertices\" and \"grow\".");
    if (!plane && arguments.contains("tolerance")) return fail("unknown-key", "\"tolerance\" goes with \"plane\" only.");
    IMOMUSHI_TRY(auto face, plane ? faceInPlane(body, *plane, arguments) : vertices ? faceOfIndices(body, *vertices) : grownFace(body, was, *grow));
    if (auto ok = checkApart(element, face, ref.face); !ok) return tl::unexpected(ok.error());
    face.takeNameFrom(was);
    Json answer = patchJson(face);
    exchangePart(document.elements, ref.element, [&](Element& changed) { changed.faces[static_cast<std::size_t>(changed.faceIndex(ref.face))] = std::move(face); });
    // Bones that end at it must still be bones.
    IMOMUSHI_TRY(const auto planned, edit.planned());
    return answer;
}

Result<Json> join(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto a, document.face(text(arguments, "a")));
    IMOMUSHI_TRY(const auto b, document.face(text(arguments, "b")));
    IMOMUSHI_TRY(const auto joined, joinFaces(document, a, b));
    const JointFace &first = faceOf(document, a), &second = faceOf(document, b);
    Json warnings = Json::array();
    if (first.frame.axes.col(2).dot(second.frame.axes.col(2)) > 0.0)
        warnings.push_back("The faces look the same way, so that their elements overlap: join faces that look at each other.");
    Json answer{{"welded", joined.welded}, {"unmatched", first.vertices.size() + second.vertices.size() - 2 * joined.welded},
                {"largest_gap", joined.gap}, {"warnings", std::move(warnings)}};
    return answer;
}

Result<Json> unjoin(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto face, document.face(text(arguments, "face")));
    if (!document.jointOf(face)) return fail("not-joined", "The face \"" + text(arguments, "face") + "\" is not joined.");
    leaveJoint(document, face);
    return Json::object();
}

Result<Json> removeJointFace(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto face, edit.document.face(text(arguments, "face")));
    removeFace(edit.document, face);
    return Json::object();
}

void eraseCharacter(Document& document, PartId character) {
    document.characters.erase(character);
    std::erase_if(document.turns, [character](const auto& turn) { return turn.first.character == character; });
    std::erase_if(document.morphs, [character](const auto& morph) { return morph.first.character == character; });
}

/// What an element or a whole character leaves behind is free: see dropElement().
Result<Json> removeElement(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    const std::string& name = text(arguments, "name");
    if (const CharacterSource* character = document.characterNamed(name)) {
        const PartId gone = character->id;
        for (const PartId element : document.elementsOf(gone)) dropElement(document, element);
        eraseCharacter(document, gone);
        return Json::object();
    }
    IMOMUSHI_TRY(const auto element, elementOf(document, name));
    if (const auto& piece = element->piece) {
        const CharacterSource& character = *document.characters.at(piece->character);
        if (!character.cuts.empty())
            return fail("part-of-character", "The element \"" + name + "\" is a piece of the character \"" + character.name +
                                                 "\": take out the cut beside it with remove-cut, or remove the whole character by its name.");
        eraseCharacter(document, character.id);
    }
    dropElement(document, element->id);
    return Json::object();
}

}  // namespace

FaceGap faceGap(const Document& document, const FaceRef& a, const FaceRef& b) {
    const FaceOnBody first{&document.elements.at(a.element)->mesh->body, &faceOf(document, a)};
    const FaceOnBody second{&document.elements.at(b.element)->mesh->body, &faceOf(document, b)};
    FaceGap out;
    for (const SeamPoint& point : seamPoints(first, second)) out.gap = std::max(out.gap, point.distance);
    out.share = out.gap / std::max(first.face->size, second.face->size);
    return out;
}

Result<JoinedFaces> joinFaces(Document& document, const FaceRef& a, const FaceRef& b) {
    for (const FaceRef& face : {a, b})
        if (document.elements.at(face.element)->handleOf(face.face))
            return fail("is-handle", "\"" + face.face + "\" is a handle, which moves by itself: join joint faces.");
    if (a.element == b.element) return fail("same-element", "Both faces belong to one element: join faces of two elements.");
    const FaceGap between = faceGap(document, a, b);
    if (!(between.share <= kLargestGap))
        return fail("gap-too-large", formatted("The faces are %.3g m apart at most, which is %.3g %% of their size: bring them together to 1 %% before joining.", between.gap, 100.0 * between.share));
    const auto welded = weldedVertices({&document.elements.at(a.element)->mesh->body, &faceOf(document, a)}, {&document.elements.at(b.element)->mesh->body, &faceOf(document, b)});

    const Joint* jointA = document.jointOf(a);
    const Joint* jointB = document.jointOf(b);
    if (jointA && jointA == jointB) return fail("already-joined", "These faces are joined already.");
    if (jointA && jointB) {
        // Two joints become one: the older one takes the faces of the younger.
        const PartId keep = std::min(jointA->id, jointB->id), gone = std::max(jointA->id, jointB->id);
        const std::vector<FaceRef> more = document.joints.at(gone)->faces;
        document.joints.erase(gone);
        exchangePart(document.joints, keep, [&](Joint& joint) { joint.faces.insert(joint.faces.end(), more.begin(), more.end()); });
    } else if (jointA || jointB) {
        exchangePart(document.joints, jointA ? jointA->id : jointB->id, [&](Joint& joint) { joint.faces.push_back(jointA ? b : a); });
    } else {
        Joint joint;
        joint.id = document.nextId++;
        joint.faces = {a, b};
        document.joints.emplace(joint.id, std::make_shared<const Joint>(std::move(joint)));
    }
    return JoinedFaces{welded.size(), between.gap};
}

void removeFace(Document& document, const FaceRef& face) {
    leaveJoint(document, face);
    freeBones(document, {face});
    eraseHandle(document, face);
    exchangePart(document.elements, face.element, [&](Element& element) {
        element.faces.erase(element.faces.begin() + element.faceIndex(face.face));
        if (CutSide* side = element.sideOf(face.face)) side->face.clear();
    });
}

void addElementCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey path{"face", Type::Text, true, "\"element/face\"."};
    registry.addChange("add-joint-face",
                       "Makes a patch of an element's surface a joint face: by plane the largest connected patch in it, by vertices the triangles whose "
                       "corners are all named.",
                       {{"element", Type::Text, true, "The element."},
                        {"name", Type::Text, true, "A name that no other face of the element has."},
                        {"plane", Type::Object, false, "{\"origin\": [x,y,z], \"normal\": [x,y,z]}, metres, normal outward."},
                        {"tolerance", Type::Number, false, "Metres that a corner may lie off the plane (1e-4 of the element's diagonal)."},
                        {"vertices", Type::Array, false, "Body vertices, counted from 0."}},
                       addJointFace);
    registry.addChange("edit-joint-face",
                       "Makes a joint face another patch of its element, by a plane, by vertices, or larger or smaller than it is; its name and the ends of bones at it stay. "
                       "Not of a handle, of a cut, or while it is joined.",
                       {path,
                        {"plane", Type::Object, false, "{\"origin\": [x,y,z], \"normal\": [x,y,z]}, metres, normal outward."},
                        {"tolerance", Type::Number, false, "Metres that a corner may lie off the plane (1e-4 of the element's diagonal)."},
                        {"vertices", Type::Array, false, "Body vertices, counted from 0."},
                        {"grow", Type::Integer, false, "Rings of neighbours to add; below 0: outer rings to take away."}},
                       editJointFace);
    registry.addChange("join",
                       "Joins two faces so that they look like one surface in every pose; moves nothing. A face that is joined already takes the other "
                       "one into its joint.",
                       {{"a", Type::Text, true, "\"element/face\"."}, {"b", Type::Text, true, "\"element/face\" of another element."}},
                       join);
    registry.addChange("unjoin", "Takes a face out of its joint.", {path}, unjoin);
    registry.addChange("remove-joint-face", "Removes a joint face; bones that ended at it stay where they are.", {path}, removeJointFace);
    registry.addChange("remove-element",
                       "Removes an element with its joint faces; bones that ended at them stay where they are. A character goes as a whole, by its own name.",
                       {{"name", Type::Text, true, "The element, or a character."}},
                       removeElement);
}

}  // namespace imomushi
