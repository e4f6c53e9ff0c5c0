// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <chrono>
#include <set>

#include "core/base/decompositions.h"
#include "core/base/finite.h"
#include "core/commands/core_commands.h"
#include "core/document/body_error.h"
#include "core/document/command_support.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

/// Joint parameters beyond this (stretch, radians, metres) mean nothing in linear elasticity; squares stay far from overflow.
constexpr double kLargestParameter = 1e6;

/// The elements that "elements" names, or all.
Result<std::vector<PartId>> chosen(const Document& document, const Json& arguments) {
    std::vector<PartId> ids;
    if (const Json* names = find(arguments, "elements")) {
        for (const Json& name : *names) {
            if (!name.is_string()) return fail("bad-type", "\"elements\" must hold names of elements.");
            IMOMUSHI_TRY(const auto element, elementOf(document, name.get_ref<const std::string&>()));
            if (std::find(ids.begin(), ids.end(), element->id) == ids.end()) ids.push_back(element->id);
        }
    } else {
        for (const auto& [id, element] : document.elements) ids.push_back(id);
    }
    return ids;
}

Result<Json> estimate(SessionAccess& access, const Json& arguments, const Progress&) {
    const Session& session = access.session;
    IMOMUSHI_TRY(const auto ids, chosen(session.document(), arguments));
    Json list = Json::array();
    double seconds = 0.0, milliseconds = 0.0;
    std::size_t bytes = 0;
    std::set<PartId> needed;  // by others, itself not asked for
    for (const PartId id : ids) {
        const Element& element = *session.document().elements.at(id);
        const SharedResponse* shared = session.sharedResponse(id);
        const ResponseEstimate estimated = session.responseEstimate(id);
        Json line = {{"name", element.name},
                     {"vertices", element.mesh->body.vertices.rows()},
                     {"columns", estimated.columns},
                     {"seconds", estimated.seconds},
                     {"bytes", estimated.bytes},
                     {"ms_per_frame", estimated.frameMilliseconds}};
        if (shared) {
            line["shared"] = session.document().elements.at(shared->from)->name;
            if (shared->how->mirrored) line["mirrored"] = true;
            const bool known = session.responseState(shared->from) == ResponseState::Fresh;
            if (!known && std::find(ids.begin(), ids.end(), shared->from) == ids.end()) needed.insert(shared->from);
        }
        list.push_back(std::move(line));
        seconds += estimated.seconds;
        milliseconds += estimated.frameMilliseconds;
        bytes = std::max(bytes, estimated.bytes);
    }
    for (const PartId id : needed) {
        const ResponseEstimate estimated = session.responseEstimate(id);
        seconds += estimated.seconds;
        bytes = std::max(bytes, estimated.bytes);
    }
    return Json{{"elements", std::move(list)}, {"seconds", seconds}, {"peak_bytes", bytes}, {"ms_per_frame", milliseconds}};
}

Result<Json> precompute(SessionAccess& access, const Json& arguments, const Progress& progress) {
    const Document& document = access.document();
    DocumentResponses& responses = access.responses;
    IMOMUSHI_TRY(const auto ids, chosen(document, arguments));
    constexpr double kTogether = 0.9;
    const std::set<PartId> together = responses.computeTogether(ids, progress.part(0.0, kTogether));
    if (progress.cancelled()) return fail(kCancelled, "The precompute was cancelled.");
    Json list = Json::array();
    double done = kTogether;
    for (const PartId id : ids) {
        const Element& element = *document.elements.at(id);
        Json line;
        line["name"] = element.name;
        line["vertices"] = element.mesh->body.vertices.rows();
        const double next = done + (1.0 - kTogether) / static_cast<double>(ids.size());
        if (element.faces.empty()) {
            if (arguments.contains("elements"))
                return fail("no-face", "The element \"" + element.name + "\" has no joint face: add one, or leave it rigid.");
            line["columns"] = 0;
            line["note"] = "no joint face: the element follows its bone rigidly";
        } else {
            const bool solved = together.contains(id), cached = !solved && responses.freshOf(id) != nullptr;
            const auto start = std::chrono::steady_clock::now();
            IMOMUSHI_TRY(const auto fresh, responses.compute(id, progress.part(done, next)));
            const auto& response = fresh;
            const double seconds = cached ? 0.0 : solved ? response->quality.seconds : std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            line["columns"] = response->columns();
            line["seconds"] = seconds;
            line["bytes"] = response->bytes();
            line["residual"] = response->quality.solve.residual;
            if (response->quality.solve.rcond > 0.0) line["rcond"] = response->quality.solve.rcond;
            line["asymmetry"] = response->quality.asymmetry;
            line["negative_energy"] = response->quality.negativeEnergy;
            line["solver_vertices"] = response->quality.solverVertices;
            line["solver_nodes"] = response->quality.solverNodes;
            if (response->quality.tetrahedra > 0) line["tetrahedra"] = response->quality.tetrahedra;
            if (!response->quality.noFilling.empty()) line["note"] = response->quality.noFilling;
            if (response->quality.error >= 0.0) line["error"] = response->quality.error;
            const double ofBody = bodyError(document, element);
            if (ofBody < 0.0) line["body_error"] = nullptr;
            if (ofBody > 0.0) {
                line["body_error"] = ofBody;
                if (response->quality.error >= 0.0) line["error_sum"] = response->quality.error + response->quality.mappingError + ofBody;
            }
            if (response->quality.decimated) {
                line["mapping_error"] = response->quality.mappingError;
                line["shape_error"] = response->quality.shapeError;
            }
            if (const SharedResponse* shared = responses.sharedOf(id)) {
                line["shared"] = document.elements.at(shared->from)->name;
                if (shared->how->mirrored) line["mirrored"] = true;
            }
            line["cached"] = cached;
        }
        list.push_back(std::move(line));
        done = next;
    }
    if (auto alive = access.live.built(); !alive) return tl::unexpected(alive.error());
    access.changedResponses();
    access.changedPose();
    access.note(arguments);
    return Json{{"elements", std::move(list)}};
}

