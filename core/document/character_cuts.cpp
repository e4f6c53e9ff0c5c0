// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/character_cuts.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/union_find.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/document/face_references.h"
#include "core/document/names.h"
#include "core/mesh/connectivity.h"
#include "core/mesh/winding_number.h"

namespace imomushi {

namespace {

using Sides = std::vector<std::pair<PartId, bool>>;  // cut and whether in front, ascending

Sides sidesOf(const CharacterPiece& piece) {
    Sides sides;
    for (const CutSide& side : piece.sides) sides.emplace_back(side.cut, side.front);
    return sides;
}

Sides sidesOf(const BodyPiece& piece, const std::vector<Cut>& cuts) {
    Sides sides;
    for (const auto& cap : piece.caps) sides.emplace_back(cuts[static_cast<std::size_t>(cap.cut)].id, cap.front);
    std::sort(sides.begin(), sides.end());
    return sides;
}

const BodyPiece* pieceWith(const std::vector<BodyPiece>& pieces, const std::vector<Cut>& cuts, const Sides& sides) {
    const auto found = std::find_if(pieces.begin(), pieces.end(), [&](const BodyPiece& piece) { return sidesOf(piece, cuts) == sides; });
    return found == pieces.end() ? nullptr : &*found;
}

const BodyPiece::Cap& capOf(const BodyPiece& piece, const std::vector<Cut>& cuts, PartId cut) {
    return *std::find_if(piece.caps.begin(), piece.caps.end(), [&](const auto& cap) { return cuts[static_cast<std::size_t>(cap.cut)].id == cut; });
}

std::string quoted(const std::string& name) { return "\"" + name + "\""; }

using Pieces = std::vector<BodyPiece>;

/// Without the names of cuts.
tl::expected<Pieces, CutRefusal> cutUp(const CharacterSource& character, const Progress& progress) {
    std::vector<CutPlane> planes;
    for (const Cut& cut : character.cuts) planes.push_back(cut.plane);
    return cutBody(character.body->mesh, planes, progress);
}

/// `asked`: the cut that a command is about; a refusal that is another one's fault says whose.
Error named(const CutRefusal& why, const CharacterSource& character, PartId asked) {
    const auto named = [&](int cut) { return quoted(character.cuts[static_cast<std::size_t>(cut)].name); };
    std::string message = why.message;
    if (why.cut >= 0 && character.cuts[static_cast<std::size_t>(why.cut)].id != asked) message = "At the cut " + named(why.cut) + ": " + message;
    if (const int other = why.other; other >= 0 && character.cuts[static_cast<std::size_t>(other)].id != asked) message += " The other cut is " + named(other) + ".";
    return {why.code, std::move(message)};
}

Result<Pieces> piecesOf(const CharacterSource& character, PartId asked, const Progress& progress) {
    auto pieces = cutUp(character, progress);
    if (!pieces) return tl::unexpected(named(pieces.error(), character, asked));
    return std::move(*pieces);
}

// ---- joint faces --------------------------------------------------------------------------------------------------------

/// A joint face of an element as it was.
struct OldFace {
    PartId element = 0;
    const TriangleMesh* body = nullptr;
    const JointFace* face = nullptr;
    PartId cut = 0;  ///< whose side it is, 0: none
};

std::vector<OldFace> facesOf(const Element& element) {
    std::vector<OldFace> faces;
    for (const JointFace& face : element.faces) {
        OldFace old{element.id, &element.mesh->body, &face, 0};
        for (const CutSide& side : element.piece->sides)
            if (side.face == face.name) old.cut = side.cut;
        faces.push_back(old);
    }
    return faces;
}

/// Corners of a triangle, the lowest place first, so that the same triangle of another body compares equal.
using Place = std::array<double, 9>;
Place placeOf(const TriangleMesh& body, std::int32_t triangle) {
    std::array<std::array<double, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
        for (int x = 0; x < 3; ++x) corners[k][static_cast<std::size_t>(x)] = body.vertices(body.triangles(triangle, static_cast<int>(k)), x);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    Place place;
    for (std::size_t i = 0; i < 9; ++i) place[i] = corners[i / 3][i % 3];
    return place;
}

/// The faces on another body, bit for bit at the same places; none: not all of their triangles are there.
std::vector<std::optional<JointFace>> carriedTo(const TriangleMesh& body, const std::vector<OldFace>& faces) {
    std::map<Place, std::vector<std::size_t>> wanted;  // by place, the faces that have a triangle there
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const std::int32_t t : faces[f].face->triangles) wanted[placeOf(*faces[f].body, t)].push_back(f);
    std::vector<std::vector<std::int32_t>> triangles(faces.size());
    if (!wanted.empty())
        for (std::int32_t t = 0; t < body.triangles.rows(); ++t)
            if (const auto found = wanted.find(placeOf(body, t)); found != wanted.end())
                for (const std::size_t f : found->second) triangles[f].push_back(t);
    std::vector<std::optional<JointFace>> carried(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (triangles[f].size() != faces[f].face->triangles.size()) continue;
        JointFace face = *faces[f].face;  // frame and size stay as they are, bit for bit
        face.triangles = std::move(triangles[f]);
        face.vertices.clear();
        for (const std::int32_t t : face.triangles)
            for (int k = 0; k < 3; ++k) face.vertices.push_back(body.triangles(t, k));
        std::sort(face.vertices.begin(), face.vertices.end());
        face.vertices.erase(std::unique(face.vertices.begin(), face.vertices.end()), face.vertices.end());
        carried[f] = std::move(face);
    }
    return carried;
}

/// The faces that a piece takes over from elements; those of cuts that lie elsewhere now are its caps. `lost`: of any other that is not there.
template <class Lost>
Result<std::vector<JointFace>> facesOn(const BodyPiece& piece, const std::vector<Cut>& cuts, const std::vector<OldFace>& faces, Lost&& lost) {
    auto carried = carriedTo(piece.body, faces);
    std::vector<JointFace> out;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (!carried[f]) {
            IMOMUSHI_TRY(auto found, faces[f].cut != 0 ? jointFaceByTriangles(piece.body, capOf(piece, cuts, faces[f].cut).triangles) : lost(faces[f]));
            found.takeNameFrom(*faces[f].face);
            carried[f] = std::move(found);
        }
        out.push_back(std::move(*carried[f]));
    }
    return out;
}

