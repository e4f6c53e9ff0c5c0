// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/embed_model.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/index.h"
#include "core/base/union_find.h"
#include "core/document/attachments.h"
#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/mesh/weld.h"
#include "core/reduction/embedded_mapping.h"

namespace imomushi {

namespace {

/// A part that is larger than this, in diagonals of its element, is flesh of several elements: a hand among fingers.
constexpr double kOfElement = 0.5;
constexpr double kOneNormal = 0.985;  // cosine of 10 degrees: corners of a vertex whose normals are nearer than that have one

template <class Matrix>
bool sameRows(const Matrix& a, const Matrix& b) {
    return a.rows() == b.rows() && a == b;
}

bool same(const EmbeddedPoints& a, const EmbeddedPoints& b) {
    return sameRows(a.rest, b.rest) && sameRows(a.normals, b.normals) && a.bodyVertex == b.bodyVertex &&
           std::equal(a.attached.begin(), a.attached.end(), b.attached.begin(), b.attached.end(), [](const auto& p, const auto& q) { return p.pivot == q.pivot && p.points == q.points; });
}

bool same(const EmbeddedMesh& a, const EmbeddedMesh& b) {
    return std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                      [](const auto& p, const auto& q) { return p.element == q.element && p.index == q.index && p.onBody == q.onBody; }) &&
           sameRows(a.triangles, b.triangles) && sameRows(a.normals, b.normals) && a.model == b.model;
}

/// #V x 3: the sum of the normals that the corners of each vertex have in the file, or else that of the areas of its triangles.
Points outwardNormals(const ElementMesh& mesh) {
    const Points& vertices = mesh.body.vertices;
    const RenderMesh& render = mesh.renderMesh;
    Points normals = Points::Zero(vertices.rows(), 3);
    if (render.normals.rows() > 0) {
        for (std::size_t r = 0; r < render.bodyVertex.size(); ++r) normals.row(render.bodyVertex[r]) += render.normals.row(static_cast<Eigen::Index>(r)).cast<double>();
        return normals;
    }
    const double diagonal = boundsOf(vertices).diagonal();
    if (!(diagonal > 0.0)) return normals;
    for (std::int32_t t = 0; t < mesh.body.triangles.rows(); ++t) {
        const Vec3 a = vertices.row(mesh.body.triangles(t, 0)), b = vertices.row(mesh.body.triangles(t, 1)), c = vertices.row(mesh.body.triangles(t, 2));
        const Vec3 area = ((b - a) / diagonal).cross((c - a) / diagonal);
        for (int k = 0; k < 3; ++k) normals.row(mesh.body.triangles(t, k)) += area.transpose();
    }
    return normals;
}

/// The normals of the file per vertex; none where a vertex has more than one.
Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> fileNormals(const ElementMesh& mesh) {
    const RenderMesh& render = mesh.renderMesh;
    Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> normals;
    if (render.normals.rows() == 0) return normals;
    normals.setZero(mesh.body.vertices.rows(), 3);
    for (std::size_t r = 0; r < render.bodyVertex.size(); ++r) {
        auto to = normals.row(render.bodyVertex[r]);
        const Eigen::RowVector3f n = render.normals.row(static_cast<Eigen::Index>(r));
        if (to.isZero(0.0f)) {
            to = n;
        } else if (to.dot(n) < static_cast<float>(kOneNormal) * to.norm() * n.norm()) {
            return {};
        }
    }
    return normals;
}

/// The surfaces of all elements of a character, without the caps of their cuts.
class Skins {
public:
    explicit Skins(const std::vector<const Element*>& elements) {
        Eigen::Index vertices = 0, triangles = 0;
        for (const Element* e : elements) {
            vertices += e->mesh->body.vertices.rows();
            triangles += std::count_if(e->piece->origin->triangles.begin(), e->piece->origin->triangles.end(), [](auto t) { return t >= 0; });
        }
        mesh_.vertices.resize(vertices, 3);
        mesh_.triangles.resize(triangles, 3);
        vertices = triangles = 0;
        for (std::size_t i = 0; i < elements.size(); ++i) {
            const TriangleMesh& body = elements[i]->mesh->body;
            mesh_.vertices.middleRows(vertices, body.vertices.rows()) = body.vertices;
            for (std::int32_t t = 0; t < body.triangles.rows(); ++t) {
                if (elements[i]->piece->origin->triangles[at(t)] < 0) continue;
                mesh_.triangles.row(triangles++) = body.triangles.row(t).array() + static_cast<std::int32_t>(vertices);
                element_.push_back(static_cast<std::int32_t>(i));
            }
            vertices += body.vertices.rows();
        }
        deep_ = EmbeddedMapping::kDeep * boundsOf(mesh_.vertices).diagonal();
        if (triangles > 0) tree_.emplace(mesh_);
    }

