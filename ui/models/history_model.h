// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractListModel>
#include <QTimer>
#include <vector>

#include "ui/models/studio_document.h"

namespace imomushi {

/// The undo steps as a list: row 0 is the beginning, row n the state after step n. Steps that were undone stay, greyed.
class HistoryModel : public QAbstractListModel {
    Q_OBJECT
public:
    enum Roles { DoneRole = Qt::UserRole };  ///< bool: this state lies at or before the present one
    explicit HistoryModel(StudioDocument& document, QObject* parent = nullptr);

    [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    [[nodiscard]] int position() const { return position_; }
    /// Undoes or redoes until the state of `row`.
    void goTo(int row);
    void refresh();

signals:
    void positionChanged();

private:
    StudioDocument& document_;
    QTimer later_;
    std::vector<Session::Step> steps_;
    int position_ = 0;
};

}  // namespace imomushi
