// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/retarget.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/decompositions.h"
#include "core/mesh/avatar.h"
#include "core/mesh/humanoid.h"

namespace imomushi {

namespace {

using Matrix = Eigen::Matrix4d;
using Turn = Eigen::Quaterniond;

constexpr double kFramesPerSecond = 60.0;
constexpr double kMostNumbers = 4e6;       // of a clip
constexpr double kMoves = 1e-4;            // radians, and of the reach of a skeleton: less is no motion
constexpr double kOtherWay = 30.0 * std::numbers::pi / 180.0;  // figures whose sides differ by less look the same way
constexpr double kStands = 0.05;           // of the leg's length: a foot this little above its lowest place
constexpr double kStandsStill = 0.15;      // of the leg's length per second
constexpr double kBlend = 0.1;             // s: a foot goes over from standing to free

/// The roles of a leg.
struct LegRoles {
    const char *upper, *lower, *foot;
};
constexpr std::array<LegRoles, 2> kLegs = {{{"leftUpperLeg", "leftLowerLeg", "leftFoot"}, {"rightUpperLeg", "rightLowerLeg", "rightFoot"}}};

/// Limbs that point where those of the clip do, and what shows where that is.
const std::map<std::string_view, std::string_view>& pointingRoles() {
    static const std::map<std::string_view, std::string_view> roles = {{"leftUpperArm", "leftLowerArm"}, {"leftLowerArm", "leftHand"}, {"rightUpperArm", "rightLowerArm"}, {"rightLowerArm", "rightHand"},
                                                                       {"leftUpperLeg", "leftLowerLeg"}, {"leftLowerLeg", "leftFoot"}, {"rightUpperLeg", "rightLowerLeg"}, {"rightLowerLeg", "rightFoot"}};
    return roles;
}
/// Hands keep on with the arm that they are of.
bool isOfHand(std::string_view role) {
    for (const HumanRole* at = humanRole(role); at; at = humanRole(at->above))
        if (at->name == "leftHand" || at->name == "rightHand") return true;
    return false;
}

std::vector<std::string> roleNames(const Rig& rig) {
    std::vector<std::string> names(rig.bones.size());
    for (const RigRole& role : humanRoles(rig)) names[static_cast<std::size_t>(role.bone)] = role.role;
    return names;
}

class Retarget {
public:
    Retarget(const Rig& source, const RigClip& clip, const Rig& figure)
        : source_(source), clip_(clip), figure_(figure), sourceRoles_(roleNames(source)), figureRoles_(roleNames(figure)), sourceOf_(figure.bones.size(), -1), turned_(figure.bones.size(), Turn::Identity()) {}

    RetargetedClip made() {
        out_.clip.name = clip_.name;
        out_.clip.morphs = clip_.morphs;
        for (const MorphTrack& track : clip_.morphs) out_.clip.seconds = std::max(out_.clip.seconds, track.times.back());
        match();
        if (out_.followed.empty()) return std::move(out_);
        facing();
        align();
        sample();
        tellLost();
        scale();
        stand();
        write();
        return std::move(out_);
    }

private:
    void match() {
        std::map<std::string, int> exact, plain, roles;
        const auto once = [](std::map<std::string, int>& map, const std::string& key, int bone) {
            if (key.empty()) return;
            if (const auto [known, isNew] = map.try_emplace(key, bone); !isNew) known->second = -1;  // two have it: it says nothing
        };
        for (std::size_t b = 0; b < source_.bones.size(); ++b) {
            exact[source_.bones[b].name] = static_cast<int>(b);
            once(plain, plainBoneName(source_.bones[b].name), static_cast<int>(b));
            roles.try_emplace(sourceRoles_[b], static_cast<int>(b));
        }
        std::map<std::string, int> plainOfFigure;
        for (std::size_t b = 0; b < figure_.bones.size(); ++b) once(plainOfFigure, plainBoneName(figure_.bones[b].name), static_cast<int>(b));
        std::vector<char> used(source_.bones.size(), 0);
        const auto give = [&](std::size_t b, int bone) {
            if (sourceOf_[b] >= 0 || bone < 0 || used[static_cast<std::size_t>(bone)]) return false;
            // What both files say of a human counts more than a name that they share.
            if (!figureRoles_[b].empty() && !sourceRoles_[static_cast<std::size_t>(bone)].empty() && figureRoles_[b] != sourceRoles_[static_cast<std::size_t>(bone)]) return false;
            sourceOf_[b] = bone;
            used[static_cast<std::size_t>(bone)] = 1;
            return true;
        };
        const auto at = [](const std::map<std::string, int>& map, const std::string& key) {
            const auto found = map.find(key);
            return found == map.end() ? -1 : found->second;
        };
        for (std::size_t b = 0; b < figure_.bones.size(); ++b) out_.byNames += give(b, at(exact, figure_.bones[b].name));
        for (std::size_t b = 0; b < figure_.bones.size(); ++b)
            if (const std::string name = plainBoneName(figure_.bones[b].name); at(plainOfFigure, name) == static_cast<int>(b)) out_.byNames += give(b, at(plain, name));
        for (std::size_t b = 0; b < figure_.bones.size(); ++b)
            if (!figureRoles_[b].empty()) give(b, at(roles, figureRoles_[b]));
        for (std::size_t b = 0; b < figure_.bones.size(); ++b)
            if (sourceOf_[b] >= 0) out_.followed.emplace_back(sourceOf_[b], static_cast<int>(b));
    }

