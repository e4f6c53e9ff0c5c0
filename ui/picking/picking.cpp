// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/picking/picking.h"

#include <Eigen/Geometry>
#include <QThreadPool>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <span>

#include "core/base/decompositions.h"
#include "core/base/kept_with.h"
#include "core/document/character_input.h"
#include "core/mesh/connectivity.h"
#include "core/mesh/triangle_tree.h"
#include "ui/models/failures.h"
#include "ui/models/paths.h"
#include "ui/scene/cut_frame.h"
#include "ui/scene/document_scene.h"
#include "ui/scene/posed_body.h"
#include "ui/scene/rim.h"
#include "ui/scene/seen_mesh.h"

namespace imomushi {
namespace {

const Vec3* skeletonPoint(const Session& session, const EndpointRef& end) {
    Character* character = session.character();
    const int index = session.pointIndex(end);
    if (!character || index < 0) return nullptr;
    const auto& posed = session.shownPose().points;
    const auto& rest = character->input().skeleton.points;
    if (index >= int(rest.size())) return nullptr;
    return posed.size() == rest.size() ? &posed[std::size_t(index)] : &rest[std::size_t(index)];
}

/// Distance from the pointer's ray to `p` in logical pixels; infinite behind the eye.
double pixelsTo(const PointerEvent& e, const Vec3& p) {
    const Vec3 d = p - e.rayOrigin;
    const double along = d.dot(e.rayDirection);
    if (along <= 0.0) return std::numeric_limits<double>::infinity();
    return (d - along * e.rayDirection).norm() / e.pixelAt(p);
}

/// The point of the segment a...b nearest to the pointer's ray.
Vec3 nearestOnSegment(const PointerEvent& e, const Vec3& a, const Vec3& b) {
    const Vec3 s = b - a, w = a - e.rayOrigin;
    const double sr = s.dot(e.rayDirection);
    const double denominator = s.squaredNorm() - sr * sr;
    if (denominator <= 1e-12 * s.squaredNorm()) return a;
    const double t = (sr * w.dot(e.rayDirection) - s.dot(w)) / denominator;
    return a + std::clamp(t, 0.0, 1.0) * s;
}

/// Whether the segment a...b on the screen touches the box.
bool touches(const QRectF& box, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector2d low = a.cwiseMin(b), high = a.cwiseMax(b);
    if (high.x() < box.left() || low.x() > box.right() || high.y() < box.top() || low.y() > box.bottom()) return false;
    // Not all corners on one side of its line.
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const QPointF corner : {box.topLeft(), box.topRight(), box.bottomLeft(), box.bottomRight()}) {
        const double side = (b.x() - a.x()) * (corner.y() - a.y()) - (b.y() - a.y()) * (corner.x() - a.x());
        least = std::min(least, side);
        most = std::max(most, side);
    }
    return least <= 0.0 && most >= 0.0;
}

/// How a rectangle lies to an area.
enum class Lies { Outside, Inside, Across };

/// What a drag over the view goes round.
struct BoxArea {
    QRectF box;
    [[nodiscard]] Lies where(const QRectF& what) const { return box.contains(what) ? Lies::Inside : box.intersects(what) ? Lies::Across : Lies::Outside; }
    [[nodiscard]] bool contains(const Eigen::Vector2d& p) const { return box.contains(QPointF(p.x(), p.y())); }
    /// Of a segment with both ends outside.
    [[nodiscard]] bool crosses(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const { return touches(box, a, b); }
};

/// A closed loop, as it is painted where it crosses itself.
struct LoopArea {
    QPolygonF loop;
    QRectF bounds = loop.boundingRect();
    [[nodiscard]] Lies where(const QRectF& what) const {
        if (!bounds.intersects(what)) return Lies::Outside;
        for (qsizetype i = 0; i < loop.size(); ++i) {
            const QPointF &a = loop[i], &b = loop[(i + 1) % loop.size()];
            if (touches(what, {a.x(), a.y()}, {b.x(), b.y()})) return Lies::Across;
        }
        return contains({what.center().x(), what.center().y()}) ? Lies::Inside : Lies::Outside;
    }
    [[nodiscard]] bool contains(const Eigen::Vector2d& p) const { return bounds.contains(QPointF(p.x(), p.y())) && loop.containsPoint(QPointF(p.x(), p.y()), Qt::WindingFill); }
    [[nodiscard]] bool crosses(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
        if (!touches(bounds, a, b)) return false;
        const QLineF segment(QPointF(a.x(), a.y()), QPointF(b.x(), b.y()));
        for (qsizetype i = 0; i < loop.size(); ++i)
            if (segment.intersects(QLineF(loop[i], loop[(i + 1) % loop.size()])) == QLineF::BoundedIntersection) return true;
        return false;
    }
};

/// Places of a surface, whose buffer is longer than its last vertex (Character::Surface).
struct PosedPlaces {
    const float* posed;
    Eigen::Vector3f operator()(std::int32_t v) const { return Eigen::Vector3f(posed + 3 * std::ptrdiff_t(v)); }
    [[nodiscard]] Eigen::Array4f wide(std::int32_t v) const { return Eigen::Map<const Eigen::Array4f>(posed + 3 * std::ptrdiff_t(v)); }
};

/// Calls use(at), where at(vertex) is the place of a vertex of a mesh now, m: on a surface, or at rest.
template <class Use>
void withPlaces(const float* posed, const Points& rest, const Use& use) {
    if (posed) use(PosedPlaces{posed});
    else use([&rest](std::int32_t v) { return Vec3(rest.row(v)); });
}

/// Where a ray crosses a triangle.
struct Crossing {
    double distance = 0.0;  ///< m
    bool entering = true;
    Vec3 weight = Vec3::Zero();  ///< barycentric
};

/// Moeller and Trumbore, two-sided. None: it passes by, or the triangle is behind.
std::optional<Crossing> crossing(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, p = direction.cross(ac);
    const double determinant = ab.dot(p);
    if (determinant == 0.0) return std::nullopt;
    const Vec3 s = origin - a;
    const double u = s.dot(p) / determinant;
    if (!(u >= 0.0 && u <= 1.0)) return std::nullopt;
    const Vec3 q = s.cross(ab);
    const double v = direction.dot(q) / determinant;
    if (!(v >= 0.0 && u + v <= 1.0)) return std::nullopt;
    const double distance = ac.dot(q) / determinant;
    if (!(distance > 0.0)) return std::nullopt;
    return Crossing{distance, determinant > 0.0, Vec3(1.0 - u - v, u, v)};
}

Vec3 weighted(const Vec3& weight, const Vec3& a, const Vec3& b, const Vec3& c) { return weight[0] * a + weight[1] * b + weight[2] * c; }

/// What a crossing with the render mesh is on the body of the element: the nearest point of its skin, on the side that the render triangle faces if that is about
/// as near.
RayHit onBody(const Session& session, const Element& element, const TriangleTree& tree, const Vec3& rest, const Vec3& restNormal) {
    constexpr double kFacing = 2.0;  // times as far at most
    const TriangleMesh& mesh = element.mesh->body;
    auto near = tree.nearest(rest);
    if (restNormal.squaredNorm() > 0.0) {
        const auto facing = tree.nearestFacing(rest, restNormal);
        if (facing.triangle >= 0 && facing.squaredDistance <= kFacing * kFacing * near.squaredDistance) near = facing;
    }
    const PosedBody body(session, element.id, element);
    const auto corner = [&](int c) { return mesh.triangles(near.triangle, c); };
    RayHit hit;
    hit.element = element.id;
    hit.triangle = near.triangle;
    hit.rest = weighted(near.barycentric, mesh.vertices.row(corner(0)), mesh.vertices.row(corner(1)), mesh.vertices.row(corner(2)));
    const Vec3 a = body.at(corner(0)), b = body.at(corner(1)), c = body.at(corner(2));
    hit.point = weighted(near.barycentric, a, b, c);
    hit.normal = (b - a).cross(c - a).stableNormalized();
    return hit;
}

/// The skin of an element: what cuts left of the body. Null: nothing. Kept while its mesh lives.
std::shared_ptr<const TriangleTree> skinOf(const Element& element) {
    static KeptWith<ElementMesh, std::shared_ptr<const TriangleTree>> all;
    return *all.of(element.mesh, [&]() -> std::shared_ptr<const TriangleTree> {
        const TriangleMesh& mesh = element.mesh->body;
        std::vector<std::int32_t> skin;
        for (std::int32_t t = 0; t < mesh.triangles.rows(); ++t)
            if (element.piece->origin->triangles[std::size_t(t)] >= 0) skin.push_back(t);
        return skin.empty() ? nullptr : std::make_shared<const TriangleTree>(mesh, std::move(skin));
    });
}

void addSeenHits(const Session& session, const Vec3& origin, const Vec3& direction, std::vector<RayHit>& hits) {
    const auto& elements = session.document().elements;
    std::vector<std::int32_t> triangles;
    for (const SeenMesh& seen : seenMeshes(session)) {
        const TriangleMesh& mesh = seen.model().mesh.body;
        withPlaces(seen.surface.positions, mesh.vertices, [&](const auto& at) { seen.model().mesh.connectivity().clusters().along(origin, direction, at, triangles); });
        for (const std::int32_t t : triangles) {
            const auto crossed = crossing(origin, direction, seen.at(mesh.triangles(t, 0)), seen.at(mesh.triangles(t, 1)), seen.at(mesh.triangles(t, 2)));
            if (!crossed) continue;
            const auto element = elements.find(seen.elementOf(t));
            if (element == elements.end() || !element->second->visible || element->second->locked) continue;
            const Vec3 a = mesh.vertices.row(mesh.triangles(t, 0)), b = mesh.vertices.row(mesh.triangles(t, 1)), c = mesh.vertices.row(mesh.triangles(t, 2));
            const auto skin = skinOf(*element->second);
            if (!skin) continue;
            RayHit hit = onBody(session, *element->second, *skin, weighted(crossed->weight, a, b, c), (b - a).cross(c - a));
            hit.distance = crossed->distance;
            hit.character = seen.source->id;
            hit.seen = t;
            hit.entering = hit.normal.dot(direction) < 0.0;  // triangles of a file may face any way
            hits.push_back(hit);
        }
    }
}

}  // namespace

void preparePicking(const Document& document) {
    QThreadPool::globalInstance()->start([elements = document.elements, characters = document.characters] { attempt([&] { makePicking(elements, characters); }); });
}

void makePicking(const decltype(Document::elements)& elements, const decltype(Document::characters)& characters) {
    for (const auto& [id, character] : characters) (void)character->model->mesh.connectivity().clusters();
    for (const auto& [id, element] : elements) {
        if (element->piece) (void)skinOf(*element);
        else (void)element->mesh->connectivity().clusters();
        (void)element->mesh->connectivity().facts();  // what the inspector says of it, once it is picked
        (void)element->mesh->connectivity().box();
    }
}

std::vector<RayHit> rayHits(const Session& session, const Vec3& rayOrigin, const Vec3& rayDirection) {
    std::vector<RayHit> hits;
    std::vector<std::int32_t> triangles;
    for (const auto& [id, element] : session.document().elements) {
        if (!element->visible || element->locked || element->piece) continue;
        const PosedBody body(session, id, *element);
        const TriangleMesh& mesh = element->mesh->body;
        withPlaces(body.posed, mesh.vertices, [&](const auto& at) { element->mesh->connectivity().clusters().along(rayOrigin, rayDirection, at, triangles); });
        for (const std::int32_t t : triangles) {
            const Vec3 a = body.at(mesh.triangles(t, 0)), b = body.at(mesh.triangles(t, 1)), c = body.at(mesh.triangles(t, 2));
            const auto crossed = crossing(rayOrigin, rayDirection, a, b, c);
            if (!crossed) continue;
            RayHit hit;
            hit.element = id;
            hit.triangle = t;
            hit.distance = crossed->distance;
            hit.entering = crossed->entering;
            hit.point = rayOrigin + crossed->distance * rayDirection;
            hit.normal = (b - a).cross(c - a).normalized();
            hit.rest = weighted(crossed->weight, mesh.vertices.row(mesh.triangles(t, 0)), mesh.vertices.row(mesh.triangles(t, 1)), mesh.vertices.row(mesh.triangles(t, 2)));
            hits.push_back(hit);
        }
    }
    addSeenHits(session, rayOrigin, rayDirection, hits);
    std::stable_sort(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) { return a.distance < b.distance; });
    return hits;
}

