// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/shape_proposal.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "core/base/try.h"
#include "core/body/cgal/even_mesh.h"
#include "core/body/cgal/rays.h"
#include "core/mesh/bounds.h"
#include "core/mesh/health.h"
#include "core/mesh/topology.h"
#include "core/proposal/fit_cuts.h"
#include "core/proposal/limb_cuts.h"
#include "core/proposal/mirror_plane.h"
#include "core/proposal/proposal_codec.h"
#include "core/proposal/scaled_body.h"
#include "core/proposal/standing.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

/// Of the meshes that the skeleton is found on, one after the other, and of the one on which ends are looked for that it loses.
constexpr std::size_t kVertices[] = {3200, 2500}, kFineVertices = 10000;
/// How often limbs that the skeleton lost are tried, each time without those that could not be cut off.
constexpr int kRounds = 5;
/// Length of a piece in thicknesses; longer by the factor until there are at most so many cuts. Limbs are divided into few pieces, tentacles and chains into more.
constexpr double kPerPiece = 2.0, kLonger = 1.3;
constexpr std::size_t kMostCuts = 40;
constexpr int kMostOfLimb = 3, kMostOfTentacle = 8, kMostOfChain = 15;
constexpr double kTentacle = 0.6;  // diagonals long
/// A cut may be moved by this much of the radius of its section: as far as necks are looked for.
constexpr double kCutReach = 1.3;
constexpr int kMoves = 5;  // and so often: ears and horns that stand side by side give way to each other several times
/// A limb stands on the ground where its tip is at most this far above the lowest point: of the height, or of the diagonal.
constexpr double kGround = 0.06, kGroundOfDiagonal = 0.02;
/// Bones end this far inside of the tip, in lengths of the last one.
constexpr double kInside = 0.05;
/// A handle lies across the plane of symmetry where its direction has more than this of the plane's normal.
constexpr double kAcrossPlane = 0.5;
/// Radius of proposed handles, in diagonals.
constexpr double kHandle = 0.08;

struct HubPlan;
struct LimbPlan {
    std::string name, suffix;
    std::vector<int> cuts;  // outward
    std::vector<HubPlan> end;
};
struct HubPlan {
    std::vector<LimbPlan> limbs;
};

/// Cuts that were tried.
struct Planned {
    LimbTree tree;
    HubPlan plan;
    std::vector<WishedCut> wished;
    std::vector<FittedCut> fitted;
    std::size_t kept = 0;
};

class Proposer {
public:
    Proposer(const TriangleMesh& body, double least, const Progress& progress) : body_(body), least_(least), progress_(progress), scaled_(scaledBody(body)) {
        low_ = body.vertices.col(1).minCoeff();
        ground_ = low_ + std::max(kGround * (body.vertices.col(1).maxCoeff() - low_), kGroundOfDiagonal * scaled_.diagonal);
    }

