// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/finite.h"
#include "core/document/document.h"
#include "core/document/names.h"
#include "core/mesh/bounds.h"
#include "core/project/sqlite.h"

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

/// Whether all are finite and within kMaxCoordinate, m. Import checks less strictly: a document may hold coordinates that can be saved but are refused when the file is opened.
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

/// A number or an enumerator in [low, high], where it goes.
template <class T>
struct Within {
    T& value;
    T low, high;
};

template <class T>
void readColumn(RowReader& row, T& v) {
    if constexpr (std::is_same_v<T, bool>)
        v = row.boolean();
    else if constexpr (std::is_same_v<T, double>)
        v = row.real();
    else if constexpr (std::is_same_v<T, std::string>)
        v = readUtf8(row);
    else if constexpr (requires { v.derived(); })
        v = row.template matrix<T>();
    else
        v = row.template array<typename T::value_type>();
}
inline void readColumn(RowReader& row, Vec3& v) {
    const auto read = row.array<double>(3);
    require(read.size() == 3 && allCoordinates(read), "a point is out of range");
    v = {read[0], read[1], read[2]};
}
/// A unit quaternion, up to rounding.
inline void readColumn(RowReader& row, Eigen::Quaterniond& v) {
    constexpr double kUnit = 1e-6;
    const auto q = row.array<double>(4);
    require(q.size() == 4 && allCoordinates(q), "a turn is broken");
    v = Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
    require(std::abs(v.norm() - 1.0) < kUnit, "a turn is no rotation");
}
template <class T>
void readColumn(RowReader& row, Within<T>& v) {
    if constexpr (std::is_floating_point_v<T>)
        v.value = static_cast<T>(row.real(v.low, v.high));
    else
        v.value = static_cast<T>(row.integer(static_cast<std::int64_t>(v.low), static_cast<std::int64_t>(v.high)));
}
/// Reads the next columns of a row, each as what it goes to is: texts of UTF-8, points of a document, turns, numbers, arrays.
template <class... Columns>
void readColumns(RowReader& row, Columns&&... columns) {
    (readColumn(row, columns), ...);
}

inline Vec3 readPoint(RowReader& row) {
    Vec3 point;
    readColumn(row, point);
    return point;
}

}  // namespace imomushi
