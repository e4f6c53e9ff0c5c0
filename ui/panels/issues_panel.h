// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <optional>
#include <vector>

#include "ui/models/issue_model.h"

class QLabel;
class QListView;
class QPushButton;

namespace imomushi {

/// What asks for attention; a click selects the element it is about and shows the place, a button at its end mends it.
class IssuesPanel : public QWidget {
    Q_OBJECT
public:
    explicit IssuesPanel(StudioDocument& document, QWidget* parent = nullptr);
    [[nodiscard]] int problems() const { return model_->problems(); }

signals:
    void problemsChanged();
    void frameWanted();  ///< a line was double-clicked
    /// Triangles of an element are to be pointed out in the view; none: what was pointed out is over.
    void markWanted(PartId element, const std::vector<std::int32_t>& triangles);
    /// The same of a place of a whole character: triangles of its render mesh, or a point (m, at rest).
    void placeWanted(PartId character, const std::vector<std::int32_t>& triangles, const std::optional<Vec3>& point);
    void placeFrameWanted();
    void repairWanted(const std::vector<Json>& commands);

protected:
    void changeEvent(QEvent* event) override;

private:
    void update();
    void addButtons();
    void repair(const std::vector<Json>& commands);
    IssueModel* model_;
    QListView* list_;
    QLabel* empty_;
    QPushButton* all_;
};

}  // namespace imomushi
