// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/commands/copied_parts.h"
#include "core/commands/core_commands.h"
#include "core/commands/handle_commands.h"
#include "core/document/character_cuts.h"
#include "core/document/command_support.h"
#include "core/document/face_references.h"
#include "core/document/names.h"
#include "core/document/side_names.h"
#include "core/joints/carried_face.h"
#include "core/mesh/bounds.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

/// Boxes that agree so far, of their diagonal, are one: the mirror image of such an element would lie in the element.
constexpr double kSameBox = 0.01;
/// Cuts are one where their planes lean less than this, and the origin of each lies as near to the other (in diagonals of the body): along its normal, and across.
const double kSameLean = std::cos(5.0 * std::numbers::pi / 180.0);
constexpr double kSameAlong = 0.01, kSameAcross = 0.05;
/// Ends of bones that are so near to each other, of the bone's length, are at one place.
constexpr double kSamePlace = 1e-4;
/// Faces that look at each other this much may be joined.
constexpr double kFacing = -0.9;

Error ownImage() { return {"own-image", "It is its own mirror image."}; }
Error thereAlready(const std::string& kind, const std::string& name) { return {"image-there", "The " + kind + " \"" + name + "\" is there already."}; }

/// What is to be mirrored, as it is asked for.
struct Asked {
    CopiedParts whole;               ///< copied
    std::set<PartId> pieces, cuts;   ///< of characters: mirrored on the same body
    std::set<FaceRef> faces;         ///< and handles: the same
};

/// The mirror image of a cut.
struct MirroredCut {
    PartId cut = 0;
    bool turned = false;  ///< what lay in front of the first lies behind this one
};

class Mirror {
public:
    Mirror(DocumentEdit& edit, const Document& from, Asked asked, PartCopier::Options options)
        : edit_(edit), document_(edit.document), from_(from), asked_(std::move(asked)), copier_(edit, from, std::move(options)) {}

    Result<Json> run(const Progress& progress);

private:
    void leaveOut(const std::string& name, const Error& why) { left_.push_back({{"name", name}, {"code", why.code}, {"why", why.message}}); }
    void leaveOutCentred();
    Result<void> mirrorCuts(const Progress& progress);
    /// Cuts that a cut of the character is mirrored onto, by its id: its own in the plane.
    [[nodiscard]] std::map<PartId, MirroredCut> imagesThere(const CharacterSource& character) const;
    void matchPieces();
    void mirrorFaces();
    void mirrorFace(const Element& was, const JointFace& face, PartId target);
    void leaveOutBones();
    void joinMeeting();

    DocumentEdit& edit_;
    Document& document_;
    const Document& from_;
    Asked asked_;
    PartCopier copier_;
    std::map<PartId, MirroredCut> cuts_;
    Json left_ = Json::array(), faces_ = Json::array(), joined_ = Json::array();
};

/// An element or a character that lies across the plane would be mirrored into itself.
void Mirror::leaveOutCentred() {
    const auto centred = [&](const Points& v) {
        const Vec3 low = v.colwise().minCoeff(), high = v.colwise().maxCoeff();
        const Vec3 a = copier_.placing().point(low), b = copier_.placing().point(high);
        return std::max((a.cwiseMin(b) - low).norm(), (a.cwiseMax(b) - high).norm()) <= kSameBox * (high - low).norm();
    };
    const Error why{"in-the-plane", "It lies in the middle of the mirror plane, so that its mirror image would lie in itself."};
    std::erase_if(asked_.whole.characters, [&](PartId id) {
        const CharacterSource& character = *from_.characters.at(id);
        if (!centred(character.body->mesh.vertices)) return false;
        leaveOut(character.name, why);
        for (const PartId element : from_.elementsOf(id)) asked_.whole.elements.erase(element);
        return true;
    });
    std::erase_if(asked_.whole.elements, [&](PartId id) {
        const Element& element = *from_.elements.at(id);
        if (element.piece || !centred(element.mesh->body.vertices)) return false;
        leaveOut(element.name, why);
        return true;
    });
}

