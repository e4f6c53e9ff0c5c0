// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/rig_movers.h"

#include <algorithm>

#include "core/document/rig_follower.h"

namespace imomushi {

ExportedRig rigMovers(const Document& document, const CharacterPlan& plan, const CharacterSource& character, const EmbeddedMesh& mesh) {
    ExportedRig out;
    out.rig = character.rig;
    const Rig& rig = *character.rig;
    const RigFollower follower(document, plan, character);
    const std::vector<int>& follows = follower.follows();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };

    // Own bones: by name, by where they start, or whatever follows.
    out.movers.resize(rig.bones.size());
    double size = 0.0;
    for (const RigBone& bone : rig.bones) size = std::max(size, (bone.head - rig.bones[0].head).norm());
    std::vector<int> worth(rig.bones.size(), 0);
    for (std::size_t b = 0; b < follows.size(); ++b) {
        if (follows[b] < 0) continue;
        const RigBone& bone = rig.bones[at(follows[b])];
        const Vec3& start = plan.input.skeleton.points[at(plan.input.skeleton.bones[b].start)];
        const int own = document.bones.at(plan.bones[b])->name == bone.name ? 3 : (start - bone.head).norm() <= 1e-6 * size ? 2 : 1;
        if (own <= worth[at(follows[b])]) continue;
        worth[at(follows[b])] = own;
        out.movers[at(follows[b])].bone = static_cast<int>(b);
    }

    // Which of them leads each element.
    out.leads.assign(plan.elements.size(), -1);
    const std::vector<PartId> own = document.elementsOf(character.id);
    for (std::size_t e = 0; e < out.leads.size(); ++e) {
        if (!std::binary_search(own.begin(), own.end(), plan.elements[e])) continue;
        int best = 0;
        for (const int b : plan.input.elements[e].bones) {
            const int leader = follows[at(b)];
            if (leader < 0) continue;
            const int rank = out.movers[at(leader)].bone == b ? 2 : 1;
            if (rank <= best) continue;
            best = rank;
            out.leads[e] = leader;
        }
    }

    // The others go with the element of their flesh.
    std::vector<std::vector<double>> flesh(rig.bones.size(), std::vector<double>(plan.elements.size(), 0.0));
    for (std::size_t v = 0; v + 1 < rig.weights.first.size(); ++v)
        for (auto i = at(rig.weights.first[v]); i < at(rig.weights.first[v + 1]); ++i) flesh[at(rig.weights.bone[i])][at(mesh.vertices[v].element)] += static_cast<double>(rig.weights.weight[i]);
    std::vector<char> known(rig.bones.size(), 0);
    for (std::size_t r = 0; r < rig.bones.size(); ++r) {
        auto& mover = out.movers[r];
        known[r] = mover.bone >= 0;
        if (known[r]) continue;
        const auto most = std::max_element(flesh[r].begin(), flesh[r].end());
        if (most != flesh[r].end() && *most > 0.0) {
            const auto element = static_cast<std::size_t>(most - flesh[r].begin());
            if (const int leader = out.leads[element]; leader >= 0)
                mover = out.movers[at(leader)];
            else
                mover.element = static_cast<int>(element);
            known[r] = 1;
        } else if (const int parent = rig.bones[r].parent; parent >= 0 && known[at(parent)]) {
            mover = out.movers[at(parent)];
            known[r] = 1;
        }
    }
    for (std::size_t r = rig.bones.size(); r-- > 0;)
        if (const int parent = rig.bones[r].parent; parent >= 0 && known[r] && !known[at(parent)]) {
            // Roots without flesh; the first child comes last here.
            out.movers[at(parent)] = out.movers[r];
            known[at(parent)] = 2;
        } else if (parent >= 0 && known[r] && known[at(parent)] == 2) {
            out.movers[at(parent)] = out.movers[r];
        }
    for (std::size_t r = 0; r < rig.bones.size(); ++r)
        if (const int parent = rig.bones[r].parent; !known[r] && parent >= 0) out.movers[r] = out.movers[at(parent)];
    return out;
}

}  // namespace imomushi
