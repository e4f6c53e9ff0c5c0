// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/hard_cases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "tests/support/hard_bodies.h"
#include "tests/support/hard_checks.h"
#include "tests/support/shapes.h"

namespace imomushi {
namespace {

using namespace hard;

// ---- elements --------------------------------------------------------------------------------------------------------------------------------

/// An element with joint faces at its ends along z.
HardElement withEnds(TriangleMesh mesh, double nu = 0.3) {
    HardElement element;
    element.name = "body";
    const Vec3 low = mesh.vertices.colwise().minCoeff().transpose(), high = mesh.vertices.colwise().maxCoeff().transpose();
    const Vec3 middle = 0.5 * (low + high);
    element.faces = {{"in", Vec3(middle.x(), middle.y(), low.z()), -Vec3::UnitZ(), {}}, {"out", Vec3(middle.x(), middle.y(), high.z()), Vec3::UnitZ(), {}}};
    element.mesh = std::move(mesh);
    element.nu = nu;
    return element;
}

HardElement refinedElement(HardElement element) {
    element.mesh = refined(element.mesh);
    return element;
}

/// One element, a bone from its first face to its last, and a drag of the end by a tenth of the bone.
HardCase solvedCase(std::string name, std::string hard, HardElement element, std::vector<HardCheck> checks) {
    element.checks = std::move(checks);
    HardCase c;
    c.name = std::move(name);
    c.hard = std::move(hard);
    c.bones = {{"bone", element.name, element.name + "/" + element.faces.front().name, element.name + "/" + element.faces.back().name}};
    c.endpoint = "bone/end";
    const double length = (element.faces.back().origin - element.faces.front().origin).norm();
    c.drag = 0.1 * length * Vec3(0.5, 0.3, 0.8);
    c.elements = {std::move(element)};
    return c;
}

HardCase refusedCase(std::string name, std::string hard, HardElement element, HardCase::Refusal refusal) {
    HardCase c = solvedCase(std::move(name), std::move(hard), std::move(element), {});
    c.refusal = std::move(refusal);
    return c;
}

constexpr double kWellConditioned = 1e4;  // a compact body: about 100 in the 2-norm, up to sqrt(n) more in the maximum norm
const char* const kTwoTriangulations = "the same polyhedron; each triangulation has 1-2 % of discretisation error";

const char* const kOtherTetrahedra = "places of other rounding get other tetrahedra, which leave at most 0.5 % of a bar by default";
const char* const kTwoDefaults = "tetrahedra by default leave at most 1 % of either triangulation";

/// A bar whose section is slit from its top to its middle; the slit opens to `gap` within the first quarter.
TriangleMesh slitBar(double gap) {
    Section section = grid(steps(0.0, 1.0, 4), steps(0.0, 1.0, 4));
    // The points of the slit above its floor, once more for the cells to their right.
    std::map<int, int> right;
    for (int i = 0; i < 25; ++i) {
        const Eigen::Vector2d p = section.points[static_cast<std::size_t>(i)];
        if (p.x() == 0.5 && p.y() > 0.5) right[i] = 0;
    }
    for (auto& [left, copy] : right) {
        copy = static_cast<int>(section.points.size());
        section.points.push_back(section.points[static_cast<std::size_t>(left)] + Eigen::Vector2d(0.5 * gap, 0.0));
    }
    for (auto& t : section.triangles) {
        double x = 0.0;
        for (const int v : t) x += section.points[static_cast<std::size_t>(v)].x() / 3.0;
        if (x < 0.5) continue;
        for (int& v : t)
            if (const auto it = right.find(v); it != right.end()) v = it->second;
    }
    for (const auto& [left, copy] : right) section.points[static_cast<std::size_t>(left)].x() -= 0.5 * gap;
    return prism(section, steps(0.0, 2.0, 6));
}

void addMaterials(std::vector<HardCase>& cases) {
    const auto bar = [](double nu) { return withEnds(plainBar(), nu); };
    const auto name = [](double nu) {
        char text[24];
        std::snprintf(text, sizeof text, "nu %g", nu);
        return std::string(text);
    };
    for (const double nu : {0.0, 0.3, 0.45, 0.49, 0.4999, 0.5}) {
        std::vector<HardCheck> checks{rigid(kWellConditioned), stretch(kWellConditioned)};
        if (nu == 0.4999)
            checks.push_back(sameAs("difference from nu 0.5", bar(0.5), 1e-3,
                                    "the solution is smooth in nu up to 0.5, so it changes by about 0.5 - nu; 1/(1 - 2 nu) would show here"));
        cases.push_back(solvedCase(name(nu), nu > 0.48 ? "nearly or wholly incompressible" : "a plain bar, for comparison", bar(nu), std::move(checks)));
    }
}

void addTriangles(std::vector<HardCase>& cases) {
    const HardElement plain = withEnds(plainBar());
    const double thin = 1.0 / 300.0;
    const Section square = grid(steps(-0.5, 0.5, 3), steps(-0.5, 0.5, 3));
    cases.push_back(solvedCase("slivers", "rings of triangles 1:100, at a rim and along the bar",
                               withEnds(prism(square, with(steps(0.0, 3.0, 9), {thin, 1.0 + thin, 2.0 + thin}))),
                               {rigid(1e5), stretch(1e5), byDefault(sameAs("difference from even triangles", plain, 0.03, kTwoTriangulations), 0.02, kTwoDefaults)}));
    cases.push_back(solvedCase("needles", "every fifth triangle has a vertex 1e-4 of its side from a corner, also on the joint faces",
                               withEnds(pierced(plainBar(), 5, Vec3(1.0 - 2e-4, 1e-4, 1e-4))),
                               {rigid(1e7), stretch(1e7), byDefault(sameAs("difference from even triangles", plain, 0.03, kTwoTriangulations), 0.02, kTwoDefaults)}));
    cases.push_back(solvedCase("caps", "every fifth triangle has a vertex 1e-4 of its size beside a side, also on the joint faces",
                               withEnds(pierced(plainBar(), 5, Vec3(0.5 - 5e-5, 0.5 - 5e-5, 1e-4))),
                               {rigid(1e7), stretch(1e7), byDefault(sameAs("difference from even triangles", plain, 0.03, kTwoTriangulations), 0.02, kTwoDefaults)}));
    const double near = 1e-9 * sizeOf(plain.mesh);
    cases.push_back(solvedCase("near duplicates", "every fifth triangle has a vertex 1e-9 of the body's size from a corner",
                               withEnds(pierced(plainBar(), 5, Vec3(1.0 - 6.0 * near, 3.0 * near, 3.0 * near))),
                               {rigid(kWellConditioned), stretch(kWellConditioned),
                                byDefault(sameAs("difference from the bar without them", plain, 1e-9, "the import merges them, so that the bar comes back to the bit or nearly"), 0.01,
                                          "it comes back with its triangles in another order, and of equally long edges the order decides which is refined first")}));
    HardCheck seamRigid = rigid(1e6), seamStretch = stretch(1e6);
    seamRigid.why = "joint faces are out of their planes by 1e-9 of the size, which the modes of a flat face leave out";
    seamStretch.why = "ends and sides are out of their planes by 1e-9 of the size, 1e-8 of a side";
    seamStretch.bound = 1e-6;
    cases.push_back(solvedCase("open seams", "every triangle has vertices of its own, 1e-9 of the body's size apart", withEnds(apart(plainBar(), near)),
                               {seamRigid, seamStretch,
                                byDefault(sameAs("difference from the bar without seams", plain, 1e-6,
                                                 "the import welds them; places move by 1e-8 of a side, and the condition number in the 2-norm is about 100"),
                                          0.01, kOtherTetrahedra)}));
}

void addShapes(std::vector<HardCase>& cases) {
    // The Kirchhoff plate with nu = 0, one end clamped, the other moved across: u_y = 3 s^2 - 2 s^3, exact but for (thickness / length)^2.
    const HardCheck plateBend{"bending against Kirchhoff's plate", 0.05,
                              "at nu = 0 the deflection is 3 s^2 - 2 s^3; 8 cells leave about (1/8)^2 of it, and a method that locks leaves a straight line (12 %)",
                              [](const SolvedElement& s) -> Result<double> {
                                  const JointFace& face = s.input.faces.back();
                                  JointMap map;
                                  map.shift = face.frame.axes.transpose() * Vec3::UnitY();
                                  Eigen::VectorXd v = Eigen::VectorXd::Zero(s.response.columns());
                                  double lost = 0.0;
                                  s.response.bases.back().coefficients(map, face.size, v.data() + s.response.firstColumn[1], lost);
                                  const Points u = freeDisplacement(s, v), x = freePoints(s);
                                  double miss = 0.0, norm = 0.0;
                                  for (Eigen::Index i = 0; i < u.rows(); ++i) {
                                      const double at = x(i, 2), exact = at * at * (3.0 - 2.0 * at);
                                      miss += (u(i, 1) - exact) * (u(i, 1) - exact);
                                      norm += exact * exact;
                                  }
                                  return std::sqrt(miss / norm);
                              }};
    const char* const kPlateByDefault = "quadratic displacement bends as the plate does, but for the shear of thickness^2 and the clamped ends";
    const auto plate = [](double thickness) {
        return withEnds(prism(grid(steps(-0.5, 0.5, 4), {-0.5 * thickness, 0.5 * thickness}), steps(0.0, 1.0, 8)), 0.0);
    };
    cases.push_back(solvedCase("plate", "1 x 1 x 0.001: triangles 250 times as long as the plate is thick", plate(0.001),
                               {byDefault(rigid(1e8), 1e-4, "rounding 1e-16 times the condition number of its tetrahedra, side * length^2 / thickness^3 * 7e4 nodes = 2e11"), stretch(1e8),
                                byDefault(plateBend, 0.01, kPlateByDefault)}));
    cases.back().elements[0].checks.back().bound = 0.1;
    cases.back().elements[0].checks.back().why = "sides 250 times the thickness lock linear displacement about half-way to a straight line (12 %)";
    cases.push_back(solvedCase("plate 0.005", "1 x 1 x 0.005: triangles 50 times as long as the plate is thick", plate(0.005),
                               {rigid(1e7), stretch(1e7), byDefault(plateBend, 0.01, kPlateByDefault)}));
    cases.back().elements[0].checks.back().bound = 0.1;
    cases.push_back(solvedCase("thick plate", "1 x 1 x 0.05", plate(0.05), {rigid(1e5), stretch(1e5), byDefault(plateBend, 0.01, kPlateByDefault)}));

    // Spikes on the side of a bar: one vertex between rows that are `half` away, drawn out by a metre, with rings of vertices along it.
    const auto spiky = [](double half, double length, int rings) {
        TriangleMesh mesh = prism(grid({-0.5, -0.25 - half / 2, -half, 0.0, half, 0.25 + half / 2, 0.5}, steps(-0.5, 0.5, 2)),
                                  {0.0, 0.4, 0.8, 1.2, 1.5 - half, 1.5, 1.5 + half, 1.8, 2.2, 2.6, 3.0});
        std::vector<Vec3> points;
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) points.emplace_back(mesh.vertices.row(v).transpose());
        const auto tip = static_cast<int>(std::find(points.begin(), points.end(), Vec3(0.0, 0.5, 1.5)) - points.begin());
        points[static_cast<std::size_t>(tip)].y() += length;
        std::map<std::pair<int, int>, int> between;
        const auto at = [&](int foot, int ring) {
            if (ring == 0) return foot;
            if (ring == rings) return tip;
            const auto [it, fresh] = between.try_emplace({foot, ring}, static_cast<int>(points.size()));
            const Vec3 from = points[static_cast<std::size_t>(foot)], to = points[static_cast<std::size_t>(tip)];
            if (fresh) points.push_back(from + (to - from) * ring / rings);
            return it->second;
        };
        std::vector<std::array<int, 3>> corners;
        for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
            std::array<int, 3> t{mesh.triangles(f, 0), mesh.triangles(f, 1), mesh.triangles(f, 2)};
            while (t[0] != tip && (t[1] == tip || t[2] == tip)) std::rotate(t.begin(), t.begin() + 1, t.end());
            if (t[0] != tip) {
                corners.push_back(t);
                continue;
            }
            for (int k = 0; k < rings; ++k) {
                corners.push_back({at(t[1], k), at(t[2], k), at(t[2], k + 1)});
                if (k + 1 < rings) corners.push_back({at(t[1], k), at(t[2], k + 1), at(t[1], k + 1)});
            }
        }
        return shapes::detail::meshOf(points, corners);
    };
    const auto tipOf = [](const Points& x) {
        Eigen::Index at = 0;
        x.col(1).maxCoeff(&at);
        return at;
    };
    const HardCheck stretchedTip{"motion of the tip in a stretched bar", 0.03, "nothing loads the spike: its tip moves as the side of the bar there does, by -nu / 2",
                                 [tipOf](const SolvedElement& s) -> Result<double> {
                                     const Eigen::Matrix3d gradient = Vec3(-s.input.nu, -s.input.nu, 1.0).asDiagonal();
                                     const Points u = freeDisplacement(s, parametersOf(s, gradient, Vec3(0.0, 0.0, 1.5), Vec3::Zero()));
                                     const Vec3 miss = u.row(tipOf(freePoints(s))).transpose() - Vec3(0.0, -0.5 * s.input.nu, 0.0);
                                     return miss.norm() / 1.5;  // the ends move by 1.5
                                 }};
    const HardCheck whip{"motion of the tip over that of the body", 2.0,
                         "the tip is a metre from the bar, which turns by less than a radian per metre that its end moves, and faces that only change shape hardly turn its middle",
                         [tipOf](const SolvedElement& s) -> Result<double> {
                             const Points x = freePoints(s);
                             const Eigen::Index tip = tipOf(x);
                             double worst = 0.0;
                             for (int column = s.response.firstColumn[1]; column < s.response.columns(); ++column) {
                                 const Points u = freeDisplacement(s, Eigen::VectorXd::Unit(s.response.columns(), column));
                                 double body = column - s.response.firstColumn[1] < 5 || column + 1 == s.response.columns() ? 0.5 * std::sqrt(2.0) : 1.0;
                                 for (Eigen::Index i = 0; i < u.rows(); ++i)
                                     if (x(i, 1) <= 0.5) body = std::max(body, u.row(i).norm());
                                 worst = std::max(worst, u.row(tip).norm() / body);
                             }
                             return worst;
                         }};
    const auto addSpike = [&](const char* name, const char* hard, double half, int rings) {
        cases.push_back(solvedCase(name, hard, withEnds(spiky(half, 1.0, rings)),
                                   {rigid(1e6), stretchedTip, whip,
                                    sameAs("difference from the bar without it", withEnds(spiky(half, 0.0, 1)), 0.03,
                                           "an unloaded spike disturbs its foot only, at one vertex in a hundred or two")}));
    };
    addSpike("horn", "a spike on the side of a bar, 5 times as long as wide", 0.1, 1);
    addSpike("horn of rings", "the same with five rings of vertices along it", 0.1, 5);
    addSpike("spike", "a needle of a spike on the side of a bar, 50 times as long as wide", 0.01, 1);

