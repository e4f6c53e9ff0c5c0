// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QTableView>

#include "ui/models/mapping_model.h"

namespace imomushi {

/// The table of mappings: a meter in each row; muting and solo by a click. Delete removes the chosen row, Alt with the arrow keys moves it; Escape, and a click beside the rows, chooses none.
class MappingView : public QTableView {
    Q_OBJECT
public:
    MappingView(MappingModel& model, QWidget* parent = nullptr);
    [[nodiscard]] int chosen() const { return currentIndex().isValid() ? currentIndex().row() : -1; }
    void choose(int row);

signals:
    void chosenChanged();
    void removeWanted();
    void moveWanted(int by);

protected:
    void keyPressEvent(QKeyEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    bool event(QEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void currentChanged(const QModelIndex& current, const QModelIndex& previous) override;

private:
    void takeSizes();
    void shareWidth();
    MappingModel& model_;
    bool switching_ = false;  ///< the press was on a switch
};

}  // namespace imomushi
