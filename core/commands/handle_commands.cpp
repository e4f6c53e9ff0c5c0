// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/handle_commands.h"

#include <algorithm>

#include "core/base/formatted.h"
#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/document/standing_places.h"
#include "core/mesh/bounds.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

/// A point this near to the surface lies on it, parts of the diagonal: as typed with few digits.
constexpr double kOnSurface = 1e-3;
constexpr double kLongestHandleGlide = 1e6;  // s

Json json(const Eigen::Quaterniond& turn) { return Json::array({turn.x(), turn.y(), turn.z(), turn.w()}); }
using imomushi::json;

Json faceJson(const JointFace& face) {
    return Json{{"vertices", face.vertices.size()}, {"triangles", face.triangles.size()}, {"frame", json(face.frame)}, {"planarity_error", face.planarityError},
                {"flat", face.flat()},              {"area", face.area},                  {"size", face.size}};
}

Result<std::optional<EndpointRef>> boneFrom(const Document& document, const std::string& path) {
    if (path.empty()) return std::optional<EndpointRef>();
    IMOMUSHI_TRY(const auto end, document.endpoint(path));
    return std::optional(end);
}

/// "handle 1", "handle 2", ...: the first that is free.
std::string freeHandleName(const Document& document, const Element& element, const std::string& stem = "handle") {
    for (int n = 1;; ++n) {
        std::string name = stem + " " + std::to_string(n);
        if (checkNewName(document, name) && element.faceIndex(name) < 0) return name;
    }
}

Result<double> radiusFrom(const Element& element, const Json& value) {
    return numberWithin(value, "radius", 0.0, kLargestHandleRadius * diagonalOf(element.mesh->body.vertices));
}

/// Nothing of the document moves it or holds it.
bool isFree(const Document& document, const Element& element) {
    return element.faces.empty() && std::none_of(document.bones.begin(), document.bones.end(), [&](const auto& bone) { return bone.second->element == element.id; });
}

/// Pins handles where an element stands, beside those that it has; where there is no room, as far from `handle` as can be. Their names.
std::vector<std::string> holdWhereItStands(Document& document, PartId id, const std::string& handle) {
    std::vector<std::string> names;
    const auto hold = [&](const StandingPlace& place) {
        const Element& element = *document.elements.at(id);
        auto face = handleFace(element, place.point, place.radius);
        if (!face) return;
        face->name = freeHandleName(document, element, "hold");
        HandleGoal goal;
        goal.pinned = goal.target.held = true;
        goal.target.at = face->frame.origin;
        document.handleGoals.insert_or_assign(FaceRef{id, face->name}, goal);
        names.push_back(face->name);
        exchangePart(document.elements, id, [&](Element& changed) {
            changed.handles.push_back({face->name, nearestOnSurface(changed.mesh->body, place.point).point, place.radius, {}});
            changed.faces.push_back(std::move(*face));
        });
    };
    const TriangleMesh& body = document.elements.at(id)->mesh->body;
    for (const StandingPlace& place : standingPlaces(body, kDefaultHandleRadius * diagonalOf(body.vertices))) hold(place);
    if (!names.empty()) return names;
    const Element& element = *document.elements.at(id);
    const Points& vertices = element.mesh->body.vertices;
    Eigen::Index far = 0;
    (vertices.rowwise() - faceOf(document, {id, handle}).frame.origin.transpose()).rowwise().squaredNorm().maxCoeff(&far);
    hold({vertices.row(far).transpose(), kDefaultHandleRadius * diagonalOf(vertices)});
    return names;
}

