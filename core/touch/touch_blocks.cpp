// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/touch/touch_blocks.h"

#include <algorithm>

namespace imomushi {
namespace {
constexpr std::size_t kEntries = 3 * TouchBlocks::kBlock;
using Block = Eigen::Array<float, static_cast<int>(kEntries), 1>;
}  // namespace

TouchBlocks::TouchBlocks(const ElementResponse& response, std::span<const std::int32_t> first) : columns_(response.touch.columns()) {
    which_.resize(static_cast<std::size_t>(columns_));
    weights_.resize(static_cast<std::size_t>(columns_));
    auto data = std::make_shared<Data>(first.size() * static_cast<std::size_t>(columns_) * kEntries, 0.0f);
    const auto& free = response.freeVertices;
    for (std::size_t b = 0; b < first.size(); ++b) {
        auto i = std::lower_bound(free.begin(), free.end(), first[b]) - free.begin();
        for (; i < static_cast<std::ptrdiff_t>(free.size()) && free[static_cast<std::size_t>(i)] < first[b] + kBlock; ++i)
            for (int c = 0; c < columns_; ++c)
                for (int axis = 0; axis < 3; ++axis)
                    (*data)[(b * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)) * kEntries +
                          static_cast<std::size_t>(axis * kBlock + free[static_cast<std::size_t>(i)] - first[b])] =
                        response.touch.displacement(3 * i + axis, c);
    }
    data_ = std::move(data);
}

void TouchBlocks::weigh(const Eigen::VectorXd& patchForces) {
    active_ = 0;
    for (Eigen::Index c = 0; c < std::min<Eigen::Index>(columns_, patchForces.size()); ++c)
        if (const auto weight = static_cast<float>(patchForces[c]); weight != 0.0f) {
            which_[static_cast<std::size_t>(active_)] = static_cast<std::int32_t>(c);
            weights_[static_cast<std::size_t>(active_++)] = weight;
        }
}

void TouchBlocks::add(std::size_t begin, std::size_t end, float* local) const {
    for (std::size_t b = begin; b < end; ++b) {
        const float* data = data_->data() + b * static_cast<std::size_t>(columns_) * kEntries;
        Eigen::Map<Block, Eigen::Aligned16> to(local + b * kEntries);
        Block sum = to;
        for (std::size_t k = 0; k < static_cast<std::size_t>(active_); ++k)
            sum += weights_[k] * Eigen::Map<const Block, Eigen::Aligned16>(data + static_cast<std::size_t>(which_[k]) * kEntries);
        to = sum;
    }
}

}  // namespace imomushi