std::map<PartId, MirroredCut> Mirror::imagesThere(const CharacterSource& character) const {
    struct Pair {
        double apart;
        PartId cut, image;
        bool flipped;
    };
    std::vector<Pair> pairs;
    const double diagonal = diagonalOf(character.body->mesh.vertices);
    for (const Cut& cut : character.cuts) {
        const CutPlane plane = copier_.placing().plane(cut.plane);
        const Vec3 normal = plane.normal.stableNormalized();
        for (const Cut& other : character.cuts) {
            const Vec3 n = other.plane.normal.stableNormalized(), between = plane.origin - other.plane.origin;
            if (std::abs(n.dot(normal)) < kSameLean || std::abs(between.dot(n)) > kSameAlong * diagonal || between.norm() > kSameAcross * diagonal) continue;
            pairs.push_back({between.norm(), cut.id, other.id, n.dot(normal) < 0.0});
        }
    }
    // Of limbs beside each other the nearest one takes it, and each is the image of one.
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.apart < b.apart; });
    std::map<PartId, MirroredCut> images;
    std::set<PartId> taken;
    for (const Pair& pair : pairs)
        if (!images.contains(pair.cut) && taken.insert(pair.image).second) images.emplace(pair.cut, MirroredCut{pair.image, pair.flipped});
    return images;
}

Result<void> Mirror::mirrorCuts(const Progress& progress) {
    std::set<PartId> named = asked_.cuts;
    for (const PartId piece : asked_.pieces)
        for (const CutSide& side : from_.elements.at(piece)->piece->sides) asked_.cuts.insert(side.cut);
    for (const auto& [id, source] : from_.characters) {
        const auto images = imagesThere(*source);
        for (const Cut& cut : source->cuts) {
            const CutPlane plane = copier_.placing().plane(cut.plane);
            if (const auto there = images.find(cut.id); there != images.end()) {
                const PartId image = there->second.cut;
                cuts_.emplace(cut.id, there->second);
                if (named.contains(cut.id)) leaveOut(cut.name, image == cut.id ? ownImage() : thereAlready("cut", source->cuts[static_cast<std::size_t>(source->cutIndex(image))].name));
                continue;
            }
            if (!asked_.cuts.contains(cut.id)) continue;
            // The piece with a side in its name is the limb: its mirror image is the one that gets a new name.
            std::array<std::string, 2> beside;
            for (const PartId element : from_.elementsOf(id))
                if (const int side = from_.elements.at(element)->piece->sideIndex(cut.id); side >= 0)
                    beside[from_.elements.at(element)->piece->sides[static_cast<std::size_t>(side)].front ? 1 : 0] = from_.elements.at(element)->name;
            const bool turned = copier_.nameFor(beside[1]) == beside[1] && copier_.nameFor(beside[0]) != beside[0];
            const std::string wish = copier_.nameFor(beside[turned ? 0 : 1]);
            Cut made;
            made.name = freeName(document_, copier_.nameFor(cut.name));
            made.plane = plane;
            if (turned) made.plane.normal = -made.plane.normal;
            const std::string called = made.name;
            std::string front = freeName(document_, wish);
            if (front == called) front = freeName(document_, wish + " 2");
            const auto done = addCut(document_, id, 0, std::move(made), {"", front}, progress);
            if (!done && done.error().code == kCancelled) return tl::unexpected(done.error());
            if (!done) {
                leaveOut(cut.name, done.error());
                continue;
            }
            copier_.cuts.emplace_back(called, cut.name);
            cuts_.emplace(cut.id, MirroredCut{done->cut, turned});
        }
    }
    return {};
}

/// Pieces of a character are each other's mirror images where the cuts beside them are.
void Mirror::matchPieces() {
    using Sides = std::vector<std::pair<PartId, bool>>;
    std::map<std::pair<PartId, Sides>, PartId> now;
    for (const auto& [id, element] : document_.elements) {
        if (!element->piece) continue;
        Sides sides;
        for (const CutSide& side : element->piece->sides) sides.emplace_back(side.cut, side.front);
        now.emplace(std::pair(element->piece->character, sides), id);
    }
    for (const auto& [id, element] : from_.elements) {
        if (!element->piece || copier_.has(id)) continue;
        Sides sides;
        for (const CutSide& side : element->piece->sides)
            if (const auto cut = cuts_.find(side.cut); cut != cuts_.end()) sides.emplace_back(cut->second.cut, side.front != cut->second.turned);
        std::sort(sides.begin(), sides.end());
        const auto found = now.find({element->piece->character, sides});
        if (sides.size() != element->piece->sides.size() || found == now.end()) {
            if (asked_.pieces.contains(id)) leaveOut(element->name, {"no-image", "Not all of the cuts beside it have a mirror image."});
            continue;
        }
        const PartId image = found->second;
        copier_.match(id, image);
        for (const CutSide& side : element->piece->sides) {
            const MirroredCut& cut = cuts_.at(side.cut);
            const Element& there = *document_.elements.at(image);
            const std::string& face = there.piece->sides[static_cast<std::size_t>(there.piece->sideIndex(cut.cut))].face;
            if (!side.face.empty() && !face.empty()) copier_.match(FaceRef{id, side.face}, FaceRef{image, face});
        }
        if (!asked_.pieces.contains(id)) continue;
        if (image == id) {
            leaveOut(element->name, ownImage());
            continue;
        }
        copier_.elements.emplace_back(document_.elements.at(image)->name, element->name);
        exchangePart(document_.elements, image, [&element = *element](Element& changed) {
            changed.nu = element.nu;
            changed.stiffness = element.stiffness;
            changed.density = element.density;
            changed.damping = element.damping;
            changed.solverMesh = element.solverMesh;
            changed.jointPlanes = element.jointPlanes;
        });
        for (std::size_t k = 0; k < kEffects; ++k) {
            Effect& effect = document_.effects[static_cast<EffectKind>(k)];
            if (effect.elements.contains(id)) effect.elements.insert(image);
        }
    }
}