std::optional<RayHit> surfaceUnder(const Session& session, const PointerEvent& e) {
    const auto hits = rayHits(session, e.rayOrigin, e.rayDirection);
    const auto first = std::find_if(hits.begin(), hits.end(), [](const RayHit& hit) { return hit.entering; });
    return first == hits.end() ? std::nullopt : std::optional(*first);
}

const JointFace* faceOfTriangle(const Element& element, std::int32_t triangle) {
    for (const JointFace& face : element.faces)
        if (std::binary_search(face.triangles.begin(), face.triangles.end(), triangle)) return &face;
    return nullptr;
}

std::optional<Vec3> endpointRestPosition(const Document& document, const EndpointRef& end) {
    const auto position = restPosition(document, end);
    return position ? std::optional(*position) : std::nullopt;
}

std::optional<Vec3> endpointPosition(const Session& session, const EndpointRef& end) {
    if (const Vec3* point = skeletonPoint(session, end)) return *point;
    return endpointRestPosition(session.document(), end);
}

std::optional<Vec3> facePosition(const Session& session, const FaceRef& ref) {
    const auto found = session.document().elements.find(ref.element);
    if (found == session.document().elements.end()) return std::nullopt;
    const Element& element = *found->second;
    const int index = element.faceIndex(ref.face);
    if (index < 0) return std::nullopt;
    // With the areas at rest as weights the centroid follows every joint map exactly, for these are affine.
    const JointFace& face = element.faces[std::size_t(index)];
    const PosedBody body(session, ref.element, element);
    const TriangleMesh& rest = element.mesh->body;
    Vec3 sum = Vec3::Zero();
    double area = 0.0;
    for (const std::int32_t t : face.triangles) {
        const Vec3 a = rest.vertices.row(rest.triangles(t, 0)), b = rest.vertices.row(rest.triangles(t, 1)),
                   c = rest.vertices.row(rest.triangles(t, 2));
        const double weight = (b - a).cross(c - a).norm();
        sum += weight / 3.0 * (body.at(rest.triangles(t, 0)) + body.at(rest.triangles(t, 1)) + body.at(rest.triangles(t, 2)));
        area += weight;
    }
    return area > 0.0 ? Vec3(sum / area) : face.frame.origin;
}