    Result<Proposal> propose() {
        mirror_ = mirrorPlane();
        if (mirror_) proposal_.symmetry = scaled_.back(*mirror_);
        // Which limbs a skeleton finds and where their necks are hangs on the triangles: where a limb could not be cut, others are tried, and the one that keeps most cuts is taken.
        HubPlan plan;
        std::optional<Planned> best;
        for (std::size_t i = 0; i < std::size(kVertices); ++i) {
            const Progress part = progress_.part(static_cast<double>(i) / std::size(kVertices), static_cast<double>(i + 1) / std::size(kVertices));
            even_ = evenMesh(scaled_.mesh, kVertices[i]);
            if (even_.triangles.rows() == 0) even_ = scaled_.mesh;
            part.report("skeleton", 0.1);
            auto tree = findLimbs(even_, scaled_.direction(Vec3::UnitY()), least_, part.part(0.1, 0.5));
            if (!tree && tree.error().code == kCancelled) return tl::unexpected(tree.error());
            if (!tree && best) continue;
            if (!tree) return asBlob(std::move(tree.error()));
            part.report("cut", 0.5);
            if (auto planned = planWithLost(*tree, plan, part); !planned) return tl::unexpected(std::move(planned.error()));
            if (!best || keptCuts() > best->kept) best = Planned{tree_, plan, wished_, fitted_, keptCuts()};
            if (tree_.blob || tree_.chain || !losesLimbs(tree_.root, plan)) break;
        }
        std::tie(tree_, plan, wished_, fitted_) = std::tie(best->tree, best->plan, best->wished, best->fitted);
        if (tree_.rings > 0)
            proposal_.notes.push_back({"ring", "The body has " + counted(static_cast<std::size_t>(tree_.rings), "ring", "rings") + ": a ring is cut where it is thinnest, in two places by hand."});
        // The bones of a ring would not meet again.
        if (tree_.blob || (tree_.chain && tree_.rings > 0)) return asBlob(std::nullopt);
        if (keptCuts() == 0) return asBlob(std::nullopt);
        name(tree_.root, plan);
        keepCuts(plan);
        addBones(tree_.root, plan);
        pinStanding(proposal_, tips_, body_);
        tellLeftOut(uncut(tree_.root, plan));
        return std::move(proposal_);
    }

private:
    /// Along the axes of the world, in which characters have a front; given in those of the body.
    [[nodiscard]] std::optional<CutPlane> mirrorPlane() const {
        TriangleMesh upright = scaled_.mesh;
        upright.vertices = (upright.vertices * scaled_.axes.transpose()).eval();
        if (scaled_.axes.determinant() < 0.0) upright.triangles.col(1).swap(upright.triangles.col(2));
        const Bounds box = boundsOf(upright.vertices);
        const Vec3 middle = box.low + 0.5 * box.size();  // planes go through it where they can
        upright.vertices.rowwise() -= middle.transpose();
        auto plane = findMirrorPlane(upright);
        if (plane) plane = CutPlane{scaled_.direction(plane->origin + middle), scaled_.direction(plane->normal)};
        return plane;
    }

    // ---- limbs

    /// Plans the cuts of a tree and tries them.
    Result<void> planTree(LimbTree tree, HubPlan& plan, const Progress& progress) {
        tree_ = std::move(tree);
        if (mirror_) symmetrise(tree_, *mirror_);
        plan = {};
        wished_.clear();
        fitted_.clear();
        if (tree_.blob || (tree_.chain && tree_.rings > 0)) return {};
        const CutSurface surface(even_);
        for (double perPiece = kPerPiece;; perPiece *= kLonger) {
            wished_.clear();
            plan = tree_.chain ? planChain(surface, perPiece) : planHub(surface, tree_.root, perPiece);
            if (wished_.size() <= kMostCuts || perPiece > 50.0) break;
        }
        IMOMUSHI_TRY(fitted_, fitCuts(body_, wished_, proposal_.symmetry, least_, progress));
        return {};
    }

    /// With the limbs that the skeleton lost, as far as they can be cut off and no other cut is lost by them.
    Result<void> planWithLost(const LimbTree& skeleton, HubPlan& plan, const Progress& progress) {
        if (auto planned = planTree(skeleton, plan, progress.part(0.5, 0.7)); !planned) return tl::unexpected(std::move(planned.error()));
        if (!surfaceTips_) {
            fine_ = evenMesh(scaled_.mesh, kFineVertices);
            if (fine_.triangles.rows() == 0) fine_ = even_;
            surfaceTips_ = findSurfaceTips(fine_);
        }
        std::vector<char> without(surfaceTips_->tips.size(), 0);
        for (int round = 0; round < kRounds; ++round) {
            LimbTree tree = skeleton;
            if (!addLostLimbs(tree, fine_, *surfaceTips_, without, least_)) return {};
            const Planned before{tree_, plan, wished_, fitted_, keptCuts()};
            if (auto planned = planTree(std::move(tree), plan, progress.part(0.7 + 0.3 * round / kRounds, 0.7 + 0.3 * (round + 1) / kRounds)); !planned) return tl::unexpected(std::move(planned.error()));
            const bool uncut = leaveUncutOut(tree_.root, plan, without);
            if (!uncut && keptCuts() >= before.kept) return {};
            std::tie(tree_, plan, wished_, fitted_) = std::tie(before.tree, before.plan, before.wished, before.fitted);
            if (!uncut) return {};
        }
        return {};
    }

