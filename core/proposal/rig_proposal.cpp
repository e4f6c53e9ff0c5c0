// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/rig_proposal.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/base/try.h"
#include "core/mesh/winding_number.h"
#include "core/proposal/choose_planes.h"
#include "core/proposal/fit_cuts.h"
#include "core/proposal/mirror_plane.h"
#include "core/proposal/proposal_codec.h"
#include "core/proposal/standing.h"
#include "core/proposal/rig_cuts.h"
#include "core/proposal/rig_flesh.h"
#include "core/worker/worker.h"

namespace imomushi {

namespace {

constexpr double kSmallPiece = 0.25;  // of the least share: a piece that is smaller than this is not cut off
constexpr double kWithin = 0.95;      // of the way from the head of a bone to the end of its flesh: where its tip is
constexpr double kEnd = 0.9;          // of the same way: flesh beyond is its end
constexpr double kRoundShare = 0.5;   // of what is left of the progress that a round takes
constexpr std::size_t kMostRefused = 3;  // planes of a bone; then it is merged
constexpr std::size_t kMostRigPieces = 20;          // unless somebody asks for a least share
constexpr double kMoreShare = 1.2;                  // by which the least share is raised until they are few
constexpr double kTwin = 0.01;                      // of the diagonal: how near a mirrored bone is to its twin
constexpr double kStraight = 0.1;                   // a plane of a bone on the mirror plane that leans by less stands upright

class RigProposer {
public:
    RigProposer(const Rig& rig, const TriangleMesh& render, const TriangleMesh& body)
        : rig_(rig), body_(body), flesh_(rigFlesh(rig, render, body)), cuts_(rig, flesh_, body) {
        diagonal_ = (body.vertices.colwise().maxCoeff() - body.vertices.colwise().minCoeff()).norm();
    }

    Result<Proposal> propose(std::optional<double> least, const std::optional<std::vector<int>>& chosen, const Progress& progress) {
        findTwins();
        double smallest = chosen ? 0.0 : least.value_or(kLeastRigShare);
        std::vector<std::pair<int, std::string>> never;
        if (chosen)
            for (int b = 0; b < static_cast<int>(rig_.bones.size()); ++b)
                if (std::find(chosen->begin(), chosen->end(), b) == chosen->end()) never.emplace_back(b, "It was chosen to be merged.");
        merged_ = mergeRig(rig_, flesh_, smallest, never);
        if (!least && !chosen) {
            while (merged_.kept.size() > kMostRigPieces) merged_ = mergeRig(rig_, flesh_, smallest *= kMoreShare);
            if (smallest > kLeastRigShare) proposal_.notes.push_back({"merged-more", "Bones of less than " + std::to_string(static_cast<int>(std::round(100.0 * smallest))) + " % of the flesh were merged, so that few are left: a smaller least share keeps more."});
        }
        IMOMUSHI_TRY(Cutting cutting, cutLimbs(smallest, never, progress.part(0.1, 1.0)));
        merged_ = std::move(cutting.merged);
        const std::map<int, FittedCut>& fitted = cutting.fitted;
        proposal_.share = flesh_.share;
        proposal_.symmetry = mirror_;
        proposal_.from = Proposal::Source::Skeleton;
        names();
        for (std::size_t k = 1; k < merged_.kept.size(); ++k) {
            const FittedCut& cut = fitted.at(merged_.kept[k]);
            proposal_.cuts.push_back({unique(names_[k] + " cut"), unique(names_[k] + " flesh"), cut.plane});
            if (!cut.why.empty()) proposal_.notes.push_back({"moved", "The cut of \"" + names_[k] + "\": " + cut.why});
        }
        proposal_.root = unique(names_[0] + " flesh");
        bones();
        pinStanding(proposal_, tips_, body_);
        for (const MergedRig::Merge& merge : merged_.merges)
            proposal_.merged.push_back({rig_.bones[static_cast<std::size_t>(merge.bone)].name, names_[static_cast<std::size_t>(merged_.mover[static_cast<std::size_t>(merge.bone)])], merge.share, merge.why});
        if (!flesh_.skinned) proposal_.notes.push_back({"no-skin", "The file binds no skin to its bones: flesh follows the nearest one."});
        return std::move(proposal_);
    }

private:
    /// Bones that are kept, and their cuts.
    struct Cutting {
        MergedRig merged;
        std::map<int, FittedCut> fitted;  ///< by the bone of the rig
    };

