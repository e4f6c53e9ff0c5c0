// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/rig_cuts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/decompositions.h"

namespace imomushi {

namespace {

constexpr double kSharpest = -0.5;      // cosine of the largest bend at a joint whose bisector is taken: beyond, a limb goes back along its parent
constexpr double kBelongs = 0.5;        // of a vertex's flesh: what lies beyond a joint
constexpr double kFarther[] = {0.5, 1.0};                // radii of the section
constexpr double kAlong[] = {0.15, 0.3, 0.5};            // of the bone
constexpr double kAlongLimb[] = {0.15, 0.3, 0.45, 0.6};  // of the way to its tip
constexpr double kBack[] = {0.15, 0.3};                  // of the way to the joint before
constexpr double kLean[] = {0.35, 0.7};                  // radians
constexpr double kSlanting = 0.7;                        // cosine: two directions are too near to each other for an axis across both
constexpr double kLeastWay = 0.02;                       // diagonals
constexpr double kAstray = 0.5;                          // cosine between both middles, and between flesh and bone
constexpr double kAside = 0.15;                          // of a bone: flesh whose middle is nearer to the head lies around it
constexpr double kMostShift = 0.35;                      // of the length of the shorter bone: how far a plane may be moved

}  // namespace

RigCuts::RigCuts(const Rig& rig, const RigFlesh& flesh, const TriangleMesh& body) : rig_(rig), flesh_(flesh), body_(body) {
    std::vector<std::pair<std::int32_t, std::int32_t>> edges;
    for (Eigen::Index f = 0; f < body.triangles.rows(); ++f)
        for (int k = 0; k < 3; ++k) edges.emplace_back(body.triangles(f, k), body.triangles(f, (k + 1) % 3));  // closed: each once in each direction
    std::sort(edges.begin(), edges.end());
    firstNeighbour_.assign(static_cast<std::size_t>(body.vertices.rows()) + 1, 0);
    for (const auto& [from, to] : edges) {
        ++firstNeighbour_[static_cast<std::size_t>(from) + 1];
        neighbour_.push_back(to);
    }
    for (std::size_t v = 1; v < firstNeighbour_.size(); ++v) firstNeighbour_[v] += firstNeighbour_[v - 1];
    diagonal_ = (body.vertices.colwise().maxCoeff() - body.vertices.colwise().minCoeff()).norm();
}

Vec3 RigCuts::direction(const MergedRig& merged, std::size_t kept) const {
    const auto b = static_cast<std::size_t>(merged.kept[kept]);
    const Vec3 head = rig_.bones[b].head;
    const double near = 1e-3 * diagonal_;
    // The next joint of the file within the same flesh, or the first one beyond it, if the bone goes on there.
    const Vec3 along = rig_.bones[b].tail - head;
    bool goesOn = false;
    for (const RigBone& other : rig_.bones) goesOn = goesOn || (other.parent == static_cast<std::int32_t>(b) && other.head == rig_.bones[b].tail);
    if (goesOn && along.norm() > near) return along.normalized();
    // The middle of its flesh; where a little of its weight lies far away on its neighbours, of what it moves more than any other.
    Vec3 all = Vec3::Zero(), belonging = Vec3::Zero();
    double whole = 0.0, share = 0.0;
    for (std::size_t r = 0; r < rig_.bones.size(); ++r)
        if (merged.mover[r] == static_cast<int>(kept)) {
            whole += flesh_.share[r];
            all += flesh_.share[r] * (flesh_.middle[r] - head);
        }
    for (std::size_t v = 0; v + 1 < flesh_.first.size(); ++v) {
        double own = 0.0;
        for (auto i = static_cast<std::size_t>(flesh_.first[v]); i < static_cast<std::size_t>(flesh_.first[v + 1]); ++i)
            if (merged.mover[static_cast<std::size_t>(flesh_.bone[i])] == static_cast<int>(kept)) own += flesh_.weight[i];
        if (own <= kBelongs) continue;
        share += flesh_.volume[v] * own;
        belonging += flesh_.volume[v] * own * (vertexPlace(body_.vertices, static_cast<Eigen::Index>(v)) - head);
    }
    const bool astray = all.dot(belonging) < kAstray * all.norm() * belonging.norm();
    // A joint in the middle of its flesh says nothing by where the rest lies: rounding would decide.
    const Vec3 middle = astray && share > 0.0 ? Vec3(belonging / share) : whole > 0.0 ? Vec3(all / whole) : Vec3(Vec3::Zero());
    if (middle.norm() > std::max(near, kAside * along.norm())) return middle.normalized();
    return along.norm() > near ? along.normalized() : Vec3::UnitY();
}

RigCuts::Wish RigCuts::wish(const MergedRig& merged, std::size_t k, const std::optional<CutPlane>& mirror) const {
    const auto vertices = static_cast<std::size_t>(body_.vertices.rows());
    std::vector<char> beyond(merged.kept.size(), 0);
    beyond[k] = 1;
    for (std::size_t c = k + 1; c < merged.kept.size(); ++c) beyond[c] = beyond[static_cast<std::size_t>(merged.parent[c])];
    const Vec3 head = rig_.bones[static_cast<std::size_t>(merged.kept[k])].head, out = direction(merged, k);
    Wish wish;
    wish.own.assign(vertices, 0.0);
    std::vector<double>& own = wish.own;
    double length = 0.0;
    Vec3 tip = head;  // the farthest place that belongs beyond
    for (std::size_t v = 0; v < vertices; ++v) {
        for (auto i = static_cast<std::size_t>(flesh_.first[v]); i < static_cast<std::size_t>(flesh_.first[v + 1]); ++i)
            if (beyond[static_cast<std::size_t>(merged.mover[static_cast<std::size_t>(flesh_.bone[i])])]) own[v] += flesh_.weight[i];
        const Vec3 at = vertexPlace(body_.vertices, static_cast<Eigen::Index>(v));
        if (own[v] <= kBelongs || (at - head).norm() <= length) continue;
        length = (at - head).norm();
        tip = at;
    }

    const Vec3 from = head - rig_.bones[static_cast<std::size_t>(merged.kept[static_cast<std::size_t>(merged.parent[k])])].head;
    Vec3 bisector = out;
    if (from.norm() > 1e-3 * diagonal_ && from.normalized().dot(out) > kSharpest) bisector = (from.normalized() + out).normalized();
    wish.planes.push_back({head, bisector});
    wish.planes.push_back({head, out});
    // Where the skin goes over from one to the other: the places on edges where half of the flesh belongs beyond.
    Vec3 middle = Vec3::Zero();
    std::vector<Vec3> places;
    for (std::size_t v = 0; v < vertices; ++v)
        for (auto i = static_cast<std::size_t>(firstNeighbour_[v]); i < static_cast<std::size_t>(firstNeighbour_[v + 1]); ++i) {
            const auto w = static_cast<std::size_t>(neighbour_[i]);
            if (own[v] <= kBelongs || own[w] > kBelongs) continue;
            const double t = (own[v] - kBelongs) / (own[v] - own[w]);
            places.push_back((1.0 - t) * vertexPlace(body_.vertices, static_cast<Eigen::Index>(v)) + t * vertexPlace(body_.vertices, static_cast<Eigen::Index>(w)));
            middle += places.back();
        }
    double radius = diagonal_;  // of the section
    Vec3 side = mirror ? mirror->normal : Vec3(Vec3::UnitX());  // a direction across most limbs
    std::vector<Vec3> normals{bisector, out}, origins{head};
    // Flesh that is spread over other limbs misleads: as the bone itself points.
    const Vec3 bone = rig_.bones[static_cast<std::size_t>(merged.kept[k])].tail - head;
    if (bone.norm() > 1e-3 * diagonal_ && bone.normalized().dot(out) < kAstray) normals.push_back(bone.normalized());
    if (places.size() >= 3) {
        middle /= static_cast<double>(places.size());
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        for (const Vec3& p : places) spread += (p - middle) * (p - middle).transpose() / static_cast<double>(places.size());
        radius = std::sqrt(spread.trace());
        const auto axes = eigenpairsOf(spread);
        if (!mirror) side = axes.vectors.col(2);
        Vec3 normal = axes.vectors.col(0);
        if (normal.dot(bisector) < 0.0) normal = -normal;
        const Vec3 between = (normal + bisector).normalized();
        for (const Vec3& n : {bisector, normal, between}) wish.planes.push_back({middle, n});
        // Farther out the limb is narrower, and other limbs are farther away.
        for (const double part : kFarther) wish.planes.push_back({middle + part * radius * out, between});
        normals.insert(normals.end(), {normal, between});
        origins.push_back(middle);
        for (const double part : kFarther) origins.push_back(middle + part * radius * out);
    }
    const double along = std::min(std::max(bone.norm(), kLeastWay * diagonal_), length);
    for (const double part : kAlong) origins.push_back(head + part * along * out);
    if (from.norm() > 1e-3 * diagonal_)
        for (const double part : kBack) origins.push_back(head - part * from);
    const Vec3 across = (std::abs(side.dot(bisector)) < kSlanting ? side : bisector.unitOrthogonal()).cross(bisector).normalized(), other = bisector.cross(across);
    for (const double lean : kLean)
        for (const Vec3& axis : {across, Vec3(-across), other, Vec3(-other)}) normals.push_back(Eigen::AngleAxisd(lean, axis) * bisector);
    for (const Vec3& origin : origins)
        for (const Vec3& normal : normals) wish.more.push_back({origin, normal});
    // Along the whole limb, whose first joints may lie deep in the trunk.
    if (length > 0.0)
        for (const double part : kAlongLimb)
            for (const Vec3& normal : {Vec3((tip - head) / length), bisector, out}) wish.more.push_back({head + part * (tip - head), normal});
    const double shorter = std::min(bone.norm(), from.norm());
    wish.reach = kMostShift * std::max(shorter, kLeastWay * diagonal_);
    wish.importance = length / std::max(radius, 1e-6 * diagonal_);
    return wish;
}

}  // namespace imomushi
