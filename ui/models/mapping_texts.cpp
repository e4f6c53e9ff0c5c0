// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/mapping_texts.h"

#include <QCoreApplication>
#include <QLocale>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/document/cycle.h"
#include "core/document/kept_pose.h"
#include "core/document/names.h"
#include "core/input/key_names.h"
#include "core/input/pose_numbers.h"
#include "core/live/live_input.h"
#include "core/live/suggested_mappings.h"
#include "core/mesh/render_model.h"
#include "ui/models/effect_texts.h"

namespace imomushi {
namespace {

struct MappingTexts {
    Q_DECLARE_TR_FUNCTIONS(MappingTexts)
};

using TargetKind = MappedTarget::Kind;

constexpr double kReachTurn = std::numbers::pi / 4.0;  // radians

QString placeAxis(int axis) { return axis == 0 ? MappingTexts::tr("sideways (X)") : axis == 1 ? MappingTexts::tr("up (Y)") : MappingTexts::tr("forward (Z)"); }
QString turnAxis(int axis) { return MappingTexts::tr("turn %1", "about an axis").arg(QChar(u'X' + axis)); }

bool turns(TargetKind kind) { return kind == TargetKind::HandleTurn || kind == TargetKind::BoneTurn || kind == TargetKind::EndRoll; }
bool places(TargetKind kind) { return kind == TargetKind::HandlePlace || kind == TargetKind::EndPlace; }

QString triggerText(const QString& take, bool plays) { return plays ? MappingTexts::tr("Play “%1”", "a take").arg(take) : MappingTexts::tr("Stop “%1”", "a take").arg(take); }

LiveInput inputOf(const MappedTarget& target) {
    LiveInput input;
    input.kind = LiveInput::Kind::Effect;
    input.effect = target.effect;
    input.value = target.value;
    return input;
}

QString numberText(const EffectProperty& property, int axis) {
    const QString title = effectPropertyTitle(property);
    return property.size == 1 ? title : MappingTexts::tr("%1 %2", "a setting of an effect, X, Y or Z").arg(title).arg(QChar(u'X' + axis));
}

TargetText effectTarget(const MappedTarget& target) {
    const auto& [property, first] = propertyOf(inputOf(target));
    TargetText said;
    said.thing = effectTitle(target.effect);
    said.number = numberText(property, target.value - first);
    said.unit = QString::fromUtf8(property.unit.data(), qsizetype(property.unit.size()));
    said.there = true;
    return said;
}

/// Controls whose names are words, by what they are called in a row; empty: it is called as it is.
QString knownControl(std::string_view channel) {
    static constexpr std::pair<std::string_view, const char*> kWords[] = {
        {"arrows", QT_TRANSLATE_NOOP("MappingTexts", "arrow keys")}, {"space", QT_TRANSLATE_NOOP("MappingTexts", "space bar")}, {"backspace", QT_TRANSLATE_NOOP("MappingTexts", "backspace")}, {"enter", QT_TRANSLATE_NOOP("MappingTexts", "enter")},
        {"left-x", QT_TRANSLATE_NOOP("MappingTexts", "left stick ↔")}, {"left-y", QT_TRANSLATE_NOOP("MappingTexts", "left stick ↕")}, {"right-x", QT_TRANSLATE_NOOP("MappingTexts", "right stick ↔")}, {"right-y", QT_TRANSLATE_NOOP("MappingTexts", "right stick ↕")},
        {"left-trigger", QT_TRANSLATE_NOOP("MappingTexts", "left trigger")}, {"right-trigger", QT_TRANSLATE_NOOP("MappingTexts", "right trigger")}, {"left-shoulder", QT_TRANSLATE_NOOP("MappingTexts", "left shoulder button")}, {"right-shoulder", QT_TRANSLATE_NOOP("MappingTexts", "right shoulder button")},
        {"level", QT_TRANSLATE_NOOP("MappingTexts", "loudness")}, {"aa", QT_TRANSLATE_NOOP("MappingTexts", "mouth “aa”")}, {"ih", QT_TRANSLATE_NOOP("MappingTexts", "mouth “ih”")}, {"ou", QT_TRANSLATE_NOOP("MappingTexts", "mouth “ou”")}, {"ee", QT_TRANSLATE_NOOP("MappingTexts", "mouth “ee”")}, {"oh", QT_TRANSLATE_NOOP("MappingTexts", "mouth “oh”")}};
    for (const auto& [name, words] : kWords)
        if (name == channel) return MappingTexts::tr(words);
    return {};
}

}  // namespace

QString TargetText::text() const { return number.isEmpty() ? thing : MappingTexts::tr("%1, %2", "a handle, a number of it").arg(thing, number); }

QString TargetText::briefText() const { return mark.isEmpty() ? text() : QStringLiteral("%1  %2").arg(thing, mark); }

TargetText targetText(const Document& document, const std::string& target) {
    TargetText said;
    const auto found = mappedTarget(document, target);
    if (!found) {
        said.thing = QString::fromStdString(target);
        return said;
    }
    said.there = true;
    switch (found->kind) {
        case TargetKind::HandlePlace:
        case TargetKind::HandleTurn: said.thing = QString::fromStdString(found->handle.face); break;
        case TargetKind::EndPlace:
        case TargetKind::EndRoll:
            said.thing = found->end.atEnd ? MappingTexts::tr("%1 end", "a bone").arg(QString::fromStdString(document.bones.at(found->end.bone)->name))
                                          : MappingTexts::tr("%1 start", "a bone").arg(QString::fromStdString(document.bones.at(found->end.bone)->name));
            break;
        case TargetKind::BoneTurn: said.thing = QString::fromStdString(document.bones.at(found->end.bone)->name); break;
        case TargetKind::Effect: return effectTarget(*found);
        case TargetKind::PlayTake:
        case TargetKind::StopTake:
        case TargetKind::LetGo:
            said.trigger = true;
            said.thing = found->kind == TargetKind::LetGo ? MappingTexts::tr("Stop every input") : triggerText(QString::fromStdString(document.takes.at(found->take)->name), found->kind == TargetKind::PlayTake);
            return said;
        case TargetKind::Pose: said.thing = MappingTexts::tr("Pose “%1”", "a kept pose").arg(QString::fromStdString(keptPoses(document)[found->pose].name)); break;
        case TargetKind::CycleAmount:
        case TargetKind::CycleSpeed:
            said.thing = MappingTexts::tr("Cycle “%1”", "a movement that repeats").arg(QString::fromStdString(cyclesOf(document)[found->cycle].name));
            said.number = found->kind == TargetKind::CycleAmount ? MappingTexts::tr("amount", "of a cycle") : MappingTexts::tr("speed", "of a cycle");
            return said;
        case TargetKind::Morph: said.thing = QString::fromStdString(document.characters.at(found->morph.character)->model->morphs[std::size_t(found->morph.target)].name); break;
    }
    if (places(found->kind)) {
        said.number = placeAxis(found->axis);
        said.mark = found->axis == 0 ? QStringLiteral("X ↔") : found->axis == 1 ? QStringLiteral("Y ↕") : QStringLiteral("Z ↗");
        said.unit = QStringLiteral("m");
    } else if (turns(found->kind)) {
        said.number = found->kind == TargetKind::EndRoll ? MappingTexts::tr("roll") : turnAxis(found->axis);
        if (found->kind != TargetKind::EndRoll) said.mark = QStringLiteral("%1 ↻").arg(QChar(u'X' + found->axis));
        said.unit = QStringLiteral("°");
        said.factor = 180.0 / std::numbers::pi;
    } else {
        said.number = MappingTexts::tr("weight");
    }
    return said;
}

QString targetValueText(const TargetText& target, double value) {
    const double shown = value * target.factor;
    const int decimals = target.unit == u"°" ? 0 : std::abs(shown) < 10.0 ? 2 : 1;
    const QString number = QLocale().toString(shown, 'f', decimals);
    return target.unit.isEmpty() ? number : target.unit == u"°" ? number + target.unit : QStringLiteral("%1 %2").arg(number, target.unit);
}

QString sourceText(const std::string& source) {
    const auto protocol = protocolNamed(source);
    return protocol ? protocolText(*protocol) : QString::fromStdString(source);
}

QString channelText(const InputMapping& mapping) {
    const QString channel = QString::fromStdString(mapping.row.channel);
    const int component = mapping.row.component;
    for (const QLatin1String kind : {QLatin1String("bone/"), QLatin1String("tracker/"), QLatin1String("controller/"), QLatin1String("hmd/")})
        if (channel.startsWith(kind) && (component < kPoseRotation || component >= kPoseTurn))
            return MappingTexts::tr("%1, %2", "a control, a number of it").arg(channel.mid(kind.size()), component < kPoseRotation ? placeAxis(component) : turnAxis(component - kPoseTurn));
    if (channel.startsWith(QLatin1String("blend/"))) return channel.mid(6);
    const QString known = knownControl(mapping.row.channel);
    if (component < 2 && std::any_of(kKeySticks.begin(), kKeySticks.end(), [&](const KeyStick& s) { return s.name == mapping.row.channel; }))
        return (known.isEmpty() ? channel.toUpper() : known) + (component == 0 ? QStringLiteral(" ↔") : QStringLiteral(" ↕"));
    if (component == 0 && !known.isEmpty()) return known;
    return component == 0 ? channel : MappingTexts::tr("%1, number %2", "a control").arg(channel).arg(component + 1);
}

QString protocolText(InputProtocol protocol) {
    switch (protocol) {
        case InputProtocol::Osc: return QStringLiteral("OSC");
        case InputProtocol::Vmc: return QStringLiteral("VMC");
        case InputProtocol::Midi: return QStringLiteral("MIDI");
        case InputProtocol::Pad: return MappingTexts::tr("Game controller");
        case InputProtocol::Keys: return MappingTexts::tr("Keyboard");
        case InputProtocol::Voice: return MappingTexts::tr("Microphone");
    }
    return {};
}

std::vector<DrivenThing> drivenThings(const Document& document) {
    std::vector<DrivenThing> things;
    const char* const axes = "xyz";
    const auto addAxes = [&](DrivenThing& thing, const std::string& of, const QString& what) {
        for (int k = 0; k < 3; ++k) thing.numbers.emplace_back(what.isEmpty() ? placeAxis(k) : MappingTexts::tr("%1, %2", "an end of a bone, a direction").arg(what, placeAxis(k)), of + axes[k]);
    };
    const auto addTurns = [&](DrivenThing& thing, const std::string& of) {
        for (int k = 0; k < 3; ++k) thing.numbers.emplace_back(turnAxis(k), of + "turn-" + axes[k]);
    };
    for (const auto& [id, element] : document.elements)
        for (const Handle& handle : element->handles) {
            DrivenThing thing{QString::fromStdString(handle.face), QStringLiteral("handle"), {}};
            const std::string of = "handle/" + handle.face + "/";
            addAxes(thing, of, {});
            addTurns(thing, of);
            things.push_back(std::move(thing));
        }
    for (const auto& [id, bone] : document.bones) {
        DrivenThing thing{QString::fromStdString(bone->name), QStringLiteral("bone"), {}};
        const std::string of = "bone/" + bone->name + "/";
        addAxes(thing, of + "end/", MappingTexts::tr("end"));
        addTurns(thing, of);
        thing.numbers.emplace_back(MappingTexts::tr("roll"), of + "end/roll");
        addAxes(thing, of + "start/", MappingTexts::tr("start"));
        things.push_back(std::move(thing));
    }
    for (const auto& [id, character] : document.characters) {
        if (character->model->morphs.empty()) continue;
        DrivenThing thing{MappingTexts::tr("Shapes of %1", "morph targets of a character").arg(QString::fromStdString(character->name)), QStringLiteral("character"), {}};
        for (const auto& morph : character->model->morphs) thing.numbers.emplace_back(QString::fromStdString(morph.name), "morph/" + character->name + "/" + morph.name);
        things.push_back(std::move(thing));
    }
    if (!keptPoses(document).empty()) {
        DrivenThing thing{MappingTexts::tr("Poses"), QStringLiteral("pose"), {}};
        for (const KeptPose& pose : keptPoses(document)) thing.numbers.emplace_back(QString::fromStdString(pose.name), "pose/" + pose.name + "/weight");
        things.push_back(std::move(thing));
    }
    if (!cyclesOf(document).empty()) {
        DrivenThing thing{MappingTexts::tr("Cycles"), QStringLiteral("loop"), {}};
        for (const Cycle& cycle : cyclesOf(document)) {
            const QString name = QString::fromStdString(cycle.name);
            thing.numbers.emplace_back(MappingTexts::tr("%1, amount", "a cycle").arg(name), "cycle/" + cycle.name + "/amount");
            thing.numbers.emplace_back(MappingTexts::tr("%1, speed", "a cycle").arg(name), "cycle/" + cycle.name + "/speed");
        }
        things.push_back(std::move(thing));
    }
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto kind = EffectKind(k);
        if (!document.effects.has(kind)) continue;
        DrivenThing thing{effectTitle(kind), QStringLiteral("spring"), {}};
        for (const EffectProperty& property : effectProperties(kind)) {
            const std::string of = "effect/" + std::string(effectName(kind)) + "/" + std::string(property.name);
            for (int axis = 0; axis < property.size && !property.rebuilds; ++axis) thing.numbers.emplace_back(numberText(property, axis), property.size == 1 ? of : of + "/" + axes[axis]);
        }
        if (!thing.numbers.empty()) things.push_back(std::move(thing));
    }
    DrivenThing happens{MappingTexts::tr("Triggers"), QStringLiteral("play"), {}};
    for (const auto& [id, take] : document.takes)
        for (const bool plays : {true, false}) happens.numbers.emplace_back(triggerText(QString::fromStdString(take->name), plays), "take/" + take->name + (plays ? "/play" : "/stop"));
    happens.numbers.emplace_back(MappingTexts::tr("Stop every input"), "trigger/let-go");
    if (!things.empty()) things.push_back(std::move(happens));
    return things;
}