    Result<Cutting> cutLimbs(double smallest, std::vector<std::pair<int, std::string>> never, const Progress& progress) const {
        const CutSurface surface(body_);
        const double least = kSmallPiece * smallest;
        std::map<int, std::vector<CutPlane>> refused;  // by bone: planes that cutBody() refused
        // Each round merges a bone that no cut works for, so that those of others may change.
        for (int round = 0;; ++round) {
            const Progress part = progress.part(1.0 - std::pow(kRoundShare, round), 1.0 - std::pow(kRoundShare, round + 1));
            Cutting made{mergeRig(rig_, flesh_, smallest, never), {}};
            std::vector<RigCuts::Wish> wishes(made.merged.kept.size());
            std::vector<std::size_t> order;  // kept bones, the more important ones first
            for (std::size_t k = 1; k < wishes.size(); ++k) {
                wishes[k] = cuts_.wish(made.merged, k, mirror_);
                order.push_back(k);
            }
            const std::vector<int> twin = keptTwins(made.merged);
            for (std::size_t k = 1; k < wishes.size(); ++k) mirrorWish(made.merged, k, twin[k], wishes);
            std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return wishes[a].importance > wishes[b].importance; });
            std::vector<int> place(made.merged.kept.size(), -1);
            for (std::size_t c = 0; c < order.size(); ++c) place[order[c]] = static_cast<int>(c);
            std::vector<PlaneWish> choices;
            for (const std::size_t k : order) {
                PlaneWish choice;
                const std::vector<CutPlane>& bad = refused[made.merged.kept[k]];
                const auto offered = [&](std::vector<CutPlane> planes) {
                    std::erase_if(planes, [&](const CutPlane& p) { return std::any_of(bad.begin(), bad.end(), [&](const CutPlane& b) { return b.origin == p.origin && b.normal == p.normal; }); });
                    return planes;
                };
                choice.planes = offered(std::move(wishes[k].planes));
                choice.more = offered(std::move(wishes[k].more));
                choice.own = std::move(wishes[k].own);
                choice.parent = made.merged.parent[k] > 0 ? place[static_cast<std::size_t>(made.merged.parent[k])] : -1;
                if (twin[k] > 0) choice.twin = place[static_cast<std::size_t>(twin[k])];
                choices.push_back(std::move(choice));
            }
            const auto planes = choosePlanes(surface, flesh_.volume, choices, mirror_, least, part.part(0.0, 0.7));
            if (progress.cancelled()) return fail(kCancelled, "The proposal was cancelled.");  // else bones without a plane would be merged
            const std::size_t before = never.size();
            std::vector<WishedCut> wished;
            std::vector<int> index(order.size(), -1);  // into `wished`
            std::vector<int> bones;
            for (std::size_t c = 0; c < order.size(); ++c) {
                if (!planes[c]) {
                    never.emplace_back(made.merged.kept[order[c]], "No cut works there that goes together with the others.");
                    continue;
                }
                index[c] = static_cast<int>(wished.size());
                bones.push_back(made.merged.kept[order[c]]);
                WishedCut& wish = wished.emplace_back();
                wish.plane = *planes[c];
                wish.reach = wishes[order[c]].reach;
            }
            for (std::size_t c = 0; c < order.size(); ++c)
                if (index[c] >= 0 && choices[c].twin >= 0) wished[static_cast<std::size_t>(index[c])].twin = index[static_cast<std::size_t>(choices[c].twin)];
            IMOMUSHI_TRY(const auto tried, fitCuts(body_, wished, mirror_, least, part.part(0.7, 1.0)));
            bool all = never.size() == before;
            for (std::size_t w = 0; w < tried.size(); ++w) {
                if (tried[w].kept) {
                    made.fitted.emplace(bones[w], tried[w]);
                    continue;
                }
                all = false;
                std::vector<CutPlane>& bad = refused[bones[w]];
                bad.push_back(wished[w].plane);
                if (bad.size() > kMostRefused) never.emplace_back(bones[w], "No cut works there: " + tried[w].why);
            }
            if (all) return made;
        }
    }

