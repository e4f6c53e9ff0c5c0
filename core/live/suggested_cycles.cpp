// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/suggested_cycles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>

#include "core/base/rotation_vector.h"
#include "core/document/command_support.h"
#include "core/live/suggested_mappings.h"
#include "core/mesh/bounds.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// How long rounds take, s: a walk, a slow sway, and a breath at rest.
constexpr double kCrawlSeconds = 1.6, kSwaySeconds = 3.0, kBreatheSeconds = 4.0;
/// k of crawl over the length of its chain, and how much shorter bones are where they are lifted.
constexpr double kLift = 0.06, kShorten = 0.08;
constexpr std::size_t kFewestToCrawl = 3;
/// A chain lies where its bones rise or fall by no more than this part of its length, and have a point that is no higher above the ground than this part of the character's size.
constexpr double kLevel = 0.5, kNearGround = 0.2;
/// a of sway, radians, and how many waves a chain has.
constexpr double kSwayAngle = 0.4, kSwayWaves = 0.75;
/// What is shorter than this part of the size, such as a finger, sways less.
constexpr double kLimb = 0.2;
/// A leg goes down by so much of its length, and its tip is no higher than this part of the size.
constexpr double kSteep = 0.7, kOnGround = 0.1;
/// Of breathing: how much longer bones get, what counts as a large element, and how far handles rise over the size.
constexpr double kLonger = 0.12, kLarge = 0.5, kRise = 0.05;
/// How much of a joint limit is used.
constexpr double kOfLimit = 0.5;

struct Chain {
    std::vector<int> bones;  ///< of the skeleton, from root to tip
    double length = 0.0;     ///< m
    Vec3 along = Vec3::UnitX();  ///< from its root to its tip, m
    double lowest = 0.0;     ///< m, of its joint points
    bool free = false;       ///< its tip carries nothing
    bool loose = false;      ///< its root may move: nothing carries it and no pin holds it
    bool leg = false;
};

/// What a bone does besides what its parent does.
struct Motion {
    Vec3 turn = Vec3::Zero();  ///< a rotation vector, in the axes of the rest pose
    double longer = 0.0;       ///< by this part of its length
    Vec3 by = Vec3::Zero();    ///< m, of the start of a root
};

class Creature {
public:
    Creature(const Document& document, const CharacterPlan& plan) : document_(document), plan_(plan), skeleton_(plan.input.skeleton), tree_(boneTree(skeleton_)), size_(characterSize(document)) {
        ground_ = std::numeric_limits<double>::infinity();
        for (const auto& [id, element] : document.elements)
            if (element->mesh->body.vertices.rows() > 0) ground_ = std::min(ground_, boundsOf(element->mesh->body.vertices).low.y());
        findChains();
    }

    std::vector<SuggestedCycle> all() const {
        std::vector<SuggestedCycle> made;
        for (auto& cycle : {crawl(), sway(), breathe()})
            if (!cycle.poses.empty()) made.push_back(cycle);
        return made;
    }

private:
    [[nodiscard]] const Skeleton::Bone& bone(int b) const { return skeleton_.bones[static_cast<std::size_t>(b)]; }
    [[nodiscard]] const Vec3& point(int p) const { return skeleton_.points[static_cast<std::size_t>(p)]; }
    [[nodiscard]] int parent(int b) const { return tree_.parent[static_cast<std::size_t>(b)]; }
    [[nodiscard]] bool pinned(int p) const {
        return std::ranges::any_of(document_.goals, [&](const auto& goal) { return goal.second.pinned && plan_.pointIndex(goal.first) == p; });
    }
    [[nodiscard]] bool isHinge(int b) const { return !bone(b).hinge.isZero(); }

