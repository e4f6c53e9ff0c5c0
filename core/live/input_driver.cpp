// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/input_driver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/rotation_vector.h"
#include "core/document/command_support.h"
#include "core/document/morph_weights.h"
#include "core/document/names.h"
#include "core/live/direct_names.h"
#include "core/live/pose_parts.h"
#include "core/mesh/bounds.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

using Kind = MappedTarget::Kind;

/// Direct names tell places within this, m: what is farther is not meant, and numbers keep their digits.
constexpr double kFarthestDirect = 1e6;
constexpr double kLargestDirectAngle = 100.0;  // radians
/// Weights far beyond 1 shorten no bone to less than this part of its length at rest.
constexpr double kShortest = 0.05;

/// Which of Driven::slotNumbers a target is.
std::size_t slotOf(const MappedTarget& target) {
    switch (target.kind) {
        case Kind::HandlePlace:
        case Kind::EndPlace: return static_cast<std::size_t>(target.axis);
        case Kind::HandleTurn: return static_cast<std::size_t>(3 + target.axis);
        case Kind::EndRoll: return 3;
        default: return 0;
    }
}

/// A control that says the number itself, within these bounds, and not how far it is from `rest`.
ResponseCurve direct(double rest, double bound) {
    ResponseCurve curve;
    curve.inLow = -bound, curve.inHigh = bound;
    curve.outLow = -bound - rest, curve.outHigh = bound - rest;
    return curve;
}

/// The number of an effect within the bounds of its property.
double withinProperty(const LiveInput& input) {
    const EffectProperty& p = propertyOf(input).first;
    const double value = std::clamp(input.weight, p.low, p.high);
    return p.whole ? std::round(value) : value;
}

}  // namespace

struct InputDriver::Tables {
    const Document& document;
    const CharacterPlan& plan;
    BoneTree tree;
    Pose pose;  // of the document, or rest
    std::vector<Driven> driven;
    std::vector<Turned> turned;
    std::vector<Posed> posed;
    std::vector<std::size_t> keptOf;  // of each of posed, in the document
    std::vector<InputRow> rows;
    std::vector<int> rowOf;  // of each mapping
    std::vector<double> shown, rest;
    const bool solo = anySolo(document);  // of any row

    /// Null: the character has no such thing.
    Driven* find(const MappedTarget& target) {
        Driven made;
        LiveInput& input = made.input;
        if (target.kind == Kind::Morph) {
            input.kind = LiveInput::Kind::Morph;
            input.morph = target.morph;
            input.weight = morphWeight(document, *document.characters.at(target.morph.character), target.morph.target);
        } else if (target.kind == Kind::Effect) {
            input.kind = LiveInput::Kind::Effect;
            input.effect = target.effect;
            input.value = target.value;
            input.weight = document.effects[target.effect].values[static_cast<std::size_t>(target.value)];
        } else if (target.kind == Kind::HandlePlace || target.kind == Kind::HandleTurn) {
            input.kind = LiveInput::Kind::Handle;
            input.handle = plan.handleIndex(target.handle);
            if (input.handle < 0) return nullptr;
            input.target = made.rest = faceOf(document, target.handle).frame.origin;
            if (const auto goal = document.handleGoals.find(target.handle); goal != document.handleGoals.end() && goal->second.target.held) {
                input.target = goal->second.now().at;
                input.rotation = goal->second.now().rotation;
                made.turn = rotationVector(input.rotation);
            }
        } else {
            input.kind = LiveInput::Kind::End;
            const int point = plan.pointIndex(target.end);
            if (point < 0) return nullptr;
            // Ends of several bones may be the same point.
            input.end = std::find_if(plan.points.begin(), plan.points.end(), [&](const auto& end) { return end.second == point; })->first;
            made.rest = plan.input.skeleton.points[static_cast<std::size_t>(point)];
            input.target = pose.points[static_cast<std::size_t>(point)];
            for (const auto& [end, goal] : document.goals)
                if (plan.pointIndex(end) == point) {
                    input.target = goal.target;
                    input.roll = goal.roll.value_or(0.0);
                    input.hasRoll = goal.roll.has_value();
                }
        }
        const auto known = std::find_if(driven.begin(), driven.end(), [&](const Driven& d) { return d.input.sameTarget(input); });
        if (known != driven.end()) return &*known;
        return &driven.emplace_back(made);
    }