void Mirror::mirrorFace(const Element& was, const JointFace& face, PartId target) {
    const Handle* handle = was.handleOf(face.name);
    const Element& there = *document_.elements.at(target);
    const std::string wish = copier_.nameFor(face.name);
    JointFace made;
    Handle disc;
    if (handle) {
        disc = *handle;
        disc.point = copier_.placing().point(handle->point);
        auto found = handleFace(there, disc.point, disc.radius);
        if (!found) return leaveOut(face.name, found.error());
        made = std::move(*found);
        disc.point = nearestOnSurface(there.mesh->body, disc.point).point;
        disc.bone.reset();
        if (const auto& bone = handle->bone; bone && (asked_.whole.bones.contains(bone->bone) || copier_.has(bone->bone))) disc.bone = EndpointRef{copier_.idOf(bone->bone), bone->atEnd};
        made.name = freeName(document_, wish);
        for (int n = 2; there.faceIndex(made.name) >= 0; ++n) made.name = freeName(document_, wish + " " + std::to_string(n));
        disc.face = made.name;
    } else {
        auto found = refoundFace(copier_.placing().mesh(was.mesh->body), copier_.placing().face(face), there.mesh->body);
        if (!found) return leaveOut(was.name + "/" + face.name, found.error());
        made = std::move(*found);
        if (const int other = overlappingFace(there.faces, made); other >= 0)
            return leaveOut(was.name + "/" + face.name, {"shared-rim", "Its mirror image would touch the joint face \"" + there.name + "/" + there.faces[static_cast<std::size_t>(other)].name + "\"."});
        made.name = wish;
        for (int n = 2; there.faceIndex(made.name) >= 0; ++n) made.name = wish + " " + std::to_string(n);
    }
    copier_.match(FaceRef{was.id, face.name}, FaceRef{target, made.name});
    if (handle)
        copier_.handles.emplace_back(made.name, face.name);
    else
        faces_.push_back({{"name", there.name + "/" + made.name}, {"from", was.name + "/" + face.name}});
    exchangePart(document_.elements, target, [&](Element& changed) {
        changed.faces.push_back(std::move(made));
        if (handle) changed.handles.push_back(std::move(disc));
    });
}

void Mirror::mirrorFaces() {
    for (const PartId piece : asked_.pieces) {
        const Element& element = *from_.elements.at(piece);
        for (const JointFace& face : element.faces)
            if (std::none_of(element.piece->sides.begin(), element.piece->sides.end(), [&](const CutSide& side) { return side.face == face.name; })) asked_.faces.insert({piece, face.name});
    }
    for (const FaceRef& ref : asked_.faces) {
        const Element& was = *from_.elements.at(ref.element);
        if (copier_.faceOf(ref)) continue;
        if (was.piece && !copier_.has(was.id)) {
            leaveOut(ref.face, {"no-image", "The element \"" + was.name + "\" has no mirror image."});
            continue;
        }
        mirrorFace(was, was.faces[static_cast<std::size_t>(was.faceIndex(ref.face))], was.piece ? copier_.idOf(was.id) : was.id);
    }
}

/// Bones that lie in the mirror plane, and those whose mirror image is a bone already.
void Mirror::leaveOutBones() {
    std::erase_if(asked_.whole.bones, [&](PartId id) {
        const Bone& bone = *from_.bones.at(id);
        const auto start = restPosition(from_, bone.start), end = restPosition(from_, bone.end);
        if (!start || !end) return false;
        const double near = kSamePlace * (*end - *start).norm();
        const Vec3 a = copier_.placing().point(*start), b = copier_.placing().point(*end);
        for (const auto& [other, there] : from_.bones) {
            const auto p = restPosition(from_, there->start), q = restPosition(from_, there->end);
            if (!p || !q || (*p - a).norm() > near || (*q - b).norm() > near) continue;
            leaveOut(bone.name, other == id ? ownImage() : thereAlready("bone", there->name));
            copier_.match(id, other);
            return true;
        }
        return false;
    });
}

