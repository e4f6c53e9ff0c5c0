// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/solver_mesh_setting.h"

#include <array>
#include <charconv>
#include <utility>

namespace imomushi {
namespace {

using Kind = SolverMeshSetting::Kind;

/// Names that stand alone, and names that a count follows.
constexpr std::array<std::pair<std::string_view, Kind>, 5> kPlain{{{"as-is", Kind::AsIs}, {"default", Kind::Default}, {"best", Kind::Best}, {"draft", Kind::Draft}, {"volume", Kind::Volume}}};
constexpr std::array<std::pair<std::string_view, Kind>, 3> kCounted{{{"refined", Kind::Refined}, {"decimated", Kind::Decimated}, {"volume", Kind::Volume}}};

}  // namespace

Result<SolverMeshSetting> parseSolverMesh(std::string_view text) {
    for (const auto& [name, kind] : kPlain)
        if (text == name) return SolverMeshSetting{kind, 0};
    for (const auto& [name, kind] : kCounted) {
        if (!text.starts_with(name)) continue;
        const std::string example = std::string(name) + ":2000";
        if (text.size() == name.size())
            return fail("bad-value", "The solver mesh \"" + std::string(name) + "\" needs a number of vertices; write it as in \"" + example + "\".");
        if (text[name.size()] != ':') break;
        const std::string_view digits = text.substr(name.size() + 1);
        const auto wrong = [&] {
            return fail("bad-value", "\"" + std::string(digits) + "\" is not a number of vertices; write whole digits, as in \"" + example + "\".");
        };
        // from_chars would take a minus sign.
        if (digits.empty() || digits.front() < '0' || digits.front() > '9') return wrong();
        int count = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
        if (end != digits.data() + digits.size()) return wrong();
        if (error != std::errc{} || count < SolverMeshSetting::kFewest || count > SolverMeshSetting::kMax)
            return fail("bad-value", "A solver mesh has " + std::to_string(SolverMeshSetting::kFewest) + " to " +
                                         std::to_string(SolverMeshSetting::kMax) + " vertices, not " + std::string(digits) +
                                         "; choose a number in that range.");
        return SolverMeshSetting{kind, count};
    }
    return fail("bad-value", "There is no solver mesh \"" + std::string(text) +
                                 "\"; choose \"as-is\", \"refined:N\", \"decimated:N\", \"default\", \"best\", \"draft\", \"volume\" or \"volume:N\".");
}

std::string solverMeshName(const SolverMeshSetting& setting) {
    for (const auto& [name, kind] : kPlain)
        if (setting.kind == kind && setting.count == 0) return std::string(name);
    for (const auto& [name, kind] : kCounted)
        if (setting.kind == kind) return std::string(name) + ":" + std::to_string(setting.count);
    return {};
}

}  // namespace imomushi