    // Slits.
    cases.push_back(solvedCase("slit 1e-3", "two surfaces 0.001 apart, sides of 0.25", withEnds(slitBar(1e-3)), {rigid(1e7), stretch(1e7)}));
    cases.push_back(solvedCase("slit 1e-6", "two surfaces 1e-6 apart, sides of 0.25", withEnds(slitBar(1e-6)),
                               {rigid(1e9), stretch(1e9),
                                byDefault(sameAs("difference from half the side", refinedElement(withEnds(slitBar(1e-6))), 0.1,
                                                 "the solution has a crack tip, whose error falls as the square root of the side, 0.25 and 0.125 of the slit's depth of 0.5"),
                                          0.02, "tetrahedra are small at the crack tip and leave at most 1 % by default")}));
    cases.push_back(refusedCase("slit closed", "a body that touches itself: the two sides of a slit coincide", withEnds(slitBar(0.0)),
                                {"precompute", "not-closed", "inside and outside are not defined where surfaces coincide: vertices at one place would give the same equations"}));

    // A vertex of one side of an open slit that touches the other side inside a triangle.
    const auto touching = [](double gap) {
        TriangleMesh mesh = slitBar(0.1);
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
            const Eigen::RowVector3d p = mesh.vertices.row(v);
            if (std::abs(p.x() - 0.45) < 1e-9 && p.y() == 0.75 && std::abs(p.z() - 1.0) < 1e-9) mesh.vertices.row(v) << 0.55 - gap, 0.85, 1.08;
        }
        return mesh;
    };
    cases.push_back(solvedCase("nearly touching", "a vertex 0.001 in front of the middle of a triangle", withEnds(touching(1e-3)),
                               {rigid(1e5), byDefault(sameAs("difference from half the side", refinedElement(withEnds(touching(1e-3))), 0.1,
                                                             "as for the slit: the crack tip dominates"),
                                                      0.02, "tetrahedra are small at the crack tip and leave at most 1 % by default")}));
    HardCase touch = solvedCase("touching", "a body that touches itself in a point: a vertex lies in the middle of a triangle", withEnds(touching(0.0)),
                                {rigid(1e5), sameAs("difference from a gap of 1e-6", withEnds(touching(1e-6)), 1e-3, "a touch in a point holds nothing")});
    touch.refusal = {"precompute", "not-closed", "inside and outside are not defined around that vertex, and its equation may take the body on the other side for its own"};
    touch.orSolved = true;
    cases.push_back(std::move(touch));

    // Eight cells around a hole and one more diagonal hole: two edges at one place.
    const auto diagonal = [](bool shared) {
        Section s = grid(steps(0.0, 1.0, 3), steps(0.0, 1.0, 3), [](int i, int j) { return i != j || i == 0; });
        const double at = steps(0.0, 1.0, 3)[2];
        if (!shared) {
            const int old = static_cast<int>(std::find(s.points.begin(), s.points.end(), Eigen::Vector2d(at, at)) - s.points.begin());
            const int copy = static_cast<int>(s.points.size());
            s.points.push_back(s.points[static_cast<std::size_t>(old)]);
            for (auto& t : s.triangles) {
                Eigen::Vector2d c = Eigen::Vector2d::Zero();
                for (const int v : t) c += s.points[static_cast<std::size_t>(v)] / 3.0;
                for (int& v : t)
                    if (v == old && c.x() > c.y()) v = copy;
            }
        }
        return prism(s, steps(0.0, 2.0, 6));
    };
    cases.push_back(refusedCase("kissing edges", "a body that touches itself along a line", withEnds(diagonal(false)),
                                {"precompute", "not-closed", "as with a closed slit: inside and outside are not defined where two edges coincide"}));
    cases.push_back(refusedCase("shared edges", "a body that touches itself along edges of four triangles", withEnds(diagonal(true)),
                                {"import-element", "non-manifold-edge", "no inside and outside are defined around such an edge"}));
    cases.push_back(refusedCase("overlap", "a surface that crosses itself: two boxes that overlap by half, in one mesh",
                                withEnds(both(shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 2), 2, 2, 4).mesh, shapes::box(Vec3(0.3, 0.3, 1), Vec3(1.3, 1.3, 3), 2, 2, 4).mesh)),
                                {"precompute", "not-closed", "vertices inside the other box see one and a half spheres of body: the space there is counted twice"}));
    cases.push_back(refusedCase("loose part", "two bars in one element, both faces on the first of them",
                                [] {
                                    HardElement e = withEnds(plainBar());
                                    e.mesh = both(e.mesh, moved(plainBar(), 0.5, Vec3(2.0, 0.0, 0.7)));
                                    return e;
                                }(),
                                {"precompute", "singular", "nothing holds the second bar"}));

    // A wall that is thinner than double precision can resolve by a direct method: condition (side / thickness)^2 = 1e11 and more.
    HardCase skin = solvedCase("skin", "a tube with one wall 1e-6 thick, sides of 0.5",
                               withEnds(prism(grid({0.0, 1e-6, 0.5, 1.0}, steps(0.0, 1.0, 3), [](int i, int j) { return i != 1 || j != 1; }), steps(0.0, 1.5, 4))),
                               {rigid(1e9), stretch(1e9)});
    skin.refusal = {"precompute", "inaccurate", "the condition number grows as (side / thickness)^2 or worse, beyond 1e11"};
    skin.orSolved = true;
    cases.push_back(std::move(skin));

    // Holes.
    cases.push_back(solvedCase("genus 1", "a tube: each joint face is a ring",
                               withEnds(prism(grid(steps(0.0, 1.0, 3), steps(0.0, 1.0, 3), [](int i, int j) { return i != 1 || j != 1; }), steps(0.0, 2.0, 6))),
                               {rigid(kWellConditioned), stretch(kWellConditioned)}));
    const Section sieve = grid(steps(0.0, 1.8, 9), steps(0.0, 1.4, 7), [](int i, int j) { return i % 2 == 0 || j % 2 == 0; });
    cases.push_back(solvedCase("genus 12", "a block with twelve holes through both joint faces", withEnds(prism(sieve, steps(0.0, 0.8, 4))),
                               {rigid(kWellConditioned), stretch(kWellConditioned)}));
    {
        // The same block on its side, holes across: its faces are flat outer sides.
        TriangleMesh lying = prism(sieve, steps(0.0, 0.4, 2));
        lying.vertices = (lying.vertices * (Eigen::Matrix3d() << 0, 0, 1, 0, 1, 0, -1, 0, 0).finished().transpose()).eval();
        HardElement element = withEnds(std::move(lying));
        cases.push_back(solvedCase("genus 12 across", "a lattice: twelve holes between its joint faces, bars one cell thick", element,
                                   {rigid(kWellConditioned),
                                    byDefault(sameAs("difference from half the side", refinedElement(element), 0.15,
                                                     "struts of one cell bend with an error of about 10 %, of which halving removes most"),
                                              0.02, "tetrahedra are small at re-entrant edges and leave at most 1 % by default")}));
    }
}

