// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "core/document/take.h"

namespace imomushi {

/// A take at 60 frames per second in which all numbers of all elements and joints change in every frame.
inline std::shared_ptr<Take> longTake(std::size_t elements, std::size_t frames) {
    constexpr int kWeights = 21;
    auto take = std::make_shared<Take>();
    take->name = "long";
    take->layout.elements.assign(elements, {kWeights, 0, 0});
    take->layout.joints = static_cast<int>(elements) - 1;
    for (std::size_t e = 0; e < elements; ++e) take->elements.push_back(e + 1);
    const int size = take->layout.size();
    std::vector<double> row(static_cast<std::size_t>(size));
    for (std::size_t f = 0; f < frames; ++f) {
        const double time = static_cast<double>(f) / 60.0;
        take->times.push_back(time);
        for (int i = 0; i < size; ++i) row[static_cast<std::size_t>(i)] = std::sin(time + 0.1 * i);
        const auto turn = [&](int at) {
            for (int k = 0; k < 4; ++k) row[static_cast<std::size_t>(at + k)] = k == 0 ? std::sin(time) : k == 3 ? std::cos(time) : 0.0;
        };
        for (std::size_t e = 0; e < elements; ++e) turn(take->layout.element(e));
        for (int j = 0; j < take->layout.joints; ++j) turn(take->layout.joint(j));
        take->shapes.add(row);
        take->poses.add({});
    }
    take->shapes.finish();
    take->poses.finish();
    return take;
}

}  // namespace imomushi