    /// Bones that mirror each other move equal shares of flesh.
    void findTwins() {
        twins_.assign(rig_.bones.size(), -1);
        const Vec3 middle = 0.5 * (body_.vertices.colwise().maxCoeff() + body_.vertices.colwise().minCoeff()).transpose();
        TriangleMesh scaled = body_;
        scaled.vertices = (body_.vertices.rowwise() - middle.transpose()) / diagonal_;
        const auto plane = findMirrorPlane(scaled);
        if (!plane) return;
        const CutPlane mirror{middle + diagonal_ * plane->origin, plane->normal};
        bool any = false;
        for (std::size_t b = 0; b < twins_.size(); ++b) {
            const Vec3 head = mirroredPoint(mirror, rig_.bones[b].head), tail = mirroredPoint(mirror, rig_.bones[b].tail);
            double nearest = kTwin * diagonal_;
            for (std::size_t other = 0; other < twins_.size(); ++other) {
                const double away = std::max((rig_.bones[other].head - head).norm(), (rig_.bones[other].tail - tail).norm());
                if (away > nearest || (away == nearest && twins_[b] >= 0)) continue;
                nearest = away;
                twins_[b] = static_cast<int>(other);
            }
        }
        for (std::size_t b = 0; b < twins_.size(); ++b)
            if (twins_[b] >= 0 && twins_[static_cast<std::size_t>(twins_[b])] != static_cast<int>(b)) twins_[b] = -1;
        std::vector<double> share = flesh_.share;
        for (std::size_t b = 0; b < twins_.size(); ++b) {
            if (twins_[b] < 0 || twins_[b] == static_cast<int>(b)) continue;
            share[b] = 0.5 * (flesh_.share[b] + flesh_.share[static_cast<std::size_t>(twins_[b])]);
            any = true;
        }
        if (!any) return;
        flesh_.share = share;
        mirror_ = mirror;
    }

    /// Per kept bone its twin, 0: none.
    [[nodiscard]] std::vector<int> keptTwins(const MergedRig& merged) const {
        std::vector<int> twin(merged.kept.size(), 0);
        for (std::size_t k = 1; mirror_ && k < twin.size(); ++k) {
            const int other = twins_[static_cast<std::size_t>(merged.kept[k])];
            const auto found = std::find(merged.kept.begin() + 1, merged.kept.end(), other);
            if (other >= 0 && found != merged.kept.end()) twin[k] = static_cast<int>(found - merged.kept.begin());
        }
        for (std::size_t k = 1; k < twin.size(); ++k)
            if (twin[k] == static_cast<int>(k)) twin[k] = 0;
        return twin;
    }

    /// The later of two twins gets the planes of the other one; those of a bone on the mirror plane stand upright on it.
    void mirrorWish(const MergedRig& merged, std::size_t k, int twin, std::vector<RigCuts::Wish>& wishes) const {
        if (twin > 0 && twin < static_cast<int>(k)) {
            const RigCuts::Wish& other = wishes[static_cast<std::size_t>(twin)];
            wishes[k].planes = other.planes;
            wishes[k].more = other.more;
            wishes[k].reach = other.reach;
            wishes[k].importance = other.importance;
            for (auto* planes : {&wishes[k].planes, &wishes[k].more})
                for (CutPlane& plane : *planes) plane = {mirroredPoint(*mirror_, plane.origin), mirroredDirection(*mirror_, plane.normal)};
        } else if (mirror_ && twins_[static_cast<std::size_t>(merged.kept[k])] == merged.kept[k]) {
            const auto upright = [&](CutPlane& plane) {
                const double lean = mirror_->normal.dot(plane.normal);
                if (std::abs(lean) > kStraight) return false;
                plane.normal = (plane.normal - lean * mirror_->normal).normalized();
                plane.origin = ontoPlane(*mirror_, plane.origin);
                return true;
            };
            for (CutPlane& plane : wishes[k].planes) upright(plane);
            std::erase_if(wishes[k].more, [&](CutPlane& plane) { return !upright(plane); });
        }
    }