void addPlaces(std::vector<HardCase>& cases) {
    const HardElement plain = withEnds(plainBar());
    const auto add = [&](const char* name, const char* hard, double scale, const Vec3& shift, double bound, const char* why) {
        HardCheck same = sameAs("difference from the bar of size 1", plain, bound, why, scale, shift);
        if (bound > 1e-8) same = byDefault(std::move(same), 0.01, kOtherTetrahedra);
        cases.push_back(solvedCase(name, hard, withEnds(moved(plainBar(), scale, shift)), {rigid(bound / kAssemblyRounding), stretch(bound / kAssemblyRounding), std::move(same)}));
    };
    add("size 1e-6", "a bar of 3 micrometres", 1e-6, Vec3::Zero(), 1e-10, "no length enters but relative to the body: rounding 1e-14 times a condition number of 1e4");
    add("size 1e6", "a bar of 3000 kilometres", 1e6, Vec3::Zero(), 1e-10, "no length enters but relative to the body: rounding 1e-14 times a condition number of 1e4");
    add("far away", "a bar of size 1, a million metres from the origin", 1.0, Vec3(1e6, -1e6, 1e6 + 1.0 / 3.0), 1e-7,
        "coordinates are rounded to 1e-10, which is 3e-10 of a side, and the condition number in the 2-norm is about 100");
}