    [[nodiscard]] std::size_t keptCuts() const {
        return static_cast<std::size_t>(std::count_if(fitted_.begin(), fitted_.end(), [](const FittedCut& cut) { return cut.kept; }));
    }

    [[nodiscard]] bool losesLimbs(const Hub& hub, const HubPlan& plan) const {
        for (std::size_t i = 0; i < plan.limbs.size(); ++i) {
            const auto& cuts = plan.limbs[i].cuts;
            if (!hub.limbs[i].stump && std::none_of(cuts.begin(), cuts.end(), [&](int c) { return fitted_[static_cast<std::size_t>(c)].kept; })) return true;
            for (std::size_t e = 0; e < plan.limbs[i].end.size(); ++e)
                if (losesLimbs(hub.limbs[i].end[e], plan.limbs[i].end[e])) return true;
        }
        return false;
    }

    /// False: every lost limb has a cut.
    bool leaveUncutOut(const Hub& hub, const HubPlan& plan, std::vector<char>& without) const {
        bool some = false;
        for (std::size_t i = 0; i < plan.limbs.size(); ++i) {
            const auto& cuts = plan.limbs[i].cuts;
            if (hub.limbs[i].lost >= 0 && std::none_of(cuts.begin(), cuts.end(), [&](int c) { return fitted_[static_cast<std::size_t>(c)].kept; }))
                without[static_cast<std::size_t>(hub.limbs[i].lost)] = 1, some = true;
            for (std::size_t e = 0; e < plan.limbs[i].end.size(); ++e) some = leaveUncutOut(hub.limbs[i].end[e], plan.limbs[i].end[e], without) || some;
        }
        return some;
    }

    // ---- cuts

    int wish(const LimbStation& station, const Limb& limb, int side) {
        LimbStation s = station;
        if (mirror_ && side == 0) {
            s.at = ontoPlane(*mirror_, s.at);
            const Vec3 n = s.normal - mirror_->normal.dot(s.normal) * mirror_->normal;
            if (n.norm() > 0.3) s.normal = n.normalized();
        }
        wished_.push_back({scaled_.back(CutPlane{s.at, s.normal}), kCutReach * s.radius * scaled_.diagonal, -1, limb.end.empty() ? std::optional(scaled_.back(limb.tip())) : std::nullopt, kMoves});
        return static_cast<int>(wished_.size()) - 1;
    }

    /// The mirror images of a planned limb's cuts.
    LimbPlan image(const LimbPlan& of) {
        LimbPlan made = of;
        for (int& cut : made.cuts) {
            WishedCut twin = wished_[static_cast<std::size_t>(cut)];
            twin.plane = {mirroredPoint(*proposal_.symmetry, twin.plane.origin), mirroredDirection(*proposal_.symmetry, twin.plane.normal)};
            if (twin.tip) twin.tip = mirroredPoint(*proposal_.symmetry, *twin.tip);
            twin.twin = cut;
            wished_[static_cast<std::size_t>(cut)].twin = static_cast<int>(wished_.size());
            cut = static_cast<int>(wished_.size());
            wished_.push_back(twin);
        }
        for (HubPlan& hub : made.end)
            for (LimbPlan& limb : hub.limbs) limb = image(limb);
        return made;
    }

