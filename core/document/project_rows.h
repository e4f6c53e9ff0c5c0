// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/finite.h"
#include "core/document/document.h"
#include "core/document/names.h"
#include "core/document/sqlite.h"
#include "core/mesh/bounds.h"

// What the tables of a project file have in common: the limits of their values, and readers that refuse a value outside them. All throw DatabaseError.

namespace imomushi {

inline void require(bool ok, const char* what) {
    if (!ok) throw DatabaseError(what);
}

/// Whether `values` rise strictly and all are in [0, count).
inline bool ascendingWithin(const std::vector<std::int32_t>& values, Eigen::Index count) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i] < (i ? values[i - 1] + std::int64_t{1} : 0) || values[i] >= count) return false;
    return true;
}

/// Whether all are in [0, count). `values`: a vector or a matrix.
template <class Values>
bool allWithin(const Values& values, Eigen::Index count) {
    return std::all_of(values.data(), values.data() + values.size(), [&](auto v) { return v >= 0 && v < count; });
}

/// Whether all are coordinates or lengths of a document, m. Import allows more, so a document can hold what can be saved but not opened again.
template <class Values>
bool allCoordinates(const Values& values) {
    return allFinite(values) && std::all_of(values.data(), values.data() + values.size(), [](auto x) { return std::abs(x) <= kMaxCoordinate; });
}

/// Scripts and answers carry ids as JSON numbers, exact up to 2^53.
inline constexpr std::int64_t kMaxId = std::int64_t{1} << 53;

inline PartId readId(RowReader& row) { return static_cast<PartId>(row.integer(1, kMaxId)); }
inline PartId readIdOrNone(RowReader& row) { return static_cast<PartId>(row.integer(0, kMaxId)); }

/// The column "position" of a row that comes after `count` others of one list.
inline void readPosition(RowReader& row, std::size_t count) { row.integer(static_cast<std::int64_t>(count), static_cast<std::int64_t>(count)); }

inline std::string readUtf8(RowReader& row) {
    std::string text = row.text();
    require(isUtf8(text), "a text is not UTF-8");
    return text;
}

inline Vec3 readPoint(RowReader& row) {
    const auto v = row.array<double>(3);
    require(v.size() == 3 && allCoordinates(v), "a point is out of range");
    return {v[0], v[1], v[2]};
}

}  // namespace imomushi
