// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <optional>

#include "core/base/formatted.h"
#include "core/body/cut.h"
#include "core/commands/core_commands.h"
#include "core/commands/handle_commands.h"
#include "core/commands/import_request.h"
#include "core/document/attachments.h"
#include "core/document/character_cuts.h"
#include "core/document/character_repair.h"
#include "core/document/command_support.h"
#include "core/document/face_references.h"
#include "core/document/names.h"
#include "core/joints/carried_face.h"
#include "core/mesh/bounds.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

/// A mesh so many times as large or small as the other is in another unit, or not of the same character.
constexpr double kLargestScale = 4.0;
/// A handle farther from the new surface than this, of its diagonal, has no place there.
constexpr double kHandleAway = 0.1;

/// What the rig keeps on another mesh.
class Replacement {
public:
    explicit Replacement(Document& document) : document_(document) {}

    Result<void> element(PartId id, std::shared_ptr<const ElementMesh> mesh, std::vector<MeshIssue> issues);
    Result<void> character(PartId id, std::shared_ptr<const RenderModel> model, std::shared_ptr<const Body> body, std::vector<MeshIssue> issues, const Progress& progress);
    [[nodiscard]] Json answer() const;

private:
    void keep(const char* what, const std::string& name) { kept_[what].push_back(name); }
    void lose(const char* what, const std::string& name, const Error& why) { lost_.push_back({{"what", what}, {"name", name}, {"code", why.code}, {"why", why.message}}); }
    void findFaces(PartId id, const Element& was);
    void loseFace(const FaceRef& ref, const Element& was, const JointFace& face, const Error& why);
    void checkJoints(PartId id);
    Result<void> cutAgain(PartId id, const TriangleMesh& body, const Progress& progress);
    Result<void> loseCut(PartId character, PartId cut, const Error& why, const Progress& progress);
    void findParts(PartId id, const RenderModel& was);
    void keepBones(const std::set<PartId>& elements);

    Document& document_;
    Json kept_{{"faces", Json::array()}, {"handles", Json::array()}, {"cuts", Json::array()}, {"bones", Json::array()}, {"parts", Json::array()}}, lost_ = Json::array();
    std::vector<PartId> elements_;
};

Result<void> checkScale(const Points& was, const Points& is) {
    const double scale = diagonalOf(is) / diagonalOf(was);
    if (scale <= kLargestScale && scale * kLargestScale >= 1.0) return {};
    return fail("other-size", formatted("The new mesh is %.3g times as large as the old one: give its \"unit\", or bring it to the size of the old one first.", scale));
}

void Replacement::loseFace(const FaceRef& ref, const Element& was, const JointFace& face, const Error& why) {
    lose(was.handleOf(ref.face) ? "handle" : "face", was.handleOf(ref.face) ? ref.face : was.name + "/" + ref.face, why);
    // As it was once more, for what refers to it: ends of bones stay at its old middle.
    exchangePart(document_.elements, ref.element, [&](Element& changed) {
        changed.faces.push_back(face);
        if (const Handle* handle = was.handleOf(ref.face)) changed.handles.push_back(*handle);
    });
    removeFace(document_, ref);
}

/// The faces of `was` on the new body of an element, which has none of them yet but those of its cuts.
void Replacement::findFaces(PartId id, const Element& was) {
    const TriangleMesh &before = was.mesh->body, &body = document_.elements.at(id)->mesh->body;
    if (before.vertices.rows() == body.vertices.rows() && before.triangles.rows() == body.triangles.rows() && before.vertices == body.vertices && before.triangles == body.triangles) {
        exchangePart(document_.elements, id, [&](Element& same) {
            same.faces = was.faces;
            same.handles = was.handles;
        });
        for (const JointFace& face : was.faces) keep(was.handleOf(face.name) ? "handles" : "faces", was.handleOf(face.name) ? face.name : was.name + "/" + face.name);
        return;
    }
    for (const JointFace& face : was.faces) {
        const Element& now = *document_.elements.at(id);
        if (now.faceIndex(face.name) >= 0) {
            keep("faces", now.name + "/" + face.name);
            continue;
        }
        const Handle* handle = was.handleOf(face.name);
        std::optional<Handle> disc;
        Result<JointFace> found = fail("face-lost", "");
        if (handle) {
            disc = *handle;
            const SurfacePoint place = nearestOnSurface(now.mesh->body, handle->point);
            disc->point = place.point;
            found = place.distance <= kHandleAway * diagonalOf(now.mesh->body.vertices) ? handleFace(now, place.point, disc->radius) : fail("bad-point", "The new surface is too far away from it.");
        } else {
            found = refoundFace(was.mesh->body, face, now.mesh->body);
            if (found)
                if (const int other = overlappingFace(now.faces, *found); other >= 0)
                    found = fail("shared-rim", "It would touch \"" + now.faces[static_cast<std::size_t>(other)].name + "\".");
        }
        if (!found) {
            loseFace({id, face.name}, was, face, found.error());
            continue;
        }
        found->takeNameFrom(face);
        keep(handle ? "handles" : "faces", handle ? face.name : now.name + "/" + face.name);
        exchangePart(document_.elements, id, [&](Element& changed) {
            changed.faces.push_back(std::move(*found));
            if (disc) changed.handles.push_back(std::move(*disc));
        });
    }
    // Results count faces in their order.
    exchangePart(document_.elements, id, [&](Element& changed) {
        std::sort(changed.faces.begin(), changed.faces.end(), [&](const JointFace& a, const JointFace& b) { return was.faceIndex(a.name) < was.faceIndex(b.name); });
    });
    std::erase_if(document_.touches, [&](const Touch& touch) { return touch.element == id; });
}