    /// The element with the surface that a point with this normal follows, by the rule of EmbeddedMapping.
    [[nodiscard]] std::int32_t nearest(const Vec3& point, const Vec3& normal) const {
        if (!tree_) return 0;
        const auto near = tree_->nearest(point);
        if (normal.squaredNorm() > 0.0) {
            const auto facing = tree_->nearestFacing(point, normal);
            if (facing.triangle >= 0 && facing.squaredDistance <= EmbeddedMapping::kReach * EmbeddedMapping::kReach * near.squaredDistance &&
                facing.squaredDistance <= deep_ * deep_)
                return element_[at(facing.triangle)];
        }
        return element_[at(near.triangle)];
    }

private:
    TriangleMesh mesh_;
    std::vector<std::int32_t> element_;  // per triangle
    std::optional<TriangleTree> tree_;
    double deep_ = 0.0;  // m
};

/// What the artist chose, by vertices.
struct Chosen {
    ModelPart part;
    const Attachment* attachment = nullptr;
    std::vector<std::int32_t> vertices;  ///< none: shells of the part have their own
    std::int32_t element = -1;           ///< of the character's, -1: not chosen
};

std::vector<Chosen> chosenParts(const CharacterSource& character, const std::vector<PartId>& elements) {
    std::vector<Chosen> all;
    for (const auto& [part, attachment] : character.attachments) {
        const auto element = std::find(elements.begin(), elements.end(), attachment.element);
        all.push_back({part, &attachment, attachedVertices(character, part), element == elements.end() ? -1 : static_cast<std::int32_t>(element - elements.begin())});
    }
    return all;
}

}  // namespace

