// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/cut_preview.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/body/cut.h"
#include "core/mesh/topology.h"

namespace imomushi {
namespace {

/// Directions that are tried around the normal, and how often the best of them is halved between its neighbours.
constexpr int kDirections = 12, kRefinements = 3;
/// How far below the surface the section that is meant is looked for, in diagonals: less than any limb is thick.
constexpr double kBelow = 1e-3;
/// A patch is a facet where its rim bends by this much on average; a sphere of 80 triangles bends by half of it.
constexpr double kCrease = 35.0 * std::numbers::pi / 180.0;

}  // namespace

std::pair<std::int32_t, std::int32_t> SectionFinder::ends(std::int32_t edge) const {
    const EdgeUse& use = surface_.edges.uses(edge).front();
    return {use.low, use.high};
}

Result<SectionFinder::Outline> SectionFinder::at(const CutPlane& plane) const {
    auto section = findSection(surface_, plane);
    if (!section) return tl::unexpected(section.error());
    Outline out;
    out.loops = std::move(section->loops);
    const auto& loop = out.loops.front();
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3 &a = loop[i].place, &b = loop[(i + 1) % loop.size()].place;
        const double side = (b - a).norm();
        out.centre += 0.5 * side * (a + b);
        out.length += side;
    }
    out.centre = out.length > 0.0 ? Vec3(out.centre / out.length) : loop.front().place;
    return out;
}

std::optional<CutPlane> SectionFinder::across(const Vec3& point, const Vec3& normal) const {
    const Vec3 n = normal.stableNormalized();
    const Vec3 x = n.unitOrthogonal(), y = n.cross(x);
    const Vec3 origin = point - kBelow * surface_.diagonal * n;
    double shortest = std::numeric_limits<double>::infinity(), best = 0.0;
    const auto normalAt = [&](double angle) { return Vec3(std::cos(angle) * x + std::sin(angle) * y); };
    const auto offer = [&](double angle) {
        const auto outline = at({origin, normalAt(angle)});
        if (!outline || outline->length >= shortest) return;
        shortest = outline->length;
        best = angle;
    };
    double step = std::numbers::pi / kDirections;
    for (int k = 0; k < kDirections; ++k) offer(k * step);
    if (!std::isfinite(shortest)) return std::nullopt;
    for (int k = 0; k < kRefinements; ++k) {
        step *= 0.5;
        const double middle = best;
        offer(middle - step);
        offer(middle + step);
    }
    CutPlane plane{origin, normalAt(best)};
    // The middle of the section reads better, and lies in it unless that is bent like a bean.
    if (const auto outline = at(plane)) {
        const CutPlane centred{outline->centre, plane.normal};
        const auto again = at(centred);
        if (again && std::abs(again->length - outline->length) < 1e-6 * outline->length) plane = centred;
    }
    const Vec3 middle = surface_.mesh.vertices.colwise().mean().transpose();
    if (plane.normal.dot(plane.origin - middle) < 0.0) plane.normal = -plane.normal;
    return plane;
}

bool SectionFinder::isFacet(const JointFace& patch) const {
    double bend = 0.0, length = 0.0;
    for (const std::int32_t t : patch.triangles)
        for (int k = 0; k < 3; ++k) {
            const int edge = surface_.edges.edgeOf(t, k);
            if (edge < 0) continue;
            for (const EdgeUse& use : surface_.edges.uses(edge)) {
                if (use.triangle == t || std::binary_search(patch.triangles.begin(), patch.triangles.end(), use.triangle)) continue;
                const Vec3 a = areaVector(surface_.mesh, t).stableNormalized(), b = areaVector(surface_.mesh, use.triangle).stableNormalized();
                const double side = (surface_.mesh.vertices.row(use.low) - surface_.mesh.vertices.row(use.high)).norm();
                bend += side * std::acos(std::clamp(a.dot(b), -1.0, 1.0));
                length += side;
            }
        }
    return length > 0.0 && bend > kCrease * length;
}

std::optional<CutPlane> nearestCut(const Document& document, PartId id, PartId moved, const CutPlane& plane) {
    const auto element = document.elements.find(id);
    if (element == document.elements.end()) return std::nullopt;
    std::vector<CutPlane> planes;
    const TriangleMesh* body = &element->second->mesh->body;
    int at = -1;
    if (element->second->piece) {
        const CharacterSource& character = *document.characters.at(element->second->piece->character);
        body = &character.body->mesh;
        for (const Cut& cut : character.cuts) {
            if (cut.id == moved) at = int(planes.size());
            planes.push_back(cut.id == moved ? plane : cut.plane);
        }
    }
    if (at < 0) {
        at = int(planes.size());
        planes.push_back(plane);
    }
    const auto pieces = cutBody(*body, planes);
    if (pieces || pieces.error().cut != at) return std::nullopt;
    return pieces.error().nearest;
}

}  // namespace imomushi
