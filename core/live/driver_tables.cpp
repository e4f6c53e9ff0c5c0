// SPDX-License-Identifier: GPL-3.0-or-later
// What an InputDriver is built from.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/rotation_vector.h"
#include "core/document/command_support.h"
#include "core/document/cycle.h"
#include "core/document/morph_weights.h"
#include "core/live/calibrated_rows.h"
#include "core/live/direct_names.h"
#include "core/live/input_driver.h"
#include "core/live/pose_parts.h"
#include "core/mesh/bounds.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

using Kind = MappedTarget::Kind;

/// Direct names tell places within this, m: what is farther is not meant, and numbers keep their digits.
constexpr double kFarthestDirect = 1e6;
constexpr double kLargestDirectAngle = 100.0;  // radians
/// A target that was given comes back within this: m, or of a weight.
constexpr double kSame = 1e-9;
/// Smoothing of those who drive cycles alone, Hz: their faders go by steps.
constexpr double kFaderHertz = 4.0;

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

}  // namespace

struct InputDriver::Tables {
    const Document& document;
    const CharacterPlan& plan;
    BoneTree tree;
    Pose pose;  // of the document, or rest
    std::vector<Driven> driven;
    std::vector<Turned> turned;
    std::vector<Limb> limbs;
    std::vector<Posed> posed;
    std::vector<std::size_t> keptOf;  // of each of posed, in the document
    std::vector<Cycled> cycles;
    std::vector<int> cycleOf;         // of each of the document, in `cycles`; -1: nobody drives it
    const InputDriver* before;        // null: it begins anew
    std::vector<InputRow> rows;
    std::vector<int> rowOf;  // of each mapping
    std::vector<double> shown, rest;
    std::vector<int> letGo;           // slots that were letting go
    const bool solo = anySolo(document);  // of any row
    CalibratedRows calibrated = calibratedRows(document, plan);

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
            made.face = target.handle;
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
        made.part = target.end.bone;
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
        // While a cycle runs bones may lag behind their targets, which it goes on from.
        if (const Turned* was = turnedBefore(made.part)) made.turn = made.base = was->turn;
        return &turned.emplace_back(made);
    }

    [[nodiscard]] bool endIsPinned(std::size_t bone) const {
        return std::ranges::any_of(document.goals, [&](const auto& goal) { return goal.second.pinned && plan.pointIndex(goal.first) == plan.input.skeleton.bones[bone].end; });
    }

    /// Bones between two that are turned go along with the upper one, and carry the lower one.
    void addBetween() {
        std::vector<char> known(plan.bones.size(), 0);
        for (const Turned& t : turned) known[t.bone] = 1;
        for (std::size_t b = 0; b < plan.bones.size(); ++b) {
            if (!known[b]) continue;
            std::vector<int> between;
            int up = tree.parent[b];
            for (; up >= 0 && !known[static_cast<std::size_t>(up)]; up = tree.parent[static_cast<std::size_t>(up)]) between.push_back(up);
            if (up < 0) continue;
            for (const int bone : between) {
                MappedTarget target;
                target.kind = Kind::BoneTurn;
                target.end = {plan.bones[static_cast<std::size_t>(bone)], true};
                if (Turned* made = findTurned(target)) {
                    made->between = true;
                    made->pinned = endIsPinned(static_cast<std::size_t>(bone));
                }
                known[static_cast<std::size_t>(bone)] = 1;
            }
        }
    }

    /// Parents before children, with what they know of each other.
    void sortTurned() {
        addBetween();
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

    /// What the driver before made of a bone, where a cycle moves it; null: nothing.
    [[nodiscard]] const Turned* turnedBefore(PartId part) const {
        if (!before || !before->cycling()) return nullptr;
        const auto was = std::ranges::find(before->turned_, part, &Turned::part);
        return was == before->turned_.end() || before->driven_[was->end].byHand ? nullptr : &*was;
    }

    /// Its place in `posed`; placePoses() says what it does.
    std::size_t placeOfPose(std::size_t kept) {
        const auto known = std::ranges::find(keptOf, kept);
        if (known != keptOf.end()) return static_cast<std::size_t>(known - keptOf.begin());
        keptOf.push_back(kept);
        posed.emplace_back().name = keptPoses(document)[kept].name;
        return posed.size() - 1;
    }

    int addSlot(double shows, double rests) {
        shown.push_back(shows);
        rest.push_back(rests);
        return static_cast<int>(shown.size()) - 1;
    }

    /// The same of the driver before, if it got another name too; null: there is none.
    [[nodiscard]] const Cycled* cycleBefore(const Cycle& cycle) const {
        if (!before) return nullptr;
        if (const Cycled* was = before->cycleNamed(cycle.name)) return was;
        const auto renamed = std::ranges::find_if(before->cycles_, [&](const Cycled& c) {
            return !imomushi::cycleNamed(document, c.name) && std::ranges::equal(c.poses, cycle.poses, {}, [&](std::size_t p) -> const std::string& { return before->posed_[p].name; });
        });
        return renamed == before->cycles_.end() ? nullptr : &*renamed;
    }

    /// Null: not all its poses are there.
    Cycled* findCycle(std::size_t index) {
        const Cycle& cycle = cyclesOf(document)[index];
        cycleOf.resize(cyclesOf(document).size(), -1);
        if (!isWhole(document, cycle)) return nullptr;
        if (int& known = cycleOf[index]; known < 0) {
            known = static_cast<int>(cycles.size());
            Cycled made;
            made.name = cycle.name;
            made.seconds = cycle.seconds;
            for (const std::string& name : cycle.poses) made.poses.push_back(placeOfPose(static_cast<std::size_t>(keptPose(document, name) - keptPoses(document).data())));
            const Cycled* was = cycleBefore(cycle);
            if (was) made.phase = was->phase;
            made.amount = addSlot(was ? before->amountOf(*was) : 0.0, 0.0);
            made.speed = addSlot(was ? before->mapper_.shown(was->speed) : 1.0, 1.0);
            for (const auto& [slot, slotBefore] : {std::pair(made.amount, was ? was->amount : -1), std::pair(made.speed, was ? was->speed : -1)})
                if (slotBefore >= 0 && before->mapper_.letsGo(slotBefore)) letGo.push_back(slot);
            cycles.push_back(std::move(made));
        }
        return &cycles[static_cast<std::size_t>(cycleOf[index])];
    }

    /// How much of each driven pose is in what is shown.
    void weighPoses(const std::vector<PoseParts>& parts) {
        std::vector<double> known(posed.size(), 0.0);
        for (const Cycled& cycle : cycles)
            for (std::size_t k = 0; k < cycle.poses.size(); ++k) known[cycle.poses[k]] += shown[static_cast<std::size_t>(cycle.amount)] * cycleWeight(k, cycle.poses.size(), cycle.phase);
        std::vector<bool> asked(posed.size());
        for (std::size_t p = 0; p < posed.size(); ++p) {
            asked[p] = posed[p].slot >= 0;
            if (!asked[p] || !before || !before->cycling()) continue;
            // Waves are sums of poses, too: only the driver before knows how much is whose.
            const auto was = std::ranges::find(before->posed_, posed[p].name, &Posed::name);
            if (was == before->posed_.end() || was->slot < 0) continue;
            asked[p] = false;
            known[p] += shown[static_cast<std::size_t>(posed[p].slot)] = before->mapper_.shown(was->slot);
        }
        const std::vector<double> weights = weightsIn(partsOf(poseOf(document, plan), document, plan, tree), parts, plan, known, asked);
        for (std::size_t p = 0; p < posed.size(); ++p)
            if (asked[p]) shown[static_cast<std::size_t>(posed[p].slot)] = weights[p];
    }

    /// Each bone that a driven pose turns, with all that hang on it, what stands on its own, and how much of each pose is in what is shown. Answers what each pose does.
    std::vector<PoseParts> placePoses() {
        std::vector<PoseParts> parts;
        if (posed.empty()) return parts;
        for (const std::size_t of : keptOf) parts.push_back(partsOf(keptPoses(document)[of], document, plan, tree));
        weighPoses(parts);
        std::vector<char> moves(plan.bones.size(), 0);
        const auto& bones = plan.input.skeleton.bones;
        const auto endOf = [&](int bone, bool atEnd) {
            MappedTarget target;
            target.kind = Kind::EndPlace;
            target.end = {plan.bones[static_cast<std::size_t>(bone)], atEnd};
            return target;
        };
        for (std::size_t p = 0; p < posed.size(); ++p) {
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
            const Turned* was = turnedBefore(bone->part);
            bone->baseLength = was && before->poses_ ? was->length : (pose.points[static_cast<std::size_t>(bones[b].end)] - pose.points[static_cast<std::size_t>(bones[b].start)]).norm() / bones[b].length;
            bone->pinned = !bone->hasRow() && endIsPinned(b);
        }
        return parts;
    }

    /// After sortTurned(). A limb ends where a row may place the end of a bone, or a hand while poses move it, and begins after the last bone that others hang on, too.
    void addLimbs() {
        std::vector<int> children(turned.size(), 0);
        for (const Turned& t : turned)
            if (t.parent >= 0) ++children[static_cast<std::size_t>(t.parent)];
        for (std::size_t b = 0; b < turned.size(); ++b) {
            const auto& slots = driven[turned[b].end].slotNumbers;
            if (posed.empty() && std::all_of(slots.begin(), slots.begin() + 3, [](int slot) { return slot < 0; })) continue;
            Limb limb{{b}};
            for (int up = turned[b].parent; up >= 0 && children[static_cast<std::size_t>(up)] == 1 && !turned[static_cast<std::size_t>(up)].pinned; up = turned[static_cast<std::size_t>(up)].parent) limb.bones.push_back(static_cast<std::size_t>(up));
            limbs.push_back(std::move(limb));
        }
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
            int& slot = posed[placeOfPose(target.pose)].slot;
            if (slot < 0) slot = addSlot(0.0, 0.0);
            row.slot = slot;
            rows.push_back(std::move(row));
            return;
        }
        if (target.kind == Kind::CycleAmount || target.kind == Kind::CycleSpeed) {
            const Cycled* cycle = findCycle(target.cycle);
            if (!cycle) return;
            row.slot = target.kind == Kind::CycleAmount ? cycle->amount : cycle->speed;
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

    /// A row of the document's table, corrected where its source is calibrated.
    [[nodiscard]] InputRow heard(const InputMapping& mapping) const {
        InputRow row = heardRow(mapping, solo);
        row.correction = calibrated.correctionOf[static_cast<std::size_t>(&mapping - document.mappings->data())];
        return row;
    }

    void addMappings() {
        if (!document.mappings) return;
        for (const InputMapping& mapping : *document.mappings) {
            rowOf.push_back(-1);
            const auto target = mappedTarget(document, mapping.target);
            if (!target || target->isTrigger()) continue;
            const InputRow row = heard(mapping);
            const std::size_t count = rows.size();
            add(row, *target);
            if (rows.size() > count) rowOf.back() = static_cast<int>(count);
        }
        // Behind all others: who maps the other side means it.
        for (const InputMapping& mapping : *document.mappings) {
            if (!mapping.mirrored) continue;
            const auto target = mappedTarget(document, otherSideOfTarget(mapping.target));
            if (!target) continue;
            InputRow row = heard(mapping);
            row.curve.outLow *= mirrorSign(*target);
            row.curve.outHigh *= mirrorSign(*target);
            add(row, *target);
        }
    }

    void addDirectNames(std::span<const std::string> sources, std::span<const std::string> ofCycles) {
        if (sources.empty() && ofCycles.empty()) return;
        for (const DirectName& name : directNames(document))
            for (int i = 0; i < name.count; ++i) {
                const MappedTarget& target = name.targets[static_cast<std::size_t>(i)];
                InputRow row;
                row.channel = name.address;
                row.component = i;
                row.muted = solo;
                row.curve = target.kind == Kind::Morph || target.kind == Kind::Pose || target.kind == Kind::CycleAmount ? direct(0.0, kLargestMorphWeight) : target.kind == Kind::CycleSpeed ? direct(0.0, Cycle::kFastest) : target.kind == Kind::Effect ? direct(0.0, kFarthestDirect)
                            : target.kind == Kind::HandleTurn || target.kind == Kind::EndRoll ? direct(0.0, kLargestDirectAngle)
                                                                                              : direct(restOf(target), kFarthestDirect);
                const auto addFor = [&](std::span<const std::string> some, double hertz) {
                    for (const std::string& source : some) {
                        row.source = source;
                        row.filter.hertz = hertz;
                        add(row, target);
                    }
                };
                addFor(sources, 0.0);
                if (target.kind == Kind::CycleAmount || target.kind == Kind::CycleSpeed) addFor(ofCycles, kFaderHertz);
            }
    }
};

InputDriver::InputDriver(const Document& document, const CharacterPlan& plan, std::span<const std::string> oscSources, std::span<const std::string> cycleSources, const InputDriver* before)
    : InputDriver([&] {
          const Skeleton& skeleton = plan.input.skeleton;
          Tables tables{document, plan, boneTree(skeleton), fits(skeleton, document.pose) ? document.pose : restPose(skeleton), {}, {}, {}, {}, {}, {}, {}, before && before->isIn(document, plan) ? before : nullptr, {}, {}, {}, {}, {}};
          tables.addMappings();
          tables.addDirectNames(oscSources, cycleSources);
          const auto parts = tables.placePoses();
          tables.sortTurned();
          tables.addLimbs();
          tables.addTurnsOfPoses(parts);
          for (Driven& driven : tables.driven) rebase(driven);
          return tables;
      }()) {}

InputDriver::InputDriver(Tables&& tables)
    : driven_(std::move(tables.driven)), turned_(std::move(tables.turned)), limbs_(std::move(tables.limbs)), posed_(std::move(tables.posed)), cycles_(std::move(tables.cycles)), rowOf_(std::move(tables.rowOf)), mapper_(std::move(tables.rows), tables.shown, tables.rest, std::move(tables.calibrated.corrections)) {
    moved_.reserve(driven_.size());
    weighPoses();
    for (Posed& pose : posed_) pose.before = pose.weight;
    for (const Limb& limb : limbs_) limbPoints_.resize(std::max(limbPoints_.size(), limb.bones.size() + 1));
    limbLengths_.resize(limbPoints_.size());
    takePosesOut();
    for (const int slot : tables.letGo) mapper_.letGo(slot);
}

bool InputDriver::isIn(const Document& document, const CharacterPlan& plan) const {
    const auto has = [&](const Driven& driven) {
        const LiveInput& input = driven.input;
        if (input.kind == LiveInput::Kind::Handle) {
            const auto goal = document.handleGoals.find(driven.face);
            return goal != document.handleGoals.end() && goal->second.target.held && (goal->second.now().at - input.target).norm() < kSame;
        }
        if (input.kind == LiveInput::Kind::Morph) {
            const auto character = document.characters.find(input.morph.character);
            return character == document.characters.end() || std::abs(morphWeight(document, *character->second, input.morph.target) - input.weight) < kSame;
        }
        const int point = plan.pointIndex(input.end);
        return point < 0 || std::ranges::any_of(document.goals, [&](const auto& goal) { return plan.pointIndex(goal.first) == point && (goal.second.target - input.target).norm() < kSame; });
    };
    return std::ranges::all_of(turned_, [&](const Turned& t) { return t.pinned || driven_[t.end].byHand || (driven_[t.end].held && has(driven_[t.end])); }) &&
           std::ranges::all_of(driven_, [&](const Driven& d) { return !d.posed || d.byHand || (d.held && has(d)); });
}

}  // namespace imomushi
