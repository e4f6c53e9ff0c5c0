// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/calibrated_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include "core/document/input_mapping.h"
#include "core/document/kept_pose.h"
#include "core/document/source_calibration.h"
#include "core/input/calibration.h"
#include "core/input/pose_numbers.h"
#include "core/live/pose_parts.h"
#include "core/mesh/render_model.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

using Kind = MappedTarget::Kind;
using Said = std::vector<double>;

constexpr double kSameSlope = 1e-9;

constexpr double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

Vec3 threeOf(const Said& said, int first) {
    const auto at = static_cast<std::size_t>(first);
    return {said[at], said[at + 1], said[at + 2]};
}

/// It tells how it stands in the room, not how it is turned about its parent.
bool isInRoom(std::string_view channel) { return !channel.starts_with("bone/") || channel == "bone/Hips"; }
/// It faces where who performs does: a tracker may be worn any way round.
bool facesAlong(std::string_view channel) { return channel == "root" || channel == "bone/Hips" || channel.starts_with("hmd/"); }

bool isTurn(Kind kind) { return kind == Kind::HandleTurn || kind == Kind::BoneTurn; }
bool isPlace(Kind kind) { return kind == Kind::HandlePlace || kind == Kind::EndPlace; }
bool saysPoseOf(Kind kind) { return isTurn(kind) || isPlace(kind) || kind == Kind::EndRoll || kind == Kind::Morph || kind == Kind::Pose; }

/// A pose of the character, as numbers that rows drive.
struct Stand {
    const KeptPose* kept = nullptr;  // null: rest
    PoseParts parts;
};

class Builder {
public:
    Builder(const Document& document, const CharacterPlan& plan) : document_(document), plan_(plan) { made_.correctionOf.resize(document.mappings ? document.mappings->size() : 0, -1); }

    CalibratedRows build() {
        if (!document_.mappings) return std::move(made_);
        for (const std::string& source : calibratedSources(document_)) calibrate(source);
        return std::move(made_);
    }

private:
    /// A row of the table that a calibration may correct.
    struct Row {
        std::size_t mapping = 0;
        MappedTarget target;
        int component = 0;
        const ResponseCurve* curve = nullptr;
        std::vector<double> wanted;  // of each pose of the source, in the unit of its target
    };
    /// Rows that are corrected as one.
    struct Group {
        Correction::Kind kind = Correction::Kind::Number;
        std::string_view channel;
        int first = 0;
        double radians = 1.0;
        std::vector<Row> rows;
    };

    const std::string& targetOf(const Row& row) const { return (*document_.mappings)[row.mapping].target; }

    void calibrate(const std::string& source) {
        poses_.clear();
        stands_.clear();
        const std::size_t begin = made_.poses.size();
        for (const SourceCalibration::Pose& pose : calibrationOf(document_, source)->poses) {
            Stand stand;
            if (!pose.name.empty()) {
                stand.kept = keptPose(document_, pose.name);
                if (!stand.kept) continue;
                stand.parts = partsOf(*stand.kept, document_, plan_, tree());
            }
            poses_.push_back(&pose);
            stands_.push_back(std::move(stand));
            made_.poses.push_back({source, pose.name, 0, {}, {}, false});
        }
        std::vector<Group> groups;
        for (std::size_t m = 0; m < document_.mappings->size(); ++m) {
            const InputMapping& mapping = (*document_.mappings)[m];
            if (mapping.row.source != source || mapping.row.toggles) continue;
            const auto target = mappedTarget(document_, mapping.target);
            if (!target || !saysPoseOf(target->kind)) continue;
            Row row{m, *target, mapping.row.component, &mapping.row.curve, {}};
            for (const Stand& stand : stands_) row.wanted.push_back(wantedOf(*target, stand));
            put(groups, std::move(row), mapping.row.channel);
        }
        std::vector<Group> singles;
        for (Group& group : groups) settle(group, singles);
        groups.insert(groups.end(), std::make_move_iterator(singles.begin()), std::make_move_iterator(singles.end()));
        const std::size_t count = poses_.size();
        apart_.assign(count * count, false), told_.assign(count * count, false);
        for (const Group& group : groups)
            if (!group.rows.empty()) fit(group, begin);
        for (std::size_t a = 0; a < count; ++a)
            for (std::size_t b = 0; b < count; ++b)
                if (apart_[a * count + b] && !told_[a * count + b]) {
                    made_.poses[begin + a].isAlike = true;
                    made_.poses[begin + a].alike = poses_[b]->name;
                }
    }

    /// Rows of one channel that turn, or place, one thing belong together.
    void put(std::vector<Group>& groups, Row row, std::string_view channel) const {
        const Kind kind = row.target.kind;
        if (isTurn(kind) || isPlace(kind)) {
            const auto thing = [&](const Row& r) { return std::string_view(targetOf(r)).substr(0, targetOf(r).size() - 1); };
            for (Group& group : groups)
                if (group.channel == channel && group.rows.front().target.kind == kind && thing(group.rows.front()) == thing(row)) return group.rows.push_back(std::move(row));
        }
        Group& made = groups.emplace_back();
        made.channel = channel;
        made.kind = isTurn(kind) ? Correction::Kind::Turn : isPlace(kind) ? Correction::Kind::Place : Correction::Kind::Number;
        made.first = row.component;
        made.rows.push_back(std::move(row));
    }