/// Mirror images that meet what is there become one with it.
void Mirror::joinMeeting() {
    std::vector<FaceRef> made, others;
    std::set<PartId> copies;
    for (const PartId id : asked_.whole.elements) copies.insert(copier_.idOf(id));
    for (const auto& [id, element] : document_.elements)
        for (const JointFace& face : element->faces)
            if (!element->handleOf(face.name) && !document_.jointOf({id, face.name})) (copies.contains(id) ? made : others).push_back({id, face.name});
    for (const FaceRef& a : made)
        for (const FaceRef& b : others) {
            const JointFace &x = faceOf(document_, a), &y = faceOf(document_, b);
            const double size = std::max(x.size, y.size);
            if (document_.jointOf(b) || (x.frame.origin - y.frame.origin).norm() > kLargestGap * size || x.frame.axes.col(2).dot(y.frame.axes.col(2)) > kFacing ||
                faceGap(document_, a, b).share > kLargestGap)
                continue;
            if (!joinFaces(document_, a, b)) continue;
            joined_.push_back(Json::array({faceText(document_, a), faceText(document_, b)}));
            break;
        }
}

Result<Json> Mirror::run(const Progress& progress) {
    leaveOutCentred();
    asked_.whole.addBones(from_);
    for (const auto& [id, bone] : from_.bones)
        if (asked_.pieces.contains(bone->element)) asked_.whole.bones.insert(id);
    leaveOutBones();
    std::erase_if(asked_.pieces, [&](PartId id) { return asked_.whole.elements.contains(id); });
    std::erase_if(asked_.faces, [&](const FaceRef& face) { return asked_.whole.elements.contains(face.element); });
    for (const PartId id : asked_.whole.characters)
        for (const Cut& cut : from_.characters.at(id)->cuts) asked_.cuts.erase(cut.id);
    if (auto ok = checkPlaces(from_, asked_.whole, copier_.placing(), "at"); !ok) return tl::unexpected(ok.error());
    copier_.copyCharacters(asked_.whole.characters, asked_.whole.elements);
    copier_.copyElements(asked_.whole.elements, asked_.whole.bones);
    copier_.copyJoints();
    if (auto ok = mirrorCuts(progress); !ok) return tl::unexpected(ok.error());
    matchPieces();
    mirrorFaces();
    copier_.copyBones(asked_.whole.bones);
    findElements(document_, from_, copier_);
    joinMeeting();
    for (const std::string& end : copier_.loose) leaveOut(end, {"hangs-on-nothing", "What it hangs on was not mirrored, and nothing is where the mirror image of that would be: it is a point of its own."});

    Json answer = copiesJson(copier_);
    answer["faces"] = faces_;
    answer["joined"] = joined_;
    answer["not_mirrored"] = left_;
    bool any = false;
    for (const char* key : {"elements", "characters", "cuts", "handles", "bones", "faces"}) any = any || !answer[key].empty();
    if (!any && left_.empty()) return fail("nothing-to-mirror", "There is nothing to mirror: name elements, characters, bones, cuts, handles or joint faces.");
    if (!any) return fail("nothing-to-mirror", "\"" + left_[0]["name"].get<std::string>() + "\" cannot be mirrored: " + left_[0]["why"].get<std::string>());
    return answer;
}

Result<void> resolve(const Document& document, const std::string& name, Asked& asked) {
    if (const CharacterSource* character = document.characterNamed(name)) {
        asked.whole.addCharacter(document, character->id);
    } else if (const Element* element = document.elementNamed(name)) {
        if (element->piece)
            asked.pieces.insert(element->id);
        else
            asked.whole.elements.insert(element->id);
    } else if (const Bone* bone = document.boneNamed(name)) {
        asked.whole.bones.insert(bone->id);
    } else if (const CharacterSource* of = document.characterOfCut(name)) {
        asked.cuts.insert(of->cuts[static_cast<std::size_t>(of->cutIndex(name))].id);
    } else if (const auto handle = document.handle(name)) {
        asked.faces.insert(*handle);
    } else if (name.find('/') != std::string::npos) {
        IMOMUSHI_TRY(const auto face, document.face(name));
        asked.faces.insert(face);
    } else {
        return fail("no-such-target", "There is no element, character, bone, cut or handle \"" + name + "\"; joint faces are named \"element/face\".");
    }
    return {};
}