std::vector<std::vector<Vec3>> rimOf(const Session& session, PartId id, const std::vector<std::int32_t>& triangles) {
    std::vector<std::vector<Vec3>> loops;
    const auto found = session.document().elements.find(id);
    if (found == session.document().elements.end()) return loops;
    const PosedBody body(session, id, *found->second);
    for (const auto& rim : rimLoops(found->second->mesh->body.triangles, triangles)) {
        std::vector<Vec3>& loop = loops.emplace_back();
        for (const std::int32_t v : rim) loop.push_back(body.at(v));
    }
    return loops;
}

void addRim(render::Scene& scene, const Session& session, PartId element, const std::vector<std::int32_t>& triangles) {
    for (std::vector<Vec3>& loop : rimOf(session, element, triangles)) {
        render::Marker rim;
        rim.shape = render::Marker::Shape::FaceOutline;
        rim.outline = std::move(loop);
        rim.hovered = true;
        scene.markers.push_back(std::move(rim));
    }
}

EndpointRef holdingEndpoint(const Session& session, const EndpointRef& end) {
    const int point = session.pointIndex(end);
    if (point < 0) return end;
    for (const auto& [held, value] : session.document().goals)
        if (session.pointIndex(held) == point) return held;
    if (end.atEnd) return end;
    for (const auto& [id, bone] : session.document().bones)
        if (session.pointIndex({id, true}) == point) return {id, true};
    return end;
}