    /// Says which three numbers a group has; where they are none, each row goes into `singles`.
    void settle(Group& group, std::vector<Group>& singles) const {
        if (group.kind == Correction::Kind::Number) return;
        const auto [low, high] = std::ranges::minmax(group.rows, {}, &Row::component);
        std::array<bool, 3> there{};
        for (const Row& row : group.rows)
            if (const int axis = row.component - low.component; axis < 3) there[static_cast<std::size_t>(axis)] = true;
        bool whole = high.component - low.component == 2 && there[1];
        group.first = low.component;
        if (group.kind == Correction::Kind::Turn) {
            const bool ofPose = low.component >= kPoseTurn && high.component < kPoseTurn + 3 && std::ranges::any_of(poses_, [&](const auto* pose) {
                const auto said = pose->said.find(std::string(group.channel));
                return said != pose->said.end() && saysPose(said->second);
            });
            if (ofPose) {
                group.first = kPoseTurn;
                return;
            }
            // Any three numbers that are mapped evenly are a rotation vector in a unit of their own.
            group.radians = std::abs(group.rows.front().curve->slope());
            whole = whole && group.radians > 0.0 && std::ranges::all_of(group.rows, [&](const Row& row) { return row.curve->isEven() && std::abs(std::abs(row.curve->slope()) - group.radians) <= kSameSlope * group.radians; });
        }
        if (whole) return;
        for (Row& row : group.rows) {
            Group& single = singles.emplace_back();
            single.channel = group.channel;
            single.first = row.component;
            single.rows.push_back(std::move(row));
        }
        group.rows.clear();
    }

    double wantedOf(const MappedTarget& target, const Stand& stand) const {
        const auto atRest = [&](const MorphRef& morph) { return document_.characters.at(morph.character)->model->morphs[static_cast<std::size_t>(morph.target)].atRest; };
        if (!stand.kept) return target.kind == Kind::Morph ? atRest(target.morph) : 0.0;
        switch (target.kind) {
            case Kind::HandlePlace:
            case Kind::HandleTurn: {
                const auto found = std::ranges::find(stand.parts.handles, plan_.handleIndex(target.handle), &PoseParts::Handle::handle);
                return found == stand.parts.handles.end() ? 0.0 : (target.kind == Kind::HandlePlace ? found->by : found->turn)[target.axis];
            }
            case Kind::BoneTurn: {
                const auto found = std::ranges::find(stand.parts.bones, plan_.boneIndex(target.end.bone), &PoseParts::Bone::bone);
                return found == stand.parts.bones.end() ? 0.0 : found->turn[target.axis];
            }
            case Kind::EndPlace:
            case Kind::EndRoll: {
                const auto bone = stand.kept->bones.find(target.end.bone);
                const int point = plan_.pointIndex(target.end);
                if (bone == stand.kept->bones.end() || point < 0) return 0.0;
                if (target.kind == Kind::EndRoll) return target.end.atEnd ? bone->second.endRoll : bone->second.startRoll;
                return ((target.end.atEnd ? bone->second.end : bone->second.start) - plan_.input.skeleton.points[static_cast<std::size_t>(point)])[target.axis];
            }
            case Kind::Morph: {
                const auto weight = stand.kept->morphs.find(target.morph);
                return weight == stand.kept->morphs.end() ? atRest(target.morph) : weight->second;
            }
            case Kind::Pose: return &keptPoses(document_)[target.pose] == stand.kept ? 1.0 : 0.0;
            default: return 0.0;
        }
    }

    /// What a group should hear in a pose.
    static Vec3 meantOf(const Group& group, std::size_t pose) {
        Vec3 made = Vec3::Zero();
        for (auto row = group.rows.rbegin(); row != group.rows.rend(); ++row) made[row->component - group.first] = row->curve->back(row->wanted[pose]);
        return made;
    }

