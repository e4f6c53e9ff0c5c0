// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/direct_names.h"

#include "core/document/cycle.h"
#include "core/document/kept_pose.h"
#include "core/document/names.h"
#include "core/input/osc_packet.h"
#include "core/mesh/render_model.h"

namespace imomushi {

std::vector<DirectName> directNames(const Document& document) {
    std::vector<DirectName> names;
    const auto add = [&](const std::string& address, const MappedTarget& target, int count) {
        if (!InputName::fits(address)) return;
        DirectName name{address, {}, count};
        name.targets.fill(target);
        for (int i = 0; i < count; ++i) {
            name.targets[static_cast<std::size_t>(i)].axis = i;
            name.targets[static_cast<std::size_t>(i)].value += i;
        }
        names.push_back(std::move(name));
    };
    const std::string root = "/imomushi/";
    for (const auto& [id, element] : document.elements)
        for (const Handle& handle : element->handles) {
            MappedTarget target;
            target.handle = {id, handle.face};
            target.kind = MappedTarget::Kind::HandlePlace;
            add(root + "handle/" + handle.face + "/position", target, 3);
            target.kind = MappedTarget::Kind::HandleTurn;
            add(root + "handle/" + handle.face + "/turn", target, 3);
        }
    for (const auto& [id, bone] : document.bones)
        for (const bool atEnd : {false, true}) {
            MappedTarget target;
            target.end = {id, atEnd};
            const std::string of = root + "bone/" + endpointText(document, target.end);
            target.kind = MappedTarget::Kind::EndPlace;
            add(of + "/position", target, 3);
            target.kind = MappedTarget::Kind::EndRoll;
            add(of + "/roll", target, 1);
        }
    for (const auto& [id, character] : document.characters)
        for (std::size_t t = 0; t < character->model->morphs.size(); ++t) {
            MappedTarget target;
            target.kind = MappedTarget::Kind::Morph;
            target.morph = {id, static_cast<std::int32_t>(t)};
            add(root + "morph/" + character->name + "/" + character->model->morphs[t].name, target, 1);
        }
    for (std::size_t i = 0; i < keptPoses(document).size(); ++i) {
        MappedTarget target;
        target.kind = MappedTarget::Kind::Pose;
        target.pose = i;
        add(root + "pose/" + keptPoses(document)[i].name, target, 1);
    }
    for (std::size_t i = 0; i < cyclesOf(document).size(); ++i)
        for (const auto& [number, kind] : {std::pair("/amount", MappedTarget::Kind::CycleAmount), std::pair("/speed", MappedTarget::Kind::CycleSpeed)}) {
            MappedTarget target;
            target.kind = kind;
            target.cycle = i;
            add(root + "cycle/" + cyclesOf(document)[i].name + number, target, 1);
        }
    for (std::size_t k = 0; k < kEffects; ++k) {
        MappedTarget target;
        target.kind = MappedTarget::Kind::Effect;
        target.effect = static_cast<EffectKind>(k);
        target.value = 0;
        if (document.effects.has(target.effect))
            for (const EffectProperty& p : effectProperties(target.effect)) {
                if (!p.rebuilds) add(root + "effect/" + std::string(effectName(target.effect)) + "/" + std::string(p.name), target, p.size);
                target.value += p.size;
            }
    }
    return names;
}

std::vector<std::string> nameMessages(const Document& document) {
    std::vector<std::string> messages;
    for (const DirectName& name : directNames(document)) messages.push_back(oscMessage("/imomushi/name", name.address, name.count));
    messages.push_back(oscMessage("/imomushi/names", "", static_cast<std::int32_t>(messages.size())));
    return messages;
}

}  // namespace imomushi