std::vector<EndpointRef> endpointsUnder(const Session& session, const PointerEvent& e, double pixels) {
    constexpr double kAsNear = 4.0;  // pixels that a hand does not tell apart
    struct Near {
        double rank, depth;
        EndpointRef end;
    };
    std::vector<Near> near;
    if (e.bonesVisible)
        for (const auto& [id, bone] : session.document().bones)
            for (const bool atEnd : {true, false})
                if (const auto at = !shown(*bone).picked() ? std::nullopt : endpointPosition(session, {id, atEnd}))
                    if (const double distance = pixelsTo(e, *at); distance <= pixels) near.push_back({std::floor(distance / kAsNear), (*at - e.rayOrigin).dot(e.rayDirection), {id, atEnd}});
    std::stable_sort(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.rank != b.rank ? a.rank < b.rank : a.depth < b.depth; });
    std::vector<EndpointRef> ends;
    for (const Near& one : near)
        if (const EndpointRef end = holdingEndpoint(session, one.end); std::find(ends.begin(), ends.end(), end) == ends.end()) ends.push_back(end);
    return ends;
}

std::optional<EndpointRef> pickEndpoint(const Session& session, const PointerEvent& e, double pixels) {
    const auto ends = endpointsUnder(session, e, pixels);
    return ends.empty() ? std::nullopt : std::optional(ends[std::size_t(e.behind) % ends.size()]);
}