    /// A name of the document: without "/", which separates names there.
    static std::string plain(std::string name) {
        std::replace(name.begin(), name.end(), '/', '-');
        return name;
    }

    std::string unique(const std::string& name) {
        if (taken_.insert(name).second) return name;
        for (int i = 2;; ++i)
            if (std::string other = name + " " + std::to_string(i); taken_.insert(other).second) return other;
    }

    void names() {
        for (const int b : merged_.kept) names_.push_back(unique(plain(rig_.bones[static_cast<std::size_t>(b)].name)));
    }

    [[nodiscard]] const Vec3& headOf(std::size_t kept) const { return rig_.bones[static_cast<std::size_t>(merged_.kept[kept])].head; }

    /// Where a bone ends that nothing hangs on: within its flesh, straight on; where that is beside its flesh or behind its cut, in the middle of the end of what lies in front of the cut.
    [[nodiscard]] Vec3 tipOf(std::size_t kept) const {
        const Vec3 &head = headOf(kept), along = cuts_.direction(merged_, kept);
        const auto inFront = [&](const Vec3& place) { return kept == 0 || proposal_.cuts[kept - 1].plane.normal.dot(place - proposal_.cuts[kept - 1].plane.origin) > 0.0; };
        const auto isIn = [&](const Vec3& place) { return inFront(place) && windingNumber(body_, place) > 0.5; };
        std::vector<Vec3> own;
        for (std::size_t v = 0; v + 1 < flesh_.first.size(); ++v) {
            double weight = 0.0;
            for (auto i = static_cast<std::size_t>(flesh_.first[v]); i < static_cast<std::size_t>(flesh_.first[v + 1]); ++i)
                if (merged_.mover[static_cast<std::size_t>(flesh_.bone[i])] == static_cast<int>(kept)) weight += flesh_.weight[i];
            if (weight > 0.5) own.emplace_back(body_.vertices.row(static_cast<Eigen::Index>(v)));
        }
        const auto reach = [&](const Vec3& out) {
            double most = 0.0;
            for (const Vec3& place : own) most = std::max(most, out.dot(place - head));
            return most;
        };
        const auto mean = [&] { return Vec3(std::accumulate(own.begin(), own.end(), Vec3(Vec3::Zero())) / static_cast<double>(own.size())); };
        const Vec3 straight = head + std::max(kWithin * reach(along), 0.01 * diagonal_) * along;
        if (isIn(straight)) return straight;
        std::erase_if(own, [&](const Vec3& place) { return !inFront(place); });
        if (own.empty()) return straight;
        const Vec3 out = (mean() - head).stableNormalized();
        const double far = reach(out);
        std::erase_if(own, [&](const Vec3& place) { return out.dot(place - head) < kEnd * far; });
        if (own.empty()) return straight;
        Vec3 end = mean();
        end += (kWithin * far - out.dot(end - head)) * out;  // not in the last face of it
        return isIn(end) ? end : straight;
    }

    int add(std::string name, int parent, bool fromParentStart, const Vec3& start, const Vec3& end, std::size_t kept) {
        proposal_.bones.push_back({std::move(name), parent, start, end, fromParentStart, static_cast<int>(kept) - 1, -1, -1, merged_.kept[kept]});
        return static_cast<int>(proposal_.bones.size()) - 1;
    }

