// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QPolygonF>
#include <QRectF>
#include <optional>
#include <string>
#include <vector>

#include "ui/models/studio_document.h"
#include "ui/picking/pointer_event.h"
#include "ui/render/scene.h"

namespace imomushi {

/// Distances in pixels of the design within which the pointer takes hold of things.
inline constexpr double kEndpointPixels = 12.0;
inline constexpr double kBonePixels = 6.0;
inline constexpr double kFaceCentrePixels = 14.0;
/// A press that moves less than this before its release is a click, pixels of the design.
inline constexpr double kDragPixels = 3.0;

/// A crossing of a ray with what is seen of an element, as it is posed now. Where that is the render mesh of a character, all but `distance` is of the point of the
/// element's body that is nearest to the crossing, caps of cuts left out: what tools do there, they do to the body.
struct RayHit {
    PartId element = 0;
    std::int32_t triangle = -1;  ///< of the body
    double distance = 0.0;       ///< m along the ray
    bool entering = true;        ///< from outside to inside
    Vec3 point = Vec3::Zero();   ///< world, posed
    Vec3 normal = Vec3::UnitZ(); ///< of the triangle there, outward, unit
    Vec3 rest = Vec3::Zero();    ///< the same surface point at rest
    PartId character = 0;        ///< whose render mesh was crossed; 0: the element's own mesh
    std::int32_t seen = -1;      ///< triangle of that render mesh
};

/// Makes in the background what rays ask of meshes, so that the first ray waits for none of it.
void preparePicking(const Document& document);
/// The same on this thread, whichever it is.
void makePicking(const decltype(Document::elements)& elements, const decltype(Document::characters)& characters);

/// All crossings with what is seen of visible, unlocked elements, nearest first. rayDirection must be a unit vector.
std::vector<RayHit> rayHits(const Session& session, const Vec3& rayOrigin, const Vec3& rayDirection);

/// The surface under the pointer, seen from outside; none: there is none.
std::optional<RayHit> surfaceUnder(const Session& session, const PointerEvent& e);

/// The joint face of an element that a triangle belongs to; null: none.
const JointFace* faceOfTriangle(const Element& element, std::int32_t triangle);

/// What a pose is made with: an end of a bone, or a handle.
struct PoseGrip {
    EndpointRef end;
    FaceRef handle;  ///< of no element: it is the end of a bone
    [[nodiscard]] bool isHandle() const { return handle.element != 0; }
    [[nodiscard]] SelectionItem item() const {
        if (isHandle()) return {SelectionItem::Kind::Face, handle.element, handle.face, false};
        return {SelectionItem::Kind::Endpoint, end.bone, {}, end.atEnd};
    }
    bool operator==(const PoseGrip&) const = default;
};
/// Where it is now; none: the reference leads nowhere.
std::optional<Vec3> gripPosition(const Session& session, const PoseGrip& grip);
/// What commands call it.
std::string pathOf(const Document& document, const PoseGrip& grip);
bool isPinned(const Document& document, const PoseGrip& grip);
/// It was dragged or pinned.
bool isHeld(const Document& document, const PoseGrip& grip);

/// Where an end of a bone is now (posed), or at rest; none: the reference leads nowhere.
std::optional<Vec3> endpointPosition(const Session& session, const EndpointRef& end);
std::optional<Vec3> endpointRestPosition(const Document& document, const EndpointRef& end);
/// Where the centre of a joint face is now (posed).
std::optional<Vec3> facePosition(const Session& session, const FaceRef& face);

/// The rim of a patch of an element as closed polylines, posed.
std::vector<std::vector<Vec3>> rimOf(const Session& session, PartId element, const std::vector<std::int32_t>& triangles);
/// Shows it, as what the next click makes.
void addRim(render::Scene& scene, const Session& session, PartId element, const std::vector<std::int32_t>& triangles);

/// The ends of bones within `pixels` of the pointer, one for each joint point: the nearest first, and of those about as near the one in front. Of several ends at one
/// joint point it is the one that is held already, then the end (not the start) of the oldest bone.
std::vector<EndpointRef> endpointsUnder(const Session& session, const PointerEvent& e, double pixels = kEndpointPixels);
/// The one of them that is meant: the first, or as many later as `e.behind` says.
std::optional<EndpointRef> pickEndpoint(const Session& session, const PointerEvent& e, double pixels = kEndpointPixels);

/// The handle under the pointer: one whose disc is seen there, or whose middle is within `pixels` of it and not behind a body.
std::optional<FaceRef> pickHandle(const Session& session, const PointerEvent& e, double pixels = kEndpointPixels);
/// Whichever of both is under the pointer, ends of bones first.
std::optional<PoseGrip> pickGrip(const Session& session, const PointerEvent& e);
/// The end of a bone through the element, or the handle of it, that is nearest to a place of the flesh as it is posed.
/// A pinned handle only where there is nothing else.
std::optional<PoseGrip> nearestGrip(const Session& session, PartId element, const Vec3& place);

/// How the flesh of a patch of an element lies now: the rigid motion nearest to those of its vertices, in the world.
HandlePose poseOfFlesh(const Session& session, const Element& element, const JointFace& patch);

/// Another reference to the same joint point that is to be preferred for holding it.
EndpointRef holdingEndpoint(const Session& session, const EndpointRef& end);

/// What lies under the pointer, hidden and locked parts left out: bones and their ends, drawn over everything, come before bodies; a triangle of a joint face is the face.
std::optional<SelectionItem> pickItem(const Session& session, const PointerEvent& e);

/// The cut whose rim is under the pointer and not behind a body.
std::optional<SelectionItem> pickCut(const Session& session, const PointerEvent& e);

/// Everything that a box over the viewport touches: bones, where they are shown, and then visible, unlocked elements.
std::vector<SelectionItem> itemsWithin(const Session& session, const PointerEvent& view, const QRectF& box);
/// The same of a closed loop.
std::vector<SelectionItem> itemsWithin(const Session& session, const PointerEvent& view, const QPolygonF& loop);

/// The id of a selected part in every scene; 0: it is not there any more.
std::uint64_t sceneIdOf(const Document& document, const SelectionItem& item);

/// Points that a view of these parts must show: body vertices and ends of bones, m, world, posed.
std::vector<Vec3> pointsOf(const Session& session, const std::vector<SelectionItem>& items);

/// The body of an element in a scene that is being put together; null: it is hidden, or under a render mesh.
render::Body* bodyOf(render::Scene& scene, const Element& element);

}  // namespace imomushi
