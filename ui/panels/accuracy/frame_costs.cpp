// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/accuracy/frame_costs.h"

#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <algorithm>

#include "core/effects/smooth_joints_job.h"
#include "core/live/live_character.h"
#include "ui/models/effect_texts.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr double kSmooth = 0.12;  // share of a new frame
constexpr int kTellMs = 350;

/// Safe for colour-blind readers (after Okabe and Ito), and told apart by their order too.
QColor stageColor(std::size_t stage) {
    static constexpr QRgb colors[] = {0xff0072b2, 0xff56b4e9, 0xff009e73, 0xffe69f00, 0xffd55e00, 0xffcc79a7};
    return QColor::fromRgb(colors[stage % std::size(colors)]);
}

QString msText(double ms) { return QLocale().toString(ms, 'f', ms < 10.0 ? 3 : 1) + QStringLiteral(" ms"); }

}  // namespace

FrameCostMeter::FrameCostMeter(StudioDocument& document, QObject* parent) : QObject(parent), document_(document) {
    ms_.fill(-1.0);
    predicted_.fill(-1.0);
    tell_.setSingleShot(true);
    tell_.setInterval(kTellMs);
    connect(&tell_, &QTimer::timeout, this, &FrameCostMeter::changed);
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (!change.forResponses() && !change.has(&DocumentChange::joints) && !change.has(&DocumentChange::bones)) return;
        ms_.fill(-1.0);
        tell_.start();
    });
}

void FrameCostMeter::take(double cpuMs, double, int, double uploadMs) {
    const Character* character = document_.session().character();
    if (!character) return;
    const StageTimes s = *document_.session().stages();
    std::array<double, Stages> now = {s.pose, s.joints, character->input().effects.has<SmoothJointsEffect>() ? s.equilibrium : -1.0, s.product, s.normals, uploadMs, 0.0};
    now[Drawing] = std::max(0.0, cpuMs - s.pose - s.joints - s.equilibrium - s.product - s.normals - uploadMs);
    for (int i = 0; i < Stages; ++i) {
        double& mean = ms_[std::size_t(i)];
        const double value = now[std::size_t(i)];
        mean = value < 0.0 ? -1.0 : mean < 0.0 ? value : mean + kSmooth * (value - mean);
    }
    if (!tell_.isActive()) tell_.start();
}

void FrameCostMeter::setPredicted(const std::array<EffectCost, kEffects>& costs) {
    for (std::size_t k = 0; k < kEffects; ++k) predicted_[k] = document_.document().effects.has(EffectKind(k)) ? costs[k].milliseconds : -1.0;
    tell_.start();
}

FrameCosts FrameCostMeter::costs() const {
    FrameCosts out;
    const QString names[] = {tr("Bones (inverse kinematics)"), tr("Joints"), tr("Equilibrium of joints"), tr("Surfaces (product)"), tr("Normals"), tr("Upload"), tr("Drawing")};
    for (int i = 0; i < Stages; ++i) {
        if (i == Equilibrium && ms_[std::size_t(i)] < 0.0) continue;
        out.rows.push_back({names[i], ms_[std::size_t(i)], -1.0, false, i < Upload});
        if (i < Upload && ms_[std::size_t(i)] >= 0.0) out.total = std::max(0.0, out.total) + ms_[std::size_t(i)];
    }
    for (std::size_t k = 0; k < kEffects; ++k) {
        if (!document_.document().effects.has(EffectKind(k))) continue;
        const auto ms = document_.effectMilliseconds(EffectKind(k));
        out.rows.push_back({effectTitle(EffectKind(k)), ms.value_or(-1.0), predicted_[k], true, false});
    }
    return out;
}

CostBar::CostBar(FrameCostMeter& meter, QWidget* parent) : QWidget(parent), meter_(meter) {
    setObjectName(QStringLiteral("costBar"));
    setCursor(Qt::PointingHandCursor);
    connect(&meter, &FrameCostMeter::changed, this, [this] {
        const FrameCosts costs = meter_.costs();
        QStringList lines{tr("What a frame costs (click for more)")};
        for (const auto& row : costs.rows) lines << QStringLiteral("%1: %2").arg(row.name, row.ms < 0.0 ? QStringLiteral("–") : msText(row.ms));
        setToolTip(lines.join(u'\n'));
        setAccessibleName(lines.join(QStringLiteral(", ")));
        update();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, [this] { updateGeometry(); });
}

QSize CostBar::sizeHint() const { return {px(96), px(12)}; }
void CostBar::mousePressEvent(QMouseEvent*) { Q_EMIT clicked(); }

void CostBar::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const QRectF area = QRectF(rect()).adjusted(0.5, 0.5 * (height() - px(10)), -0.5, -0.5 * (height() - px(10)));
    painter.fillRect(area, themeColor(Appearance::Role::Field));
    const FrameCosts costs = meter_.costs();
    double at = area.left();
    std::size_t stage = 0;
    for (const auto& row : costs.rows) {
        if (!row.part) continue;
        if (row.ms > 0.0 && costs.total > 0.0) {
            const double width = area.width() * row.ms / costs.total;
            painter.fillRect(QRectF(at, area.top(), std::max(0.0, width - 1.0), area.height()), stageColor(stage));
            at += width;
        }
        ++stage;
    }
    painter.setPen(themeColor(Appearance::Role::Line));
    painter.drawRect(area);
}