Result<Json> makeHandle(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto element, elementOf(document, text(arguments, "element")));
    std::string name;
    if (const Json* given = find(arguments, "name")) {
        name = given->get_ref<const std::string&>();
        if (auto ok = checkNewName(document, name); !ok) return tl::unexpected(ok.error());
        if (element->faceIndex(name) >= 0)
            return fail("name-taken", "The element \"" + element->name + "\" has a joint face \"" + name + "\" already: choose another name.");
    } else {
        name = freeHandleName(document, *element);
    }
    Handle handle;
    handle.face = name;
    handle.radius = kDefaultHandleRadius * diagonalOf(element->mesh->body.vertices);
    if (const Json* given = find(arguments, "radius")) {
        IMOMUSHI_TRY(handle.radius, radiusFrom(*element, *given));
    }
    if (const Json* given = find(arguments, "bone")) {
        IMOMUSHI_TRY(handle.bone, boneFrom(document, given->get_ref<const std::string&>()));
    }
    handle.point = *vector3(arguments.at("point"));
    IMOMUSHI_TRY(auto face, handleFace(*element, handle.point, handle.radius));
    handle.point = nearestOnSurface(element->mesh->body, handle.point).point;
    face.name = name;
    Json answer = faceJson(face);
    answer["name"] = name;
    answer["face"] = element->name + "/" + name;
    answer["radius"] = handle.radius;
    answer["handles"] = element->handles.size() + 1;
    const bool holds = arguments.value("hold", false) && isFree(document, *element);
    exchangePart(document.elements, element->id, [&](Element& changed) {
        changed.faces.push_back(std::move(face));
        changed.handles.push_back(std::move(handle));
    });
    if (arguments.contains("hold")) answer["held"] = holds ? holdWhereItStands(document, element->id, name) : std::vector<std::string>();
    return answer;
}

Result<Json> removeHandle(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto handle, handleNamed(document, text(arguments, "handle")));
    removeFace(document, handle);
    return Json::object();
}

/// What is known of where a handle is, or rest.
HandleGoal& goalOf(Document& document, const FaceRef& handle) {
    const auto [goal, added] = document.handleGoals.try_emplace(handle);
    if (added) goal->second.target.at = faceOf(document, handle).frame.origin;
    return goal->second;
}

/// A handle is let go where it is.
Result<void> leave(DocumentEdit& edit, const FaceRef& handle) {
    HandleGoal& goal = goalOf(edit.document, handle);
    IMOMUSHI_TRY(const auto left, edit.carried(handle, goal.now()));
    goal = {};
    goal.target = left;
    return {};
}

}  // namespace

Result<JointFace> handleFace(const Element& element, const Vec3& point, double radius, std::string_view instead) {
    const TriangleMesh& body = element.mesh->body;
    const SurfacePoint place = nearestOnSurface(body, point);
    if (place.distance > std::max(radius, kOnSurface * diagonalOf(body.vertices)))
        return fail("bad-point", formatted("The point is %.3g m away", place.distance) + " from the surface of \"" + element.name + "\" at rest: give one on it.");
    auto face = jointFaceByDisc(body, place.triangle, place.point, radius);
    if (!face) return face;
    std::vector<JointFace> others;
    for (const JointFace& other : element.faces)
        if (other.name != instead) others.push_back(other);
    if (const int other = overlappingFace(others, *face); other >= 0)
        return fail("shared-rim", "The handle would overlap \"" + others[static_cast<std::size_t>(other)].name +
                                      "\": choose a smaller radius or another place, one ring of free triangles must lie between them.");
    if (face->vertices.size() == static_cast<std::size_t>(body.vertices.rows()))
        return fail("no-free-vertex", "The handle would hold every vertex of the element: choose a smaller radius.");
    return face;
}

void eraseHandle(Document& document, const FaceRef& face) {
    document.handleGoals.erase(face);
    if (document.elements.at(face.element)->handleOf(face.face))
        exchangePart(document.elements, face.element, [&](Element& element) { std::erase_if(element.handles, [&](const Handle& h) { return h.face == face.face; }); });
}

