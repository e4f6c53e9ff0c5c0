// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/element_runtime.h"

#include <algorithm>
#include <numeric>

#include "core/base/parallel.h"
#include "core/character/normal_stencils.h"

namespace imomushi {

bool sameJointFaces(const std::vector<JointFace>& a, const std::vector<JointFace>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const JointFace& f, const JointFace& g) {
        return f.frame.origin == g.frame.origin && f.frame.axes == g.frame.axes && f.area == g.area && f.size == g.size && f.planarityError == g.planarityError &&
               f.vertices == g.vertices && f.triangles == g.triangles;
    });
}

namespace {

/// But for embedded points.
bool sameBody(const ElementRuntime::Input& a, const ElementRuntime::Input& b) {
    return a.mesh == b.mesh && a.response == b.response && a.format == b.format && a.tables == b.tables && (!(a.tables.warp || a.embedded) || a.nu == b.nu) &&
           a.covered == b.covered && sameJointFaces(a.faces, b.faces);
}

bool same(const ElementRuntime::Input& a, const ElementRuntime::Input& b) { return a.embedded == b.embedded && sameBody(a, b); }

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

std::size_t padded(std::size_t vertices) { return (vertices + kVertexBlock - 1) / kVertexBlock * kVertexBlock + kVertexBlock; }

Result<std::shared_ptr<const EmbeddedTables>> embed(const ElementRuntime& runtime) {
    const auto& given = runtime.input;
    const EmbeddedPoints& points = *given.embedded;
    const auto count = static_cast<std::size_t>(points.rest.rows());
    auto made = std::make_shared<EmbeddedTables>();
    EmbeddedTables& out = *made;
    out.first = padded(runtime.vertices);
    out.parts = points.attached.size();
    out.count = count + EmbeddedTables::kFrameVertices * out.parts;
    out.reach = runtime.size > 0.0 ? runtime.size : 1.0;
    std::vector<char> elsewhere(count, 0);
    for (std::size_t i = 0; i < points.bodyVertex.size(); ++i) elsewhere[i] = points.bodyVertex[i] >= 0;
    for (const auto& part : points.attached)
        for (const auto i : part.points) elsewhere[static_cast<std::size_t>(i)] = 1;
    for (std::size_t i = 0; i < count; ++i)
        if (!elsewhere[i]) out.rows.push_back(static_cast<std::int32_t>(out.first + i));
    std::vector<std::int32_t> place(out.rows.size());
    std::iota(place.begin(), place.end(), 0);
    for (std::size_t a = 0; a < out.parts; ++a)
        for (std::size_t k = 0; k < EmbeddedTables::kFrameVertices; ++k) {
            place.push_back(static_cast<std::int32_t>(out.rows.size() - k));  // that of its pivot
            out.rows.push_back(static_cast<std::int32_t>(out.frameOf(a) + k));
        }
    const Points all = out.restOf(points);
    Points rest(static_cast<Eigen::Index>(out.rows.size()), 3), normals = Points::Zero(rest.rows(), 3);
    for (Eigen::Index i = 0; i < rest.rows(); ++i) {
        const Eigen::Index from = out.rows[static_cast<std::size_t>(i)] - static_cast<Eigen::Index>(out.first);
        rest.row(i) = all.row(from);
        if (from < points.normals.rows()) normals.row(i) = points.normals.row(from);
    }
    EmbeddedMapping::Input mapping;
    mapping.body = &given.mesh->body;
    mapping.faces = given.faces;
    mapping.covered = given.covered;
    mapping.points = &rest;
    mapping.normals = &normals;
    mapping.place = place;
    mapping.nu = given.nu;
    mapping.threads = hardwareThreads();
    auto built = EmbeddedMapping::build(mapping);
    if (!built) return tl::unexpected(built.error());
    out.mapping = std::move(*built);
    return std::shared_ptr<const EmbeddedTables>(std::move(made));
}

/// Displacements of all body vertices per column: those of free ones, and what the bases of faces say of held ones. 3 #V x columns.
Eigen::MatrixXd wholeResponse(const ElementRuntime& runtime, const Eigen::MatrixXd& response) {
    const auto& given = runtime.input;
    const auto& body = given.mesh->body;
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * body.vertices.rows(), response.cols());
    for (std::size_t i = 0; i < runtime.free.size(); ++i) out.middleRows<3>(3 * runtime.free[i]) = response.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    forHeldVertices(given, [&](std::int32_t v, int column, const Eigen::MatrixXd& block) { out.block(3 * v, column, 3, block.cols()) = block; });
    return out;
}