    [[nodiscard]] Eigen::Quaterniond wholeRotation(std::size_t bone) const {
        const auto end = static_cast<std::size_t>(plan.input.skeleton.bones[bone].end);
        return imomushi::wholeRotation(tree, bone, pose.frames[bone], pose.roll[end]);
    }

    /// Where its end is driven, too.
    Turned* findTurned(const MappedTarget& target) {
        const int index = plan.boneIndex(target.end.bone);
        const Driven* end = find(target);
        if (index < 0 || !end) return nullptr;
        const auto bone = static_cast<std::size_t>(index);
        const auto known = std::find_if(turned.begin(), turned.end(), [&](const Turned& t) { return t.bone == bone; });
        if (known != turned.end()) return &*known;
        const Skeleton& skeleton = plan.input.skeleton;
        const auto pointAt = [&](int point) { return skeleton.points[static_cast<std::size_t>(point)]; };
        Turned made;
        made.bone = bone;
        made.end = static_cast<std::size_t>(end - driven.data());
        made.startAt = pose.points[static_cast<std::size_t>(skeleton.bones[bone].start)];
        made.along = pointAt(skeleton.bones[bone].end) - pointAt(skeleton.bones[bone].start);
        made.rollSign = tree.rollSign[bone];
        if (const int parent = tree.parent[bone]; parent >= 0) {
            made.parentTurn = wholeRotation(static_cast<std::size_t>(parent));
            made.parentUntwisted = pose.frames[static_cast<std::size_t>(parent)].normalized();
            made.fromParent = pointAt(skeleton.bones[bone].start) - pointAt(skeleton.bones[static_cast<std::size_t>(parent)].start);
        }
        made.startNow = made.startAt;
        made.now = wholeRotation(bone);
        made.untwisted = pose.frames[bone].normalized();
        made.turn = made.base = rotationVector((made.parentTurn.conjugate() * made.now).normalized());
        return &turned.emplace_back(made);
    }

    /// Parents before children, with what they know of each other.
    void sortTurned() {
        std::ranges::sort(turned, {}, &Turned::bone);
        for (Turned& t : turned) {
            const auto parent = std::ranges::find_if(turned, [&](const Turned& p) { return static_cast<int>(p.bone) == tree.parent[t.bone]; });
            t.parent = parent == turned.end() ? -1 : static_cast<int>(parent - turned.begin());
            // The first of a chain starts where it does now: other bones would give way there.
            if (t.parent < 0) {
                MappedTarget place;
                place.kind = Kind::EndPlace;
                place.end = {plan.bones[t.bone], false};
                (void)find(place);
            }
            const int start = plan.input.skeleton.bones[t.bone].start;
            const auto at = std::ranges::find_if(driven, [&](const Driven& d) { return d.input.kind == LiveInput::Kind::End && plan.pointIndex(d.input.end) == start; });
            t.start = at == driven.end() ? -1 : static_cast<int>(at - driven.begin());
        }
    }

    /// A slot for the weight of a pose; placePoses() says what it is.
    int& slotOfPose(std::size_t kept) {
        const auto known = std::ranges::find(keptOf, kept);
        if (known != keptOf.end()) return posed[static_cast<std::size_t>(known - keptOf.begin())].slot;
        keptOf.push_back(kept);
        return posed.emplace_back().slot;
    }

