// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/fit_cuts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/proposal/mirror_plane.h"
#include "core/mesh/health.h"

namespace imomushi {
namespace {

/// Steps outward where it is not known how far.
constexpr double kSteps = 2.0;
/// A moved plane goes a little beyond the first place that works, in parts of the way, so that its twin works there, too.
constexpr double kBeyond = 0.1;

class Fitter {
public:
    Fitter(const TriangleMesh& body, std::span<const WishedCut> wished, const std::optional<CutPlane>& mirror, double least, const Progress& progress)
        : body_(body), cutter_(body), wished_(wished), mirror_(mirror), least_(least), progress_(progress), fitted_(wished.size()), moves_(wished.size(), 0) {
        for (std::size_t c = 0; c < wished.size(); ++c) {
            fitted_[c].plane = wished[c].plane;
            if (fitted_[c].plane.normal.allFinite() && fitted_[c].plane.normal.norm() > 0.0) fitted_[c].plane.normal.stableNormalize();
        }
    }

    Result<std::vector<FittedCut>> fit() {
        // Every round moves or leaves out a cut, and none is moved often.
        while (true) {
            std::vector<std::size_t> which;
            std::vector<CutPlane> planes;
            for (std::size_t c = 0; c < fitted_.size(); ++c)
                if (fitted_[c].kept) which.push_back(c), planes.push_back(fitted_[c].plane);
            const auto pieces = cutter_.cut(planes, progress_);
            if (pieces) {
                if (!leaveStrayOut(*pieces, which) && !leaveSmallOut(*pieces, which)) return std::move(fitted_);
                continue;
            }
            const CutRefusal& refusal = pieces.error();
            if (refusal.cut < 0) return tl::unexpected<Error>(refusal);
            std::size_t at = which[static_cast<std::size_t>(refusal.cut)];
            std::optional<CutPlane> nearest = refusal.nearest;
            if (refusal.other >= 0 && which[static_cast<std::size_t>(refusal.other)] > at && !isTwin(at, which[static_cast<std::size_t>(refusal.other)])) {
                at = which[static_cast<std::size_t>(refusal.other)];
                nearest.reset();  // was of the one that stays
            }
            // Where it works is known of the cut that stays only; the other one goes outward.
            const bool outward = !nearest && refusal.other >= 0;
            const double by = nearest ? (1.0 + kBeyond) * fitted_[at].plane.normal.dot(nearest->origin - fitted_[at].plane.origin) : wished_[at].reach / kSteps;
            const auto moved = [&](std::size_t c, double way) {
                if (std::abs(fitted_[c].moved + way) > wished_[c].reach || moves_[c] >= wished_[c].moves) return false;
                move(c, way);
                fitted_[c].code = refusal.code;
                fitted_[c].why = "It was moved along the limb: " + refusal.message;
                return true;
            };
            if (!(nearest || outward) || !moved(at, by)) {
                fitted_[at].kept = false;
                fitted_[at].code = refusal.code;
                fitted_[at].why = refusal.message;
            }
            mirror(at);
        }
    }

private:
    [[nodiscard]] bool isTwin(std::size_t a, std::size_t b) const { return wished_[a].twin == static_cast<int>(b); }

    void move(std::size_t c, double by) {
        ++moves_[c];
        fitted_[c].moved += by;
        fitted_[c].plane.origin += by * fitted_[c].plane.normal;
    }

    /// Does to the twin what was done to a cut.
    void mirror(std::size_t c) {
        if (wished_[c].twin < 0 || !mirror_) return;
        const auto t = static_cast<std::size_t>(wished_[c].twin);
        const double share = fitted_[t].share;
        fitted_[t] = fitted_[c];
        fitted_[t].share = share;
        moves_[t] = moves_[c];
        fitted_[t].plane = {mirroredPoint(*mirror_, fitted_[c].plane.origin), mirroredDirection(*mirror_, fitted_[c].plane.normal)};
    }