    HubPlan planHub(const CutSurface& surface, const Hub& hub, double perPiece) {
        HubPlan plan;
        plan.limbs.resize(hub.limbs.size());
        for (std::size_t i = 0; i < hub.limbs.size(); ++i) {
            const Limb& limb = hub.limbs[i];
            if (limb.side < 0 && limb.twin >= 0 && limb.twin < static_cast<int>(i)) {
                plan.limbs[i] = image(plan.limbs[static_cast<std::size_t>(limb.twin)]);
                continue;
            }
            if (limb.stump) continue;
            const int most = limb.length() > kTentacle && limb.end.empty() ? kMostOfTentacle : kMostOfLimb;
            for (const LimbStation& s : cutsOfLimb(surface, hub, limb, perPiece, most)) plan.limbs[i].cuts.push_back(wish(s, limb, limb.side));
            for (const Hub& end : limb.end) plan.limbs[i].end.push_back(planHub(surface, end, perPiece));
        }
        return plan;
    }

    HubPlan planChain(const CutSurface& surface, double perPiece) {
        HubPlan plan;
        const auto cuts = cutsOfChain(surface, tree_.root, perPiece, kMostOfChain);
        const bool across = mirror_ && tree_.root.limbs[0].twin >= 0;
        for (std::size_t i = 0; i < 2; ++i) {
            LimbPlan& limb = plan.limbs.emplace_back();
            if (across && i == 1) {
                limb = image(plan.limbs[0]);
                continue;
            }
            for (const LimbStation& s : cuts[i]) limb.cuts.push_back(wish(s, tree_.root.limbs[i], across ? 1 : 0));
        }
        return plan;
    }

    // ---- names

    void name(const Hub& hub, HubPlan& plan) {
        proposal_.root = tree_.chain ? "middle" : "trunk";
        std::vector<std::string> label(hub.limbs.size());
        int highest = -1;
        for (std::size_t i = 0; i < hub.limbs.size(); ++i) {
            const Limb& limb = hub.limbs[i];
            const bool down = scaled_.height(limb.tip()) < scaled_.height(limb.line.front());
            if (tree_.chain) {
                label[i] = i == 0 ? "front" : "back";
            } else if (limb.twin >= 0 || !mirror_) {
                label[i] = down && scaled_.back(limb.tip()).y() <= ground_ ? "leg" : mirror_ ? "arm" : "limb";
            } else {
                label[i] = down && scaled_.back(limb.tip()).y() <= ground_ ? "leg" : "tail";
                if (!down && (highest < 0 || scaled_.height(limb.tip()) > scaled_.height(hub.limbs[static_cast<std::size_t>(highest)].tip()))) highest = static_cast<int>(i);
            }
        }
        if (highest >= 0) label[static_cast<std::size_t>(highest)] = "head";
        std::map<std::string, int> total, count;
        const auto counts = [&](std::size_t i) { return hub.limbs[i].twin < 0 || hub.limbs[i].twin > static_cast<int>(i); };
        for (std::size_t i = 0; i < label.size(); ++i)
            if (counts(i)) ++total[label[i]];
        for (std::size_t i = 0; i < label.size(); ++i) {
            LimbPlan& limb = plan.limbs[i];
            if (!counts(i)) {
                limb.name = plan.limbs[static_cast<std::size_t>(hub.limbs[i].twin)].name;
            } else {
                limb.name = label[i];
                if (total[label[i]] > 1) limb.name += " " + std::to_string(++count[label[i]]);
            }
            if (hub.limbs[i].side != 0 && hub.limbs[i].twin >= 0) limb.suffix = hub.limbs[i].side > 0 ? ".L" : ".R";
            for (std::size_t e = 0; e < limb.end.size(); ++e) nameParts(hub.limbs[i].end[e], limb.end[e], limb.name, limb.suffix);
        }
    }

    void nameParts(const Hub& hub, HubPlan& plan, const std::string& of, const std::string& suffix) {
        int count = 0;
        for (std::size_t i = 0; i < plan.limbs.size(); ++i) {
            LimbPlan& limb = plan.limbs[i];
            const Limb& shape = hub.limbs[i];
            const bool image = shape.twin >= 0 && shape.twin < static_cast<int>(i);
            if (shape.stump) continue;
            limb.name = image ? plan.limbs[static_cast<std::size_t>(shape.twin)].name : of + " part " + std::to_string(++count);
            limb.suffix = suffix;
            if (suffix.empty() && shape.twin >= 0) limb.suffix = shape.side > 0 ? ".L" : ".R";
            for (std::size_t e = 0; e < limb.end.size(); ++e) nameParts(shape.end[e], limb.end[e], limb.name, limb.suffix);
        }
    }

