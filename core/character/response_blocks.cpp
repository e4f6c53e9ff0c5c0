// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/response_blocks.h"

#include <algorithm>
#include <cmath>

namespace imomushi {

namespace {

constexpr std::size_t kStride = 3 * kVertexBlock;
// The largest entry of a column in each format. Half: just below a power of two, where its steps are smallest for what they carry.
constexpr double kLargestHalf = 65504.0, kLargestInt16 = 32767.0;
// Sums of products stay within 32 bits: entries up to kLargestInt16 times weights whose absolute values add up to this at most.
constexpr double kWeightSum = 65535.0 - kColumnGroup;
// Weaker groups of columns (m) move nothing that single precision could show.
constexpr double kNoMotion = 1e-30;
// Sign patterns that the error is measured with, besides columns alone.
constexpr int kSignPatterns = 4;

}  // namespace

ResponseBlocks::ResponseBlocks(const Points& vertices, const std::vector<std::int32_t>& free, const Vec3& middle, const Eigen::MatrixXd& response,
                               ResponseFormat format)
    : format_(format) {
    for (const auto v : free)
        if (first_.empty() || v >= first_.back() + kVertexBlock) first_.push_back(v);
    rest_ = AlignedBuffer<float>(count() * kStride);
    std::size_t k = 0;
    for (const auto v : free) {
        while (v >= first_[k] + kVertexBlock) ++k;
        for (int axis = 0; axis < 3; ++axis)
            rest_[k * kStride + axis * kVertexBlock + (v - first_[k])] = static_cast<float>(vertices(v, axis) - middle[axis]);
    }
    const auto columns = static_cast<std::size_t>(response.cols());
    scale_.assign(columns, 0.0);
    columns_.assign(columns, 0.0f);
    pairs_.assign(columns + columns % 2, 0);
    groups_.assign((columns + kColumnGroup - 1) / kColumnGroup, 0.0f);
    if (columns == 0 || free.empty()) return;
    pack(free, response);
    error_ = measure(static_cast<std::size_t>(vertices.rows()), free, response);
}

void ResponseBlocks::pack(const std::vector<std::int32_t>& free, const Eigen::MatrixXd& response) {
    const auto columns = static_cast<std::size_t>(response.cols());
    const std::size_t pairs = (columns + 1) / 2;
    const std::size_t entries = count() * kStride * (format_ == ResponseFormat::Int16 ? 2 * pairs : columns);
    response_ = AlignedBuffer<std::byte>(entries * (format_ == ResponseFormat::Float ? sizeof(float) : sizeof(std::int16_t)));
    auto* floats = reinterpret_cast<float*>(response_.data());
    auto* halves = reinterpret_cast<Eigen::half*>(response_.data());
    auto* integers = reinterpret_cast<std::int16_t*>(response_.data());
    for (std::size_t c = 0; c < columns; ++c) {
        const auto column = response.col(static_cast<Eigen::Index>(c));
        const double largest = column.cwiseAbs().maxCoeff();
        scale_[c] = format_ == ResponseFormat::Float ? 1.0 : largest / (format_ == ResponseFormat::Half ? kLargestHalf : kLargestInt16);
        const double factor = largest > 0.0 ? 1.0 / scale_[c] : 0.0;
        std::size_t k = 0;
        for (std::size_t i = 0; i < free.size(); ++i) {
            while (free[i] >= first_[k] + kVertexBlock) ++k;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double entry = column[static_cast<Eigen::Index>(3 * i + axis)] * factor;
                const std::size_t lane = axis * kVertexBlock + static_cast<std::size_t>(free[i] - first_[k]);
                switch (format_) {
                    case ResponseFormat::Float: floats[(k * columns + c) * kStride + lane] = static_cast<float>(entry); break;
                    case ResponseFormat::Half: halves[(k * columns + c) * kStride + lane] = Eigen::half(static_cast<float>(entry)); break;
                    case ResponseFormat::Int16:
                        integers[2 * ((k * pairs + c / 2) * kStride + lane) + c % 2] = static_cast<std::int16_t>(std::lrint(entry));
                        break;
                }
            }
        }
    }
}

