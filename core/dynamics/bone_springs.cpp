// SPDX-License-Identifier: GPL-3.0-or-later
// Bend angles are measured in space: a parent carries its child by the rotation of least angle from the parent's kinematic direction to its present one.
// The energy is thus a function of the joint points alone, without history.
#include "core/dynamics/bone_springs.h"

#include <algorithm>
#include <cmath>

#include "core/dynamics/bone_dynamics.h"

namespace imomushi {

using Eigen::Matrix3d;

namespace {

// Of a bone's kinematic length: a shorter one has no direction. The potential keeps bones far longer.
constexpr double kCollapsedSpring = 1e-2;
// 1 + cosine of the angle to the kinematic direction: below it the rotation of least angle is not unique.
constexpr double kOpposite = 1e-6;
// The same where Newton's matrix is assembled, as the exact stiffness is unbounded there.
constexpr double kNearlyOpposite = 1e-2;
// A spring beyond the stretch limits of a bone, stiff enough to look rigid.
constexpr double kLimitHertz = 20.0;
constexpr double kLimitDamping = 0.5;
// The same beyond bend and twist limits, and of bones that are held as they point: a swing of 5 rad/s goes less than a degree beyond.
constexpr double kTurnLimitHertz = 60.0;

Matrix3d cross(const Vec3& a) {
    Matrix3d m;
    m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return m;
}

// b, rotated by the rotation of least angle from a to u (unit vectors).
Vec3 turned(const Vec3& a, const Vec3& u, const Vec3& b) {
    const Vec3 v = a.cross(u);
    const Vec3 across = v.cross(b);
    return (b + across + v.cross(across) / std::max(1.0 + a.dot(u), kOpposite)).normalized();
}

double angleBetween(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// Reduced mass (or inertia) of two parts that oscillate against each other. A part with held points stands still, unless both have some.
double reducedMass(double one, bool oneHeld, double other, bool otherHeld) {
    if (oneHeld != otherHeld) return oneHeld ? other : one;
    if (one <= 0.0 || other <= 0.0) return std::max({one, other, 0.0});
    return one / (one + other) * other;
}

}  // namespace

BoneSprings::BoneSprings(const Skeleton& skeleton, const std::vector<double>& mass)
    : skeleton_(skeleton), tree_(boneTree(skeleton)), mass_(mass) {
    const int points = static_cast<int>(skeleton.points.size()), bones = static_cast<int>(skeleton.bones.size());
    std::vector<std::vector<int>> at(points);
    for (int b = 0; b < bones; ++b) {
        const auto& bone = skeleton.bones[b];
        at[bone.start].push_back(b);
        at[bone.end].push_back(b);
        pairs_.emplace_back(bone.start, bone.end);
        rollArm_ += 0.2 * bone.length / bones;
    }
    above_.assign(points, -1), aboveBone_.assign(points, -1), root_.assign(points, -1);
    for (int r = 0; r < points; ++r) {
        if (root_[r] >= 0) continue;
        root_[r] = r;
        order_.push_back(r);
        for (std::size_t next = order_.size() - 1; next < order_.size(); ++next) {
            const int i = order_[next];
            for (const int b : at[i]) {
                const int j = skeleton.bones[b].start + skeleton.bones[b].end - i;
                if (root_[j] >= 0) continue;
                root_[j] = r;
                above_[j] = i;
                aboveBone_[j] = b;
                order_.push_back(j);
            }
        }
    }

    for (int b = 0; b < bones; ++b) {
        const auto& bone = skeleton.bones[b];
        for (const int hinge : {bone.start, bone.end}) {
            Bend bend;
            bend.child = b;
            bend.hinge = hinge;
            bend.add(bone.start, 0, -1), bend.add(bone.end, 0, 1);
            bends_.push_back(bend);
        }
        if (tree_.parent[b] < 0) continue;
        Bend bend;
        bend.parent = tree_.parent[b];
        bend.child = b;
        const auto& parent = skeleton.bones[bend.parent];
        for (const int p : {bone.start, bone.end})
            if (p == parent.start || p == parent.end) bend.hinge = p;
        bend.add(parent.start, -1, 0), bend.add(parent.end, 1, 0), bend.add(bone.start, 0, -1), bend.add(bone.end, 0, 1);
        for (int i = 0; i < bend.count; ++i)
            for (int j = 0; j < i; ++j) pairs_.emplace_back(bend.point[i], bend.point[j]);
        bends_.push_back(bend);
        if (bone.limitsBend()) stops_.push_back(bend);
    }
    stretch_.resize(bones), twistStop_.resize(bones), limit_.resize(bones), roll_.resize(bones), arms_.resize(bones);
    return_.resize(points), below_.resize(points);
    rollDiagonal_.resize(points), rollBelow_.resize(points);
}

BoneSprings::MassMoments BoneSprings::beyond(int from, int to) const {
    if (above_[to] == from) return below_[to];
    MassMoments side = below_[root_[from]];
    const MassMoments& cut = below_[from];
    side.mass -= cut.mass;
    side.first -= cut.first;
    side.second -= cut.second;
    side.held -= cut.held;
    return side;
}

void BoneSprings::calibrate(std::span<const BoneSpring> springs, double returnHertz, double airDamping, const std::vector<char>& held, const std::vector<char>& pointing) {
    const auto place = [&](int i) -> Vec3 { return skeleton_.points[i] - skeleton_.points[root_[i]]; };
    for (const int i : order_) {
        below_[i] = MassMoments{};
        if (held[i]) {
            below_[i].held = 1;
            continue;
        }
        below_[i] = {mass_[i], mass_[i] * place(i).squaredNorm(), mass_[i] * place(i), 0};
    }
    for (auto i = order_.rbegin(); i != order_.rend(); ++i) {
        if (above_[*i] < 0) continue;
        MassMoments& sum = below_[above_[*i]];
        const MassMoments& part = below_[*i];
        sum.mass += part.mass;
        sum.second += part.second;
        sum.first += part.first;
        sum.held += part.held;
    }
    // About the point `about`; differences of sums cancel: no less than that of the neighbour `next`.
    const auto inertia = [&](const MassMoments& side, int about, int next) {
        const Vec3 p = place(about);
        const double least = held[next] ? 0.0 : mass_[next] * (skeleton_.points[next] - skeleton_.points[about]).squaredNorm();
        return std::max(side.second - 2.0 * p.dot(side.first) + side.mass * p.squaredNorm(), least);
    };
    const auto springDamper = [](double mass, double hertz, double ratio) -> SpringDamper {
        const double omega = 2.0 * M_PI * hertz;
        return {mass * omega * omega, 2.0 * ratio * mass * omega};
    };
    const auto springOf = [&](int bone) -> const BoneSpring& { return springs[springs.size() > 1 ? bone : 0]; };

    for (std::size_t b = 0; b < stretch_.size(); ++b) {
        const auto& bone = skeleton_.bones[b];
        const BoneSpring& spring = springOf(static_cast<int>(b));
        const MassMoments one = beyond(bone.start, bone.end), other = beyond(bone.end, bone.start);
        // Differences of sums cancel: no less than what the bone's own points give.
        const double least = std::min(held[bone.start] ? mass_[bone.end] : mass_[bone.start], held[bone.end] ? mass_[bone.start] : mass_[bone.end]);
        const double mass = std::max(reducedMass(one.mass, one.held > 0, other.mass, other.held > 0), 0.5 * least);
        const double stiffer = std::sqrt(bone.stiffness);
        stretch_[b] = springDamper(mass, stiffer * spring.stretchHertz, spring.stretchDamping);
        limit_[b] = springDamper(mass, kLimitHertz, kLimitDamping);
        roll_[b] = springDamper(mass * rollArm_ * rollArm_, stiffer * spring.rollHertz, spring.rollDamping);
        if (bone.limitsTwist()) twistStop_[b] = springDamper(mass * rollArm_ * rollArm_, kTurnLimitHertz, kLimitDamping);
    }
    for (auto& bend : bends_) {
        const auto& bone = skeleton_.bones[bend.child];
        const BoneSpring& spring = springOf(bend.child);
        double mass = 0.0;
        if (bend.hinge >= 0) {
            const int far = bone.start + bone.end - bend.hinge;
            const MassMoments child = beyond(bend.hinge, far);
            const double childInertia = inertia(child, bend.hinge, far);
            if (bend.parent < 0) {
                bend.active = held[bend.hinge] && !held[far];
                mass = childInertia;
            } else {
                bend.active = !held[bend.hinge];
                const auto& parent = skeleton_.bones[bend.parent];
                const int near = parent.start + parent.end - bend.hinge;
                MassMoments rest = below_[root_[bend.hinge]];
                rest.mass -= child.mass;
                rest.second -= child.second;
                rest.first -= child.first;
                rest.held -= child.held;
                mass = reducedMass(childInertia, child.held > 0, inertia(rest, bend.hinge, near), rest.held > 0);
            }
        } else {  // bones that do not touch: two trees, joined by this angle only
            const auto& parent = skeleton_.bones[bend.parent];
            bend.active = true;
            const MassMoments& one = below_[root_[bone.start]];
            const MassMoments& other = below_[root_[parent.end]];
            mass = reducedMass(inertia(one, bone.start, bone.end), one.held > 0, inertia(other, parent.end, parent.start), other.held > 0);
        }
        bend.spring = springDamper(mass, std::sqrt(bone.stiffness) * spring.bendHertz, spring.bendDamping);
        if (bend.parent < 0 && pointing[bend.child]) bend.spring = springDamper(mass, kTurnLimitHertz, kLimitDamping);
        if (bend.parent < 0 || !bone.limitsBend()) continue;
        for (Bend& stop : stops_)
            if (stop.child == bend.child) stop.spring = springDamper(mass, kTurnLimitHertz, kLimitDamping);
    }
    for (std::size_t i = 0; i < return_.size(); ++i)
        return_[i] = below_[root_[i]].held > 0 ? SpringDamper{0.0, airDamping * mass_[i]} : springDamper(mass_[i], returnHertz, 1.0);
}

void BoneSprings::arms(const std::vector<Vec3>& x, const BoneTargets& targets) const {
    for (std::size_t b = 0; b < arms_.size(); ++b) {
        const Vec3 along = x[skeleton_.bones[b].end] - x[skeleton_.bones[b].start];
        const double length = along.norm();
        Arm& arm = arms_[b];
        arm.length = std::max(length, kCollapsedSpring * targets.length[b]);
        arm.direction = length > kCollapsedSpring * targets.length[b] ? Vec3(along / length) : targets.direction[b];
    }
}

// The child's kinematic direction as the parent carries it: unit.
Vec3 BoneSprings::carried(const Bend& bend, const BoneTargets& targets) const {
    if (bend.parent < 0) return targets.direction[bend.child];
    return turned(targets.direction[bend.parent], arms_[bend.parent].direction, targets.direction[bend.child]);
}

// The same of its direction at rest.
Vec3 BoneSprings::carriedUnbent(const Bend& bend, const BoneTargets& targets) const {
    return turned(targets.direction[bend.parent], arms_[bend.parent].direction, targets.unbent[bend.child]);
}

// The spring beyond the stretch limits, which give way to the kinematic length. Linear beyond the upper limit; below the lower one the potential of a bone
// again, which no finite force collapses.
BoneSprings::Limit BoneSprings::limit(std::size_t b, const BoneTargets& targets) const {
    const auto& bone = skeleton_.bones[b];
    const double length = arms_[b].length, k = limit_[b].stiffness;
    const double most = std::max(bone.maxStretch * bone.length, targets.length[b]);
    if (length > most) return {0.5 * k * (length - most) * (length - most), k * (length - most), k, limit_[b].damping};
    const double least = std::min(bone.minStretch * bone.length, targets.length[b]);
    if (length >= least) return {};
    const double r = length / least, r3 = 1.0 / (r * r * r);
    return {0.125 * k * least * least * (r - 1.0 / r) * (r - 1.0 / r), 0.25 * k * least * (r - r3), 0.25 * k * (1.0 + 3.0 * r3 / r), limit_[b].damping};
}

double BoneSprings::energy(const std::vector<Vec3>& x, const BoneTargets& targets) const {
    arms(x, targets);
    double sum = 0.0;
    for (std::size_t b = 0; b < arms_.size(); ++b) {
        const double length = targets.length[b], r = arms_[b].length / length;
        const double strain = 0.5 * (r - 1.0 / r) * length;
        sum += 0.5 * stretch_[b].stiffness * strain * strain + limit(b, targets).energy;
    }
    for (const auto& bend : bends_) {
        if (!bend.active) continue;
        const double angle = angleBetween(carried(bend, targets), arms_[bend.child].direction);
        sum += 0.5 * bend.spring.stiffness * angle * angle;
    }
    for (const auto& stop : stops_) {
        const double beyond = std::max(angleBetween(carriedUnbent(stop, targets), arms_[stop.child].direction) - skeleton_.bones[stop.child].maxBend, 0.0);
        sum += 0.5 * stop.spring.stiffness * beyond * beyond;
    }
    for (std::size_t i = 0; i < return_.size(); ++i)
        if (return_[i].stiffness > 0.0) sum += 0.5 * return_[i].stiffness * (x[i] - targets.points[i]).squaredNorm();
    return sum;
}

void BoneSprings::add(BlockCholesky<3>& system, int i, int j, const Matrix3d& block, const std::vector<Freedom>& freedom, const Vec3& normal) const {
    if (freedom[i] == Freedom::Fixed || freedom[j] == Freedom::Fixed) return;
    if (freedom[i] == Freedom::Free && freedom[j] == Freedom::Free) return system.add(i, j, block);
    Matrix3d within = block;
    if (freedom[i] == Freedom::OnPlane) within -= normal * (normal.transpose() * within);
    if (freedom[j] == Freedom::OnPlane) within -= (within * normal).eval() * normal.transpose();
    system.add(i, j, within);
}

void BoneSprings::addBend(const Bend& bend, const Vec3& t, double least, const Vec3& drift, const Step& step) {
    const auto& [v, force, system, seconds, freedom, normal] = step;
    const Arm& child = arms_[bend.child];
    const Vec3& u = child.direction;
    const Vec3 tu = t.cross(u);
    const double sine = tu.norm(), angle = std::atan2(sine, t.dot(u)) - least;
    if (angle < 0.0) return;
    const Vec3 axis = sine > 1e-12 ? Vec3(tu / sine) : Vec3(Vec3::Zero());
    const auto& bone = skeleton_.bones[bend.child];
    Vec3 turning = child.rotation * (v[bone.end] - v[bone.start]);
    const Arm* parent = bend.parent < 0 ? nullptr : &arms_[bend.parent];
    if (parent) {
        const auto& p = skeleton_.bones[bend.parent];
        turning -= parent->carries * (v[p.end] - v[p.start]);
    }
    turning -= drift;
    turning -= u * u.dot(turning);
    const Vec3 torque = -(bend.spring.stiffness * angle * axis + bend.spring.damping * turning);
    const Vec3 onChild = child.rotation.transpose() * torque;
    Vec3 onParent = Vec3::Zero();
    if (parent) onParent = -(parent->carries.transpose() * torque);
    for (int i = 0; i < bend.count; ++i) force[bend.point[i]] += bend.onChild[i] * onChild + bend.onParent[i] * onParent;
    if (!system) return;
    const Matrix3d eye = Matrix3d::Identity();
    // The Hessian of k angle^2 / 2 is k about the bend axis and k angle / tan(angle) across it, negative beyond a right angle and set to zero there.
    const double acrossShare = sine > 1e-6 ? std::max(angle * t.dot(u) / sine, 0.0) : (t.dot(u) > 0.0 ? 1.0 : 0.0);
    const Matrix3d w = (bend.spring.stiffness * acrossShare + bend.spring.damping / seconds) * (eye - u * u.transpose()) +
                       bend.spring.stiffness * (1.0 - acrossShare) * axis * axis.transpose();
    const Matrix3d wc = w * child.rotation;
    const Matrix3d cc = child.rotation.transpose() * wc;
    Matrix3d pp = Matrix3d::Zero(), pc = pp;
    if (parent) {
        pp.noalias() = parent->carriesAbout.transpose() * (w * parent->carriesAbout);
        pc.noalias() = -parent->carriesAbout.transpose() * wc;
    }
    for (int i = 0; i < bend.count; ++i)
        for (int j = 0; j <= i; ++j) {
            const double ci = bend.onChild[i], cj = bend.onChild[j], pi = bend.onParent[i], pj = bend.onParent[j];
            const Matrix3d block = ci * cj * cc + pi * pj * pp + pi * cj * pc + ci * pj * pc.transpose();
            add(*system, bend.point[i], bend.point[j], block, freedom, normal);
        }
}

void BoneSprings::forces(const std::vector<Vec3>& x, const std::vector<Vec3>& v, const BoneTargets& targets, const Motion& motion,
                         std::vector<Vec3>& force, BlockCholesky<3>* system, double seconds, const std::vector<Freedom>& freedom, const Vec3& normal) {
    const Matrix3d eye = Matrix3d::Identity();
    arms(x, targets);
    for (std::size_t b = 0; b < arms_.size(); ++b) {
        const auto& bone = skeleton_.bones[b];
        Arm& arm = arms_[b];
        const Vec3& u = arm.direction;
        const Matrix3d c = cross(u);
        arm.rotation = c / arm.length;
        const Vec3& from = targets.direction[b];
        const Vec3 across = from.cross(u);
        const double open = 1.0 + from.dot(u);
        arm.carries = (c - u * (across / std::max(open, kOpposite)).transpose()) / arm.length;
        arm.carriesAbout = open < kNearlyOpposite ? Matrix3d((c - u * (across / kNearlyOpposite).transpose()) / arm.length) : arm.carries;

        const double length = targets.length[b], r = arm.length / length, r3 = 1.0 / (r * r * r);
        const Limit stop = limit(b, targets);
        const double k = 0.25 * stretch_[b].stiffness, d = stretch_[b].damping + stop.damping;
        double rate = (v[bone.end] - v[bone.start]).dot(u);
        if (motion.from) rate -= (motion.to->length[b] - motion.from->length[b]) / motion.seconds;
        const double spring = k * length * (r - r3) + stop.force;
        const Vec3 pull = (spring + d * rate) * u;
        force[bone.start] += pull;
        force[bone.end] -= pull;
        if (!system) continue;
        const Matrix3d along = u * u.transpose();
        const Matrix3d h = (k * (1.0 + 3.0 * r3 / r) + stop.stiffness + d / seconds) * along + std::max(spring, 0.0) / arm.length * (eye - along);
        add(*system, bone.start, bone.start, h, freedom, normal);
        add(*system, bone.end, bone.end, h, freedom, normal);
        add(*system, bone.start, bone.end, -h, freedom, normal);
    }
    const Step step{v, force, system, seconds, freedom, normal};
    for (const auto& bend : bends_) {
        if (!bend.active) continue;
        const Vec3 drift = motion.from ? Vec3(carried(bend, *motion.from).cross(carried(bend, *motion.to)) / motion.seconds) : Vec3(Vec3::Zero());
        addBend(bend, carried(bend, targets), 0.0, drift, step);
    }
    for (const auto& stop : stops_) addBend(stop, carriedUnbent(stop, targets), skeleton_.bones[stop.child].maxBend, Vec3::Zero(), step);
    for (std::size_t i = 0; i < return_.size(); ++i) {
        const SpringDamper& g = return_[i];
        if (g.stiffness <= 0.0 && g.damping <= 0.0) continue;
        Vec3 rate = v[i];
        if (motion.from) rate -= (motion.to->points[i] - motion.from->points[i]) / motion.seconds;
        force[i] -= g.stiffness * (x[i] - targets.points[i]) + g.damping * rate;
        const int at = static_cast<int>(i);
        if (system) add(*system, at, at, (g.stiffness + g.damping / seconds) * eye, freedom, normal);
    }
}

void BoneSprings::solveRoll(const BoneTargets& targets, const Motion& motion, double seconds, const std::vector<double>& predicted,
                            const std::vector<double>& predictedRate, const std::vector<char>& held, std::vector<double>& roll) {
    const double s = 1.0 / seconds;
    const auto rate = [&](int i) { return motion.from ? (motion.to->roll[i] - motion.from->roll[i]) / motion.seconds : 0.0; };
    // Tridiagonal along each branch: Gaussian elimination from the leaves to the roots (Thomas algorithm on a tree). Rows of held points keep their roll.
    for (const int i : order_) {
        rollBelow_[i] = 0.0;
        rollDiagonal_[i] = 1.0;
        if (held[i]) continue;
        const double inertia = mass_[i] * rollArm_ * rollArm_;
        const SpringDamper& g = return_[i];
        const double stiffness = g.stiffness * rollArm_ * rollArm_, damping = g.damping * rollArm_ * rollArm_;
        rollDiagonal_[i] = inertia * s * s + damping * s + stiffness;
        roll[i] = inertia * (s * s * predicted[i] + s * predictedRate[i]) + damping * (s * predicted[i] + rate(i)) + stiffness * targets.roll[i];
    }
    for (const int i : order_) {
        const int p = above_[i];
        if (p < 0) continue;
        const SpringDamper& g = roll_[aboveBone_[i]];
        double weight = g.stiffness + g.damping * s;
        double pull = g.stiffness * (targets.roll[i] - targets.roll[p]) + g.damping * (s * (predicted[i] - predicted[p]) + rate(i) - rate(p));
        if (const SpringDamper& stop = twistStop_[aboveBone_[i]]; stop.stiffness > 0.0) {
            const double twist = predicted[i] - predicted[p], most = skeleton_.bones[aboveBone_[i]].maxTwist;
            const double ahead = twist + seconds * (predictedRate[i] - predictedRate[p]);
            if (std::abs(ahead) > most) {
                weight += stop.stiffness + stop.damping * s;
                pull += std::copysign(stop.stiffness * most, ahead) + stop.damping * s * twist;
            }
        }
        if (!held[i]) rollDiagonal_[i] += weight, roll[i] += pull;
        if (!held[p]) rollDiagonal_[p] += weight, roll[p] -= pull;
        if (!held[i] && !held[p]) rollBelow_[i] = -weight;
        if (held[i] && !held[p]) roll[p] += weight * roll[i];
        if (held[p] && !held[i]) roll[i] += weight * roll[p];
    }
    for (auto i = order_.rbegin(); i != order_.rend(); ++i) {
        const int p = above_[*i];
        if (p < 0 || rollBelow_[*i] == 0.0) continue;
        const double part = rollBelow_[*i] / rollDiagonal_[*i];
        rollDiagonal_[p] -= part * rollBelow_[*i];
        roll[p] -= part * roll[*i];
    }
    for (const int i : order_) {
        const int p = above_[i];
        if (held[i]) continue;
        if (p >= 0) roll[i] -= rollBelow_[i] * roll[p];
        roll[i] /= rollDiagonal_[i];
    }
}

}  // namespace imomushi
