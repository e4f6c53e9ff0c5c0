// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/embedded_mapping.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/finite.h"
#include "core/base/parallel.h"
#include "core/mesh/bounds.h"
#include "core/mesh/triangle_tree.h"
#include "core/reduction/surface_gradient.h"

namespace imomushi {

namespace {

/// Points per piece of work: some milliseconds.
constexpr std::size_t kPointGrain = 2048;
/// A triangle that was squashed or blown up by more than this factor of its area gets no thicker or thinner.
constexpr double kMostArea = 8.0;

/// Where points find the surface that they follow.
class FollowedSurface {
public:
    FollowedSurface(const EmbeddedMapping::Input& input, const std::vector<TriangleFrame>& frames)
        : body_(*input.body), deep_(EmbeddedMapping::kDeep * diagonalOf(input.body->vertices)) {
        faceOf_.assign(frames.size(), -1);
        for (std::size_t f = 0; f < input.faces.size(); ++f) {
            std::vector<std::int32_t> all;
            for (const auto t : input.faces[f].triangles) {
                faceOf_[static_cast<std::size_t>(t)] = static_cast<int>(f);
                if (frames[static_cast<std::size_t>(t)].area > 0.0) all.push_back(t);
            }
            faces_.emplace_back();
            if (!all.empty()) faces_.back().emplace(body_, std::move(all));
        }
        std::vector<std::int32_t> seen;
        for (std::int32_t t = 0; t < static_cast<std::int32_t>(frames.size()); ++t) {
            const int f = faceOf_[static_cast<std::size_t>(t)];
            if (frames[static_cast<std::size_t>(t)].area > 0.0 && !(f >= 0 && input.covered[static_cast<std::size_t>(f)])) seen.push_back(t);
        }
        if (!seen.empty()) seen_.emplace(body_, std::move(seen));
    }

    [[nodiscard]] bool empty() const { return !seen_; }
    /// The face that a triangle belongs to, -1: none.
    [[nodiscard]] int faceOf(std::int32_t triangle) const { return faceOf_[static_cast<std::size_t>(triangle)]; }