void addFaces(std::vector<HardCase>& cases) {
    // Faces of three vertices.
    Section triangle;
    for (int i = 0; i < 3; ++i) triangle.points.emplace_back(std::cos(2.0 * std::numbers::pi * i / 3), std::sin(2.0 * std::numbers::pi * i / 3));
    triangle.triangles = {{0, 1, 2}};
    cases.push_back(solvedCase("three vertices", "a three-sided prism whose joint faces are one triangle each", withEnds(prism(triangle, steps(0.0, 4.0, 8))),
                               {rigid(kWellConditioned), stretch(kWellConditioned)}));
    {
        HardElement ball;
        ball.name = "球 (ball)";
        ball.mesh = shapes::sphere(1.0, 2).mesh;
        const auto pole = [&](double side) {
            Eigen::Index best = 0;
            Points centre = Points::Zero(ball.mesh.triangles.rows(), 3);
            for (Eigen::Index f = 0; f < centre.rows(); ++f)
                for (int c = 0; c < 3; ++c) centre.row(f) += ball.mesh.vertices.row(ball.mesh.triangles(f, c)) / 3.0;
            (side * centre.col(2)).maxCoeff(&best);
            const Eigen::RowVector3i t = ball.mesh.triangles.row(best);
            return HardFace{side < 0 ? "南 (south)" : "北 (north)", side * Vec3::UnitZ(), side * Vec3::UnitZ(), {t[0], t[1], t[2]}};
        };
        ball.faces = {pole(-1.0), pole(1.0)};
        cases.push_back(solvedCase("two pins", "a ball held at two single triangles", ball, {rigid(1e5)}));
    }
    // Faces that cover most.
    for (const double nu : {0.3, 0.5}) {
        HardElement slab = withEnds(prism(grid(steps(-0.5, 0.5, 5), steps(-0.5, 0.5, 5)), {0.0, 0.05, 0.1}), nu);
        cases.push_back(solvedCase(nu == 0.5 ? "mostly faces, nu 0.5" : "mostly faces", "a slab: two joint faces cover five sixths of it, one row of vertices is free", slab,
                                   {rigid(1e6), stretch(1e6)}));
    }
    cases.push_back(refusedCase("all faces", "a slab without a free vertex", withEnds(prism(grid(steps(-0.5, 0.5, 4), steps(-0.5, 0.5, 4)), {0.0, 0.2})),
                                {"precompute", "no-free-vertex", "nothing is left to be found"}));
    // Rims.
    {
        HardElement cube;
        cube.name = "body";
        cube.mesh = shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 1), 4, 4, 4).mesh;
        cube.faces = {{"top", Vec3(0.5, 0.5, 1.0), Vec3::UnitZ(), {}}, {"side", Vec3(1.0, 0.5, 0.5), Vec3::UnitX(), {}}};
        const HardCase::Refusal shared{"add-joint-face", "shared-rim", "traction jumps there between two faces, which one unknown per vertex cannot say (an error of half the traction)"};
        cases.push_back(refusedCase("rims in one edge", "two joint faces that share an edge of the body", cube, shared));
        const auto onSide = [&](auto inside) {
            return shapes::patchWhere(cube.mesh, [&](const Vec3& p) { return p.x() == 1.0 && inside(p); }).vertices;
        };
        HardElement corner = cube;
        corner.faces = {{"one", Vec3(1.0, 0.25, 0.25), Vec3::UnitX(), onSide([](const Vec3& p) { return p.y() <= 0.5 && p.z() <= 0.5; })},
                        {"other", Vec3(1.0, 0.75, 0.75), Vec3::UnitX(), onSide([](const Vec3& p) { return p.y() >= 0.5 && p.z() >= 0.5; })}};
        cases.push_back(refusedCase("rims in one vertex", "two joint faces that share a vertex", corner, shared));
        HardElement close = cube;
        close.faces[1] = {"side", Vec3(1.0, 0.5, 0.375), Vec3::UnitX(), onSide([](const Vec3& p) { return p.z() <= 0.75; })};
        cases.push_back(solvedCase("rims one side apart", "between two joint faces lies one row of triangles and no free vertex", close,
                                   {rigid(kWellConditioned),
                                    byDefault(sameAs("difference from half the side",
                                           [&] {
                                               HardElement fine = refinedElement(close);
                                               fine.faces[1].vertices = shapes::patchWhere(fine.mesh, [](const Vec3& p) { return p.x() == 1.0 && p.z() <= 0.75; }).vertices;
                                               return fine;
                                           }(),
                                           0.15, "only the surface away from the faces is free, and there the solution is smooth; singular rims leave some percent"),
                                              0.02, kTwoDefaults)}));
    }
    // Numbers of faces.
    {
        HardElement none = withEnds(plainBar());
        none.faces.clear();
        HardCase c, single;
        c.name = "no face";
        c.hard = "an element without a joint face: it must follow its bone rigidly";
        c.elements = {none};
        c.bones = {{"bone", "body", Vec3(0, 0, 0), Vec3(0, 0, 3)}};
        c.endpoint = "bone/end";
        c.drag = Vec3(0.2, 0.1, 0.3);
        cases.push_back(std::move(c));
        HardElement one = withEnds(plainBar());
        one.faces.pop_back();
        one.checks = {rigid(kWellConditioned)};
        single.name = "one face";
        single.hard = "an element with a single joint face and a free end";
        single.elements = {one};
        single.bones = {{"bone", "body", std::string("body/in"), Vec3(0, 0, 3)}};
        single.endpoint = "bone/end";
        single.drag = Vec3(0.2, 0.1, 0.3);
        cases.push_back(std::move(single));
    }
    {
        const Hub eight = hub();
        HardElement element;
        element.name = "hub";
        element.mesh = eight.mesh;
        HardCase c;
        c.name = "eight faces";
        c.hard = "eight joint faces around one body";
        for (int k = 0; k < 8; ++k) {
            const double turn = 2.0 * std::numbers::pi * k / 8;
            const Vec3 out(std::sin(turn), 0.0, std::cos(turn));
            const std::string face = "face " + std::to_string(k);
            element.faces.push_back({face, out + Vec3(0.0, 0.4, 0.0), out, eight.faces[static_cast<std::size_t>(k)]});
            HardBone bone{"bone " + std::to_string(k), "hub", Vec3(0.0, 0.4, 0.0), "hub/" + face};
            if (k > 0) bone.from = std::string("bone 0/start");
            c.bones.push_back(std::move(bone));
        }
        const HardCheck turned{"eight-fold symmetry", 1e-10, "the mesh turns into itself: rounding of 1e-14 times a condition number of 1e4",
                               [](const SolvedElement& s) -> Result<double> {
                                   const Points x = freePoints(s);
                                   const auto push = [&](int k) {
                                       Eigen::VectorXd v = Eigen::VectorXd::Zero(s.response.columns());
                                       v[s.response.firstColumn[static_cast<std::size_t>(k)] + 5] = 1.0;
                                       return freeDisplacement(s, v);
                                   };
                                   const Points first = push(0);
                                   double worst = 0.0;
                                   for (int k = 1; k < 8; ++k) {
                                       const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0 * std::numbers::pi * k / 8, Vec3::UnitY()).toRotationMatrix();
                                       const Points now = push(k);
                                       for (Eigen::Index i = 0; i < x.rows(); ++i) {
                                           Eigen::Index at = 0;
                                           (x.rowwise() - x.row(i) * turn.transpose()).rowwise().squaredNorm().minCoeff(&at);
                                           worst = std::max(worst, (now.row(at) - first.row(i) * turn.transpose()).norm());
                                       }
                                   }
                                   return worst / first.rowwise().norm().maxCoeff();
                               }};
        element.checks = {rigid(kWellConditioned),
                          byDefault(turned, 0.03, "refinement to a number of vertices is not symmetric; either of two meshes is wrong by about 1 % beside the small pushed face")};
        c.elements = {std::move(element)};
        c.endpoint = "bone 3/end";
        c.drag = Vec3(0.05, 0.08, -0.05);
        cases.push_back(std::move(c));
    }
}

