// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/limb_cuts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace imomushi {
namespace {

constexpr int kStations = 48;         // of a limb
constexpr double kFinestStation = 0.005;     // between stations
/// Going inward, the flesh of the hub begins where the radius of the section grows by more than this per length: a cone of 40 degrees to each side.
constexpr double kFlare = 0.85;
/// The neck is looked for this far outward from there, in radii; what is farther out must be narrower by this part per radius.
constexpr double kNeckWindow = 1.3, kNeckFarther = 0.25;
/// What is left beyond the first cut is at least so many radii of it long: more than the corner of a cube, 1.1.
constexpr double kLeastEnd = 1.15;
/// The same where it is known what stands out.
constexpr double kKnownWindow = 0.6, kLeastKnown = 0.8;
/// Cuts between pieces are looked for this far to both sides, in lengths of the pieces; how much a right angle is worth against a section twice the area.
constexpr double kPieceWindow = 0.22, kBend = 1.5;

class Line {
public:
    Line(const CutSurface& surface, const Limb& limb) : limb_(limb), length_(limb.length()) {
        step_ = std::max(length_ / kStations, kFinestStation);
        const int count = std::max(2, static_cast<int>(std::floor(length_ / step_)) + 1);
        for (int i = 0; i < count; ++i) stations_.push_back(station(surface, static_cast<double>(i) * step_));
    }

    [[nodiscard]] double length() const { return length_; }
    [[nodiscard]] double step() const { return step_; }
    [[nodiscard]] const std::vector<LimbStation>& stations() const { return stations_; }
    [[nodiscard]] std::size_t index(double way) const { return std::min(stations_.size() - 1, static_cast<std::size_t>(std::max(0.0, std::round(way / step_)))); }

    /// Mean radius of the sections between two ways.
    [[nodiscard]] double meanRadius(double from, double to) const {
        double sum = 0.0, count = 0.0;
        for (const LimbStation& s : stations_)
            if (s.radius > 0.0 && s.way >= from && s.way <= to) sum += s.radius, count += 1.0;
        return count > 0.0 ? sum / count : stations_[index(0.5 * (from + to))].radius;
    }

    /// How much the line bends at a way, radians.
    [[nodiscard]] double bend(double way, double reach) const {
        const Vec3 at = pointAlong(limb_.line, way);
        const Vec3 in = at - pointAlong(limb_.line, std::max(0.0, way - reach)), out = pointAlong(limb_.line, std::min(length_, way + reach)) - at;
        return in.norm() > 0.0 && out.norm() > 0.0 ? std::atan2(in.cross(out).norm(), in.dot(out)) : 0.0;
    }

private:
    [[nodiscard]] double ballAt(double way) const {
        for (std::size_t i = 1; i < limb_.line.size(); ++i) {
            const double side = (limb_.line[i] - limb_.line[i - 1]).norm();
            if (way <= side) return std::max(limb_.radius[i - 1], limb_.radius[i]);
            way -= side;
        }
        return limb_.radius.back();
    }

    [[nodiscard]] LimbStation station(const CutSurface& surface, double way) const {
        LimbStation made;
        made.way = way;
        made.at = pointAlong(limb_.line, way);
        const double reach = std::max(0.8 * ballAt(way), 2.0 * step_);
        Vec3 along = pointAlong(limb_.line, std::min(length_, way + reach)) - pointAlong(limb_.line, std::max(0.0, way - reach));
        if (!(along.norm() > 1e-9)) along = limb_.line.back() - limb_.line.front();
        if (!(along.norm() > 1e-9)) return made;
        made.normal = along.normalized();
        const auto section = findSection(surface, {made.at, made.normal});
        if (!section) return made;
        double area = 0.0, outer = 0.0;
        Eigen::Vector2d middle = Eigen::Vector2d::Zero();
        const Eigen::Vector2d here = section->flat(made.at);
        bool inside = false;
        for (std::size_t l = 0; l < section->loops.size(); ++l) {
            const auto& loop = section->loops[l];
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const Eigen::Vector2d a = section->flat(loop[i].place), b = section->flat(loop[(i + 1) % loop.size()].place);
                const double twice = a.x() * b.y() - a.y() * b.x();
                area += 0.5 * twice;
                if (l > 0) continue;
                outer += 0.5 * twice, middle += twice / 6.0 * (a + b);
                if ((a.y() > here.y()) != (b.y() > here.y()) && ((b - a).x() * (here - a).y() - (b - a).y() * (here - a).x() > 0.0) == (b.y() > a.y())) inside = !inside;
            }
        }
        // A section beside the line is another limb's, or a slice of a bulge.
        if (!inside || !(area > 0.0) || !(outer > 0.0)) return made;
        made.radius = std::sqrt(area / std::numbers::pi);
        made.at = section->lifted(middle / outer);
        return made;
    }

    const Limb& limb_;
    double length_, step_ = 0.0;
    std::vector<LimbStation> stations_;
};

