// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/document/character_input.h"
#include "core/document/input_mapping.h"
#include "core/input/input_mapper.h"
#include "core/live/live_input.h"

namespace imomushi {

/// What live input makes of a character that is performed: values go in, targets for the next step come out. Rows of the document's table come first; after them, everything has a name of its own
/// by OSC (directNames()). Built once. Taking and stepping neither allocate, lock nor fail; what comes out depends on values, steps and hold() alone.
/// Bones that are turned (BoneTurn) go by forward kinematics, from where their parents are driven, or were when this was built.
class InputDriver {
public:
    /// `oscSources`: those whose values may use direct names; `cycleSources`: those of cycles alone. Rows whose target is not there drive nothing. `before`: the driver that was
    /// stepped until now. Cycles go on from where it has them, if its targets are what the document has; else, and where it is null, they begin at their first pose.
    InputDriver(const Document& document, const CharacterPlan& plan, std::span<const std::string> oscSources, std::span<const std::string> cycleSources = {}, const InputDriver* before = nullptr);

    /// False: it drives nothing.
    bool take(const InputValue& value) { return mapper_.take(value); }
    /// A step of so many seconds, > 0: the targets that moved, until the next step. Those of handles and ends of bones are taken by the character only where they are held.
    std::span<const LiveInput> step(double seconds);
    /// The target of this input is grabbed from now on, at the place that the input says, and glides from there. If a hand had it, the hand has let go.
    void hold(const LiveInput& held);
    /// True after hold(). The stepping thread gives a number to the character only then, so that undo can restore the number from before.
    [[nodiscard]] bool holds(const LiveInput& input) const;
    /// A row drives it, or there is something of a pose or a cycle.
    [[nodiscard]] bool moves(const LiveInput& input) const;
    /// Numbers must be held anew.
    void forgetNumbers();
    /// A hand has what such an input moves, there: nothing else drives it until hold(). While poses move its limb, that goes along.
    void giveToHand(const LiveInput& held);
    /// See InputMapper::rests() and pass(), between two steps. While a cycle runs it does not rest.
    [[nodiscard]] double rests() const;
    void pass(double seconds) { mapper_.pass(seconds); }
    /// Everything glides to rest. For panic.
    void letGo() { mapper_.letGo(); }
    [[nodiscard]] const InputMapper& mapper() const { return mapper_; }
    /// Where a driven cycle is, 0 ... 1 rounds; none: nobody drives it.
    [[nodiscard]] std::optional<double> phaseOf(std::string_view cycle) const;
    /// How many rows the document's table has, and what they show; of one whose target is not there, nothing. `meters`: one for each.
    [[nodiscard]] std::size_t mappings() const { return rowOf_.size(); }
    void read(std::span<InputMeter> meters) const;

private:
    /// A bone that is turned about its parent: its end goes where forward kinematics has it, and twists with it.
    struct Turned {
        PartId part = 0;
        std::size_t bone = 0, end = 0;     ///< of the skeleton; of driven_
        int parent = -1;                   ///< of turned_, -1: none, then
        Eigen::Quaterniond parentTurn = Eigen::Quaterniond::Identity(), parentUntwisted = Eigen::Quaterniond::Identity();  ///< of its parent, world; the latter without roll
        int start = -1;                    ///< of driven_, -1: none has the start of the bone
        Vec3 startAt = Vec3::Zero();       ///< m, where it has no parent here
        Vec3 fromParent = Vec3::Zero(), along = Vec3::Zero();  ///< at rest: from the start of its parent to its own, from there to its end
        double rollSign = 1.0;
        std::array<int, 3> slotNumbers{-1, -1, -1};
        Vec3 turn = Vec3::Zero();          ///< about its parent, a rotation vector
        Vec3 base = Vec3::Zero(), added = Vec3::Zero();  ///< the turn without poses, where no slot says it; what poses add
        double baseLength = 1.0, longer = 0.0;           ///< over that at rest, the same
        bool pinned = false;               ///< its end stays where it is pinned
        bool between = false;              ///< nothing turns it but what it hangs on
        Vec3 byPoses = Vec3::Zero();       ///< of the turn, all that is of poses
        double longerByPoses = 0.0;
        // Of the last step
        Eigen::Quaterniond now = Eigen::Quaterniond::Identity(), untwisted = Eigen::Quaterniond::Identity();  ///< world; the latter without twist
        Vec3 startNow = Vec3::Zero();
        double length = 1.0;               ///< over that at rest
        // The same without poses
        Eigen::Quaterniond unposedNow = Eigen::Quaterniond::Identity();
        Vec3 unposedStart = Vec3::Zero();
        double unposedLength = 1.0;
        // It goes along with the end of its limb
        bool led = false;
        Eigen::Quaterniond ledNow = Eigen::Quaterniond::Identity();
        double ledLength = 1.0;
        [[nodiscard]] bool hasRow() const { return std::ranges::any_of(slotNumbers, [](int slot) { return slot >= 0; }); }
        [[nodiscard]] Vec3 endNow() const { return startNow + now * (length * along); }
        [[nodiscard]] Vec3 unposedEnd() const { return unposedStart + unposedNow * (unposedLength * along); }
    };
    /// Bones whose last end rows or a hand may place: where poses move them, what rows say is added to that, a hand has it where it is, and the bones before the last one go along.
    struct Limb {
        std::vector<std::size_t> bones;    ///< of turned_, from the last one up
    };
    /// What is moved as one: a handle, an end of a bone, a morph target, a number of an effect.
    struct Driven {
        LiveInput input;     ///< as it was given last
        FaceRef face;        ///< of a handle
        Vec3 rest = Vec3::Zero();
        Vec3 turn = Vec3::Zero();        ///< of a handle, as a rotation vector
        LiveInput base;                  ///< without poses, where no slot says it
        Vec3 baseTurn = Vec3::Zero();
        Vec3 added = Vec3::Zero(), addedTurn = Vec3::Zero();  ///< by poses, to the base
        double addedWeight = 0.0;
        Vec3 byPoses = Vec3::Zero(), turnByPoses = Vec3::Zero();  ///< all that is of poses
        double weightByPoses = 0.0;
        bool posed = false;              ///< poses add something
        std::array<int, 6> slotNumbers{-1, -1, -1, -1, -1, -1};  ///< x y z, turn x y z; of an end roll in place of the turn, of a number that first
        bool moved = false;  ///< in the last step
        bool byHand = false, held = false;
    };
    /// A pose whose weight is driven, or that a driven cycle goes through: what it adds to turned_ and driven_.
    struct Posed {
        std::string name;
        int slot = -1;                   ///< of its weight, -1: only cycles have it
        double before = 0.0;             ///< the weight that is in what was shown at first
        double weight = 0.0;             ///< now, with what cycles have of it
        struct OfBone {
            std::size_t turned = 0;
            Vec3 turn = Vec3::Zero();
            double longer = 0.0;
        };
        struct OfThing {
            std::size_t driven = 0;
            Vec3 by = Vec3::Zero(), turn = Vec3::Zero();
            double weight = 0.0;
        };
        std::vector<OfBone> bones;
        std::vector<OfThing> things;
    };
    /// A cycle whose amount or speed is driven.
    struct Cycled {
        std::string name;
        int amount = -1, speed = -1;     ///< slots
        double seconds = 1.0;            ///< of a round at speed 1
        double phase = 0.0;              ///< rounds, 0 ... 1: it stands where there is nothing of it
        std::vector<std::size_t> poses;  ///< of posed_
    };
    struct Tables;
    explicit InputDriver(Tables&& tables);
    /// A row drives it, or did and lets go.
    [[nodiscard]] bool leads(int slot) const { return slot >= 0 && (mapper_.winner(slot) >= 0 || mapper_.left(slot) > 0.0); }
    /// Something drives its place.
    [[nodiscard]] bool placed(const Driven& driven) const { return std::any_of(driven.slotNumbers.begin(), driven.slotNumbers.begin() + 3, [this](int slot) { return leads(slot); }); }
    /// Where forward kinematics has it, with and without poses.
    void turn(Turned& bone);
    void turnAll();
    /// Bends a limb so that its end comes where rows place it or a hand has it. Bones that rows turn or place themselves, and what is above them, stay.
    void lead(const Limb& limb);
    /// Gives its end where it is.
    void follow(Turned& bone);
    [[nodiscard]] const Cycled* cycleNamed(std::string_view name) const;  ///< null: nobody drives it
    /// What cycles and poses move is held, and the document has it where this driver has put it last.
    [[nodiscard]] bool isIn(const Document& document, const CharacterPlan& plan) const;
    [[nodiscard]] bool cycling() const;  ///< there is something of a cycle in what it makes
    [[nodiscard]] double amountOf(const Cycled& cycle) const;
    [[nodiscard]] double speedOf(const Cycled& cycle) const;
    [[nodiscard]] bool runs(const Cycled& cycle) const { return amountOf(cycle) != 0.0 && speedOf(cycle) != 0.0; }
    /// Time passes in cycles.
    void turnCycles(double seconds);
    /// Of poses, with what cycles have of them.
    void weighPoses();
    /// Sums what poses add. False: none moved.
    bool addPoses();
    void sumPoses();
    /// What is shown without poses: what slots begin from.
    void takePosesOut();
    /// From now on its base is what makes it what it is.
    static void rebase(Driven& driven);
    /// A bone that is turned points where its end was left, so that it goes on from there.
    void pointAt(Turned& bone, const Vec3& end);
    /// The same for the bones that went along with a hand, which has let go of their last end there.
    void leaveLimb(const Driven& end, const Vec3& at);
    std::vector<Driven> driven_;
    std::vector<Turned> turned_;     // parents before children
    std::vector<Limb> limbs_;        // parents before children
    std::vector<Vec3> limbPoints_;   // room of lead(), with
    std::vector<double> limbLengths_;
    std::vector<Posed> posed_;
    std::vector<Cycled> cycles_;
    bool poses_ = false;             // one has moved
    std::vector<LiveInput> moved_;
    std::vector<int> rowOf_;         // of each mapping, -1: its target is not there
    InputMapper mapper_;
};

}  // namespace imomushi