    [[nodiscard]] int sourceBone(std::string_view role) const { return boneOf(sourceRoles_, role); }
    [[nodiscard]] int figureBone(std::string_view role) const { return boneOf(figureRoles_, role); }
    static int boneOf(const std::vector<std::string>& roles, std::string_view role) {
        const auto found = std::find(roles.begin(), roles.end(), role);
        return found == roles.end() ? -1 : static_cast<int>(found - roles.begin());
    }
    [[nodiscard]] const Vec3& figureHead(int bone) const { return figure_.bones[static_cast<std::size_t>(bone)].head; }
    [[nodiscard]] Vec3 sourceHead(int bone) const { return facing_ * source_.bones[static_cast<std::size_t>(bone)].head; }

    /// From the right to the left, level.
    void facing() {
        const auto side = [](const Rig& rig, int right, int left) {
            Vec3 across = Vec3::Zero();
            if (right >= 0 && left >= 0) across = rig.bones[static_cast<std::size_t>(left)].head - rig.bones[static_cast<std::size_t>(right)].head;
            across.y() = 0.0;
            return across;
        };
        const Vec3 from = side(source_, sourceBone("rightUpperLeg"), sourceBone("leftUpperLeg")), to = side(figure_, figureBone("rightUpperLeg"), figureBone("leftUpperLeg"));
        if (to.norm() > 0.0) facesTo_ = to.cross(Vec3::UnitY()).normalized();
        if (!(from.norm() > 0.0) || !(to.norm() > 0.0)) return;
        const double angle = std::atan2(from.cross(to).dot(Vec3::UnitY()), from.dot(to));
        if (std::abs(angle) > kOtherWay) facing_ = Turn(Eigen::AngleAxisd(angle, Vec3::UnitY()));
    }

    /// What turns each bone of the figure from its rest to the one that its counterpart rests in.
    void align() {
        for (std::size_t b = 0; b < figure_.bones.size(); ++b) {
            const int parent = figure_.bones[b].parent;
            const std::string& role = figureRoles_[b];
            if (sourceOf_[b] < 0) {
                turned_[b] = parent < 0 ? Turn::Identity() : turned_[static_cast<std::size_t>(parent)];
                continue;
            }
            if (const auto next = pointingRoles().find(role); next != pointingRoles().end()) {
                const int own = figureBone(next->second), other = sourceBone(next->second);
                if (own >= 0 && other >= 0) turned_[b] = between(figureHead(own) - figure_.bones[b].head, sourceHead(other) - sourceHead(sourceOf_[b]));
                continue;
            }
            if (isOfHand(role)) {
                turned_[b] = parent < 0 ? Turn::Identity() : turned_[static_cast<std::size_t>(parent)];
                continue;
            }
            if (!role.empty()) continue;  // trunk, head and feet stand alike in all rest poses
            // Tails, ears and what no human has: towards the only child that has a counterpart too.
            int child = -1, children = 0;
            for (std::size_t c = b + 1; c < figure_.bones.size(); ++c)
                if (figure_.bones[c].parent == static_cast<int>(b) && sourceOf_[c] >= 0 && figureRoles_[c].empty()) {
                    child = static_cast<int>(c);
                    ++children;
                }
            if (children == 1)
                turned_[b] = between(figureHead(child) - figure_.bones[b].head, sourceHead(sourceOf_[static_cast<std::size_t>(child)]) - sourceHead(sourceOf_[b]));
            else if (parent >= 0 && figureRoles_[static_cast<std::size_t>(parent)].empty())
                turned_[b] = turned_[static_cast<std::size_t>(parent)];
        }
    }
    static Turn between(const Vec3& from, const Vec3& to) { return from.norm() > 0.0 && to.norm() > 0.0 ? shortestRotation(from, to) : Turn::Identity(); }