EmbeddedModel embedModel(const Document& document, const CharacterSource& character) {
    EmbeddedModel out;
    out.elements = document.elementsOf(character.id);
    std::vector<const Element*> elements;
    for (const PartId id : out.elements) {
        elements.push_back(document.elements.at(id).get());
        out.places.push_back(static_cast<int>(std::distance(document.elements.begin(), document.elements.find(id))));
    }
    const TriangleMesh& model = character.model->mesh.body;
    const auto count = static_cast<std::size_t>(model.vertices.rows());
    const Points normals = outwardNormals(character.model->mesh);

    // Body vertices of pieces by those of the whole body; at a cut two pieces have one, and the first is as good as the other.
    std::vector<EmbeddedMesh::Vertex> ofBody(static_cast<std::size_t>(character.body->mesh.vertices.rows()), {-1, -1, true});
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const auto& from = elements[e]->piece->origin->vertices;
        for (std::size_t v = 0; v < from.size(); ++v)
            if (from[v] >= 0 && ofBody[at(from[v])].element < 0) ofBody[at(from[v])] = {static_cast<std::int32_t>(e), static_cast<std::int32_t>(v), true};
    }

    // Vertices at one place are one, and what hangs together by them is a part.
    std::vector<char> used(count, 0);
    for (Eigen::Index i = 0; i < model.triangles.size(); ++i) used[at(model.triangles.data()[i])] = 1;
    const std::vector<std::int32_t> first = weldExact(model.vertices, std::vector<char>(count, 1), {});
    UnionFind parts(count);
    for (Eigen::Index t = 0; t < model.triangles.rows(); ++t)
        for (int k = 1; k < 3; ++k) parts.unite(first[at(model.triangles(t, 0))], first[at(model.triangles(t, k))]);

    // Those at one place follow one body vertex, also where the body has several there (surfaces that touch were parted) or only some of them are of the body.
    const auto bodyVertexOf = [&](std::size_t v) {
        const std::int32_t b = character.body->bodyVertex[v];
        return b < 0 ? EmbeddedMesh::Vertex{-1, -1, false} : ofBody[at(b)];
    };
    std::vector<EmbeddedMesh::Vertex> ofPlace(count, {-1, -1, false});
    for (std::size_t v = 0; v < count; ++v)
        if (ofPlace[at(first[v])].element < 0) ofPlace[at(first[v])] = bodyVertexOf(v);

    const Skins skins(elements);
    std::vector<EmbeddedMesh::Vertex> vertices(count);
    for (std::size_t v = 0; v < count; ++v) {
        const EmbeddedMesh::Vertex on = ofPlace[at(first[v])];
        if (on.element >= 0) {
            vertices[v] = on;
            // A cut has moved the body vertex, or the body was mended there: the vertex follows the surface beside it.
            const auto& body = elements[at(on.element)]->mesh->body.vertices;
            if (body.row(on.index) != model.vertices.row(static_cast<Eigen::Index>(v))) vertices[v].onBody = false;
        } else if (first[v] != static_cast<std::int32_t>(v)) {
            vertices[v] = {vertices[at(first[v])].element, -1, false};
        } else {
            vertices[v] = {elements.size() == 1 || !used[v] ? 0 : skins.nearest(model.vertices.row(static_cast<Eigen::Index>(v)), normals.row(static_cast<Eigen::Index>(v))), -1, false};
        }
    }

    const std::vector<Chosen> chosen = chosenParts(character, out.elements);
    std::vector<char> told(count, 0);
    for (const Chosen& c : chosen)
        for (const std::int32_t v : c.vertices) told[at(v)] = 1;

    // Small parts follow one element, and are no flesh where the body was made without them.
    struct Part {
        Bounds box;
        bool any = false, onBody = false;
        std::vector<std::size_t> votes;
        std::int32_t element = -1;           // it is rigid on this one
        std::vector<std::int32_t> vertices;  // of a rigid one
    };
    std::map<std::int32_t, Part> all;
    {
        const bool leftOut = character.body->report.how != BodyKind::Wrapped;
        for (std::size_t v = 0; v < count; ++v) {
            if (!used[v]) continue;
            Part& part = all[parts.find(first[v])];
            const Vec3 p = model.vertices.row(static_cast<Eigen::Index>(v));
            part.box = part.any ? Bounds{part.box.low.cwiseMin(p), part.box.high.cwiseMax(p)} : Bounds{p, p};
            part.any = true;
            part.onBody = part.onBody || character.body->bodyVertex[v] >= 0;
            part.votes.resize(elements.size());
            ++part.votes[at(vertices[v].element)];
        }
        const double small = kSmallPart * boundsOf(model.vertices).diagonal();
        std::vector<double> sizes;
        for (const Element* element : elements) sizes.push_back(boundsOf(element->mesh->body.vertices).diagonal());
        for (std::size_t v = 0; v < count; ++v) {
            if (!used[v]) continue;
            Part& part = all.at(parts.find(first[v]));
            if (told[v] || part.onBody || part.box.diagonal() >= small) continue;
            const auto most = std::max_element(part.votes.begin(), part.votes.end()) - part.votes.begin();
            if (part.box.diagonal() >= kOfElement * sizes[static_cast<std::size_t>(most)]) continue;
            vertices[v].element = static_cast<std::int32_t>(most);
            if (!leftOut) continue;
            part.element = static_cast<std::int32_t>(most);
            part.vertices.push_back(static_cast<std::int32_t>(v));
        }
    }

    // Attached parts: rigid ones as a whole, others where they are to be.
    for (const Chosen& c : chosen) {
        std::int32_t element = c.element;
        const bool rigid = c.attachment->mode == Attachment::Mode::Rigid;
        if (c.vertices.empty() || (!rigid && element < 0)) continue;
        if (element < 0) {
            std::vector<std::size_t> votes(elements.size(), 0);
            for (const std::int32_t v : c.vertices) votes[at(vertices[at(v)].element)] += static_cast<std::size_t>(used[at(v)]);
            element = static_cast<std::int32_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
        }
        for (const std::int32_t v : c.vertices)
            if (rigid || vertices[at(v)].element != element) vertices[at(v)] = {element, -1, false};
        if (rigid) out.rigid.push_back({c.part, at(element), 0});
    }

    // Points of each element, in the order of the file.
    auto mesh = std::make_shared<EmbeddedMesh>();
    std::vector<std::vector<std::int32_t>> pointsOf(elements.size());
    for (std::size_t v = 0; v < count; ++v)
        if (!vertices[v].onBody) {
            auto& list = pointsOf[at(vertices[v].element)];
            vertices[v].index = static_cast<std::int32_t>(list.size());
            list.push_back(static_cast<std::int32_t>(v));
        }
    for (const auto& list : pointsOf) {
        if (list.empty()) {
            out.points.push_back(nullptr);
            continue;
        }
        auto points = std::make_shared<EmbeddedPoints>();
        points->rest.resize(static_cast<Eigen::Index>(list.size()), 3);
        points->normals.resize(static_cast<Eigen::Index>(list.size()), 3);
        for (std::size_t i = 0; i < list.size(); ++i) {
            points->rest.row(static_cast<Eigen::Index>(i)) = model.vertices.row(list[i]);
            points->normals.row(static_cast<Eigen::Index>(i)) = normals.row(first[at(list[i])]);  // at one place the same, or two sides of a sheet would follow different surfaces
        }
        const std::size_t element = out.points.size();
        for (auto& rigid : out.rigid) {
            if (rigid.element != element) continue;
            const auto c = std::find_if(chosen.begin(), chosen.end(), [&rigid](const Chosen& known) { return known.part == rigid.part; });
            rigid.index = static_cast<int>(points->attached.size());
            auto& part = points->attached.emplace_back();
            part.pivot = pivotOf(character, rigid.part);
            for (const std::int32_t v : c->vertices) part.points.push_back(vertices[at(v)].index);
        }
        for (const auto& [key, small] : all) {
            if (small.element != static_cast<std::int32_t>(element)) continue;
            auto& part = points->attached.emplace_back();
            part.pivot = 0.5 * (small.box.low + small.box.high);
            for (const std::int32_t v : small.vertices) part.points.push_back(vertices[at(v)].index);
        }
        out.points.push_back(std::move(points));
    }
    for (auto& vertex : vertices) vertex.element = out.places[at(vertex.element)];
    mesh->vertices = std::move(vertices);
    mesh->triangles = model.triangles;
    mesh->normals = fileNormals(character.model->mesh);
    if (!character.model->morphs.empty()) mesh->model = character.model;
    out.mesh = std::move(mesh);
    return out;
}