    void findChains() {
        const auto count = static_cast<int>(skeleton_.bones.size());
        std::vector<std::vector<int>> children(skeleton_.bones.size()), goOn(skeleton_.bones.size());
        for (int b = 0; b < count; ++b)
            if (parent(b) >= 0) {
                children[static_cast<std::size_t>(parent(b))].push_back(b);
                if (bone(b).start == bone(parent(b)).end) goOn[static_cast<std::size_t>(parent(b))].push_back(b);
            }
        std::vector<char> inside(skeleton_.bones.size(), 0);
        for (int b = 0; b < count; ++b) {
            if (inside[static_cast<std::size_t>(b)]) continue;
            Chain chain;
            for (int at = b;;) {
                chain.bones.push_back(at);
                chain.length += bone(at).length;
                inside[static_cast<std::size_t>(at)] = 1;
                const auto& next = goOn[static_cast<std::size_t>(at)];
                if (next.size() != 1) break;
                at = next.front();
            }
            const int first = chain.bones.front(), last = chain.bones.back();
            chain.along = point(bone(last).end) - point(bone(first).start);
            chain.lowest = point(bone(first).start).y();
            for (const int c : chain.bones) chain.lowest = std::min(chain.lowest, point(bone(c).end).y());
            chain.free = children[static_cast<std::size_t>(last)].empty() && !pinned(bone(last).end);
            chain.loose = parent(first) < 0 && !pinned(bone(first).start);
            chain.leg = chain.free && -chain.along.y() > kSteep * chain.length && point(bone(last).end).y() - ground_ < kOnGround * size_;
            chains_.push_back(std::move(chain));
        }
        carriesLegs_.assign(skeleton_.bones.size(), 0);
        for (const Chain& chain : chains_)
            for (int b = chain.leg ? chain.bones.front() : -1; b >= 0; b = parent(b)) carriesLegs_[static_cast<std::size_t>(b)] = 1;
    }

    /// From 0 at a root that stays to 1 at a tip.
    static double envelope(double s) { return std::sin(0.5 * std::numbers::pi * s); }

    /// How far into a round the chains that are next to each other are apart: their places around the character, 0 ... 1.
    [[nodiscard]] double around(const Chain& chain) const {
        const double angle = std::atan2(chain.along.x(), chain.along.z()) / kTurn;
        return angle - std::floor(angle);
    }

    static constexpr std::array<double, 3> kPhases = {0.0, 1.0 / 3.0, 2.0 / 3.0};
    using Motions = std::array<std::vector<Motion>, 3>;  ///< at these phases
    [[nodiscard]] Motions still() const {
        Motions motions;
        for (auto& of : motions) of.resize(skeleton_.bones.size());
        return motions;
    }

    /// The angle of a bone's direction: mean + the real part of wave e^(2 pi i t).
    struct Angle {
        double mean = 0.0;
        std::complex<double> wave;
    };
    static double at(const Angle& angle, double phase) { return angle.mean + std::real(angle.wave * std::polar(1.0, kTurn * phase)); }

    /// Turns each bone of a chain by the difference of angles to the bone before it. Answers which part of that joints allow, and is done.
    double turnChain(const Chain& chain, const Vec3& axis, const std::vector<Angle>& angles, Motions& motions) const {
        std::vector<Angle> turns;
        Angle before;
        double part = 1.0;
        for (std::size_t i = 0; i < chain.bones.size(); ++i) {
            const int b = chain.bones[i];
            const Angle direction = isHinge(b) ? before : angles[i];
            turns.push_back({direction.mean - before.mean, direction.wave - before.wave});
            before = direction;
            const double most = std::abs(turns.back().mean) + std::abs(turns.back().wave);
            if (bone(b).parent >= 0 && bone(b).limitsBend() && most > 0.0) part = std::min(part, kOfLimit * bone(b).maxBend / most);
        }
        for (std::size_t p = 0; p < kPhases.size(); ++p)
            for (std::size_t i = 0; i < chain.bones.size(); ++i) motions[p][static_cast<std::size_t>(chain.bones[i])].turn += part * at(turns[i], kPhases[p]) * axis;
        return part;
    }