    /// Each bone that a driven pose turns, with all that hang on it, what stands on its own, and how much of each pose is in what is shown. Answers what each pose does.
    std::vector<PoseParts> placePoses() {
        std::vector<PoseParts> parts;
        if (posed.empty()) return parts;
        for (const std::size_t of : keptOf) parts.push_back(partsOf(keptPoses(document)[of], document, plan, tree));
        const std::vector<double> weights = weightsIn(partsOf(poseOf(document, plan), document, plan, tree), parts, plan);
        std::vector<char> moves(plan.bones.size(), 0);
        const auto& bones = plan.input.skeleton.bones;
        const auto endOf = [&](int bone, bool atEnd) {
            MappedTarget target;
            target.kind = Kind::EndPlace;
            target.end = {plan.bones[static_cast<std::size_t>(bone)], atEnd};
            return target;
        };
        for (std::size_t p = 0; p < posed.size(); ++p) {
            shown[static_cast<std::size_t>(posed[p].slot)] = posed[p].before = weights[p];
            const auto thing = [&](const MappedTarget& target) -> Posed::OfThing* {
                Driven* found = find(target);
                if (!found) return nullptr;
                found->posed = true;
                return &posed[p].things.emplace_back(Posed::OfThing{static_cast<std::size_t>(found - driven.data()), Vec3::Zero(), Vec3::Zero(), 0.0});
            };
            for (const PoseParts::Bone& b : parts[p].bones) moves[static_cast<std::size_t>(b.bone)] = 1;
            for (const PoseParts::Root& r : parts[p].roots) {
                moves[static_cast<std::size_t>(r.bone)] = 1;
                if (auto* of = thing(endOf(r.bone, false))) of->by = r.by;
            }
            for (const PoseParts::Handle& h : parts[p].handles) {
                MappedTarget target;
                target.kind = Kind::HandlePlace;
                target.handle = plan.handles[static_cast<std::size_t>(h.handle)];
                if (auto* of = thing(target)) of->by = h.by, of->turn = h.turn;
            }
            for (const PoseParts::Morph& m : parts[p].morphs) {
                MappedTarget target;
                target.kind = Kind::Morph;
                target.morph = m.morph;
                if (auto* of = thing(target)) of->weight = m.more;
            }
        }
        for (std::size_t b = 0; b < moves.size(); ++b) {
            const int parent = tree.parent[b];
            moves[b] = moves[b] || (parent >= 0 && moves[static_cast<std::size_t>(parent)]);
            if (!moves[b]) continue;
            MappedTarget target = endOf(static_cast<int>(b), true);
            target.kind = Kind::BoneTurn;
            Turned* bone = findTurned(target);
            if (!bone) continue;
            bone->baseLength = (pose.points[static_cast<std::size_t>(bones[b].end)] - pose.points[static_cast<std::size_t>(bones[b].start)]).norm() / bones[b].length;
            const bool turnedByRow = std::ranges::any_of(bone->slotNumbers, [](int slot) { return slot >= 0; });
            bone->pinned = !turnedByRow && std::ranges::any_of(document.goals, [&](const auto& goal) { return goal.second.pinned && plan.pointIndex(goal.first) == bones[b].end; });
        }
        return parts;
    }

    /// After sortTurned().
    void addTurnsOfPoses(const std::vector<PoseParts>& parts) {
        for (std::size_t p = 0; p < posed.size(); ++p)
            for (const PoseParts::Bone& b : parts[p].bones) {
                const auto of = std::ranges::find(turned, static_cast<std::size_t>(b.bone), &Turned::bone);
                if (of != turned.end()) posed[p].bones.push_back({static_cast<std::size_t>(of - turned.begin()), b.turn, b.longer});
            }
    }

    void add(InputRow row, const MappedTarget& target) {
        if (target.kind == Kind::Pose) {
            int& slot = slotOfPose(target.pose);
            if (slot < 0) {
                slot = static_cast<int>(shown.size());
                shown.push_back(0.0);
                rest.push_back(0.0);
            }
            row.slot = slot;
            rows.push_back(std::move(row));
            return;
        }
        Driven* thing = find(target);
        if (!thing) return;
        Turned* bone = target.kind == Kind::BoneTurn ? findTurned(target) : nullptr;
        if (target.kind == Kind::BoneTurn && !bone) return;
        int& slot = bone ? bone->slotNumbers[static_cast<std::size_t>(target.axis)] : thing->slotNumbers[slotOf(target)];
        if (slot < 0) {
            slot = static_cast<int>(shown.size());
            const auto axis = static_cast<Eigen::Index>(target.axis);
            switch (target.kind) {
                case Kind::HandlePlace:
                case Kind::EndPlace: shown.push_back(thing->input.target[axis] - thing->rest[axis]); break;
                case Kind::HandleTurn: shown.push_back(thing->turn[axis]); break;
                case Kind::EndRoll: shown.push_back(thing->input.roll); break;
                case Kind::BoneTurn: shown.push_back(bone->turn[axis]); break;
                default: shown.push_back(thing->input.weight); break;
            }
            // An effect rests where it was before.
            rest.push_back(target.kind == Kind::Effect ? thing->input.weight : target.kind == Kind::Morph ? document.characters.at(target.morph.character)->model->morphs[static_cast<std::size_t>(target.morph.target)].atRest : 0.0);
        }
        row.slot = slot;
        rows.push_back(std::move(row));
    }