Result<std::vector<JointFace>> facesOn(const Document& document, const BodyPiece& piece, const std::vector<Cut>& cuts, const std::vector<OldFace>& faces) {
    return facesOn(piece, cuts, faces, [&](const OldFace& face) -> Result<JointFace> {
        return fail("face-cut", "The cut would go through the joint face \"" + document.elements.at(face.element)->name + "/" + face.face->name +
                                    "\": move the plane away from it, or remove the face first.");
    });
}

/// Faces that share a vertex cannot be moved one by one.
Result<void> checkApart(const Element& element) {
    for (std::size_t i = 0; i < element.faces.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            std::vector<std::int32_t> shared;
            std::set_intersection(element.faces[i].vertices.begin(), element.faces[i].vertices.end(), element.faces[k].vertices.begin(), element.faces[k].vertices.end(),
                                  std::back_inserter(shared));
            if (!shared.empty())
                return fail("face-cut", "The cut would touch the joint face \"" + element.name + "/" + element.faces[k].name +
                                            "\": leave one ring of free triangles between them, or remove the face first.");
        }
    std::size_t held = 0;
    for (const JointFace& face : element.faces) held += face.vertices.size();
    if (held == static_cast<std::size_t>(element.mesh->body.vertices.rows()))
        return fail("no-free-vertex", "The joint faces of \"" + element.name + "\" would hold every one of its vertices: leave some of its surface free.");
    return {};
}

std::string freeFaceName(const Element& element, const std::string& wish) {
    std::string name = wish;
    for (int n = 2; element.faceIndex(name) >= 0; ++n) name = wish + " " + std::to_string(n);
    return name;
}

// ---- elements -----------------------------------------------------------------------------------------------------------