/// Cuts between two ways, near equal parts of what goes on for `beyond` after the second one.
void divide(const Line& line, double from, double to, double beyond, double perPiece, int most, std::vector<LimbStation>& cuts) {
    const double thickness = 2.0 * line.meanRadius(from, from + 0.75 * (to - from));
    if (!(thickness > 0.0)) return;
    const int pieces = std::clamp(static_cast<int>(std::lround((to + beyond - from) / (perPiece * thickness))), 1, most);
    const double length = (to + beyond - from) / pieces;
    for (int k = 1; k < pieces; ++k) {
        const double middle = from + k * length;
        if (middle >= to) break;
        const double usual = line.stations()[line.index(middle)].radius;
        const LimbStation* best = nullptr;
        double least = HUGE_VAL;
        for (const LimbStation& s : line.stations()) {
            if (!(s.radius > 0.0) || std::abs(s.way - middle) > kPieceWindow * length || s.way >= to) continue;
            const double area = usual > 0.0 ? s.radius * s.radius / (usual * usual) : 1.0;
            const double off = (s.way - middle) / (kPieceWindow * length);
            const double cost = area - kBend * line.bend(s.way, 0.4 * length) * 2.0 / std::numbers::pi + 0.1 * off * off;
            if (cost < least) least = cost, best = &s;
        }
        if (best && (cuts.empty() || best->way > cuts.back().way)) cuts.push_back(*best);
    }
}

}  // namespace

std::vector<LimbStation> cutsOfLimb(const CutSurface& surface, const Hub& hub, const Limb& limb, double perPiece, int most) {
    const Line line(surface, limb);
    const auto& stations = line.stations();
    const double ball = hub.radius[static_cast<std::size_t>(limb.point)];
    const double end = limb.end.empty() ? line.length() : line.length() - 0.7 * limb.end[0].radius[0];
    double exit = 0.0;
    for (const LimbStation& s : stations)
        if ((pointAlong(limb.line, s.way) - limb.line.front()).norm() <= kOutside * ball) exit = s.way + line.step();
    exit = std::min(exit, 0.7 * end);
    // Inward from the middle of the limb to where the flesh of the hub begins.
    const bool known = limb.own > 0.0 && end - limb.own > exit;
    const double begin = std::max(exit, std::min(limb.hidden, 0.7 * end));
    std::size_t base = line.index(known ? end - limb.own : begin + 0.4 * (end - begin));
    while (base + 1 < stations.size() && !(stations[base].radius > 0.0)) ++base;
    for (std::size_t i = base; !known && i-- > 0 && stations[i].way >= exit;) {
        if (!(stations[i].radius > 0.0)) break;
        const std::size_t before = i > 0 && stations[i - 1].radius > 0.0 ? i - 1 : i;
        const double flare = (stations[before].radius - stations[i + 1].radius) / (stations[i + 1].way - stations[before].way);
        if (flare > kFlare) break;
        base = i;
    }
    const LimbStation* neck = nullptr;
    double least = HUGE_VAL;
    for (std::size_t i = base; i < stations.size(); ++i) {
        const LimbStation& s = stations[i];
        const double beyond = (s.way - stations[base].way) / std::max(stations[base].radius, line.step());
        if (beyond > (known ? kKnownWindow : kNeckWindow) || s.way > end) break;
        if (!(s.radius > 0.0) || end - s.way < (!limb.end.empty() ? 0.0 : known ? kLeastKnown : kLeastEnd) * s.radius) continue;
        const double cost = s.radius * s.radius * (1.0 + kNeckFarther * beyond);
        if (cost < least) least = cost, neck = &s;
    }
    if (!neck) return {};
    std::vector<LimbStation> cuts = {*neck};
    divide(line, neck->way, end, limb.beyond, perPiece, most, cuts);
    return cuts;
}

std::vector<std::vector<LimbStation>> cutsOfChain(const CutSurface& surface, const Hub& root, double perPiece, int most) {
    const Line first(surface, root.limbs[0]), second(surface, root.limbs[1]);
    const double length = first.length() + second.length();
    const double thickness = first.meanRadius(0.0, first.length()) + second.meanRadius(0.0, second.length());
    const int wanted = std::clamp(static_cast<int>(std::lround(length / (perPiece * std::max(thickness, kFinestStation)))), 3, most);
    const int aside = std::max(1, (wanted - 1) / 2);  // pieces on each side of the middle one
    const double piece = length / (2 * aside + 1);
    std::vector<std::vector<LimbStation>> out;
    for (const Line* line : {&first, &second}) {
        auto& cuts = out.emplace_back();
        for (int k = 0; k < aside; ++k) {
            const LimbStation& s = line->stations()[line->index((k + 0.5) * piece)];
            if (s.radius > 0.0 && (cuts.empty() || s.way > cuts.back().way)) cuts.push_back(s);
        }
    }
    return out;
}

}  // namespace imomushi
