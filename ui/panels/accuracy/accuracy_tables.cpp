// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/accuracy/accuracy_tables.h"

#include <QHeaderView>
#include <QLocale>
#include <QSignalBlocker>
#include <algorithm>
#include <cmath>

#include "core/accuracy/study.h"
#include "ui/models/effect_texts.h"
#include "ui/models/texts.h"
#include "ui/panels/accuracy/accuracy_texts.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

/// Sorts by what it stands for rather than by its text; unknown values, which are negative, come last.
class Cell : public QTableWidgetItem {
public:
    Cell(const QString& text, double value) : QTableWidgetItem(text), value_(value < 0.0 ? INFINITY : value) {}
    bool operator<(const QTableWidgetItem& other) const override { return value_ < static_cast<const Cell&>(other).value_; }

private:
    double value_;
};

void setUp(QTableWidget& table, int columns) {
    table.setEditTriggers(QAbstractItemView::NoEditTriggers);
    table.setSelectionBehavior(QAbstractItemView::SelectRows);
    table.setSelectionMode(QAbstractItemView::SingleSelection);
    table.verticalHeader()->hide();
    table.setShowGrid(false);
    table.setColumnCount(columns);
}

/// Names at the left, figures at the right.
void place(QTableWidget& table, int row, int column, QTableWidgetItem* item, const QString& tip) {
    if (column > 0) item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
    item->setToolTip(tip);
    table.setItem(row, column, item);
}

}  // namespace

AccuracyTable::AccuracyTable(QWidget* parent) : QTableWidget(parent) {
    setObjectName(QStringLiteral("accuracyTable"));
    setUp(*this, 7);
    connect(this, &QTableWidget::itemSelectionChanged, this, [this] {
        const auto rows = selectionModel()->selectedRows();
        if (!rows.empty()) Q_EMIT chosen(item(rows.front().row(), 0)->data(Qt::UserRole).toInt());
    });
}

void AccuracyTable::retranslate() {
    setAccessibleName(tr("Measured settings"));
    setHorizontalHeaderLabels({tr("Setting"), tr("Error"), tr("Largest"), tr("Frame"), tr("Predicted"), tr("Precompute"), tr("Memory")});
}

void AccuracyTable::showStudy(const AccuracyStudy& study, const std::vector<std::size_t>& front, const std::vector<QString>& tips) {
    const QSignalBlocker quiet(this);
    setSortingEnabled(false);
    setRowCount(int(study.points.size()));
    for (int i = 0; i < int(study.points.size()); ++i) {
        const AccuracyPoint& p = study.points[std::size_t(i)];
        const bool on = std::find(front.begin(), front.end(), std::size_t(i)) != front.end();
        const auto cell = [&](int column, const QString& text, double value) {
            auto* item = new Cell(text, value);
            if (p.relative >= 0.0 && !on) item->setForeground(themeColor(Appearance::Role::Muted));
            place(*this, i, column, item, tips[std::size_t(i)]);
        };
        cell(0, (i == study.present() ? QStringLiteral("□ ") : on ? QStringLiteral("● ") : QStringLiteral("○ ")) + settingText(p.setting), i);
        item(i, 0)->setData(Qt::UserRole, i);
        cell(1, shareText(p.relative), p.relative);
        cell(2, diagonalText(p.percent), p.percent);
        cell(3, millisecondsText(p.frameMs), p.frameMs);
        cell(4, millisecondsText(p.predictedMs), p.predictedMs);
        cell(5, secondsText(p.precomputeSeconds), p.precomputeSeconds);
        cell(6, p.frameBytes < 0.0 ? QStringLiteral("–") : bytesText(p.frameBytes), p.frameBytes);
    }
    setSortingEnabled(true);
    horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    horizontalHeader()->setSectionResizeMode(0, QHeaderView::Interactive);
    setColumnWidth(0, px(230));
}

void AccuracyTable::setChosen(int point) {
    const QSignalBlocker quiet(this);
    for (int row = 0; row < rowCount(); ++row)
        if (item(row, 0)->data(Qt::UserRole).toInt() == point) selectRow(row);
}

EffectCostTable::EffectCostTable(QWidget* parent) : QTableWidget(parent) {
    setObjectName(QStringLiteral("accuracyEffects"));
    setUp(*this, 4);
}

void EffectCostTable::retranslate() {
    setAccessibleName(tr("Cost of effects"));
    setHorizontalHeaderLabels({tr("Effect"), tr("Predicted"), tr("Measured"), tr("Off by")});
}

void EffectCostTable::showStudy(const AccuracyStudy& study) {
    setRowCount(int(study.effects.size()));
    for (int i = 0; i < int(study.effects.size()); ++i) {
        const EffectPoint& e = study.effects[std::size_t(i)];
        const auto kind = effectNamed(e.effect);
        const QString why = e.problem.empty() ? QString() : tr("Fingers need their own precompute: turn touch on, precompute, and measure again.");
        const auto cell = [&](int column, const QString& text) { place(*this, i, column, new QTableWidgetItem(text), why); };
        cell(0, kind ? effectTitle(*kind) : QString::fromStdString(e.effect));
        cell(1, millisecondsText(e.predictedMs));
        cell(2, why.isEmpty() ? millisecondsText(e.measuredMs) : tr("unknown"));
        cell(3, e.off() < 0.0 ? QStringLiteral("–") : QStringLiteral("× ") + QLocale().toString(e.off(), 'f', 2));
    }
    horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
}

}  // namespace imomushi