/// Blocks of the body and, where they are a product, of embedded points.
ResponseBlocks blocksOf(ElementRuntime& runtime) {
    const auto& given = runtime.input;
    const Points& body = given.mesh->body.vertices;
    const Eigen::MatrixXd response = responseWithLoads(runtime);
    const bool warped = given.response && !given.faces.empty() && given.tables.warp && !given.tables.fades;
    if (!runtime.embedded || warped || runtime.embedded->rows.empty()) return {body, runtime.free, runtime.middle, response, given.format};
    const EmbeddedTables& embedded = *runtime.embedded;
    const auto own = static_cast<Eigen::Index>(3 * runtime.free.size()), more = static_cast<Eigen::Index>(3 * embedded.rows.size());
    Eigen::MatrixXd all(own + more, response.cols());
    all.topRows(own) = response;
    all.bottomRows(more) = embedded.mapping.apply(wholeResponse(runtime, response), hardwareThreads());
    Points rest = Points::Zero(static_cast<Eigen::Index>(embedded.first + embedded.count), 3);
    rest.topRows(body.rows()) = body;
    rest.bottomRows(static_cast<Eigen::Index>(embedded.count)) = embedded.restOf(*given.embedded);
    std::vector<std::int32_t> rows = runtime.free;
    rows.insert(rows.end(), embedded.rows.begin(), embedded.rows.end());
    return {rest, rows, runtime.middle, all, given.format};
}

}  // namespace

Points EmbeddedTables::restOf(const EmbeddedPoints& points) const {
    Points rest(static_cast<Eigen::Index>(count), 3);
    rest.topRows(points.rest.rows()) = points.rest;
    Eigen::Index row = points.rest.rows();
    for (const auto& part : points.attached)
        for (int k = 0; k < static_cast<int>(kFrameVertices); ++k, ++row) {
            rest.row(row) = part.pivot.transpose();
            if (k > 0) rest(row, k - 1) += reach;
        }
    return rest;
}

std::shared_ptr<const PoseWatch> ElementRuntime::findWatch() const { return lazyWatch ? lazyWatch->get(input.mesh->body, input.faces, *input.response) : nullptr; }

std::size_t ElementRuntime::paddedVertices() const { return embedded ? padded(embedded->first + embedded->count) : padded(vertices); }

Result<std::shared_ptr<const ElementRuntime>> ElementRuntime::build(Input input, const ElementRuntimes& known) {
    auto embedded = known.findEmbedded(input);
    const auto like = known.findLike(input);
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

    if (given.response && !given.faces.empty()) {
        out.lazyWatch = known.findWatch(given);
        if (!out.lazyWatch) out.lazyWatch = std::make_shared<const LazyPoseWatch>();
    }
    if (given.embedded && !embedded) {
        auto tables = embed(out);
        if (!tables) return tl::unexpected(tables.error());
        embedded = std::move(*tables);
    }
    out.embedded = std::move(embedded);
    out.blocks = blocksOf(out);
    const std::span<const std::int32_t> blocks(out.blocks.first(), out.blocks.count());
    out.bodyBlocks = static_cast<std::size_t>(std::lower_bound(blocks.begin(), blocks.end(), static_cast<std::int32_t>(out.vertices)) - blocks.begin());
    if (like) {
        out.stencils = like->stencils;
        out.warp = like->warp;
        out.watch = like->watch;
        out.touch = like->touch;
        out.touchBlocks = like->touchBlocks;
        out.contact = like->contact;
        out.dents = like->dents;
        return std::shared_ptr<const ElementRuntime>(std::move(made));
    }
    const auto alike = known.findSeenAlike(given);
    out.stencils = alike ? alike->stencils : normalStencils(body.vertices, triangles, out.inverseSize());
    const auto first = blocks.first(out.bodyBlocks);
    if (given.response && !given.faces.empty()) {
        if (given.tables.warp) {
            auto warp = BendWarpTables::build(body, given.faces, *given.response, given.nu, first, out.middle, {});
            if (!warp) return tl::unexpected(warp.error());
            out.warp = std::move(*warp);
            if (given.tables.fades) out.watch = out.findWatch();
        }
        if (given.tables.touch && given.response->touch.columns() > 0) {
            auto surface = TouchSurface::build(*given.mesh, given.faces, given.response);
            if (!surface) return tl::unexpected(surface.error());
            out.touch = std::move(*surface);
            out.touchBlocks = TouchBlocks(*given.response, first);
            if (given.tables.dents) out.dents = std::make_shared<const DentSurface>(*given.mesh, given.faces, out.touch, given.nu, first);
            if (given.tables.contact) out.contact = std::make_shared<const ContactSurface>(*given.mesh, out.touch);
        }
    }
    return std::shared_ptr<const ElementRuntime>(std::move(made));
}