std::shared_ptr<const ElementMesh> meshOf(TriangleMesh body) {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->renderMesh.bodyVertex.resize(static_cast<std::size_t>(body.vertices.rows()));
    std::iota(mesh->renderMesh.bodyVertex.begin(), mesh->renderMesh.bodyVertex.end(), 0);
    mesh->renderMesh.triangles = body.triangles;
    mesh->body = std::move(body);
    return mesh;
}

/// Gives an element the body of a piece. Sides keep the names of their faces; those that are new have none.
void takePiece(Element& element, const BodyPiece& piece, const std::vector<Cut>& cuts) {
    element.mesh = meshOf(piece.body);
    element.issues.clear();
    const std::vector<CutSide> was = element.piece->sides;
    element.piece->sides.clear();
    for (const auto& [cut, front] : sidesOf(piece, cuts)) {
        const auto known = std::find_if(was.begin(), was.end(), [&, id = cut](const CutSide& side) { return side.cut == id; });
        element.piece->sides.push_back({cut, front, known == was.end() ? std::string() : known->face});
    }
    element.piece->origin = std::make_shared<const PieceOrigin>(PieceOrigin{piece.source, piece.sourceTriangle});
}

/// Whether a piece is what the element is already.
bool same(const Element& element, const BodyPiece& piece) {
    const TriangleMesh& body = element.mesh->body;
    return body.triangles.rows() == piece.body.triangles.rows() && body.vertices.rows() == piece.body.vertices.rows() && body.triangles == piece.body.triangles &&
           body.vertices == piece.body.vertices;
}

/// Handles are the faces of theirs that the element has now. `from`: the elements that they were of.
void takeHandles(Element& element, std::initializer_list<const Element*> from, const std::vector<std::pair<std::string, std::string>>& renamed = {}) {
    std::vector<Handle> handles;
    for (const Element* of : from)
        for (Handle handle : of->handles) {
            if (of->id != element.id)
                for (const auto& [was, is] : renamed)
                    if (handle.face == was) {
                        handle.face = is;
                        break;
                    }
            handles.push_back(std::move(handle));
        }
    element.handles.clear();
    for (const JointFace& face : element.faces)
        for (const Handle& handle : handles)
            if (handle.face == face.name) element.handles.push_back(handle);
}

void put(Document& document, Element element) {
    const PartId id = element.id;
    std::erase_if(document.touches, [&](const Touch& touch) { return touch.element == id; });
    document.elements.insert_or_assign(id, std::make_shared<const Element>(std::move(element)));
}

/// Whether an end of a bone lies in a piece.
bool liesIn(const Document& document, Bone::Place place, const Element& element) {
    for (std::size_t hops = 0; hops <= 2 * document.bones.size(); ++hops) {
        if (const auto* face = std::get_if<FaceRef>(&place)) return face->element == element.id;
        const auto* end = std::get_if<EndpointRef>(&place);
        if (!end) break;
        const auto bone = document.bones.find(end->bone);
        if (bone == document.bones.end()) return false;
        place = Bone::Place(end->atEnd ? bone->second->end : bone->second->start);
    }
    const auto* point = std::get_if<Vec3>(&place);
    return point && windingNumber(element.mesh->body, *point) > 0.5;
}

}  // namespace

Element wholeElement(const CharacterSource& character) {
    const TriangleMesh& body = character.body->mesh;
    PieceOrigin origin;
    origin.vertices.resize(static_cast<std::size_t>(body.vertices.rows()));
    std::iota(origin.vertices.begin(), origin.vertices.end(), 0);
    origin.triangles.resize(static_cast<std::size_t>(body.triangles.rows()));
    std::iota(origin.triangles.begin(), origin.triangles.end(), 0);
    Element element;
    element.mesh = meshOf(body);
    element.piece = CharacterPiece{character.id, {}, std::make_shared<const PieceOrigin>(std::move(origin))};
    return element;
}

