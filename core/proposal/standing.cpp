// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/standing.h"

#include <algorithm>
#include <cmath>

#include "core/body/cut.h"

namespace imomushi {
namespace {

/// Flesh stands where its lowest point is at most this far above that of the body: of the height, or of the diagonal. A trunk lies at less, of the height.
constexpr double kStanding = 0.05, kStandingOfDiagonal = 0.015, kLying = 0.015;
/// A bone is in the plane of symmetry where its end is this near to it, in diagonals.
constexpr double kBetween = 0.01;

}  // namespace

void pinStanding(Proposal& proposal, const std::vector<int>& tips, const TriangleMesh& body) {
    proposal.pins = {};
    const Eigen::RowVector3d low = body.vertices.colwise().minCoeff(), high = body.vertices.colwise().maxCoeff();
    const double height = high.y() - low.y(), diagonal = (high - low).norm();
    const double ground = low.y() + std::max(kStanding * height, kStandingOfDiagonal * diagonal);
    // Per cut the lowest place of the piece in front of it; last, that of the root's piece.
    std::vector<CutPlane> planes;
    for (const ProposedCut& cut : proposal.cuts) planes.push_back(cut.plane);
    std::vector<double> lowest(planes.size() + 1, HUGE_VAL);
    if (const auto pieces = cutBody(body, planes))
        for (const BodyPiece& piece : *pieces) {
            std::size_t of = planes.size();
            for (const BodyPiece::Cap& cap : piece.caps)
                if (cap.front) of = static_cast<std::size_t>(cap.cut);
            lowest[of] = std::min(lowest[of], piece.body.vertices.col(1).minCoeff());
        }
    if (!proposal.bones.empty() && lowest.back() > low.y() + kLying * height) {
        const auto isBetween = [&](int bone) {
            const Vec3& end = proposal.bones[static_cast<std::size_t>(bone)].end;
            return proposal.symmetry &&
                   std::abs(proposal.symmetry->normal.normalized().dot(end - proposal.symmetry->origin)) <= kBetween * diagonal;
        };
        std::vector<int> standing;
        for (const int tip : tips) {
            const int piece = proposal.bones[static_cast<std::size_t>(tip)].piece;
            if (piece >= 0 && lowest[static_cast<std::size_t>(piece)] <= ground) standing.push_back(tip);
        }
        const bool feet = !std::all_of(standing.begin(), standing.end(), isBetween);
        for (const int tip : standing)
            if (!feet || !isBetween(tip)) proposal.pins.push_back({tip, true});
    }
    if (proposal.pins.empty()) proposal.pins = {{0, false}};
}

}  // namespace imomushi