std::optional<Vec3> gripPosition(const Session& session, const PoseGrip& grip) {
    if (!grip.isHandle()) return endpointPosition(session, grip.end);
    const auto pose = session.poseOf(grip.handle);
    return pose ? std::optional(pose->at) : std::nullopt;
}

std::string pathOf(const Document& document, const PoseGrip& grip) { return grip.isHandle() ? grip.handle.face : pathOf(document, grip.end); }
bool isPinned(const Document& document, const PoseGrip& grip) { return grip.isHandle() ? isPinned(document, grip.handle) : isPinned(document, grip.end); }

bool isHeld(const Document& document, const PoseGrip& grip) {
    if (!grip.isHandle()) return document.goals.contains(grip.end);
    const auto goal = document.handleGoals.find(grip.handle);
    return goal != document.handleGoals.end() && goal->second.target.held;
}

namespace {

bool hasHandles(const Document& document) {
    return std::any_of(document.elements.begin(), document.elements.end(), [](const auto& part) { return !part.second->handles.empty(); });
}

/// hits: of the ray of the pointer.
std::optional<FaceRef> handleAmong(const Session& session, const PointerEvent& e, double pixels, const std::vector<RayHit>& hits) {
    const auto& elements = session.document().elements;
    if (!hits.empty()) {
        const Element& element = *elements.at(hits.front().element);
        const JointFace* face = faceOfTriangle(element, hits.front().triangle);
        if (face && shown(*face).picked() && element.handleOf(face->name)) return FaceRef{element.id, face->name};
    }
    std::optional<FaceRef> best;
    double nearest = pixels;
    for (const auto& [id, element] : elements) {
        if (!element->visible || element->locked) continue;
        for (const Handle& handle : element->handles) {
            const auto at = gripPosition(session, {{}, {id, handle.face}});
            const JointFace& face = element->faces[std::size_t(element->faceIndex(handle.face))];
            if (!at || !shown(face).picked()) continue;
            const double distance = pixelsTo(e, *at);
            const double size = face.size;
            if (distance >= nearest || (!hits.empty() && hits.front().distance < (*at - e.rayOrigin).dot(e.rayDirection) - size)) continue;
            nearest = distance;
            best = FaceRef{id, handle.face};
        }
    }
    return best;
}

}  // namespace

std::optional<FaceRef> pickHandle(const Session& session, const PointerEvent& e, double pixels) {
    if (!hasHandles(session.document())) return std::nullopt;
    return handleAmong(session, e, pixels, rayHits(session, e.rayOrigin, e.rayDirection));
}

std::optional<PoseGrip> pickGrip(const Session& session, const PointerEvent& e) {
    if (const auto end = pickEndpoint(session, e)) return PoseGrip{*end, {}};
    if (const auto handle = pickHandle(session, e)) return PoseGrip{{}, *handle};
    return std::nullopt;
}

