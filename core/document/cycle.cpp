// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/cycle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/document/kept_pose.h"

namespace imomushi {

double cycleWeight(std::size_t k, std::size_t count, double phase) {
    const auto n = static_cast<double>(count);
    double x = phase - static_cast<double>(k) / n;
    x -= std::round(x);
    // The sum 1 + 2 cos 2 pi x + 2 cos 4 pi x + ..., over n, in closed form; an even count ends with half of the last.
    const double angle = std::numbers::pi * x, below = n * (count % 2 == 1 ? std::sin(angle) : std::tan(angle));
    constexpr double kThere = 1e-9;  // rounds: the weight differs from 1 by the square of it
    return std::abs(x) < kThere ? 1.0 : std::sin(n * angle) / below;
}

const Cycles& cyclesOf(const Document& document) {
    static const Cycles kNone;
    return document.cycles ? *document.cycles : kNone;
}

const Cycle* cycleNamed(const Document& document, std::string_view name) {
    const Cycles& all = cyclesOf(document);
    const auto found = std::ranges::find(all, name, &Cycle::name);
    return found == all.end() ? nullptr : &*found;
}

void setCycles(Document& document, Cycles cycles) {
    if (document.cycles ? *document.cycles == cycles : cycles.empty()) return;
    document.cycles = cycles.empty() ? nullptr : std::make_shared<const Cycles>(std::move(cycles));
}

void renamePoseInCycles(Document& document, std::string_view from, std::string_view to) {
    Cycles cycles = cyclesOf(document);
    for (Cycle& cycle : cycles) std::ranges::replace(cycle.poses, std::string(from), std::string(to));
    setCycles(document, std::move(cycles));
}

std::vector<std::string> cyclesThrough(const Document& document, std::string_view pose) {
    std::vector<std::string> names;
    for (const Cycle& cycle : cyclesOf(document))
        if (std::ranges::find(cycle.poses, pose) != cycle.poses.end()) names.push_back(cycle.name);
    return names;
}

bool isWhole(const Document& document, const Cycle& cycle) {
    return std::ranges::all_of(cycle.poses, [&](const std::string& pose) { return keptPose(document, pose) != nullptr; });
}

Json cyclesJson(const Cycles& cycles) {
    Json list = Json::array();
    for (const Cycle& cycle : cycles) list.push_back({{"name", cycle.name}, {"poses", cycle.poses}, {"seconds", cycle.seconds}});
    return list;
}

Result<Cycles> cyclesFrom(const Json& list) {
    const auto broken = [] { return fail("bad-cycle", "A cycle is broken."); };
    if (!list.is_array() || list.size() > Cycle::kMost) return broken();
    Cycles cycles;
    for (const Json& line : list) {
        if (!line.is_object() || !line.contains("name") || !line.contains("poses") || !line.contains("seconds")) return broken();
        const Json &name = line["name"], &poses = line["poses"], &seconds = line["seconds"];
        if (!name.is_string() || name.get_ref<const std::string&>().empty() || !poses.is_array() || !seconds.is_number()) return broken();
        Cycle cycle{name.get<std::string>(), {}, seconds.get<double>()};
        if (poses.size() < Cycle::kFewestPoses || poses.size() > Cycle::kMostPoses || !(cycle.seconds >= Cycle::kShortest && cycle.seconds <= Cycle::kLongest)) return broken();
        for (const Json& pose : poses) {
            if (!pose.is_string()) return broken();
            cycle.poses.push_back(pose.get<std::string>());
        }
        if (std::ranges::find(cycles, cycle.name, &Cycle::name) != cycles.end()) return broken();
        cycles.push_back(std::move(cycle));
    }
    return cycles;
}

}  // namespace imomushi