    void fit(const Group& group, std::size_t begin) {
        struct Measured {
            std::size_t pose;
            const Said* said;
            Vec3 meant;
        };
        std::vector<Measured> measured;
        const std::size_t size = group.kind == Correction::Kind::Number ? 1 : 3;
        for (std::size_t p = 0; p < poses_.size(); ++p) {
            const auto said = poses_[p]->said.find(std::string(group.channel));
            if (said != poses_[p]->said.end() && said->second.size() >= static_cast<std::size_t>(group.first) + size) measured.push_back({p, &said->second, meantOf(group, p)});
        }
        if (measured.empty()) return;
        double range = 0.0;
        for (const Row& row : group.rows) range = std::max(range, row.curve->inHigh - row.curve->inLow);
        const double tells = kRangeTells * range;
        Correction made;
        std::vector<SaidAndMeant<Eigen::Quaterniond>> turns;
        std::vector<SaidAndMeant<Vec3>> places;
        std::vector<SaidAndMeant<double>> numbers;
        for (const Measured& m : measured) {
            if (group.kind == Correction::Kind::Number) numbers.push_back({(*m.said)[static_cast<std::size_t>(group.first)], m.meant.x()});
            else if (group.kind == Correction::Kind::Place) places.push_back({threeOf(*m.said, group.first), m.meant});
            else turns.push_back({rotationOf(group.radians * threeOf(*m.said, group.first)), rotationOf(group.radians * m.meant)});
        }
        switch (group.kind) {
            case Correction::Kind::Number: made = fitNumber(numbers, tells); break;
            case Correction::Kind::Place: {
                const bool faces = facesAlong(group.channel) && saysPose(*measured.front().said);
                made = fitPlace(places, faces ? facingOf(rotationOf(threeOf(*measured.front().said, kPoseTurn))).conjugate() : Eigen::Quaterniond::Identity(), tells);
                break;
            }
            case Correction::Kind::Turn: made = fitTurn(turns, isInRoom(group.channel) && (group.first == kPoseTurn || group.rows.front().target.kind == Kind::HandleTurn)); break;
        }
        made.first = group.first;
        made.radians = group.radians;
        for (const Row& row : group.rows) made_.correctionOf[row.mapping] = static_cast<int>(made_.corrections.size());
        made_.corrections.push_back(made);
        for (const Measured& m : measured) {
            CalibratedRows::OfPose& of = made_.poses[begin + m.pose];
            of.rows += group.rows.size();
            measureOff(group, made, m.pose, *m.said, of.off);
        }
        const auto differ = [&](std::size_t a, std::size_t b, bool meant) {
            if (group.kind == Correction::Kind::Turn) return (meant ? turns[a].meant.angularDistance(turns[b].meant) : turns[a].said.angularDistance(turns[b].said)) > kTurnTells;
            if (group.kind == Correction::Kind::Place) return (meant ? places[a].meant - places[b].meant : places[a].said - places[b].said).norm() > tells;
            return std::abs(meant ? numbers[a].meant - numbers[b].meant : numbers[a].said - numbers[b].said) > tells;
        };
        for (std::size_t a = 0; a < measured.size(); ++a)
            for (std::size_t b = 0; b < measured.size(); ++b) {
                if (a == b || !differ(a, b, true)) continue;
                const std::size_t at = measured[a].pose * poses_.size() + measured[b].pose;
                apart_[at] = true;
                if (differ(a, b, false)) told_[at] = true;
            }
    }

    static void measureOff(const Group& group, const Correction& correction, std::size_t pose, const Said& said, CalibrationResidual& off) {
        const auto grow = [](std::optional<double>& most, double by) { most = std::max(most.value_or(0.0), by); };
        Vec3 wanted = Vec3::Zero(), got = Vec3::Zero();
        for (const Row& row : group.rows) {
            const double makes = row.curve->at(correction.at(said, row.component)), asked = row.wanted[pose];
            if (group.kind != Correction::Kind::Number) {
                wanted[row.target.axis] = asked, got[row.target.axis] = makes;
                continue;
            }
            const double by = std::abs(makes - asked), range = std::abs(row.curve->outHigh - row.curve->outLow);
            if (isPlace(row.target.kind)) grow(off.mm, 1e3 * by);
            else if (isTurn(row.target.kind) || row.target.kind == Kind::EndRoll) grow(off.degrees, degrees(by));
            else grow(off.percent, 100.0 * by / (range > 0.0 ? range : 1.0));
        }
        if (group.kind == Correction::Kind::Turn) grow(off.degrees, degrees(rotationOf(wanted).angularDistance(rotationOf(got))));
        if (group.kind == Correction::Kind::Place) grow(off.mm, 1e3 * (wanted - got).norm());
    }

    const BoneTree& tree() {
        if (!tree_) tree_ = boneTree(plan_.input.skeleton);
        return *tree_;
    }

    const Document& document_;
    const CharacterPlan& plan_;
    std::optional<BoneTree> tree_;
    CalibratedRows made_;
    std::vector<const SourceCalibration::Pose*> poses_;  // of the source
    std::vector<Stand> stands_;
    std::vector<bool> apart_, told_;  // of each two poses: the character has something elsewhere; the source says so
};

}  // namespace

const CalibratedRows::OfPose* CalibratedRows::find(std::string_view source, std::string_view pose) const {
    const auto found = std::ranges::find_if(poses, [&](const OfPose& p) { return p.source == source && p.pose == pose; });
    return found == poses.end() ? nullptr : &*found;
}

CalibratedRows calibratedRows(const Document& document, const CharacterPlan& plan) { return Builder(document, plan).build(); }

}  // namespace imomushi