    [[nodiscard]] static std::string numbered(const LimbPlan& limb, std::size_t k, std::size_t of, const char* what = "") {
        return limb.name + (of > 1 ? "-" + std::to_string(k + 1) : std::string()) + what + limb.suffix;
    }

    /// Cuts that work become the proposal's, those of each limb renumbered.
    void keepCuts(HubPlan& plan) {
        for (LimbPlan& limb : plan.limbs) {
            std::vector<int> kept;
            for (const int c : limb.cuts) {
                const FittedCut& cut = fitted_[static_cast<std::size_t>(c)];
                if (cut.kept) kept.push_back(c);
            }
            std::vector<int> made;
            for (std::size_t k = 0; k < kept.size(); ++k) {
                made.push_back(static_cast<int>(proposal_.cuts.size()));
                proposal_.cuts.push_back({numbered(limb, k, kept.size(), " cut"), numbered(limb, k, kept.size()), fitted_[static_cast<std::size_t>(kept[k])].plane});
            }
            for (const int c : limb.cuts) {
                const FittedCut& cut = fitted_[static_cast<std::size_t>(c)];
                if (cut.why.empty() || (wished_[static_cast<std::size_t>(c)].twin >= 0 && wished_[static_cast<std::size_t>(c)].twin < c)) continue;  // told of its twin
                proposal_.notes.push_back({cut.kept ? "moved" : "left-out", "A cut of \"" + limb.name + limb.suffix + "\": " + cut.why});
            }
            limb.cuts = std::move(made);
            for (HubPlan& end : limb.end) keepCuts(end);
        }
    }

    // ---- bones

    int bone(std::string name, int parent, bool fromParentStart, const Vec3& start, const Vec3& end, int piece, int startCut, int endCut) {
        ProposedBone made;
        made.name = std::move(name);
        made.parent = parent;
        made.fromParentStart = fromParentStart;
        made.start = parent < 0 ? start : fromParentStart ? proposal_.bones[static_cast<std::size_t>(parent)].start : proposal_.bones[static_cast<std::size_t>(parent)].end;
        made.end = end;
        made.piece = piece;
        made.startCut = startCut;
        made.endCut = endCut;
        proposal_.bones.push_back(std::move(made));
        return static_cast<int>(proposal_.bones.size()) - 1;
    }
    [[nodiscard]] const Vec3& placeOf(int cut) const { return proposal_.cuts[static_cast<std::size_t>(cut)].plane.origin; }

    void addBones(const Hub& root, const HubPlan& plan) {
        if (tree_.chain) {
            const auto& a = plan.limbs[0].cuts;
            const auto& b = plan.limbs[1].cuts;
            const auto inside = [&](const Limb& limb) { return scaled_.back(pointAlong(limb.line, (1.0 - kInside) * limb.length())); };
            const Vec3 end = a.empty() ? inside(root.limbs[0]) : placeOf(a[0]), start = b.empty() ? inside(root.limbs[1]) : placeOf(b[0]);
            const int middle = bone(proposal_.root + " bone", -1, false, start, end, -1, b.empty() ? -1 : b[0], a.empty() ? -1 : a[0]);
            if (a.empty()) tips_.push_back(middle);
            addPieces(root.limbs[0], plan.limbs[0], middle, false);
            addPieces(root.limbs[1], plan.limbs[1], middle, true);
            return;
        }
        addHub(root, plan, -1, -1, proposal_.root, {});
    }