/// Joints whose faces lie apart now would tear.
void Replacement::checkJoints(PartId id) {
    std::vector<FaceRef> faces;
    for (const JointFace& face : document_.elements.at(id)->faces) faces.push_back({id, face.name});
    for (const FaceRef& face : faces) {
        const Joint* joint = document_.jointOf(face);
        if (!joint) continue;
        const bool meets = std::any_of(joint->faces.begin(), joint->faces.end(), [&](const FaceRef& other) { return other != face && faceGap(document_, face, other).share <= kLargestGap; });
        if (meets) continue;
        lose("joint", faceText(document_, face), {"gap-too-large", "The face does not meet the one that it was joined to any more."});
        leaveJoint(document_, face);
    }
}

void Replacement::keepBones(const std::set<PartId>& elements) {
    for (const auto& [id, bone] : document_.bones)
        if (elements.contains(bone->element)) keep("bones", bone->name);
}

Result<void> Replacement::element(PartId id, std::shared_ptr<const ElementMesh> mesh, std::vector<MeshIssue> issues) {
    const Element was = *document_.elements.at(id);
    if (auto ok = checkScale(was.mesh->body.vertices, mesh->body.vertices); !ok) return ok;
    exchangePart(document_.elements, id, [&](Element& changed) {
        changed.mesh = std::move(mesh);
        changed.issues = std::move(issues);
        changed.faces.clear();
        changed.handles.clear();
    });
    findFaces(id, was);
    checkJoints(id);
    keepBones({id});
    elements_ = {id};
    return {};
}

Result<void> Replacement::loseCut(PartId character, PartId cut, const Error& why, const Progress& progress) {
    const CharacterSource& source = *document_.characters.at(character);
    lose("cut", source.cuts[static_cast<std::size_t>(source.cutIndex(cut))].name, why);
    if (auto removed = removeCut(document_, character, cut, progress); !removed) return tl::unexpected(removed.error());
    return {};
}

/// Takes out cuts that cannot divide the new body.
Result<void> Replacement::cutAgain(PartId id, const TriangleMesh& body, const Progress& progress) {
    for (;;) {
        const std::vector<Cut> cuts = document_.characters.at(id)->cuts;
        std::vector<CutPlane> planes;
        for (const Cut& cut : cuts) planes.push_back(cut.plane);
        const auto pieces = cutBody(body, planes, progress);
        if (!pieces) {
            if (pieces.error().code == kCancelled || cuts.empty()) return fail(pieces.error().code, pieces.error().message);
            const auto at = pieces.error().cut >= 0 ? static_cast<std::size_t>(pieces.error().cut) : cuts.size() - 1;
            if (auto ok = loseCut(id, cuts[at].id, pieces.error(), progress); !ok) return ok;
            continue;
        }
        // Each element is the piece between its cuts. Where there is none, the youngest cut beside it goes.
        std::optional<PartId> gone;
        for (const PartId element : document_.elementsOf(id)) {
            std::vector<std::pair<PartId, bool>> sides;
            for (const CutSide& side : document_.elements.at(element)->piece->sides) sides.emplace_back(side.cut, side.front);
            const bool there = std::any_of(pieces->begin(), pieces->end(), [&](const BodyPiece& piece) {
                std::vector<std::pair<PartId, bool>> caps;
                for (const auto& cap : piece.caps) caps.emplace_back(cuts[static_cast<std::size_t>(cap.cut)].id, cap.front);
                std::sort(caps.begin(), caps.end());
                return caps == sides;
            });
            if (!there && !sides.empty()) gone = std::max(gone.value_or(0), sides.back().first);
        }
        if (!gone) return {};
        if (auto ok = loseCut(id, *gone, {"cut-passes", "It divides the new mesh in another way."}, progress); !ok) return ok;
    }
}