void askForLoads(ElementTables& tables, std::initializer_list<int> columns) {
    std::vector<int>& loads = tables.loads;
    loads.insert(loads.end(), columns);
    std::sort(loads.begin(), loads.end());
    loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
}

void forHeldVertices(const ElementRuntime::Input& input, const std::function<void(std::int32_t, int, const Eigen::MatrixXd&)>& take) {
    for (std::size_t f = 0; input.response && f < input.faces.size(); ++f) {
        const auto& face = input.faces[f];
        int i = 0;
        for (const auto v : face.vertices) {
            const Vec3 local = face.frame.toLocal(input.mesh->body.vertices.row(v).transpose());
            take(v, input.response->firstColumn[f], face.frame.axes * input.response->bases[f].at(local, i++));
        }
    }
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

std::shared_ptr<const EmbeddedTables> ElementRuntimes::findEmbedded(const ElementRuntime::Input& input) const {
    if (!input.embedded) return nullptr;
    const auto [begin, end] = byMesh_.equal_range(input.mesh.get());
    const auto found = std::find_if(begin, end, [&](const auto& known) {
        const auto& i = known.second->input;
        return i.embedded == input.embedded && i.nu == input.nu && i.covered == input.covered && sameJointFaces(i.faces, input.faces);
    });
    return found == end ? nullptr : found->second->embedded;
}

std::shared_ptr<const ElementRuntime> ElementRuntimes::findSeenAlike(const ElementRuntime::Input& input) const {
    const auto [begin, end] = byMesh_.equal_range(input.mesh.get());
    const auto found = std::find_if(begin, end, [&](const auto& known) { return known.second->input.covered == input.covered && sameJointFaces(known.second->input.faces, input.faces); });
    return found == end ? nullptr : found->second;
}

std::shared_ptr<const ElementRuntime> ElementRuntimes::findLike(const ElementRuntime::Input& input) const {
    const auto [begin, end] = byMesh_.equal_range(input.mesh.get());
    const auto found = std::find_if(begin, end, [&](const auto& known) { return known.second->input.embedded && input.embedded && sameBody(known.second->input, input); });
    return found == end ? nullptr : found->second;
}

std::shared_ptr<const LazyPoseWatch> ElementRuntimes::findWatch(const ElementRuntime::Input& input) const {
    const auto [begin, end] = byMesh_.equal_range(input.mesh.get());
    const auto found = std::find_if(begin, end, [&](const auto& known) { return known.second->input.response == input.response && sameJointFaces(known.second->input.faces, input.faces); });
    return found == end ? nullptr : found->second->lazyWatch;
}

bool ElementRuntimes::knows(const std::shared_ptr<const ElementMesh>& mesh, const std::vector<JointFace>& faces) const {
    const auto [begin, end] = byMesh_.equal_range(mesh.get());
    return std::any_of(begin, end, [&](const auto& known) { return sameJointFaces(known.second->input.faces, faces); });
}

bool ElementRuntimes::knows(const std::shared_ptr<const ElementMesh>& mesh, const std::vector<JointFace>& faces,
                            const std::shared_ptr<const ElementResponse>& response) const {
    const auto [begin, end] = byMesh_.equal_range(mesh.get());
    return std::any_of(begin, end, [&](const auto& known) {
        const auto& i = known.second->input;
        return i.mesh == mesh && i.response == response && sameJointFaces(i.faces, faces);
    });
}

}  // namespace imomushi
