// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/connectivity.h"

#include <mutex>
#include <optional>

namespace imomushi {
namespace {

/// A value that is made once, by the first who asks.
template <class T>
class Once {
public:
    template <class Make>
    const T& get(Make make) {
        std::call_once(made_, [&] { value_.emplace(make()); });
        return *value_;
    }

private:
    std::once_flag made_;
    std::optional<T> value_;
};

}  // namespace

struct MeshConnectivity::Parts {
    Once<EdgeTable> edges;
    Once<VertexCorners> corners;
    Once<Points> normals;
    Once<MeshFacts> facts;
    Once<TriangleClusters> clusters;
    Once<Bounds> box;
    Once<double> diagonal;
};

MeshConnectivity::MeshConnectivity(const TriangleMesh& body) : body_(body), parts_(std::make_unique<Parts>()) {}
MeshConnectivity::~MeshConnectivity() = default;

const EdgeTable& MeshConnectivity::edges() const {
    return parts_->edges.get([this] { return EdgeTable(body_.triangles); });
}
const VertexCorners& MeshConnectivity::corners() const {
    return parts_->corners.get([this] { return VertexCorners(body_); });
}
const Points& MeshConnectivity::normals() const {
    return parts_->normals.get([this] { return vertexNormals(body_); });
}
const MeshFacts& MeshConnectivity::facts() const {
    return parts_->facts.get([this] { return meshFacts(body_); });
}

const TriangleClusters& MeshConnectivity::clusters() const {
    return parts_->clusters.get([this] { return TriangleClusters(body_); });
}

const Bounds& MeshConnectivity::box() const {
    return parts_->box.get([this] { return boundsOf(body_.vertices); });
}

double MeshConnectivity::diagonal() const {
    return parts_->diagonal.get([this] { return diagonalOf(body_.vertices); });
}

const MeshConnectivity& ElementMesh::connectivity() const {
    auto kept = connectivity_.kept.load(std::memory_order_acquire);
    if (!kept) {
        auto made = std::make_shared<const MeshConnectivity>(body);
        // Another thread may have been quicker: its object is everybody's then.
        if (connectivity_.kept.compare_exchange_strong(kept, made, std::memory_order_acq_rel)) kept = std::move(made);
    }
    return *kept;
}

}  // namespace imomushi
