// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/live/mapping_view.h"

#include <QApplication>
#include <QHeaderView>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QStyledItemDelegate>
#include <algorithm>

#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

using Column = MappingModel::Column;
using Role = Appearance::Role;

constexpr int kRowHeight = 30, kIconWidth = 30, kMeterWidth = 108, kLeastMeterWidth = 64, kBarHeight = 4;
constexpr double kFaded = 0.45;  // of rows that drive nothing

/// Draws the rows of the table.
class MappingDelegate : public QStyledItemDelegate {
public:
    MappingDelegate(const MappingModel& model, QObject* parent) : QStyledItemDelegate(parent), model_(model) {}

    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override {
        QStyleOptionViewItem row = option;
        initStyleOption(&row, index);
        row.text.clear();
        row.state &= ~QStyle::State_HasFocus;
        const QWidget* widget = option.widget;
        (widget ? widget->style() : QApplication::style())->drawControl(QStyle::CE_ItemViewItem, &row, painter, widget);
        const MappingModel::Level level = model_.level(index.row());
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        painter->setFont(option.font);
        const QRect rect = option.rect.adjusted(px(8), 0, -px(6), 0);
        switch (index.column()) {
            case Column::Control: paintWords(*painter, option, rect, index.data().toString(), index.data(MappingModel::NoteRole).toString(), level.muted); break;
            case Column::Target: paintTarget(*painter, option, rect, index, level); break;
            case Column::Meter: paintMeter(*painter, option, rect, level); break;
            default: paintToggle(*painter, option, index); break;
        }
        painter->restore();
    }

private:
    static void paintWords(QPainter& painter, const QStyleOptionViewItem& option, QRect rect, const QString& text, const QString& note, bool faded) {
        painter.setOpacity(faded ? kFaded : 1.0);
        painter.setPen(themeColor(Role::Text));
        const QString shown = option.fontMetrics.elidedText(text, Qt::ElideMiddle, rect.width());
        painter.drawText(rect, Qt::AlignLeft | Qt::AlignVCenter, shown);
        rect.setLeft(rect.left() + option.fontMetrics.horizontalAdvance(shown) + px(8));
        if (note.isEmpty() || rect.width() < px(24)) return;
        painter.setPen(themeColor(Role::Muted));
        painter.drawText(rect, Qt::AlignLeft | Qt::AlignVCenter, option.fontMetrics.elidedText(note, Qt::ElideRight, rect.width()));
    }

    static void paintTarget(QPainter& painter, const QStyleOptionViewItem& option, QRect rect, const QModelIndex& index, const MappingModel::Level& level) {
        if (!index.data(MappingModel::TroubleRole).toString().isEmpty()) {
            QRect place(0, 0, px(16), px(16));
            place.moveCenter({rect.left() + px(8), rect.center().y()});
            themedIcon(QStringLiteral("warning"), Role::Warning).paint(&painter, place);
            rect.setLeft(place.right() + px(6));
        }
        paintWords(painter, option, rect, index.data().toString(), {}, level.muted);
    }

    /// A bar for where the control is in its range, and what becomes of it in numbers.
    static void paintMeter(QPainter& painter, const QStyleOptionViewItem& option, const QRect& rect, const MappingModel::Level& level) {
        painter.setOpacity(level.muted || level.silent ? kFaded : 1.0);
        painter.setPen(themeColor(level.drives ? Role::Text : Role::Muted));
        painter.drawText(rect.adjusted(0, 0, 0, -px(kBarHeight + 3)), Qt::AlignRight | Qt::AlignVCenter, level.raw ? level.text : QStringLiteral("–"));
        QRectF bar(rect.left(), rect.bottom() - px(kBarHeight + 3), rect.width(), px(kBarHeight));
        painter.setPen(Qt::NoPen);
        painter.setBrush(themeColor(Role::Line));
        painter.drawRoundedRect(bar, bar.height() / 2, bar.height() / 2);
        if (!level.raw) return;
        painter.setBrush(themeColor(level.drives ? Role::Accent : Role::Muted));
        bar.setWidth(std::max(bar.height(), bar.width() * *level.raw));
        painter.drawRoundedRect(bar, bar.height() / 2, bar.height() / 2);
        (void)option;
    }

