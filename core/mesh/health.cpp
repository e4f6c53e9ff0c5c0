// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/health.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/finite.h"
#include "core/mesh/cgal/intersections.h"
#include "core/mesh/shells.h"
#include "core/mesh/topology.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

constexpr std::size_t kPlaces = 1000;          // shown per issue
constexpr std::size_t kIntersections = 20000;  // pairs after which counting them tells an artist nothing more
constexpr double kHuge = 1000.0;               // m: beyond a kilometre a unit is likely wrong,
constexpr double kTiny = 1e-3;                 // m: and below a millimetre
constexpr double kFar = 1e4;                   // sizes from the origin where single precision shows in the picture
constexpr double kThin = 1e-4;                 // mean thickness over size, below which the elasticity loses its accuracy

bool indicesInRange(const TriangleMesh& mesh) {
    return mesh.triangles.rows() == 0 || (mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < mesh.vertices.rows());
}

MeshIssue issue(Severity severity, const char* code, std::string text, std::size_t count) {
    return {severity, code, std::move(text), static_cast<int>(count), false, {}, {}};
}

void showTriangles(MeshIssue& i, std::vector<std::int32_t> places) {
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    if (places.size() > kPlaces) places.resize(kPlaces);
    i.triangles = std::move(places);
}

void showVertices(MeshIssue& i, std::vector<std::int32_t> places) {
    if (places.size() > kPlaces) places.resize(kPlaces);
    i.vertices = std::move(places);
}

struct EdgeFacts {
    std::vector<std::int32_t> open, nonManifold, mixed;  // a triangle at each such edge
    std::size_t openEdges = 0, nonManifoldEdges = 0, mixedEdges = 0;
};

EdgeFacts edgeFacts(const EdgeTable& edges) {
    EdgeFacts facts;
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() == 1) {
            ++facts.openEdges;
            facts.open.push_back(uses[0].triangle);
        } else if (uses.size() > 2) {
            ++facts.nonManifoldEdges;
            for (const EdgeUse& use : uses) facts.nonManifold.push_back(use.triangle);
        } else if (uses[0].forward == uses[1].forward) {
            ++facts.mixedEdges;
            facts.mixed.push_back(uses[0].triangle);
            facts.mixed.push_back(uses[1].triangle);
        }
    }
    return facts;
}

}  // namespace

std::string counted(std::size_t n, const char* one, const char* many) { return std::to_string(n) + " " + (n == 1 ? one : many); }

MeshFacts meshFacts(const TriangleMesh& mesh) {
    MeshFacts facts;
    if (mesh.vertices.rows() == 0 || mesh.triangles.rows() == 0 || !indicesInRange(mesh) || !allFinite(mesh.vertices)) return facts;
    facts.low = mesh.vertices.colwise().minCoeff();
    facts.high = mesh.vertices.colwise().maxCoeff();
    const Vec3 centre = facts.low + (facts.high - facts.low) / 2;
    bool sound = true;
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
        const Vec3 a = mesh.vertices.row(mesh.triangles(f, 0)).transpose() - centre;
        const Vec3 b = mesh.vertices.row(mesh.triangles(f, 1)).transpose() - centre;
        const Vec3 c = mesh.vertices.row(mesh.triangles(f, 2)).transpose() - centre;
        facts.volume += a.dot(b.cross(c)) / 6.0;
        facts.area += (b - a).cross(c - a).norm() / 2.0;
        sound = sound && mesh.triangles(f, 0) != mesh.triangles(f, 1) && mesh.triangles(f, 1) != mesh.triangles(f, 2) &&
                mesh.triangles(f, 2) != mesh.triangles(f, 0);
    }
    const EdgeTable edges(mesh.triangles);
    const EdgeFacts atEdges = edgeFacts(edges);
    edgeComponents(mesh.triangles, edges, facts.components);
    facts.closed = sound && atEdges.openEdges + atEdges.nonManifoldEdges + atEdges.mixedEdges == 0 &&
                   nonManifoldVertices(mesh.triangles, edges).empty();
    facts.outward = facts.closed && facts.volume > 0.0;
    return facts;
}

void sayLeftOut(std::vector<MeshIssue>& issues) {
    const std::vector<std::string> steps = leftOutSteps();
    if (steps.empty()) return;
    MeshIssue issue;
    issue.severity = Severity::Warning;
    issue.code = "left-out";
    issue.text = counted(steps.size(), "step", "steps") +
                 " broke down or came to no end on this surface and was left out, the first of them " + steps.front() +
                 ": repair the mesh in a modelling program for a body that has all of it.";
    issue.count = static_cast<int>(steps.size());
    issues.push_back(std::move(issue));
}