    /// `entry`: the bone that ends at the hub's first point, -1: it is the root. `piece`: that the hub lies in.
    void addHub(const Hub& hub, const HubPlan& plan, int entry, int piece, const std::string& name, const std::string& suffix) {
        int second = -1;
        if (hub.points.size() > 1) second = bone(name + " bone" + suffix, entry, false, scaled_.back(hub.points[0]), scaled_.back(hub.points[1]), piece, -1, -1);
        int leader = entry < 0 ? second : entry;  // on which hangs what begins at the first point
        for (std::size_t i = 0; i < plan.limbs.size(); ++i) {
            const Limb& limb = hub.limbs[i];
            const LimbPlan& planned = plan.limbs[i];
            if (planned.cuts.empty()) continue;
            const bool far = limb.point == 1 && second >= 0;
            const int parent = far ? second : leader;
            const bool fromStart = !far && entry < 0 && leader >= 0;
            const Vec3 from = scaled_.back(hub.points[static_cast<std::size_t>(far ? 1 : 0)]);
            const int base = bone(planned.name + " base" + planned.suffix, parent, fromStart, from, placeOf(planned.cuts[0]), piece, -1, planned.cuts[0]);
            if (leader < 0) leader = base;
            addPieces(limb, planned, base, false);
        }
    }

    /// The bones beyond the first cut of a limb, after `parent`.
    void addPieces(const Limb& limb, const LimbPlan& planned, int parent, bool fromStart) {
        int piece = -1;
        const bool ends = limb.end.empty() || !hasCuts(planned.end[0]);
        for (std::size_t k = 0; k < planned.cuts.size(); ++k) {
            const bool last = k + 1 == planned.cuts.size();
            piece = planned.cuts[k];
            Vec3 end;
            if (!last)
                end = placeOf(planned.cuts[k + 1]);
            else if (ends)
                end = tipOf(limb) + kInside * (placeOf(planned.cuts[k]) - tipOf(limb));
            else
                end = scaled_.back(limb.end[0].points[0]);
            parent = bone(numbered(planned, k, planned.cuts.size(), " bone"), parent, fromStart, Vec3::Zero(), end, piece, planned.cuts[k], last ? -1 : planned.cuts[k + 1]);
            fromStart = false;
        }
        if (planned.cuts.empty()) return;
        if (ends)
            tips_.push_back(parent);
        else
            addHub(limb.end[0], planned.end[0], parent, piece, planned.name + " end", planned.suffix);
    }

    [[nodiscard]] static bool hasCuts(const HubPlan& hub) {
        return std::any_of(hub.limbs.begin(), hub.limbs.end(), [](const LimbPlan& limb) { return !limb.cuts.empty(); });
    }

    /// The tip of a limb; where it ends in a hub whose limbs are not cut, that of its stump, else of the longest of them (in the plane of symmetry where it lies there).
    [[nodiscard]] Vec3 tipOf(const Limb& limb) const {
        if (limb.end.empty()) return scaled_.back(limb.tip());
        const Hub& hub = limb.end[0];
        const Limb* longest = nullptr;
        for (const Limb& on : hub.limbs)
            if ((!mirror_ || limb.side != 0 || on.side == 0) && (!longest || (!longest->stump && (on.stump || on.length() > longest->length())))) longest = &on;
        return longest ? tipOf(*longest) : scaled_.back(hub.points.back());
    }