PartId makeCharacter(Document& document, PartId element, const std::string& name) {
    const auto part = document.elements.at(element);
    const auto vertices = part->mesh->body.vertices.rows(), triangles = part->mesh->body.triangles.rows();
    RenderModel model{*part->mesh, std::vector<std::int32_t>(static_cast<std::size_t>(triangles), 0), {part->name}};
    Body body;
    body.mesh = part->mesh->body;
    body.bodyVertex.resize(static_cast<std::size_t>(vertices));
    std::iota(body.bodyVertex.begin(), body.bodyVertex.end(), 0);
    body.report.volumeError = 0.0;
    body.report.components = part->mesh->connectivity().facts().components;
    CharacterSource character;
    character.id = document.nextId++;
    character.name = name;
    character.issues = part->issues;
    character.model = std::make_shared<const RenderModel>(std::move(model));
    character.body = std::make_shared<const Body>(std::move(body));
    const PartId id = character.id;
    exchangePart(document.elements, element, [&](Element& e) { e.piece = wholeElement(character).piece; });
    document.characters.emplace(id, std::make_shared<const CharacterSource>(std::move(character)));
    return id;
}

namespace {

/// What new cuts make of an element that there is.
struct Division {
    std::shared_ptr<const Element> whole;
    std::vector<std::size_t> pieces;  ///< the one that goes on as the element first
};

/// Those that new cuts divide, each with more than one piece. Errors: "cut-passes".
Result<std::vector<Division>> divisions(const Document& document, const CharacterSource& character, const Pieces& pieces, PartId firstNew) {
    UnionFind connected(pieces.size());
    std::map<PartId, std::size_t> beside;  // of a new cut, the first piece seen
    std::vector<char> inFront(pieces.size(), 0);
    for (std::size_t p = 0; p < pieces.size(); ++p)
        for (const auto& [cut, front] : sidesOf(pieces[p], character.cuts)) {
            if (cut < firstNew) continue;
            if (front) inFront[p] = 1;
            if (const auto [other, isNew] = beside.emplace(cut, p); !isNew) connected.unite(static_cast<std::int32_t>(p), static_cast<std::int32_t>(other->second));
        }
    std::map<std::int32_t, Division> byFirst;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        auto& of = byFirst[connected.find(static_cast<std::int32_t>(p))].pieces;
        of.push_back(p);
        if (inFront[p] == 0) std::swap(of.front(), of.back());
    }
    std::vector<Division> found;
    for (auto& [first, division] : byFirst) {
        if (division.pieces.size() == 1) continue;
        Sides before;
        for (const std::size_t p : division.pieces)
            for (const auto& side : sidesOf(pieces[p], character.cuts))
                if (side.first < firstNew) before.push_back(side);
        std::sort(before.begin(), before.end());
        for (const PartId id : document.elementsOf(character.id))
            if (sidesOf(*document.elements.at(id)->piece) == before) division.whole = document.elements.at(id);
        if (!division.whole) return fail("cut-passes", "The cut would change on which side of each other the other cuts lie: put it between them.");
        // Parts of a body that touch nowhere fall apart where each is cut.
        const auto same = std::find_if(found.begin(), found.end(), [&](const Division& other) { return other.whole == division.whole; });
        if (same == found.end())
            found.push_back(std::move(division));
        else
            same->pieces.insert(same->pieces.end(), division.pieces.begin(), division.pieces.end());
    }
    return found;
}

/// The last cut of a piece of which all vertices lie on cuts, so that joint faces would hold it whole; -1: there is none.
int cutWithoutFlesh(const Pieces& pieces) {
    for (const BodyPiece& piece : pieces) {
        std::size_t held = 0;  // cuts share no vertices
        for (const BodyPiece::Cap& cap : piece.caps) held += cap.vertices.size();
        if (!piece.caps.empty() && held == piece.source.size()) return piece.caps.back().cut;
    }
    return -1;
}

/// A cut that gets a name of its own where it has none.
void nameCut(const Document& document, Cut& cut, const Element& behind, const Element& front, bool named) {
    for (int n = 1; cut.name.empty() || cut.name == behind.name || cut.name == front.name; ++n)
        cut.name = named ? freeName(document, front.name + " cut" + (n > 1 ? " " + std::to_string(n) : std::string())) : numberedName(document, "cut", n);
}

}  // namespace

