// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/meeting_job.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/character/frame.h"
#include "core/effects/contact_job.h"

namespace imomushi {

namespace {

/// Points that are nearer than this many reaches at rest are near from the beginning.
constexpr double kNearAtRest = 2.0;
/// Elements without a common joint meet where such points come this part of their distance near.
constexpr double kNearer = 0.5;

/// m: no point of a triangle is farther from the nearest of its corners.
double widestTriangle(const TriangleMesh& body) {
    double longest = 0.0;
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) longest = std::max(longest, (body.vertices.row(body.triangles(t, k)) - body.vertices.row(body.triangles(t, (k + 1) % 3))).squaredNorm());
    return std::sqrt(longest / 3.0);
}

/// Vertices that lie as far from each other as can be, from the one that is farthest from the middle on. `reach`: how far the others are from them at most, m.
std::vector<std::int32_t> spreadPoints(const Points& vertices, const std::vector<std::int32_t>& from, const Vec3& middle, std::size_t most, double& reach) {
    std::vector<std::int32_t> out;
    std::vector<double> distance(from.size(), std::numeric_limits<double>::infinity());
    std::size_t next = 0;
    double farthest = -1.0;
    for (std::size_t i = 0; i < from.size(); ++i)
        if (const double d = (vertices.row(from[i]).transpose() - middle).squaredNorm(); d > farthest) farthest = d, next = i;
    reach = 0.0;
    while (out.size() < std::min(most, from.size())) {
        out.push_back(from[next]);
        const Vec3 at = vertices.row(from[next]).transpose();
        farthest = 0.0;
        for (std::size_t i = 0; i < from.size(); ++i) {
            distance[i] = std::min(distance[i], (vertices.row(from[i]).transpose() - at).squaredNorm());
            if (distance[i] > farthest) farthest = distance[i], next = i;
        }
        reach = std::sqrt(farthest);
    }
    return out;
}

}  // namespace

MeetingJob::MeetingJob(const Frame& frame, bool pressing, std::shared_ptr<std::vector<std::size_t>> met) : FrameJob(ContactEffect::kName, {{Stage::Weights, FrameData::Elements | FrameData::Parameters | FrameData::Loads, {}}}), met_(std::move(met)), pressing_(pressing) {
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        const auto& of = frame.elements[e];
        const auto& given = of.runtime->input;
        if (!given.response || of.runtime->free.empty()) continue;
        Body body;
        body.element = e;
        body.presses = of.runtime->contact != nullptr;
        const Points& vertices = given.mesh->body.vertices;
        const auto points = spreadPoints(vertices, of.runtime->free, of.runtime->middle, kPoints, body.reach);
        body.reach += widestTriangle(given.mesh->body);
        const auto count = static_cast<Eigen::Index>(points.size());
        body.rest = body.now = Eigen::Matrix3Xd::Zero(3, count);
        body.columns = Eigen::MatrixXf::Zero(3 * count, of.weights().size());
        body.weights = Eigen::VectorXf::Zero(of.weights().size());
        body.moved = Eigen::VectorXf::Zero(3 * count);
        for (Eigen::Index p = 0; p < count; ++p) {
            const std::int32_t vertex = points[static_cast<std::size_t>(p)];
            body.rest.col(p) = vertices.row(vertex).transpose();
            const auto row = 3 * (std::lower_bound(of.runtime->free.begin(), of.runtime->free.end(), vertex) - of.runtime->free.begin());
            body.columns.block(3 * p, 0, 3, of.v.size()) = given.response->response.middleRows<3>(row).cast<float>();
            for (std::size_t l = 0; l < given.tables.loads.size(); ++l)
                body.columns.block<3, 1>(3 * p, of.v.size() + static_cast<Eigen::Index>(l)) = given.response->loads.block<3, 1>(row, given.tables.loads[l]).cast<float>();
        }
        bodies_.push_back(std::move(body));
    }
    const auto joined = [&](std::size_t a, std::size_t b) {
        const auto& of = frame.elements[a].jointOf;
        const auto& other = frame.elements[b].jointOf;
        return std::any_of(of.begin(), of.end(), [&](int joint) { return joint >= 0 && std::find(other.begin(), other.end(), joint) != other.end(); });
    };
    for (std::size_t a = 0; a < bodies_.size(); ++a)
        for (std::size_t b = a + 1; b < bodies_.size(); ++b)
            if (!bodies_[a].presses || !bodies_[b].presses) pairs_.push_back({a, b, joined(bodies_[a].element, bodies_[b].element)});
    met_->clear();
    met_->reserve(bodies_.size());
}

void MeetingJob::run(Stage, Frame& frame) {
    if (frame.again || frame.shifted) return;  // the same frame once more
    met_->clear();
    if (frame.replaying) return;
    for (Body& body : bodies_) {
        const auto& of = frame.elements[body.element];
        body.placed = false;
        body.bound = of.weights().cwiseAbs().dot(of.runtime->columnSize);
    }
    for (const Pair& pair : pairs_)
        if (isNear(frame, pair)) note(bodies_[pair.a]), note(bodies_[pair.b]);
    std::sort(met_->begin(), met_->end());
}

void MeetingJob::note(const Body& body) {
    if (!body.presses && std::find(met_->begin(), met_->end(), body.element) == met_->end()) met_->push_back(body.element);
}

void MeetingJob::place(const Frame& frame, Body& body) const {
    if (body.placed) return;
    body.placed = true;
    const auto& of = frame.elements[body.element];
    body.weights = of.weights().cast<float>();
    body.moved.noalias() = body.columns * body.weights;
    for (Eigen::Index p = 0; p < body.rest.cols(); ++p) body.now.col(p) = of.frame(body.rest.col(p) + body.moved.segment<3>(3 * p).cast<double>());
    body.box = {body.now.rowwise().minCoeff(), body.now.rowwise().maxCoeff()};
}

bool MeetingJob::isNear(const Frame& frame, const Pair& pair) {
    Body &a = bodies_[pair.a], &b = bodies_[pair.b];
    const auto &A = frame.elements[a.element], &B = frame.elements[b.element];
    if (!A.moved && !B.moved) return false;
    const double reach = a.reach + b.reach, apart = 0.5 * (A.runtime->size + B.runtime->size) + a.bound + b.bound + reach;
    if ((A.frame(A.runtime->middle) - B.frame(B.runtime->middle)).squaredNorm() > apart * apart) return false;
    place(frame, a);
    place(frame, b);
    const Vec3 out = Vec3::Constant(reach);
    const Bounds around{b.box.low - out, b.box.high + out};
    for (Eigen::Index p = 0; p < a.now.cols(); ++p) {
        const Vec3 at = a.now.col(p);
        if ((at.array() < around.low.array()).any() || (at.array() > around.high.array()).any()) continue;
        for (Eigen::Index q = 0; q < b.now.cols(); ++q) {
            const double square = (b.now.col(q) - at).squaredNorm();
            if (square > reach * reach) continue;
            const double atRest = (b.rest.col(q) - a.rest.col(p)).norm();
            if (atRest > kNearAtRest * reach || (!pair.joined && square < kNearer * kNearer * atRest * atRest)) return true;
        }
    }
    return false;
}

std::size_t MeetingJob::bytes() const {
    std::size_t sum = 0;
    for (const Body& body : bodies_) sum += static_cast<std::size_t>(body.columns.size()) * sizeof(float);
    return sum;
}

void MeetingJob::report(Frame& frame, double ms) const { frame.setTime(ContactEffect::kName, ms + (pressing_ ? frame.stats.effectMs(ContactEffect::kName) : 0.0)); }

}  // namespace imomushi
