// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/element_bounds.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "ui/render/vertex_block_reader.h"

namespace imomushi::render {

namespace {

using Eigen::Matrix3f;
using Eigen::Matrix3Xf;
using Eigen::Vector3f;

// As many clusters per element, and as many held vertices per face.
constexpr std::size_t kClusters = 256, kSampledHeld = 64;

Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> linearOf(const AffineFloat& a) {
    return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(a.linear);
}
Vector3f shiftOf(const AffineFloat& a) { return Eigen::Map<const Vector3f>(a.shift); }

}  // namespace

void ElementBounds::prepare(const DeformInput::Element& element) {
    std::vector<int> met(static_cast<std::size_t>(element.places), 0), heldBy(met);
    for (const auto& h : element.held) ++heldBy[static_cast<std::size_t>(h.place)];
    for (std::size_t i = 0; i < element.held.size(); ++i) {
        const auto f = static_cast<std::size_t>(element.held[i].place);
        if (met[f]++ % (1 + heldBy[f] / static_cast<int>(kSampledHeld)) == 0) sampledHeld_.push_back(static_cast<int>(i));
    }

    offsets_.assign(static_cast<std::size_t>(element.faces), 0.0f);
    for (const auto& part : element.jointParts) offsets_[static_cast<std::size_t>(part.face)] = std::max(offsets_[static_cast<std::size_t>(part.face)], part.offset.norm());

    // Clusters: halves of halves along the longest side.
    const VertexBlockReader reader(element);
    std::vector<std::size_t> order(element.free.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<VertexBlockReader::Place> places(order.size());
    reader.forEachFreeVertex([&](std::size_t i, const auto& place) { places[i] = place; });
    const auto at = [&](std::size_t i) { return reader.rest(places[i]); };
    const std::size_t most = std::max<std::size_t>(order.size() / kClusters, 1);
    const auto modes = static_cast<Eigen::Index>(reader.modes());
    const auto split = [&](const auto& self, std::size_t begin, std::size_t end) -> void {
        Eigen::AlignedBox3f box;
        for (std::size_t i = begin; i < end; ++i) box.extend(at(order[i]));
        if (end - begin > most) {
            Eigen::Index axis = 0;
            box.sizes().maxCoeff(&axis);
            const std::size_t middle = (begin + end) / 2;
            std::nth_element(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(middle),
                             order.begin() + static_cast<std::ptrdiff_t>(end), [&](std::size_t a, std::size_t b) { return at(a)[axis] < at(b)[axis]; });
            self(self, begin, middle);
            self(self, middle, end);
            return;
        }
        Cluster cluster{box, Vector3f::Zero(), Matrix3Xf(3, modes), Matrix3Xf(3, modes), Matrix3Xf::Zero(3, modes)};
        Matrix3Xf low = Matrix3Xf::Constant(3, modes, std::numeric_limits<float>::max()), high = -low;
        const float share = 1.0f / static_cast<float>(end - begin);
        for (std::size_t i = begin; i < end; ++i) {
            cluster.mean += share * at(order[i]);
            for (Eigen::Index c = 0; c < modes; ++c) {
                const auto& place = places[order[i]];
                const auto mode = static_cast<std::size_t>(c);
                const Vector3f a(reader.response(place, mode, 0), reader.response(place, mode, 1), reader.response(place, mode, 2));
                low.col(c) = low.col(c).cwiseMin(a);
                high.col(c) = high.col(c).cwiseMax(a);
                cluster.meanOf.col(c) += share * a;
            }
        }
        cluster.middleOf = 0.5f * (low + high);
        cluster.halfOf = 0.5f * (high - low);
        clusters_.push_back(std::move(cluster));
    };
    if (!order.empty()) split(split, 0, order.size());
}

// Of each cluster: all places between the least and the greatest that its modes reach.
BoundingBoxes ElementBounds::at(const DeformInput::Element& element) const {
    BoundingBoxes bounds;
    const auto& frame = element.frame;
    const Matrix3f shape = linearOf(frame.shape), placed = linearOf(frame.placement);
    const Eigen::Map<const Eigen::VectorXf> weights(frame.weights.data(), static_cast<Eigen::Index>(frame.weights.size()));
    for (const Cluster& c : clusters_) {
        const Vector3f offset = shiftOf(frame.shape) + c.middleOf * weights;
        const Vector3f middle = placed * (shape * c.rest.center() + offset) + shiftOf(frame.placement);
        const Vector3f half = placed.cwiseAbs() * (shape.cwiseAbs() * (0.5f * c.rest.sizes()) + c.halfOf * weights.cwiseAbs());
        bounds.conservative.extend(middle - half);
        bounds.conservative.extend(middle + half);
        bounds.tight.extend(placed * (shape * c.mean + shiftOf(frame.shape) + c.meanOf * weights) + shiftOf(frame.placement));
    }
    float farther = 0.0f;
    for (std::size_t f = 0; f < offsets_.size(); ++f)
        if (offsets_[f] > 0.0f) farther = std::max(farther, offsets_[f] * (linearOf(frame.joints[f]) - placed).norm());
    if (farther > 0.0f) {
        bounds.conservative.min().array() -= farther;
        bounds.conservative.max().array() += farther;
    }
    const auto shapes = element.shapes.rows();
    const auto heldAt = [&](std::size_t i) -> Vector3f {
        const auto& h = element.held[i];
        const auto f = static_cast<std::size_t>(h.place);
        Vector3f p = linearOf(frame.joints[f]) * h.rest + shiftOf(frame.joints[f]);
        if (shapes > 0)
            p += Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic, Eigen::RowMajor>>(frame.warping.data() + 3 * f * static_cast<std::size_t>(shapes), 3, shapes) *
                 element.shapes.col(static_cast<Eigen::Index>(i));
        return p;
    };
    for (std::size_t i = 0; i < element.held.size(); ++i) bounds.conservative.extend(heldAt(i));
    for (const int i : sampledHeld_) bounds.tight.extend(heldAt(static_cast<std::size_t>(i)));
    return bounds;
}

}  // namespace imomushi::render