/// Parts keep how they follow by their names.
void Replacement::findParts(PartId id, const RenderModel& was) {
    const CharacterSource now = *document_.characters.at(id);
    std::map<ModelPart, ModelPart> found;
    std::map<ModelPart, Attachment> attachments;
    for (const auto& [part, attachment] : now.attachments) {
        const std::string name = was.namedParts().nameOf(part);
        if (const auto there = now.model->namedParts().find(name)) {
            keep("parts", name);
            found.emplace(part, *there);
            attachments.emplace(*there, attachment);
        } else {
            lose("part", name, {"no-such-part", "The new mesh has no part of that name."});
        }
    }
    exchangePart(document_.characters, id, [&](CharacterSource& changed) { changed.attachments = attachments; });
    std::map<PartRef, TurnGoal> turns;
    for (const auto& [part, turn] : document_.turns) {
        if (part.character != id) {
            turns.emplace(part, turn);
        } else if (const auto there = found.find(part.part); there != found.end() && isRigid(*document_.characters.at(id), there->second)) {
            turns.emplace(PartRef{id, there->second}, turn);
        }
    }
    document_.turns = std::move(turns);
    std::map<MorphRef, double> morphs;
    for (const auto& [ref, weight] : document_.morphs) {
        const int there = ref.character == id ? now.model->morphIndex(was.morphs[static_cast<std::size_t>(ref.target)].name) : ref.target;
        if (there >= 0) morphs.emplace(MorphRef{ref.character, there}, weight);
    }
    document_.morphs = std::move(morphs);
}

Result<void> Replacement::character(PartId id, std::shared_ptr<const RenderModel> model, std::shared_ptr<const Body> body, std::vector<MeshIssue> issues, const Progress& progress) {
    if (auto ok = checkScale(document_.characters.at(id)->body->mesh.vertices, body->mesh.vertices); !ok) return ok;
    if (auto ok = cutAgain(id, body->mesh, progress); !ok) return ok;
    const std::shared_ptr<const CharacterSource> was = document_.characters.at(id);
    std::map<PartId, std::shared_ptr<const Element>> elements;
    for (const PartId element : document_.elementsOf(id)) {
        elements.emplace(element, document_.elements.at(element));
        // Faces of cuts follow these; the others are found again afterwards.
        exchangePart(document_.elements, element, [](Element& changed) {
            std::erase_if(changed.faces, [&](const JointFace& face) {
                return std::none_of(changed.piece->sides.begin(), changed.piece->sides.end(), [&](const CutSide& side) { return side.face == face.name; });
            });
            changed.handles.clear();
        });
    }
    IMOMUSHI_TRY(elements_, changeBody(document_, id, std::move(body), progress));
    exchangePart(document_.characters, id, [&](CharacterSource& source) {
        // Weights are for the vertices of the mesh that they came with.
        if (source.rig && !source.rig->weights.empty() && !model->sameVertices(*source.model)) {
            Rig rig = *source.rig;
            rig.weights = {};
            source.rig = std::make_shared<const Rig>(std::move(rig));
            lose("skin", source.name, {"other-vertices", "The skin of its skeleton is for the vertices of the mesh before: flesh follows the nearest bone. Import the skeleton of the new file for its own."});
        }
        source.model = std::move(model);
        source.issues = std::move(issues);
    });
    std::set<PartId> own;
    for (const auto& [element, before] : elements) {
        own.insert(element);
        findFaces(element, *before);
    }
    for (const auto& [element, before] : elements) checkJoints(element);
    for (const Cut& cut : document_.characters.at(id)->cuts) keep("cuts", cut.name);
    keepBones(own);
    findParts(id, *was->model);
    return {};
}

Json Replacement::answer() const {
    Json stale = Json::array();
    for (const PartId id : elements_) stale.push_back(document_.elements.at(id)->name);
    return Json{{"kept", kept_}, {"lost", lost_}, {"stale", std::move(stale)}};
}

