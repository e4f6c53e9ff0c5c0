// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/snap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/finite.h"
#include "ui/models/paths.h"
#include "ui/picking/picking.h"
#include "ui/scene/posed_body.h"
#include "ui/scene/seen_mesh.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Pixels of the design within which a place is taken; where one that was taken is left; and how much nearer another one must be to take its place.
constexpr double kTakePixels = 12.0, kLeavePixels = 18.0, kNearerPixels = 4.0;
/// Rays around the pointer find vertices of a body whose rim it is beside.
constexpr double kAroundPixels = 9.0;
constexpr int kAround = 8;
/// The grid that is chosen by itself is the power of ten (in metres) that is at least this many pixels wide.
constexpr double kGridPixels = 12.0;
/// A step is left this far from it: half a step, and some more, so that it does not flicker.
constexpr double kLeaveStep = 0.6;
constexpr double kFactorStep = 0.1;

/// The same view with the pointer over `p`.
PointerEvent through(const PointerEvent& e, const Vec3& p) {
    PointerEvent at = e;
    if (const auto s = e.onScreen(p)) {
        at.x = s->x();
        at.y = s->y();
    }
    if (e.pixelSize > 0.0) {
        at.rayOrigin = p - e.viewForward.dot(p - e.rayOrigin) * e.viewForward;
    } else if ((p - e.rayOrigin).norm() > 0.0) {
        at.rayDirection = (p - e.rayOrigin).normalized();
    }
    return at;
}

double pixelsFrom(const PointerEvent& e, const Vec3& p) {
    const auto s = e.onScreen(p);
    return s ? (*s - Eigen::Vector2d(e.x, e.y)).norm() : std::numeric_limits<double>::infinity();
}

/// The point of an edge that the pointer's ray passes nearest to.
Vec3 nearestOnEdge(const PointerEvent& e, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a, from = e.rayOrigin - a;
    const double slope = along.dot(e.rayDirection), square = along.squaredNorm() - slope * slope;
    if (!(square > 1e-12 * along.squaredNorm())) return a;  // seen end on
    return a + std::clamp((from.dot(along) - slope * from.dot(e.rayDirection)) / square, 0.0, 1.0) * along;
}

double inSteps(double free, double step, std::optional<double> held) {
    if (!(step > 0.0)) return free;
    if (held && std::abs(free - *held) <= kLeaveStep * step && std::abs(std::remainder(*held, step)) < 1e-6 * step) return *held;
    return step * std::round(free / step);
}

}  // namespace

void Snap::begin(Moving moving) {
    moving_ = std::move(moving);
    place_.reset();
    held_.reset();
}

double Snap::step(const PointerEvent& e, double pixel) const {
    const double fine = (e.modifiers & Qt::ShiftModifier) ? 0.1 : 1.0;
    return fine * (settings_.step > 0.0 ? settings_.step : std::pow(10.0, std::ceil(std::log10(kGridPixels * std::max(pixel, 1e-12)))));
}

double Snap::rounded(double free, double step) {
    held_ = inSteps(free, step, held_);
    return *held_;
}

double Snap::angle(const PointerEvent& e, double free) {
    if (!acts(e) || !settings_.angle) return free;
    return rounded(free, settings_.angleStep * ((e.modifiers & Qt::ShiftModifier) ? 0.1 : 1.0));
}

double Snap::factor(const PointerEvent& e, double free) {
    if (!acts(e) || !settings_.grid) return free;
    return rounded(free, kFactorStep * ((e.modifiers & Qt::ShiftModifier) ? 0.1 : 1.0));
}

double Snap::length(const PointerEvent& e, double free, double pixel) { return acts(e) && settings_.grid ? rounded(free, step(e, pixel)) : free; }

Vec3 Snap::point(const PointerEvent& e, const Vec3& free, bool atPointer) {
    if (!acts(e) || !allFinite(free)) {
        place_.reset();
        return free;
    }
    auto found = find(atPointer ? e : through(e, free));
    if (!found && settings_.grid) {
        const double wide = step(e, e.pixelAt(free));
        found = Place{Place::Kind::Grid, free, 0, -1};
        for (int k = 0; k < 3; ++k) {
            const bool held = place_ && place_->kind == Place::Kind::Grid;
            found->at[k] = inSteps(free[k], wide, held ? std::optional(place_->at[k]) : std::nullopt);
        }
    }
    place_ = found;
    return place_ ? place_->at : free;
}

