// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/skin_rig.h"

#include <algorithm>

namespace imomushi {

namespace {

/// The largest `kMax` of some joints; what the others have goes to `leader`. Sum 1 in single precision.
FittedSkin::Vertex largest(std::vector<std::pair<int, double>> parts, const std::vector<int>& leader) {
    const auto heavier = [](const auto& a, const auto& b) { return a.second > b.second || (a.second == b.second && a.first < b.first); };
    std::sort(parts.begin(), parts.end(), heavier);
    while (parts.size() > FittedSkin::kMax) {
        const auto [joint, weight] = parts.back();
        parts.pop_back();
        // To the one that carries it, or where that is not there to the next of its piece, which moves as it does; else to the heaviest.
        const int lead = leader[static_cast<std::size_t>(joint)];
        auto to = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == lead; });
        if (to == parts.end()) to = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return leader[static_cast<std::size_t>(p.first)] == lead; });
        if (to == parts.end()) to = parts.begin();
        to->second += weight;
        std::sort(parts.begin(), parts.end(), heavier);
    }
    FittedSkin::Vertex out;
    for (std::size_t k = 0; k < parts.size(); ++k) out.joint[k] = parts[k].first, out.weight[k] = static_cast<float>(parts[k].second);
    return out;
}

}  // namespace

std::vector<int> leadingJoints(const ExportScene& scene, int first) {
    std::vector<int> out(scene.elements.size(), -1);
    for (const ExportedRig& rig : scene.rigs) {
        for (std::size_t e = 0; e < rig.leads.size(); ++e)
            if (rig.leads[e] >= 0) out[e] = first + rig.leads[e];
        first += static_cast<int>(rig.rig->bones.size());
    }
    return out;
}

void shareAmongMerged(const ExportScene& scene, const Motion& motion, int first, FittedSkin& skin) {
    // Which joint stands for those that move as one with it.
    std::vector<int> leader(skin.joints.size());
    for (std::size_t j = 0; j < leader.size(); ++j) leader[j] = static_cast<int>(j);
    int begin = first;
    for (const ExportedRig& rig : scene.rigs) {
        for (std::size_t b = 0; b < rig.movers.size(); ++b) {
            const auto same = std::find(rig.movers.begin(), rig.movers.end(), rig.movers[b]) - rig.movers.begin();
            leader[static_cast<std::size_t>(begin) + b] = begin + static_cast<int>(same);
        }
        begin += static_cast<int>(rig.movers.size());
    }
    begin = first;
    for (const ExportedRig& rig : scene.rigs) {
        const RigWeights& file = rig.rig->weights;
        for (std::size_t e = 0; !file.empty() && e < skin.elements.size(); ++e) {
            if (motion.seen[e].mesh != rig.mesh) continue;
            for (std::size_t i = 0; i < skin.elements[e].size(); ++i) {
                auto& vertex = skin.elements[e][i];
                const auto v = static_cast<std::size_t>(motion.seen[e].vertices[i]);
                std::vector<std::pair<int, double>> parts;
                for (std::size_t k = 0; k < FittedSkin::kMax; ++k) {
                    if (!(vertex.weight[k] > 0.0f)) continue;
                    const int joint = vertex.joint[k], lead = leader[static_cast<std::size_t>(joint)];
                    const auto of = [&](std::int32_t n) { return begin + file.bone[static_cast<std::size_t>(n)]; };
                    double sum = 0.0;
                    for (std::int32_t n = file.first[v]; n < file.first[v + 1]; ++n)
                        if (leader[static_cast<std::size_t>(of(n))] == lead) sum += static_cast<double>(file.weight[static_cast<std::size_t>(n)]);
                    const bool isBone = skin.joints[static_cast<std::size_t>(joint)].rigBone >= 0;
                    if (!isBone || !(sum > 0.0)) {
                        parts.emplace_back(joint, static_cast<double>(vertex.weight[k]));
                        continue;
                    }
                    for (std::int32_t n = file.first[v]; n < file.first[v + 1]; ++n)
                        if (leader[static_cast<std::size_t>(of(n))] == lead)
                            parts.emplace_back(of(n), static_cast<double>(vertex.weight[k]) * static_cast<double>(file.weight[static_cast<std::size_t>(n)]) / sum);
                }
                vertex = largest(std::move(parts), leader);
            }
        }
        begin += static_cast<int>(rig.movers.size());
    }
}

void orderJoints(int first, FittedSkin& skin) {
    std::vector<char> used(skin.joints.size(), 0);
    for (const auto& element : skin.elements)
        for (const auto& vertex : element)
            for (std::size_t k = 0; k < FittedSkin::kMax; ++k)
                if (vertex.weight[k] > 0.0f) used[static_cast<std::size_t>(vertex.joint[k])] = 1;
    std::vector<std::size_t> order;
    for (auto j = static_cast<std::size_t>(first); j < skin.joints.size(); ++j) order.push_back(j);
    for (std::size_t j = 0; j < static_cast<std::size_t>(first); ++j)
        if (used[j]) order.push_back(j);
    std::vector<int> place(skin.joints.size(), 0);
    std::vector<FittedSkin::Joint> joints;
    for (const std::size_t j : order) {
        place[j] = static_cast<int>(joints.size());
        joints.push_back(skin.joints[j]);
    }
    skin.joints = std::move(joints);
    for (auto& clip : skin.tracks) {
        std::vector<FittedSkin::Track> tracks;
        for (const std::size_t j : order) tracks.push_back(std::move(clip[j]));
        clip = std::move(tracks);
    }
    for (auto& element : skin.elements)
        for (auto& vertex : element)
            for (std::size_t k = 0; k < FittedSkin::kMax; ++k)
                if (vertex.weight[k] > 0.0f) vertex.joint[k] = place[static_cast<std::size_t>(vertex.joint[k])];
}

}  // namespace imomushi
