// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/rig_flesh.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/formatted.h"
#include "core/base/json_member.h"
#include "core/mesh/humanoid.h"
#include "core/mesh/triangle_tree.h"

namespace imomushi {

namespace {

constexpr double kLeastWeight = 1e-4;
constexpr double kTrunk = 0.5;        // of the flesh: what hangs beside this much below a root hangs on it
constexpr double kLeastOfLimbs = 0.2;  // RigFlesh::leastFactor of limbs and hair

/// The segments that stand for bones: to the tail, and to the heads of children.
struct Segments {
    TriangleMesh mesh;  // degenerate triangles
    std::vector<std::int32_t> bone;

    explicit Segments(const Rig& rig) {
        std::vector<Vec3> points;
        const auto add = [&](std::size_t b, const Vec3& end) {
            points.push_back(rig.bones[b].head);
            points.push_back(end);
            bone.push_back(static_cast<std::int32_t>(b));
        };
        for (std::size_t b = 0; b < rig.bones.size(); ++b) {
            add(b, rig.bones[b].tail);
            if (rig.bones[b].parent >= 0) add(static_cast<std::size_t>(rig.bones[b].parent), rig.bones[b].head);
        }
        mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
        mesh.triangles.resize(static_cast<Eigen::Index>(bone.size()), 3);
        for (std::size_t i = 0; i < points.size(); ++i) mesh.vertices.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
        for (std::int32_t s = 0; s < static_cast<std::int32_t>(bone.size()); ++s) mesh.triangles.row(s) << 2 * s, 2 * s + 1, 2 * s + 1;
    }
};

/// Triangles of the render mesh with three corners that are bound.
std::vector<std::int32_t> boundTriangles(const Rig& rig, const TriangleMesh& render) {
    std::vector<std::int32_t> which;
    if (rig.weights.empty()) return which;
    for (std::int32_t f = 0; f < render.triangles.rows(); ++f) {
        bool all = true;
        for (int c = 0; c < 3; ++c) {
            const auto v = static_cast<std::size_t>(render.triangles(f, c));
            all = all && rig.weights.first[v] < rig.weights.first[v + 1];
        }
        if (all) which.push_back(f);
    }
    return which;
}

/// How much of the surface between vertices goes over from one bone to another.
class Contacts {
public:
    Contacts(const RigFlesh& flesh, const TriangleMesh& body) {
        for (Eigen::Index f = 0; f < body.triangles.rows(); ++f)
            for (int k = 0; k < 3; ++k) {  // closed: each edge once in each direction
                const auto v = static_cast<std::size_t>(body.triangles(f, k)), w = static_cast<std::size_t>(body.triangles(f, (k + 1) % 3));
                for (auto i = static_cast<std::size_t>(flesh.first[v]); i < static_cast<std::size_t>(flesh.first[v + 1]); ++i)
                    for (auto j = static_cast<std::size_t>(flesh.first[w]); j < static_cast<std::size_t>(flesh.first[w + 1]); ++j)
                        if (flesh.bone[i] != flesh.bone[j]) between_[{flesh.bone[i], flesh.bone[j]}] += flesh.weight[i] * flesh.weight[j];
            }
    }
    /// Of the bones of a limb with each other bone.
    [[nodiscard]] std::vector<double> of(const std::vector<char>& limb) const {
        std::vector<double> sums(limb.size(), 0.0);
        for (const auto& [bones, amount] : between_)
            if (limb[static_cast<std::size_t>(bones.first)] && !limb[static_cast<std::size_t>(bones.second)]) sums[static_cast<std::size_t>(bones.second)] += amount;
        return sums;
    }

private:
    std::map<std::pair<std::int32_t, std::int32_t>, double> between_;
};

/// Bones in an order in which carriers come first.
std::vector<int> carriersFirst(const std::vector<int>& carrier) {
    std::vector<int> order;
    std::vector<std::vector<int>> carried(carrier.size());
    for (std::size_t b = 0; b < carrier.size(); ++b)
        if (carrier[b] < 0)
            order.push_back(static_cast<int>(b));
        else
            carried[static_cast<std::size_t>(carrier[b])].push_back(static_cast<int>(b));
    for (std::size_t i = 0; i < order.size(); ++i) order.insert(order.end(), carried[static_cast<std::size_t>(order[i])].begin(), carried[static_cast<std::size_t>(order[i])].end());
    return order;
}

void findCarriers(const Rig& rig, const TriangleMesh& body, RigFlesh& flesh) {
    for (const RigBone& bone : rig.bones) flesh.carrier.push_back(bone.parent);
    if (!flesh.skinned) return;  // the nearest bone says nothing about what hangs together
    const std::size_t bones = rig.bones.size();
    std::vector<double> subtree = flesh.share;
    for (std::size_t b = bones; b-- > 0;)
        if (rig.bones[b].parent >= 0) subtree[static_cast<std::size_t>(rig.bones[b].parent)] += subtree[b];
    std::optional<Contacts> contacts;
    for (std::size_t root = 0; root < bones; ++root) {
        if (rig.bones[root].parent >= 0) continue;
        std::vector<std::size_t> limbs;
        std::size_t trunk = root;
        for (std::size_t b = root + 1; b < bones; ++b) {
            if (rig.bones[b].parent != static_cast<std::int32_t>(root)) continue;
            limbs.push_back(b);
            if (trunk == root || subtree[b] > subtree[trunk]) trunk = b;
        }
        if (limbs.size() < 2 || subtree[trunk] < kTrunk * subtree[root]) continue;
        const auto under = [&](std::size_t top) {
            std::vector<char> in(bones, 0);
            in[top] = 1;
            for (std::size_t b = top + 1; b < bones; ++b)
                if (rig.bones[b].parent >= 0 && in[static_cast<std::size_t>(rig.bones[b].parent)]) in[b] = 1;
            return in;
        };
        const std::vector<char> main = under(trunk);
        if (!contacts) contacts.emplace(flesh, body);
        for (const std::size_t limb : limbs) {
            if (limb == trunk || subtree[limb] <= 0.0) continue;
            std::vector<double> with = contacts->of(under(limb));
            const double above = with[root];
            for (std::size_t b = 0; b < bones; ++b)
                if (!main[b]) with[b] = 0.0;
            const auto most = std::max_element(with.begin(), with.end());
            if (*most > above) flesh.carrier[limb] = static_cast<int>(most - with.begin());
        }
    }
}

std::string percent(double share) { return formatted("%.2g %%", 100.0 * share); }

/// RigFlesh::leastFactor.
std::vector<double> leastFactors(const Rig& rig) {
    static constexpr std::array<std::string_view, 14> kLimbs{"head", "neck", "leftUpperLeg", "leftLowerLeg", "leftFoot", "rightUpperLeg", "rightLowerLeg", "rightFoot",
                                                             "leftUpperArm", "leftLowerArm", "leftHand", "rightUpperArm", "rightLowerArm", "rightHand"};
    std::vector<double> factors(rig.bones.size(), 1.0);
    for (const RigRole& role : humanRoles(rig))
        if (std::find(kLimbs.begin(), kLimbs.end(), role.role) != kLimbs.end()) factors[static_cast<std::size_t>(role.bone)] = kLeastOfLimbs;
    const auto avatar = nlohmann::json::parse(rig.avatar, nullptr, false);
    for (const auto& spring : jsonMember(jsonMember(avatar, "springBone"), "springs")) {
        const auto& joints = jsonMember(spring, "joints");
        if (!joints.is_array() || joints.empty()) continue;
        const auto& name = jsonMember(joints[0], "bone");
        const int bone = name.is_string() ? rig.boneIndex(name.get<std::string>()) : -1;
        if (bone >= 0) factors[static_cast<std::size_t>(bone)] = kLeastOfLimbs;
    }
    return factors;
}

}  // namespace

RigFlesh rigFlesh(const Rig& rig, const TriangleMesh& render, const TriangleMesh& body) {
    RigFlesh flesh;
    const std::size_t bones = rig.bones.size(), vertices = static_cast<std::size_t>(body.vertices.rows());
    const Segments segments(rig);
    const TriangleTree nearBones(segments.mesh);
    const std::vector<std::int32_t> bound = boundTriangles(rig, render);
    flesh.skinned = !bound.empty();
    std::optional<TriangleTree> skin;
    if (flesh.skinned) skin.emplace(render, bound);
    std::vector<Vec3> nearest(vertices);  // place on a bone
    flesh.first.push_back(0);
    std::map<std::int32_t, double> of;
    for (std::size_t v = 0; v < vertices; ++v) {
        const Vec3 p = vertexPlace(body.vertices, static_cast<Eigen::Index>(v));
        const auto bone = nearBones.nearest(p);
        const auto corners = segments.mesh.triangles.row(bone.triangle);
        nearest[v] = bone.barycentric[0] * vertexPlace(segments.mesh.vertices, corners[0]) + (1.0 - bone.barycentric[0]) * vertexPlace(segments.mesh.vertices, corners[1]);
        of.clear();
        if (skin) {
            const auto hit = skin->nearest(p);
            for (int c = 0; c < 3; ++c) {
                const auto r = static_cast<std::size_t>(render.triangles(hit.triangle, c));
                for (auto i = static_cast<std::size_t>(rig.weights.first[r]); i < static_cast<std::size_t>(rig.weights.first[r + 1]); ++i)
                    of[rig.weights.bone[i]] += hit.barycentric[c] * static_cast<double>(rig.weights.weight[i]);
            }
        } else {
            of[segments.bone[static_cast<std::size_t>(bone.triangle)]] = 1.0;
        }
        double sum = 0.0;
        std::erase_if(of, [](const auto& entry) { return entry.second < kLeastWeight; });
        for (const auto& [b, w] : of) sum += w;
        for (const auto& [b, w] : of) {
            flesh.bone.push_back(b);
            flesh.weight.push_back(w / sum);
        }
        flesh.first.push_back(static_cast<std::int32_t>(flesh.bone.size()));
    }

    // The flesh between the surface and the bones: that of a triangle is the cone to the places on bones nearest to its corners. Where the surface faces the bone from behind
    // there is none.
    flesh.volume.assign(vertices, 0.0);
    double whole = 0.0;
    for (Eigen::Index f = 0; f < body.triangles.rows(); ++f) {
        const std::int32_t* t = body.triangles.data() + 3 * f;
        const Vec3 a = vertexPlace(body.vertices, t[0]), b = vertexPlace(body.vertices, t[1]), c = vertexPlace(body.vertices, t[2]);
        const Vec3 area = 0.5 * (b - a).cross(c - a);
        for (int k = 0; k < 3; ++k) {
            const auto v = static_cast<std::size_t>(t[k]);
            const double volume = std::max(0.0, area.dot(vertexPlace(body.vertices, t[k]) - nearest[v])) / 3.0;
            flesh.volume[v] += volume;
            whole += volume;
        }
    }
    flesh.share.assign(bones, 0.0);
    std::vector<Vec3> moment(bones, Vec3::Zero());
    for (std::size_t v = 0; v < vertices; ++v) {
        flesh.volume[v] = whole > 0.0 ? flesh.volume[v] / whole : 1.0 / static_cast<double>(vertices);
        // The middle of a cone is a quarter of its height above its ground.
        const Vec3 middle = 0.75 * vertexPlace(body.vertices, static_cast<Eigen::Index>(v)) + 0.25 * nearest[v];
        for (auto i = static_cast<std::size_t>(flesh.first[v]); i < static_cast<std::size_t>(flesh.first[v + 1]); ++i) {
            const auto b = static_cast<std::size_t>(flesh.bone[i]);
            flesh.share[b] += flesh.volume[v] * flesh.weight[i];
            moment[b] += flesh.volume[v] * flesh.weight[i] * middle;
        }
    }
    for (std::size_t b = 0; b < bones; ++b) flesh.middle.push_back(flesh.share[b] > 0.0 ? Vec3(moment[b] / flesh.share[b]) : rig.bones[b].head);
    findCarriers(rig, body, flesh);
    flesh.leastFactor = leastFactors(rig);
    return flesh;
}

MergedRig mergeRig(const Rig& rig, const RigFlesh& flesh, double least, const std::vector<std::pair<int, std::string>>& never) {
    const auto bones = static_cast<int>(rig.bones.size());
    const auto at = [](int b) { return static_cast<std::size_t>(b); };
    std::vector<double> enough = flesh.leastFactor;
    for (double& of : enough) of *= least;
    std::vector<double> share = flesh.share, subtree = flesh.share;
    std::vector<int> parent, into(at(bones), -1);
    std::vector<const std::string*> forbidden(at(bones), nullptr);
    for (const auto& [b, why] : never) forbidden[at(b)] = &why;
    parent = flesh.carrier;
    std::vector<int> inward = carriersFirst(flesh.carrier);
    std::reverse(inward.begin(), inward.end());
    for (const int b : inward)
        if (parent[at(b)] >= 0) subtree[at(parent[at(b)])] += subtree[at(b)];

    MergedRig merged;
    const auto merge = [&](int b, int to) {
        const double small = share[at(b)];
        std::string why = forbidden[at(b)] ? *forbidden[at(b)] : small <= 0.0 ? "It moves no flesh." : "It moves " + percent(small) + " of the flesh, less than " + percent(enough[at(b)]) + ".";
        merged.merges.push_back({b, small, std::move(why)});
        into[at(b)] = to;
        share[at(to)] += small;
    };
    for (const int b : inward)
        if (parent[at(b)] >= 0 && (share[at(b)] < enough[at(b)] || forbidden[at(b)])) merge(b, parent[at(b)]);
    const auto moverOf = [&](int b) {
        while (into[at(b)] >= 0) b = into[at(b)];
        return b;
    };
    // Kept bones hang on kept bones.
    for (int b = 0; b < bones; ++b)
        if (parent[at(b)] >= 0) parent[at(b)] = moverOf(parent[at(b)]);
    // The root is the bone without a parent under which most flesh hangs, or below it.
    int root = -1;
    for (int b = 0; b < bones; ++b)
        if (flesh.carrier[at(b)] < 0 && (root < 0 || subtree[at(b)] > subtree[at(root)])) root = b;
    const auto isKept = [&](int b) { return into[at(b)] < 0; };
    while (share[at(root)] < enough[at(root)] || forbidden[at(root)]) {
        int child = -1;
        for (int b = 0; b < bones; ++b)
            if (isKept(b) && parent[at(b)] == root && (child < 0 || subtree[at(b)] > subtree[at(child)])) child = b;
        // Nothing is kept below it: another root takes its place.
        for (int b = 0; child < 0 && b < bones; ++b)
            if (isKept(b) && b != root && parent[at(b)] < 0 && !forbidden[at(b)] && share[at(b)] >= enough[at(b)]) child = b;
        if (child < 0) break;
        parent[at(child)] = -1;
        for (int b = 0; b < bones; ++b)
            if (isKept(b) && b != child && parent[at(b)] == root) parent[at(b)] = child;
        merge(root, child);
        root = child;
    }
    for (int b = 0; b < bones; ++b) {
        if (!isKept(b) || parent[at(b)] >= 0 || b == root) continue;
        if (share[at(b)] < enough[at(b)] || forbidden[at(b)]) {  // targets of inverse kinematics, for one
            for (int child = 0; child < bones; ++child)
                if (isKept(child) && parent[at(child)] == b) parent[at(child)] = root;
            merge(b, root);
        } else {
            parent[at(b)] = root;
        }
    }
    // Parents first, in the order of the rig otherwise.
    std::vector<int> place(at(bones), -1);
    const auto keep = [&](int b, int above) {
        place[at(b)] = static_cast<int>(merged.kept.size());
        merged.kept.push_back(b);
        merged.parent.push_back(above);
        merged.share.push_back(share[at(b)]);
    };
    keep(root, -1);
    for (std::size_t next = 0; next < merged.kept.size(); ++next)
        for (int b = 0; b < bones; ++b)
            if (isKept(b) && place[at(b)] < 0 && parent[at(b)] == merged.kept[next]) keep(b, static_cast<int>(next));
    for (int b = 0; b < bones; ++b) merged.mover.push_back(place[at(moverOf(b))]);
    std::sort(merged.merges.begin(), merged.merges.end(), [](const auto& a, const auto& b) { return a.bone < b.bone; });
    return merged;
}

}  // namespace imomushi