    /// Limbs without a cut.
    [[nodiscard]] static std::size_t uncut(const Hub& hub, const HubPlan& plan) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < plan.limbs.size(); ++i) {
            if (plan.limbs[i].cuts.empty() && !hub.limbs[i].stump) ++count;
            for (std::size_t e = 0; e < plan.limbs[i].end.size(); ++e) count += uncut(hub.limbs[i].end[e], plan.limbs[i].end[e]);
        }
        return count;
    }

    void tellLeftOut(std::size_t uncut) {
        for (const LimbTree::LeftOut& out : tree_.leftOut) {
            const Vec3 at = scaled_.back(out.place);
            const ProposedBone* nearest = nullptr;
            double least = HUGE_VAL;
            for (const ProposedBone& bone : proposal_.bones) {
                const Vec3 side = bone.end - bone.start;
                const double t = std::clamp(side.dot(at - bone.start) / std::max(side.squaredNorm(), 1e-300), 0.0, 1.0);
                const double d = (bone.start + t * side - at).norm();
                if (d < least) least = d, nearest = &bone;
            }
            proposal_.merged.push_back({"branch", nearest ? nearest->name : std::string(), std::min(out.share, 1.0), out.why});
        }
        if (uncut > 0)
            proposal_.notes.push_back({"too-short", counted(uncut, "limb is", "limbs are") + " too short to be cut, or touch another cut: cut by hand, or put a handle there."});
    }

    // ---- what is not cut

    Result<Proposal> asBlob(std::optional<Error> why) {
        proposal_.cuts.clear();
        proposal_.bones.clear();
        proposal_.root = "body";
        if (why) proposal_.notes.push_back(std::move(*why));
        for (const FittedCut& cut : fitted_)
            if (!cut.why.empty()) proposal_.notes.push_back({"left-out", cut.why});
        const RayTree rays(scaled_.mesh);
        Vec3 middle = tree_.root.points.empty() ? Vec3(Vec3::Zero()) : tree_.root.points[0];
        const auto add = [&](std::string name, const Vec3& along, bool pinned) {
            const Vec3 direction = scaled_.direction(along);
            // What lies across the plane of symmetry is the image of what lies in front of it; what looks along it lies in it.
            const double across = mirror_ ? mirror_->normal.dot(direction) : 0.0;
            const bool image = across < -kAcrossPlane;
            const Vec3 way = image ? mirroredDirection(*mirror_, direction) : direction;
            const auto hit = rays.first(middle, way, 2.0, -1);
            if (hit.triangle < 0) return;
            Vec3 at = middle + hit.distance * way;
            if (image) at = mirroredPoint(*mirror_, at);
            else if (mirror_ && across <= kAcrossPlane) at = ontoPlane(*mirror_, at);
            for (const ProposedHandle& other : proposal_.handles)
                if ((scaled_.back(at) - other.point).norm() < 3.0 * kHandle * scaled_.diagonal) return;
            proposal_.handles.push_back({std::move(name), scaled_.back(at), kHandle * scaled_.diagonal, pinned});
        };
        add("bottom", -Vec3::UnitY(), true);
        add("top", Vec3::UnitY(), false);
        add("side.L", Vec3::UnitX(), false);
        add("side.R", -Vec3::UnitX(), false);
        add("front", Vec3::UnitZ(), false);
        add("back", -Vec3::UnitZ(), false);
        if (proposal_.handles.empty()) return fail("no-skeleton", "The body has neither limbs nor places for handles that can be told: cut it by hand.");
        proposal_.notes.push_back({"handles", "The shape has no limbs that can be cut: it gets handles."});
        return std::move(proposal_);
    }

    const TriangleMesh& body_;
    double least_;
    const Progress& progress_;
    ScaledBody scaled_;
    double low_ = 0.0, ground_ = 0.0;
    TriangleMesh even_, fine_;
    std::optional<SurfaceTips> surfaceTips_;  // of fine_
    LimbTree tree_;
    std::optional<CutPlane> mirror_;
    std::vector<WishedCut> wished_;
    std::vector<FittedCut> fitted_;
    std::vector<int> tips_;
    Proposal proposal_;
};

Result<Proposal> proposeHere(const TriangleMesh& body, const double& least, const Progress& progress) {
    if (!meshFacts(body).outward) return fail("not-closed", "The body is not a closed surface that faces outward; repair or wrap it first.");
    auto proposal = Proposer(body, least, progress).propose();
    if (proposal) noteLeftOut(*proposal);
    return proposal;
}

const Operation<Result<Proposal>(TriangleMesh, double)> kPropose("propose-from-shape", proposeHere);

}  // namespace

Result<Proposal> proposeFromShape(const TriangleMesh& body, double least, const Progress& progress) {
    return kPropose(body, least, progress);
}

}  // namespace imomushi