    static void paintToggle(QPainter& painter, const QStyleOptionViewItem& option, const QModelIndex& index) {
        const bool on = index.data(MappingModel::OnRole).toBool(), over = option.state & QStyle::State_MouseOver;
        QRect place(0, 0, px(17), px(17));
        place.moveCenter(option.rect.center());
        const Role ink = !on ? Role::Muted : index.column() == Column::Mute ? Role::Warning : Role::Accent;
        painter.setOpacity(on || over ? 1.0 : kFaded);
        themedIcon(index.data(MappingModel::IconRole).toString(), ink).paint(&painter, place);
    }

    const MappingModel& model_;
};

}  // namespace

MappingView::MappingView(MappingModel& model, QWidget* parent) : QTableView(parent), model_(model) {
    setModel(&model);
    setItemDelegate(new MappingDelegate(model, this));
    setSelectionBehavior(SelectRows);
    setSelectionMode(SingleSelection);
    setEditTriggers(NoEditTriggers);
    setShowGrid(false);
    setMouseTracking(true);
    setTabKeyNavigation(false);
    setWordWrap(false);
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    verticalHeader()->hide();
    verticalHeader()->setMinimumSectionSize(0);
    QHeaderView* header = horizontalHeader();
    header->setHighlightSections(false);
    header->setSectionsClickable(false);
    header->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    header->setMinimumSectionSize(0);
    header->setSectionResizeMode(QHeaderView::Fixed);
    connect(&Appearance::instance(), &Appearance::changed, this, &MappingView::takeSizes);
    takeSizes();
}

void MappingView::takeSizes() {
    verticalHeader()->setDefaultSectionSize(px(kRowHeight));
    setMinimumSize(px(330), px(4 * kRowHeight));
    shareWidth();
}

void MappingView::shareWidth() {
    const int icons = 2 * px(kIconWidth), meter = std::clamp(viewport()->width() / 5, px(kLeastMeterWidth), px(kMeterWidth)), left = std::max(0, viewport()->width() - icons - meter);
    const int control = left * 2 / 5;  // of targets the end says the most
    setColumnWidth(Column::Control, control);
    setColumnWidth(Column::Meter, meter);
    setColumnWidth(Column::Target, left - control);
    for (const int column : {Column::Mute, Column::Solo}) setColumnWidth(column, px(kIconWidth));
}

void MappingView::resizeEvent(QResizeEvent* event) {
    QTableView::resizeEvent(event);
    shareWidth();
}

void MappingView::choose(int row) {
    if (row < 0 || row >= model_.rowCount()) return setCurrentIndex({});
    setCurrentIndex(model_.index(row, Column::Control));
    scrollTo(currentIndex());
}

void MappingView::currentChanged(const QModelIndex& current, const QModelIndex& previous) {
    QTableView::currentChanged(current, previous);
    Q_EMIT chosenChanged();
}

namespace {

bool removes(const QKeyEvent& key) { return key.key() == Qt::Key_Delete || key.key() == Qt::Key_Backspace; }

}  // namespace

// These keys are for the table while it has the focus, not for what is selected in the view.
bool MappingView::event(QEvent* event) {
    if (event->type() == QEvent::ShortcutOverride && removes(static_cast<QKeyEvent&>(*event))) {
        event->accept();
        return true;
    }
    return QTableView::event(event);
}

// A row that is chosen by a click opens its form, which moves what is under the pointer: a click that mutes chooses nothing. One beside the rows closes the form.
void MappingView::mousePressEvent(QMouseEvent* event) {
    const QModelIndex index = indexAt(event->position().toPoint());
    switching_ = event->button() == Qt::LeftButton && index.isValid() && index.column() >= Column::Mute;
    if (switching_) return model_.toggle(index);
    if (!index.isValid()) return choose(-1);
    QTableView::mousePressEvent(event);
}

void MappingView::mouseMoveEvent(QMouseEvent* event) {
    if (!switching_ || !(event->buttons() & Qt::LeftButton)) QTableView::mouseMoveEvent(event);
}

void MappingView::keyPressEvent(QKeyEvent* event) {
    if (removes(*event)) return Q_EMIT removeWanted();
    if (event->key() == Qt::Key_Escape && chosen() >= 0) return choose(-1);
    if (event->modifiers() == Qt::AltModifier && (event->key() == Qt::Key_Up || event->key() == Qt::Key_Down)) return Q_EMIT moveWanted(event->key() == Qt::Key_Up ? -1 : 1);
    if ((event->key() == Qt::Key_Space || event->key() == Qt::Key_Return) && currentIndex().column() >= Column::Mute) return model_.toggle(currentIndex());
    QTableView::keyPressEvent(event);
}

}  // namespace imomushi
