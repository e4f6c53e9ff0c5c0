// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/joints/seam.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"
#include "core/mesh/write_mesh.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

std::vector<PartId> elementsOf(const Document& document, const std::shared_ptr<const Element>& only) {
    if (only) return {only->id};
    std::vector<PartId> ids;
    for (const auto& [id, element] : document.elements) ids.push_back(id);
    return ids;
}

/// The largest value of `figure` over all pairs of joined faces (of `only`, where given).
double largestAtSeams(Session& session, const std::shared_ptr<const Element>& only,
                      const std::function<double(const FaceOnBody&, const Points&, const FaceOnBody&, const Points&)>& figure) {
    double largest = 0.0;
    const auto on = [&](const FaceRef& ref) {
        const Element& element = *session.document().elements.at(ref.element);
        return FaceOnBody{&element.mesh->body, &element.faces[static_cast<std::size_t>(element.faceIndex(ref.face))]};
    };
    for (const auto& [id, joint] : session.document().joints)
        for (std::size_t i = 0; i < joint->faces.size(); ++i)
            for (std::size_t k = i + 1; k < joint->faces.size(); ++k) {
                const FaceRef &a = joint->faces[i], &b = joint->faces[k];
                if (only && a.element != only->id && b.element != only->id) continue;
                largest = std::max(largest, figure(on(a), session.positionsOf(a.element), on(b), session.positionsOf(b.element)));
            }
    return largest;
}

/// The largest distance of render vertices that are at one place at rest (of vertices of `only`, where given), m.
double largestRenderGap(SessionAccess& access, const std::shared_ptr<const Element>& only) {
    double largest = 0.0;
    for (const auto& [id, character] : access.document().characters) {
        if (only && !(only->piece && only->piece->character == id)) continue;
        const Points& rest = character->model->mesh.body.vertices;
        const auto first = weldExact(rest, std::vector<char>(static_cast<std::size_t>(rest.rows()), 1), {});
        const Points now = access.session.renderPositionsOf(id);
        for (std::size_t v = 0; v < first.size(); ++v)
            if (first[v] != static_cast<std::int32_t>(v)) largest = std::max(largest, (now.row(first[v]) - now.row(static_cast<Eigen::Index>(v))).norm());
    }
    return largest;
}

Result<Json> measure(SessionAccess& access, const Json& arguments, const Progress&) {
    Session& session = access.session;
    const std::string& what = text(arguments, "what");
    std::shared_ptr<const Element> element;
    if (const Json* name = find(arguments, "element")) {
        IMOMUSHI_TRY(element, elementOf(session.document(), name->get_ref<const std::string&>()));
    }
    const auto needs = [&](const char* key) { return fail("missing-key", "To measure \"" + what + "\", \"measure\" needs the key \"" + key + "\"."); };
    if (what != "stiffness")
        if (auto alive = session.builtCharacter(); !alive) return tl::unexpected(alive.error());

    Json answer;
    if (what == "volume" || what == "area") {
        double sum = 0.0;
        for (const PartId id : elementsOf(session.document(), element)) {
            const Triangles& triangles = session.document().elements.at(id)->mesh->body.triangles;
            const Points points = session.positionsOf(id);
            if (what == "volume") {
                sum += enclosedVolume(points, triangles);
                continue;
            }
            for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
                const Vec3 a = points.row(triangles(t, 0)).transpose();
                const Vec3 b = points.row(triangles(t, 1)).transpose();
                const Vec3 c = points.row(triangles(t, 2)).transpose();
                sum += 0.5 * (b - a).cross(c - a).norm();
            }
        }
        answer["value"] = sum;
    } else if (what == "gap") {
        const double gap = largestAtSeams(session, element, [](const FaceOnBody& a, const Points& atA, const FaceOnBody& b, const Points& atB) {
            return seamGap(seamPoints(a, b), *a.body, atA, *b.body, atB);
        });
        answer["value"] = std::max(gap, largestRenderGap(access, element));
    } else if (what == "crease") {
        answer["value"] = largestAtSeams(session, element, seamCrease);
    } else if (what == "stiffness") {
        if (!element) return needs("element");
        const auto response = session.response(element->id);
        if (!response) return fail("not-precomputed", "The element \"" + element->name + "\" has no fresh response: run precompute first.");
        Json rows = Json::array();
        for (Eigen::Index i = 0; i < response->stiffness.rows(); ++i) {
            Json values = Json::array();
            for (Eigen::Index k = 0; k < response->stiffness.cols(); ++k) values.push_back(element->stiffness * response->stiffness(i, k));
            rows.push_back(std::move(values));
        }
        Json faces = Json::array();
        for (std::size_t f = 0; f < element->faces.size(); ++f)
            faces.push_back({{"name", element->faces[f].name}, {"first_column", response->firstColumn[f]}, {"columns", response->bases[f].columns()}});
        answer["value"] = std::move(rows);
        answer["faces"] = std::move(faces);
    } else if (what == "bounds") {
        Vec3 low = Vec3::Zero(), high = Vec3::Zero();
        bool first = true;
        for (const PartId id : elementsOf(session.document(), element)) {
            const Points points = session.positionsOf(id);
            const Vec3 l = points.colwise().minCoeff().transpose(), h = points.colwise().maxCoeff().transpose();
            low = first ? l : low.cwiseMin(l);
            high = first ? h : high.cwiseMax(h);
            first = false;
        }
        answer["value"] = {{"low", json(low)}, {"high", json(high)}};
    } else if (what == "position") {
        if (!arguments.contains("endpoint")) return needs("endpoint");
        if (const auto handle = session.document().handle(text(arguments, "endpoint"))) {
            IMOMUSHI_TRY(const auto pose, session.poseOf(*handle));
            answer["value"] = json(pose.at);
            return answer;
        }
        IMOMUSHI_TRY(const auto end, session.document().endpoint(text(arguments, "endpoint")));
        IMOMUSHI_TRY(const auto position, session.positionOf(end));
        answer["value"] = json(position);
    } else if (what == "length") {
        if (!arguments.contains("bone")) return needs("bone");
        IMOMUSHI_TRY(const auto bone, boneOf(session.document(), text(arguments, "bone")));
        const auto start = session.positionOf({bone->id, false}), end = session.positionOf({bone->id, true});
        if (!start || !end) return tl::unexpected((start ? end : start).error());
        answer["value"] = (*end - *start).norm();
    } else {
        return fail("bad-value", "\"" + what + "\" cannot be measured: choose volume, area, gap, crease, stiffness, bounds, position or length.");
    }
    return answer;
}

