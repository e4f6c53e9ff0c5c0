// SPDX-License-Identifier: GPL-3.0-or-later
// Support functions: how far a group of vertices reaches in many directions, in some poses. Vertices are taken one by one, each time the one that reaches farthest
// beyond those that were taken.
#include "core/effects/ground_vertices.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

namespace imomushi {

namespace {

constexpr int kDirections = 200;   // a quarter of a radian apart, about
constexpr double kBentBy[] = {0.8, 1.6};  // radians: how far the faces of a bent element are turned, each against the next
constexpr double kMissed = 0.002;  // sizes of the element: reaching less far beyond does not matter
constexpr double kCell = 1.0 / 32.0;  // sizes of the element: of vertices nearer to each other one is a candidate, besides those that reach farthest at rest

std::vector<Vec3> directions() {
    std::vector<Vec3> out;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < kDirections; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / kDirections, r = std::sqrt(1.0 - z * z);
        out.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
    }
    return out;
}

/// Of all groups: who reaches farthest at rest, and one vertex of each cell.
std::vector<std::int32_t> candidatesOf(const ElementRuntime& element, const std::vector<int>& groupOf, int groups, const std::vector<Vec3>& toward) {
    const Points& body = element.input.mesh->body.vertices;
    std::vector<std::int32_t> out;
    std::map<std::tuple<int, long, long, long>, std::int32_t> cells;
    std::vector<double> reach(static_cast<std::size_t>(groups) * toward.size(), -std::numeric_limits<double>::infinity());
    std::vector<std::int32_t> farthest(reach.size(), -1);
    for (std::size_t v = 0; v < groupOf.size(); ++v) {
        if (groupOf[v] < 0) continue;
        const Vec3 p = body.row(static_cast<Eigen::Index>(v)).transpose() - element.middle;
        const auto vertex = static_cast<std::int32_t>(v);
        const Vec3 cell = p * (element.inverseSize() / kCell);
        if (cells.try_emplace({groupOf[v], std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())}, vertex).second) out.push_back(vertex);
        const std::size_t first = static_cast<std::size_t>(groupOf[v]) * toward.size();
        for (std::size_t d = 0; d < toward.size(); ++d)
            if (const double r = toward[d].dot(p); r > reach[first + d]) reach[first + d] = r, farthest[first + d] = vertex;
    }
    for (const auto v : farthest)
        if (v >= 0) out.push_back(v);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

/// Candidates at rest, and in poses whose faces are turned against each other, about three axes, both ways.
std::vector<Eigen::Matrix3Xd> posesOf(const ElementRuntime& element, const std::vector<std::int32_t>& candidates) {
    const auto& given = element.input;
    const Points& body = given.mesh->body.vertices;
    Eigen::Matrix3Xd rest(3, static_cast<Eigen::Index>(candidates.size()));
    for (std::size_t c = 0; c < candidates.size(); ++c) rest.col(static_cast<Eigen::Index>(c)) = body.row(candidates[c]).transpose();
    std::vector<Eigen::Matrix3Xd> out = {rest};
    if (!given.response || element.columns() == 0) return out;
    const auto& response = *given.response;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(rest.size(), response.columns());
    std::vector<int> faceOf(candidates.size(), -1);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        const auto row = std::lower_bound(element.free.begin(), element.free.end(), candidates[c]);
        if (row != element.free.end() && *row == candidates[c]) {
            rows.middleRows<3>(3 * static_cast<Eigen::Index>(c)) = response.response.middleRows<3>(3 * (row - element.free.begin()));
            continue;
        }
        for (std::size_t f = 0; f < given.faces.size(); ++f)
            if (std::binary_search(given.faces[f].vertices.begin(), given.faces[f].vertices.end(), candidates[c])) faceOf[c] = static_cast<int>(f);
    }
    Eigen::VectorXd v = Eigen::VectorXd::Zero(response.columns());
    for (int axis = 0; axis < 3; ++axis)
        for (const double angle : {kBentBy[0], -kBentBy[0], kBentBy[1], -kBentBy[1]}) {
            std::vector<JointMap> maps(given.faces.size());
            for (std::size_t f = 0; f < given.faces.size(); ++f) {
                const auto& axes = given.faces[f].frame.axes;
                maps[f].linear = axes.transpose() * Eigen::AngleAxisd(f % 2 ? -angle : angle, Vec3::Unit(axis)).toRotationMatrix() * axes;
                double lost = 0.0;
                response.bases[f].coefficients(maps[f], element.restOfFace[f], given.faces[f].size, v.data() + response.firstColumn[f], lost);
            }
            const Eigen::VectorXd moved = rows * v;
            Eigen::Matrix3Xd posed = rest + Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, rest.cols());
            for (std::size_t c = 0; c < candidates.size(); ++c) {
                if (faceOf[c] < 0) continue;
                const auto& frame = given.faces[static_cast<std::size_t>(faceOf[c])].frame;
                const auto column = static_cast<Eigen::Index>(c);
                posed.col(column) = frame.origin + frame.axes * (maps[static_cast<std::size_t>(faceOf[c])].linear * frame.toLocal(rest.col(column)));
            }
            out.push_back(std::move(posed));
        }
    return out;
}

}  // namespace

std::vector<std::int32_t> lowestVertices(const ElementRuntime& element, const std::vector<int>& groupOf, std::size_t most) {
    const int groups = groupOf.empty() ? 0 : *std::max_element(groupOf.begin(), groupOf.end()) + 1;
    const std::vector<Vec3> toward = directions();
    const std::vector<std::int32_t> candidates = candidatesOf(element, groupOf, groups, toward);
    const std::vector<Eigen::Matrix3Xd> poses = posesOf(element, candidates);
    std::vector<std::int32_t> out;
    struct Reach {
        double all = -std::numeric_limits<double>::infinity(), taken = all;
        std::size_t who = 0;
    };
    std::vector<Reach> reach(poses.size() * toward.size());
    for (int group = 0; group < groups; ++group) {
        std::fill(reach.begin(), reach.end(), Reach{});
        std::size_t some = candidates.size();
        const auto pass = [&](std::size_t c, const auto& note) {
            for (std::size_t p = 0; p < poses.size(); ++p)
                for (std::size_t d = 0; d < toward.size(); ++d) note(reach[p * toward.size() + d], toward[d].dot(poses[p].col(static_cast<Eigen::Index>(c))));
        };
        for (std::size_t c = 0; c < candidates.size(); ++c) {
            if (groupOf[static_cast<std::size_t>(candidates[c])] != group) continue;
            some = std::min(some, c);
            pass(c, [c](Reach& r, double far) {
                if (far > r.all) r.all = far, r.who = c;
            });
        }
        for (std::size_t next = some, taken = 0; next < candidates.size() && taken < most; ++taken) {
            out.push_back(candidates[next]);
            pass(next, [](Reach& r, double far) { r.taken = std::max(r.taken, far); });
            double missed = kMissed * element.size;
            next = candidates.size();
            for (const Reach& r : reach)
                if (r.all - r.taken > missed) missed = r.all - r.taken, next = r.who;
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

}  // namespace imomushi
