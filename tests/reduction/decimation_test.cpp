// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stop_token>
#include <string>

#include "core/mesh/cgal/intersections.h"
#include "core/mesh/health.h"
#include "core/mesh/topology.h"
#include "core/meshing/decimation.h"
#include "tests/reduction/faces.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

int euler(const TriangleMesh& mesh) {
    return static_cast<int>(mesh.vertices.rows()) - EdgeTable(mesh.triangles).size() + static_cast<int>(mesh.triangles.rows());
}

double worstQuality(const TriangleMesh& mesh) {
    double worst = 1.0;
    for (std::int32_t t = 0; t < mesh.triangles.rows(); ++t) {
        double squares = 0.0;
        for (int c = 0; c < 3; ++c) squares += (mesh.vertices.row(mesh.triangles(t, c)) - mesh.vertices.row(mesh.triangles(t, (c + 1) % 3))).squaredNorm();
        worst = std::min(worst, 2.0 * std::sqrt(3.0) * areaVector(mesh, t).norm() / squares);
    }
    return worst;
}

double patchArea(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles) {
    double area = 0.0;
    for (const auto t : triangles) area += 0.5 * areaVector(mesh, t).norm();
    return area;
}

/// What every decimated body must be.
void checkDecimated(const shapes::Body& body, const std::vector<JointFace>& faces, const DecimatedBody& small) {
    const MeshFacts before = meshFacts(body.mesh), after = meshFacts(small.mesh);
    CHECK(after.closed);
    CHECK(after.outward);
    CHECK(after.components == before.components);
    CHECK(euler(small.mesh) == euler(body.mesh));
    CHECK(selfIntersections(small.mesh, 1).empty());
    CHECK(small.volumeError == doctest::Approx(after.volume / before.volume - 1.0).epsilon(1e-12));
    for (std::size_t v = 0; v < small.bodyVertex.size(); ++v)
        if (small.bodyVertex[v] >= 0) CHECK(small.mesh.vertices.row(static_cast<int>(v)) == body.mesh.vertices.row(small.bodyVertex[v]));
    REQUIRE(small.faces.size() == faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const JointFace& face = small.faces[f];
        for (const auto v : face.vertices) {
            CHECK(small.bodyVertex[static_cast<std::size_t>(v)] >= 0);
            CHECK(std::binary_search(faces[f].vertices.begin(), faces[f].vertices.end(), small.bodyVertex[static_cast<std::size_t>(v)]));
        }
        CHECK(patchArea(small.mesh, face.triangles) == doctest::Approx(faces[f].area).epsilon(1e-9));
        // The face's vertices name the face's triangles, and no others.
        CHECK(jointFaceByVertices(small.mesh, face.vertices).value().triangles == face.triangles);
    }
}

}  // namespace

namespace {

/// A ball with a ball-shaped cavity: the wall is as thick as the difference of the radii.
shapes::Body hollowBall(double outer, double inner, int levels) {
    const shapes::Body out = shapes::sphere(outer, levels), in = shapes::inverted(shapes::sphere(inner, levels));
    shapes::Body body = out;
    const auto n = static_cast<std::int32_t>(out.mesh.vertices.rows());
    body.mesh.vertices.conservativeResize(2 * n, 3);
    body.mesh.vertices.bottomRows(n) = in.mesh.vertices;
    body.mesh.triangles.conservativeResize(2 * out.mesh.triangles.rows(), 3);
    body.mesh.triangles.bottomRows(out.mesh.triangles.rows()) = in.mesh.triangles.array() + n;
    return body;
}

}  // namespace

