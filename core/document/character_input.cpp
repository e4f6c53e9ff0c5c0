// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/character_input.h"

#include <algorithm>
#include <limits>
#include <queue>

#include "core/base/try.h"
#include "core/base/union_find.h"
#include "core/document/embed_model.h"
#include "core/document/limb_hinges.h"
#include "core/document/names.h"
#include "core/joints/seam.h"
#include "core/skeleton/body_follows.h"

namespace imomushi {

namespace {

/// Endpoints closer than this, relative to the size of the skeleton, are one joint point (rounding of coordinates that were typed twice).
constexpr double kSamePoint = 1e-9;
/// An endpoint that was given as coordinates and lies this near to the centroid of a face, relative to the face, sits at the face.
constexpr double kAtFace = 1e-6;
/// Bones of a file meet at its joints, which may lie this many sizes of the section beside its middle: where a cut was moved along the limb to a place that works.
constexpr double kMeeting = 3.0;

const Bone::Place& placeOf(const Bone& bone, bool atEnd) { return atEnd ? bone.end : bone.start; }

const JointFace* faceAt(const Document& document, const FaceRef& ref) {
    const auto element = document.elements.find(ref.element);
    if (element == document.elements.end()) return nullptr;
    const int face = element->second->faceIndex(ref.face);
    return face < 0 ? nullptr : &element->second->faces[static_cast<std::size_t>(face)];
}

/// A handle moves by itself: a bone that was placed at its middle does not move it.
bool isHandle(const Document& document, const FaceRef& ref) {
    const auto element = document.elements.find(ref.element);
    return element != document.elements.end() && element->second->handleOf(ref.face);
}

/// Where neighbours or bones may take hold of an element.
std::size_t jointFaces(const Element& element) { return element.faces.size() - element.handles.size(); }

/// Nodes of the union: two per bone (start, end), then one per joint face.
struct Nodes {
    std::map<PartId, int> bones;   ///< node of a bone's start
    std::map<FaceRef, int> faces;
    int count = 0;