    [[nodiscard]] SuggestedCycle crawl() const {
        std::vector<const Chain*> lying;
        for (const Chain& chain : chains_)
            if (chain.bones.size() >= kFewestToCrawl && std::abs(chain.along.y()) <= kLevel * chain.length && std::hypot(chain.along.x(), chain.along.z()) > kLevel * chain.length && chain.lowest - ground_ <= kNearGround * size_)
                lying.push_back(&chain);
        if (lying.empty()) return {};
        std::ranges::stable_sort(lying, {}, [this](const Chain* chain) { return around(*chain); });
        Motions motions = still();
        for (std::size_t c = 0; c < lying.size(); ++c) {
            const Chain& chain = *lying[c];
            const double k = kLift * chain.length, later = 0.5 * static_cast<double>(c % 2);
            const Vec3 side = Vec3(chain.along.x(), 0.0, chain.along.z()).normalized().cross(Vec3::UnitY());
            std::vector<double> s = {0.0};
            for (const int b : chain.bones) s.push_back(s.back() + bone(b).length / chain.length);
            const auto g = [&](double at) { return chain.loose ? 1.0 : envelope(at); };
            const auto height = [&](double where) { return Angle{k * g(where), std::polar(k * g(where), -kTurn * (where + later))}; };  // an angle but for the unit
            std::vector<Angle> slopes;
            for (std::size_t i = 0; i < chain.bones.size(); ++i) {
                const Angle from = height(s[i]), to = height(s[i + 1]);
                const double length = bone(chain.bones[i]).length;
                slopes.push_back({(to.mean - from.mean) / length, (to.wave - from.wave) / length});
            }
            const double part = turnChain(chain, side, slopes, motions);
            for (std::size_t p = 0; p < kPhases.size(); ++p) {
                for (std::size_t i = 0; i < chain.bones.size(); ++i) {
                    const Skeleton::Bone& of = bone(chain.bones[i]);
                    const double most = std::min({kShorten, kOfLimit * (1.0 - of.minStretch), kOfLimit * (of.maxStretch - 1.0)}), lifted = at({0.0, height(0.5 * (s[i] + s[i + 1])).wave}, kPhases[p]) / k;
                    motions[p][static_cast<std::size_t>(chain.bones[i])].longer -= part * std::max(0.0, most) * lifted;
                }
                if (chain.loose) motions[p][static_cast<std::size_t>(chain.bones.front())].by += part * at(height(0.0), kPhases[p]) * Vec3::UnitY();
            }
        }
        return made("crawl", kCrawlSeconds, motions, kPhases.size());
    }

    [[nodiscard]] SuggestedCycle sway() const {
        auto motions = still();
        bool any = false;
        for (const Chain& chain : chains_) {
            if (!chain.free || chain.leg || chain.length <= 0.0) continue;
            const Vec3 along = chain.along.normalized();
            const Vec3 across = Vec3::UnitY().cross(along);
            // What stands sways from side to side of the scene.
            const Vec3 side = across.norm() > 0.3 ? across.normalized() : Vec3(Vec3::UnitX() - along.x() * along).normalized();
            const Vec3 axis = along.cross(side).normalized();
            const double later = around(chain);
            const double most = kSwayAngle * std::min(1.0, chain.length / (kLimb * size_));
            double s = 0.0;
            std::vector<Angle> angles;
            for (const int b : chain.bones) {
                const double middle = s + 0.5 * bone(b).length / chain.length;
                s += bone(b).length / chain.length;
                const bool stands = carriesLegs_[static_cast<std::size_t>(b)] != 0;
                any = any || !(stands || isHinge(b));
                // A sine is the real part of -i e^i.
                angles.push_back({0.0, stands ? 0.0 : std::complex<double>(0.0, -1.0) * std::polar(most * envelope(middle), -kTurn * (kSwayWaves * middle + later))});
            }
            (void)turnChain(chain, axis, angles, motions);
        }
        return any ? made("sway", kSwaySeconds, motions, kPhases.size()) : SuggestedCycle();
    }