CostList::CostList(FrameCostMeter& meter, QWidget* parent) : QWidget(parent), meter_(meter) {
    connect(&meter, &FrameCostMeter::changed, this, [this] {
        updateGeometry();
        update();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, [this] { updateGeometry(); });
}

QSize CostList::sizeHint() const {
    const int line = fontMetrics().height() + px(6);
    return {px(320), line * (int(meter_.costs().rows.size()) + 1) + px(10)};
}

void CostList::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.fillRect(rect(), themeColor(Appearance::Role::Panel));
    const FrameCosts costs = meter_.costs();
    const double line = fontMetrics().height() + px(6), name = 0.34 * width(), number = fontMetrics().horizontalAdvance(QStringLiteral("00.000 ms")) + px(8);
    bool any = false;
    for (const auto& row : costs.rows) any = any || row.predicted > 0.0;
    const double bar = std::max(20.0, width() - name - number - px(16) - (any ? 0.3 * width() : 0.0));
    double most = 1e-3;
    // Drawing is another world: it may be a hundred times the rest, which would then show nothing.
    for (const auto& row : costs.rows)
        if (row.part || row.effect) most = std::max({most, row.ms, row.predicted});
    double y = px(4);
    std::size_t stage = 0;
    const auto cell = [&](double x, double w, const QString& text, Appearance::Role role, int align) {
        painter.setPen(themeColor(role));
        painter.drawText(QRectF(x, y, w, line), align | Qt::AlignVCenter, fontMetrics().elidedText(text, Qt::ElideRight, int(w)));
    };
    bool effects = false;
    for (const auto& row : costs.rows) {
        if (row.effect && !effects) {
            effects = true;
            cell(px(6), width(), tr("Of it, by effect"), Appearance::Role::Muted, Qt::AlignLeft);
            y += line;
        }
        cell(px(6), name - px(6), row.name, Appearance::Role::Text, Qt::AlignLeft);
        const QRectF place(name, y + 0.25 * line, bar, 0.5 * line);
        painter.fillRect(place, themeColor(Appearance::Role::Field));
        const QColor color = row.effect ? themeColor(Appearance::Role::Accent) : row.part ? stageColor(stage) : themeColor(Appearance::Role::Muted);
        if (row.ms > 0.0) painter.fillRect(QRectF(place.left(), place.top(), bar * std::min(1.0, row.ms / most), place.height()), color);
        if (row.ms > most) {  // longer than is shown
            painter.setPen(QPen(themeColor(Appearance::Role::Field), px(2)));
            painter.drawLine(QPointF(place.right() - px(8), place.bottom()), QPointF(place.right() - px(3), place.top()));
        }
        if (row.predicted > 0.0) {
            painter.setPen(QPen(themeColor(Appearance::Role::Text), px(2)));
            const double x = place.left() + bar * row.predicted / most;
            painter.drawLine(QPointF(x, place.top() - px(2)), QPointF(x, place.bottom() + px(2)));
        }
        cell(name + bar, number, row.ms < 0.0 ? QStringLiteral("–") : msText(row.ms), Appearance::Role::Text, Qt::AlignRight);
        QString more;
        if (row.predicted > 0.0)
            more = row.ms > 0.0 ? tr("predicted %1, off by × %2").arg(msText(row.predicted), QLocale().toString(std::max(row.ms / row.predicted, row.predicted / row.ms), 'f', 2))
                                : tr("predicted %1").arg(msText(row.predicted));
        cell(name + bar + number + px(10), width() - name - bar - number - px(10), more, Appearance::Role::Muted, Qt::AlignLeft);
        if (row.part) ++stage;
        y += line;
    }
}

}  // namespace imomushi
