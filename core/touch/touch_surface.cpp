// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/touch/touch_surface.h"

#include <algorithm>
#include <cmath>

#include "core/base/finite.h"
#include "core/mesh/bounds.h"
#include "core/mesh/connectivity.h"
#include "core/mesh/topology.h"

namespace imomushi {
namespace {

/// Mean squared distance of a finger's pressure from its centre, in squared reaches of a patch: of the pressure of one patch; of the patches around a point,
/// each by its weight there; what one smoothing over neighbouring patches adds.
constexpr double kVarianceOfPatch = 0.25, kVarianceOfWeights = 0.42, kVarianceOfSmoothing = 0.34;
/// The narrowest finger takes weights to this power: with a higher one it would jump from patch to patch as it moves.
constexpr double kSharpest = 3.0;
/// Patches of less than this share of the largest are left out: their parts are not seen, but their columns would be read.
constexpr double kMinShare = 1e-3;
/// Barycentric coordinates may leave the triangle by this much.
constexpr double kOutside = 1e-9;

}  // namespace

Result<std::shared_ptr<const TouchSurface>> TouchSurface::build(const ElementMesh& mesh, std::span<const JointFace> faces,
                                                                std::shared_ptr<const ElementResponse> response) {
    const auto bad = [] { return fail("bad-value", "The element has no precomputed touch for this mesh; precompute it again with touch."); };
    const TriangleMesh& body = mesh.body;
    if (!response || response->touch.patches.count() == 0) return bad();
    const TouchResponse& touch = response->touch;
    const Eigen::Index columns = 3 * touch.patches.count();
    const auto& p = touch.patches;
    bool fits = p.first.size() == static_cast<std::size_t>(body.vertices.rows()) + 1 && p.patch.size() == p.weight.size() &&
                touch.displacement.cols() == columns && touch.displacement.rows() == 3 * static_cast<Eigen::Index>(response->freeVertices.size()) &&
                touch.compliance.rows() == columns && touch.compliance.cols() == columns && touch.forces.cols() == columns &&
                touch.gradients.cols() == columns && touch.gradients.rows() == 9 * static_cast<Eigen::Index>(touch.probes.size());
    fits =
        fits && p.first.front() == 0 && static_cast<std::size_t>(p.first.back()) == p.patch.size() && std::is_sorted(p.first.begin(), p.first.end());
    for (const std::int32_t i : p.patch) fits = fits && i >= 0 && i < p.count();
    for (const std::int32_t v : response->freeVertices) fits = fits && v >= 0 && v < body.vertices.rows();
    for (const JointFace& face : faces)
        for (const std::int32_t f : face.triangles) fits = fits && f >= 0 && f < body.triangles.rows();
    if (!fits) return bad();
    return std::shared_ptr<const TouchSurface>(new TouchSurface(mesh, faces, std::move(response)));
}

TouchSurface::TouchSurface(const ElementMesh& mesh, std::span<const JointFace> faces, std::shared_ptr<const ElementResponse> response)
    : response_(std::move(response)), body_(mesh.body), normals_(mesh.connectivity().normals()) {
    const TriangleMesh& body = mesh.body;
    size_ = diagonalOf(body.vertices);
    row_.assign(static_cast<std::size_t>(body.vertices.rows()), -1);
    for (std::size_t i = 0; i < response_->freeVertices.size(); ++i)
        row_[static_cast<std::size_t>(response_->freeVertices[i])] = static_cast<std::int32_t>(3 * i);

    std::vector<std::int32_t> held, touchable;
    for (const JointFace& face : faces) held.insert(held.end(), face.triangles.begin(), face.triangles.end());
    touchable_ = touchableTriangles(body, mesh.connectivity().edges(), held);
    for (std::int32_t f = 0; f < body.triangles.rows(); ++f)
        if (touchable_[static_cast<std::size_t>(f)]) touchable.push_back(f);
    findOverlap(touchable);
    tree_ = std::make_unique<TriangleTree>(body, std::move(touchable));

    const auto& displacement = touch().displacement;
    largest_ = Eigen::VectorXd::Zero(touch().patches.count());
    for (Eigen::Index c = 0; c < displacement.cols(); ++c) {
        double most = 0.0;
        for (Eigen::Index i = 0; i < displacement.rows(); i += 3) most = std::max(most, static_cast<double>(displacement.block<3, 1>(i, c).squaredNorm()));
        largest_[c / 3] += std::sqrt(most);
    }
}

/// Integrals of products of weights over the surface, rows scaled to add up to 1.
void TouchSurface::findOverlap(const std::vector<std::int32_t>& triangles) {
    const TouchPatches& patches = touch().patches;
    const Eigen::Index count = patches.count();
    const Eigen::MatrixXd weights = patches.dense();
    overlap_ = Eigen::MatrixXd::Zero(count, count);
    for (const std::int32_t f : triangles) {
        const double area = areaVector(body_, f).norm();
        for (int a = 0; a < 3; ++a) {
            const auto v = static_cast<std::size_t>(body_.triangles(f, a));
            for (auto i = static_cast<std::size_t>(patches.first[v]); i < static_cast<std::size_t>(patches.first[v + 1]); ++i)
                for (int b = 0; b < 3; ++b)
                    overlap_.row(patches.patch[i]) += area * (a == b ? 2.0 : 1.0) * static_cast<double>(patches.weight[i]) * weights.row(body_.triangles(f, b));
        }
    }
    for (Eigen::Index p = 0; p < count; ++p) {
        const double sum = overlap_.row(p).sum();
        if (sum > 0.0)
            overlap_.row(p) /= sum;
        else
            overlap_(p, p) = 1.0;
    }
}

TouchSurface::Point TouchSurface::nearest(const Vec3& rest) const {
    if (!allFinite(rest)) return {};
    const TriangleTree::Hit hit = tree_->nearest(rest);
    return {hit.triangle, hit.barycentric, std::sqrt(hit.squaredDistance)};
}

TouchSurface::Point TouchSurface::nearestFacing(const Vec3& rest, const Vec3& direction) const {
    if (!allFinite(rest) || !allFinite(direction)) return {};
    const TriangleTree::Hit hit = tree_->nearestFacing(rest, direction);
    return hit.triangle < 0 ? nearest(rest) : Point{hit.triangle, hit.barycentric, std::sqrt(hit.squaredDistance)};
}

bool TouchSurface::canTouch(const Point& point) const {
    return point.triangle >= 0 && point.triangle < body_.triangles.rows() && allFinite(point.barycentric) && point.barycentric.minCoeff() >= -kOutside &&
           std::abs(point.barycentric.sum() - 1.0) <= 1e-6 && touchable_[static_cast<std::size_t>(point.triangle)];
}

std::array<std::int32_t, 3> TouchSurface::corners(std::int32_t triangle) const {
    return {body_.triangles(triangle, 0), body_.triangles(triangle, 1), body_.triangles(triangle, 2)};
}

double TouchSurface::narrowest() const { return std::sqrt(kVarianceOfPatch) * touch().patches.reach; }

/// Patches around the point by their weights there, sharpened for a small finger, smoothed over their neighbours for a large one.
void TouchSurface::weigh(const Point& point, double radius, Eigen::VectorXd& weights, Eigen::VectorXd& next) const {
    const TouchPatches& patches = touch().patches;
    weights.setZero();
    const auto at = corners(point.triangle);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto v = static_cast<std::size_t>(at[c]);
        for (auto i = static_cast<std::size_t>(patches.first[v]); i < static_cast<std::size_t>(patches.first[v + 1]); ++i)
            weights[patches.patch[i]] += point.barycentric[static_cast<Eigen::Index>(c)] * static_cast<double>(patches.weight[i]);
    }
    const double plain = std::sqrt(kVarianceOfWeights) * patches.reach;  // radius of the finger that presses patches by their weights
    if (radius > 0.0 && radius < plain) {
        const double power = 1.0 + (kSharpest - 1.0) * std::min(1.0, (plain - radius) / (plain - narrowest()));
        const double most = weights.maxCoeff();
        for (double& w : weights) w = w > 0.0 ? std::pow(w / most, power) : 0.0;
    } else if (radius > plain) {
        double smoothings =
            std::min((radius * radius / (patches.reach * patches.reach) - kVarianceOfWeights) / kVarianceOfSmoothing, static_cast<double>(kMaxSpread));
        for (; smoothings > 0.0; smoothings -= 1.0) {
            next.noalias() = overlap_.transpose() * weights;
            weights += std::min(smoothings, 1.0) * (next - weights);
        }
    }
    const double most = weights.maxCoeff();
    for (double& w : weights) w = std::max(0.0, w - kMinShare * most);
    weights /= weights.sum();
}

std::size_t TouchSurface::bytes() const {
    return static_cast<std::size_t>(overlap_.size() + largest_.size() + normals_.size() + body_.vertices.size()) * sizeof(double) +
           row_.size() * sizeof(std::int32_t) + static_cast<std::size_t>(body_.triangles.size()) * sizeof(std::int32_t);
}

}  // namespace imomushi
