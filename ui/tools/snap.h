// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "ui/tools/tool.h"

namespace imomushi {

/// Where what is dragged goes to: the grid, vertices, edges, the surface or the middle of bodies, ends of bones; angles and factors in steps. One for all drags. It places and never
/// joins. What was reached is left only when something else is clearly nearer; with Shift steps are a tenth.
class Snap {
public:
    struct Place {
        enum class Kind { Grid, Vertex, Edge, Surface, Middle, End } kind = Kind::Grid;
        Vec3 at = Vec3::Zero();  ///< m, world
        PartId of = 0;           ///< element; character, of whose render mesh the vertex or edge is; bone
        int index = -1;          ///< of the vertex, or of one of an edge; 1: the end of the bone, 0: its start
        int to = -1;             ///< of an edge, its other vertex: the larger one
        [[nodiscard]] bool sameAs(const Place& other) const { return kind == other.kind && of == other.of && index == other.index && to == other.to; }
    };
    /// What moves together with what is dragged: no place to go to. Empty: nothing.
    struct Moving {
        std::function<bool(const EndpointRef&)> end;
        std::function<bool(PartId)> element;
    };

    explicit Snap(const StudioDocument& document) : document_(document) {}
    void set(const SnapSettings& settings) { settings_ = settings; }
    [[nodiscard]] const SnapSettings& settings() const { return settings_; }
    /// A drag begins.
    void begin(Moving moving = {});
    /// It snaps now: the magnet, or Ctrl without it.
    [[nodiscard]] bool acts(const PointerEvent& e) const { return settings_.on != bool(e.modifiers & Qt::ControlModifier); }
    /// Where a point goes that would be at `free`, m, world. atPointer: what is under the pointer is meant, not what is at `free` (it is confined to an axis).
    Vec3 point(const PointerEvent& e, const Vec3& free, bool atPointer = false);
    /// Radians, from where the drag began.
    double angle(const PointerEvent& e, double free);
    /// In steps of a tenth.
    double factor(const PointerEvent& e, double free);
    /// A length in steps of the grid, m; pixel: metres that one covers there.
    double length(const PointerEvent& e, double free, double pixel);
    /// Nothing is snapped any more.
    void clear() { place_.reset(); }
    [[nodiscard]] const std::optional<Place>& place() const { return place_; }
    /// What it goes to now, translated; empty: nothing.
    [[nodiscard]] QString text() const;
    /// The hint of a tool with that before it.
    [[nodiscard]] QString before(const QString& hint) const;
    void decorate(render::Scene& scene) const;

private:
    [[nodiscard]] double step(const PointerEvent& e, double pixel) const;
    [[nodiscard]] std::optional<Place> find(const PointerEvent& e) const;
    double rounded(double free, double step);

    const StudioDocument& document_;
    SnapSettings settings_;
    Moving moving_;
    std::optional<Place> place_;
    std::optional<double> held_;  ///< an angle, factor or length
};

}  // namespace imomushi
