// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/tetrahedral_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <mutex>
#include <numeric>
#include <string>
#include <utility>

#include "core/mesh/mesh_codec.h"
#include "core/worker/worker.h"

#define TETLIBRARY
#include <tetgen.h>

namespace imomushi {
namespace {

using Index = std::int32_t;

constexpr const char* kNoFilling = "no-filling";
/// Radius of the circumscribed sphere over the shortest edge, at most; TetGen's own measure. Larger: fewer tetrahedra, of worse shape.
constexpr double kRadiusEdgeRatio = 2.0;
/// A tetrahedron is too large where its longest edge is longer than this times the wanted length: the edges around it are then about as long as wanted.
constexpr double kTooLong = 1.4;
/// What a worker may use; a body of 100,000 vertices takes some five seconds.
constexpr WorkLimits kLimits{std::size_t{16} << 30, 600, 3600.0, false};

/// See anyFlat(). Four corners in one plane have a volume of about the rounding of coordinates, of a sign by chance. A flat
/// tetrahedron makes entries of the stiffness larger by one over its flatness: at this bound six of the sixteen digits are left.
constexpr double kFlat = 1e-10;
/// What TetGen throws where it gets no memory.
constexpr int kNoMemory = 1;

/// TetGen has global state.
std::mutex oneAtATime;
/// What TetGen's call-back asks for; it has no argument for it.
const TetrahedronSizes* wantedSize = nullptr;

bool tooLarge(REAL* a, REAL* b, REAL* c, REAL* d, REAL*, REAL) {
    const std::array<Vec3, 4> corner{Vec3(a[0], a[1], a[2]), Vec3(b[0], b[1], b[2]), Vec3(c[0], c[1], c[2]), Vec3(d[0], d[1], d[2])};
    double longest = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t k = 0; k < i; ++k) longest = std::max(longest, (corner[i] - corner[k]).squaredNorm());
    const double size = kTooLong * wantedSize->at(0.25 * (corner[0] + corner[1] + corner[2] + corner[3]));
    return longest > size * size;
}

/// What TetGen makes: a status (0: done, otherwise what it threw), vertices and tetrahedra.
struct Filling {
    int status = 0;
    TetrahedralMesh mesh;
};

Filling fillWithTetGen(const TriangleMesh& surface, const TetrahedronSizes& size) {
    const std::lock_guard lock(oneAtATime);
    std::fenv_t before;
    std::feholdexcept(&before);
    wantedSize = &size;
    Filling made;
    try {
        // Not freed where TetGen throws: it leaves them half done. Often it crashes by itself then, which a worker survives.
        auto* const given = new tetgenio;
        auto* const filled = new tetgenio;
        tetgenio &in = *given, &out = *filled;
        in.numberofpoints = static_cast<int>(surface.vertices.rows());
        in.pointlist = new REAL[static_cast<std::size_t>(3 * in.numberofpoints)];
        for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v)
            for (int k = 0; k < 3; ++k) in.pointlist[3 * v + k] = surface.vertices(v, k);
        in.numberoffacets = static_cast<int>(surface.triangles.rows());
        in.facetlist = new tetgenio::facet[static_cast<std::size_t>(in.numberoffacets)];
        for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
            tetgenio::facet& facet = in.facetlist[t];
            tetgenio::init(&facet);
            facet.numberofpolygons = 1;
            facet.polygonlist = new tetgenio::polygon[1];
            tetgenio::polygon& polygon = facet.polygonlist[0];
            polygon.numberofvertices = 3;
            polygon.vertexlist = new int[3];
            for (int c = 0; c < 3; ++c) polygon.vertexlist[c] = surface.triangles(t, c);
        }
        in.tetunsuitable = tooLarge;
        // p: a polyhedron; Y: its triangles stay; M: coplanar ones too; q: no bad shapes; Q: no messages.
        std::string switches = "pYMQq" + std::to_string(kRadiusEdgeRatio);
        tetrahedralize(switches.data(), &in, &out);
        made.mesh.vertices.resize(out.numberofpoints, 3);
        made.mesh.tetrahedra.resize(out.numberoftetrahedra, 4);
        for (Eigen::Index v = 0; v < made.mesh.vertices.rows(); ++v)
            for (int k = 0; k < 3; ++k) made.mesh.vertices(v, k) = out.pointlist[3 * v + k];
        for (Eigen::Index t = 0; t < made.mesh.tetrahedra.rows(); ++t)
            for (int c = 0; c < 4; ++c) made.mesh.tetrahedra(t, c) = out.tetrahedronlist[4 * t + c];
        delete given;
        delete filled;
    } catch (int reason) {
        made.status = reason == 0 ? -1 : reason;
    } catch (const std::bad_alloc&) {
        made.status = kNoMemory;
    } catch (...) {
        made.status = -1;
    }
    std::fesetenv(&before);
    return made;
}

