// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/joints/grown_vertices.h"

#include <cstddef>
#include <cstdlib>

namespace imomushi {

namespace {

/// By vertex: whether it is one of the set.
using Members = std::vector<char>;

Members membersOf(const TriangleMesh& body, std::span<const std::int32_t> vertices) {
    Members in(static_cast<std::size_t>(body.vertices.rows()), 0);
    for (const std::int32_t v : vertices) in[static_cast<std::size_t>(v)] = 1;
    return in;
}

int cornersIn(const TriangleMesh& body, std::int32_t t, const Members& in) {
    int count = 0;
    for (int c = 0; c < 3; ++c) count += in[static_cast<std::size_t>(body.triangles(t, c))];
    return count;
}

void setCorners(const TriangleMesh& body, std::int32_t t, char value, Members& in) {
    for (int c = 0; c < 3; ++c) in[static_cast<std::size_t>(body.triangles(t, c))] = value;
}

}  // namespace

std::vector<std::int32_t> trianglesWithin(const TriangleMesh& body, std::span<const std::int32_t> vertices) {
    const Members in = membersOf(body, vertices);
    std::vector<std::int32_t> found;
    for (std::int32_t t = 0; t < body.triangles.rows(); ++t)
        if (cornersIn(body, t, in) == 3) found.push_back(t);
    return found;
}

std::vector<std::int32_t> grownVertices(const TriangleMesh& body, std::span<const std::int32_t> vertices, int rings) {
    Members in = membersOf(body, vertices);
    // A triangle across the rim is all in from then on, or all out.
    const char becomes = rings > 0 ? 1 : 0;
    for (int left = std::abs(rings); left > 0; --left) {
        Members next = in;
        for (std::int32_t t = 0; t < body.triangles.rows(); ++t)
            if (const int count = cornersIn(body, t, in); count == 1 || count == 2) setCorners(body, t, becomes, next);
        if (next == in) break;
        in = std::move(next);
    }
    Members used(in.size(), 0);
    for (std::int32_t t = 0; t < body.triangles.rows(); ++t)
        if (cornersIn(body, t, in) == 3) setCorners(body, t, 1, used);
    std::vector<std::int32_t> grown;
    for (std::size_t v = 0; v < used.size(); ++v)
        if (used[v]) grown.push_back(static_cast<std::int32_t>(v));
    return grown;
}

}  // namespace imomushi
