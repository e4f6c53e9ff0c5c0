// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/response_blocks.h"

#include <algorithm>
#include <cmath>

#include "core/base/decompositions.h"

namespace imomushi {

namespace {

constexpr std::size_t kStride = 3 * kVertexBlock;
// The largest entry of a mode in each format. Half: just below a power of two, where its steps are smallest for what they carry.
constexpr double kLargestHalf = 65504.0, kLargestInt16 = 32767.0;
// Sums of products stay within 32 bits: entries up to kLargestInt16 times weights whose absolute values add up to this at most.
constexpr double kWeightSum = 65535.0 - kColumnGroup;
// Weaker groups of columns (m) move nothing that single precision could show.
constexpr double kNoMotion = 1e-30;
// Modes that move nothing by more than this part of the largest displacement are left out.
constexpr double kNoModeOfFloat = 2e-7, kNoModeOfSixteenBits = 1e-5;
// More columns (of a full basis) are kept as they are: modes would save little and take long to find.
constexpr Eigen::Index kMaxColumnsForModes = 128;
// An element whose free vertices are flatter than this part of their extent has no affine motion across it.
constexpr double kFlatBlock = 1e-5;
// The error is measured with columns alone, as many of them at most, and with all together in several patterns of signs.
constexpr Eigen::Index kMaxColumnsAlone = 64;
constexpr int kSignPatterns = 4;

}  // namespace

ResponseBlocks::ResponseBlocks(const Points& vertices, const std::vector<std::int32_t>& free, const Vec3& middle, const Eigen::MatrixXd& response,
                               ResponseFormat format) {
    auto made = std::make_shared<Table>();
    Table& t = *made;
    table_ = made;
    t.format = format;
    for (const auto v : free)
        if (t.first.empty() || v >= t.first.back() + kVertexBlock) t.first.push_back(v);
    t.rest = AlignedBuffer<float>(count() * kStride);
    Points rest(static_cast<Eigen::Index>(free.size()), 3);
    std::size_t k = 0;
    for (std::size_t i = 0; i < free.size(); ++i) {
        rest.row(static_cast<Eigen::Index>(i)) = vertices.row(free[i]) - middle.transpose();
        while (free[i] >= t.first[k] + kVertexBlock) ++k;
        for (int axis = 0; axis < 3; ++axis)
            t.rest[k * kStride + axis * kVertexBlock + (free[i] - t.first[k])] = static_cast<float>(rest(static_cast<Eigen::Index>(i), axis));
    }
    if (response.cols() == 0 || free.empty()) return;
    pack(free, findModes(rest, response, t), t);
    const std::size_t columns = t.scale.size();
    modal_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns));
    columns_.assign(columns, 0.0f);
    pairs_.assign(2 * ((columns + 1) / 2), 0);
    groups_.assign((columns + kColumnGroup - 1) / kColumnGroup, 0.0f);
    t.error = measure(static_cast<std::size_t>(vertices.rows()), free, rest, response);
}

