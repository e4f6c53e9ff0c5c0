// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/mapping_model.h"

#include <algorithm>

#include "core/document/document_change.h"
#include "ui/models/commands.h"

namespace imomushi {

MappingModel::MappingModel(StudioDocument& document, InputDeck& inputs, QObject* parent) : QAbstractTableModel(parent), document_(document), inputs_(inputs) {
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.unknown || change.mappings || !change.elements.empty() || !change.bones.empty() || !change.characters.empty() || !change.takes.empty()) take();
    });
    connect(&inputs, &InputDeck::told, this, [this] {
        if (rowCount() > 0) Q_EMIT dataChanged(index(0, Meter), index(rowCount() - 1, Meter));
    });
    connect(&inputs, &InputDeck::changed, this, [this] {
        if (rowCount() > 0) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
    });
    take();
}

// Rows that stay are not taken away: one may be chosen, or being edited.
void MappingModel::take() {
    const auto now = document_.document().mappings;
    const auto sizeOf = [](const auto& table) { return table ? table->size() : 0; };
    const bool same = mappings_ && now && std::equal(now->begin(), now->end(), mappings_->begin(), mappings_->end(), [](const InputMapping& a, const InputMapping& b) { return a.sameLine(b); });
    if (!same) beginResetModel();
    mappings_ = now;
    targets_.clear();
    solo_ = false;
    for (std::size_t i = 0; i < sizeOf(now); ++i) {
        targets_.push_back(targetText(document_.document(), (*now)[i].target));
        solo_ = solo_ || (*now)[i].solo;
    }
    if (!same) return endResetModel();
    if (rowCount() > 0) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
}

void MappingModel::refresh() {
    take();
    Q_EMIT headerDataChanged(Qt::Horizontal, 0, kColumns - 1);
}

int MappingModel::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : int(targets_.size()); }

const InputMapping* MappingModel::mapping(int row) const { return row >= 0 && row < rowCount() ? &(*mappings_)[std::size_t(row)] : nullptr; }

int MappingModel::rowOf(const InputMapping& line) const {
    for (int row = 0; row < rowCount(); ++row)
        if (mapping(row)->sameLine(line)) return row;
    return -1;
}

MappingModel::Level MappingModel::level(int row) const {
    Level level;
    const InputMapping* m = mapping(row);
    if (!m) return level;
    level.muted = m->row.muted || (solo_ && !m->solo);
    const auto& meters = inputs_.meters();
    if (meters.size() != targets_.size()) return level;
    const InputMeter& meter = meters[std::size_t(row)];
    if (!meter.known) return level;
    const ResponseCurve& curve = m->row.curve;
    level.raw = std::clamp((meter.raw - curve.inLow) / (curve.inHigh - curve.inLow), 0.0, 1.0);
    level.text = targetValueText(targets_[std::size_t(row)], meter.value);
    level.drives = meter.drives && inputs_.waits() == InputDeck::Waits::No;
    level.silent = meter.silent;
    return level;
}

QString MappingModel::conflict(int row) const {
    const InputMapping* m = mapping(row);
    if (!m || targets_[std::size_t(row)].trigger) return {};
    int other = -1, winner = -1;
    const auto& meters = inputs_.meters();
    for (int i = 0; i < rowCount(); ++i) {
        if (mapping(i)->target != m->target) continue;
        if (i != row && other < 0) other = i;
        if (meters.size() == targets_.size() && meters[std::size_t(i)].drives) winner = i;
    }
    if (other < 0) return {};
    const auto called = [this](int i) { return tr("Row %1, “%2”,", "a mapping, its control").arg(i + 1).arg(channelText(*mapping(i))); };
    if (winner == row) return tr("%1 drives it, too. This row wins now.").arg(called(other));
    if (winner >= 0) return tr("%1 wins now.").arg(called(winner));
    return tr("%1 drives it, too. The upper row wins.").arg(called(other));
}

QVariant MappingModel::data(const QModelIndex& index, int role) const {
    const InputMapping* m = index.isValid() ? mapping(index.row()) : nullptr;
    if (!m) return {};
    const TargetText& target = targets_[std::size_t(index.row())];
    switch (index.column()) {
        case Control:
            if (role == Qt::DisplayRole) return channelText(*m);
            if (role == NoteRole) return sourceText(m->row.source);
            if (role == Qt::ToolTipRole) return tr("%1 of “%2”, number %3", "an address of a source").arg(QString::fromStdString(m->row.channel), QString::fromStdString(m->row.source)).arg(m->row.component + 1);
            break;
        case Meter:
            if (role == Qt::DisplayRole) return level(index.row()).text;
            break;
        case Target:
            if (role == Qt::DisplayRole) return target.briefText();
            if (role == Qt::AccessibleTextRole) return target.text();
            if (role == TroubleRole || role == Qt::ToolTipRole) {
                if (!target.there) return tr("The character has no “%1”. The row waits for it.").arg(QString::fromStdString(m->target));
                const QString trouble = conflict(index.row());
                return trouble.isEmpty() && role == Qt::ToolTipRole ? target.text() : trouble;
            }
            break;
        case Mute:
            if (role == OnRole) return m->row.muted;
            if (role == IconRole) return QStringLiteral("mute");
            if (role == Qt::ToolTipRole || role == Qt::AccessibleTextRole) return m->row.muted ? tr("Muted: it drives nothing") : tr("Mute: it drives nothing");
            break;
        case Solo:
            if (role == OnRole) return m->solo;
            if (role == IconRole) return QStringLiteral("solo");
            if (role == Qt::ToolTipRole || role == Qt::AccessibleTextRole) return tr("Solo: rows that are not solo are muted");
            break;
        default: break;
    }
    return {};
}

QVariant MappingModel::headerData(int section, Qt::Orientation orientation, int role) const {
    if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
    switch (section) {
        case Control: return tr("Control");
        case Meter: return tr("Now");
        case Target: return tr("Drives");
        default: return QString();
    }
}

void MappingModel::toggle(const QModelIndex& index) {
    const InputMapping* m = index.isValid() ? mapping(index.row()) : nullptr;
    if (!m) return;
    InputMapping made = *m;
    if (index.column() == Mute) made.row.muted = !made.row.muted;
    else if (index.column() == Solo) made.solo = !made.solo;
    else return;
    document_.execute(commands::mapInput(made));
}

}  // namespace imomushi
