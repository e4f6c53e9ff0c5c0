// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/kernels.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

using Corners = std::array<Vec3, 3>;

/// Gauss points on (0, 1), ten of them.
constexpr std::array<double, 5> kNode{0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845, 0.9739065285171717};
constexpr std::array<double, 5> kWeight{0.2955242247147529, 0.2692667193099964, 0.2190863625159820, 0.1494513491505806, 0.0666713443086881};

struct Sums {
    TriangleIntegrals in;
    Sums() {
        in.kelvin.setZero();
        for (auto& m : in.kelvinLinear) m.setZero();
    }
};

/// Adds quadrature over `part` of the integrands of `whole`, halving towards x until the parts are smaller than their distance.
void integrate(const Vec3& x, const Corners& whole, const Corners& part, int depth, Sums& sums) {
    const Vec3 middle = (part[0] + part[1] + part[2]) / 3.0;
    double radius = 0.0, distance = (middle - x).norm();
    for (const Vec3& p : part) radius = std::max(radius, (p - middle).norm());
    if (distance < 3.0 * radius) {
        if (depth == 0) return;  // its share, of the order of its size, is below the bounds of the tests
        const Corners m{0.5 * (part[0] + part[1]), 0.5 * (part[1] + part[2]), 0.5 * (part[2] + part[0])};
        integrate(x, whole, {part[0], m[0], m[2]}, depth - 1, sums);
        integrate(x, whole, {m[0], part[1], m[1]}, depth - 1, sums);
        integrate(x, whole, {m[2], m[1], part[2]}, depth - 1, sums);
        integrate(x, whole, m, depth - 1, sums);
        return;
    }
    const Vec3 areaNormal = (whole[1] - whole[0]).cross(whole[2] - whole[0]);
    const Vec3 n = areaNormal.normalized();
    double w = -(whole[0] - x).dot(n);
    if (std::abs(w) < 1e-14) w = 0.0;  // in the plane but for rounding, which R^-3 would blow up
    const double jacobian = (part[1] - part[0]).cross(part[2] - part[0]).norm();
    const auto node = [](int i) { return i < 5 ? 0.5 * (1.0 - kNode[static_cast<std::size_t>(i)]) : 0.5 * (1.0 + kNode[static_cast<std::size_t>(i - 5)]); };
    for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 10; ++j) {
            const double s = node(i), t = node(j);
            const double weight = 0.25 * kWeight[static_cast<std::size_t>(i % 5)] * kWeight[static_cast<std::size_t>(j % 5)] * s * jacobian;
            const Vec3 y = part[0] + s * (part[1] - part[0]) + s * t * (part[2] - part[1]);
            const Vec3 r = y - x;
            const double R = r.norm();
            Vec3 hat;
            for (int a = 0; a < 3; ++a)
                hat[a] = (whole[static_cast<std::size_t>((a + 1) % 3)] - y).cross(whole[static_cast<std::size_t>((a + 2) % 3)] - y).dot(n) /
                         areaNormal.norm();
            const double dipole = w / (R * R * R);
            sums.in.solidAngle += weight * dipole;
            sums.in.doubleLayer += weight * dipole * hat;
            for (std::size_t e = 0; e < 3; ++e) {
                const auto a = static_cast<Eigen::Index>(e), b = static_cast<Eigen::Index>((e + 1) % 3);
                sums.in.doubleLayerBubble[a] += weight * dipole * 4.0 * hat[a] * hat[b];
            }
            sums.in.singleLayerGradient += weight / R * r;
            sums.in.singleLayer += weight / R;
            sums.in.kelvin += weight / (R * R * R) * r * r.transpose();
            sums.in.singleLayerLinear += weight / R * hat;
            for (std::size_t a = 0; a < 3; ++a)
                sums.in.kelvinLinear[a] += weight * hat[static_cast<Eigen::Index>(a)] / (R * R * R) * r * r.transpose();
        }
}