    void sample() {
        const double frames = std::clamp(kMostNumbers / (5.0 * static_cast<double>(out_.followed.size() + 1)), 2.0, 1e5), rate = clip_.seconds > 0.0 ? std::min(kFramesPerSecond, frames / clip_.seconds) : kFramesPerSecond;
        const auto last = static_cast<std::size_t>(std::floor(clip_.seconds * rate + 1e-6));
        for (std::size_t f = 0; f <= last; ++f) times_.push_back(static_cast<double>(f) / rate);
        if (clip_.seconds - times_.back() > 1e-3 / rate) times_.push_back(clip_.seconds);
        for (const double time : times_) {
            poses_.push_back(posedRig(source_, clip_, time));
            for (RigPose& pose : poses_.back()) pose = {facing_ * pose.head, (facing_ * pose.rotation).normalized()};
        }
    }

    /// Only what turns by itself is missed: below a bone that is followed, others go along.
    void tellLost() {
        std::vector<char> followed(source_.bones.size(), 0);
        for (const auto& [from, to] : out_.followed) followed[static_cast<std::size_t>(from)] = 1;
        for (std::size_t b = 0; b < source_.bones.size(); ++b) {
            if (followed[b]) continue;
            const int parent = source_.bones[b].parent;
            const auto local = [&](std::size_t f) { return parent < 0 ? poses_[f][b].rotation : poses_[f][static_cast<std::size_t>(parent)].rotation.conjugate() * poses_[f][b].rotation; };
            const Turn first = local(0);
            for (std::size_t f = 1; f < times_.size(); ++f)
                if (local(f).angularDistance(first) > kMoves) {
                    out_.lost.push_back(source_.bones[b].name);
                    break;
                }
        }
    }

    /// Lengths of the figure over those of the clip's skeleton: of the legs, else of what corresponds.
    void scale() {
        double own = 0.0, other = 0.0;
        for (const LegRoles& leg : kLegs) {
            const std::array<int, 3> a = {figureBone(leg.upper), figureBone(leg.lower), figureBone(leg.foot)}, s = {sourceBone(leg.upper), sourceBone(leg.lower), sourceBone(leg.foot)};
            if (std::min({a[0], a[1], a[2], s[0], s[1], s[2]}) < 0) continue;
            own += (figureHead(a[1]) - figureHead(a[0])).norm() + (figureHead(a[2]) - figureHead(a[1])).norm();
            other += (sourceHead(s[1]) - sourceHead(s[0])).norm() + (sourceHead(s[2]) - sourceHead(s[1])).norm();
        }
        if (own == 0.0 || other == 0.0) {
            own = other = 0.0;
            for (const auto& [from, to] : out_.followed) {
                own = std::max(own, (figureHead(to) - figureHead(out_.followed.front().second)).norm());
                other = std::max(other, (sourceHead(from) - sourceHead(out_.followed.front().first)).norm());
            }
        }
        if (own > 0.0 && other > 0.0 && std::isfinite(own / other)) scale_ = own / other;
    }

    struct Leg {
        int upper, lower, foot;    ///< of the figure
        std::vector<Vec3> goal;    ///< per frame: where its ankle belongs
        std::vector<double> hold;  ///< per frame, 0 ... 1: how much it stays there
    };

