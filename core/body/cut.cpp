// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/finite.h"
#include "core/base/formatted.h"
#include "core/base/try.h"
#include "core/body/body_codec.h"
#include "core/body/cut_pieces.h"
#include "core/mesh/health.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

/// How far a refused plane is tried along its normal, in diagonals of the body, and in parts of the body's extent along the normal.
constexpr double kSteps[] = {1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4};
constexpr double kParts[] = {0.01, 0.05, 0.2, 0.5, 0.8, 0.95, 0.99};
constexpr int kHalvings = 4;  // of the way between the last place that failed and the first that works, until it is about the first step

CutRefusal refusalOf(Error error, int cut) {
    CutRefusal refusal;
    static_cast<Error&>(refusal) = std::move(error);
    refusal.cut = cut;
    return refusal;
}

Result<PreparedCut> withTriangles(Section section) {
    std::vector<std::vector<Eigen::Vector2d>> loops;
    for (const auto& loop : section.loops) {
        auto& flat = loops.emplace_back();
        for (const SectionPoint& point : loop) flat.push_back(section.flat(point.place));
    }
    const Attempt meshing("the triangles of a section");
    auto region = meshing ? meshRegion(loops, section.spacing) : std::nullopt;
    if (!region || region->triangles.rows() == 0)
        return fail("section-touches-itself", "The section touches or crosses itself; repair the body there, or move or turn the plane a little.");
    return PreparedCut{std::move(section), std::move(*region)};
}

Result<PreparedCut> prepare(const CutSurface& surface, const CutPlane& plane) {
    IMOMUSHI_TRY(auto section, findSection(surface, plane));
    return withTriangles(std::move(section));
}

/// Tries places of one cut among others.
class NearestPlace {
public:
    NearestPlace(const CutSurface& surface, const std::vector<TriedCut>& cuts, int cut, const Progress& progress)
        : surface_(surface), plane_(cuts[static_cast<std::size_t>(cut)].plane), progress_(progress) {
        // Cuts that are refused for themselves are left out, and of those that touch each other the later ones: one refusal is all that is said of many cuts, and it must not be theirs.
        for (std::size_t c = 0; c < cuts.size(); ++c)
            if (static_cast<int>(c) != cut && cuts[c].prepared) others_.push_back(*cuts[c].prepared);
        while (!progress.cancelled()) {
            const auto touching = findTouching(surface, others_);
            if (!touching) break;
            others_.erase(others_.begin() + std::max(touching->cut, touching->other));
        }
        others_.emplace_back();
    }