/// What deform-element asks of one face.
struct FaceRequest {
    bool given = false;
    bool byVertices = false;
    JointMap map;
    Points displacement;  ///< #vertices of the face x 3, world axes of the element at rest
};

Result<FaceRequest> parameters(const Json& value) {
    PaperParameters p;
    for (const auto& item : value.items()) {
        double* to = item.key() == "a" ? &p.a : item.key() == "b" ? &p.b : item.key() == "theta1" ? &p.theta1 : item.key() == "theta2" ? &p.theta2
                     : item.key() == "dz" ? &p.dz : nullptr;
        if (!to) return fail("unknown-key", "A face has no parameter \"" + item.key() + "\"; it has a, b, theta1, theta2, dz, or vertices alone.");
        IMOMUSHI_TRY(const auto number, numberWithin(item.value(), item.key(), -kLargestParameter, kLargestParameter));
        *to = number;
    }
    FaceRequest request;
    request.given = true;
    request.map = jointMap(p);
    return request;
}

Result<FaceRequest> displacements(const JointFace& face, const Json& value) {
    if (value.size() != 1 || !value.at("vertices").is_object())
        return fail("bad-type", "\"vertices\" of a face must be {index: [dx,dy,dz]} and stand alone.");
    FaceRequest request;
    request.given = request.byVertices = true;
    request.displacement = Points::Zero(static_cast<Eigen::Index>(face.vertices.size()), 3);
    std::set<std::int32_t> named;
    for (const auto& item : value.at("vertices").items()) {
        std::int32_t index = -1;
        const char* end = item.key().data() + item.key().size();
        const auto read = std::from_chars(item.key().data(), end, index);
        const auto at = std::lower_bound(face.vertices.begin(), face.vertices.end(), index);
        if (read.ec != std::errc() || read.ptr != end || at == face.vertices.end() || *at != index || !named.insert(index).second)
            return fail("bad-index", "\"" + item.key() + "\" is no vertex of the joint face \"" + face.name + "\" (counted from 0), or is named twice.");
        const auto d = vector3(item.value());
        if (!d || d->cwiseAbs().maxCoeff() > kLargestParameter)
            return fail("bad-type", "The displacement of vertex " + item.key() + " must be [dx,dy,dz] in metres, each within 1e6.");
        request.displacement.row(at - face.vertices.begin()) = d->transpose();
    }
    return request;
}

/// Displacement of the vertices of a face, #vertices x 3, rest axes of the element.
Points faceDisplacement(const TriangleMesh& body, const JointFace& face, const FaceRequest& request) {
    Points u = Points::Zero(static_cast<Eigen::Index>(face.vertices.size()), 3);
    if (!request.given) return u;
    if (request.byVertices) return request.displacement;
    for (std::size_t i = 0; i < face.vertices.size(); ++i) {
        const Vec3 p = face.frame.toLocal(body.vertices.row(face.vertices[i]).transpose());
        u.row(static_cast<Eigen::Index>(i)) = (face.frame.axes * (request.map.linear * p + request.map.shift - p)).transpose();
    }
    return u;
}

/// The joint parameters whose displacement of the face's vertices is nearest in the mean square.
Eigen::VectorXd project(const TriangleMesh& body, const JointFace& face, const FaceBasis& basis, const Points& displacement) {
    const Points rest = localVertices(body, face);
    Eigen::VectorXd u(3 * rest.rows());
    for (Eigen::Index i = 0; i < rest.rows(); ++i) u.segment(3 * i, 3) = face.frame.axes.transpose() * displacement.row(i).transpose();
    if (basis.kind == BasisKind::Full) return u;
    Eigen::MatrixXd C(3 * rest.rows(), basis.columns());
    for (Eigen::Index i = 0; i < rest.rows(); ++i) C.middleRows(3 * i, 3) = basis.at(rest.row(i).transpose());
    return leastSquares(C, u);
}