/// Where the mirror plane lies unless somebody says: in the middle of the body whose parts are mirrored on it, else through the origin.
double middleOf(const Document& document, const Asked& asked, int axis) {
    constexpr double kCentred = 0.01;  // of the diagonal: the plane through the origin is the middle
    if (!asked.whole.elements.empty()) return 0.0;
    std::set<const TriangleMesh*> bodies;
    const auto addElement = [&](PartId id) {
        const Element& element = *document.elements.at(id);
        bodies.insert(element.piece ? &document.characters.at(element.piece->character)->body->mesh : &element.mesh->body);
    };
    for (const PartId piece : asked.pieces) addElement(piece);
    for (const FaceRef& face : asked.faces) addElement(face.element);
    for (const PartId bone : asked.whole.bones)
        if (const PartId element = document.bones.at(bone)->element; element != 0) addElement(element);
    for (const auto& [id, character] : document.characters)
        for (const Cut& cut : character->cuts)
            if (asked.cuts.contains(cut.id)) bodies.insert(&character->body->mesh);
    if (bodies.size() != 1) return 0.0;
    const Points& v = (*bodies.begin())->vertices;
    const double middle = 0.5 * (v.col(axis).minCoeff() + v.col(axis).maxCoeff());
    return std::abs(middle) <= kCentred * diagonalOf(v) ? 0.0 : middle;
}

Result<Json> mirror(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    const Document from = edit.document;  // shares all parts
    Asked asked;
    for (const Json& name : arguments.at("from")) {
        if (!name.is_string()) return fail("bad-type", "\"from\" must be names.");
        if (auto ok = resolve(from, name.get_ref<const std::string&>(), asked); !ok) return tl::unexpected(ok.error());
    }
    int axis = 0;
    if (const Json* given = find(arguments, "axis")) {
        const std::string& name = given->get_ref<const std::string&>();
        if (name != "x" && name != "y" && name != "z") return fail("bad-value", "\"axis\" must be \"x\", \"y\" or \"z\".");
        axis = name[0] - 'x';
    }
    double at = middleOf(from, asked, axis);
    if (auto ok = readNumber(arguments, "at", -kMaxCoordinate, kMaxCoordinate, at); !ok) return tl::unexpected(ok.error());
    PartCopier::Options options;
    options.placing = Placing::mirror(axis, at);
    options.name = [](const std::string& name) { return otherSide(name); };
    if (const Json* given = find(arguments, "suffixes")) {
        if (given->size() != 2 || !(*given)[0].is_string() || !(*given)[1].is_string() || (*given)[0] == (*given)[1] || (*given)[0] == "" || (*given)[1] == "")
            return fail("bad-type", "\"suffixes\" must be two different texts, such as [\".L\", \".R\"].");
        for (const Json& suffix : *given)
            if (auto ok = checkNameText(suffix.get_ref<const std::string&>()); !ok) return tl::unexpected(ok.error());
        options.name = [suffixes = std::pair((*given)[0].get<std::string>(), (*given)[1].get<std::string>())](const std::string& name) { return otherSide(name, suffixes); };
    }
    options.response = lastResponses(edit);
    options.within = true;
    auto answer = Mirror(edit, from, std::move(asked), std::move(options)).run(progress);
    if (answer) (*answer)["at"] = at;
    return answer;
}

}  // namespace

void addMirrorCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("mirror",
                       "Makes mirror images. Elements and characters are copied with their joint faces, handles, cuts, bones, pins, effects and results, which are reflected instead of solved "
                       "again; where their faces meet others they are joined. Pieces, cuts and joint faces of a character, and handles, are mirrored on the same body. Names change sides "
                       "(.L and .R, _l and _r, Left and Right, 左 and 右), others get a number. What could not be mirrored is told with the reason.",
                       {{"from", Type::Array, true, "Names of elements, characters, bones, cuts and handles, joint faces as \"element/face\"."},
                        {"axis", Type::Text, false, "\"x\", \"y\" or \"z\": across this axis lies the mirror plane (\"x\")."},
                        {"at", Type::Number, false, "Where on the axis, metres (0; of parts of one body its middle)."},
                        {"suffixes", Type::Array, false, "Two endings of names that are exchanged, instead of the usual ones: [\".L\", \".R\"]."}},
                       mirror);
}

}  // namespace imomushi