    [[nodiscard]] TriangleTree::Hit find(const Vec3& x, const Vec3& normal) const {
        const auto hit = seen_->nearest(x);
        if (normal == Vec3::Zero()) return hit;
        const auto facing = seen_->nearestFacing(x, normal);
        return facing.triangle >= 0 && facing.squaredDistance <= std::min(EmbeddedMapping::kReach * EmbeddedMapping::kReach * hit.squaredDistance, deep_ * deep_) ? facing : hit;
    }
    /// w of a point that is `far` from its place p, and the face that it belongs to; 0: none.
    [[nodiscard]] double fade(const Vec3& p, double far, int& face) const {
        const double width = EmbeddedMapping::kBand * far;
        double best = 0.0;
        for (std::size_t f = 0; width > 0.0 && f < faces_.size(); ++f) {
            if (!faces_[f]) continue;
            const double t = 1.0 - std::sqrt(faces_[f]->nearest(p).squaredDistance) / width;
            if (!(t > 0.0)) continue;
            const double w = t * t * (3.0 - 2.0 * t);
            if (w > best) best = w, face = static_cast<int>(f);
        }
        return best;
    }

private:
    const TriangleMesh& body_;
    double deep_;
    std::vector<int> faceOf_;
    std::optional<TriangleTree> seen_;
    std::vector<std::optional<TriangleTree>> faces_;
};

Result<void> check(const EmbeddedMapping::Input& input) {
    const auto count = input.points->rows();
    const auto many = [count](Eigen::Index given) { return given == 0 || given == count; };
    if ((input.normals && !many(input.normals->rows())) || !many(static_cast<Eigen::Index>(input.place.size())))
        return fail("bad-value", "The normals or places of embedded points are not as many as the points.");
    if (!allFinite(*input.points) || (input.normals && !allFinite(*input.normals))) return fail("bad-value", "An embedded point or its normal is not a number.");
    for (std::size_t i = 0; i < input.place.size(); ++i)
        if (input.place[i] < 0 || input.place[i] > static_cast<std::int32_t>(i)) return fail("bad-value", "An embedded point takes the place of a later one.");
    if (!(input.nu >= 0.0 && input.nu <= 0.5)) return fail("bad-value", "The Poisson ratio is 0 to 0.5.");
    return {};
}

}  // namespace

Result<EmbeddedMapping> EmbeddedMapping::build(const Input& input) {
    if (auto ok = check(input); !ok) return tl::unexpected(ok.error());
    const TriangleMesh& body = *input.body;
    const auto triangleCount = static_cast<std::size_t>(body.triangles.rows()), vertexCount = static_cast<std::size_t>(body.vertices.rows());
    const auto count = static_cast<std::size_t>(input.points->rows());
    EmbeddedMapping out;
    out.bodyVertices_ = vertexCount;
    out.stretch_ = input.nu / (1.0 - input.nu);
    out.places_.resize(count);
    if (count == 0) return out;
    std::vector<TriangleFrame> frames(triangleCount);
    for (std::size_t t = 0; t < triangleCount; ++t) frames[t] = triangleFrame(body, static_cast<std::int32_t>(t));
    const FollowedSurface surface(input, frames);
    if (surface.empty())
        return fail("bad-value", "The body has no triangle that points could follow, outside of its joints and with an area; give the element another body.");
    std::vector<char> held(vertexCount, 0), freeTriangle(triangleCount, 0);
    for (const auto& face : input.faces)
        for (const auto v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    for (std::size_t t = 0; t < triangleCount; ++t) freeTriangle[t] = surface.faceOf(static_cast<std::int32_t>(t)) < 0 && frames[t].area > 0.0;

    std::vector<TriangleTree::Hit> hits(count);
    std::vector<JointPart> parts(count);  // of all points; offset 0: none
    parallelFor(input.threads, count, kPointGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto row = static_cast<Eigen::Index>(input.place.empty() ? i : static_cast<std::size_t>(input.place[i]));
            const Vec3 normal = input.normals && input.normals->rows() > 0 ? Vec3(input.normals->row(row).transpose()) : Vec3(Vec3::Zero());
            hits[i] = surface.find(input.points->row(row).transpose(), normal);
            const auto& hit = hits[i];
            Vec3 p = Vec3::Zero();
            double h = 0.0;
            auto& place = out.places_[i];
            for (int c = 0; c < 3; ++c) {
                const std::int32_t v = body.triangles(hit.triangle, c);
                place.corner[static_cast<std::size_t>(c)] = v;
                p += hit.barycentric[c] * body.vertices.row(v).transpose();
                if (held[static_cast<std::size_t>(v)]) h += hit.barycentric[c];
            }
            place.weight = hit.barycentric;
            const Vec3 offset = input.points->row(static_cast<Eigen::Index>(i)).transpose() - p;
            int face = surface.faceOf(hit.triangle);
            const bool onFace = face >= 0;
            // Points that share a place share w, too.
            const double w = onFace ? 1.0 : surface.fade(p, (input.points->row(row).transpose() - p).norm(), face);
            const double curved = onFace ? 0.0 : 0.5 * std::max(1.0 - h, 0.0);
            for (int c = 0; c < 3; ++c) {
                const Vec3 corner = body.vertices.row(place.corner[static_cast<std::size_t>(c)]).transpose();
                place.offset[static_cast<std::size_t>(c)] = place.weight[c] * (curved * (p - corner) + (1.0 - w) * offset);
            }
            parts[i] = {static_cast<std::int32_t>(i), face, w * offset};
        }
    });
    for (const auto& part : parts)
        if (part.offset != Vec3::Zero()) out.jointParts_.push_back(part);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& place = out.places_[i];
            const double weight = place.weight[static_cast<Eigen::Index>(c)];
            if (held[static_cast<std::size_t>(place.corner[c])] && weight > 0.0) out.heldParts_.push_back({static_cast<std::int32_t>(i), place.corner[c], weight});
        }

    // Only what points need of the surface is kept.
    std::vector<std::int32_t> vertexIndex(vertexCount, -1), triangleIndex(triangleCount, -1);
    for (auto& place : out.places_)
        for (std::size_t c = 0; c < 3; ++c) {
            auto& index = vertexIndex[static_cast<std::size_t>(place.corner[c])];
            if (index < 0) {
                index = static_cast<std::int32_t>(out.vertices_.size());
                out.vertices_.push_back(place.corner[c]);
            }
            place.gradient[c] = index;
        }
    const VertexCorners around({body.triangles.data(), static_cast<std::size_t>(body.triangles.size())}, vertexCount, freeTriangle);
    out.firstAround_.push_back(0);
    for (const auto v : out.vertices_) {
        for (const auto corner : around.at(v)) {
            const std::int32_t t = corner / 3;
            auto& index = triangleIndex[static_cast<std::size_t>(t)];
            if (index < 0) {
                index = static_cast<std::int32_t>(out.triangles_.size());
                out.triangles_.push_back({{body.triangles(t, 0), body.triangles(t, 1), body.triangles(t, 2)}, frames[static_cast<std::size_t>(t)]});
            }
            out.around_.push_back(index);
        }
        out.firstAround_.push_back(static_cast<std::uint32_t>(out.around_.size()));
    }
    return out;
}

