// SPDX-License-Identifier: GPL-3.0-or-later
// Whole characters: what is seen of them, and their cuts.
#include <algorithm>
#include <span>

#include "core/base/hash.h"
#include "ui/scene/cut_frame.h"
#include "ui/scene/document_scene.h"

namespace imomushi {

namespace {

// Of render meshes, where the bodies under them are shown.
constexpr float kSeenThrough = 0.3f;

void gather(const float* from, const std::vector<std::int32_t>& which, std::vector<float>& to) {
    to.resize(3 * which.size());
    for (std::size_t i = 0; i < which.size(); ++i) std::copy_n(from + 3 * static_cast<std::ptrdiff_t>(which[i]), 3, &to[3 * i]);
}

}  // namespace

void DocumentScene::addRenderMeshes(const Session& session, const SceneOptions& options, render::Scene& scene) {
    const Document& document = session.document();
    for (SeenMesh& seen : seenMeshes(session, scene.deformInput)) {
        const bool unmade = seen.index >= 0 && !seen.surface.positions;
        CharacterParts& of = characters_[seen.source->id];
        const TriangleMesh& whole = seen.model().mesh.body;
        const bool sameModel = of.model == seen.source->model;
        if (!sameModel || of.embedded != seen.embedded || of.elements != seen.elements) {
            of.parts = renderParts(seen, sameModel ? of.parts : std::vector<RenderPart>());
            of.model = seen.source->model;
            of.embedded = seen.embedded;
            of.elements = seen.elements;
            of.lowest = whole.vertices.rows() ? whole.vertices.col(1).minCoeff() : 0.0;
            of.positions.resize(of.parts.size());
            of.normals.resize(of.parts.size());
        }
        scene.ground = std::min(scene.ground, of.lowest);
        const std::size_t firstBody = scene.bodies.size();
        std::vector<std::size_t> partOf;  // of the bodies that are added
        for (std::size_t i = 0; i < of.parts.size(); ++i) {
            const RenderPart& part = of.parts[i];
            const auto element = document.elements.find(part.element);
            if (element == document.elements.end() || !element->second->visible) continue;
            render::Body& body = scene.bodies.emplace_back();
            partOf.push_back(i);
            body.id = sceneId({ScenePart::Kind::Element, part.element, -1, false});
            body.mesh = part.mesh;
            body.textures = std::shared_ptr<const ElementMesh>(seen.source->model, &seen.source->model->mesh);
            body.modelVertices = &part.vertices;
            body.twoSided = true;  // anything goes
            body.color = element->second->color;
            body.opacity = options.bodies ? std::min(options.bodyOpacity, kSeenThrough) : options.bodyOpacity;
            body.pickable = !element->second->locked;
            body.selected = options.isSelected(body.id) || options.isSelected(sceneId({ScenePart::Kind::Character, seen.source->id, -1, false}));
            body.hovered = options.hovered == body.id;
            body.outdated = session.responseState(part.element) == Session::ResponseState::Stale && !session.responses().isDraft(part.element);
            ContentHasher content;
            if (unmade) {
                body.deformSurface = static_cast<int>(scene.deformInput->elements.size()) + seen.index;
                content.number(scene.deformInput->id);
                for (const auto e : scene.deformInput->meshes[static_cast<std::size_t>(seen.index)].elements)
                    content.number(scene.deformInput->elements[static_cast<std::size_t>(e)].frame.revision);
                body.revision = content.key().low;
                continue;
            }
            if (seen.surface.positions) {
                gather(seen.surface.positions, part.vertices, of.positions[i]);
                gather(seen.surface.normals, part.vertices, of.normals[i]);
                body.normals = of.normals[i].data();
            } else {
                of.positions[i].resize(3 * part.vertices.size());
                Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(of.positions[i].data(), part.mesh->body.vertices.rows(), 3) = part.mesh->body.vertices.cast<float>();
            }
            body.positions = of.positions[i].data();
            content.array(std::span<const float>(of.positions[i]));
            body.revision = content.key().low;
        }
        if (!options.marked || options.marked->character != seen.source->id) continue;
        if (unmade) seen.surface = session.character()->renderSurface(seen.index);
        addMarked(seen, of, *options.marked, firstBody, partOf, scene);
    }
}

void DocumentScene::addMarked(const SeenMesh& seen, CharacterParts& of, const MarkedPlace& marked, std::size_t firstBody, const std::vector<std::size_t>& partOf, render::Scene& scene) {
    of.marked.assign(of.parts.size(), {});
    for (std::size_t b = 0; b < partOf.size(); ++b) {
        const auto& triangles = of.parts[partOf[b]].triangles;
        auto& here = of.marked[partOf[b]];
        for (const std::int32_t t : marked.triangles)
            if (const auto at = std::lower_bound(triangles.begin(), triangles.end(), t); at != triangles.end() && *at == t) here.push_back(static_cast<std::int32_t>(at - triangles.begin()));
        if (!here.empty()) scene.bodies[firstBody + b].highlightedTriangles = &here;
    }
    const Points& rest = seen.model().mesh.body.vertices;
    if (!marked.point || rest.rows() == 0) return;
    Eigen::Index nearest = 0;
    (rest.rowwise() - marked.point->transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    render::Marker point;
    point.shape = render::Marker::Shape::HeldPoint;
    point.from = point.to = seen.at(static_cast<std::int32_t>(nearest)) + (*marked.point - rest.row(nearest).transpose());
    point.hovered = true;
    scene.markers.push_back(std::move(point));
}

void DocumentScene::addCuts(const Session& session, const SceneOptions& options, render::Scene& scene) {
    for (const auto& [id, character] : session.document().characters)
        for (const Cut& cut : character->cuts) {
            const std::uint64_t item = sceneId({ScenePart::Kind::Cut, cut.id, -1, false});
            const bool selected = options.isSelected(item), hovered = options.hovered == item;
            if (!cut.visible || (!selected && !hovered)) continue;
            const auto frame = cutFrame(session, cut.id);
            if (!frame) continue;
            for (const auto& loop : frame->rim) {
                render::Marker rim;
                rim.shape = render::Marker::Shape::FaceOutline;
                rim.id = item;
                rim.outline = loop;
                rim.from = rim.to = loop.front();
                rim.selected = selected;
                rim.hovered = hovered;
                scene.markers.push_back(std::move(rim));
            }
            if (!selected || cut.locked) continue;
            render::Marker plane;
            plane.shape = render::Marker::Shape::PlaneGizmo;
            plane.id = item;
            plane.from = frame->centre;
            plane.to = frame->centre + frame->reach * frame->normal;
            plane.selected = selected;
            plane.hovered = hovered;
            scene.markers.push_back(std::move(plane));
        }
}

}  // namespace imomushi