void ResponseBlocks::weigh(const Eigen::VectorXd& v) {
    const std::size_t columns = scale_.size();
    if (format_ != ResponseFormat::Int16) {
        for (std::size_t c = 0; c < columns; ++c) columns_[c] = static_cast<float>(v[static_cast<Eigen::Index>(c)] * scale_[c]);
        return;
    }
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const std::size_t begin = g * kColumnGroup, end = std::min(begin + kColumnGroup, columns);
        double sum = 0.0, largest = 0.0;
        for (std::size_t c = begin; c < end; ++c) {
            const double weight = std::abs(v[static_cast<Eigen::Index>(c)] * scale_[c]);
            sum += weight;
            largest = std::max(largest, weight);
        }
        const double factor = sum > kNoMotion ? std::min(kWeightSum / sum, kLargestInt16 / largest) : 0.0;
        for (std::size_t c = begin; c < end; ++c)
            pairs_[c] = static_cast<std::int16_t>(std::lrint(v[static_cast<Eigen::Index>(c)] * scale_[c] * factor));
        groups_[g] = factor > 0.0 ? static_cast<float>(1.0 / factor) : 0.0f;
    }
}

VertexBlocks ResponseBlocks::view() const {
    return {format_, response_.data(), rest_.data(), first_.data(), static_cast<int>(scale_.size())};
}

double ResponseBlocks::measure(std::size_t vertices, const std::vector<std::int32_t>& free, const Eigen::MatrixXd& response) {
    const Eigen::Index columns = response.cols();
    // Displacements alone: the rounding of positions is no matter of the format.
    const AlignedBuffer<float> atZero(rest_.size());
    std::vector<float> shown(3 * (vertices + kVertexBlock));
    VertexBlocks blocks = view();
    blocks.rest = atZero.data();
    constexpr Placement kInPlace = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    Eigen::VectorXd v(columns), exact(response.rows());
    const auto error = [&] {
        weigh(v);
        evaluateAndPlace(blocks, weights(), kInPlace, 0, count(), nullptr, shown.data());
        double wrong = 0.0, largest = 0.0;
        for (std::size_t i = 0; i < free.size(); ++i) {
            const auto x = exact.segment<3>(static_cast<Eigen::Index>(3 * i));
            const Eigen::Map<const Eigen::Vector3f> y(shown.data() + 3 * static_cast<std::size_t>(free[i]));
            wrong = std::max(wrong, (x - y.cast<double>()).squaredNorm());
            largest = std::max(largest, x.squaredNorm());
        }
        return largest > 0.0 ? std::sqrt(wrong / largest) : 0.0;
    };
    double worst = 0.0;
    Eigen::VectorXd size(columns);
    for (Eigen::Index c = 0; c < columns; ++c) {
        size[c] = response.col(c).cwiseAbs().maxCoeff();
        if (!(size[c] > 0.0)) continue;
        v.setZero();
        v[c] = 1.0 / size[c];
        exact = response.col(c) / size[c];
        worst = std::max(worst, error());
    }
    for (int pattern = 0; pattern < kSignPatterns; ++pattern) {
        exact.setZero();
        for (Eigen::Index c = 0; c < columns; ++c) {
            // Signs without a period in common with the columns of faces: bits of multiples of the golden ratio.
            const bool negative = (static_cast<std::uint32_t>(c * kSignPatterns + pattern + 1) * 2654435769u) >> 31;
            v[c] = size[c] > 0.0 ? (negative ? -1.0 : 1.0) / size[c] : 0.0;
            exact += response.col(c) * v[c];
        }
        worst = std::max(worst, error());
    }
    v.setZero();
    weigh(v);
    return worst;
}

}  // namespace imomushi