Result<MadeCuts> addCuts(Document& document, PartId characterId, PartId elementId, std::vector<NewCut> wanted, bool leaveOut, const Progress& progress) {
    CharacterSource character = *document.characters.at(characterId);
    const PartId firstNew = document.nextId;
    const std::size_t before = character.cuts.size();
    MadeCuts out;
    out.made.resize(wanted.size());
    std::vector<std::size_t> which;  // of the cuts that are new, into `wanted`
    for (std::size_t c = 0; c < wanted.size(); ++c) {
        wanted[c].cut.id = document.nextId++;
        character.cuts.push_back(wanted[c].cut);
        which.push_back(c);
    }
    Pieces pieces;
    while (true) {
        auto cut = cutUp(character, progress);
        if (cut && leaveOut) {
            if (const int fault = cutWithoutFlesh(*cut); fault >= static_cast<int>(before)) {
                CutRefusal none;
                none.code = "no-free-vertex";
                none.message = "Between the cut and another no vertex of the surface would be free; move one of them away.";
                none.cut = fault;
                cut = tl::make_unexpected(std::move(none));
            }
        }
        if (cut) {
            pieces = std::move(*cut);
            break;
        }
        const int fault = std::max(cut.error().cut, cut.error().other);
        Error why = named(cut.error(), character, leaveOut && fault >= 0 ? character.cuts[static_cast<std::size_t>(fault)].id : wanted.front().cut.id);
        if (!leaveOut || cut.error().code == kCancelled || fault < static_cast<int>(before)) return tl::unexpected(std::move(why));
        const std::size_t at = static_cast<std::size_t>(fault) - before;
        out.refused.push_back({which[at], std::move(why)});
        which.erase(which.begin() + static_cast<std::ptrdiff_t>(at));
        character.cuts.erase(character.cuts.begin() + fault);
        if (which.empty()) return tl::unexpected(out.refused.back().why);
    }
    IMOMUSHI_TRY(const auto divided, divisions(document, character, pieces, firstNew));
    std::map<PartId, std::size_t> wantedOf;
    for (const std::size_t c : which) wantedOf.emplace(wanted[c].cut.id, c);

    // All that may fail comes first: a document is not changed by halves.
    struct Divided {
        PartId whole;
        std::vector<Element> parts;
        std::vector<std::vector<OldFace>> gets;  // per part
    };
    std::vector<Divided> all;
    std::vector<Joint> joints;
    for (const Division& division : divided) {
        const std::shared_ptr<const Element>& whole = division.whole;
        if (elementId != 0 && whole->id != elementId)
            return fail("other-element", "The section nearest to the origin of the plane belongs to the element " + quoted(whole->name) + ": put the origin into the section that is meant.");
        std::vector<Element> parts;
        std::vector<PartId> new_;  // of the new cuts here
        for (std::size_t i = 0; i < division.pieces.size(); ++i) {
            Element part = *whole;
            part.name.clear();
            if (i > 0) part.id = document.nextId++;
            for (const auto& [cut, front] : sidesOf(pieces[division.pieces[i]], character.cuts)) {
                const auto found = wantedOf.find(cut);
                if (found == wantedOf.end()) continue;
                if (std::find(new_.begin(), new_.end(), cut) == new_.end()) new_.push_back(cut);
                const std::string& name = wanted[found->second].names[front ? 1 : 0];
                if (part.name.empty() && (front || i == 0) && !name.empty()) part.name = name;
            }
            if (part.name.empty()) part.name = i == 0 ? whole->name : numberedName(document, whole->name);
            // A name that is taken only once the element is in the document.
            for (int n = 2; i > 0 && std::any_of(parts.begin(), parts.end(), [&](const Element& other) { return other.name == part.name; }); ++n) part.name = numberedName(document, whole->name, n);
            takePiece(part, pieces[division.pieces[i]], character.cuts);
            parts.push_back(std::move(part));
        }
        std::sort(new_.begin(), new_.end());

        // Each joint face goes with the piece that has all of it.
        const auto old = facesOf(*whole);
        std::vector<std::vector<OldFace>> gets(parts.size());
        std::vector<std::vector<std::optional<JointFace>>> carried;
        for (std::size_t i = 1; i < parts.size(); ++i) carried.push_back(carriedTo(parts[i].mesh->body, old));
        for (std::size_t f = 0; f < old.size(); ++f) {
            std::size_t to = 0;
            for (std::size_t i = 1; i < parts.size(); ++i)
                if (old[f].cut != 0 ? parts[i].piece->sideIndex(old[f].cut) >= 0 : carried[i - 1][f].has_value()) to = i;
            gets[to].push_back(old[f]);
        }
        for (std::size_t i = 0; i < parts.size(); ++i) {
            IMOMUSHI_TRY(parts[i].faces, facesOn(document, pieces[division.pieces[i]], character.cuts, gets[i]));
        }
        for (const PartId id : new_) {
            Cut& cut = character.cuts[static_cast<std::size_t>(character.cutIndex(id))];
            MadeCut& made = out.made[wantedOf.at(id)].emplace();
            made.character = characterId, made.cut = id;
            std::array<std::size_t, 2> sides{};
            for (std::size_t i = 0; i < parts.size(); ++i)
                if (const int side = parts[i].piece->sideIndex(id); side >= 0) sides[parts[i].piece->sides[static_cast<std::size_t>(side)].front ? 1 : 0] = i;
            nameCut(document, cut, parts[sides[0]], parts[sides[1]], !wanted[wantedOf.at(id)].names[1].empty());
            for (const bool isFront : {false, true}) {
                Element& element = parts[sides[isFront ? 1 : 0]];
                const BodyPiece& piece = pieces[division.pieces[sides[isFront ? 1 : 0]]];
                const auto& cap = capOf(piece, character.cuts, id);
                IMOMUSHI_TRY(auto face, jointFaceByTriangles(piece.body, cap.triangles));
                face.name = freeFaceName(element, cut.name);
                made.elements[isFront ? 1 : 0] = element.id;
                made.faces[isFront ? 1 : 0] = face.name;
                made.smallestAngle = isFront ? std::min(made.smallestAngle, cap.smallestAngle) : cap.smallestAngle;
                element.piece->sides[static_cast<std::size_t>(element.piece->sideIndex(id))].face = face.name;
                element.faces.push_back(std::move(face));
            }
            Joint joint;
            joint.id = document.nextId++;
            joint.faces = {{made.elements[0], made.faces[0]}, {made.elements[1], made.faces[1]}};
            joints.push_back(std::move(joint));
        }
        for (Element& part : parts) {
            takeHandles(part, {whole.get()});
            if (auto ok = checkApart(part); !ok) return tl::unexpected(ok.error());
        }
        all.push_back({whole->id, std::move(parts), std::move(gets)});
    }

    for (Divided& division : all) {
        for (std::size_t i = 1; i < division.parts.size(); ++i) {
            const Element& part = division.parts[i];
            for (const OldFace& face : division.gets[i]) replaceFace(document, {division.whole, face.face->name}, {part.id, face.face->name});
            std::vector<PartId> through;
            for (const auto& [id, bone] : document.bones)
                if (bone->element == division.whole && liesIn(document, bone->start, part) && liesIn(document, bone->end, part)) through.push_back(id);
            for (const PartId id : through) exchangePart(document.bones, id, [&](Bone& bone) { bone.element = part.id; });
            for (std::size_t k = 0; k < kEffects; ++k)
                if (auto& on = document.effects[static_cast<EffectKind>(k)].elements; on.contains(division.whole)) on.insert(part.id);
        }
    }
    for (Joint& joint : joints) document.joints.emplace(joint.id, std::make_shared<const Joint>(std::move(joint)));
    for (Divided& division : all)
        for (Element& part : division.parts) put(document, std::move(part));
    document.characters.insert_or_assign(characterId, std::make_shared<const CharacterSource>(std::move(character)));
    return out;
}

