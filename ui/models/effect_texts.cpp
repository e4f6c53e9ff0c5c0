// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/effect_texts.h"

#include <QCoreApplication>
#include <QLocale>
#include <algorithm>
#include <iterator>

namespace imomushi {
namespace {

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(EffectTexts)
};

struct PropertyWords {
    std::string_view name;
    const char *title, *help;
};
struct EffectWords {
    EffectKind kind;
    const char *title, *help;
    std::vector<PropertyWords> properties;
};

// One row per effect.
const EffectWords kWords[] = {
    {EffectKind::BoneDynamics, QT_TRANSLATE_NOOP("Effects", "Bone dynamics"),
     QT_TRANSLATE_NOOP("Effects", "Bones swing, stretch and settle after each move."),
     {
         {"stretch-hertz", QT_TRANSLATE_NOOP("Effects", "Stretch"), QT_TRANSLATE_NOOP("Effects", "How fast bones swing in their length.")},
         {"stretch-damping", QT_TRANSLATE_NOOP("Effects", "Stretch damping"),
          QT_TRANSLATE_NOOP("Effects", "Damping ratio of the length. 0: it never stops; 1: no swing.")},
         {"swing-hertz", QT_TRANSLATE_NOOP("Effects", "Swing"), QT_TRANSLATE_NOOP("Effects", "How fast the angles between bones swing.")},
         {"swing-damping", QT_TRANSLATE_NOOP("Effects", "Swing damping"),
          QT_TRANSLATE_NOOP("Effects", "Damping ratio of the angles. 0: they never stop; 1: no swing.")},
         {"roll-hertz", QT_TRANSLATE_NOOP("Effects", "Roll"), QT_TRANSLATE_NOOP("Effects", "How fast bones swing about themselves.")},
         {"roll-damping", QT_TRANSLATE_NOOP("Effects", "Roll damping"),
          QT_TRANSLATE_NOOP("Effects", "Damping ratio of the roll. 0: it never stops; 1: no swing.")},
         {"return-hertz", QT_TRANSLATE_NOOP("Effects", "Return"),
          QT_TRANSLATE_NOOP("Effects", "How fast a body that nothing holds comes back. 0: it floats and falls, as it always does above the ground.")},
     }},
    {EffectKind::SmoothJoints, QT_TRANSLATE_NOOP("Effects", "Smooth joints"),
     QT_TRANSLATE_NOOP("Effects", "Joints take the shape of least energy: bends without a crease."),
     {}},
    {EffectKind::BendWarp, QT_TRANSLATE_NOOP("Effects", "Bend warp"),
     QT_TRANSLATE_NOOP("Effects", "Strong bends and twists keep their volume and do not fold."),
     {}},
    {EffectKind::JointDynamics, QT_TRANSLATE_NOOP("Effects", "Joint dynamics"),
     QT_TRANSLATE_NOOP("Effects", "Joints jiggle softly after each move."),
     {
         {"hertz", QT_TRANSLATE_NOOP("Effects", "Jiggle"), QT_TRANSLATE_NOOP("Effects", "How fast the softest part of a joint jiggles.")},
         {"damping", QT_TRANSLATE_NOOP("Effects", "Damping"), QT_TRANSLATE_NOOP("Effects", "Damping ratio. 0: it never stops; 1: no jiggle.")},
     }},
    {EffectKind::PreviousModel, QT_TRANSLATE_NOOP("Effects", "Previous model"),
     QT_TRANSLATE_NOOP("Effects", "Joint faces move by the explicit dynamics of the paper’s previous model. For comparison: it is slow and may diverge."),
     {
         {"step", QT_TRANSLATE_NOOP("Effects", "Time step"),
          QT_TRANSLATE_NOOP("Effects", "Time step of the explicit integration. Longer ones diverge.")},
         {"damping", QT_TRANSLATE_NOOP("Effects", "Damping"), QT_TRANSLATE_NOOP("Effects", "Damping of the velocities of joint-face vertices.")},
         {"shear-modulus", QT_TRANSLATE_NOOP("Effects", "Shear modulus"), QT_TRANSLATE_NOOP("Effects", "Shear modulus of elements with stiffness 1.")},
     }},
    {EffectKind::Gravity, QT_TRANSLATE_NOOP("Effects", "Gravity and inertia"),
     QT_TRANSLATE_NOOP("Effects", "Flesh sags under its weight and lags behind when it is moved."),
     {
         {"acceleration", QT_TRANSLATE_NOOP("Effects", "Gravity"), QT_TRANSLATE_NOOP("Effects", "Acceleration of free fall, in the world.")},
         {"shear-modulus", QT_TRANSLATE_NOOP("Effects", "Shear modulus"),
          QT_TRANSLATE_NOOP("Effects", "Shear modulus of elements with stiffness 1: softer flesh sags more.")},
         {"inertia", QT_TRANSLATE_NOOP("Effects", "Inertia"),
          QT_TRANSLATE_NOOP("Effects", "How much of its own acceleration the flesh feels. 0: none.")},
     }},
    {EffectKind::Inflate, QT_TRANSLATE_NOOP("Effects", "Inflate"),
     QT_TRANSLATE_NOOP("Effects", "Pressure inside puffs the body up, and lets it breathe."),
     {
         {"pressure", QT_TRANSLATE_NOOP("Effects", "Pressure"),
          QT_TRANSLATE_NOOP("Effects", "Pressure over the shear modulus. Above 0 it puffs up, below it shrivels.")},
         {"breath", QT_TRANSLATE_NOOP("Effects", "Breath"),
          QT_TRANSLATE_NOOP("Effects", "How much the pressure rises and falls with each breath. 0: none.")},
         {"breath-hertz", QT_TRANSLATE_NOOP("Effects", "Breathing"), QT_TRANSLATE_NOOP("Effects", "Breaths per second.")},
     }},
    {EffectKind::Touch, QT_TRANSLATE_NOOP("Effects", "Touch"),
     QT_TRANSLATE_NOOP("Effects", "Fingers press dents into the surface (touch tool, T)."),
     {
         {"patches", QT_TRANSLATE_NOOP("Effects", "Patches"),
          QT_TRANSLATE_NOOP("Effects", "How many patches of a surface fingers act on. More of them make finer dents, and a longer precompute.")},
         {"friction", QT_TRANSLATE_NOOP("Effects", "Friction"),
          QT_TRANSLATE_NOOP("Effects", "Coulomb’s coefficient between a finger and the surface. 0: it only pushes straight in.")},
         {"release", QT_TRANSLATE_NOOP("Effects", "Release"), QT_TRANSLATE_NOOP("Effects", "In this time a dent goes back after its finger lifts.")},
     }},
    {EffectKind::Ground, QT_TRANSLATE_NOOP("Effects", "Ground"),
     QT_TRANSLATE_NOOP("Effects", "Bodies rest on a plane and do not sink through it."),
     {
         {"height", QT_TRANSLATE_NOOP("Effects", "Height"), QT_TRANSLATE_NOOP("Effects", "Height of the plane.")},
         {"friction", QT_TRANSLATE_NOOP("Effects", "Friction"),
          QT_TRANSLATE_NOOP("Effects", "Coulomb’s coefficient between bodies and the ground, with bone dynamics.")},
     }},
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

const EffectWords* wordsOf(EffectKind effect) {
    const auto found = std::find_if(std::begin(kWords), std::end(kWords), [effect](const EffectWords& w) { return w.kind == effect; });
    return found == std::end(kWords) ? nullptr : found;
}

const PropertyWords* wordsOf(EffectKind effect, const EffectProperty& property) {
    if (const EffectWords* words = wordsOf(effect))
        for (const PropertyWords& p : words->properties)
            if (p.name == property.name) return &p;
    return nullptr;
}

QString translated(const char* text) { return QCoreApplication::translate("Effects", text); }
QString english(std::string_view text) { return QString::fromUtf8(text.data(), qsizetype(text.size())); }

}  // namespace

QString effectTitle(EffectKind effect) {
    const EffectWords* words = wordsOf(effect);
    return words ? translated(words->title) : english(effectName(effect));
}

QString effectHelp(EffectKind effect) {
    const EffectWords* words = wordsOf(effect);
    return words ? translated(words->help) : QString();
}

QString effectPropertyTitle(EffectKind effect, const EffectProperty& property) {
    const PropertyWords* words = wordsOf(effect, property);
    return words ? translated(words->title) : english(property.name);
}

QString effectPropertyHelp(EffectKind effect, const EffectProperty& property) {
    const PropertyWords* words = wordsOf(effect, property);
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