std::string reasonOf(int status) {
    switch (status) {
        case 3:
            return "its triangles meet each other";
        case 4:
            return "some of its parts are too small or nearly touch";
        default:
            return "TetGen gave up";
    }
}

tl::unexpected<Error> noFilling(const std::string& reason) {
    return fail(kNoFilling, "The body cannot be filled with tetrahedra: " + reason + "; repair it, or choose a solver mesh that needs none, such as \"as-is\".");
}

/// From the first corner of a tetrahedron to the others.
Eigen::Matrix3d edgesOf(const TetrahedralMesh& mesh, Eigen::Index t) {
    Eigen::Matrix3d edges;
    for (int c = 0; c < 3; ++c) edges.col(c) = mesh.vertices.row(mesh.tetrahedra(t, c + 1)) - mesh.vertices.row(mesh.tetrahedra(t, 0));
    return edges;
}

/// Keeps the tetrahedra inside, turned to positive volume, and checks that exactly the surface bounds them and that none is flat.
Result<TetrahedralMesh> within(const TriangleMesh& surface, TetrahedralMesh mesh) {
    const Eigen::Index count = mesh.tetrahedra.rows();
    if (mesh.vertices.rows() < surface.vertices.rows() || mesh.vertices.topRows(surface.vertices.rows()) != surface.vertices)
        return noFilling("TetGen moved its vertices");
    // All look the same way by exact predicates, flat ones too, of which rounding would tell nothing.
    double all = 0.0;
    for (Eigen::Index t = 0; t < count; ++t) all += edgesOf(mesh, t).determinant();
    if (all < 0.0) mesh.tetrahedra.col(2).swap(mesh.tetrahedra.col(3));
    // Sides by their corners; those of one tetrahedron look outwards in this order.
    constexpr std::array<std::array<int, 3>, 4> kSides{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
    struct Side {
        std::array<Index, 3> sorted;
        Index of;   ///< 4 * tetrahedron + side, -1 - triangle
        bool even;  ///< the corners as they look outwards are an even permutation of the sorted ones
    };
    std::vector<Side> sides;
    sides.reserve(static_cast<std::size_t>(4 * count + surface.triangles.rows()));
    const auto add = [&](Index a, Index b, Index c, Index of) {
        bool even = true;
        if (a > b) std::swap(a, b), even = !even;
        if (b > c) std::swap(b, c), even = !even;
        if (a > b) std::swap(a, b), even = !even;
        sides.push_back({{a, b, c}, of, even});
    };
    for (Eigen::Index t = 0; t < count; ++t)
        for (int s = 0; s < 4; ++s) {
            const auto& k = kSides[static_cast<std::size_t>(s)];
            add(mesh.tetrahedra(t, k[0]), mesh.tetrahedra(t, k[1]), mesh.tetrahedra(t, k[2]), static_cast<Index>(4 * t + s));
        }
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
        add(surface.triangles(t, 0), surface.triangles(t, 1), surface.triangles(t, 2), static_cast<Index>(-1 - t));
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) { return x.sorted != y.sorted ? x.sorted < y.sorted : x.of < y.of; });
    std::vector<Index> neighbour(static_cast<std::size_t>(4 * count), -1);
    std::vector<Index> open;
    std::vector<char> inside(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i;
        while (end < sides.size() && sides[end].sorted == sides[i].sorted) ++end;
        if (sides[i].of < 0) {
            // Of the tetrahedra at a triangle of the surface, inside is the one whose side looks as the triangle does.
            bool found = false;
            for (std::size_t k = i + 1; k < end; ++k)
                if (sides[k].of >= 0 && sides[k].even == sides[i].even) {
                    found = true;
                    if (!std::exchange(inside[static_cast<std::size_t>(sides[k].of / 4)], char{1})) open.push_back(sides[k].of / 4);
                }
            if (!found) return noFilling("TetGen did not keep its triangles");
        } else if (end - i == 2) {
            neighbour[static_cast<std::size_t>(sides[i].of)] = sides[i + 1].of / 4;
            neighbour[static_cast<std::size_t>(sides[i + 1].of)] = sides[i].of / 4;
        }
        i = end;
    }
    while (!open.empty()) {
        const Index t = open.back();
        open.pop_back();
        for (Index s = 0; s < 4; ++s) {
            const Index next = neighbour[static_cast<std::size_t>(4 * t + s)];
            if (next >= 0 && !std::exchange(inside[static_cast<std::size_t>(next)], char{1})) open.push_back(next);
        }
    }
    TetrahedralMesh out;
    std::vector<Index> number(static_cast<std::size_t>(mesh.vertices.rows()), -1);
    std::iota(number.begin(), number.begin() + surface.vertices.rows(), 0);
    auto vertices = static_cast<Index>(surface.vertices.rows());
    Eigen::Index kept = 0;
    double volume = 0.0, wanted = 0.0;
    for (Eigen::Index t = 0; t < count; ++t) {
        if (!inside[static_cast<std::size_t>(t)]) continue;
        volume += edgesOf(mesh, t).determinant();
        mesh.tetrahedra.row(kept++) = mesh.tetrahedra.row(t);
    }
    const Vec3 from = surface.vertices.row(0).transpose();
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        const auto corner = [&](int c) -> Vec3 { return surface.vertices.row(surface.triangles(t, c)).transpose() - from; };
        wanted += corner(0).cross(corner(1)).dot(corner(2));
    }
    if (!(std::abs(volume - wanted) <= 1e-6 * std::abs(wanted))) return noFilling("it overlaps itself");
    out.tetrahedra = mesh.tetrahedra.topRows(kept);
    for (Eigen::Index t = 0; t < kept; ++t)
        for (int c = 0; c < 4; ++c)
            if (Index& n = number[static_cast<std::size_t>(out.tetrahedra(t, c))]; n < 0) n = vertices++;
    out.vertices.resize(vertices, 3);
    for (std::size_t v = 0; v < number.size(); ++v)
        if (number[v] >= 0) out.vertices.row(number[v]) = mesh.vertices.row(static_cast<Eigen::Index>(v));
    for (Eigen::Index t = 0; t < kept; ++t)
        for (int c = 0; c < 4; ++c) out.tetrahedra(t, c) = number[static_cast<std::size_t>(out.tetrahedra(t, c))];
    if (anyFlat(out)) return noFilling("a tetrahedron has no volume");
    return out;
}