std::optional<PoseGrip> nearestGrip(const Session& session, PartId id, const Vec3& place) {
    std::optional<PoseGrip> best;
    std::pair<bool, double> nearest;  // a handle that is pinned holds the body: it comes last
    const auto offer = [&](const PoseGrip& grip) {
        const auto at = gripPosition(session, grip);
        if (!at) return;
        const std::pair distance(grip.isHandle() && isPinned(session.document(), grip), (*at - place).norm());
        if (best && distance >= nearest) return;
        nearest = distance;
        best = grip;
    };
    for (const auto& [bone, part] : session.document().bones)
        if (part->element == id && shown(*part).picked())
            for (const bool atEnd : {true, false}) offer({{bone, atEnd}, {}});
    if (const auto element = session.document().elements.find(id); element != session.document().elements.end())
        for (const Handle& handle : element->second->handles)
            if (shown(element->second->faces[std::size_t(element->second->faceIndex(handle.face))]).picked()) offer({{}, {id, handle.face}});
    if (best && !best->isHandle()) best->end = holdingEndpoint(session, best->end);
    return best;
}

HandlePose poseOfFlesh(const Session& session, const Element& element, const JointFace& patch) {
    const PosedBody body(session, element.id, element);
    const auto count = Eigen::Index(patch.vertices.size());
    Eigen::Matrix3Xd rest(3, count), now(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const std::int32_t v = patch.vertices[std::size_t(i)];
        rest.col(i) = element.mesh->body.vertices.row(v).transpose();
        now.col(i) = body.at(v);
    }
    const Eigen::Matrix4d motion = nearestMotion(rest, now);
    HandlePose pose;
    pose.held = true;
    pose.at = (motion * patch.frame.origin.homogeneous()).head<3>();
    pose.rotation = Eigen::Quaterniond(Eigen::Matrix3d(motion.topLeftCorner<3, 3>())).normalized();
    return pose;
}

std::optional<SelectionItem> pickItem(const Session& session, const PointerEvent& e) {
    if (e.bonesVisible) {
        if (const auto end = pickEndpoint(session, e)) return SelectionItem{SelectionItem::Kind::Endpoint, end->bone, {}, end->atEnd};
        double nearest = kBonePixels;
        std::optional<SelectionItem> best;
        for (const auto& [id, bone] : session.document().bones) {
            const auto from = endpointPosition(session, {id, false}), to = endpointPosition(session, {id, true});
            if (!from || !to || !shown(*bone).picked()) continue;
            const double distance = pixelsTo(e, nearestOnSegment(e, *from, *to));
            if (distance > nearest) continue;
            nearest = distance;
            best = SelectionItem{SelectionItem::Kind::Bone, id, {}, false};
        }
        if (best) return best;
    }
    const auto hits = rayHits(session, e.rayOrigin, e.rayDirection);
    if (const auto handle = handleAmong(session, e, kEndpointPixels, hits)) return PoseGrip{{}, *handle}.item();
    if (hits.empty()) return std::nullopt;
    const RayHit& hit = hits.front();
    const Element& element = *session.document().elements.at(hit.element);
    if (const JointFace* face = faceOfTriangle(element, hit.triangle); face && shown(*face).picked())
        return SelectionItem{SelectionItem::Kind::Face, hit.element, face->name, false};
    return SelectionItem{SelectionItem::Kind::Element, hit.element, {}, false};
}

std::optional<SelectionItem> pickCut(const Session& session, const PointerEvent& e) {
    struct Near {
        double pixels, depth, reach;
        PartId cut;
    };
    std::vector<Near> near;
    for (const auto& [id, character] : session.document().characters)
        for (const Cut& cut : character->cuts) {
            const auto frame = shown(cut).picked() ? cutFrame(session, cut.id) : std::nullopt;
            if (!frame) continue;
            for (const auto& loop : frame->rim)
                for (std::size_t i = 0; i < loop.size(); ++i) {
                    const Vec3 at = nearestOnSegment(e, loop[i], loop[(i + 1) % loop.size()]);
                    if (const double pixels = pixelsTo(e, at); pixels < kBonePixels) near.push_back({pixels, (at - e.rayOrigin).dot(e.rayDirection), frame->reach, cut.id});
                }
        }
    if (near.empty()) return std::nullopt;
    // The rim lies on the surface: what is a little behind that is in front all the same.
    if (const auto hits = rayHits(session, e.rayOrigin, e.rayDirection); !hits.empty())
        std::erase_if(near, [&](const Near& n) { return n.depth > hits.front().distance + 0.5 * n.reach; });
    const auto best = std::min_element(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.pixels < b.pixels; });
    return best == near.end() ? std::nullopt : std::optional(SelectionItem{SelectionItem::Kind::Cut, best->cut, {}, false});
}