    double restOf(const MappedTarget& target) {
        const Driven* thing = target.kind == Kind::HandlePlace || target.kind == Kind::EndPlace ? find(target) : nullptr;
        return thing ? thing->rest[target.axis] : 0.0;
    }

    void addMappings() {
        if (!document.mappings) return;
        for (const InputMapping& mapping : *document.mappings) {
            rowOf.push_back(-1);
            const auto target = mappedTarget(document, mapping.target);
            if (!target || target->isTrigger()) continue;
            const InputRow row = heardRow(mapping, solo);
            const std::size_t before = rows.size();
            add(row, *target);
            if (rows.size() > before) rowOf.back() = static_cast<int>(before);
        }
        // Behind all others: who maps the other side means it.
        for (const InputMapping& mapping : *document.mappings) {
            if (!mapping.mirrored) continue;
            const auto target = mappedTarget(document, otherSideOfTarget(mapping.target));
            if (!target) continue;
            InputRow row = heardRow(mapping, solo);
            row.curve.outLow *= mirrorSign(*target);
            row.curve.outHigh *= mirrorSign(*target);
            add(row, *target);
        }
    }

    void addDirectNames(std::span<const std::string> sources) {
        if (sources.empty()) return;
        for (const DirectName& name : directNames(document))
            for (int i = 0; i < name.count; ++i) {
                const MappedTarget& target = name.targets[static_cast<std::size_t>(i)];
                InputRow row;
                row.channel = name.address;
                row.component = i;
                row.muted = solo;
                row.curve = target.kind == Kind::Morph || target.kind == Kind::Pose ? direct(0.0, kLargestMorphWeight) : target.kind == Kind::Effect ? direct(0.0, kFarthestDirect)
                            : target.kind == Kind::HandleTurn || target.kind == Kind::EndRoll ? direct(0.0, kLargestDirectAngle)
                                                                                              : direct(restOf(target), kFarthestDirect);
                for (const std::string& source : sources) {
                    row.source = source;
                    add(row, target);
                }
            }
    }
};

InputDriver::InputDriver(const Document& document, const CharacterPlan& plan, std::span<const std::string> oscSources)
    : InputDriver([&] {
          const Skeleton& skeleton = plan.input.skeleton;
          Tables tables{document, plan, boneTree(skeleton), fits(skeleton, document.pose) ? document.pose : restPose(skeleton), {}, {}, {}, {}, {}, {}, {}, {}};
          tables.addMappings();
          tables.addDirectNames(oscSources);
          const auto parts = tables.placePoses();
          tables.sortTurned();
          tables.addTurnsOfPoses(parts);
          for (Driven& driven : tables.driven) rebase(driven);
          return tables;
      }()) {}

InputDriver::InputDriver(Tables&& tables) : driven_(std::move(tables.driven)), turned_(std::move(tables.turned)), posed_(std::move(tables.posed)), rowOf_(std::move(tables.rowOf)), mapper_(std::move(tables.rows), tables.shown, tables.rest) { moved_.reserve(driven_.size()); }

std::span<const LiveInput> InputDriver::step(double seconds) {
    mapper_.step(seconds);
    moved_.clear();
    const auto moves = [this](const auto& slotNumbers) { return std::any_of(slotNumbers.begin(), slotNumbers.end(), [this](int slot) { return slot >= 0 && mapper_.moved(slot); }); };
    const bool posed = addPoses();
    const bool turns = posed || std::any_of(turned_.begin(), turned_.end(), [&](const Turned& t) { return moves(t.slotNumbers); });
    for (Driven& driven : driven_) {
        driven.moved = !driven.byHand && ((posed && driven.posed) || moves(driven.slotNumbers));
        if (!driven.moved) continue;
        LiveInput& input = driven.input;
        const auto put = [&](std::size_t slot, double& to, double rest, double base, double added) {
            if (driven.slotNumbers[slot] >= 0) to = rest + mapper_.shown(driven.slotNumbers[slot]) + added;
            else if (driven.posed) to = base + added;
        };
        if (input.isNumber()) {
            put(0, input.weight, 0.0, driven.base.weight, driven.addedWeight);
            if (input.kind == LiveInput::Kind::Effect) input.weight = withinProperty(input);
        } else {
            for (Eigen::Index k = 0; k < 3; ++k) put(static_cast<std::size_t>(k), input.target[k], driven.rest[k], driven.base.target[k], driven.added[k]);
            if (input.kind == LiveInput::Kind::End) {
                if (driven.slotNumbers[3] >= 0) input.roll = mapper_.shown(driven.slotNumbers[3]);
                input.hasRoll = input.hasRoll || (driven.slotNumbers[3] >= 0 && mapper_.winner(driven.slotNumbers[3]) >= 0);
            } else {
                for (Eigen::Index k = 0; k < 3; ++k) put(static_cast<std::size_t>(3 + k), driven.turn[k], 0.0, driven.baseTurn[k], driven.addedTurn[k]);
                if (driven.posed || driven.slotNumbers[3] >= 0 || driven.slotNumbers[4] >= 0 || driven.slotNumbers[5] >= 0) input.rotation = rotationOf(driven.turn);
            }
        }
    }
    if (turns || std::any_of(turned_.begin(), turned_.end(), [&](const Turned& t) { return t.start >= 0 && driven_[static_cast<std::size_t>(t.start)].moved; }))
        for (Turned& bone : turned_) follow(bone);
    for (const Driven& driven : driven_)
        if (driven.moved) moved_.push_back(driven.input);
    return moved_;
}

