// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/body_error.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "core/mesh/triangle_tree.h"
#include "core/reduction/element_response.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// Two balls of radius 0.8 about z = -0.6 and z = 0.6 in one: a wrap bridges the crease between them.
TriangleMesh peanut() {
    TriangleMesh mesh = shapes::sphere(1.0, 4).mesh;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        const double along = 0.6 * std::abs(mesh.vertices(v, 2)) / mesh.vertices.row(v).norm();
        mesh.vertices.row(v) *= (along + std::sqrt(along * along + 0.64 - 0.36)) / mesh.vertices.row(v).norm();
    }
    return mesh;
}

/// A document with one uncut character.
struct Made {
    Document document;
    const Element& element() const { return *document.elements.begin()->second; }
};
Made character(const TriangleMesh& seen, const BodySetting& setting) {
    auto body = std::make_shared<Body>(makeBody(seen, {}, setting, {}).value());
    auto model = std::make_shared<RenderModel>();
    model->mesh.body = seen;
    auto source = std::make_shared<CharacterSource>();
    source->id = 1;
    source->model = model;
    source->body = body;
    auto element = std::make_shared<Element>();
    element->id = 2;
    element->mesh = std::make_shared<ElementMesh>(ElementMesh{body->mesh, {}});
    element->piece = CharacterPiece{1, {}, nullptr};
    Made made;
    made.document.characters[1] = source;
    made.document.elements[2] = element;
    return made;
}

/// A response to two handles, and how it moves points on its surface.
struct Answer {
    ResponseInput input;
    ElementResponse response;

    explicit Answer(const std::shared_ptr<const ElementMesh>& mesh) {
        input.mesh = mesh;
        for (const double side : {-1.0, 1.0}) {
            const SurfacePoint place = nearestOnSurface(mesh->body, Vec3(0.45 * side, 0, 1.4 * side));
            input.faces.push_back(jointFaceByDisc(mesh->body, place.triangle, place.point, 0.3).value());
            input.faces.back().disc = SurfaceDisc{place.point, 0.3};
        }
        input.basis = BasisKind::Affine;
        input.solverMesh = parseSolverMesh("volume:1500").value();
        input.threads = 2;
        response = buildResponse(input, {}).value();
    }
    /// Of all vertices, #V x 3, when handle f moves by `shift` and turns by `turn` about `centre`.
    [[nodiscard]] Points moved(std::size_t f, const Vec3& shift, const Vec3& turn, const Vec3& centre) const {
        const JointFace& face = input.faces[f];
        Eigen::Matrix3d cross;
        cross << 0, -turn.z(), turn.y(), turn.z(), 0, -turn.x(), -turn.y(), turn.x(), 0;
        JointMap map;
        map.linear += face.frame.axes.transpose() * cross * face.frame.axes;
        map.shift = face.frame.axes.transpose() * (shift + cross * (face.frame.origin - centre));
        Eigen::VectorXd v = Eigen::VectorXd::Zero(response.columns());
        double lost = 0.0;
        response.bases[f].coefficients(map, face.size, v.data() + response.firstColumn[f], lost);
        const Eigen::VectorXd free = response.response * v;
        Points out = Points::Zero(input.mesh->body.vertices.rows(), 3);
        for (std::size_t i = 0; i < response.freeVertices.size(); ++i) out.row(response.freeVertices[i]) = free.segment<3>(3 * static_cast<Eigen::Index>(i)).transpose();
        for (const std::int32_t vertex : face.vertices)
            out.row(vertex) = (shift + cross * (input.mesh->body.vertices.row(vertex).transpose() - centre)).transpose();
        return out;
    }
};

}  // namespace

TEST_CASE("body error: what is stated of a wrap is the difference of its answers from the exact body's, within 1 / 1.5 and 4; of coarser ones it is not known, exact and mended bodies have none") {
    const TriangleMesh seen = peanut();
    const Made exact = character(seen, {BodyKind::Exact, 0.0}), wrapped = character(seen, {BodyKind::Wrapped, 0.03});
    CHECK(bodyError(exact.document, exact.element()) == 0.0);
    CHECK(bodyError(exact.document, Element()) == 0.0);
    const double stated = bodyError(wrapped.document, wrapped.element());
    const Answer truth(exact.element().mesh), found(wrapped.element().mesh);
    const TriangleMesh& wrap = wrapped.element().mesh->body;
    const TriangleTree tree(wrap);
    double sum = 0.0;
    int motions = 0;
    for (std::size_t f = 0; f < 2; ++f)
        for (int m = 0; m < 6; ++m, ++motions) {
            const Vec3 centre = truth.input.faces[f].disc->point;
            Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
            (m < 3 ? shift : turn)[m % 3] = 1.0;
            const Points a = truth.moved(f, shift, turn, centre), b = found.moved(f, shift, turn, centre);
            double apart = 0.0, size = 0.0, held = 0.0;
            for (const std::int32_t v : truth.response.freeVertices) {
                const Vec3 p = seen.vertices.row(v).transpose();
                const TriangleTree::Hit hit = tree.nearest(p);
                Vec3 u = Vec3::Zero();
                for (int c = 0; c < 3; ++c) u += hit.barycentric[c] * b.row(wrap.triangles(hit.triangle, c)).transpose();
                apart += (u - a.row(v).transpose()).squaredNorm();
                size += a.row(v).squaredNorm();
            }
            for (const std::int32_t v : truth.input.faces[f].vertices) held += a.row(v).squaredNorm();
            const auto free = static_cast<double>(truth.response.freeVertices.size());
            const auto all = static_cast<double>(truth.input.faces[0].vertices.size() + truth.input.faces[1].vertices.size());
            sum += (apart / free) / (size / free + held / all);
        }
    const double error = std::sqrt(sum / motions);
    MESSAGE("wrap: ", 100.0 * error, " %, stated ", 100.0 * stated, " %; tetrahedra state ", 100.0 * truth.response.quality.error, " %");
    CHECK(stated >= error / 1.5);
    CHECK(stated <= 4.0 * error);
    // A wrap of detail 0.05 answers wrong by 26 %, three times what its distance lets expect.
    const Made coarse = character(seen, {BodyKind::Wrapped, 0.05});
    CHECK(bodyError(coarse.document, coarse.element()) < 0.0);
    Made mended = wrapped;
    auto source = std::make_shared<CharacterSource>(*mended.document.characters.at(1));
    auto body = std::make_shared<Body>(*source->body);
    body->report.how = BodyKind::Mended;
    source->body = body;
    mended.document.characters[1] = source;
    CHECK(bodyError(mended.document, mended.element()) == 0.0);
}
