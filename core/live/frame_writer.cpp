// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/frame_writer.h"

#include <algorithm>
#include <cmath>

#include "core/base/rotation_vector.h"
#include "core/document/avatar.h"
#include "core/document/names.h"
#include "core/input/input_value.h"
#include "core/live/live_character.h"
#include "core/live/pose_parts.h"
#include "core/live/suggested_mappings.h"

namespace imomushi {

namespace {

/// The weight at which an expression is shown whole, at most: a target that an expression needs least of says how much of it is there.
double shareOf(const std::vector<std::pair<std::size_t, double>>& needed, const std::vector<double>& weights) {
    double share = needed.empty() ? 0.0 : 1.0;
    for (const auto& [morph, amount] : needed) share = std::min(share, morph < weights.size() ? weights[morph] / amount : 0.0);
    return std::max(share, 0.0);
}

}  // namespace

void showFrame(const LiveCharacter& live, ShownFrame& frame) {
    frame.pose = live.presentPose();
    frame.handles.clear();
    for (std::size_t i = 0; i < live.plan().handles.size(); ++i) frame.handles.push_back(live.presentHandle(static_cast<int>(i)));
    frame.morphs.clear();
    for (std::size_t c = 0; c < live.plan().characters.size(); ++c) {
        const auto& weights = live.presentMorphs(static_cast<int>(c));
        frame.morphs.insert(frame.morphs.end(), weights.begin(), weights.end());
    }
}

std::optional<OutputProtocol> outputProtocolNamed(std::string_view name) {
    for (const auto protocol : {OutputProtocol::Vmc, OutputProtocol::Osc})
        if (outputProtocolName(protocol) == name) return protocol;
    return std::nullopt;
}

std::string_view outputProtocolName(OutputProtocol protocol) { return protocol == OutputProtocol::Vmc ? "vmc" : "osc"; }

FrameWriter::FrameWriter(OutputProtocol protocol, const Document& document, const CharacterPlan& plan)
    : protocol_(protocol), skeleton_(plan.input.skeleton), tree_(boneTree(skeleton_)), rest_(restPose(skeleton_)) {
    const bool osc = protocol == OutputProtocol::Osc;
    const std::string root = "/imomushi/";
    for (std::size_t i = 0; i < plan.handles.size(); ++i) {
        const std::string& name = plan.handles[i].face;
        if (!osc) handles_.push_back({name, {}, i});
        else if (const std::string of = root + "handle/" + name; InputName::fits(of + "/position")) handles_.push_back({of + "/position", of + "/turn", i});
    }
    // Of several ends at one point one is named, an end rather than a start.
    for (const bool atEnd : {true, false})
        for (const auto& [end, point] : plan.points)
            if (const std::string of = root + "bone/" + endpointText(document, end); osc && end.atEnd == atEnd && InputName::fits(of + "/position") && std::ranges::find(ends_, static_cast<std::size_t>(point), &Named::of) == ends_.end())
                ends_.push_back({of + "/position", of + "/roll", static_cast<std::size_t>(point)});
    std::size_t first = 0;
    for (const PartId id : plan.characters) {
        const CharacterSource* character = document.characters.at(id).get();
        const std::size_t begin = first;
        for (const MorphTarget& morph : character->model->morphs) {
            const std::string name = osc ? root + "morph/" + character->name + "/" + morph.name : morph.name;
            if (!osc || InputName::fits(name)) morphs_.push_back({name, {}, first});
            ++first;
        }
        if (!character->rig || osc) continue;
        for (const AvatarExpression& given : avatarFacts(*character->rig).expressions) {
            Expression made{olderExpressionName(given.name), {}};
            for (const auto& [target, amount] : given.morphs)
                if (const int t = character->model->morphIndex(target); t >= 0 && amount > 0.0) made.morphs.emplace_back(begin + static_cast<std::size_t>(t), amount);
            if (!made.morphs.empty()) expressions_.push_back(std::move(made));
        }
    }
    if (osc) return;
    // What an expression says is not said twice.
    std::erase_if(morphs_, [this](const Named& morph) { return std::ranges::find(expressions_, morph.address, &Expression::name) != expressions_.end(); });
    std::vector<int> humanOf(skeleton_.bones.size(), -1);
    const auto roles = bonesByRole(document, plan);
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {  // parents come first
        const std::string& name = document.bones.at(plan.bones[b])->name;
        const auto role = std::find_if(roles.begin(), roles.end(), [&](const auto& r) { return r.second == name; });
        if (role == roles.end()) continue;
        HumanBone made{vmcBoneName(role->first), b, -1};
        for (int up = tree_.parent[b]; up >= 0 && made.parent < 0; up = tree_.parent[static_cast<std::size_t>(up)]) made.parent = humanOf[static_cast<std::size_t>(up)];
        humanOf[b] = static_cast<int>(human_.size());
        human_.push_back(std::move(made));
    }
    whole_.assign(human_.size(), Eigen::Quaterniond::Identity());
}

void FrameWriter::write(const ShownFrame& frame, double time, const std::function<void(std::span<const std::byte>)>& send) {
    bundle_.begin(send);
    if (protocol_ == OutputProtocol::Vmc) writeVmc(frame, time);
    else writeOsc(frame);
    bundle_.end();
}

void FrameWriter::placed(std::string_view address, std::string_view name, const Vec3& at, const Eigen::Quaterniond& turn) {
    const auto f = [](double number) { return static_cast<float>(number); };
    bundle_.message(address, name, {f(-at.x()), f(at.y()), f(at.z()), f(turn.x()), f(-turn.y()), f(-turn.z()), f(turn.w())});
}

void FrameWriter::writeVmc(const ShownFrame& frame, double time) {
    const Pose& pose = fits(skeleton_, frame.pose) ? frame.pose : rest_;
    bundle_.message("/VMC/Ext/OK", std::int32_t{1});
    bundle_.message("/VMC/Ext/T", {static_cast<float>(time)});
    placed("/VMC/Ext/Root/Pos", "root", Vec3::Zero(), Eigen::Quaterniond::Identity());
    for (std::size_t h = 0; h < human_.size(); ++h) {
        const HumanBone& human = human_[h];
        const auto startOf = [&](std::size_t bone) -> const Vec3& { return pose.points[static_cast<std::size_t>(skeleton_.bones[bone].start)]; };
        whole_[h] = wholeRotation(tree_, human.bone, pose.frames[human.bone], pose.roll[static_cast<std::size_t>(skeleton_.bones[human.bone].end)]);
        const Eigen::Quaterniond carried = human.parent < 0 ? Eigen::Quaterniond::Identity() : whole_[static_cast<std::size_t>(human.parent)];
        const Vec3 from = human.parent < 0 ? Vec3(Vec3::Zero()) : startOf(human_[static_cast<std::size_t>(human.parent)].bone);
        placed("/VMC/Ext/Bone/Pos", human.name, carried.conjugate() * (startOf(human.bone) - from), (carried.conjugate() * whole_[h]).normalized());
    }
    for (const Named& handle : handles_)
        if (handle.of < frame.handles.size()) placed("/VMC/Ext/Tra/Pos", handle.address, frame.handles[handle.of].at, frame.handles[handle.of].rotation);
    for (const Expression& expression : expressions_) bundle_.message("/VMC/Ext/Blend/Val", expression.name, {static_cast<float>(shareOf(expression.morphs, frame.morphs))});
    for (const Named& morph : morphs_)
        if (morph.of < frame.morphs.size()) bundle_.message("/VMC/Ext/Blend/Val", morph.address, {static_cast<float>(frame.morphs[morph.of])});
    if (!morphs_.empty() || !expressions_.empty()) bundle_.message("/VMC/Ext/Blend/Apply");
}

void FrameWriter::writeOsc(const ShownFrame& frame) {
    const Pose& pose = fits(skeleton_, frame.pose) ? frame.pose : rest_;
    const auto vector = [&](const std::string& address, const Vec3& v) { bundle_.message(address, {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}); };
    for (const Named& end : ends_) {
        vector(end.address, pose.points[end.of]);
        bundle_.message(end.second, {static_cast<float>(pose.roll[end.of])});
    }
    for (const Named& handle : handles_) {
        if (handle.of >= frame.handles.size()) continue;
        vector(handle.address, frame.handles[handle.of].at);
        vector(handle.second, rotationVector(frame.handles[handle.of].rotation));
    }
    for (const Named& morph : morphs_)
        if (morph.of < frame.morphs.size()) bundle_.message(morph.address, {static_cast<float>(frame.morphs[morph.of])});
}

}  // namespace imomushi
