// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/history_model.h"

#include <algorithm>

#include "ui/models/commands.h"
#include "ui/models/texts.h"

namespace imomushi {

HistoryModel::HistoryModel(StudioDocument& document, QObject* parent) : QAbstractListModel(parent), document_(document) {
    // A drag changes the document at the rate of the mouse; the list follows a few times a second.
    later_.setSingleShot(true);
    later_.setInterval(100);
    connect(&later_, &QTimer::timeout, this, &HistoryModel::refresh);
    const auto soon = [this] {
        if (!later_.isActive()) later_.start();
    };
    connect(&document, &StudioDocument::historyChanged, this, soon);
    connect(&document, &StudioDocument::fileChanged, this, soon);
    refresh();
}

void HistoryModel::refresh() {
    const auto& steps = document_.session().steps();
    const auto same = [](const Session::Step& a, const Session::Step& b) { return a.name == b.name && a.subject == b.subject; };
    if (!std::equal(steps.begin(), steps.end(), steps_.begin(), steps_.end(), same)) {
        beginResetModel();
        steps_ = steps;
        endResetModel();
    }
    position_ = document_.session().position();
    Q_EMIT dataChanged(index(0), index(rowCount() - 1));
    Q_EMIT positionChanged();
}

int HistoryModel::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : int(steps_.size()) + 1; }

QVariant HistoryModel::data(const QModelIndex& index, int role) const {
    if (!index.isValid()) return {};
    const int row = index.row();
    if (role == DoneRole) return row <= position_;
    if (role == Qt::DisplayRole) {
        if (row == 0) return tr("Beginning");
        const Session::Step& step = steps_[std::size_t(row - 1)];
        return stepText(step.name, step.subject);
    }
    return {};
}

void HistoryModel::goTo(int row) {
    if (row == document_.session().position()) return;
    document_.giveUpUnderWay();  // else it would follow on what was not there when it was asked for
    const int by = row - document_.session().position();
    if (by < 0) document_.execute(commands::undo(-by));
    if (by > 0) document_.execute(commands::redo(by));
}

}  // namespace imomushi
