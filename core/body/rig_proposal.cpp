// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/rig_proposal.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "core/body/rig_cuts.h"
#include "core/body/rig_flesh.h"

namespace imomushi {

namespace {

constexpr double kSmallPiece = 0.25;  // of the least share: a piece that is smaller than this is not cut off
constexpr double kWithin = 0.95;      // of the way from the head of a bone to the end of its flesh: where its tip is
constexpr double kStandsWithin = 0.03;      // of the height of a body: tips that are lower stand on the ground
constexpr int kMostRounds = 8;

class RigProposer {
public:
    RigProposer(const Rig& rig, const TriangleMesh& render, const TriangleMesh& body, double least)
        : rig_(rig), body_(body), least_(least), flesh_(rigFlesh(rig, render, body)), cuts_(rig, flesh_, body) {
        diagonal_ = (body.vertices.colwise().maxCoeff() - body.vertices.colwise().minCoeff()).norm();
    }

    Result<Proposal> propose(const Progress& progress) {
        std::vector<std::pair<int, std::string>> never;
        std::map<int, FittedCut> fitted;  // by the bone of the rig
        // Each round merges the bones that no cut works for, so that the planes of others may change.
        for (int round = 0; round < kMostRounds; ++round) {
            merged_ = mergeRig(rig_, flesh_, least_, never);
            progress.report("skeleton", 0.2 + 0.8 * round / kMostRounds);
            const std::vector<WishedCut> wished = cuts_.cuts(merged_);
            const auto tried = fitCuts(body_, std::span(wished).subspan(1), std::nullopt, kSmallPiece * least_, progress);
            if (!tried) return tl::unexpected(tried.error());
            fitted.clear();
            for (std::size_t c = 0; c < tried->size(); ++c) {
                const FittedCut& cut = (*tried)[c];
                if (cut.kept)
                    fitted.emplace(merged_.kept[c + 1], cut);
                else
                    never.emplace_back(merged_.kept[c + 1], "No cut works there: " + cut.why);
            }
            if (fitted.size() == tried->size()) break;
        }
        merged_ = mergeRig(rig_, flesh_, least_, never);
        proposal_.from = Proposal::Source::Skeleton;
        names();
        for (std::size_t k = 1; k < merged_.kept.size(); ++k) {
            const FittedCut& cut = fitted.at(merged_.kept[k]);
            proposal_.cuts.push_back({unique(names_[k] + " cut"), unique(names_[k] + " flesh"), cut.plane});
            if (!cut.why.empty()) proposal_.notes.push_back({"moved", "The cut of \"" + names_[k] + "\": " + cut.why});
        }
        proposal_.root = unique(names_[0] + " flesh");
        bones();
        pins();
        for (const MergedRig::Merge& merge : merged_.merges)
            proposal_.merged.push_back({rig_.bones[static_cast<std::size_t>(merge.bone)].name, names_[static_cast<std::size_t>(merged_.mover[static_cast<std::size_t>(merge.bone)])], merge.share, merge.why});
        if (!flesh_.skinned) proposal_.notes.push_back({"no-skin", "The file binds no skin to its bones: flesh follows the nearest one."});
        return std::move(proposal_);
    }

private:
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

    /// Where a bone ends that nothing hangs on: within its flesh.
    [[nodiscard]] Vec3 tipOf(std::size_t kept) const {
        const Vec3 &head = headOf(kept), along = cuts_.direction(merged_, kept);
        double reach = 0.0;
        for (std::size_t v = 0; v + 1 < flesh_.first.size(); ++v) {
            double own = 0.0;
            for (auto i = static_cast<std::size_t>(flesh_.first[v]); i < static_cast<std::size_t>(flesh_.first[v + 1]); ++i)
                if (merged_.mover[static_cast<std::size_t>(flesh_.bone[i])] == static_cast<int>(kept)) own += flesh_.weight[i];
            if (own > 0.5) reach = std::max(reach, along.dot(Vec3(body_.vertices.row(static_cast<Eigen::Index>(v)).transpose()) - head));
        }
        return head + std::max(kWithin * reach, 0.01 * diagonal_) * along;
    }

    int add(std::string name, int parent, bool fromParentStart, const Vec3& start, const Vec3& end, std::size_t kept) {
        proposal_.bones.push_back({std::move(name), parent, start, end, fromParentStart, static_cast<int>(kept) - 1, -1, -1, merged_.kept[kept]});
        return static_cast<int>(proposal_.bones.size()) - 1;
    }

    /// A bone from the head of each kept one to the head of the child that goes on straightest, and others from there to the heads of its other children.
    void bones() {
        const std::size_t count = merged_.kept.size();
        std::vector<int> arrives(count, -1);        // the bone that ends at a head,
        std::vector<char> fromStart(count, 0);      // or starts there
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 head = headOf(k), along = cuts_.direction(merged_, k);
            std::vector<std::size_t> children;
            std::size_t next = count;
            double straightest = -2.0;
            for (std::size_t c = k + 1; c < count; ++c) {
                if (merged_.parent[c] != static_cast<int>(k)) continue;
                children.push_back(c);
                const Vec3 to = headOf(c) - head;
                if (to.norm() <= kSame * diagonal_) continue;
                if (const double straight = along.dot(to.normalized()); straight > straightest) {
                    straightest = straight;
                    next = c;
                }
            }
            // A head that no other leads to has a tip.
            const int own = add(names_[k], arrives[k], fromStart[k] != 0, head, next < count ? headOf(next) : tipOf(k), k);
            if (next == count) tips_.push_back(own);
            for (const std::size_t c : children) {
                if (c == next) {
                    arrives[c] = own;
                } else if ((headOf(c) - head).norm() <= kSame * diagonal_) {
                    arrives[c] = own;
                    fromStart[c] = 1;
                } else {
                    arrives[c] = add(unique(names_[k] + " to " + names_[c]), own, true, head, headOf(c), k);
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

    /// Tips that stand on the ground, else the root.
    void pins() {
        const double low = body_.vertices.col(1).minCoeff(), ground = low + kStandsWithin * (body_.vertices.col(1).maxCoeff() - low);
        for (const int tip : tips_)
            if (proposal_.bones[static_cast<std::size_t>(tip)].end.y() <= ground) proposal_.pins.push_back({tip, true});
        if (proposal_.pins.empty() || proposal_.pins.size() == tips_.size()) proposal_.pins = {{0, false}};
    }

    static constexpr double kSame = 1e-6;  // of the diagonal: heads nearer than this are one

    const Rig& rig_;
    const TriangleMesh& body_;
    double least_;
    RigFlesh flesh_;
    RigCuts cuts_;
    MergedRig merged_;
    Proposal proposal_;
    std::vector<std::string> names_;  // per kept bone
    std::set<std::string> taken_;
    std::vector<int> tips_;
    double diagonal_ = 0.0;
};

}  // namespace

Result<Proposal> proposeFromRig(const Rig& rig, const TriangleMesh& render, const TriangleMesh& body, double least, const Progress& progress) {
    return RigProposer(rig, render, body, least).propose(progress);
}

}  // namespace imomushi