// response * v = affine motion by (affineOf * v) + modes * (modesOf * v)
Eigen::MatrixXd ResponseBlocks::findModes(const Points& rest, const Eigen::MatrixXd& response, Table& t) {
    const Eigen::Index columns = response.cols(), points = response.rows() / 3;
    if (columns > kMaxColumnsForModes) return response;
    t.affineOf = Eigen::MatrixXd::Zero(12, columns);
    // Columns of equal strength.
    Eigen::VectorXd size = response.cwiseAbs().colwise().maxCoeff();
    for (Eigen::Index c = 0; c < columns; ++c)
        if (!(size[c] > 0.0)) size[c] = 1.0;
    Eigen::MatrixXd modes = response * size.cwiseInverse().asDiagonal();

    // Least squares over the free vertices about their mean, in their principal axes.
    const Eigen::RowVector3d mean = rest.colwise().mean();
    const Points x = rest.rowwise() - mean;
    const auto axes = eigenpairsOf(Eigen::Matrix3d(x.transpose() * x));
    Eigen::Vector3d inverse = Eigen::Vector3d::Zero();
    for (int i = 0; i < 3; ++i)
        if (axes.values[i] > kFlatBlock * kFlatBlock * axes.values[2]) inverse[i] = 1.0 / axes.values[i];
    const Eigen::Matrix3d solve = axes.vectors * inverse.asDiagonal() * axes.vectors.transpose();
    for (Eigen::Index c = 0; c < columns; ++c) {
        Eigen::Map<Points> u(modes.col(c).data(), points, 3);
        const Eigen::RowVector3d shift = u.colwise().mean();
        const Eigen::Matrix3d linear = (solve * (x.transpose() * u)).transpose();
        u.rowwise() -= shift;
        u.noalias() -= x * linear.transpose();
        Eigen::Matrix<double, 3, 4> fit;
        fit << linear, shift.transpose() - linear * mean.transpose();
        t.affineOf.col(c) = Eigen::Map<const Eigen::VectorXd>(fit.data(), 12) * size[c];
    }

    const auto gram = eigenpairsOf(Eigen::MatrixXd(modes.transpose() * modes));
    const double negligible = t.format == ResponseFormat::Float ? kNoModeOfFloat : kNoModeOfSixteenBits;
    Eigen::MatrixXd kept(response.rows(), columns);
    t.modesOf.resize(columns, columns);
    Eigen::Index n = 0;
    for (Eigen::Index k = columns - 1; k >= 0; --k) {
        const auto part = gram.vectors.col(k);
        kept.col(n).noalias() = modes * part;
        if (kept.col(n).cwiseAbs().maxCoeff() * part.cwiseAbs().maxCoeff() < negligible) continue;
        t.modesOf.row(n++) = part.cwiseProduct(size).transpose();
    }
    t.modesOf.conservativeResize(n, columns);
    kept.conservativeResize(Eigen::NoChange, n);
    return kept;
}