Result<TetrahedralMesh> fillHere(const TriangleMesh& surface, const TetrahedronSizes& size, const Progress& progress) {
    Filling made;
    {
        const Attempt filling("filling with tetrahedra");
        if (!filling) return noFilling("TetGen breaks down");
        made = fillWithTetGen(surface, size);
    }
    if (progress.cancelled()) return fail(kCancelled, "The precompute was cancelled.");
    // Not a reason to choose another way: with more memory there is an answer.
    if (made.status == kNoMemory)
        return fail("too-large",
                    "Filling the body with tetrahedra needs more memory than there is: close other programs, or reduce the mesh.");
    if (made.status != 0) return noFilling(reasonOf(made.status));
    return within(surface, std::move(made.mesh));
}

}  // namespace

bool anyFlat(const TetrahedralMesh& mesh) {
    for (Eigen::Index t = 0; t < mesh.tetrahedra.rows(); ++t) {
        const Eigen::Matrix3d edges = edgesOf(mesh, t);
        if (!(edges.determinant() > kFlat * edges.colwise().norm().prod())) return true;
    }
    return false;
}

double TetrahedronSizes::at(const Vec3& p) const {
    double least = most;
    for (const Point& point : points) {
        const double reach = (least - point.size) / growth;
        if (const double d = (point.place - p).squaredNorm(); reach > 0.0 && d < reach * reach) least = point.size + growth * std::sqrt(d);
    }
    return least;
}

void members(auto& archive, TetrahedronSizes::Point& p) { archive(p.place, p.size); }
void members(auto& archive, TetrahedronSizes& s) { archive(s.points, s.growth, s.most); }
void members(auto& archive, TetrahedralMesh& m) { archive(m.vertices, m.tetrahedra); }
bool sound(const TetrahedralMesh& m) {
    return m.tetrahedra.size() == 0 || (m.tetrahedra.minCoeff() >= 0 && m.tetrahedra.maxCoeff() < m.vertices.rows());
}

namespace {

const Operation<Result<TetrahedralMesh>(TriangleMesh, TetrahedronSizes)> kFill("fill-with-tetrahedra", fillHere);

}  // namespace

Result<TetrahedralMesh> fillWithTetrahedra(const TriangleMesh& surface, const TetrahedronSizes& size, const Progress& progress) {
    return kFill(surface, size, progress, kLimits);
}

}  // namespace imomushi
