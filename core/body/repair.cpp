// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/repair.h"

#include <algorithm>
#include <array>

#include "core/body/prepared_surface.h"
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

}  // namespace imomushi
