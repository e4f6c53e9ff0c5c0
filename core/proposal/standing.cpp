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
/// Flesh of the trunk belongs to the foot beyond a cut that is this near, in radii of the section: cuts across a foot leave its heel to the trunk.
constexpr double kHeel = 2.0;

/// The cut that a piece lies in front of; `none`: it is the root's.
std::size_t inFrontOf(const BodyPiece& piece, std::size_t none) {
    for (const BodyPiece::Cap& cap : piece.caps)
        if (cap.front) return static_cast<std::size_t>(cap.cut);
    return none;
}

double lowestWithoutHeels(const BodyPiece& piece, const std::vector<char>& isFoot) {
    const Points& vertices = piece.body.vertices;
    std::vector<char> heel(static_cast<std::size_t>(vertices.rows()), 0);
    for (const BodyPiece::Cap& cap : piece.caps) {
        if (!isFoot[static_cast<std::size_t>(cap.cut)]) continue;
        Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
        for (const std::int32_t v : cap.vertices) centre += vertices.row(v) / static_cast<double>(cap.vertices.size());
        double radius = 0.0;
        for (const std::int32_t v : cap.vertices) radius = std::max(radius, (vertices.row(v) - centre).norm());
        for (Eigen::Index v = 0; v < vertices.rows(); ++v)
            if ((vertices.row(v) - centre).norm() <= kHeel * radius) heel[static_cast<std::size_t>(v)] = 1;
    }
    double lowest = HUGE_VAL;
    for (Eigen::Index v = 0; v < vertices.rows(); ++v)
        if (!heel[static_cast<std::size_t>(v)]) lowest = std::min(lowest, vertices(v, 1));
    return lowest;
}

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
    const auto pieces = cutBody(body, planes);
    if (pieces)
        for (const BodyPiece& piece : *pieces) {
            const std::size_t of = inFrontOf(piece, planes.size());
            lowest[of] = std::min(lowest[of], piece.body.vertices.col(1).minCoeff());
        }
    const auto isBetween = [&](int bone) {
        const Vec3& end = proposal.bones[static_cast<std::size_t>(bone)].end;
        return proposal.symmetry && std::abs(proposal.symmetry->normal.normalized().dot(end - proposal.symmetry->origin)) <= kBetween * diagonal;
    };
    std::vector<int> standing;
    std::vector<char> isFoot(planes.size(), 0);
    for (const int tip : tips) {
        const int piece = proposal.bones[static_cast<std::size_t>(tip)].piece;
        if (piece < 0 || lowest[static_cast<std::size_t>(piece)] > ground) continue;
        standing.push_back(tip);
        isFoot[static_cast<std::size_t>(piece)] = !isBetween(tip);
    }
    double trunk = HUGE_VAL;
    if (pieces)
        for (const BodyPiece& piece : *pieces)
            if (inFrontOf(piece, planes.size()) == planes.size()) trunk = std::min(trunk, lowestWithoutHeels(piece, isFoot));
    if (!proposal.bones.empty() && trunk > low.y() + kLying * height) {
        const bool feet = !std::all_of(standing.begin(), standing.end(), isBetween);
        for (const int tip : standing)
            if (!feet || !isBetween(tip)) proposal.pins.push_back({tip, true});
    }
    if (proposal.pins.empty()) proposal.pins = {{0, false}};
}

}  // namespace imomushi