    /// Leaves out a cut beyond which its tip does not lie. False: there is none.
    bool leaveStrayOut(const std::vector<BodyPiece>& pieces, const std::vector<std::size_t>& which) {
        // Of each piece: where a vertex of the body went, and the cut that leads towards the root.
        std::vector<std::int32_t> pieceOf(static_cast<std::size_t>(body_.vertices.rows()), -1);
        std::vector<int> inward(pieces.size(), -1), behind(which.size(), -1);
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            for (const std::int32_t v : pieces[p].source)
                if (v >= 0) pieceOf[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(p);
            for (const BodyPiece::Cap& cap : pieces[p].caps) (cap.front ? inward[p] : behind[static_cast<std::size_t>(cap.cut)]) = cap.front ? cap.cut : static_cast<int>(p);
        }
        for (std::size_t i = 0; i < which.size(); ++i) {
            const std::size_t c = which[i];
            if (!wished_[c].tip) continue;
            int piece = pieceOf[static_cast<std::size_t>(tipVertex(c))];
            bool beyond = false;
            for (std::size_t steps = 0; piece >= 0 && inward[static_cast<std::size_t>(piece)] >= 0 && steps < pieces.size() && !beyond; ++steps) {
                const int cut = inward[static_cast<std::size_t>(piece)];
                beyond = cut == static_cast<int>(i);
                piece = behind[static_cast<std::size_t>(cut)];
            }
            if (beyond) continue;
            fitted_[c].kept = false;
            fitted_[c].code = "other-limb";
            fitted_[c].why = "It would cut off something else than its limb: cut there by hand.";
            mirror(c);
            return true;
        }
        return false;
    }

    /// The vertex nearest to the tip of a cut.
    Eigen::Index tipVertex(std::size_t c) {
        if (tipVertex_.empty()) tipVertex_.assign(wished_.size(), -1);
        Eigen::Index& known = tipVertex_[c];
        if (known < 0) (body_.vertices.rowwise() - wished_[c].tip->transpose()).rowwise().squaredNorm().minCoeff(&known);
        return known;
    }

    /// False: no piece is too small.
    bool leaveSmallOut(const std::vector<BodyPiece>& pieces, const std::vector<std::size_t>& which) {
        double whole = 0.0;
        std::vector<double> volumes;
        for (const BodyPiece& piece : pieces) volumes.push_back(meshFacts(piece.body).volume), whole += volumes.back();
        std::size_t smallest = fitted_.size();
        for (std::size_t p = 0; p < pieces.size(); ++p)
            for (const BodyPiece::Cap& cap : pieces[p].caps) {
                if (!cap.front) continue;
                FittedCut& cut = fitted_[which[static_cast<std::size_t>(cap.cut)]];
                cut.share = whole > 0.0 ? volumes[p] / whole : 0.0;
                if (cut.share < least_ && (smallest == fitted_.size() || cut.share < fitted_[smallest].share)) smallest = which[static_cast<std::size_t>(cap.cut)];
            }
        if (smallest == fitted_.size()) return false;
        fitted_[smallest].kept = false;
        fitted_[smallest].code = "small";
        fitted_[smallest].why = "The piece in front of it has less flesh than the least share.";
        mirror(smallest);
        return true;
    }

    const TriangleMesh& body_;
    BodyCutter cutter_;
    std::span<const WishedCut> wished_;
    const std::optional<CutPlane>& mirror_;
    double least_;
    const Progress& progress_;
    std::vector<FittedCut> fitted_;
    std::vector<int> moves_;
    std::vector<Eigen::Index> tipVertex_;  // -1: not known yet
};

}  // namespace

Result<std::vector<FittedCut>> fitCuts(const TriangleMesh& body, std::span<const WishedCut> cuts, const std::optional<CutPlane>& mirror, double least, const Progress& progress) {
    return Fitter(body, cuts, mirror, least, progress).fit();
}

}  // namespace imomushi
