// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/element_runtime.h"

#include <algorithm>

#include "core/character/normal_stencils.h"

namespace imomushi {

namespace {

bool sameFaces(const std::vector<JointFace>& a, const std::vector<JointFace>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const JointFace& f, const JointFace& g) {
        return f.frame.origin == g.frame.origin && f.frame.axes == g.frame.axes && f.area == g.area && f.size == g.size && f.planarityError == g.planarityError &&
               f.vertices == g.vertices && f.triangles == g.triangles;
    });
}

bool same(const ElementRuntime::Input& a, const ElementRuntime::Input& b) {
    return a.mesh == b.mesh && a.response == b.response && a.format == b.format && a.tables == b.tables && (!a.tables.warp || a.nu == b.nu) && a.covered == b.covered &&
           sameFaces(a.faces, b.faces);
}

void findColumnSizes(ElementRuntime& out) {
    const auto& given = out.input;
    const int columns = out.columns();
    out.columnSize = Eigen::VectorXd::Constant(columns, out.size);
    for (std::size_t f = 0; columns > 0 && f < given.faces.size(); ++f) {
        const int first = given.response->firstColumn[f];
        const FaceBasis& basis = given.response->bases[f];
        out.restOfFace.push_back(localVertices(given.mesh->body, given.faces[f]));
        // Shifts are in metres already.
        if (basis.kind == BasisKind::Full) {
            out.columnSize.segment(first, basis.columns()).setOnes();
            continue;
        }
        out.columnSize[first + 5] = 1.0;
        if (basis.kind != BasisKind::Paper) out.columnSize[first + 6] = out.columnSize[first + 7] = 1.0;
    }
}

/// A' of v, followed by the columns of loads that effects asked for.
Eigen::MatrixXd responseWithLoads(ElementRuntime& out) {
    const auto& given = out.input;
    Eigen::MatrixXd response = given.response ? given.response->response : Eigen::MatrixXd(3 * out.free.size(), 0);
    const auto& loads = given.tables.loads;
    const Eigen::Index first = response.cols(), count = static_cast<Eigen::Index>(loads.size());
    if (count == 0) return response;
    response.conservativeResize(Eigen::NoChange, first + count);
    out.columnSize.conservativeResize(first + count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto column = given.response->loads.col(loads[static_cast<std::size_t>(i)]);
        response.col(first + i) = column;
        double largest = 0.0;
        for (Eigen::Index p = 0; p < column.size(); p += 3) largest = std::max(largest, column.segment<3>(p).norm());
        out.columnSize[first + i] = largest;
    }
    return response;
}

}  // namespace

Result<std::shared_ptr<const ElementRuntime>> ElementRuntime::build(Input input) {
    auto made = std::make_shared<ElementRuntime>();
    ElementRuntime& out = *made;
    out.input = std::move(input);
    const auto& given = out.input;
    const auto& body = given.mesh->body;
    out.vertices = static_cast<std::size_t>(body.vertices.rows());
    if (out.vertices > 0) {
        const Vec3 low = body.vertices.colwise().minCoeff().transpose(), high = body.vertices.colwise().maxCoeff().transpose();
        out.middle = 0.5 * (low + high);
        out.size = (high - low).norm();
    }
    findColumnSizes(out);

    std::vector<char> onFace(out.vertices, 0), covered(static_cast<std::size_t>(body.triangles.rows()), 0), visible(out.vertices, 0);
    for (std::size_t f = 0; f < given.faces.size(); ++f) {
        for (const auto v : given.faces[f].vertices) onFace[static_cast<std::size_t>(v)] = 1;
        if (given.covered[f])
            for (const auto t : given.faces[f].triangles) covered[static_cast<std::size_t>(t)] = 1;
    }
    std::vector<std::int32_t> triangles;  // corners of those that are seen
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        if (covered[static_cast<std::size_t>(t)]) continue;
        for (int c = 0; c < 3; ++c) {
            triangles.push_back(body.triangles(t, c));
            visible[static_cast<std::size_t>(body.triangles(t, c))] = 1;
        }
    }
    for (std::size_t f = 0; f < given.faces.size(); ++f)
        for (const auto v : given.faces[f].vertices)
            if (!visible[static_cast<std::size_t>(v)]) out.hidden.push_back({v, static_cast<int>(f), given.faces[f].frame.axes.col(2)});
    if (given.response)
        out.free = given.response->freeVertices;
    else
        for (std::size_t v = 0; v < out.vertices; ++v)
            if (!onFace[v]) out.free.push_back(static_cast<std::int32_t>(v));

    out.blocks = ResponseBlocks(body.vertices, out.free, out.middle, responseWithLoads(out), given.format);
    out.stencils = normalStencils(body.vertices, triangles, out.scale());
    const std::span<const std::int32_t> first(out.blocks.first(), out.blocks.count());
    if (given.response && !given.faces.empty()) {
        if (given.tables.warp) {
            auto warp = BendWarpTables::build(body, given.faces, *given.response, given.nu, first, out.middle, {});
            if (!warp) return tl::unexpected(warp.error());
            out.warp = std::move(*warp);
        }
        if (given.tables.touch && given.response->touch.columns() > 0) {
            auto surface = TouchSurface::build(*given.mesh, given.faces, given.response);
            if (!surface) return tl::unexpected(surface.error());
            out.touch = std::move(*surface);
            out.touchBlocks = TouchBlocks(*given.response, first);
        }
    }
    return std::shared_ptr<const ElementRuntime>(std::move(made));
}

void ElementRuntimes::add(std::shared_ptr<const ElementRuntime> runtime) {
    const ElementMesh* mesh = runtime->input.mesh.get();
    byMesh_.emplace(mesh, std::move(runtime));
}

std::shared_ptr<const ElementRuntime> ElementRuntimes::find(const ElementRuntime::Input& input) const {
    const auto [begin, end] = byMesh_.equal_range(input.mesh.get());
    const auto found = std::find_if(begin, end, [&](const auto& known) { return same(known.second->input, input); });
    return found == end ? nullptr : found->second;
}

bool ElementRuntimes::knows(const std::shared_ptr<const ElementMesh>& mesh, const std::vector<JointFace>& faces,
                            const std::shared_ptr<const ElementResponse>& response) const {
    const auto [begin, end] = byMesh_.equal_range(mesh.get());
    return std::any_of(begin, end, [&](const auto& known) {
        const auto& i = known.second->input;
        return i.mesh == mesh && i.response == response && sameFaces(i.faces, faces);
    });
}

}  // namespace imomushi