/// `steep`: how large the hat functions grow where x is projected to; products of two of them cancel for the bubbles.
void checkClose(const TriangleIntegrals& a, const TriangleIntegrals& b, double length, double bound, double steep) {
    CHECK(std::abs(a.solidAngle - b.solidAngle) <= bound);
    CHECK((a.doubleLayer - b.doubleLayer).cwiseAbs().maxCoeff() <= bound);
    CHECK((a.doubleLayerBubble - b.doubleLayerBubble).cwiseAbs().maxCoeff() <= bound + 1e-15 * steep * steep);
    CHECK((a.singleLayerGradient - b.singleLayerGradient).cwiseAbs().maxCoeff() <= bound * length * length);
    CHECK(std::abs(a.singleLayer - b.singleLayer) <= bound * length);
    CHECK((a.kelvin - b.kelvin).cwiseAbs().maxCoeff() <= bound * length);
    CHECK((a.singleLayerLinear - b.singleLayerLinear).cwiseAbs().maxCoeff() <= bound * length);
    for (std::size_t c = 0; c < 3; ++c) CHECK((a.kelvinLinear[c] - b.kelvinLinear[c]).cwiseAbs().maxCoeff() <= bound * length);
}

const Corners kTriangle{Vec3(0.1, -0.2, 0.3), Vec3(1.2, 0.1, 0.2), Vec3(0.4, 0.9, -0.1)};
const Corners kSliver{Vec3(0.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0), Vec3(0.3, 0.03, 0.0)};

}  // namespace

TEST_CASE("kernels: closed forms agree with quadrature, also where x is near, on a corner, inside an edge or in line with it") {
    for (const Corners& corners : {kTriangle, kSliver}) {
        const Vec3 n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
        const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        const struct {
            const char* what;
            Vec3 x;
        } cases[] = {{"generic", Vec3(0.7, -0.8, 0.9)},
                     {"far", Vec3(20.0, -31.0, 17.0)},
                     {"above", middle + 0.5 * n},
                     {"below", middle - 0.5 * n},
                     {"just above", middle + 0.01 * n},
                     {"just below, near an edge", 0.5 * (corners[0] + corners[1]) - 0.01 * n},
                     {"in the plane, outside", 2.0 * corners[2] - middle},
                     {"in line with an edge", corners[0] + 1.7 * (corners[1] - corners[0])},
                     {"in line with an edge, other side", corners[0] - 0.4 * (corners[1] - corners[0])},
                     {"above a corner", corners[1] + 0.01 * n},
                     {"on corner 0", corners[0]},
                     {"on corner 1", corners[1]},
                     {"on corner 2", corners[2]},
                     {"in the middle of an edge", 0.5 * (corners[0] + corners[1])},
                     {"inside an edge", 0.7 * corners[1] + 0.3 * corners[2]}};
        for (const auto& [what, x] : cases) {
            CAPTURE(what);
            Sums sums;
            integrate(x, corners, corners, 42, sums);
            double longest = 0.0;
            for (std::size_t c = 0; c < 3; ++c) longest = std::max(longest, (corners[c] - corners[(c + 1) % 3]).norm());
            const double height = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / longest;
            checkClose(triangleIntegrals(x, corners), sums.in, 1.0, 1e-11, (x - middle).norm() / height);
        }
    }
}

TEST_CASE("kernels: over a closed surface the solid angle is -4 pi inside and 0 outside") {
    const auto body = shapes::torus(2.0, 0.5, 24, 12);
    const auto sum = [&](const Vec3& x) {
        double out = 0.0;
        for (Eigen::Index f = 0; f < body.mesh.triangles.rows(); ++f)
            out += triangleIntegrals(x, {body.mesh.vertices.row(body.mesh.triangles(f, 0)).transpose(),
                                         body.mesh.vertices.row(body.mesh.triangles(f, 1)).transpose(),
                                         body.mesh.vertices.row(body.mesh.triangles(f, 2)).transpose()})
                       .solidAngle;
        return out / (4.0 * std::numbers::pi);
    };
    CHECK(sum(Vec3(2.0, 0.1, 0.05)) == doctest::Approx(-1.0).epsilon(1e-12));
    CHECK(sum(Vec3(2.0, 0.0, 0.4)) == doctest::Approx(-1.0).epsilon(1e-12));
    CHECK(std::abs(sum(Vec3(0.0, 0.1, 0.05))) <= 1e-12);
    CHECK(std::abs(sum(Vec3(5.0, 7.0, -3.0))) <= 1e-12);
}