void renameHandle(Document& document, const FaceRef& face, const std::string& name) {
    exchangePart(document.elements, face.element, [&](Element& element) {
        for (Handle& handle : element.handles)
            if (handle.face == face.face) handle.face = name;
    });
    if (auto goal = document.handleGoals.extract(face)) {
        goal.key().face = name;
        document.handleGoals.insert(std::move(goal));
    }
}

void releaseHandlesOf(Document& document, PartId bone) {
    std::vector<PartId> users;
    const auto hangs = [bone](const Handle& handle) { return handle.bone && handle.bone->bone == bone; };
    for (const auto& [id, element] : document.elements)
        if (std::any_of(element->handles.begin(), element->handles.end(), hangs)) users.push_back(id);
    for (const PartId id : users)
        exchangePart(document.elements, id, [&](Element& element) {
            for (Handle& handle : element.handles)
                if (hangs(handle)) handle.bone.reset();
        });
}

Result<void> setHandleProperty(Document& document, const FaceRef& handle, const std::string& property, const Json& value) {
    const Element& element = *document.elements.at(handle.element);
    Handle changed = *element.handleOf(handle.face);
    JointFace face = faceOf(document, handle);
    if (property == "radius" || property == "point") {
        if (property == "radius") {
            IMOMUSHI_TRY(changed.radius, radiusFrom(element, value));
        } else {
            const auto point = vector3(value);
            if (!point) return fail("bad-type", "\"point\" must be three numbers [x,y,z]: the middle of the handle on the surface at rest, metres.");
            changed.point = *point;
        }
        IMOMUSHI_TRY(auto made, handleFace(element, changed.point, changed.radius, handle.face));
        if (property == "point") changed.point = nearestOnSurface(element.mesh->body, changed.point).point;
        made.takeNameFrom(face);
        // Motions stay what they are; they are told by where the middle goes, which is another one now.
        const Vec3 step = made.frame.origin - face.frame.origin;
        if (const auto goal = document.handleGoals.find(handle); goal != document.handleGoals.end())
            for (HandlePose* pose : {&goal->second.target, &goal->second.from}) pose->at += pose->rotation * step;
        face = std::move(made);
    } else if (property == "bone") {
        if (!value.is_string()) return fail("bad-type", "\"bone\" must be a text: \"bone/start\" or \"bone/end\", or \"\" for none.");
        IMOMUSHI_TRY(changed.bone, boneFrom(document, value.get_ref<const std::string&>()));
    } else {
        return fail("no-such-property", "A handle has no property \"" + property + "\"; it has radius, point, bone, visible and locked.");
    }
    exchangePart(document.elements, handle.element, [&](Element& to) {
        to.faces[static_cast<std::size_t>(to.faceIndex(handle.face))] = std::move(face);
        for (Handle& h : to.handles)
            if (h.face == handle.face) h = changed;
    });
    return {};
}

Result<Json> dragHandle(DocumentEdit& edit, const FaceRef& handle, const Json& arguments) {
    if (arguments.contains("roll")) return fail("unknown-key", "\"roll\" goes with ends of bones; a handle is turned by \"rotation\".");
    IMOMUSHI_TRY(const auto shown, edit.poseOf(handle));
    HandleGoal made;
    made.target = shown;
    made.target.held = true;
    made.target.at = *vector3(arguments.at("to"));
    if (const Json* given = find(arguments, "rotation")) {
        IMOMUSHI_TRY(made.target.rotation, rotationFrom(*given, "rotation"));
    }
    if (auto ok = readNumber(arguments, "seconds", 0.0, kLongestHandleGlide, made.seconds); !ok) return tl::unexpected(ok.error());
    made.from = shown;
    HandleGoal& goal = goalOf(edit.document, handle);
    made.pinned = goal.pinned;
    goal = made;
    return Json::object();
}