Result<MadeCut> addCut(Document& document, PartId character, PartId element, Cut cut, const std::array<std::string, 2>& names, const Progress& progress) {
    IMOMUSHI_TRY(auto made, addCuts(document, character, element, {{std::move(cut), names}}, false, progress));
    return std::move(*made.made.front());
}

Result<std::vector<PartId>> changeBody(Document& document, PartId characterId, std::shared_ptr<const Body> body, const Progress& progress) {
    CharacterSource character = *document.characters.at(characterId);
    character.body = std::move(body);
    IMOMUSHI_TRY(const auto pieces, piecesOf(character, 0, progress));
    std::vector<Element> changed, kept;
    for (const PartId id : document.elementsOf(characterId)) {
        Element element = *document.elements.at(id);
        const BodyPiece* piece = pieceWith(pieces, character.cuts, sidesOf(*element.piece));
        if (!piece) return fail("cut-passes", "The cuts would divide the other body in another way: take out the cuts of \"" + element.name + "\" first.");
        if (same(element, *piece)) {  // places in the whole body may be others
            element.piece->origin = std::make_shared<const PieceOrigin>(PieceOrigin{piece->source, piece->sourceTriangle});
            kept.push_back(std::move(element));
            continue;
        }
        IMOMUSHI_TRY(auto faces, facesOn(*piece, character.cuts, facesOf(element), [&](const OldFace& face) -> Result<JointFace> {
            const auto handle = std::find_if(element.handles.begin(), element.handles.end(), [&](const Handle& h) { return h.face == face.face->name; });
            if (handle == element.handles.end())
                return fail("face-lost", "The joint face \"" + element.name + "/" + face.face->name + "\" lies where the body becomes another: remove the face first, and make it again afterwards.");
            const SurfacePoint place = nearestOnSurface(piece->body, handle->point);
            handle->point = place.point;
            return jointFaceByDisc(piece->body, place.triangle, place.point, handle->radius);
        }));
        Element now = element;
        takePiece(now, *piece, character.cuts);
        now.faces = std::move(faces);
        if (auto ok = checkApart(now); !ok) return tl::unexpected(ok.error());
        changed.push_back(std::move(now));
    }
    document.characters.insert_or_assign(characterId, std::make_shared<const CharacterSource>(std::move(character)));
    for (Element& element : kept) document.elements.insert_or_assign(element.id, std::make_shared<const Element>(std::move(element)));
    std::vector<PartId> ids;
    for (Element& element : changed) {
        ids.push_back(element.id);
        put(document, std::move(element));
    }
    return ids;
}

