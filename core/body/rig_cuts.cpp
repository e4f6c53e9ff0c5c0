// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/rig_cuts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace imomushi {

namespace {

constexpr double kSharpest = -0.5;      // cosine of the largest bend at a joint whose bisector is taken: beyond, a limb goes back along its parent
constexpr double kBelongs = 0.5;        // of a vertex's flesh: what lies beyond a joint
constexpr double kBetterPlane = 0.7;  // another plane is taken if it misplaces this part of what the bisector does,
constexpr double kWorthIt = 0.05;       // and if the difference is this part of the limb's flesh
constexpr double kReach = 0.35;         // of the length of the shorter bone: how far a plane may be moved

Vec3 placeOf(const Points& points, Eigen::Index i) { return points.row(i).transpose(); }

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
    Vec3 middle = Vec3::Zero();
    double share = 0.0;
    for (std::size_t r = 0; r < rig_.bones.size(); ++r)
        if (merged.mover[r] == static_cast<int>(kept)) {
            share += flesh_.share[r];
            middle += flesh_.share[r] * flesh_.middle[r];
        }
    if (share > 0.0 && (middle / share - head).norm() > near) return (middle / share - head).normalized();
    return along.norm() > near ? along.normalized() : Vec3::UnitY();
}

double RigCuts::misplaced(const std::vector<double>& own, const CutPlane& plane) const {
    const auto vertices = static_cast<std::size_t>(body_.vertices.rows());
    const auto inFront = [&](std::size_t v) { return plane.normal.dot(placeOf(body_.vertices, static_cast<Eigen::Index>(v)) - plane.origin) > 0.0; };
    // What the cut would take: in front of the plane and connected there with what belongs beyond the joint.
    std::vector<char> taken(vertices, 0);
    std::vector<std::size_t> open;
    for (std::size_t v = 0; v < vertices; ++v)
        if (own[v] > 0.9 && inFront(v)) {
            taken[v] = 1;
            open.push_back(v);
        }
    while (!open.empty()) {
        const std::size_t v = open.back();
        open.pop_back();
        for (auto i = static_cast<std::size_t>(firstNeighbour_[v]); i < static_cast<std::size_t>(firstNeighbour_[v + 1]); ++i) {
            const auto other = static_cast<std::size_t>(neighbour_[i]);
            if (taken[other] || !inFront(other)) continue;
            taken[other] = 1;
            open.push_back(other);
        }
    }
    double wrong = 0.0;
    for (std::size_t v = 0; v < vertices; ++v) wrong += flesh_.volume[v] * std::abs((taken[v] ? 1.0 : 0.0) - own[v]);
    return wrong;
}

std::vector<WishedCut> RigCuts::cuts(const MergedRig& merged) const {
    const auto vertices = static_cast<std::size_t>(body_.vertices.rows());
    std::vector<WishedCut> wished(merged.kept.size());
    for (std::size_t k = 1; k < merged.kept.size(); ++k) {
        std::vector<char> beyond(merged.kept.size(), 0);
        beyond[k] = 1;
        for (std::size_t c = k + 1; c < merged.kept.size(); ++c) beyond[c] = beyond[static_cast<std::size_t>(merged.parent[c])];
        std::vector<double> own(vertices, 0.0);
        double limb = 0.0;
        for (std::size_t v = 0; v < vertices; ++v) {
            for (auto i = static_cast<std::size_t>(flesh_.first[v]); i < static_cast<std::size_t>(flesh_.first[v + 1]); ++i)
                if (beyond[static_cast<std::size_t>(merged.mover[static_cast<std::size_t>(flesh_.bone[i])])]) own[v] += flesh_.weight[i];
            limb += flesh_.volume[v] * own[v];
        }

        const Vec3 head = rig_.bones[static_cast<std::size_t>(merged.kept[k])].head, out = direction(merged, k);
        const auto above = static_cast<std::size_t>(merged.parent[k]);
        const Vec3 from = head - rig_.bones[static_cast<std::size_t>(merged.kept[above])].head;
        Vec3 bisector = out;
        if (from.norm() > 1e-3 * diagonal_ && from.normalized().dot(out) > kSharpest) bisector = (from.normalized() + out).normalized();
        CutPlane best{head, bisector};
        double least = misplaced(own, best);
        const double needed = std::min(kBetterPlane * least, least - kWorthIt * limb);
        double lowest = needed;
        const auto offer = [&](const CutPlane& plane) {
            const double wrong = misplaced(own, plane);
            if (wrong >= lowest) return;
            lowest = wrong;
            best = plane;
        };
        offer({head, out});
        // Where the skin goes over from one to the other: the places on edges where half of the flesh belongs beyond.
        Vec3 middle = Vec3::Zero();
        std::vector<Vec3> places;
        for (std::size_t v = 0; v < vertices; ++v)
            for (auto i = static_cast<std::size_t>(firstNeighbour_[v]); i < static_cast<std::size_t>(firstNeighbour_[v + 1]); ++i) {
                const auto w = static_cast<std::size_t>(neighbour_[i]);
                if (own[v] <= kBelongs || own[w] > kBelongs) continue;
                const double t = (own[v] - kBelongs) / (own[v] - own[w]);
                places.push_back((1.0 - t) * placeOf(body_.vertices, static_cast<Eigen::Index>(v)) + t * placeOf(body_.vertices, static_cast<Eigen::Index>(w)));
                middle += places.back();
            }
        if (places.size() >= 3) {
            middle /= static_cast<double>(places.size());
            Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
            for (const Vec3& p : places) spread += (p - middle) * (p - middle).transpose();
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
            Vec3 normal = axes.eigenvectors().col(0);
            if (normal.dot(bisector) < 0.0) normal = -normal;
            offer({middle, bisector});
            offer({middle, normal});
            offer({middle, (normal + bisector).normalized()});
        }
        wished[k].plane = best;
        const double length = std::min((rig_.bones[static_cast<std::size_t>(merged.kept[k])].tail - head).norm(), from.norm());
        wished[k].reach = kReach * std::max(length, 0.02 * diagonal_);
    }
    return wished;
}

}  // namespace imomushi