const EmbeddedModel& EmbeddedModels::of(const Document& document, const CharacterSource& character) {
    Known now{character.model, character.body, character.attachments, {}, {}, {}};
    const auto ids = document.elementsOf(character.id);
    std::vector<int> places;
    for (const PartId id : ids) {
        const auto element = document.elements.find(id);
        now.origins.push_back(element->second->piece->origin);
        now.meshes.push_back(element->second->mesh);
        places.push_back(static_cast<int>(std::distance(document.elements.begin(), element)));
    }
    auto& all = known_[character.id];
    const auto fits = [&](const std::shared_ptr<const Known>& k) {
        return k->model == now.model && k->body == now.body && k->attachments == now.attachments && k->origins == now.origins && k->meshes == now.meshes && k->embedded.elements == ids && k->embedded.places == places;
    };
    // Of two that are alike the latest: characters that were built lately have it.
    if (const auto found = std::find_if(all.rbegin(), all.rend(), fits); found != all.rend()) {
        std::rotate(found.base() - 1, found.base(), all.end());
        return all.back()->embedded;
    }
    now.embedded = embedModel(document, character);
    for (const auto& one : all) {
        const EmbeddedModel& was = one->embedded;
        for (std::size_t e = 0; e < ids.size(); ++e) {
            const auto before = std::find(was.elements.begin(), was.elements.end(), ids[e]);
            if (before == was.elements.end() || !now.embedded.points[e]) continue;
            const auto& points = was.points[static_cast<std::size_t>(before - was.elements.begin())];
            if (points && same(*points, *now.embedded.points[e])) now.embedded.points[e] = points;
        }
        if (same(*was.mesh, *now.embedded.mesh)) now.embedded.mesh = was.mesh;
    }
    remember(character.id, std::make_shared<const Known>(std::move(now)));
    return all.back()->embedded;
}

void EmbeddedModels::take(const EmbeddedModels& other) {
    for (const auto& [character, all] : other.known_)
        if (!all.empty()) remember(character, all.back());
}

void EmbeddedModels::remember(PartId character, std::shared_ptr<const Known> known) {
    constexpr std::size_t kMost = 2;
    auto& all = known_[character];
    std::erase(all, known);
    all.push_back(std::move(known));
    if (all.size() > kMost) all.erase(all.begin());
}

}  // namespace imomushi