Result<std::vector<PartId>> moveCut(Document& document, PartId characterId, PartId cut, const CutPlane& plane, const Progress& progress) {
    CharacterSource character = *document.characters.at(characterId);
    CutPlane& moved = character.cuts[static_cast<std::size_t>(character.cutIndex(cut))].plane;
    const bool turned = moved.normal.stableNormalized().dot(plane.normal.stableNormalized()) < 0.0;
    moved = {plane.origin, turned ? Vec3(-plane.normal) : plane.normal};
    IMOMUSHI_TRY(const auto pieces, piecesOf(character, cut, progress));

    std::vector<Element> changed;
    for (const PartId id : document.elementsOf(characterId)) {
        const Element& element = *document.elements.at(id);
        const BodyPiece* piece = pieceWith(pieces, character.cuts, sidesOf(*element.piece));
        if (!piece)
            return fail("cut-passes", "The cut would come to lie on the other side of another cut of " + quoted(element.name) + ": move it less far, or take it out and cut anew.");
        if (element.piece->sideIndex(cut) < 0 || same(element, *piece)) continue;
        Element now = element;
        takePiece(now, *piece, character.cuts);
        IMOMUSHI_TRY(now.faces, facesOn(document, *piece, character.cuts, facesOf(element)));
        if (auto ok = checkApart(now); !ok) return tl::unexpected(ok.error());
        changed.push_back(std::move(now));
    }
    document.characters.insert_or_assign(characterId, std::make_shared<const CharacterSource>(std::move(character)));
    std::vector<PartId> ids;
    for (Element& element : changed) {
        ids.push_back(element.id);
        put(document, std::move(element));
    }
    return ids;
}

