// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/accuracy/accuracy_texts.h"

#include <QCoreApplication>
#include <QLocale>

#include "ui/models/texts.h"

namespace imomushi {
namespace {

QString figure(double value, const char* unit) { return value < 0.0 ? QStringLiteral("–") : QLocale().toString(value, 'g', 3) + QLatin1String(unit); }

}  // namespace

QString shareText(double share) { return figure(100.0 * share, " %"); }
QString diagonalText(double percent) { return figure(percent, " %"); }
QString millisecondsText(double ms) { return figure(ms, " ms"); }
QString secondsText(double seconds) { return seconds < 0.0 ? QStringLiteral("–") : durationText(seconds); }

QString settingText(const AccuracySetting& s) {
    using Kind = SolverMeshSetting::Kind;
    QString mesh;
    if (s.mesh.own)
        mesh = QCoreApplication::translate("imomushi::settingText", "own meshes");
    else if (s.mesh.kind == Kind::AsIs)
        mesh = QCoreApplication::translate("imomushi::settingText", "mesh as it is");
    else if (s.mesh.kind == Kind::Refined)
        mesh = QCoreApplication::translate("imomushi::settingText", "refined × %1").arg(s.mesh.factor);
    else if (s.mesh.kind == Kind::Decimated)
        mesh = QCoreApplication::translate("imomushi::settingText", "decimated × %1").arg(s.mesh.factor);
    else if (s.mesh.kind == Kind::Best)
        mesh = QCoreApplication::translate("imomushi::settingText", "best mesh");
    else if (s.mesh.kind == Kind::Volume)
        mesh = s.mesh.factor > 0.0 ? QCoreApplication::translate("imomushi::settingText", "volume × %1").arg(s.mesh.factor) : QCoreApplication::translate("imomushi::settingText", "volume");
    else if (s.mesh.kind == Kind::Draft)
        mesh = QCoreApplication::translate("imomushi::settingText", "draft mesh");
    else
        mesh = QCoreApplication::translate("imomushi::settingText", "default mesh");
    QString basis;
    if (s.previous)
        basis = QCoreApplication::translate("imomushi::settingText", "previous model");
    else if (s.basis == BasisKind::Paper)
        basis = QCoreApplication::translate("imomushi::settingText", "paper");
    else if (s.basis == BasisKind::Affine)
        basis = QCoreApplication::translate("imomushi::settingText", "affine");
    else if (s.basis == BasisKind::Full)
        basis = QCoreApplication::translate("imomushi::settingText", "full");
    else
        basis = QCoreApplication::translate("imomushi::settingText", "%1 shapes").arg(s.basis.modes);
    if (s.smoothJoints) basis = QCoreApplication::translate("imomushi::settingText", "%1, smooth joints").arg(basis);
    return basis + QStringLiteral(" · ") + mesh + QStringLiteral(" · ") + QString::fromStdString(formatName(s.format));
}

}  // namespace imomushi