    explicit Nodes(const Document& document) {
        for (const auto& [id, bone] : document.bones) {
            bones.emplace(id, count);
            count += 2;
        }
        for (const auto& [id, element] : document.elements)
            for (const JointFace& face : element->faces) faces.emplace(FaceRef{id, face.name}, count++);
    }
    [[nodiscard]] int endpoint(const EndpointRef& end) const {
        const auto found = bones.find(end.bone);
        return found == bones.end() ? -1 : found->second + (end.atEnd ? 1 : 0);
    }
};

/// Parents of all bones: each tree is walked from its first bone; given parents win where they make a tree.
std::vector<int> parentsOf(const Document& document, const std::vector<PartId>& ids, const std::vector<std::pair<int, int>>& ends,
                           std::vector<int>& order) {
    const int count = static_cast<int>(ids.size());
    std::vector<int> parents(ids.size(), -1);
    std::vector<bool> seen(ids.size(), false);
    const auto touch = [&](int a, int b) {
        const auto& p = ends[static_cast<std::size_t>(a)];
        const auto& q = ends[static_cast<std::size_t>(b)];
        return p.first == q.first || p.first == q.second || p.second == q.first || p.second == q.second;
    };
    const auto given = [&](int b) { return document.bones.at(ids[static_cast<std::size_t>(b)])->parent; };
    const auto walk = [&](std::queue<int> open, bool strict) {
        while (!open.empty()) {
            const int at = open.front();
            open.pop();
            for (int b = 0; b < count; ++b) {
                if (seen[static_cast<std::size_t>(b)] || !touch(at, b)) continue;
                if (strict && given(b) != 0 && given(b) != ids[static_cast<std::size_t>(at)]) continue;
                seen[static_cast<std::size_t>(b)] = true;
                parents[static_cast<std::size_t>(b)] = at;
                order.push_back(b);
                open.push(b);
            }
        }
    };
    for (const bool onlyRoots : {true, false}) {
        for (int b = 0; b < count; ++b) {
            if (seen[static_cast<std::size_t>(b)] || (onlyRoots && given(b) != 0)) continue;
            const std::size_t first = order.size();
            seen[static_cast<std::size_t>(b)] = true;
            order.push_back(b);
            std::queue<int> open;
            open.push(b);
            walk(open, true);
            // Whose given parent is not on the way from the root joins its neighbours like any other.
            std::queue<int> again;
            for (std::size_t i = first; i < order.size(); ++i) again.push(order[i]);
            walk(again, false);
        }
    }
    return parents;
}

}  // namespace

int CharacterPlan::elementIndex(PartId element) const {
    const auto found = std::find(elements.begin(), elements.end(), element);
    return found == elements.end() ? -1 : static_cast<int>(found - elements.begin());
}

int CharacterPlan::boneIndex(PartId bone) const {
    const auto found = std::find(bones.begin(), bones.end(), bone);
    return found == bones.end() ? -1 : static_cast<int>(found - bones.begin());
}

int CharacterPlan::pointIndex(const EndpointRef& end) const {
    const auto found = points.find(end);
    return found == points.end() ? -1 : found->second;
}

int CharacterPlan::handleIndex(const FaceRef& handle) const {
    const auto found = std::find(handles.begin(), handles.end(), handle);
    return found == handles.end() ? -1 : static_cast<int>(found - handles.begin());
}

Result<Vec3> restPosition(const Document& document, const Bone::Place& start) {
    Bone::Place place = start;
    // Each hop leads to another endpoint, so more hops than endpoints is a circle.
    for (std::size_t hops = 0; hops <= 2 * document.bones.size(); ++hops) {
        if (const auto* point = std::get_if<Vec3>(&place)) return *point;
        if (const auto* face = std::get_if<FaceRef>(&place)) {
            const JointFace* found = faceAt(document, *face);
            if (!found) return fail("bad-place", "A bone ends at a joint face that does not exist: place that end again.");
            return found->frame.origin;
        }
        const auto& end = std::get<EndpointRef>(place);
        const auto bone = document.bones.find(end.bone);
        if (bone == document.bones.end()) return fail("bad-place", "A bone ends at a bone that does not exist: place that end again.");
        place = Bone::Place(placeOf(*bone->second, end.atEnd));
    }
    return fail("bad-place", "The ends of bones refer to each other in a circle: place one of them at a face or a point.");
}

void addRenderMeshes(CharacterPlan& plan, const Document& document, EmbeddedModels& models) {
    for (const auto& [id, character] : document.characters) {
        const EmbeddedModel& model = models.of(document, *character);
        plan.characters.push_back(id);
        plan.input.renderMeshes.push_back(model.mesh);
        for (const auto& rigid : model.rigid) plan.rigid.push_back({{id, rigid.part}, model.places[rigid.element], rigid.index});
        for (std::size_t e = 0; e < model.places.size(); ++e) plan.input.elements[static_cast<std::size_t>(model.places[e])].embedded = model.points[e];
    }
}

Result<CharacterPlan> planCharacter(const Document& document) {
    CharacterPlan plan;
    const Nodes nodes(document);
    UnionFind sets(static_cast<std::size_t>(nodes.count));

    // Which endpoints are one joint point.
    std::vector<Vec3> rest(2 * document.bones.size());
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (const auto& [id, bone] : document.bones)
        for (const bool atEnd : {false, true}) {
            const int node = nodes.endpoint({id, atEnd});
            const Bone::Place& place = placeOf(*bone, atEnd);
            IMOMUSHI_TRY(const auto position, restPosition(document, place));
            rest[static_cast<std::size_t>(node)] = position;
            low = low.cwiseMin(position);
            high = high.cwiseMax(position);
            if (const auto* face = std::get_if<FaceRef>(&place); face && !isHandle(document, *face)) sets.unite(node, nodes.faces.at(*face));
            if (const auto* end = std::get_if<EndpointRef>(&place)) sets.unite(node, nodes.endpoint(*end));
        }
    for (const auto& [id, joint] : document.joints)
        for (std::size_t i = 1; i < joint->faces.size(); ++i) {
            const auto a = nodes.faces.find(joint->faces[0]), b = nodes.faces.find(joint->faces[i]);
            if (a == nodes.faces.end() || b == nodes.faces.end()) return fail("bad-place", "A joint names a face that does not exist: unjoin it.");
            sets.unite(a->second, b->second);
        }
    const double same = rest.empty() ? 0.0 : kSamePoint * (high - low).norm();
    for (std::size_t i = 0; i < rest.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if ((rest[i] - rest[k]).norm() <= same) sets.unite(static_cast<int>(i), static_cast<int>(k));

    for (const auto& [id, bone] : document.bones)
        for (const bool atEnd : {false, true})
            if (const auto* point = std::get_if<Vec3>(&placeOf(*bone, atEnd)))
                for (const auto& [ref, node] : nodes.faces) {
                    const JointFace& face = *faceAt(document, ref);
                    if (isHandle(document, ref)) continue;
                    if ((face.frame.origin - *point).norm() <= kAtFace * face.size) sets.unite(nodes.endpoint({id, atEnd}), node);
                }

    // Joint points, in the order of their first endpoint, which also says where they are.
    std::map<int, int> pointOfSet;
    Skeleton& skeleton = plan.input.skeleton;
    const auto pointOf = [&](const EndpointRef& end) {
        const int node = nodes.endpoint(end);
        const auto [found, isNew] = pointOfSet.try_emplace(sets.find(node), static_cast<int>(skeleton.points.size()));
        if (isNew) skeleton.points.push_back(rest[static_cast<std::size_t>(node)]);
        plan.points.emplace(end, found->second);
        return found->second;
    };
    std::vector<PartId> ids;
    std::vector<std::pair<int, int>> ends;
    for (const auto& [id, bone] : document.bones) {
        const int start = pointOf({id, false}), end = pointOf({id, true});
        ids.push_back(id);
        ends.emplace_back(start, end);
        if (start == end)
            return fail("zero-length", "The bone \"" + bone->name + "\" has no length: its two ends are the same joint point.");
    }
    UnionFind trees(skeleton.points.size());
    for (std::size_t b = 0; b < ids.size(); ++b) {
        if (trees.find(ends[b].first) == trees.find(ends[b].second))
            return fail("bone-loop", "The bone \"" + document.bones.at(ids[b])->name +
                                         "\" closes a loop: bones form trees, so leave one bone of the loop out.");
        trees.unite(ends[b].first, ends[b].second);
    }

    std::vector<int> order;
    const std::vector<int> parents = parentsOf(document, ids, ends, order);
    std::vector<int> place(ids.size());
    for (std::size_t i = 0; i < order.size(); ++i) place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
    for (const int b : order) {
        const auto index = static_cast<std::size_t>(b);
        const Bone& bone = *document.bones.at(ids[index]);
        Skeleton::Bone made;
        made.start = ends[index].first;
        made.end = ends[index].second;
        made.parent = parents[index] < 0 ? -1 : place[static_cast<std::size_t>(parents[index])];
        made.length = (skeleton.points[static_cast<std::size_t>(made.end)] - skeleton.points[static_cast<std::size_t>(made.start)]).norm();
        made.minStretch = bone.minStretch;
        made.maxStretch = bone.maxStretch;
        made.maxBend = bone.maxBend;
        made.maxTwist = bone.maxTwist;
        made.stiffness = bone.stiffness;
        skeleton.bones.push_back(made);
        plan.bones.push_back(ids[index]);
    }

    if (document.settings.bodyFollows > 0.0) {
        std::vector<int> elementOf;
        for (const PartId id : plan.bones) {
            const auto element = document.elements.find(document.bones.at(id)->element);
            elementOf.push_back(element == document.elements.end() ? -1 : static_cast<int>(std::distance(document.elements.begin(), element)));
        }
        letBodyFollow(skeleton, document.settings.bodyFollows, elementOf);
        addLimbHinges(plan, document);
    }

    // Elements.
    plan.input.basis = document.settings.basis;
    plan.input.format = document.settings.format;
    plan.input.threads = document.settings.threads;
    plan.input.effects = characterEffects(document);
    for (const auto& [id, element] : document.elements) {
        CharacterInput::Element made;
        made.mesh = element->mesh;
        made.faces = element->faces;
        made.stiffness = element->stiffness;
        made.density = element->density;
        made.damping = element->damping;
        made.nu = element->nu;
        made.handles = static_cast<int>(element->handles.size());
        for (std::size_t b = 0; b < plan.bones.size(); ++b)
            if (document.bones.at(plan.bones[b])->element == id) made.bones.push_back(static_cast<int>(b));
        plan.elements.push_back(id);
        plan.input.elements.push_back(std::move(made));
    }
    for (const auto& [id, joint] : document.joints) {
        bool someHasMore = false;
        for (const FaceRef& f : joint->faces) someHasMore = someHasMore || jointFaces(*document.elements.at(f.element)) >= 2;
        for (const FaceRef& f : joint->faces) {
            const Element& element = *document.elements.at(f.element);
            auto& made = plan.input.elements[static_cast<std::size_t>(plan.elementIndex(f.element))];
            made.leadsJointPlanes = element.jointPlanes == Element::JointPlanes::Element ||
                                    (element.jointPlanes == Element::JointPlanes::Auto && jointFaces(element) == 1 && someHasMore);
        }
        if (!someHasMore && joint->faces.size() >= 2)
            plan.warnings.push_back("The elements of \"" + faceText(document, joint->faces[0]) + "\" and \"" +
                                    faceText(document, joint->faces[1]) +
                                    "\" have no other joint face: when the joint bends they turn with its plane and leave their bones; give "
                                    "each a tip face at the far end of its bone.");
    }

    const auto pointAt = [&](const FaceRef& face) {
        const auto set = pointOfSet.find(sets.find(nodes.faces.at(face)));
        return set == pointOfSet.end() ? -1 : set->second;
    };
    // Where the bones of all elements of a joint meet near its section, -1: nowhere.
    const auto meetingPoint = [&](const Joint& joint) {
        const auto touches = [&](PartId element, int point) {
            const auto& bones = plan.input.elements[static_cast<std::size_t>(plan.elementIndex(element))].bones;
            return std::any_of(bones.begin(), bones.end(), [&](int b) {
                const auto& bone = skeleton.bones[static_cast<std::size_t>(b)];
                return bone.start == point || bone.end == point;
            });
        };
        const JointFace& face = *faceAt(document, joint.faces[0]);
        int nearest = -1;
        double least = kMeeting * face.size;
        for (int p = 0; p < static_cast<int>(skeleton.points.size()); ++p) {
            const double distance = (skeleton.points[static_cast<std::size_t>(p)] - face.frame.origin).norm();
            if (distance > least || !std::all_of(joint.faces.begin(), joint.faces.end(), [&](const FaceRef& f) { return touches(f.element, p); })) continue;
            nearest = p;
            least = distance;
        }
        return nearest;
    };
    // Joints: those of the document, then every other face alone.
    const auto addFace = [&](CharacterInput::Joint& joint, const FaceRef& ref) {
        CharacterInput::Joint::Face face;
        face.element = plan.elementIndex(ref.element);
        face.face = document.elements.at(ref.element)->faceIndex(ref.face);
        if (joint.point >= 0)
            for (const int b : plan.input.elements[static_cast<std::size_t>(face.element)].bones) {
                const auto& bone = skeleton.bones[static_cast<std::size_t>(b)];
                if (face.bone < 0 && (bone.start == joint.point || bone.end == joint.point)) face.bone = b;
            }
        joint.faces.push_back(face);
    };
    for (const auto& [id, joint] : document.joints) {
        CharacterInput::Joint made;
        made.point = pointAt(joint->faces[0]);
        if (made.point < 0) made.point = meetingPoint(*joint);
        for (const FaceRef& f : joint->faces) addFace(made, f);
        if (joint->faces.size() >= 2) {
            const auto on = [&](std::size_t i) {
                const Element& element = *document.elements.at(joint->faces[i].element);
                return FaceOnBody{&element.mesh->body, faceAt(document, joint->faces[i])};
            };
            made.welded = weldedVertices(on(0), on(1));
        }
        plan.joints.push_back(id);
        plan.input.joints.push_back(std::move(made));
    }
    for (const auto& [ref, node] : nodes.faces) {
        if (document.jointOf(ref)) continue;
        CharacterInput::Joint made;
        made.point = pointAt(ref);
        addFace(made, ref);
        if (isHandle(document, ref)) {
            CharacterInput::Handle handle;
            handle.joint = static_cast<int>(plan.input.joints.size());
            if (const auto& bone = document.elements.at(ref.element)->handleOf(ref.face)->bone) {
                handle.bone = plan.boneIndex(bone->bone);
                handle.atEnd = bone->atEnd;
            }
            plan.input.handles.push_back(handle);
            plan.handles.push_back(ref);
        }
        plan.joints.push_back(0);
        plan.input.joints.push_back(std::move(made));
    }
    return plan;
}

}  // namespace imomushi