bool InputDriver::addPoses() {
    if (std::ranges::none_of(posed_, [this](const Posed& p) { return mapper_.moved(p.slot); })) return false;
    poses_ = true;
    for (Turned& bone : turned_) bone.added.setZero(), bone.longer = 0.0;
    for (Driven& driven : driven_) driven.added.setZero(), driven.addedTurn.setZero(), driven.addedWeight = 0.0;
    for (const Posed& pose : posed_) {
        const double weight = mapper_.shown(pose.slot) - pose.before;
        for (const Posed::OfBone& b : pose.bones) {
            turned_[b.turned].added += weight * b.turn;
            turned_[b.turned].longer += weight * b.longer;
        }
        for (const Posed::OfThing& t : pose.things) {
            Driven& driven = driven_[t.driven];
            driven.added += weight * t.by;
            driven.addedTurn += weight * t.turn;
            driven.addedWeight += weight * t.weight;
        }
    }
    return true;
}

void InputDriver::rebase(Driven& driven) {
    driven.base = driven.input;
    driven.base.target -= driven.added;
    driven.base.weight -= driven.addedWeight;
    driven.baseTurn = driven.turn - driven.addedTurn;
}

bool InputDriver::placed(const Driven& driven) const {
    return std::any_of(driven.slotNumbers.begin(), driven.slotNumbers.begin() + 3, [this](int slot) { return slot >= 0 && mapper_.winner(slot) >= 0; });
}

void InputDriver::follow(Turned& bone) {
    const bool mine = std::ranges::any_of(bone.slotNumbers, [](int slot) { return slot >= 0; });
    for (std::size_t k = 0; k < bone.slotNumbers.size(); ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        bone.turn[axis] = (bone.slotNumbers[k] >= 0 ? mapper_.shown(bone.slotNumbers[k]) : bone.base[axis]) + bone.added[axis];
    }
    const Turned* parent = bone.parent >= 0 ? &turned_[static_cast<std::size_t>(bone.parent)] : nullptr;
    bone.now = (parent ? parent->now : bone.parentTurn) * rotationOf(bone.turn);
    Driven* start = bone.start >= 0 ? &driven_[static_cast<std::size_t>(bone.start)] : nullptr;
    bone.startNow = parent && !(start && placed(*start)) ? Vec3(parent->startNow + parent->now * (parent->length * bone.fromParent)) : start ? start->input.target : bone.startAt;
    const bool moves = mine || poses_;  // else it only carries others
    // A row that turns a bone gives it its length at rest; poses have lengths of their own.
    bone.length = mine && !poses_ ? 1.0 : std::max(bone.baseLength + bone.longer, kShortest);
    if (start && !parent && moves) start->moved = !start->byHand;  // held, too
    const Eigen::Quaterniond& carried = parent ? parent->untwisted : bone.parentUntwisted;
    const Vec3 way = bone.now * (bone.length * bone.along), direction = way.normalized();
    bone.untwisted = (minimalRotation(carried * bone.along.normalized(), direction) * carried).normalized();
    Driven& end = driven_[bone.end];
    LiveInput& input = end.input;
    const Eigen::Quaterniond twist = bone.now * bone.untwisted.conjugate();
    if (end.byHand || !moves || (bone.pinned && !mine)) return;
    // Where something drives its place or roll themselves, that counts.
    if (!placed(end)) input.target = bone.startNow + way;
    if (end.slotNumbers[3] < 0 || mapper_.winner(end.slotNumbers[3]) < 0) input.roll = bone.rollSign * rotationVector(twist.w() < 0.0 ? Eigen::Quaterniond(-twist.coeffs()) : twist).dot(direction);
    input.hasRoll = end.moved = true;
}