std::string targetOf(const Document& document, const SelectionItem& item) {
    std::string target;
    if (item.kind == SelectionItem::Kind::Face) target = "handle/" + item.face + "/y";
    if (const auto bone = document.bones.find(item.part); bone != document.bones.end()) {
        if (item.kind == SelectionItem::Kind::Endpoint) target = "bone/" + bone->second->name + (item.atEnd ? "/end/y" : "/start/y");
        if (item.kind == SelectionItem::Kind::Bone) target = "bone/" + bone->second->name + "/turn-x";
    }
    return target.empty() || !mappedTarget(document, target) ? std::string() : target;
}

std::pair<double, double> usualReach(const Document& document, const MappedTarget& target, bool twoSided) {
    if (target.kind == TargetKind::Effect) {
        // From where it is on, as far again; a stick has that in its middle.
        const EffectProperty& property = propertyOf(inputOf(target)).first;
        const double now = document.effects[target.effect].values[std::size_t(target.value)], way = now != 0.0 ? std::abs(now) : 1.0;
        return {std::clamp(twoSided ? now - way : now, property.low, property.high), std::clamp(now + way, property.low, property.high)};
    }
    if (target.kind == TargetKind::CycleAmount) return {0.0, 1.0};
    // A fader leads from standing to twice as fast, a stick backwards, too.
    if (target.kind == TargetKind::CycleSpeed) return {twoSided ? -2.0 : 0.0, 2.0};
    const double reach = places(target.kind) ? usualReach(document) : turns(target.kind) ? kReachTurn : 1.0;
    return {twoSided && target.kind != TargetKind::Morph && target.kind != TargetKind::Pose && !target.isTrigger() ? -reach : 0.0, reach};
}

}  // namespace imomushi
