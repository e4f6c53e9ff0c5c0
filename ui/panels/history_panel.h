// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "ui/models/history_model.h"

class QListView;

namespace imomushi {

/// The undo steps; a click goes there.
class HistoryPanel : public QWidget {
    Q_OBJECT
public:
    explicit HistoryPanel(StudioDocument& document, QWidget* parent = nullptr);
    [[nodiscard]] QListView* list() const { return list_; }
    [[nodiscard]] HistoryModel* model() const { return model_; }

protected:
    void changeEvent(QEvent* event) override;

private:
    HistoryModel* model_;
    QListView* list_;
};

}  // namespace imomushi
