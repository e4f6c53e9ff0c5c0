// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/effect_texts.h"

#include <QCoreApplication>
#include <QLocale>
#include <array>
#include <map>
#include <string>

namespace imomushi {
namespace {

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(EffectTexts)
};

struct Words {
    const char* title;
    const char* help;
};

// By EffectKind.
constexpr std::array<Words, kEffects> kWords = {{
    {QT_TRANSLATE_NOOP("Effects", "Bone dynamics"), QT_TRANSLATE_NOOP("Effects", "Bones swing, stretch and settle after each move.")},
    {QT_TRANSLATE_NOOP("Effects", "Smooth joints"), QT_TRANSLATE_NOOP("Effects", "Joints take the shape of least energy: bends without a crease.")},
    {QT_TRANSLATE_NOOP("Effects", "Bend warp"), QT_TRANSLATE_NOOP("Effects", "Strong bends and twists keep their volume and do not fold.")},
    {QT_TRANSLATE_NOOP("Effects", "Joint dynamics"), QT_TRANSLATE_NOOP("Effects", "Joints jiggle softly after each move.")},
    {QT_TRANSLATE_NOOP("Effects", "Previous model"),
     QT_TRANSLATE_NOOP("Effects", "Joint faces move by the explicit dynamics of the paper’s previous model. For comparison: it is slow and may diverge.")},
    {QT_TRANSLATE_NOOP("Effects", "Gravity and inertia"), QT_TRANSLATE_NOOP("Effects", "Flesh sags under its weight and lags behind when it is moved.")},
    {QT_TRANSLATE_NOOP("Effects", "Inflate"), QT_TRANSLATE_NOOP("Effects", "Pressure inside puffs the body up, and lets it breathe.")},
    {QT_TRANSLATE_NOOP("Effects", "Touch"), QT_TRANSLATE_NOOP("Effects", "Fingers press dents into the surface (touch tool, T).")},
    {QT_TRANSLATE_NOOP("Effects", "Ground"), QT_TRANSLATE_NOOP("Effects", "Bodies rest on a plane and do not sink through it.")},
}};

const std::map<std::string, Words> kProperties = {
    {"bone-dynamics/stretch-hertz", {QT_TRANSLATE_NOOP("Effects", "Stretch"), QT_TRANSLATE_NOOP("Effects", "How fast bones swing in their length.")}},
    {"bone-dynamics/stretch-damping",
     {QT_TRANSLATE_NOOP("Effects", "Stretch damping"), QT_TRANSLATE_NOOP("Effects", "Damping ratio of the length. 0: it never stops; 1: no swing.")}},
    {"bone-dynamics/swing-hertz", {QT_TRANSLATE_NOOP("Effects", "Swing"), QT_TRANSLATE_NOOP("Effects", "How fast the angles between bones swing.")}},
    {"bone-dynamics/swing-damping",
     {QT_TRANSLATE_NOOP("Effects", "Swing damping"), QT_TRANSLATE_NOOP("Effects", "Damping ratio of the angles. 0: they never stop; 1: no swing.")}},
    {"bone-dynamics/roll-hertz", {QT_TRANSLATE_NOOP("Effects", "Roll"), QT_TRANSLATE_NOOP("Effects", "How fast bones swing about themselves.")}},
    {"bone-dynamics/roll-damping",
     {QT_TRANSLATE_NOOP("Effects", "Roll damping"), QT_TRANSLATE_NOOP("Effects", "Damping ratio of the roll. 0: it never stops; 1: no swing.")}},
    {"bone-dynamics/return-hertz",
     {QT_TRANSLATE_NOOP("Effects", "Return"),
      QT_TRANSLATE_NOOP("Effects", "How fast a body that nothing holds comes back. 0: it floats and falls, as it always does above the ground.")}},
    {"joint-dynamics/hertz", {QT_TRANSLATE_NOOP("Effects", "Jiggle"), QT_TRANSLATE_NOOP("Effects", "How fast the softest part of a joint jiggles.")}},
    {"joint-dynamics/damping", {QT_TRANSLATE_NOOP("Effects", "Damping"), QT_TRANSLATE_NOOP("Effects", "Damping ratio. 0: it never stops; 1: no jiggle.")}},
    {"previous-model/step", {QT_TRANSLATE_NOOP("Effects", "Time step"), QT_TRANSLATE_NOOP("Effects", "Time step of the explicit integration. Longer ones diverge.")}},
    {"previous-model/damping", {QT_TRANSLATE_NOOP("Effects", "Damping"), QT_TRANSLATE_NOOP("Effects", "Damping of the velocities of joint-face vertices.")}},
    {"previous-model/shear-modulus", {QT_TRANSLATE_NOOP("Effects", "Shear modulus"), QT_TRANSLATE_NOOP("Effects", "Shear modulus of elements with stiffness 1.")}},
    {"gravity/acceleration", {QT_TRANSLATE_NOOP("Effects", "Gravity"), QT_TRANSLATE_NOOP("Effects", "Acceleration of free fall, in the world.")}},
    {"gravity/shear-modulus",
     {QT_TRANSLATE_NOOP("Effects", "Shear modulus"), QT_TRANSLATE_NOOP("Effects", "Shear modulus of elements with stiffness 1: softer flesh sags more.")}},
    {"gravity/inertia", {QT_TRANSLATE_NOOP("Effects", "Inertia"), QT_TRANSLATE_NOOP("Effects", "How much of its own acceleration the flesh feels. 0: none.")}},
    {"inflate/pressure", {QT_TRANSLATE_NOOP("Effects", "Pressure"), QT_TRANSLATE_NOOP("Effects", "Pressure over the shear modulus. Above 0 it puffs up, below it shrivels.")}},
    {"inflate/breath", {QT_TRANSLATE_NOOP("Effects", "Breath"), QT_TRANSLATE_NOOP("Effects", "How much the pressure rises and falls with each breath. 0: none.")}},
    {"inflate/breath-hertz", {QT_TRANSLATE_NOOP("Effects", "Breathing"), QT_TRANSLATE_NOOP("Effects", "Breaths per second.")}},
    {"touch/patches", {QT_TRANSLATE_NOOP("Effects", "Patches"), QT_TRANSLATE_NOOP("Effects", "How many patches of a surface fingers act on. More of them make finer dents, and a longer precompute.")}},
    {"touch/friction", {QT_TRANSLATE_NOOP("Effects", "Friction"), QT_TRANSLATE_NOOP("Effects", "Coulomb’s coefficient between a finger and the surface. 0: it only pushes straight in.")}},
    {"touch/release", {QT_TRANSLATE_NOOP("Effects", "Release"), QT_TRANSLATE_NOOP("Effects", "In this time a dent goes back after its finger lifts.")}},
    {"ground/height", {QT_TRANSLATE_NOOP("Effects", "Height"), QT_TRANSLATE_NOOP("Effects", "Height of the plane.")}},
    {"ground/friction", {QT_TRANSLATE_NOOP("Effects", "Friction"), QT_TRANSLATE_NOOP("Effects", "Coulomb’s coefficient between bodies and the ground, with bone dynamics.")}},
};

struct Warning {
    FrameWarning warning;
    bool severe;
    const char* text;
};

// The worst first.
constexpr Warning kWarnings[] = {
    {FrameWarning::PoseRefused, true, QT_TRANSLATE_NOOP("Effects", "A pose was not finite; the last good one stays. Go back to rest.")},
    {FrameWarning::BasisLosesTwist, true,
     QT_TRANSLATE_NOOP("Effects", "The pose twists a joint face, which the joint modes “Paper” cannot follow: choose “Affine”.")},
    {FrameWarning::Diverged, true, QT_TRANSLATE_NOOP("Effects", "The previous model diverged: its joints stand still. Choose a smaller step or softer flesh.")},
    {FrameWarning::LoadsBounded, false, QT_TRANSLATE_NOOP("Effects", "Gravity or pressure is too strong for flesh so soft: it acts less than asked for.")},
    {FrameWarning::TargetOutOfReach, false, QT_TRANSLATE_NOOP("Effects", "Out of reach: the bones stretch no farther.")},
};

const Words* wordsOf(EffectKind effect, const EffectProperty& property) {
    const auto found = kProperties.find(std::string(effectName(effect)) + "/" + std::string(property.name));
    return found == kProperties.end() ? nullptr : &found->second;
}

QString translated(const char* text) { return QCoreApplication::translate("Effects", text); }
QString english(std::string_view text) { return QString::fromUtf8(text.data(), qsizetype(text.size())); }

}  // namespace

QString effectTitle(EffectKind effect) { return translated(kWords[std::size_t(effect)].title); }
QString effectHelp(EffectKind effect) { return translated(kWords[std::size_t(effect)].help); }

QString effectPropertyTitle(EffectKind effect, const EffectProperty& property) {
    const Words* words = wordsOf(effect, property);
    return words ? translated(words->title) : english(property.name);
}

QString effectPropertyHelp(EffectKind effect, const EffectProperty& property) {
    const Words* words = wordsOf(effect, property);
    return words ? translated(words->help) : english(property.help);
}

std::vector<WarningText> warningTexts(unsigned warnings) {
    std::vector<WarningText> texts;
    for (const Warning& w : kWarnings)
        if (warnings & unsigned(w.warning)) texts.push_back({w.warning, w.severe, translated(w.text)});
    return texts;
}

QString frameTimeText(double milliseconds) {
    const QLocale locale;
    if (milliseconds < kShownMs) return Texts::tr("below %1 ms").arg(locale.toString(0.01, 'f', 2));
    return Texts::tr("%1 ms").arg(locale.toString(milliseconds, 'f', milliseconds < 10.0 ? 2 : milliseconds < 100.0 ? 1 : 0));
}

}  // namespace imomushi
