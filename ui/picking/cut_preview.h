// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/body/section.h"
#include "core/joints/joint_face.h"
#include "core/session/session.h"

namespace imomushi {

/// The sections of one body, for previews of cuts. Keeps what all sections need.
class SectionFinder {
public:
    /// `owner`: whoever has `body`, which stays as it is.
    SectionFinder(std::shared_ptr<const void> owner, const TriangleMesh& body) : owner_(std::move(owner)), surface_(body), middle_(body.vertices.colwise().mean().transpose()) {}

    struct Outline {
        std::vector<std::vector<SectionPoint>> loops;  ///< outer one first
        Vec3 centre = Vec3::Zero();                    ///< of the outer loop, m, at rest
        double length = 0.0;                           ///< of the outer loop, m
    };
    /// Errors: those of findSection().
    [[nodiscard]] Result<Outline> at(const CutPlane& plane) const;
    /// A plane that cuts.
    struct Across {
        CutPlane plane;
        Outline outline;  ///< of its section
    };
    /// The plane through a point of the surface and its normal there that crosses the flesh on the shortest way round, which is across a limb. Its front is away from the
    /// middle of the body. `triangle`: in which the point lies, which is quicker; -1: it is not known. None: no plane there cuts.
    [[nodiscard]] std::optional<Across> across(const Vec3& point, const Vec3& normal, std::int32_t triangle = -1) const;
    /// The loops of an outline, where `place(vertex)` says where vertices of the body are.
    template <class Place>
    [[nodiscard]] std::vector<std::vector<Vec3>> placed(const Outline& outline, const Place& place) const {
        std::vector<std::vector<Vec3>> loops;
        for (const auto& loop : outline.loops) {
            std::vector<Vec3>& to = loops.emplace_back();
            for (const SectionPoint& p : loop) {
                if (p.vertex >= 0) {
                    to.push_back(place(p.vertex));
                } else {
                    const auto [low, high] = ends(p.edge);
                    to.push_back((1.0 - p.along) * place(low) + p.along * place(high));
                }
            }
        }
        return loops;
    }
    [[nodiscard]] const TriangleMesh& body() const { return surface_.mesh; }
    [[nodiscard]] const EdgeTable& edges() const { return surface_.edges; }
    [[nodiscard]] double diagonal() const { return surface_.diagonal; }
    /// The patch ends in edges, as a flat side of a box does, and not somewhere on a round surface.
    [[nodiscard]] bool isFacet(const JointFace& patch) const;

private:
    /// m, all the way round over the surface from a triangle back to it. None: the plane does not cross it, or the way is longer than `most`.
    [[nodiscard]] std::optional<double> lengthAround(std::int32_t triangle, const CutPlane& plane, double most) const;
    [[nodiscard]] std::pair<std::int32_t, std::int32_t> ends(std::int32_t edge) const;
    std::shared_ptr<const void> owner_;
    CutSurface surface_;
    Vec3 middle_;  ///< of all vertices, m
};

/// The nearest plane to `plane` that cuts an element where `plane` does not; none: none was found, or the body is not why it was refused.
/// `moved`: the cut that gets the plane, 0: a new one.
std::optional<CutPlane> nearestCut(const Document& document, PartId element, PartId moved, const CutPlane& plane);

}  // namespace imomushi