    /// A bone from the head of each kept one to the head of the child that goes on straightest, and others from there to the heads of its other children. In the plane of
    /// symmetry it goes on in that plane if any child does: which of two twins would be straighter is rounding.
    void bones() {
        const std::size_t count = merged_.kept.size();
        std::vector<int> arrives(count, -1);        // the bone that ends at a head,
        std::vector<char> fromStart(count, 0);      // or starts there
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 head = headOf(k), along = cuts_.direction(merged_, k);
            std::vector<std::size_t> children;
            std::size_t next = count;
            double straightest = -2.0;
            const auto inPlane = [&](std::size_t of) { return mirror_ && std::abs(mirror_->normal.dot(headOf(of) - mirror_->origin)) <= kTwin * diagonal_; };
            bool central = false;
            for (std::size_t c = k + 1; c < count; ++c) {
                if (merged_.parent[c] != static_cast<int>(k)) continue;
                children.push_back(c);
                const Vec3 to = headOf(c) - head;
                if (to.norm() <= kSame * diagonal_) continue;
                const double straight = along.dot(to.normalized());
                const bool better = inPlane(k) && inPlane(c) != central ? inPlane(c) : straight > straightest;
                if (!better) continue;
                straightest = straight;
                central = inPlane(c);
                next = c;
            }
            // A head that no other leads to has a tip.
            const int own = add(names_[k], arrives[k], fromStart[k] != 0, head, next < count ? headOf(next) : tipOf(k), k);
            if (next == count) tips_.push_back(own);
            // Heads at one place, such as those of two arms in the middle of a chest, hang on one bone: a second one would close a loop.
            std::vector<int> made{own};
            for (const std::size_t c : children) {
                const auto there = std::find_if(made.begin(), made.end(), [&](int m) { return (headOf(c) - proposal_.bones[static_cast<std::size_t>(m)].end).norm() <= kSame * diagonal_; });
                if (c == next) {
                    arrives[c] = own;
                } else if ((headOf(c) - head).norm() <= kSame * diagonal_) {
                    arrives[c] = own;
                    fromStart[c] = 1;
                } else if (there != made.end()) {
                    arrives[c] = *there;
                } else {
                    arrives[c] = add(unique(names_[k] + " to " + names_[c]), own, true, head, headOf(c), k);
                    made.push_back(arrives[c]);
                }
            }
        }
        // Ends and starts are the same bit for bit, also where heads differ by rounding.
        for (ProposedBone& bone : proposal_.bones)
            if (bone.parent >= 0) {
                const ProposedBone& parent = proposal_.bones[static_cast<std::size_t>(bone.parent)];
                bone.start = bone.fromParentStart ? parent.start : parent.end;
            }
    }

    static constexpr double kSame = 1e-6;  // of the diagonal: heads nearer than this are one

    const Rig& rig_;
    const TriangleMesh& body_;
    RigFlesh flesh_;
    RigCuts cuts_;
    MergedRig merged_;
    Proposal proposal_;
    std::vector<std::string> names_;  // per kept bone
    std::set<std::string> taken_;
    std::vector<int> tips_;
    std::optional<CutPlane> mirror_;  // of body and rig
    std::vector<int> twins_;          // per bone of the rig its mirror image, itself on the plane; -1: none
    double diagonal_ = 0.0;
};

Result<Proposal> proposeFromRigHere(const Rig& rig, const TriangleMesh& render, const TriangleMesh& body,
                                    const std::optional<double>& least, const std::optional<std::vector<int>>& chosen,
                                    const Progress& progress) {
    auto proposal = RigProposer(rig, render, body).propose(least, chosen, progress);
    if (proposal) noteLeftOut(*proposal);
    return proposal;
}

const Operation<Result<Proposal>(Rig, TriangleMesh, TriangleMesh, std::optional<double>, std::optional<std::vector<int>>)> kProposeFromRig(
    "propose-from-rig", proposeFromRigHere);

}  // namespace

Result<Proposal> proposeFromRig(const Rig& rig, const TriangleMesh& render, const TriangleMesh& body, std::optional<double> least, const Progress& progress,
                                const std::optional<std::vector<int>>& chosen) {
    return kProposeFromRig(rig, render, body, least, chosen, progress);
}

}  // namespace imomushi