Result<Json> writeMeshCommand(SessionAccess& access, const Json& arguments, const Progress&) {
    Session& session = access.session;
    std::shared_ptr<const Element> element;
    if (const Json* name = find(arguments, "element")) {
        IMOMUSHI_TRY(element, elementOf(session.document(), name->get_ref<const std::string&>()));
    }
    const std::string state = arguments.contains("state") ? text(arguments, "state") : "current";
    if (state != "rest" && state != "current") return fail("bad-value", "\"state\" must be \"rest\" or \"current\".");
    if (state == "current")
        if (auto alive = session.builtCharacter(); !alive) return tl::unexpected(alive.error());
    if (const Json* name = find(arguments, "character")) {
        if (element) return fail("unknown-key", "\"write-mesh\" takes either \"element\" or \"character\".");
        IMOMUSHI_TRY(const auto character, characterOf(session.document(), name->get_ref<const std::string&>()));
        const TriangleMesh& model = character->model->mesh.body;
        const Points vertices = state == "rest" ? model.vertices : session.renderPositionsOf(character->id);
        if (auto written = writeMesh(text(arguments, "path"), vertices, model.triangles); !written) return tl::unexpected(written.error());
        return Json{{"vertices", model.vertices.rows()}, {"triangles", model.triangles.rows()}};
    }
    const auto ids = elementsOf(session.document(), element);
    if (ids.empty()) return fail("no-element", "There is no element to write: import one first.");
    Eigen::Index vertexCount = 0, triangleCount = 0;
    for (const PartId id : ids) {
        vertexCount += session.document().elements.at(id)->mesh->body.vertices.rows();
        triangleCount += session.document().elements.at(id)->mesh->body.triangles.rows();
    }
    Points vertices(vertexCount, 3);
    Triangles triangles(triangleCount, 3);
    Eigen::Index v = 0, t = 0;
    for (const PartId id : ids) {
        const TriangleMesh& body = session.document().elements.at(id)->mesh->body;
        vertices.middleRows(v, body.vertices.rows()) = state == "rest" ? body.vertices : session.positionsOf(id);
        triangles.middleRows(t, body.triangles.rows()) = body.triangles.array() + static_cast<std::int32_t>(v);
        v += body.vertices.rows();
        t += body.triangles.rows();
    }
    if (auto written = writeMesh(text(arguments, "path"), vertices, triangles); !written) return tl::unexpected(written.error());
    return Json{{"vertices", vertexCount}, {"triangles", triangleCount}};
}

}  // namespace

void addMeasureCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("measure",
                       "Measures the character as it is now: \"volume\" (m^3) and \"area\" (m^2) of an element or of all; \"gap\" (largest distance between "
                       "joined faces, and between render vertices that are at one place at rest, m); \"crease\" (largest normal jump at a seam, radians); \"stiffness\" (K of an element, rows of numbers: faces by "
                       "creation, columns as in eq. (5), then the rest of the basis); \"bounds\" (low and high corner, m); \"position\" of an endpoint (m); "
                       "\"length\" of a bone (m).",
                       {{"what", Type::Text, true, "One of the names above."},
                        {"element", Type::Text, false, "The element (all unless given)."},
                        {"endpoint", Type::Text, false, "For position: \"bone/start\" or \"bone/end\"."},
                        {"bone", Type::Text, false, "For length: the bone."}},
                       measure);
    registry.addAction("write-mesh",
                       "Writes body vertices in their order, double precision, metres. Without an element all elements one after the other. With a character its own mesh, in the "
                       "order of its file.",
                       {{"path", Type::Text, true, "A file that ends in .obj or .ply."},
                        {"element", Type::Text, false, "The element (all unless given)."},
                        {"character", Type::Text, false, "The character whose render mesh is meant."},
                        {"state", Type::Text, false, "\"rest\" or \"current\" (unless given)."}},
                       writeMeshCommand);
}

}  // namespace imomushi
