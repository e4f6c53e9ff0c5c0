// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/take_model.h"

#include <QLocale>
#include <algorithm>

#include "ui/models/commands.h"
#include "ui/models/texts.h"

namespace imomushi {

TakeModel::TakeModel(StudioDocument& document, QObject* parent) : QAbstractListModel(parent), document_(document) {
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (!change.has(&DocumentChange::takes)) return;
        // A name may be being edited: rows that stay must not be taken away.
        const auto& now = document_.document().takes;
        if (now.size() != takes_.size() || !std::equal(now.begin(), now.end(), takes_.begin(), [](const auto& a, const auto& b) { return a.first == b->id; })) return refresh();
        for (int row = 0; row < rowCount(); ++row) {
            auto& take = takes_[std::size_t(row)];
            if (const auto& is = now.at(take->id); is != take) {
                take = is;
                Q_EMIT dataChanged(index(row), index(row));
            }
        }
    });
    refresh();
}

void TakeModel::refresh() {
    beginResetModel();
    takes_.clear();
    for (const auto& [id, take] : document_.document().takes) takes_.push_back(take);
    endResetModel();
}

PartId TakeModel::take(const QModelIndex& index) const { return index.isValid() ? takes_[std::size_t(index.row())]->id : 0; }

QModelIndex TakeModel::indexOf(PartId take) const {
    const auto found = std::find_if(takes_.begin(), takes_.end(), [&](const auto& t) { return t->id == take; });
    return found == takes_.end() ? QModelIndex() : index(int(found - takes_.begin()));
}

int TakeModel::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : int(takes_.size()); }

QVariant TakeModel::data(const QModelIndex& index, int role) const {
    if (!index.isValid()) return {};
    const Take& take = *takes_[std::size_t(index.row())];
    const int frames = int(take.times.size());
    switch (role) {
        case Qt::DisplayRole:
        case Qt::EditRole: return QString::fromStdString(take.name);
        case IconRole: return QStringLiteral("take");
        case NoteRole: return tr("%1 s · %n frame(s)", "length of a take", frames).arg(QLocale().toString(take.duration(), 'f', 1));
        case Qt::AccessibleTextRole: return QStringLiteral("%1, %2").arg(QString::fromStdString(take.name), data(index, NoteRole).toString());
        case Qt::ToolTipRole: return QStringLiteral("%1 · %2").arg(data(index, NoteRole).toString(), bytesText(double(take.bytes())));
        default: return {};
    }
}

bool TakeModel::setData(const QModelIndex& index, const QVariant& value, int role) {
    const QString name = value.toString().trimmed();
    if (!index.isValid() || role != Qt::EditRole || name.isEmpty()) return false;
    const std::string was = takes_[std::size_t(index.row())]->name;
    if (name.toStdString() == was) return true;
    return document_.execute(commands::renameTake(was, name.toStdString())).has_value();
}

Qt::ItemFlags TakeModel::flags(const QModelIndex& index) const { return QAbstractListModel::flags(index) | Qt::ItemIsEditable | Qt::ItemNeverHasChildren; }

}  // namespace imomushi
