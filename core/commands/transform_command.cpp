// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/commands/copied_parts.h"
#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/document/hanging.h"
#include "core/document/kept_pose.h"

namespace imomushi {

namespace {

constexpr double kLeastFactor = 1e-3, kLargestFactor = 1e3;

/// Moves parts of a document where they stand, and all that is said of them in the world.
class Mover {
public:
    Mover(DocumentEdit& edit, HangingParts parts, Placing placing) : edit_(edit), document_(edit.document), parts_(std::move(parts)), placing_(std::move(placing)) {}

    /// Takes keep what they show only while nothing is turned or scaled: `posesOnly` are those that show their poses from now on.
    Result<void> run(std::vector<std::string>& posesOnly) {
        for (const PartId id : parts_.characters) {
            auto& character = document_.characters.at(id);
            character = std::make_shared<const CharacterSource>(placed(*character, placing_));
        }
        const auto last = lastResponses(edit_);
        for (const PartId id : parts_.elements) placeElement(edit_, id, placing_, last(id));
        for (const PartId id : parts_.bones)
            exchangePart(document_.bones, id, [&](Bone& bone) {
                for (Bone::Place* place : {&bone.start, &bone.end})
                    if (auto* point = std::get_if<Vec3>(place)) *point = placing_.point(*point);
            });
        moveGoals(document_.goals);
        moveHandles(document_.handleGoals);
        for (auto& [part, goal] : document_.turns)
            if (parts_.characters.contains(part.character)) goal.target = placing_.rotation(goal.target), goal.from = placing_.rotation(goal.from);
        for (Touch& touch : document_.touches)
            if (parts_.elements.contains(touch.element)) touch.point = placing_.point(touch.point), touch.to = placing_.point(touch.to), touch.radius *= placing_.scale;
        movePoses();
        return moveTakes(posesOnly);
    }

private:
    void moveGoals(std::map<EndpointRef, EndpointGoal>& goals) const {
        for (auto& [end, goal] : goals) {
            if (!parts_.bones.contains(end.bone)) continue;
            goal.target = placing_.point(goal.target);
            goal.from = placing_.point(goal.from);
            if (!goal.rotation) continue;
            const Eigen::Quaterniond turned = placing_.rotation(Eigen::Quaterniond(goal.rotation->data()));
            goal.rotation = std::array{turned.x(), turned.y(), turned.z(), turned.w()};
        }
    }
    void moveHandles(std::map<FaceRef, HandleGoal>& goals) const {
        for (auto& [handle, goal] : goals)
            if (parts_.elements.contains(handle.element))
                for (HandlePose* pose : {&goal.target, &goal.from}) pose->at = placing_.point(pose->at), pose->rotation = placing_.rotation(pose->rotation);
    }
    void movePoses() {
        if (keptPoses(document_).empty()) return;
        KeptPoses poses = keptPoses(document_);
        for (KeptPose& pose : poses) {
            for (auto& [id, bone] : pose.bones)
                if (parts_.bones.contains(id)) bone.start = placing_.point(bone.start), bone.end = placing_.point(bone.end), bone.frame = placing_.rotation(bone.frame);
            moveGoals(pose.goals);
            moveHandles(pose.handles);
            for (auto& [part, turn] : pose.turns)
                if (parts_.characters.contains(part.character)) turn = placing_.rotation(turn);
        }
        setKeptPoses(document_, std::move(poses));
    }
    Result<void> moveTakes(std::vector<std::string>& posesOnly) {
        if (document_.takes.empty()) return {};
        IMOMUSHI_TRY(const auto plan, edit_.planned());
        for (auto& [id, take] : document_.takes) {
            const bool posed = std::any_of(take->bones.begin(), take->bones.end(), [&](const Take::Bone& bone) { return parts_.bones.contains(bone.bone); });
            const bool shaped = std::any_of(take->elements.begin(), take->elements.end(), [&](PartId element) { return parts_.elements.contains(element); });
            if (!posed && !shaped) continue;
            Take made = *take;
            if (posed) movePoses(made);
            if (shaped && (placing_.turns() || !shiftShapes(made, *plan))) {
                made.elements.clear();
                made.layout = {};
                made.shapes = {};
                posesOnly.push_back(made.name);
            }
            take = std::make_shared<const Take>(std::move(made));
        }
        return {};
    }
    void movePoses(Take& take) const {
        const auto points = static_cast<std::size_t>(take.points);
        std::vector<bool> moved(points, false);
        std::vector<std::size_t> turned;
        for (std::size_t b = 0; b < take.bones.size(); ++b) {
            if (!parts_.bones.contains(take.bones[b].bone)) continue;
            moved[static_cast<std::size_t>(take.bones[b].start)] = moved[static_cast<std::size_t>(take.bones[b].end)] = true;
            turned.push_back(3 * points + 4 * b);
        }
        FrameNumbers poses;
        std::vector<double> row(take.poses.width());
        for (std::size_t f = 0; f < take.times.size(); ++f) {
            take.poses.at(f, row.data());
            for (std::size_t p = 0; p < points; ++p)
                if (moved[p]) Eigen::Map<Vec3>(row.data() + 3 * p) = placing_.point(Vec3(Eigen::Map<const Vec3>(row.data() + 3 * p)));
            for (const std::size_t at : turned) Eigen::Map<Eigen::Quaterniond>(row.data() + at) = placing_.rotation(Eigen::Quaterniond(row.data() + at));
            poses.add(row);
        }
        poses.finish();
        take.poses = std::move(poses);
        for (Take::Target& target : take.targets)
            if (target.held && parts_.bones.contains(target.bone)) target.to = placing_.point(target.to);
    }
    /// False: it shows another character than this one.
    bool shiftShapes(Take& take, const CharacterPlan& plan) const {
        const ShapeLayout& layout = take.layout;
        if (take.elements != plan.elements || layout.elements.size() != plan.elements.size() || layout.joints != static_cast<int>(plan.input.joints.size())) return false;
        FrameNumbers shapes;
        std::vector<double> row(take.shapes.width());
        for (std::size_t f = 0; f < take.times.size(); ++f) {
            take.shapes.at(f, row.data());
            // x -> linear x + s, of what stands elsewhere at rest.
            const auto shift = [&](const Eigen::Matrix3d& linear, double* s) { Eigen::Map<Vec3>(s) += placing_.shift - linear * placing_.shift; };
            for (std::size_t e = 0; e < plan.elements.size(); ++e)
                if (double* at = row.data() + layout.element(e); parts_.elements.contains(plan.elements[e])) shift(Eigen::Quaterniond(at).toRotationMatrix(), at + 4);
            for (int j = 0; j < layout.joints; ++j) {
                const auto element = plan.elements[static_cast<std::size_t>(plan.input.joints[static_cast<std::size_t>(j)].faces[0].element)];
                if (double* at = row.data() + layout.joint(j); parts_.elements.contains(element)) shift(Eigen::Map<const Eigen::Matrix3d>(at + 4), at + 13);
            }
            shapes.add(row);
        }
        shapes.finish();
        take.shapes = std::move(shapes);
        return true;
    }