std::vector<MeshIssue> checkMesh(const TriangleMesh& mesh) {
    std::vector<MeshIssue> issues;
    const auto add = [&](MeshIssue i) -> MeshIssue& { return issues.emplace_back(std::move(i)); };
    if (mesh.triangles.rows() == 0) {
        add(issue(Severity::Error, "empty", "The mesh has no triangles: choose a mesh with a closed surface.", 1));
        return issues;
    }
    if (!indicesInRange(mesh)) {
        add(issue(Severity::Error, "bad-index", "Triangles refer to vertices that do not exist: export the mesh again.", 1));
        return issues;
    }
    std::vector<std::int32_t> places;
    for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v)
        if (!allFinite(mesh.vertices.row(v))) places.push_back(v);
    if (!places.empty()) {
        showVertices(add(issue(Severity::Error, "non-finite",
                               counted(places.size(), "vertex has a coordinate that is", "vertices have coordinates that are") +
                                   " not a finite number: repair the mesh in the program that made it.",
                               places.size())),
                     places);
        return issues;
    }

    std::vector<char> used(static_cast<std::size_t>(mesh.vertices.rows()), 0);
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f)
        for (int k = 0; k < 3; ++k) used[static_cast<std::size_t>(mesh.triangles(f, k))] = 1;
    for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v)
        if (!used[static_cast<std::size_t>(v)]) places.push_back(v);
    if (!places.empty())
        showVertices(add(issue(Severity::Warning, "unused-vertex",
                               counted(places.size(), "vertex belongs", "vertices belong") + " to no triangle: import the mesh again to drop them.",
                               places.size())),
                     places);

    places.clear();
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f)
        if (degenerate(mesh, f)) places.push_back(f);
    if (!places.empty())
        showTriangles(add(issue(Severity::Error, "degenerate",
                                counted(places.size(), "triangle has", "triangles have") + " no area: merge their vertices in a modelling program.",
                                places.size())),
                      places);

    places = duplicateTriangles(mesh.triangles);
    if (!places.empty())
        showTriangles(add(issue(Severity::Error, "duplicate-triangle",
                                counted(places.size(), "triangle lies", "triangles lie") + " on another with the same corners: delete the copies.",
                                places.size())),
                      places);

    const EdgeTable edges(mesh.triangles);
    const EdgeFacts atEdges = edgeFacts(edges);
    int components = 0;
    const std::vector<std::int32_t> component = edgeComponents(mesh.triangles, edges, components);
    if (atEdges.openEdges > 0) {
        const std::size_t loops = boundaryLoops(edges).size();
        showTriangles(add(issue(Severity::Error, "open",
                                "The surface is open: " + counted(atEdges.openEdges, "edge has", "edges have") + " only one triangle" +
                                    (loops > 0 ? ", around " + counted(loops, "hole", "holes") : std::string()) + "; close it in a modelling program.",
                                std::max<std::size_t>(loops, 1))),
                      atEdges.open);
    }
    if (atEdges.nonManifoldEdges > 0)
        showTriangles(add(issue(Severity::Error, "non-manifold-edge",
                                counted(atEdges.nonManifoldEdges, "edge has", "edges have") +
                                    " more than two triangles: separate the surfaces that meet there, or delete inner walls and fins.",
                                atEdges.nonManifoldEdges)),
                      atEdges.nonManifold);
    if (atEdges.mixedEdges > 0)
        showTriangles(add(issue(Severity::Error, "mixed-winding",
                                "Triangles on the two sides of " + counted(atEdges.mixedEdges, "edge", "edges") +
                                    " face opposite ways: make the normals consistent in a modelling program.",
                                atEdges.mixedEdges)),
                      atEdges.mixed);
    const std::vector<std::int32_t> pinched = nonManifoldVertices(mesh.triangles, edges);
    if (!pinched.empty() && atEdges.nonManifoldEdges == 0)
        showVertices(add(issue(Severity::Error, "non-manifold-vertex",
                               "The surface touches itself in " + counted(pinched.size(), "vertex", "vertices") +
                                   ": separate the parts there, or import them as separate elements.",
                               pinched.size())),
                     pinched);

    const MeshFacts facts = meshFacts(mesh);
    std::size_t cavities = 0;
    if (atEdges.openEdges + atEdges.nonManifoldEdges + atEdges.mixedEdges == 0) {
        const Shells shells = findShells(mesh, component, components);
        std::size_t inverted = 0;
        places.clear();
        for (const Shells::Shell& shell : shells.shells) {
            cavities += shell.cavity();
            if (!shell.inverted()) continue;
            ++inverted;
            places.insert(places.end(), shell.triangles.begin(), shell.triangles.end());
        }
        if (inverted > 0)
            showTriangles(add(issue(Severity::Error, "inverted",
                                    counted(inverted, "surface faces", "surfaces face") + " inside out: flip the normals.", inverted)),
                          places);
        if (std::abs(facts.volume) < kThin * facts.area * facts.diagonal())
            add(issue(Severity::Warning, "flat",
                      "The body is extremely thin for its size, so that its deformation will be inaccurate: give it more thickness.", 1));
    }
    if (components > 1)
        add(issue(Severity::Info, "components",
                  "The mesh consists of " + std::to_string(components) + " separate surfaces" +
                      (cavities > 0 ? ", " + counted(cavities, "of them a cavity", "of them cavities") : std::string()) +
                      ": import them as separate elements if they are to move apart.",
                  static_cast<std::size_t>(components)));

    const double size = facts.diagonal();
    if (size > kHuge)
        add(issue(Severity::Warning, "huge", "The mesh is larger than a kilometre: choose the unit of its file.", 1));
    else if (size < kTiny)
        add(issue(Severity::Warning, "tiny", "The mesh is smaller than a millimetre: choose the unit of its file.", 1));
    if ((facts.low + facts.high).norm() / 2 > kFar * size)
        add(issue(Severity::Warning, "far-from-origin",
                  "The mesh lies more than ten thousand times its size from the origin, so that it will look rough: move it to the origin.", 1));

    const Attempt looking("looking for triangles that cross each other");
    const auto pairs = looking ? selfIntersections(mesh, kIntersections) : std::vector<std::pair<std::int32_t, std::int32_t>>();
    if (!pairs.empty()) {
        places.clear();
        for (const auto& [f, g] : pairs) places.push_back(f), places.push_back(g);
        std::sort(places.begin(), places.end());
        places.erase(std::unique(places.begin(), places.end()), places.end());
        showTriangles(add(issue(Severity::Warning, "self-intersection",
                                "The surface crosses itself: " + std::to_string(places.size()) + (pairs.size() >= kIntersections ? " or more" : "") +
                                    " triangles take part; separate them in a modelling program for an exact deformation.",
                                places.size())),
                      places);
    }
    return issues;
}

}  // namespace imomushi