void InputDriver::forgetNumbers() {
    for (Driven& driven : driven_) driven.held = false;
}

bool InputDriver::holds(const LiveInput& input) const {
    return std::any_of(driven_.begin(), driven_.end(), [&](const Driven& d) { return d.held && d.input.sameTarget(input); });
}

void InputDriver::giveToHand(const LiveInput& held) {
    for (Driven& driven : driven_) {
        if (!driven.input.sameTarget(held)) continue;
        driven.byHand = true;
        driven.input.target = held.target;  // bones that start there are turned about it
        for (const int slot : driven.slotNumbers)
            if (slot >= 0) mapper_.setByHand(slot, true, mapper_.shown(slot));
        for (const Turned& bone : turned_)
            for (const int slot : bone.slotNumbers)
                if (slot >= 0 && &driven_[bone.end] == &driven) mapper_.setByHand(slot, true, mapper_.shown(slot));
    }
}

void InputDriver::pointAt(Turned& bone, const Vec3& end) {
    const Vec3 way = end - bone.startNow, was = bone.now * bone.along;
    const bool knows = way.norm() > 0.0 && was.norm() > 0.0;
    if (knows) {
        const Turned* parent = bone.parent >= 0 ? &turned_[static_cast<std::size_t>(bone.parent)] : nullptr;
        const Eigen::Quaterniond now = minimalRotation(was.normalized(), way.normalized()) * bone.now;
        bone.turn = rotationVector(((parent ? parent->now : bone.parentTurn).conjugate() * now).normalized());
        bone.base = bone.turn - bone.added;
        if (poses_) bone.baseLength = way.norm() / bone.along.norm() - bone.longer;
    }
    for (std::size_t k = 0; k < bone.slotNumbers.size(); ++k)
        if (bone.slotNumbers[k] >= 0) mapper_.setByHand(bone.slotNumbers[k], false, bone.turn[static_cast<Eigen::Index>(k)] - bone.added[static_cast<Eigen::Index>(k)]);
}

void InputDriver::read(std::span<InputMeter> meters) const {
    for (std::size_t i = 0; i < rowOf_.size() && i < meters.size(); ++i) meters[i] = rowOf_[i] < 0 ? InputMeter() : mapper_.meterOf(static_cast<std::size_t>(rowOf_[i]));
}

void InputDriver::hold(const LiveInput& held) {
    for (Driven& driven : driven_) {
        LiveInput& input = driven.input;
        if (!input.sameTarget(held)) continue;
        const bool byHand = std::exchange(driven.byHand, false);
        if (byHand)
            for (Turned& bone : turned_)
                if (&driven_[bone.end] == &driven) pointAt(bone, held.target);
        driven.held = true;
        // What only poses move was taken hold of where it is, and goes on by them.
        const auto restarts = [&](int slot) { return slot >= 0 && (byHand || !driven.posed || mapper_.winner(slot) >= 0); };
        if (input.isNumber()) {
            if (restarts(driven.slotNumbers[0])) mapper_.setByHand(driven.slotNumbers[0], false, held.weight - driven.addedWeight);
            input.weight = held.weight;
            continue;
        }
        input.target = held.target;
        input.rotation = held.rotation;
        input.roll = held.roll;
        driven.turn = rotationVector(held.rotation);
        if (byHand) rebase(driven);
        const Vec3 place = held.target - driven.added - driven.rest, turn = driven.turn - driven.addedTurn;
        const std::array<double, 6> shown = {place.x(), place.y(), place.z(), input.kind == LiveInput::Kind::End ? held.roll : turn.x(), turn.y(), turn.z()};
        for (std::size_t k = 0; k < shown.size(); ++k)
            if (restarts(driven.slotNumbers[k])) mapper_.setByHand(driven.slotNumbers[k], false, shown[k]);
    }
}

}  // namespace imomushi
