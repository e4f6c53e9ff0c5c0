// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/repair.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/finite.h"
#include "core/body/prepared_surface.h"
#include "core/body/wrapped_body.h"
#include "core/mesh/shells.h"

namespace imomushi {
namespace {

struct Named {
    RepairAction action;
    std::string_view name;
};
constexpr std::array<Named, 6> kNames{{{RepairAction::Weld, "weld"},
                                       {RepairAction::Drop, "drop"},
                                       {RepairAction::Separate, "separate"},
                                       {RepairAction::Orient, "orient"},
                                       {RepairAction::Fill, "fill"},
                                       {RepairAction::Wrap, "wrap"}}};

struct Mends {
    std::string_view code;
    RepairAction action;
};
constexpr std::array<Mends, 11> kMends{{{"unwelded", RepairAction::Weld},
                                        {"degenerate", RepairAction::Drop},
                                        {"duplicate-triangle", RepairAction::Drop},
                                        {"unused-vertex", RepairAction::Drop},
                                        {"non-manifold-edge", RepairAction::Separate},
                                        {"non-manifold-vertex", RepairAction::Separate},
                                        {"mixed-winding", RepairAction::Orient},
                                        {"inverted", RepairAction::Orient},
                                        {"open", RepairAction::Fill},
                                        {"self-intersection", RepairAction::Wrap},
                                        {"non-orientable", RepairAction::Wrap}}};

void drop(MendSurface& s) {
    dropDuplicates(s);
    mendDegenerate(s);
}

/// The surface again, without vertices that nothing uses.
void extract(const MendSurface& s, Repaired& out) {
    std::vector<std::int32_t> number(static_cast<std::size_t>(s.points.rows()), -1);
    for (const MendFace& f : s.faces)
        for (const std::int32_t v : f.v) number[at(v)] = 0;
    std::vector<std::int32_t> used;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] < 0) continue;
        number[v] = static_cast<std::int32_t>(used.size());
        used.push_back(static_cast<std::int32_t>(v));
    }
    out.mesh.vertices = s.points(used, Eigen::all);
    out.mesh.triangles = s.triangles();
    for (Eigen::Index i = 0; i < out.mesh.triangles.size(); ++i) out.mesh.triangles.data()[i] = number[at(out.mesh.triangles.data()[i])];
    for (const MendFace& f : s.faces) out.part.push_back(f.part);
}

}  // namespace

void orientSurface(MendSurface& s) {
    windConsistently(s);
    const TriangleMesh mesh{s.points, s.triangles()};
    const EdgeTable edges(mesh.triangles);
    int count = 0;
    std::vector<std::int32_t> component = edgeComponents(mesh.triangles, edges, count);
    const std::vector<char> sound = soundComponents(mesh.triangles, edges, component, count);
    std::vector<std::int32_t> shellOf(at(count), -1);
    int shells = 0;
    for (std::size_t c = 0; c < sound.size(); ++c)
        if (sound[c]) shellOf[c] = shells++;
    for (std::int32_t& c : component) c = shellOf[at(c)];
    std::size_t turned = 0;
    for (const Shells::Shell& shell : findShells(mesh, component, shells).shells) {
        if (!shell.inverted()) continue;
        ++turned;
        for (const std::int32_t f : shell.triangles) s.faces[at(f)].turn();
    }
    if (turned > 0) s.say("inverted", counted(turned, "surface that faced inside out was", "surfaces that faced inside out were") + " turned.", turned);
}

std::string_view nameOf(RepairAction action) {
    return std::find_if(kNames.begin(), kNames.end(), [&](const Named& n) { return n.action == action; })->name;
}

std::optional<RepairAction> repairActionOf(std::string_view name) {
    const auto it = std::find_if(kNames.begin(), kNames.end(), [&](const Named& n) { return n.name == name; });
    return it == kNames.end() ? std::nullopt : std::optional(it->action);
}

std::optional<RepairAction> repairFor(std::string_view issueCode) {
    const auto it = std::find_if(kMends.begin(), kMends.end(), [&](const Mends& m) { return m.code == issueCode; });
    return it == kMends.end() ? std::nullopt : std::optional(it->action);
}

Result<Repaired> repairSurface(const TriangleMesh& mesh, std::span<const std::int32_t> part, RepairAction action, const Progress& progress) {
    if (auto ok = checkTriangles(mesh, part); !ok) return tl::unexpected(ok.error());
    Repaired out;
    MendSurface s(rawSurface(mesh, part));
    dropUnused(s);
    out.before = checkMesh({s.points, mesh.triangles});
    s.dropCollapsed();  // edges from a vertex to itself are none
    switch (action) {
        case RepairAction::Weld: weldVertices(s); break;
        case RepairAction::Drop: drop(s); break;
        case RepairAction::Separate: separateNonManifold(s); break;
        case RepairAction::Orient: orientSurface(s); break;
        case RepairAction::Fill:
            capHoles(s);
            closeHoles(s);
            break;
        case RepairAction::Wrap: break;
    }
    if (s.collapsed > 0) s.say("degenerate", counted(s.collapsed, "triangle without area was", "triangles without area were") + " removed.", s.collapsed);
    if (s.faces.empty()) return fail("no-volume", "The mesh has no triangle with an area: choose a file with a mesh.");
    extract(s, out);
    out.done = std::move(s.issues);
    if (action == RepairAction::Wrap) {
        auto wrap = wrappedBody(out.mesh, 0.0, 0.0, progress);
        if (!wrap) return tl::unexpected(wrap.error());
        out.mesh = std::move(wrap->mesh);
        out.part.clear();
        out.done.push_back(wrappedIssue("A new surface around everything was made."));
    }
    out.after = checkMesh(out.mesh);
    return out;
}

}  // namespace imomushi