TEST_CASE("kernels: vector instructions give what the reference gives") {
    const shapes::Body bodies[] = {shapes::cylinder(0.3, 0.9, 18, 7), shapes::box(Vec3(-0.5, -0.5, 0), Vec3(0.5, 0.5, 0.01), 5, 5, 1),
                                   shapes::sphere(0.5, 2)};
    for (const auto& body : bodies) {
        const TriangleMesh& mesh = body.mesh;
        const auto count = static_cast<std::size_t>(mesh.vertices.rows());
        std::vector<std::int32_t> triangles(static_cast<std::size_t>(mesh.triangles.rows())), identity(count);
        for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = static_cast<std::int32_t>(i);
        for (std::size_t i = 0; i < count; ++i) identity[i] = static_cast<std::int32_t>(i);
        const TriangleBatch batch(mesh, triangles, identity, identity);
        TriangleBatch::Columns columns;  // bubbles: a column for every second side, one for all others
        for (const std::int32_t f : triangles) {
            columns.corner.push_back({mesh.triangles(f, 0), mesh.triangles(f, 1), mesh.triangles(f, 2)});
            columns.bubble.push_back({3 * f % static_cast<std::int32_t>(count), static_cast<std::int32_t>(count), (3 * f + 2) % static_cast<std::int32_t>(count)});
        }
        const TriangleBatch curved(mesh, triangles, columns);
        for (const double nu : {0.0, 0.3, 0.5})
            for (std::size_t v = 0; v < 2 * count; v += 5) {
                // Vertices, then middles of edges.
                Vec3 x = mesh.vertices.row(static_cast<Eigen::Index>(v % count)).transpose();
                if (v >= count)
                    x = 0.5 * (Vec3(mesh.vertices.row(mesh.triangles(triangles[v - count], 0)).transpose()) +
                               Vec3(mesh.vertices.row(mesh.triangles(triangles[v - count], 1)).transpose()));
                Eigen::VectorXd hCurved = Eigen::VectorXd::Zero(9 * static_cast<Eigen::Index>(count) + 9), hCurvedExpected = hCurved;
                Eigen::VectorXd h = Eigen::VectorXd::Zero(9 * static_cast<Eigen::Index>(count)), g = h, hAlone = h, hExpected = h, gExpected = h;
                const double sum = addBlocks(batch, x, nu, h.data(), g.data());
                CHECK(addBlocks(batch, x, nu, hAlone.data(), nullptr) == doctest::Approx(sum).epsilon(1e-13));
                CHECK(addBlocks(curved, x, nu, hCurved.data(), nullptr) == doctest::Approx(sum).epsilon(1e-13));
                double sumExpected = 0.0;
                for (const std::int32_t f : triangles) {
                    Corners p;
                    for (int c = 0; c < 3; ++c) p[static_cast<std::size_t>(c)] = mesh.vertices.row(mesh.triangles(f, c)).transpose();
                    const PairBlocks blocks = pairBlocks(x, p, nu);
                    sumExpected += triangleIntegrals(x, p).solidAngle;
                    for (int c = 0; c < 3; ++c)
                        for (int i = 0; i < 3; ++i)
                            for (int j = 0; j < 3; ++j) {
                                hExpected[9 * mesh.triangles(f, c) + 3 * i + j] += blocks.h[static_cast<std::size_t>(c)](i, j);
                                gExpected[9 * mesh.triangles(f, c) + 3 * i + j] += blocks.g[static_cast<std::size_t>(c)](i, j);
                                hCurvedExpected[9 * columns.bubble[static_cast<std::size_t>(f)][static_cast<std::size_t>(c)] + 3 * i + j] +=
                                    blocks.bubble[static_cast<std::size_t>(c)](i, j);
                            }
                }
                // The plate's thin sides have hat functions as steep as 1/0.01; elsewhere entries are of order one.
                CHECK((h - hExpected).cwiseAbs().maxCoeff() <= 1e-12);
                hCurvedExpected.head(hExpected.size()) += hExpected;
                CHECK((hCurved - hCurvedExpected).cwiseAbs().maxCoeff() <= 1e-11);
                CHECK((hAlone - hExpected).cwiseAbs().maxCoeff() <= 1e-12);
                CHECK((g - gExpected).cwiseAbs().maxCoeff() <= 1e-13);
                CHECK(std::abs(sum - sumExpected) <= 1e-12);
            }
    }
}