namespace {

/// What holds everything between two corners of a box, as it is seen. None: some of it is behind the eye.
std::optional<QRectF> boxOnScreen(const PointerEvent& view, const Vec3& low, const Vec3& high) {
    Eigen::AlignedBox2d seen;
    for (int k = 0; k < 8; ++k) {
        const auto at = view.onScreen({(k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z()});
        if (!at) return std::nullopt;
        seen.extend(*at);
    }
    // A rectangle without an area would meet nothing.
    constexpr double kEdge = 1e-6;
    return QRectF(seen.min().x() - kEdge, seen.min().y() - kEdge, seen.sizes().x() + 2.0 * kEdge, seen.sizes().y() + 2.0 * kEdge);
}

/// Bones and elements of which an edge touches an area of the view.
template <class Area>
std::vector<SelectionItem> itemsTouched(const Session& session, const PointerEvent& view, const Area& area) {
    std::vector<SelectionItem> items;
    const auto isTouched = [&](const std::optional<Eigen::Vector2d>& a, const std::optional<Eigen::Vector2d>& b) { return a && b && (area.contains(*a) || area.contains(*b) || area.crosses(*a, *b)); };
    if (view.bonesVisible)
        for (const auto& [id, bone] : session.document().bones) {
            const auto from = endpointPosition(session, {id, false}), to = endpointPosition(session, {id, true});
            if (from && to && shown(*bone).picked() && isTouched(view.onScreen(*from), view.onScreen(*to))) items.push_back({SelectionItem::Kind::Bone, id, {}, false});
        }
    std::set<PartId> touched;
    // Of a cluster of triangles that lies inside or outside as a whole no triangle is asked.
    const auto touch = [&](const ElementMesh& whole, const auto& at, const auto& elementOf, bool oneElement) {
        const TriangleMesh& mesh = whole.body;
        const auto seenAt = [&](std::int32_t v) { return view.onScreen(at(v).template cast<double>()); };
        whole.connectivity().clusters().forEach(at, [&](const Vec3& low, const Vec3& high, std::span<const std::int32_t> triangles) {
            const auto box = boxOnScreen(view, low, high);
            const Lies lies = box ? area.where(*box) : Lies::Across;
            if (lies == Lies::Outside) return true;
            PartId last = 0;  // that was touched
            for (const std::int32_t t : triangles) {
                const PartId element = elementOf(t);
                if (element == last || touched.contains(element)) continue;
                const auto isIn = [&] {
                    if (lies == Lies::Inside) return true;
                    std::array<std::optional<Eigen::Vector2d>, 3> corner;
                    for (int c = 0; c < 3; ++c) corner[std::size_t(c)] = seenAt(mesh.triangles(t, c));
                    // An edge of which an end is behind the eye counts for nothing.
                    return isTouched(corner[0], corner[1]) || isTouched(corner[1], corner[2]) || isTouched(corner[2], corner[0]);
                };
                if (!isIn()) continue;
                touched.insert(last = element);
                if (oneElement) return false;
            }
            return true;
        });
    };
    for (const auto& [id, element] : session.document().elements) {
        if (!element->visible || element->locked || element->piece) continue;
        const PosedBody body(session, id, *element);
        withPlaces(body.posed, body.rest->vertices, [&](const auto& at) { touch(*element->mesh, at, [id = id](std::int32_t) { return id; }, true); });
    }
    for (const SeenMesh& seen : seenMeshes(session))
        withPlaces(seen.surface.positions, seen.model().mesh.body.vertices, [&](const auto& at) { touch(seen.model().mesh, at, [&](std::int32_t t) { return seen.elementOf(t); }, seen.elements.size() == 1); });
    for (const auto& [id, element] : session.document().elements)
        if (element->visible && !element->locked && touched.contains(id)) items.push_back({SelectionItem::Kind::Element, id, {}, false});
    return items;
}

}  // namespace

std::vector<SelectionItem> itemsWithin(const Session& session, const PointerEvent& view, const QRectF& box) {
    return itemsTouched(session, view, BoxArea{box});
}

std::vector<SelectionItem> itemsWithin(const Session& session, const PointerEvent& view, const QPolygonF& loop) {
    return itemsTouched(session, view, LoopArea{loop});
}

std::uint64_t sceneIdOf(const Document& document, const SelectionItem& item) {
    ScenePart part;
    part.part = item.part;
    part.atEnd = item.atEnd;
    switch (item.kind) {
        case SelectionItem::Kind::Element: part.kind = ScenePart::Kind::Element; break;
        case SelectionItem::Kind::Bone: part.kind = ScenePart::Kind::Bone; break;
        case SelectionItem::Kind::Endpoint: part.kind = ScenePart::Kind::Endpoint; break;
        case SelectionItem::Kind::Character: part.kind = ScenePart::Kind::Character; break;
        case SelectionItem::Kind::Cut: part.kind = ScenePart::Kind::Cut; break;
        case SelectionItem::Kind::Face: {
            part.kind = ScenePart::Kind::Face;
            const auto element = document.elements.find(item.part);
            part.face = element == document.elements.end() ? -1 : element->second->faceIndex(item.face);
            if (part.face < 0) return 0;
            break;
        }
    }
    return sceneId(part);
}

std::vector<Vec3> pointsOf(const Session& session, const std::vector<SelectionItem>& items) {
    std::vector<Vec3> points;
    const Document& d = session.document();
    const auto addEnd = [&](const EndpointRef& end) {
        if (const auto at = endpointPosition(session, end)) points.push_back(*at);
    };
    std::set<PartId> seenWhole, seenElements;  // characters and elements of which render meshes are asked, each once
    for (const SelectionItem& item : items) {
        const auto element = d.elements.find(item.part);
        switch (item.kind) {
            case SelectionItem::Kind::Character: seenWhole.insert(item.part); break;
            case SelectionItem::Kind::Cut:
                if (const auto frame = cutFrame(session, item.part)) {
                    for (const auto& loop : frame->rim) points.insert(points.end(), loop.begin(), loop.end());
                    points.push_back(frame->centre + frame->reach * frame->normal);
                }
                break;
            case SelectionItem::Kind::Element:
                if (element != d.elements.end() && element->second->piece) {
                    seenElements.insert(item.part);
                } else if (element != d.elements.end()) {
                    const PosedBody body(session, item.part, *element->second);
                    withPlaces(body.posed, body.rest->vertices, [&](const auto& at) {
                        for (std::int32_t v = 0; v < body.rest->vertices.rows(); ++v) points.push_back(at(v).template cast<double>());
                    });
                }
                break;
            case SelectionItem::Kind::Face:
                if (const int face = element == d.elements.end() ? -1 : element->second->faceIndex(item.face); face >= 0) {
                    const PosedBody body(session, item.part, *element->second);
                    for (const std::int32_t v : element->second->faces[std::size_t(face)].vertices) points.push_back(body.at(v));
                }
                break;
            case SelectionItem::Kind::Bone:
                addEnd({item.part, false});
                addEnd({item.part, true});
                break;
            case SelectionItem::Kind::Endpoint: addEnd({item.part, item.atEnd}); break;
        }
    }
    if (seenWhole.empty() && seenElements.empty()) return points;
    for (const SeenMesh& seen : seenMeshes(session)) {
        const TriangleMesh& mesh = seen.model().mesh.body;
        const bool whole = seenWhole.contains(seen.source->id);
        std::vector<char> wanted;  // by what EmbeddedMesh::Vertex::element counts
        for (const PartId part : seen.elements) wanted.push_back(whole || seenElements.contains(part));
        if (std::ranges::find(wanted, 1) == wanted.end()) continue;
        std::vector<char> used(std::size_t(mesh.vertices.rows()), 0);  // a file may have vertices that nothing uses
        for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) used[std::size_t(mesh.triangles.data()[i])] = 1;
        for (std::size_t v = 0; v < used.size(); ++v)
            if (used[v] && wanted[seen.embedded ? std::size_t(seen.embedded->vertices[v].element) : 0]) points.push_back(seen.at(std::int32_t(v)));
    }
    return points;
}

render::Body* bodyOf(render::Scene& scene, const Element& element) {
    for (render::Body& body : scene.bodies)
        if (body.mesh == element.mesh) return &body;
    return nullptr;
}

}  // namespace imomushi