TEST_CASE("decimated body: closed, outward, of the same topology and volume, free of intersections, its faces covered exactly") {
    const struct {
        const char* name;
        shapes::Body body;
        double volume;  // relative error at a twentieth of the vertices
    } cases[] = {
        // Collapsing keeps the volume but where a sharp edge loses its last vertices: about (edge / size)^3 there.
        {"bar", shapes::bar(24), 2e-3},
        {"cylinder", shapes::cylinder(0.5, 2.0, 60, 60), 2e-3},
        {"torus", shapes::torus(1.0, 0.3, 100, 40), 2e-3},
        {"sphere", shapes::sphere(1.0, 5), 1e-9},
        {"hollow ball", hollowBall(1.0, 0.8, 5), 1e-9},
        {"plate", shapes::box(Vec3(0, 0, 0), Vec3(1, 0.02, 1), 40, 2, 40), 2e-2},
    };
    for (const auto& [name, body, volume] : cases) {
        const auto faces = facesOf(body);
        for (const double share : {0.5, 0.1, 0.05}) {
            const auto wanted = static_cast<int>(share * static_cast<double>(body.mesh.vertices.rows()));
            const auto small = decimate(body.mesh, faces, wanted, {});
            REQUIRE_MESSAGE(small, name);
            CHECK(small->mesh.vertices.rows() == wanted);
            checkDecimated(body, faces, *small);
            CHECK_MESSAGE(std::abs(small->volumeError) <= volume, name);
            CHECK_MESSAGE(worstQuality(small->mesh) >= std::min(0.2, worstQuality(body.mesh)) * (1.0 - 1e-9), name);
        }
    }
}

TEST_CASE("decimated body: any bent, stretched and roughened body, decimated to any number, is what it must be or says why not") {
    CHECK(rc::check([] {
        const int kind = *rc::gen::inRange(0, 5), n = *rc::gen::inRange(6, 14);
        shapes::Body body = kind == 0   ? shapes::bar(n / 2)
                            : kind == 1 ? shapes::cylinder(0.5, 2.0, 2 * n, n)
                            : kind == 2 ? shapes::torus(1.0, 0.3, 3 * n, n)
                            : kind == 3 ? hollowBall(1.0, 0.7, 3)
                                        : shapes::sphere(1.0, 3);
        const double bend = 0.01 * *rc::gen::inRange(0, 100), wave = 0.001 * *rc::gen::inRange(0, 30);
        const double flat = std::pow(10.0, -0.1 * *rc::gen::inRange(0, 20));
        const double top = body.mesh.vertices.col(2).maxCoeff();
        for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v) {
            Vec3 p = body.mesh.vertices.row(v);
            p.y() *= flat;
            p.z() += wave * std::sin(20.0 * p.x()) * std::min({1.0, 10.0 * std::abs(p.z()), 10.0 * std::abs(top - p.z())});
            if (body.ends.empty()) p.x() += bend * p.z() * p.z();  // ends stay flat
            body.mesh.vertices.row(v) = p.transpose();
        }
        const auto faces = facesOf(body);
        const int own = static_cast<int>(body.mesh.vertices.rows()), wanted = *rc::gen::inRange(4, own + 1);
        const auto small = decimate(body.mesh, faces, wanted, {});
        if (!small) {
            RC_ASSERT(small.error().code == "too-few-vertices");
            RC_ASSERT(wanted < own / 2);
            return;
        }
        RC_ASSERT(small->mesh.vertices.rows() >= wanted);
        RC_ASSERT(static_cast<double>(small->mesh.vertices.rows()) <= 1.1 * wanted);
        checkDecimated(body, faces, *small);
    }));
}

TEST_CASE("decimated body: the same wherever it is and however large") {
    const shapes::Body body = shapes::cylinder(0.5, 2.0, 24, 24);
    const auto small = decimate(body.mesh, facesOf(body), 200, {}).value();
    for (const double size : {1e-6, 1.0, 1e6}) {
        const shapes::Body other = shapes::moved(body, size * Eigen::Matrix3d::Identity(), Vec3(size, -2.0 * size, 1000.0 * size));
        const auto faces = facesOf(other);
        const auto moved = decimate(other.mesh, faces, 200, {});
        REQUIRE(moved);
        CHECK(moved->mesh.vertices.rows() == 200);
        checkDecimated(other, faces, *moved);
        CHECK(std::abs(moved->volumeError - small.volumeError) <= 1e-3);
    }
}