void ResponseBlocks::pack(const std::vector<std::int32_t>& free, const Eigen::MatrixXd& modes, Table& t) {
    const auto columns = static_cast<std::size_t>(modes.cols());
    const std::size_t pairs = (columns + 1) / 2;
    t.scale.assign(columns, 0.0);
    const std::size_t entries = t.first.size() * kStride * (t.format == ResponseFormat::Int16 ? 2 * pairs : columns);
    t.response = AlignedBuffer<std::byte>(entries * (t.format == ResponseFormat::Float ? sizeof(float) : sizeof(std::int16_t)));
    auto* floats = reinterpret_cast<float*>(t.response.data());
    auto* halves = reinterpret_cast<Eigen::half*>(t.response.data());
    auto* integers = reinterpret_cast<std::int16_t*>(t.response.data());
    for (std::size_t c = 0; c < columns; ++c) {
        const auto column = modes.col(static_cast<Eigen::Index>(c));
        const double largest = column.cwiseAbs().maxCoeff();
        t.scale[c] = t.format == ResponseFormat::Float ? 1.0 : largest / (t.format == ResponseFormat::Half ? kLargestHalf : kLargestInt16);
        const double factor = largest > 0.0 ? 1.0 / t.scale[c] : 0.0;
        std::size_t k = 0;
        for (std::size_t i = 0; i < free.size(); ++i) {
            while (free[i] >= t.first[k] + kVertexBlock) ++k;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double entry = column[static_cast<Eigen::Index>(3 * i + axis)] * factor;
                const std::size_t lane = axis * kVertexBlock + static_cast<std::size_t>(free[i] - t.first[k]);
                switch (t.format) {
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
    const Table& t = *table_;
    const std::size_t columns = t.scale.size();
    if (t.affineOf.cols() > 0) {
        modal_.noalias() = t.modesOf * v;
        Eigen::Matrix<double, 3, 4> affine;
        Eigen::Map<Eigen::VectorXd>(affine.data(), 12).noalias() = t.affineOf * v;
        for (int i = 0; i < 3; ++i) {
            affine_.shift[i] = static_cast<float>(affine(i, 3));
            for (int k = 0; k < 3; ++k) affine_.linear[3 * i + k] = static_cast<float>((i == k ? 1.0 : 0.0) + affine(i, k));
        }
    } else if (columns > 0) {
        modal_ = v;
    }
    if (t.format != ResponseFormat::Int16) {
        for (std::size_t c = 0; c < columns; ++c) columns_[c] = static_cast<float>(modal_[static_cast<Eigen::Index>(c)] * t.scale[c]);
        return;
    }
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const std::size_t begin = g * kColumnGroup, end = std::min(begin + kColumnGroup, columns);
        double sum = 0.0, largest = 0.0;
        for (std::size_t c = begin; c < end; ++c) {
            const double weight = std::abs(modal_[static_cast<Eigen::Index>(c)] * t.scale[c]);
            sum += weight;
            largest = std::max(largest, weight);
        }
        const double factor = sum > kNoMotion ? std::min(kWeightSum / sum, kLargestInt16 / largest) : 0.0;
        for (std::size_t c = begin; c < end; ++c)
            pairs_[c] = static_cast<std::int16_t>(std::lrint(modal_[static_cast<Eigen::Index>(c)] * t.scale[c] * factor));
        groups_[g] = factor > 0.0 ? static_cast<float>(1.0 / factor) : 0.0f;
    }
}

VertexBlocks ResponseBlocks::view() const {
    const Table& t = *table_;
    return {t.format, t.response.data(), t.rest.data(), t.first.data(), static_cast<int>(t.scale.size())};
}

double ResponseBlocks::measure(std::size_t vertices, const std::vector<std::int32_t>& free, const Points& rest, const Eigen::MatrixXd& response) {
    const Eigen::Index columns = response.cols();
    std::vector<float> shown(3 * (vertices + kVertexBlock));
    constexpr AffineFloat kInPlace = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    Eigen::VectorXd v(columns), exact(response.rows());
    const auto error = [&] {
        weigh(v);
        evaluateAndPlace(view(), weights(), kInPlace, 0, count(), nullptr, shown.data());
        double wrong = 0.0, largest = 0.0;
        for (std::size_t i = 0; i < free.size(); ++i) {
            const auto x = exact.segment<3>(static_cast<Eigen::Index>(3 * i));
            const Eigen::Map<const Eigen::Vector3f> y(shown.data() + 3 * static_cast<std::size_t>(free[i]));
            wrong = std::max(wrong, (rest.row(static_cast<Eigen::Index>(i)).transpose() + x - y.cast<double>()).squaredNorm());
            largest = std::max(largest, x.squaredNorm());
        }
        return largest > 0.0 ? std::sqrt(wrong / largest) : 0.0;
    };
    // Displacements as large as the element: the rounding of positions is no matter of the format.
    const double extent = std::sqrt(rest.rowwise().squaredNorm().maxCoeff());
    double worst = 0.0;
    Eigen::VectorXd size(columns);
    for (Eigen::Index c = 0; c < columns; ++c) {
        size[c] = response.col(c).cwiseAbs().maxCoeff();
        if (!(size[c] > 0.0) || c % (1 + (columns - 1) / kMaxColumnsAlone) != 0) continue;
        v.setZero();
        v[c] = extent / size[c];
        exact = response.col(c) * v[c];
        worst = std::max(worst, error());
    }
    for (int pattern = 0; pattern < kSignPatterns; ++pattern) {
        exact.setZero();
        for (Eigen::Index c = 0; c < columns; ++c) {
            // Signs without a period in common with the columns of faces: bits of multiples of the golden ratio.
            const bool negative = (static_cast<std::uint32_t>(c * kSignPatterns + pattern + 1) * 2654435769u) >> 31;
            v[c] = size[c] > 0.0 ? (negative ? -extent : extent) / size[c] : 0.0;
            exact += response.col(c) * v[c];
        }
        worst = std::max(worst, error());
    }
    v.setZero();
    weigh(v);
    return worst;
}

}  // namespace imomushi
