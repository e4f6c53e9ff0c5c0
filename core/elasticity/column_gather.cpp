// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/column_gather.h"

#include <algorithm>

namespace imomushi {

ColumnGather::ColumnGather(const TriangleMesh& mesh) : mesh_(&mesh) {
    begin_.assign(static_cast<std::size_t>(mesh.vertices.rows()) + 1, 0);
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) ++begin_[static_cast<std::size_t>(mesh.triangles.data()[i]) + 1];
    for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    triangles_.resize(static_cast<std::size_t>(mesh.triangles.size()));
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f)
        for (int c = 0; c < 3; ++c) triangles_[next[static_cast<std::size_t>(mesh.triangles(f, c))]++] = f;
}

TriangleBatch ColumnGather::around(std::span<const std::int32_t> vertices, std::span<const char> leaveOut) const {
    return gather(vertices, leaveOut, false);
}

TriangleBatch ColumnGather::aroundForBoth(std::span<const std::int32_t> vertices, std::span<const char> leaveOut) const {
    return gather(vertices, leaveOut, true);
}

TriangleBatch ColumnGather::gather(std::span<const std::int32_t> vertices, std::span<const char> leaveOut, bool both) const {
    // A column for every vertex of the mesh: kept by each thread, since filling it anew would cost more than a small set of columns.
    thread_local std::vector<std::int32_t> column;
    const auto ignored = static_cast<std::int32_t>(vertices.size());
    if (column.size() < begin_.size()) column.resize(begin_.size());
    thread_local std::vector<std::int32_t> which;
    which.clear();
    for (const std::int32_t v : vertices)
        for (const std::int32_t f : trianglesOf(v))
            if (leaveOut.empty() || !leaveOut[static_cast<std::size_t>(f)]) which.push_back(f);
    std::sort(which.begin(), which.end());
    which.erase(std::unique(which.begin(), which.end()), which.end());
    for (const std::int32_t f : which)
        for (int c = 0; c < 3; ++c) column[static_cast<std::size_t>(mesh_->triangles(f, c))] = ignored;
    for (std::int32_t i = 0; i < ignored; ++i) column[static_cast<std::size_t>(vertices[static_cast<std::size_t>(i)])] = i;
    return both ? TriangleBatch(*mesh_, which, column, column) : TriangleBatch(*mesh_, which, column);
}

}  // namespace imomushi
