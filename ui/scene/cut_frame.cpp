// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/cut_frame.h"

#include <algorithm>

#include "core/base/decompositions.h"
#include "core/mesh/bounds.h"
#include "ui/scene/posed_body.h"
#include "ui/scene/rim.h"

namespace imomushi {

namespace {

// The plane of a cut without a joint face, in diagonals of the body.
constexpr double kReach = 0.08;

}  // namespace

std::optional<CutFrame> cutFrame(const Session& session, PartId id) {
    const Document& document = session.document();
    const CharacterSource* character = nullptr;
    for (const auto& [key, source] : document.characters)
        if (source->cutIndex(id) >= 0) character = source.get();
    if (!character) return std::nullopt;
    const Cut& cut = character->cuts[static_cast<std::size_t>(character->cutIndex(id))];

    CutFrame frame;
    std::string face;
    for (const PartId part : document.elementsOf(character->id)) {
        const CharacterPiece& piece = *document.elements.at(part)->piece;
        const int side = piece.sideIndex(id);
        if (side < 0) continue;
        const CutSide& of = piece.sides[static_cast<std::size_t>(side)];
        frame.elements[of.front ? 1 : 0] = part;
        if (!of.front) face = of.face;
    }
    const Vec3 normal = cut.plane.normal.stableNormalized();
    frame.normal = normal;
    frame.centre = frame.restCentre = cut.plane.origin;
    const auto behind = document.elements.find(frame.elements[0]);
    const int index = behind == document.elements.end() ? -1 : behind->second->faceIndex(face);
    if (index < 0) {
        frame.reach = kReach * diagonalOf(character->body->mesh.vertices);
        return frame;
    }
    const Element& element = *behind->second;
    const PosedBody body(session, element.id, element);
    const std::vector<std::int32_t>& cap = element.faces[static_cast<std::size_t>(index)].triangles;
    const TriangleMesh& rest = element.mesh->body;
    Vec3 sum = Vec3::Zero(), restSum = Vec3::Zero(), area = Vec3::Zero();
    double weights = 0.0;
    for (const std::int32_t t : cap) {
        std::array<Vec3, 3> p, q;
        for (int c = 0; c < 3; ++c) {
            p[static_cast<std::size_t>(c)] = body.at(rest.triangles(t, c));
            q[static_cast<std::size_t>(c)] = rest.vertices.row(rest.triangles(t, c));
        }
        const double weight = (q[1] - q[0]).cross(q[2] - q[0]).norm();
        sum += weight / 3.0 * (p[0] + p[1] + p[2]);
        restSum += weight / 3.0 * (q[0] + q[1] + q[2]);
        area += (p[1] - p[0]).cross(p[2] - p[0]);
        weights += weight;
    }
    if (weights > 0.0) {
        frame.centre = sum / weights;
        frame.restCentre = restSum / weights;
    }
    if (area.norm() > 0.0) frame.normal = area.stableNormalized();  // the cap behind looks along the plane's normal
    frame.rotation = shortestRotation(normal, frame.normal);
    frame.reach = 0.0;
    const auto rims = rimsOf(behind->second);
    for (const auto& loop : (*rims)[static_cast<std::size_t>(index)]) {
        std::vector<Vec3>& points = frame.rim.emplace_back();
        for (const std::int32_t v : loop) {
            points.push_back(body.at(v));
            frame.reach = std::max(frame.reach, (points.back() - frame.centre).norm());
        }
    }
    return frame;
}

}  // namespace imomushi