    DocumentEdit& edit_;
    Document& document_;
    const HangingParts parts_;
    const Placing placing_;
};

Result<Json> transform(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    std::set<PartId> wanted;
    for (const Json& given : arguments.at("names")) {
        if (!given.is_string()) return fail("bad-type", "\"names\" must be names.");
        const std::string& name = given.get_ref<const std::string&>();
        if (const CharacterSource* character = document.characterNamed(name)) {
            wanted.insert(character->id);
        } else {
            IMOMUSHI_TRY(const auto element, elementOf(document, name));
            wanted.insert(element->id);
        }
    }
    if (wanted.empty()) return fail("no-element", "There is nothing to move: name elements or characters.");
    const HangingParts parts = hangingTogether(document, wanted);
    Vec3 shift = Vec3::Zero(), about = middleOf(document, parts);
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    double scale = 1.0;
    if (const Json* given = find(arguments, "shift")) shift = *vector3(*given);
    if (const Json* given = find(arguments, "about")) about = *vector3(*given);
    if (const Json* given = find(arguments, "rotation")) {
        IMOMUSHI_TRY(rotation, rotationFrom(*given, "rotation"));
    }
    if (auto ok = readNumber(arguments, "scale", kLeastFactor, kLargestFactor, scale); !ok) return tl::unexpected(ok.error());
    const Placing placing = Placing::about(about, rotation, scale, shift);
    CopiedParts copied;
    copied.characters = parts.characters, copied.elements = parts.elements, copied.bones = parts.bones;
    if (auto ok = checkPlaces(document, copied, placing, placing.turns() ? "rotation\" or \"scale" : "shift"); !ok) return tl::unexpected(ok.error());

    std::set<PartId> solved;
    for (const PartId id : parts.elements)
        if (edit.responses().stateOf(id) == ResponseState::Fresh) solved.insert(id);
    std::vector<std::string> posesOnly;
    if (placing.moves())
        if (auto ok = Mover(edit, parts, placing).run(posesOnly); !ok) return tl::unexpected(ok.error());
    Json answer{{"elements", Json::array()}, {"characters", Json::array()}, {"bones", Json::array()}, {"stale", Json::array()}, {"takes", posesOnly}, {"about", json(about)}};
    for (const PartId id : parts.elements) answer["elements"].push_back(document.elements.at(id)->name);
    for (const PartId id : parts.characters) answer["characters"].push_back(document.characters.at(id)->name);
    for (const PartId id : parts.bones) answer["bones"].push_back(document.bones.at(id)->name);
    if (!placing.keepsShape())
        for (const PartId id : solved) answer["stale"].push_back(document.elements.at(id)->name);
    return answer;
}

}  // namespace

void addTransformCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("transform",
                       "Moves, turns and scales elements or characters at rest, with all that hangs together with them: joined elements, pieces of one character, their bones, handles, pins, "
                       "kept poses and takes. Results are moved and turned along, so that nothing is solved again; what is scaled is out of date. Takes that were recorded before a turn or a "
                       "scale show their poses from then on, without what effects added.",
                       {{"names", Type::Array, true, "Names of elements or characters."},
                        {"shift", Type::Vector3, false, "Metres ([0,0,0])."},
                        {"rotation", Type::Array, false, "A quaternion [x,y,z,w] in the axes of the world (not turned)."},
                        {"scale", Type::Number, false, "A factor, 0.001 to 1000 (1)."},
                        {"about", Type::Vector3, false, "What it is turned and scaled about, metres (the middle of the box of all that moves)."}},
                       transform);
}

}  // namespace imomushi
