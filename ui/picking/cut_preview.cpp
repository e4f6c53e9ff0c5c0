// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/picking/cut_preview.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "core/body/cut.h"
#include "core/mesh/topology.h"

namespace imomushi {
namespace {

/// Directions that are tried around the normal, and how often the best of them is halved between its neighbours. Those that are farthest from each other come first: one of them goes nearly
/// across a limb, and no way that is longer is followed to its end.
constexpr std::array kDirections{0, 6, 3, 9, 1, 7, 4, 10, 2, 8, 5, 11};
constexpr int kRefinements = 3;
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

std::optional<double> SectionFinder::lengthAround(std::int32_t triangle, const CutPlane& plane, double most) const {
    const TriangleMesh& mesh = surface_.mesh;
    const auto distance = [&](std::int32_t v) { return plane.normal.dot(mesh.vertices.row(v).transpose() - plane.origin); };
    // From triangle to triangle over the edges that the plane crosses: of a closed surface that leads back. Of each next triangle only the third corner is new.
    struct Corner {
        std::int32_t vertex = -1;
        double distance = 0.0;
    };
    std::array<Corner, 2> known;  // of the edge that was crossed last
    double length = 0.0;
    std::int32_t at = triangle, over = -1;
    Vec3 first = Vec3::Zero(), last = Vec3::Zero();
    for (Eigen::Index steps = 0; steps <= mesh.triangles.rows(); ++steps) {
        std::array<Corner, 3> corner;
        for (int k = 0; k < 3; ++k) {
            const std::int32_t v = mesh.triangles(at, k);
            const auto before = std::ranges::find(known, v, &Corner::vertex);
            corner[std::size_t(k)] = before != known.end() ? *before : Corner{v, distance(v)};
        }
        std::int32_t next = -1;
        Vec3 place = Vec3::Zero();
        for (int k = 0; k < 3 && next < 0; ++k) {
            const Corner &a = corner[std::size_t(k)], &b = corner[std::size_t((k + 1) % 3)];
            if ((a.distance >= 0.0) == (b.distance >= 0.0)) continue;
            const std::int32_t edge = surface_.edges.edgeOf(at, k);
            if (edge < 0 || edge == over) continue;
            place = mesh.vertices.row(a.vertex).transpose() + a.distance / (a.distance - b.distance) * (mesh.vertices.row(b.vertex) - mesh.vertices.row(a.vertex)).transpose();
            known = {a, b};
            next = edge;
        }
        const auto uses = next < 0 ? std::span<const EdgeUse>() : std::span<const EdgeUse>(surface_.edges.uses(next));
        if (uses.size() != 2) return std::nullopt;
        if (over >= 0) length += (place - last).norm();
        else first = place;
        if (length > most) return std::nullopt;
        last = place;
        over = next;
        at = uses[0].triangle == at ? uses[1].triangle : uses[0].triangle;
        if (at == triangle) return length + (first - last).norm();
    }
    return std::nullopt;
}

std::optional<SectionFinder::Across> SectionFinder::across(const Vec3& point, const Vec3& normal, std::int32_t triangle) const {
    const Vec3 n = normal.stableNormalized();
    const Vec3 x = n.unitOrthogonal(), y = n.cross(x);
    const Vec3 origin = point - kBelow * surface_.diagonal * n;
    const auto normalAt = [&](double angle) { return Vec3(std::cos(angle) * x + std::sin(angle) * y); };
    /// The angle of the shortest section; not a number: nothing there can be measured.
    const auto search = [&](const auto& measure) {
        double shortest = std::numeric_limits<double>::infinity(), best = std::numeric_limits<double>::quiet_NaN();
        const auto offer = [&](double angle) {
            const std::optional<double> length = measure(CutPlane{origin, normalAt(angle)}, shortest);
            if (!length || *length >= shortest) return;
            shortest = *length;
            best = angle;
        };
        double step = std::numbers::pi / double(kDirections.size());
        for (const int k : kDirections) offer(k * step);
        if (!std::isfinite(shortest)) return best;
        for (int k = 0; k < kRefinements; ++k) {
            step *= 0.5;
            const double middle = best;
            offer(middle - step);
            offer(middle + step);
        }
        return best;
    };
    // The way round is all that the search needs; where the plane that it finds does not cut, whole sections are asked.
    double best = triangle < 0 ? std::numeric_limits<double>::quiet_NaN() : search([&](const CutPlane& p, double shortest) { return lengthAround(triangle, p, shortest); });
    auto outline = std::isfinite(best) ? at({origin, normalAt(best)}) : Result<Outline>(tl::unexpected(Error{}));
    if (!outline) {
        best = search([&](const CutPlane& p, double) {
            const auto section = at(p);
            return section ? std::optional(section->length) : std::nullopt;
        });
        if (!std::isfinite(best)) return std::nullopt;
        outline = at({origin, normalAt(best)});
        if (!outline) return std::nullopt;
    }
    Across found{{origin, normalAt(best)}, std::move(*outline)};
    // The middle of the section reads better, and lies in it unless that is bent like a bean.
    const CutPlane centred{found.outline.centre, found.plane.normal};
    if (auto again = at(centred); again && std::abs(again->length - found.outline.length) < 1e-6 * found.outline.length) found = {centred, std::move(*again)};
    if (found.plane.normal.dot(found.plane.origin - middle_) < 0.0) found.plane.normal = -found.plane.normal;
    return found;
}

bool SectionFinder::isFacet(const JointFace& patch) const {
    double bend = 0.0, length = 0.0;
    std::vector<char> within(std::size_t(surface_.mesh.triangles.rows()), 0);
    for (const std::int32_t t : patch.triangles) within[std::size_t(t)] = 1;
    for (const std::int32_t t : patch.triangles)
        for (int k = 0; k < 3; ++k) {
            const int edge = surface_.edges.edgeOf(t, k);
            if (edge < 0) continue;
            for (const EdgeUse& use : surface_.edges.uses(edge)) {
                if (within[std::size_t(use.triangle)]) continue;
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