TEST_CASE("decimated body: the same bytes every time") {
    const shapes::Body body = shapes::torus(1.0, 0.3, 60, 30);
    const auto one = decimate(body.mesh, {}, 300, {}).value(), two = decimate(body.mesh, {}, 300, {}).value();
    CHECK(one.mesh.vertices == two.mesh.vertices);
    CHECK(one.mesh.triangles == two.mesh.triangles);
    CHECK(one.bodyVertex == two.bodyVertex);
}

TEST_CASE("decimated body: thin walls keep their sides apart") {
    // With 100 vertices each, balls of radius 1 have edges of about 0.4, whose middles lie 0.02 below the vertices: as far as this wall is thick.
    // With 1000 each it is 0.002.
    const shapes::Body ball = hollowBall(1.0, 0.98, 4);
    const auto coarse = decimate(ball.mesh, {}, 200, {});
    REQUIRE(!coarse);
    CHECK(coarse.error().code == "too-few-vertices");
    const auto fine = decimate(ball.mesh, {}, 2000, {});
    REQUIRE(fine);
    checkDecimated(ball, {}, *fine);
    const shapes::Body plate = shapes::box(Vec3(0, 0, 0), Vec3(1, 0.001, 1), 30, 1, 30);
    const auto faces = facesOf(plate);
    const auto thin = decimate(plate.mesh, faces, 300, {});
    REQUIRE(thin);
    checkDecimated(plate, faces, *thin);
}

TEST_CASE("decimated body: a round rim stays, and what cannot be reached is said") {
    const shapes::Body body = shapes::cylinder(0.5, 2.0, 60, 20);
    const auto faces = facesOf(body);
    const auto small = decimate(body.mesh, faces, 60, {});  // the two rims alone have 120
    REQUIRE(!small);
    CHECK(small.error().code == "too-few-vertices");
    const std::string& text = small.error().message;
    const auto place = text.rfind("decimated:");
    REQUIRE(place != std::string::npos);
    const int smallest = std::stoi(text.substr(place + 10));
    CHECK(smallest > 120);
    const auto reached = decimate(body.mesh, faces, smallest, {});
    REQUIRE(reached);
    checkDecimated(body, faces, *reached);
}

TEST_CASE("decimated body: bad input is refused with a reason") {
    const shapes::Body body = shapes::sphere(1.0, 2);
    CHECK(decimate(body.mesh, {}, 3, {}).error().code == "bad-value");
    CHECK(decimate(body.mesh, {}, 1000, {}).error().code == "too-many-vertices");
    TriangleMesh open = body.mesh;
    open.triangles.conservativeResize(open.triangles.rows() - 1, 3);
    CHECK(decimate(open, {}, 20, {}).error().code == "not-closed");
    TriangleMesh flipped = body.mesh;
    std::swap(flipped.triangles(0, 0), flipped.triangles(0, 1));
    CHECK(decimate(flipped, {}, 20, {}).error().code == "not-closed");
    TriangleMesh wild = body.mesh;
    wild.triangles(3, 1) = 100000;
    CHECK(decimate(wild, {}, 20, {}).error().code == "bad-value");
    TriangleMesh nan = body.mesh;
    nan.vertices(5, 1) = std::numeric_limits<double>::quiet_NaN();
    CHECK(decimate(nan, {}, 20, {}).error().code == "bad-value");
    nan.vertices(5, 1) = std::numeric_limits<double>::infinity();
    CHECK(decimate(nan, {}, 20, {}).error().code == "bad-value");
    const shapes::Body crossing = hollowBall(1.0, 1.0 + 1e-3, 3);  // the inner shell lies outside in places: they cross
    shapes::Body shifted = crossing;
    const auto half = shifted.mesh.vertices.rows() / 2;
    shifted.mesh.vertices.bottomRows(half).col(0).array() += 0.5;
    CHECK(decimate(shifted.mesh, {}, 100, {}).error().code == "self-intersecting");
    std::stop_source stop;
    stop.request_stop();
    CHECK(decimate(body.mesh, {}, 20, Progress({}, stop.get_token())).error().code == kCancelled);
}