std::optional<Snap::Place> Snap::find(const PointerEvent& e) const {
    const Session& session = document_.session();
    std::vector<std::pair<double, Place>> near;
    const auto offer = [&](const Place& place) {
        if (const double pixels = pixelsFrom(e, place.at); pixels <= kLeavePixels) near.emplace_back(pixels, place);
    };
    if (settings_.ends)
        for (const EndpointRef& end : endpointsUnder(session, e, kLeavePixels))
            if (const auto at = moving_.end && moving_.end(end) ? std::nullopt : endpointPosition(session, end)) offer({Place::Kind::End, *at, end.bone, end.atEnd ? 1 : 0});

    const auto stands = [&](const RayHit& hit) { return !(moving_.element && moving_.element(hit.element)); };
    const auto seenFrom = [&](const PointerEvent& eye) {
        auto hits = rayHits(session, eye.rayOrigin, eye.rayDirection);
        std::erase_if(hits, [&](const RayHit& hit) { return !stands(hit); });
        return hits;
    };
    const auto entry = [](const std::vector<RayHit>& hits) { return std::find_if(hits.begin(), hits.end(), [](const RayHit& hit) { return hit.entering; }); };
    std::vector<RayHit> hits;
    const bool corners = settings_.vertices || settings_.edges;
    if (corners || settings_.surface || settings_.middle) hits = seenFrom(e);
    std::vector<std::pair<double, Place>> edges;  // behind vertices and ends, which are places of their own on them
    if (corners) {
        const auto offerEdge = [&](PartId of, std::int32_t v, std::int32_t w, const auto& at) {
            const Place place{Place::Kind::Edge, nearestOnEdge(e, at(v), at(w)), of, std::min(v, w), std::max(v, w)};
            if (const double pixels = pixelsFrom(e, place.at); pixels <= kLeavePixels) edges.emplace_back(pixels, place);
        };
        const auto offerTriangle = [&](PartId of, const auto& vertices, const auto& at) {
            for (int c = 0; c < 3; ++c) {
                const std::int32_t v = vertices(c), w = vertices((c + 1) % 3);
                if (settings_.vertices) offer({Place::Kind::Vertex, at(v), of, v});
                if (settings_.edges) offerEdge(of, v, w, at);
            }
        };
        const auto offerAlong = [&](const std::vector<RayHit>& along) {
            const auto hit = entry(along);
            if (hit == along.end()) return;
            if (hit->character) {
                for (const SeenMesh& seen : seenMeshes(session))
                    if (seen.source->id == hit->character) offerTriangle(hit->character, seen.model().mesh.body.triangles.row(hit->seen), [&](std::int32_t v) { return seen.at(v); });
                return;
            }
            const Element& element = *session.document().elements.at(hit->element);
            const PosedBody body(session, hit->element, element);
            offerTriangle(hit->element, element.mesh->body.triangles.row(hit->triangle), [&](std::int32_t v) { return body.at(v); });
        };
        offerAlong(hits);
        // What was reached is seen further off than rays around the pointer find it.
        if (place_ && place_->kind == Place::Kind::Edge) {
            const auto element = session.document().elements.find(place_->of);
            if (element != session.document().elements.end() && place_->to < element->second->mesh->body.vertices.rows()) {
                const PosedBody body(session, place_->of, *element->second);
                offerEdge(place_->of, place_->index, place_->to, [&](std::int32_t v) { return body.at(v); });
            }
            for (const SeenMesh& seen : seenMeshes(session))
                if (seen.source->id == place_->of && place_->to < seen.model().mesh.body.vertices.rows()) offerEdge(place_->of, place_->index, place_->to, [&](std::int32_t v) { return seen.at(v); });
        }
        const Vec3 up = e.viewRight.cross(e.viewForward), middle = e.rayOrigin + e.rayDirection / std::max(1e-9, e.viewForward.dot(e.rayDirection));
        for (int i = 0; i < kAround; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / kAround, reach = kAroundPixels * e.pixelAt(middle);
            offerAlong(seenFrom(through(e, middle + reach * (std::cos(angle) * e.viewRight + std::sin(angle) * up))));
        }
    }
    std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    if (!near.empty()) {
        const auto held = std::find_if(near.begin(), near.end(), [&](const auto& n) { return place_ && n.second.sameAs(*place_); });
        if (held != near.end() && held->first - near.front().first < kNearerPixels) return held->second;
        if (near.front().first <= kTakePixels) return near.front().second;
    }
    // Along a line of edges it slides on from one to the next.
    const auto nearest = std::min_element(edges.begin(), edges.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    if (nearest != edges.end() && (nearest->first <= kTakePixels || (place_ && place_->kind == Place::Kind::Edge))) return nearest->second;
    const std::vector<RayHit>::const_iterator in = entry(hits);
    if (in == hits.cend()) return std::nullopt;
    if (settings_.middle) {
        const auto out = std::find_if(in + 1, hits.cend(), [&](const RayHit& hit) { return !hit.entering && hit.element == in->element; });
        if (out != hits.cend()) return Place{Place::Kind::Middle, 0.5 * (in->point + out->point), in->element, -1};
    }
    return settings_.surface ? std::optional(Place{Place::Kind::Surface, in->point, in->element, -1}) : std::nullopt;
}

QString Snap::text() const {
    if (!place_) return {};
    const Document& d = document_.document();
    const auto name = [&]() -> QString {
        if (const auto element = d.elements.find(place_->of); element != d.elements.end()) return QString::fromStdString(element->second->name);
        if (const auto character = d.characters.find(place_->of); character != d.characters.end()) return QString::fromStdString(character->second->name);
        return {};
    };
    switch (place_->kind) {
        case Place::Kind::Grid: return ToolTexts::tr("On the grid");
        case Place::Kind::Vertex: return ToolTexts::tr("To a vertex of %1").arg(name());
        case Place::Kind::Edge: return ToolTexts::tr("To an edge of %1").arg(name());
        case Place::Kind::Surface: return ToolTexts::tr("To the surface of %1").arg(name());
        case Place::Kind::Middle: return ToolTexts::tr("To the middle of %1").arg(name());
        case Place::Kind::End: break;
    }
    return d.bones.contains(place_->of) ? ToolTexts::tr("To %1").arg(QString::fromStdString(pathOf(d, EndpointRef{place_->of, place_->index == 1}))) : QString();
}

QString Snap::before(const QString& hint) const {
    const QString now = text();
    return now.isEmpty() ? hint : now + QStringLiteral(" · ") + hint;
}

void Snap::decorate(render::Scene& scene) const {
    if (!place_ || !allFinite(place_->at)) return;
    render::Marker mark;
    mark.shape = render::Marker::Shape::SnapMark;
    mark.from = mark.to = place_->at;
    scene.markers.push_back(std::move(mark));
}

}  // namespace imomushi