Result<PartId> removeCut(Document& document, PartId characterId, PartId cut, const Progress& progress) {
    CharacterSource character = *document.characters.at(characterId);
    std::array<std::shared_ptr<const Element>, 2> sides;
    for (const PartId id : document.elementsOf(characterId)) {
        const auto& element = document.elements.at(id);
        if (const int side = element->piece->sideIndex(cut); side >= 0) sides[element->piece->sides[static_cast<std::size_t>(side)].front ? 1 : 0] = element;
    }
    character.cuts.erase(character.cuts.begin() + character.cutIndex(cut));
    IMOMUSHI_TRY(const auto pieces, piecesOf(character, 0, progress));
    Sides together;
    for (const auto& element : sides)
        for (const auto& side : sidesOf(*element->piece))
            if (side.first != cut) together.push_back(side);
    std::sort(together.begin(), together.end());
    const BodyPiece* piece = pieceWith(pieces, character.cuts, together);
    if (!piece) return fail("cut-passes", "The other cuts would come to lie on other sides of each other: move them apart first.");

    // Faces of the element in front come over, under names that are free there; those of the cut go.
    const PartId behind = sides[0]->id, front = sides[1]->id;
    Element merged = *sides[0];
    std::vector<OldFace> kept;
    for (const OldFace& face : facesOf(*sides[0]))
        if (face.cut != cut) kept.push_back(face);
    std::vector<std::pair<std::string, std::string>> renamed;  // in front, from and to
    std::vector<FaceRef> gone;
    for (const auto& element : sides)
        if (const std::string& face = element->piece->sides[static_cast<std::size_t>(element->piece->sideIndex(cut))].face; !face.empty()) gone.push_back({element->id, face});
    const std::size_t own = kept.size();
    for (const OldFace& face : facesOf(*sides[1]))
        if (face.cut != cut) kept.push_back(face);
    IMOMUSHI_TRY(auto faces, facesOn(document, *piece, character.cuts, kept));
    merged.faces.clear();
    for (std::size_t f = 0; f < faces.size(); ++f) {
        JointFace& face = faces[f];
        if (f >= own) {
            renamed.emplace_back(face.name, freeFaceName(merged, face.name));
            face.name = renamed.back().second;
        }
        merged.faces.push_back(std::move(face));
    }
    for (const CutSide& side : sides[1]->piece->sides) {
        const auto to = std::find_if(renamed.begin(), renamed.end(), [&](const auto& r) { return r.first == side.face; });
        merged.piece->sides.push_back({side.cut, side.front, to == renamed.end() ? std::string() : to->second});
    }
    std::erase_if(merged.piece->sides, [&](const CutSide& side) { return side.cut == cut; });
    takePiece(merged, *piece, character.cuts);
    if (auto ok = checkApart(merged); !ok) return tl::unexpected(ok.error());

    takeHandles(merged, {sides[0].get(), sides[1].get()}, renamed);
    for (const FaceRef& face : gone) leaveJoint(document, face);
    freeBones(document, gone);
    for (const auto& [from, to] : renamed) replaceFace(document, {front, from}, {behind, to});
    // Faces that were joined across the cut are now faces of one element.
    std::vector<FaceRef> alone;
    for (const auto& [id, joint] : document.joints) {
        int count = 0;
        for (const FaceRef& face : joint->faces)
            if (face.element == behind && ++count > 1) alone.push_back(face);
    }
    for (const FaceRef& face : alone) leaveJoint(document, face);
    exchangePart(document.elements, front, [](Element& element) { element.faces.clear(); });
    dropElement(document, front, behind);
    document.characters.insert_or_assign(characterId, std::make_shared<const CharacterSource>(std::move(character)));
    put(document, std::move(merged));
    return behind;
}

}  // namespace imomushi
