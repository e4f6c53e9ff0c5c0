// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/document_scene.h"

#include <algorithm>
#include <span>

#include "core/base/decompositions.h"
#include "core/base/hash.h"
#include "core/character/deform_input.h"
#include "core/document/bone_limits.h"
#include "core/document/character_input.h"
#include "core/joints/seam.h"
#include "ui/render/decoded_textures.h"

namespace imomushi {

namespace {

// An id is a kind (3 bits), a part (44 bits) and a face or end (16 bits). Parts are counted from 1, so none of them comes near its limit.
constexpr int kKindShift = 60, kPartShift = 16;
constexpr std::uint64_t kDetailMask = 0xffff, kPartMask = (std::uint64_t(1) << (kKindShift - kPartShift)) - 1;

// A face this much smaller than what it is joined to hides less than all of it (relative area): the larger one stays drawn.
constexpr double kSameArea = 0.98;
// Of bodies under render meshes, where they are shown.
constexpr float kBodyOpacity = 0.6f;
// Arrows of a handle are this many times as long as its disc is wide in half.
constexpr double kHandleAxis = 1.6;
constexpr double kFaceAxis = 0.7;  // of the size of a joint face

}  // namespace

std::uint64_t sceneId(const ScenePart& part) {
    std::uint64_t detail = 0;
    if (part.kind == ScenePart::Kind::Face) detail = static_cast<std::uint64_t>(part.face);
    if (part.kind == ScenePart::Kind::Endpoint) detail = part.atEnd ? 1 : 0;
    return (static_cast<std::uint64_t>(part.kind) + 1) << kKindShift | (part.part & kPartMask) << kPartShift | (detail & kDetailMask);
}

std::optional<ScenePart> scenePart(std::uint64_t id) {
    const std::uint64_t kind = id >> kKindShift, part = id >> kPartShift & kPartMask, detail = id & kDetailMask;
    if (kind < 1 || kind > 7 || part == 0) return std::nullopt;
    ScenePart answer{static_cast<ScenePart::Kind>(kind - 1), part, -1, false};
    if (answer.kind == ScenePart::Kind::Face) answer.face = static_cast<int>(detail);
    if (answer.kind == ScenePart::Kind::Endpoint) answer.atEnd = detail != 0;
    return answer;
}

void decodeTextures(const Document& document) {
    for (const auto& [id, element] : document.elements)
        if (element->visible && !element->piece) render::decodeTextures(element->mesh);
    for (const auto& [id, character] : document.characters) render::decodeTextures(std::shared_ptr<const ElementMesh>(character->model, &character->model->mesh));
}

DocumentScene::ElementParts& DocumentScene::parts(const std::shared_ptr<const Element>& element, const std::vector<int>& coveredFaces) {
    ElementParts& p = parts_[element->id];
    if (p.element == element && p.coveredFaces == coveredFaces) return p;
    p.coveredFaces = coveredFaces;
    auto covered = std::make_shared<std::vector<std::int32_t>>();
    for (const int f : coveredFaces) covered->insert(covered->end(), element->faces[f].triangles.begin(), element->faces[f].triangles.end());
    std::sort(covered->begin(), covered->end());
    // The renderer makes a body anew when this pointer changes, so an equal list keeps the old one.
    if (covered->empty()) p.covered = nullptr;
    else if (!p.covered || *p.covered != *covered) p.covered = std::move(covered);
    if (p.element == element) return p;

    p.element = element;
    p.rims = rimsOf(element);
    const Points& v = element->mesh->body.vertices;
    p.lowest = v.rows() ? v.col(1).minCoeff() : 0.0;
    p.restPositions.resize(v.size());
    Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(p.restPositions.data(), v.rows(), 3) = v.cast<float>();
    return p;
}

void DocumentScene::update(const Session& session, const SceneOptions& options, render::Scene& scene) {
    const Document& document = session.document();
    scene.bodies.clear();
    scene.seams.clear();
    scene.markers.clear();
    std::erase_if(parts_, [&](const auto& entry) { return !document.elements.contains(entry.first); });
    std::erase_if(characters_, [&](const auto& entry) { return !document.characters.contains(entry.first); });

    // Joined faces that lie inside: both elements are shown, and the neighbour's face is as large.
    std::map<PartId, std::vector<int>> coveredFaces;
    const auto shown = [&](const FaceRef& ref) -> const Element* {
        const auto at = document.elements.find(ref.element);
        return at != document.elements.end() && at->second->visible ? at->second.get() : nullptr;
    };
    for (const auto& [id, joint] : document.joints)
        for (const FaceRef& ref : joint->faces) {
            const Element* element = shown(ref);
            const int face = element ? element->faceIndex(ref.face) : -1;
            if (face < 0) continue;
            for (const FaceRef& other : joint->faces) {
                const Element* neighbour = shown(other);
                const int opposite = neighbour && neighbour != element ? neighbour->faceIndex(other.face) : -1;
                if (opposite < 0 || neighbour->faces[opposite].area < kSameArea * element->faces[face].area) continue;
                coveredFaces[ref.element].push_back(face);
                break;
            }
        }

    Character* character = session.character();
    scene.deformInput = character && options.gpu && options.gpu->uploadCharacter(character->deformInput()) ? &character->deformInput() : nullptr;
    for (int i = 0; character && i < static_cast<int>(character->input().elements.size()); ++i)
        (void)character->deformExternally(i, scene.deformInput && options.gpu->deforms(i));
    scene.ground = 0.0;
    for (auto& [id, p] : parts_) p.shown = nullptr;
    for (const auto& [id, element] : document.elements) {
        if (!element->visible || !element->mesh) continue;
        ElementParts& p = parts(element, coveredFaces[id]);
        const bool outlined = options.faces || (options.bones && !element->handles.empty());
        if (element->piece && !options.bodies && !outlined) continue;
        if (!element->piece) scene.ground = std::min(scene.ground, p.lowest);
        addBody(session, *element, p, options, scene);
        if (outlined && !scene.bodies.back().positions) scene.bodies.back().positions = character->surface(session.elementIndex(id)).positions;
        p.shown = scene.bodies.back().positions;
        if (element->piece && !options.bodies) scene.bodies.pop_back();
    }
    addRenderMeshes(session, options, scene);
    scene.solidGround = document.effects.has(EffectKind::Ground);
    if (scene.solidGround) scene.ground = document.effects.number(EffectKind::Ground, "height");
    addSeams(document, scene);
    if (options.faces || options.bones) addFaces(document, options, scene);
    if (options.bones) addBones(session, options, scene);
    if (options.bones) addHandles(session, options, scene);
    addCuts(session, options, scene);
}

void DocumentScene::addBody(const Session& session, const Element& element, ElementParts& p, const SceneOptions& options, render::Scene& scene) const {
    render::Body& body = scene.bodies.emplace_back();
    const std::uint64_t item = sceneId({ScenePart::Kind::Element, element.id, -1, false});
    body.id = element.piece ? sceneId({ScenePart::Kind::Body, element.id, -1, false}) : item;
    body.mesh = element.mesh;
    body.coveredTriangles = p.covered;
    body.color = element.color;
    body.opacity = element.piece ? kBodyOpacity : options.bodyOpacity;
    body.pickable = !element.locked && !element.piece;
    body.selected = options.isSelected(item) && !element.piece;
    body.hovered = options.hovered == item && !element.piece;
    body.outdated = session.responseState(element.id) == Session::ResponseState::Stale && !session.responses().isDraft(element.id);
    body.positions = p.restPositions.data();
    Character* character = session.character();
    const int index = character ? session.elementIndex(element.id) : -1;
    const DeformInput::Element* made = index >= 0 && scene.deformInput && !element.piece ? &scene.deformInput->elements[static_cast<std::size_t>(index)] : nullptr;
    ContentHasher content;
    if (made && made->bodyVertices == element.mesh->body.vertices.rows()) {
        body.deformSurface = index;
        body.positions = nullptr;
        content.number(scene.deformInput->id);
        content.number(made->frame.revision);
        body.revision = content.key().low;
        return;
    }
    if (index >= 0) {
        const Character::Surface surface = character->surface(index);
        if (surface.positions && surface.vertices == element.mesh->body.vertices.rows()) {
            body.positions = surface.positions;
            body.normals = surface.normals;
        }
    }
    // A character that was built anew counts its revisions from the start, so the content itself is the revision.
    content.array(std::span(body.positions, p.restPositions.size()));
    body.revision = content.key().low;
}

void DocumentScene::addSeams(const Document& document, render::Scene& scene) {
    const auto bodyOf = [&](PartId element) {
        const auto of = document.elements.find(element);
        const bool underRenderMesh = of != document.elements.end() && of->second->piece;
        const std::uint64_t id = sceneId({underRenderMesh ? ScenePart::Kind::Body : ScenePart::Kind::Element, element, -1, false});
        for (std::size_t i = 0; i < scene.bodies.size(); ++i)
            if (scene.bodies[i].id == id) return static_cast<int>(i);
        return -1;
    };
    std::map<std::pair<FaceRef, FaceRef>, Weld> kept;
    for (const auto& [id, joint] : document.joints)
        for (std::size_t i = 0; i < joint->faces.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const FaceRef &ra = joint->faces[j], &rb = joint->faces[i];
                const int a = bodyOf(ra.element), b = bodyOf(rb.element);
                if (a < 0 || b < 0 || a == b) continue;
                const auto& ea = document.elements.at(ra.element);
                const auto& eb = document.elements.at(rb.element);
                const int fa = ea->faceIndex(ra.face), fb = eb->faceIndex(rb.face);
                if (fa < 0 || fb < 0) continue;
                Weld& weld = kept[{ra, rb}];
                if (const auto old = welds_.find({ra, rb}); old != welds_.end()) weld = old->second;
                if (weld.a != ea || weld.b != eb)
                    weld = {ea, eb, std::make_shared<const std::vector<std::pair<std::int32_t, std::int32_t>>>(
                                        weldedVertices({&ea->mesh->body, &ea->faces[fa]}, {&eb->mesh->body, &eb->faces[fb]}))};
                scene.seams.push_back({a, b, weld.vertices});
            }
    welds_ = std::move(kept);
}

namespace {

void addAxes(render::Scene& scene, const Vec3& at, const Eigen::Matrix3d& axes, double length) {
    for (int axis = 0; axis < 3; ++axis) {
        render::Marker arrow;
        arrow.shape = render::Marker::Shape::Axis;
        arrow.from = at;
        arrow.to = at + length * axes.col(axis);
        scene.markers.push_back(std::move(arrow));
    }
}

/// The frame of a joint face where its vertices are shown. `shown`: floats x y z of all vertices of the body.
void addFrame(render::Scene& scene, const Element& element, const JointFace& face, const float* shown) {
    const auto n = static_cast<Eigen::Index>(face.vertices.size());
    Eigen::Matrix3Xd rest(3, n), now(3, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const std::int32_t v = face.vertices[static_cast<std::size_t>(k)];
        rest.col(k) = element.mesh->body.vertices.row(v).transpose();
        now.col(k) = Eigen::Map<const Eigen::Vector3f>(shown + 3 * std::ptrdiff_t(v)).cast<double>();
    }
    const Eigen::Isometry3d motion(nearestMotion(rest, now));
    addAxes(scene, motion * face.frame.origin, motion.linear() * face.frame.axes, kFaceAxis * face.size);
}

}  // namespace

void DocumentScene::addFaces(const Document& document, const SceneOptions& options, render::Scene& scene) {
    // Of joined faces, which lie on each other, the first is shown and the others when they are selected.
    std::vector<FaceRef> hidden;
    for (const auto& [joined, joint] : document.joints) hidden.insert(hidden.end(), joint->faces.begin() + (joint->faces.empty() ? 0 : 1), joint->faces.end());
    for (const auto& [id, p] : parts_) {
        if (!p.shown) continue;
        for (int f = 0; f < static_cast<int>(p.rims->size()); ++f) {
            render::Marker marker;
            marker.shape = render::Marker::Shape::FaceOutline;
            marker.id = sceneId({ScenePart::Kind::Face, id, f, false});
            marker.selected = options.isSelected(marker.id);
            marker.hovered = options.hovered == marker.id;
            if (!p.element->faces[f].visible) continue;
            const FaceRef ref{id, p.element->faces[f].name};
            if (p.element->handleOf(ref.face) ? !options.bones : !options.faces) continue;
            if (!marker.selected && !marker.hovered && std::find(hidden.begin(), hidden.end(), ref) != hidden.end()) continue;
            if (p.element->locked || p.element->faces[f].locked) marker.id = 0;
            if ((marker.selected || marker.hovered) && !p.element->handleOf(ref.face)) addFrame(scene, *p.element, p.element->faces[f], p.shown);
            for (const auto& loop : (*p.rims)[f]) {
                marker.outline.clear();
                for (const std::int32_t v : loop) marker.outline.push_back(Eigen::Map<const Eigen::Vector3f>(p.shown + 3 * v).cast<double>());
                if (!marker.outline.empty()) marker.from = marker.to = marker.outline.front();
                scene.markers.push_back(marker);
            }
        }
    }
}

void DocumentScene::addBones(const Session& session, const SceneOptions& options, render::Scene& scene) const {
    const Document& document = session.document();
    const Character* character = session.character();
    const Pose& pose = session.shownPose();
    const auto position = [&](const Bone& bone, bool atEnd) -> std::optional<Vec3> {
        const int point = character ? session.pointIndex({bone.id, atEnd}) : -1;
        if (point >= 0 && point < static_cast<int>(pose.points.size())) return pose.points[point];
        if (point >= 0 && point < static_cast<int>(character->input().skeleton.points.size())) return character->input().skeleton.points[point];
        const auto rest = restPosition(document, atEnd ? bone.end : bone.start);
        return rest ? std::optional(*rest) : std::nullopt;
    };
    // Ends that are one joint point share one marker, which answers for an end before a start: ends are what one drags.
    struct Point {
        render::Marker marker;
        EndpointRef representative;  ///< whose id the marker has
    };
    std::vector<Point> points;
    std::map<int, std::size_t> byJoint;
    // Limits are seen where somebody pulls, in the colour of a warning.
    const bool pulled = std::any_of(document.goals.begin(), document.goals.end(), [](const auto& goal) { return !goal.second.pinned; });
    for (const auto& [id, bone] : document.bones) {
        if (!bone->visible) continue;
        const auto from = position(*bone, false), to = position(*bone, true);
        if (!from || !to) continue;
        render::Marker marker;
        marker.shape = render::Marker::Shape::Bone;
        marker.id = sceneId({ScenePart::Kind::Bone, id, -1, false});
        marker.from = *from;
        marker.to = *to;
        marker.selected = options.isSelected(marker.id);
        marker.hovered = options.hovered == marker.id;
        marker.refused = character && pulled && limitOf(session.plan().input.skeleton, pose, session.plan().boneIndex(id)) != BoneLimit::None;
        scene.markers.push_back(marker);
        for (const bool atEnd : {false, true}) {
            const EndpointRef end{id, atEnd};
            const int joint = character ? session.pointIndex(end) : -1;
            std::size_t place = points.size();
            if (joint >= 0) place = byJoint.try_emplace(joint, place).first->second;
            if (place == points.size()) points.push_back({{}, end});
            Point& point = points[place];
            if (atEnd && !point.representative.atEnd) point.representative = end;
            point.marker.from = point.marker.to = atEnd ? *to : *from;
            const std::uint64_t own = sceneId({ScenePart::Kind::Endpoint, id, -1, atEnd});
            point.marker.selected = point.marker.selected || options.isSelected(own);
            point.marker.hovered = point.marker.hovered || options.hovered == own;
            if (const auto held = document.goals.find(end); held != document.goals.end())
                point.marker.shape = held->second.pinned ? render::Marker::Shape::PinnedPoint : render::Marker::Shape::HeldPoint;
        }
    }
    for (Point& point : points) {
        point.marker.id = sceneId({ScenePart::Kind::Endpoint, point.representative.bone, -1, point.representative.atEnd});
        scene.markers.push_back(std::move(point.marker));
    }
}

void DocumentScene::addHandles(const Session& session, const SceneOptions& options, render::Scene& scene) {
    const Document& document = session.document();
    for (const auto& [id, element] : document.elements) {
        if (!element->visible) continue;
        for (const Handle& handle : element->handles) {
            const int face = element->faceIndex(handle.face);
            const auto pose = session.poseOf({id, handle.face});
            if (face < 0 || !pose || !element->faces[static_cast<std::size_t>(face)].visible) continue;
            render::Marker point;
            const auto goal = document.handleGoals.find({id, handle.face});
            if (goal != document.handleGoals.end() && goal->second.target.held)
                point.shape = goal->second.pinned ? render::Marker::Shape::PinnedPoint : render::Marker::Shape::HeldPoint;
            point.id = sceneId({ScenePart::Kind::Face, id, face, false});
            point.from = point.to = pose->at;
            point.selected = options.isSelected(point.id);
            point.hovered = options.hovered == point.id;
            if (point.selected || point.hovered) {
                const JointFace& of = element->faces[static_cast<std::size_t>(face)];
                addAxes(scene, pose->at, pose->rotation * of.frame.axes, kHandleAxis * of.size);
            }
            if (element->locked || element->faces[static_cast<std::size_t>(face)].locked) point.id = 0;
            scene.markers.push_back(std::move(point));
        }
    }
}

}  // namespace imomushi