Result<void> replaceElement(DocumentEdit& edit, Replacement& replacement, const Element& element, const ImportRequest& request, const Progress& progress) {
    if (element.piece)
        return fail("part-of-character", "The element \"" + element.name + "\" is a piece of the character \"" + edit.document.characters.at(element.piece->character)->name +
                                             "\": replace the mesh of that.");
    IMOMUSHI_TRY(auto imported, edit.services.import(request, progress));
    if (imported.bodies.empty()) return fail("empty-mesh", "\"" + request.path.string() + "\" holds no surface.");
    std::erase_if(imported.bodies, [all = imported.bodies.size()](const ImportedBody& body) { return all > 1 && !body.closed; });
    if (imported.bodies.empty()) return fail("open", "\"" + request.path.string() + "\" holds no closed surface: close its holes in a modelling program.");
    if (imported.bodies.size() > 1) return fail("several-bodies", "\"" + request.path.string() + "\" holds " + std::to_string(imported.bodies.size()) + " bodies: give a file with one of them.");
    ImportedBody& body = imported.bodies.front();
    if (!body.closed) {
        const Error error = importRefusal(body);
        return fail(error.code, error.message);
    }
    return replacement.element(element.id, std::make_shared<const ElementMesh>(std::move(body.mesh)), std::move(body.issues));
}

Result<void> replaceCharacter(DocumentEdit& edit, Replacement& replacement, const CharacterSource& character, const ImportRequest& request, const BodySetting& setting, const Progress& progress) {
    IMOMUSHI_TRY(auto imported, edit.services.importCharacter(request, progress.part(0.0, 0.3)));
    if (imported.renderModel.mesh.body.triangles.rows() == 0) return fail("empty-mesh", "\"" + request.path.string() + "\" holds no surface.");
    IMOMUSHI_TRY(auto body, edit.services.makeBody(imported.renderModel, imported.rig ? &*imported.rig : nullptr, setting, progress.part(0.3, 0.9)));
    body.report.seconds = 0.0;  // the rest of the report is the same each time
    std::vector<MeshIssue> issues = issuesWith(imported.issues, imported.renderModel, std::exchange(body.report.issues, {}));
    return replacement.character(character.id, std::make_shared<const RenderModel>(std::move(imported.renderModel)), std::make_shared<const Body>(std::move(body)), std::move(issues),
                                 progress.part(0.9, 1.0));
}

Result<Json> replaceMesh(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    const Json *characterName = find(arguments, "character"), *elementName = find(arguments, "element");
    if ((characterName != nullptr) == (elementName != nullptr)) return fail("missing-key", "\"replace-mesh\" needs either \"character\" or \"element\".");
    IMOMUSHI_TRY(const auto request, importRequestFrom(edit.document, arguments));
    if (elementName && arguments.contains("body")) return fail("unknown-key", "\"body\" goes with \"character\" only.");
    BodySetting setting;
    IMOMUSHI_TRY(setting.how, choiceFrom<BodyKind>(arguments, "body", {{"auto", BodyKind::Auto}, {"exact", BodyKind::Exact}, {"mended", BodyKind::Mended}, {"wrapped", BodyKind::Wrapped}}, BodyKind::Auto));
    Replacement replacement(edit.document);
    if (characterName) {
        IMOMUSHI_TRY(const auto character, characterOf(edit.document, characterName->get_ref<const std::string&>()));
        if (auto ok = replaceCharacter(edit, replacement, *character, request, setting, progress); !ok) return tl::unexpected(ok.error());
    } else {
        IMOMUSHI_TRY(const auto element, elementOf(edit.document, elementName->get_ref<const std::string&>()));
        if (auto ok = replaceElement(edit, replacement, *element, request, progress); !ok) return tl::unexpected(ok.error());
    }
    return replacement.answer();
}

}  // namespace

void addReplaceCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("replace-mesh",
                       "Gives a character or an element another mesh of about the same shape and place, which takes over its rig: cuts, joint faces and handles are found on it again, bones, "
                       "names and settings stay. What could not be kept is told with the reason; bones that ended there stay where they are.",
                       {{"character", Type::Text, false, "The character."},
                        {"element", Type::Text, false, "Or the element."},
                        {"path", Type::Text, true, "The file of the new mesh."},
                        {"unit", Type::Text, false, "\"mm\", \"cm\" or \"m\": the unit of the file (its own unless given; metres where it has none)."},
                        {"up", Type::Text, false, "\"y\" or \"z\": the axis of the file that points up (its own unless given; y where it has none)."},
                        {"body", Type::Text, false, "Of a character, how its new body is made, as in import-character: \"auto\" (unless given), \"exact\", \"mended\" or \"wrapped\"."}},
                       replaceMesh);
}

}  // namespace imomushi