    /// Where feet of the clip stand.
    void stand() {
        for (const LegRoles& names : kLegs) {
            Leg leg{figureBone(names.upper), figureBone(names.lower), figureBone(names.foot), {}, {}};
            if (leg.upper < 0 || leg.lower < 0 || leg.foot < 0) continue;
            const int upper = sourceOf_[static_cast<std::size_t>(leg.upper)], lower = sourceOf_[static_cast<std::size_t>(leg.lower)], foot = sourceOf_[static_cast<std::size_t>(leg.foot)];
            if (upper < 0 || lower < 0 || foot < 0) continue;
            const double length = (sourceHead(lower) - sourceHead(upper)).norm() + (sourceHead(foot) - sourceHead(lower)).norm();
            const auto at = [&](std::size_t f) -> const Vec3& { return poses_[f][static_cast<std::size_t>(foot)].head; };
            double lowest = at(0).y();
            for (std::size_t f = 0; f < times_.size(); ++f) lowest = std::min(lowest, at(f).y());
            std::vector<std::size_t> standing;
            for (std::size_t f = 0; f < times_.size(); ++f) {
                const std::size_t a = f > 0 ? f - 1 : 0, b = std::min(f + 1, times_.size() - 1);
                const double seconds = times_[b] - times_[a], speed = seconds > 0.0 ? (at(b) - at(a)).norm() / seconds : 0.0;
                if (at(f).y() - lowest < kStands * length && speed < kStandsStill * length) standing.push_back(f);
                leg.goal.push_back(figureHead(leg.foot) + scale_ * (at(f) - sourceHead(foot)));
            }
            leg.hold.assign(times_.size(), 0.0);
            for (std::size_t f = 0; f < times_.size(); ++f) {
                const auto next = std::lower_bound(standing.begin(), standing.end(), f);
                double away = kBlend;
                if (next != standing.end()) away = std::min(away, times_[*next] - times_[f]);
                if (next != standing.begin()) away = std::min(away, times_[f] - times_[*std::prev(next)]);
                leg.hold[f] = 1.0 - away / kBlend;
            }
            out_.feet = out_.feet || !standing.empty();
            legs_.push_back(std::move(leg));
        }
    }

    [[nodiscard]] bool isRoot(std::size_t bone) const {
        for (int b = figure_.bones[bone].parent; b >= 0; b = figure_.bones[static_cast<std::size_t>(b)].parent)
            if (sourceOf_[static_cast<std::size_t>(b)] >= 0) return false;
        return true;
    }

    /// The nodes of the figure where bones have the world rotations `turns`, and roots the places of the clip.
    struct Posed {
        std::vector<RigNode> local;
        std::vector<Matrix> global;
    };
    [[nodiscard]] Posed pose(std::size_t frame, const std::vector<Turn>& turns) const {
        Posed posed{figure_.nodes, std::vector<Matrix>(figure_.nodes.size())};
        for (std::size_t n = 0; n < figure_.nodes.size(); ++n) {
            RigNode& node = posed.local[n];
            const Matrix& above = node.parent < 0 ? figure_.toScene : posed.global[static_cast<std::size_t>(node.parent)];
            if (const int b = boneAt_[n]; b >= 0 && sourceOf_[static_cast<std::size_t>(b)] >= 0) {
                node.rotation = (nearestRotation(above.topLeftCorner<3, 3>()).conjugate() * turns[static_cast<std::size_t>(b)]).normalized();
                if (roots_[static_cast<std::size_t>(b)] && std::abs(above.topLeftCorner<3, 3>().determinant()) > 1e-30) {
                    const int s = sourceOf_[static_cast<std::size_t>(b)];
                    const Vec3 to = figureHead(b) + scale_ * (poses_[frame][static_cast<std::size_t>(s)].head - sourceHead(s));
                    node.translation = above.topLeftCorner<3, 3>().inverse() * (to - above.topRightCorner<3, 1>());
                }
            }
            Matrix own = Matrix::Identity();
            own.topLeftCorner<3, 3>() = node.rotation.toRotationMatrix() * node.scale.asDiagonal();
            own.topRightCorner<3, 1>() = node.translation;
            posed.global[n] = above * own;
        }
        return posed;
    }
    [[nodiscard]] Vec3 headIn(const Posed& posed, int bone) const { return posed.global[static_cast<std::size_t>(figure_.bones[static_cast<std::size_t>(bone)].node)].topRightCorner<3, 1>(); }

    /// Turns a leg so that its ankle comes to `goal`, as near as it reaches, and its knee stays on its side.
    void bend(const Leg& leg, const Posed& posed, const Vec3& goal, std::vector<Turn>& turns) const {
        const Vec3 hip = headIn(posed, leg.upper), knee = headIn(posed, leg.lower), ankle = headIn(posed, leg.foot);
        const double a = (knee - hip).norm(), b = (ankle - knee).norm();
        if (!(a > 0.0) || !(b > 0.0)) return;
        const double far = std::clamp((goal - hip).norm(), std::abs(a - b) + 1e-9 * a, (a + b) * (1.0 - 1e-9));
        Vec3 axis = (knee - hip).cross(ankle - knee);
        if (axis.norm() < 1e-6 * a * b) axis = facesTo_.cross(ankle - hip);  // a straight leg bends its knee forward
        if (axis.norm() < 1e-12 * a * b) return;
        axis.normalize();
        const auto angle = [](double next, double other, double opposite) { return std::acos(std::clamp((next * next + other * other - opposite * opposite) / (2.0 * next * other), -1.0, 1.0)); };
        // Within the plane of the leg, seen along the axis, shin and thigh turn against each other.
        const double inside = std::numbers::pi - std::atan2((knee - hip).cross(ankle - knee).dot(axis), (knee - hip).dot(ankle - knee));
        const Turn atKnee(Eigen::AngleAxisd(inside - angle(a, b, far), axis));
        const Vec3 reached = knee + atKnee * (ankle - knee);
        const Turn atHip = between(reached - hip, goal - hip);
        turns[static_cast<std::size_t>(leg.upper)] = (atHip * turns[static_cast<std::size_t>(leg.upper)]).normalized();
        turns[static_cast<std::size_t>(leg.lower)] = (atHip * atKnee * turns[static_cast<std::size_t>(leg.lower)]).normalized();
    }