EmbeddedMapping::Gradients EmbeddedMapping::gradients() const {
    return {std::vector<Eigen::Matrix3d>(triangles_.size(), Eigen::Matrix3d::Zero()), std::vector<Eigen::Matrix3d>(vertices_.size(), Eigen::Matrix3d::Zero())};
}

template <class Scalar>
void EmbeddedMapping::findTriangles(Values kind, const Scalar* values, std::size_t begin, std::size_t end, Gradients& to) const {
    for (std::size_t i = begin; i < end; ++i) {
        const auto& t = triangles_[i];
        std::array<Vec3, 3> x;
        for (std::size_t c = 0; c < 3; ++c)
            x[c] = Eigen::Map<const Eigen::Matrix<Scalar, 3, 1>>(values + 3 * static_cast<std::ptrdiff_t>(t.corner[c])).template cast<double>();
        if (kind == Values::Displacements) {
            to.ofTriangle[i] = gradientOf(t.frame, x, stretch_);
            continue;
        }
        Eigen::Matrix3d& F = to.ofTriangle[i];
        F.setZero();
        for (std::size_t c = 0; c < 3; ++c) F += x[c] * t.frame.slope[c].transpose();
        // As thick as a surface free of traction gets; to first order what gradientOf() says.
        const Vec3 cross = (x[1] - x[0]).cross(x[2] - x[0]);
        const double length = cross.norm(), area = 2.0 * t.frame.area;
        if (!(length > 0.0)) continue;
        const double thick = std::pow(std::clamp(length / area, 1.0 / kMostArea, kMostArea), -stretch_);
        F += (thick / length * cross) * t.frame.normal.transpose();
    }
}

void EmbeddedMapping::findVertices(std::size_t begin, std::size_t end, Gradients& to) const {
    for (std::size_t i = begin; i < end; ++i) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        double weight = 0.0;
        for (std::uint32_t k = firstAround_[i]; k < firstAround_[i + 1]; ++k) {
            const auto t = static_cast<std::size_t>(around_[k]);
            sum += triangles_[t].frame.area * to.ofTriangle[t];
            weight += triangles_[t].frame.area;
        }
        if (weight > 0.0) sum /= weight;
        to.ofVertex[i] = sum;
    }
}

template <class Scalar>
Vec3 EmbeddedMapping::at(std::size_t point, const Scalar* values, const Gradients& gradients) const {
    const Place& place = places_[point];
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::Map<const Eigen::Matrix<Scalar, 3, 1>> value(values + 3 * static_cast<std::ptrdiff_t>(place.corner[c]));
        sum += place.weight[static_cast<Eigen::Index>(c)] * value.template cast<double>();
        sum.noalias() += gradients.ofVertex[static_cast<std::size_t>(place.gradient[c])] * place.offset[c];
    }
    return sum;
}

Eigen::MatrixXd EmbeddedMapping::apply(const Eigen::MatrixXd& displacement, int threads) const {
    Eigen::MatrixXd out(3 * static_cast<Eigen::Index>(places_.size()), displacement.cols());
    parallelFor(threads, static_cast<std::size_t>(displacement.cols()), 1, [&](std::size_t begin, std::size_t end) {
        Gradients found = gradients();
        for (std::size_t column = begin; column < end; ++column) {
            const double* values = displacement.col(static_cast<Eigen::Index>(column)).data();
            findTriangles(Values::Displacements, values, 0, triangles_.size(), found);
            findVertices(0, vertices_.size(), found);
            double* to = out.col(static_cast<Eigen::Index>(column)).data();
            for (std::size_t i = 0; i < places_.size(); ++i) Eigen::Map<Vec3>(to + 3 * i) = at(i, values, found);
        }
    });
    return out;
}

std::size_t EmbeddedMapping::bytes() const {
    return sizeof(Place) * places_.size() + sizeof(JointPart) * jointParts_.size() + sizeof(HeldPart) * heldParts_.size() + sizeof(Triangle) * triangles_.size() +
           sizeof(std::int32_t) * (vertices_.size() + around_.size() + firstAround_.size());
}

template void EmbeddedMapping::findTriangles(Values, const float*, std::size_t, std::size_t, Gradients&) const;
template void EmbeddedMapping::findTriangles(Values, const double*, std::size_t, std::size_t, Gradients&) const;
template Vec3 EmbeddedMapping::at(std::size_t, const float*, const Gradients&) const;
template Vec3 EmbeddedMapping::at(std::size_t, const double*, const Gradients&) const;

}  // namespace imomushi
