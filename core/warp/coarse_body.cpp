// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/warp/coarse_body.h"

#include <algorithm>
#include <limits>

#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/meshing/decimation.h"

namespace imomushi {

namespace {

// Rims of faces may leave their lines by this part of the root of the face's area: what is seen of them are the vertices of the large body.
constexpr double kRimTolerance = 3e-3;

// Edges at rims, in sizes of the face: the response is singular there. They grow with the distance.
constexpr double kRimEdge = 0.03;

/// Rows of the response of any vertex of the large body, held or free.
class RowsOfBody {
public:
    RowsOfBody(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response)
        : body_(body), faces_(faces), response_(response), free_(static_cast<std::size_t>(body.vertices.rows()), -1), face_(free_.size(), -1) {
        for (std::size_t i = 0; i < response.freeVertices.size(); ++i) free_[static_cast<std::size_t>(response.freeVertices[i])] = static_cast<std::int32_t>(i);
        for (std::size_t f = 0; f < faces.size(); ++f)
            for (const auto v : faces[f].vertices) face_[static_cast<std::size_t>(v)] = static_cast<int>(f);
    }
    /// -1: none.
    [[nodiscard]] int faceOf(std::int32_t vertex) const { return face_[static_cast<std::size_t>(vertex)]; }
    void add(std::int32_t vertex, double weight, Eigen::Ref<Eigen::MatrixXd> to) const {
        const auto v = static_cast<std::size_t>(vertex);
        if (free_[v] >= 0) {
            to += weight * response_.response.middleRows<3>(3 * static_cast<Eigen::Index>(free_[v]));
            return;
        }
        const auto f = static_cast<std::size_t>(face_[v]);
        const auto& frame = faces_[f].frame;
        const auto& basis = response_.bases[f];
        to.middleCols(response_.firstColumn[f], basis.columns()) += weight * frame.axes * basis.at(frame.toLocal(body_.vertices.row(vertex).transpose()));
    }

private:
    const TriangleMesh& body_;
    const std::vector<JointFace>& faces_;
    const ElementResponse& response_;
    std::vector<std::int32_t> free_;
    std::vector<int> face_;
};

}  // namespace

std::size_t CoarseBody::Carrier::bytes() const {
    return mapping.bytes() + slot.size() * sizeof(slot[0]) + contacts.size() * sizeof(Contact) + (mapping.triangles() + mapping.vertices()) * sizeof(Eigen::Matrix3d);
}

std::unique_ptr<CoarseBody> CoarseBody::build(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response, double nu, const Progress& progress) {
    for (const auto& basis : response.bases)
        if (basis.kind == BasisKind::Full) return nullptr;
    std::vector<std::int32_t> freeTriangles;
    std::vector<char> ofFace(static_cast<std::size_t>(body.triangles.rows()), 0);
    for (const auto& face : faces)
        for (const auto t : face.triangles) ofFace[static_cast<std::size_t>(t)] = 1;
    for (std::size_t t = 0; t < ofFace.size(); ++t)
        if (!ofFace[t]) freeTriangles.push_back(static_cast<std::int32_t>(t));
    if (freeTriangles.empty()) return nullptr;
    const std::vector<double> tolerance(faces.size(), kRimTolerance);
    const RowsOfBody rows(body, faces, response);
    std::vector<double> longest(static_cast<std::size_t>(body.vertices.rows()), std::numeric_limits<double>::infinity());
    for (const auto t : freeTriangles)
        for (int c = 0; c < 3; ++c)
            if (const int f = rows.faceOf(body.triangles(t, c)); f >= 0) longest[static_cast<std::size_t>(body.triangles(t, c))] = kRimEdge * faces[static_cast<std::size_t>(f)].size;
    auto decimated = decimate(body, faces, kVertices, progress, tolerance, longest);
    if (!decimated) return nullptr;
    auto out = std::make_unique<CoarseBody>();
    out->mesh = std::move(decimated->mesh);
    out->faces = std::move(decimated->faces);
    for (auto& face : out->faces) face.disc.reset();

    std::vector<char> held(static_cast<std::size_t>(out->mesh.vertices.rows()), 0);
    const TriangleTree tree(body, std::move(freeTriangles));
    for (const auto& face : out->faces)
        for (const auto v : face.vertices) held[static_cast<std::size_t>(v)] = 1;

    auto& made = out->response;
    made.bases = response.bases;
    made.firstColumn = response.firstColumn;
    for (std::size_t v = 0; v < held.size(); ++v)
        if (!held[v]) made.freeVertices.push_back(static_cast<std::int32_t>(v));
    made.response = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(made.freeVertices.size()), response.columns());
    for (std::size_t i = 0; i < made.freeVertices.size(); ++i) {
        const auto v = made.freeVertices[i];
        const auto block = 3 * static_cast<Eigen::Index>(i);
        if (const auto same = decimated->bodyVertex[static_cast<std::size_t>(v)]; same >= 0) {
            rows.add(same, 1.0, made.response.middleRows(block, 3));
            continue;
        }
        const auto hit = tree.nearest(out->mesh.vertices.row(v).transpose());
        Vec3 place = Vec3::Zero();
        for (int c = 0; c < 3; ++c) {
            const auto corner = body.triangles(hit.triangle, c);
            place += hit.barycentric[c] * body.vertices.row(corner).transpose();
            rows.add(corner, hit.barycentric[c], made.response.middleRows(block, 3));
        }
        out->mesh.vertices.row(v) = place.transpose();
    }

    out->carrier = std::make_shared<Carrier>();
    auto& carrier = *out->carrier;
    std::vector<std::int32_t> rowOf(static_cast<std::size_t>(body.vertices.rows()), -1);
    for (const auto& face : faces)
        for (const auto v : face.vertices) {
            rowOf[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(carrier.held.size());
            carrier.held.push_back(v);
        }
    for (const auto& face : out->faces)
        for (const auto v : face.vertices) {
            const auto same = decimated->bodyVertex[static_cast<std::size_t>(v)];
            if (same < 0 || rowOf[static_cast<std::size_t>(same)] < 0) return nullptr;
            carrier.rowOfHeld.push_back(rowOf[static_cast<std::size_t>(same)]);
        }
    if (progress.cancelled()) return nullptr;

    const Points allNormals = vertexNormals(body);
    const auto count = static_cast<Eigen::Index>(response.freeVertices.size());
    Points points(count, 3), normals(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
        points.row(i) = body.vertices.row(response.freeVertices[static_cast<std::size_t>(i)]);
        normals.row(i) = allNormals.row(response.freeVertices[static_cast<std::size_t>(i)]);
    }
    const std::vector<char> covered(faces.size(), 1);
    EmbeddedMapping::Input input;
    input.body = &out->mesh;
    input.faces = out->faces;
    input.covered = covered;
    input.points = &points;
    input.normals = &normals;
    input.nu = nu;
    auto mapping = EmbeddedMapping::build(input);
    if (!mapping) return nullptr;
    carrier.mapping = std::move(*mapping);
    return out;
}

}  // namespace imomushi
