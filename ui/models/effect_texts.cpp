// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/effect_texts.h"

#include <QCoreApplication>
#include <QLocale>

namespace imomushi {
namespace {

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(EffectTexts)
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
     QT_TRANSLATE_NOOP("Effects", "The pose twists a joint face, which the joint shapes “None, without twist” cannot follow: choose “None” or more.")},
    {FrameWarning::Diverged, true, QT_TRANSLATE_NOOP("Effects", "The previous model diverged: its joints stand still. Choose a smaller step or softer flesh.")},
    {FrameWarning::LoadsBounded, false, QT_TRANSLATE_NOOP("Effects", "Gravity or pressure is too strong for flesh so soft: it acts less than asked for.")},
    {FrameWarning::ContactsBounded, false, QT_TRANSLATE_NOOP("Effects", "Flesh is pressed in more places than contact looks at: the deepest are held, others may cross.")},
    {FrameWarning::HeldByGround, false, QT_TRANSLATE_NOOP("Effects", "The ground keeps something held above its place.")},
    {FrameWarning::TargetOutOfReach, false, QT_TRANSLATE_NOOP("Effects", "The target is out of reach: the bones stretch no farther.")},
};

QString translated(const char* text) { return QCoreApplication::translate("Effects", text); }
}  // namespace

QString effectTitle(EffectKind effect) { return translated(effectDescriptor(effect).title); }
QString effectHelp(EffectKind effect) { return translated(effectDescriptor(effect).help); }
QString effectPropertyTitle(const EffectProperty& property) { return translated(property.title); }
QString effectPropertyHelp(const EffectProperty& property) { return translated(property.help); }

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