    void write() {
        boneAt_.assign(figure_.nodes.size(), -1);
        for (std::size_t b = 0; b < figure_.bones.size(); ++b) boneAt_[static_cast<std::size_t>(figure_.bones[b].node)] = static_cast<int>(b);
        for (std::size_t b = 0; b < figure_.bones.size(); ++b) roots_.push_back(sourceOf_[b] >= 0 && isRoot(b));
        std::vector<RigTrack> turns(figure_.bones.size()), places(figure_.bones.size());
        for (std::size_t f = 0; f < times_.size(); ++f) {
            std::vector<Turn> wanted(figure_.bones.size(), Turn::Identity());
            for (const auto& [from, to] : out_.followed) {
                const auto s = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
                wanted[b] = (poses_[f][s].rotation * (facing_ * source_.bones[s].rotation).conjugate() * turned_[b] * figure_.bones[b].rotation).normalized();
            }
            Posed posed = pose(f, wanted);
            bool held = false;
            for (const Leg& leg : legs_) {
                if (!(leg.hold[f] > 0.0)) continue;
                const Vec3 free = headIn(posed, leg.foot);
                bend(leg, posed, free + leg.hold[f] * (leg.goal[f] - free), wanted);
                held = true;
            }
            if (held) posed = pose(f, wanted);
            for (const auto& [from, to] : out_.followed) {
                const RigNode& node = posed.local[static_cast<std::size_t>(figure_.bones[static_cast<std::size_t>(to)].node)];
                const auto b = static_cast<std::size_t>(to);
                Eigen::Vector4d q = node.rotation.coeffs();
                if (auto& values = turns[b].values; values.size() >= 4 && Eigen::Map<const Eigen::Vector4d>(values.data() + values.size() - 4).dot(q) < 0.0) q = -q;
                turns[b].values.insert(turns[b].values.end(), q.data(), q.data() + 4);
                if (roots_[b]) places[b].values.insert(places[b].values.end(), node.translation.data(), node.translation.data() + 3);
            }
        }
        for (const auto& [from, to] : out_.followed) {
            const auto b = static_cast<std::size_t>(to);
            turns[b] = {figure_.bones[b].node, RigTrack::Path::Rotation, RigTrack::Interpolation::Linear, times_, std::move(turns[b].values)};
            out_.clip.tracks.push_back(std::move(turns[b]));
            if (roots_[b]) out_.clip.tracks.push_back({figure_.bones[b].node, RigTrack::Path::Translation, RigTrack::Interpolation::Linear, times_, std::move(places[b].values)});
        }
        out_.clip.seconds = std::max(out_.clip.seconds, times_.back());
    }

    const Rig& source_;
    const RigClip& clip_;
    const Rig& figure_;
    std::vector<std::string> sourceRoles_, figureRoles_;
    std::vector<int> sourceOf_;   // per bone of the figure, -1: none
    std::vector<Turn> turned_;    // per bone of the figure
    Turn facing_ = Turn::Identity();
    Vec3 facesTo_ = Vec3::UnitZ();  // of the figure
    double scale_ = 1.0;
    std::vector<double> times_;
    std::vector<std::vector<RigPose>> poses_;  // per frame, turned as the figure looks
    std::vector<Leg> legs_;
    std::vector<int> boneAt_;     // per node of the figure
    std::vector<char> roots_;     // per bone of the figure: nothing above it is followed
    RetargetedClip out_;
};

}  // namespace

RetargetedClip retarget(const Rig& source, const RigClip& clip, const Rig& figure) { return Retarget(source, clip, figure).made(); }

}  // namespace imomushi