void addChains(std::vector<HardCase>& cases) {
    HardElement soft = withEnds(plainBar(), 0.49), stiff = withEnds(moved(plainBar(), 1.0, Vec3(0.0, 0.0, 3.0)), 0.0);
    soft.name = "soft";
    stiff.name = "stiff";
    stiff.stiffness = 1e6;
    soft.checks = stiff.checks = {rigid(kWellConditioned), stretch(kWellConditioned)};
    HardCase c;
    c.name = "materials 1e6 apart";
    c.hard = "two bars in a chain, one a million times as stiff as the other and of another nu";
    c.elements = {soft, stiff};
    c.joins = {{"soft/out", "stiff/in"}};
    c.bones = {{"soft bone", "soft", std::string("soft/in"), std::string("soft/out")}, {"stiff bone", "stiff", std::string("soft bone/end"), std::string("stiff/out")}};
    c.endpoint = "stiff bone/end";
    c.drag = Vec3(0.6, 0.3, 0.5);
    cases.push_back(std::move(c));
}

std::vector<HardCase> makeCases() {
    std::vector<HardCase> cases;
    addMaterials(cases);
    addTriangles(cases);
    addShapes(cases);
    addPlaces(cases);
    addFaces(cases);
    addChains(cases);
    return cases;
}

}  // namespace

const std::vector<HardCase>& hardCases() {
    static const std::vector<HardCase> cases = makeCases();
    return cases;
}

const HardCase& hardCase(const std::string& name) {
    const auto it = std::find_if(hardCases().begin(), hardCases().end(), [&](const HardCase& c) { return c.name == name; });
    assert(it != hardCases().end());
    return *it;
}

}  // namespace imomushi
