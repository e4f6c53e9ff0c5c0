// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/body_texts.h"

#include <QCoreApplication>
#include <QLocale>

#include "core/mesh/health.h"

namespace imomushi {
namespace {

struct BodyTexts {
    Q_DECLARE_TR_FUNCTIONS(BodyTexts)
};

QString percent(double share) { return QLocale().toString(100.0 * share, 'g', 2); }

}  // namespace

QString bodyKindText(BodyKind how) {
    switch (how) {
        case BodyKind::Exact: return BodyTexts::tr("exact");
        case BodyKind::Mended: return BodyTexts::tr("mended");
        case BodyKind::Wrapped: return BodyTexts::tr("wrapped");
        case BodyKind::Auto: break;
    }
    return BodyTexts::tr("automatic");
}

QString repairText(RepairAction action) {
    switch (action) {
        case RepairAction::Weld: return BodyTexts::tr("Weld", "vertices");
        case RepairAction::Drop: return BodyTexts::tr("Drop", "triangles without area, copies, unused vertices");
        case RepairAction::Separate: return BodyTexts::tr("Separate", "surfaces that touch");
        case RepairAction::Orient: return BodyTexts::tr("Orient", "triangles alike and outward");
        case RepairAction::Fill: return BodyTexts::tr("Fill", "holes");
        case RepairAction::Wrap: break;
    }
    return BodyTexts::tr("Wrap", "a new surface around everything");
}

QString diagonalShareText(double share) { return BodyTexts::tr("%1 % of the diagonal").arg(percent(share)); }

QStringList bodyLines(const Body& body) {
    const BodyReport& report = body.report;
    QStringList lines;
    lines << BodyTexts::tr("Body: %1 vertices, %2 triangles").arg(QLocale().toString(qlonglong(body.mesh.vertices.rows())), QLocale().toString(qlonglong(body.mesh.triangles.rows())));
    lines << BodyTexts::tr("Distance %1, largest %2").arg(diagonalShareText(report.distanceRms), diagonalShareText(report.distanceLargest));
    if (report.volumeError >= 0.0) lines << BodyTexts::tr("Volume error %1 %").arg(percent(report.volumeError));
    if (!report.links.empty()) {
        double added = 0.0;
        for (const FleshLink& link : report.links) added += link.volume;
        lines << BodyTexts::tr("%n link(s) of flesh, %1 % of the volume", nullptr, int(report.links.size())).arg(percent(added / meshFacts(body.mesh).volume));
    }
    if (!report.gaps.places.empty())
        lines << BodyTexts::tr("%n gap(s) closed, %1 % of the surface", nullptr, int(report.gaps.places.size())).arg(percent(report.gaps.area));
    return lines;
}

long long verticesOf(const Document& document) {
    long long vertices = 0;
    for (const auto& [id, character] : document.characters) vertices += character->model->mesh.body.vertices.rows();
    for (const auto& [id, element] : document.elements)
        if (!element->piece) vertices += element->mesh->body.vertices.rows();
    return vertices;
}

}  // namespace imomushi