    /// How far to move the plane along its normal, m; none: not found.
    std::optional<double> offset() {
        const Vec3 n = plane_.normal.stableNormalized();
        const Eigen::VectorXd d = (surface_.mesh.vertices.rowwise() - plane_.origin.transpose()) * n;
        const double low = d.minCoeff(), high = d.maxCoeff();
        std::vector<double> offsets;
        for (const double step : kSteps)
            for (const double sign : {1.0, -1.0}) offsets.push_back(sign * step * surface_.diagonal);
        for (const double part : kParts) offsets.push_back(low + part * (high - low));
        std::erase_if(offsets, [&](double x) { return x <= low || x >= high; });
        std::stable_sort(offsets.begin(), offsets.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
        for (std::size_t i = 0; i < offsets.size(); ++i) {
            if (progress_.cancelled()) return std::nullopt;
            if (!works(offsets[i])) continue;
            double failed = std::clamp(0.0, std::min(low, offsets[i]), std::max(high, offsets[i])), worked = offsets[i];
            for (std::size_t j = 0; j < i; ++j)
                if (offsets[j] * worked > 0.0 && std::abs(offsets[j]) > std::abs(failed)) failed = offsets[j];
            for (int k = 0; k < kHalvings && std::abs(worked - failed) > 1.5 * kSteps[0] * surface_.diagonal && !progress_.cancelled(); ++k) {
                const double middle = 0.5 * (failed + worked);
                (works(middle) ? worked : failed) = middle;
            }
            return worked;
        }
        return std::nullopt;
    }

private:
    bool works(double offset) {
        CutPlane plane = plane_;
        plane.origin += offset * plane.normal.stableNormalized();
        auto section = findSection(surface_, plane);
        if (!section) return false;
        const int self = static_cast<int>(others_.size()) - 1;
        const auto about = [&](const CutRefusal& refusal) { return refusal.cut == self || refusal.other == self; };
        others_.back() = {std::move(*section), {}};
        if (const auto touching = findTouching(surface_, others_); touching && about(*touching)) return false;  // most do, and triangles take long
        auto prepared = withTriangles(std::move(others_.back().section));
        if (!prepared) return false;
        others_.back() = std::move(*prepared);
        const auto pieces = assemblePieces(surface_, others_, self);
        return pieces || !about(pieces.error());
    }

    const CutSurface& surface_;
    const CutPlane& plane_;
    const Progress& progress_;
    std::vector<PreparedCut> others_;  // the one that is tried comes last
};

/// Says in a refusal where the plane would work.
void addNearest(CutRefusal& refusal, const CutSurface& surface, const std::vector<TriedCut>& cuts, const Progress& progress) {
    if (refusal.cut < 0 || refusal.code == "bad-value") return;
    const CutPlane& plane = cuts[static_cast<std::size_t>(refusal.cut)].plane;
    const auto offset = NearestPlace(surface, cuts, refusal.cut, progress).offset();
    if (!offset) return;
    refusal.nearest = CutPlane{plane.origin + *offset * plane.normal.stableNormalized(), plane.normal};
    refusal.message += formatted(" It works %.3g m %s its normal.", std::abs(*offset), *offset > 0.0 ? "along" : "against");
}

tl::expected<std::vector<BodyPiece>, CutRefusal> cutHere(const TriangleMesh& body, const std::vector<CutPlane>& cuts, const Progress& progress) {
    return BodyCutter(body).cut(cuts, progress);
}

const Operation<tl::expected<std::vector<BodyPiece>, CutRefusal>(TriangleMesh, std::vector<CutPlane>)> kCutBody("cut-body", cutHere);

}  // namespace

struct BodyCutter::State {
    std::optional<CutSurface> surface;  ///< none: the body cannot be cut
    std::vector<TriedCut> last;         ///< the cuts that were asked for last
};

BodyCutter::BodyCutter(const TriangleMesh& body) : state_(std::make_unique<State>()) {
    if (meshFacts(body).outward) state_->surface.emplace(body);
}

BodyCutter::~BodyCutter() = default;

tl::expected<std::vector<BodyPiece>, CutRefusal> BodyCutter::cut(std::span<const CutPlane> cuts, const Progress& progress) {
    const auto refuse = [](CutRefusal refusal) { return tl::unexpected(std::move(refusal)); };
    const auto cancelled = [&] { return refuse(refusalOf({kCancelled, "Cutting was cancelled."}, -1)); };
    if (!state_->surface)
        return refuse(refusalOf({"not-closed", "The body is not a closed surface that faces outward; repair or wrap it before it is cut."}, -1));
    const CutSurface& surface = *state_->surface;
    const std::vector<TriedCut> before = std::exchange(state_->last, {});
    std::vector<TriedCut>& tried = state_->last;
    for (const CutPlane& plane : cuts) {
        if (progress.cancelled()) return cancelled();
        progress.report("cut", static_cast<double>(tried.size()) / static_cast<double>(cuts.size() + 1));
        const auto known = std::find_if(before.begin(), before.end(), [&](const TriedCut& t) { return t.plane.origin == plane.origin && t.plane.normal == plane.normal; });
        tried.push_back(known != before.end() ? *known : TriedCut{plane, prepare(surface, plane)});
    }
    std::vector<PreparedCut> sound;
    for (std::size_t c = 0; c < tried.size(); ++c) {
        if (tried[c].prepared) {
            sound.push_back(*tried[c].prepared);
            continue;
        }
        CutRefusal refusal = refusalOf(tried[c].prepared.error(), static_cast<int>(c));
        addNearest(refusal, surface, tried, progress);
        return refuse(std::move(refusal));
    }
    if (progress.cancelled()) return cancelled();
    auto pieces = assemblePieces(surface, sound);
    if (!pieces) addNearest(pieces.error(), surface, tried, progress);
    return pieces;
}

tl::expected<std::vector<BodyPiece>, CutRefusal> cutBody(const TriangleMesh& body, std::span<const CutPlane> cuts,
                                                         const Progress& progress) {
    return kCutBody(body, {cuts.begin(), cuts.end()}, progress);
}

}  // namespace imomushi