Result<Json> deform(SessionAccess& access, const Json& arguments, const Progress& progress) {
    const Document& document = access.document();
    IMOMUSHI_TRY(const auto found, elementOf(document, text(arguments, "element")));
    const Element& element = *found;
    const TriangleMesh& body = element.mesh->body;
    const std::string model = arguments.contains("model") ? text(arguments, "model") : "reduced";
    if (model != "reduced" && model != "full" && model != "previous")
        return fail("bad-value", "\"model\" must be \"reduced\", \"full\" or \"previous\".");
    if (element.faces.empty()) return fail("no-face", "The element \"" + element.name + "\" has no joint face to move: add one.");

    std::vector<FaceRequest> requests(element.faces.size());
    for (const auto& item : arguments.at("faces").items()) {
        const int index = element.faceIndex(item.key());
        if (index < 0) {
            const auto error = document.face(element.name + "/" + item.key());
            return tl::unexpected(error.error());
        }
        if (!item.value().is_object()) return fail("bad-type", "A face needs an object: {a, b, theta1, theta2, dz} or {vertices}.");
        const JointFace& face = element.faces[static_cast<std::size_t>(index)];
        IMOMUSHI_TRY(requests[static_cast<std::size_t>(index)], item.value().contains("vertices") ? displacements(face, item.value()) : parameters(item.value()));
    }

    Json answer;
    answer["model"] = model;
    Points positions;
    // A response of full basis is the full solution, for any displacement of the faces.
    if (model == "reduced" || document.settings.basis == BasisKind::Full) {
        const bool known = access.responses.freshOf(element.id) != nullptr;
        IMOMUSHI_TRY(const auto fresh, access.responses.compute(element.id, progress));
        if (!known) access.changedResponses();
        const auto& response = fresh;
        Eigen::VectorXd v = Eigen::VectorXd::Zero(response->columns());
        double lost = 0.0, worst = 0.0;
        for (std::size_t f = 0; f < element.faces.size(); ++f) {
            const JointFace& face = element.faces[f];
            const FaceBasis& basis = response->bases[f];
            auto part = v.segment(response->firstColumn[f], basis.columns());
            if (!requests[f].given) continue;
            if (requests[f].byVertices) {
                part = project(body, face, basis, requests[f].displacement);
            } else {
                double faceLost = 0.0;
                Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(basis.columns());
                basis.coefficients(requests[f].map, localVertices(body, face), face.size, coefficients.data(), faceLost);
                part = coefficients;
                lost = std::max(lost, faceLost);
            }
            const Points wanted = faceDisplacement(body, face, requests[f]);
            for (std::size_t i = 0; i < face.vertices.size(); ++i) {
                const Vec3 p = face.frame.toLocal(body.vertices.row(face.vertices[i]).transpose());
                worst = std::max(worst, (face.frame.axes * (basis.at(p, static_cast<int>(i)) * part) - wanted.row(static_cast<Eigen::Index>(i)).transpose()).norm());
            }
        }
        positions = deformElement(*element.mesh, element.faces, *response, v);
        answer["columns"] = response->columns();
        answer["basis_error"] = worst;
    } else {
        std::vector<Points> displacement;
        for (std::size_t f = 0; f < element.faces.size(); ++f) displacement.push_back(faceDisplacement(body, element.faces[f], requests[f]));
        IMOMUSHI_TRY(auto solved, solveFull(access.responses.inputOf(element.id), displacement, progress));
        positions = body.vertices + solved;
    }
    if (!allFinite(positions)) return fail("not-finite", "The deformation is not finite: use smaller displacements.");
    answer["vertices"] = positions.rows();
    answer["max_displacement"] = (positions - body.vertices).rowwise().norm().maxCoeff();
    access.live.showPositions(element.id, std::move(positions));
    return answer;
}

}  // namespace

void addSolveCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey elements{"elements", Type::Array, false, "Names of elements (all unless given)."};
    registry.addAction("estimate", "What a precompute will cost on this machine: seconds, bytes, milliseconds per frame.", {elements}, estimate);
    registry.addAction("precompute", "Solves the elements for their joint faces; what is known already is not solved again.", {elements}, precompute);
    registry.addAction("deform-element",
                       "Statics of one element alone in its own rest frame. write-mesh \"current\" writes the result until the next drag, step or rest.",
                       {{"element", Type::Text, true, "The element."},
                        {"faces", Type::Object, true,
                         "{face: {a, b, theta1, theta2, dz}} as in eq. (5), or {face: {\"vertices\": {index: [dx,dy,dz]}}}; what is not named is at rest."},
                        {"model", Type::Text, false, "\"reduced\" (unless given; precomputes the element where that is missing), \"full\" or \"previous\" (the statics of full)."}},
                       deform);
}

}  // namespace imomushi