Result<Json> showHandle(LiveCharacter& live, const FaceRef& handle) {
    const HandleGoal goal = live.document().handleGoals.at(handle);
    live.hidePositions();
    Json answer;
    if (goal.seconds > 0.0) answer["seconds"] = goal.seconds;
    IMOMUSHI_TRY(const auto solved, live.converge());
    IMOMUSHI_TRY(const auto now, live.poseOf(handle));
    answer["position"] = json(now.at);
    answer["rotation"] = json(now.rotation);
    answer["distance"] = (now.at - goal.target.at).norm();
    answer["settled"] = solved.converged && goal.seconds <= 0.0;
    answer["ms"] = solved.milliseconds;
    answer["warnings"] = live.warningTexts(solved.warnings);
    return answer;
}

Result<Json> pinHandle(DocumentEdit& edit, const FaceRef& handle) {
    IMOMUSHI_TRY(const auto shown, edit.poseOf(handle));
    HandleGoal& goal = goalOf(edit.document, handle);
    if (!goal.target.held) {
        goal = {};
        goal.target = shown;
    }
    goal.pinned = true;
    return Json::object();
}

Result<Json> unpinHandle(DocumentEdit& edit, const FaceRef& handle) {
    const auto goal = edit.document.handleGoals.find(handle);
    if (goal == edit.document.handleGoals.end() || !goal->second.pinned) return fail("not-pinned", "The handle \"" + handle.face + "\" is not pinned.");
    if (auto ok = leave(edit, handle); !ok) return tl::unexpected(ok.error());
    return Json::object();
}

Result<bool> releaseHandle(DocumentEdit& edit, const FaceRef& handle) {
    const auto goal = edit.document.handleGoals.find(handle);
    if (goal == edit.document.handleGoals.end() || !goal->second.target.held) return false;
    if (!goal->second.pinned) {
        if (auto ok = leave(edit, handle); !ok) return tl::unexpected(ok.error());
        return true;
    }
    // A pin that was dragged stays a pin, where it is now.
    HandleGoal pinned;
    pinned.pinned = true;
    pinned.target = goal->second.now();
    goal->second = pinned;
    return true;
}

void restHandles(Document& document) {
    std::erase_if(document.handleGoals, [](const auto& goal) { return !goal.second.pinned; });
    for (auto& [handle, goal] : document.handleGoals) {
        goal = {};
        goal.pinned = goal.target.held = true;
        goal.target.at = faceOf(document, handle).frame.origin;
    }
}

Json heldHandleJson(const FaceRef& handle, const HandleGoal& goal) {
    return Json{{"endpoint", handle.face}, {"pinned", goal.pinned}, {"to", json(goal.target.at)}, {"rotation", json(goal.target.rotation)}};
}

Json handleJson(const Document& document, const Element& element, const Handle& handle) {
    const JointFace& face = faceOf(document, {element.id, handle.face});
    return Json{{"name", handle.face},
                {"element", element.name},
                {"origin", json(face.frame.origin)},
                {"radius", handle.radius},
                {"vertices", face.vertices.size()},
                {"bone", handle.bone ? Json(endpointText(document, *handle.bone)) : Json()}};
}

void addHandleCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("handle",
                       "Makes a handle: a disc of an element's surface that is dragged, turned and pinned by itself. An element with handles needs no bone.",
                       {{"element", Type::Text, true, "The element."},
                        {"name", Type::Text, false, "A name that no element, bone or handle has (\"handle 1\", ...)."},
                        {"point", Type::Vector3, true, "Its middle on the surface at rest, metres."},
                        {"radius", Type::Number, false, "Metres along the surface, up to half of the element's diagonal (a twentieth of that); at least the triangles about a vertex."},
                        {"bone", Type::Text, false, "\"bone/start\" or \"bone/end\", with which it moves while it is not held (the element)."},
                        {"hold", Type::Boolean, false, "Where nothing moves or holds the element yet: pins it where it stands by handles of their own, so that this one bends it instead of carrying it (false)."}},
                       makeHandle);
    registry.addChange("remove-handle", "Removes a handle.", {{"handle", Type::Text, true, "The handle."}}, removeHandle);
}

}  // namespace imomushi