    [[nodiscard]] SuggestedCycle breathe() const {
        if (skeleton_.bones.empty()) return rise();
        const auto sizeOf = [&](PartId element) {
            const auto found = document_.elements.find(element);
            return found == document_.elements.end() || found->second->mesh->body.vertices.rows() == 0 ? 0.0 : (boundsOf(found->second->mesh->body.vertices).high - boundsOf(found->second->mesh->body.vertices).low).prod();
        };
        double largest = 0.0;
        for (const PartId id : plan_.bones) largest = std::max(largest, sizeOf(document_.bones.at(id)->element));
        auto motions = still();
        bool any = false;
        for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
            const double longer = std::min(kLonger, kOfLimit * (skeleton_.bones[b].maxStretch - 1.0));
            if (sizeOf(document_.bones.at(plan_.bones[b])->element) < kLarge * largest || longer <= 0.0) continue;
            motions[0][b].longer = longer;
            any = true;
        }
        return any ? made("breathe", kBreatheSeconds, motions, 2) : SuggestedCycle();
    }

    [[nodiscard]] SuggestedCycle rise() const {
        if (plan_.handles.empty()) return {};
        SuggestedCycle breath = made("breathe", kBreatheSeconds, still(), 2);
        for (const FaceRef& handle : plan_.handles) {
            const auto goal = document_.handleGoals.find(handle);
            if (goal != document_.handleGoals.end() && goal->second.pinned) continue;
            HandleGoal up;
            up.target.held = true;
            up.target.at = faceOf(document_, handle).frame.origin + kRise * size_ * Vec3::UnitY();
            up.from = up.target;
            breath.poses.front().handles.insert_or_assign(handle, up);
        }
        return breath;
    }

    [[nodiscard]] SuggestedCycle made(const std::string& name, double seconds, const Motions& motions, std::size_t count) const {
        SuggestedCycle cycle{{name, {}, seconds}, {}};
        for (std::size_t p = 0; p < count; ++p) {
            cycle.poses.push_back(poseOf(motions[p]));
            cycle.poses.back().name = name + " " + std::to_string(p + 1);
            cycle.cycle.poses.push_back(cycle.poses.back().name);
        }
        return cycle;
    }

    /// By forward kinematics; what is pinned stays held.
    [[nodiscard]] KeptPose poseOf(const std::vector<Motion>& motions) const {
        KeptPose pose;
        struct At {
            Eigen::Quaterniond whole = Eigen::Quaterniond::Identity(), frame = Eigen::Quaterniond::Identity();
            Vec3 start = Vec3::Zero();
            double length = 1.0;
        };
        std::vector<At> at(skeleton_.bones.size());
        std::vector<double> roll(skeleton_.points.size(), 0.0);
        for (std::size_t b = 0; b < at.size(); ++b) {
            const Skeleton::Bone& of = skeleton_.bones[b];
            const At* carrier = tree_.parent[b] < 0 ? nullptr : &at[static_cast<std::size_t>(tree_.parent[b])];
            at[b].whole = (carrier ? carrier->whole : Eigen::Quaterniond::Identity()) * rotationOf(motions[b].turn);
            at[b].length = 1.0 + motions[b].longer;
            at[b].start = point(of.start) + motions[b].by;
            if (carrier) at[b].start = carrier->start + carrier->whole * (carrier->length * (point(of.start) - point(bone(tree_.parent[b]).start)));
            const Eigen::Quaterniond carried = carrier ? carrier->frame : Eigen::Quaterniond::Identity();
            const Vec3 way = at[b].whole * (at[b].length * (point(of.end) - point(of.start))), direction = way.normalized();
            at[b].frame = (minimalRotation(carried * tree_.restDirection[b], direction) * carried).normalized();
            const Eigen::Quaterniond twist = at[b].whole * at[b].frame.conjugate();
            roll[static_cast<std::size_t>(of.end)] = tree_.rollSign[b] * rotationVector(twist.w() < 0.0 ? Eigen::Quaterniond(-twist.coeffs()) : twist).dot(direction);
            pose.bones.emplace(plan_.bones[b], KeptPose::Bone{at[b].start, at[b].start + way, at[b].frame, roll[static_cast<std::size_t>(of.start)], roll[static_cast<std::size_t>(of.end)]});
        }
        for (const auto& [end, goal] : document_.goals)
            if (goal.pinned) pose.goals.emplace(end, goal);
        for (const auto& [handle, goal] : document_.handleGoals)
            if (goal.pinned) pose.handles.emplace(handle, goal);
        return pose;
    }

    const Document& document_;
    const CharacterPlan& plan_;
    const Skeleton& skeleton_;
    BoneTree tree_;
    double size_ = 1.0, ground_ = 0.0;  // m; y
    std::vector<Chain> chains_;
    std::vector<char> carriesLegs_;     // of each bone
};

}  // namespace

std::vector<SuggestedCycle> suggestedCycles(const Document& document, const CharacterPlan& plan) { return Creature(document, plan).all(); }

}  // namespace imomushi
