// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QSet>
#include <QWidget>

#include "ui/models/outliner_model.h"

class QLineEdit;
class QSortFilterProxyModel;
class QTreeView;

namespace imomushi {

/// The outliner: the tree of the character with a filter; its selection is the document's.
class OutlinerPanel : public QWidget {
    Q_OBJECT
public:
    explicit OutlinerPanel(StudioDocument& document, QWidget* parent = nullptr);
    /// Starts editing the name of what is selected.
    void renameSelected();
    [[nodiscard]] QTreeView* tree() const { return tree_; }

signals:
    void contextMenuWanted(const QPoint& global);
    void effectWanted(imomushi::EffectKind effect);  ///< its row was double-clicked, or Enter was pressed there

protected:
    void changeEvent(QEvent* event) override;

private:
    void retranslate();
    void takeSelection();
    void showSelection();
    void rememberExpansion();
    void restoreExpansion();
    void sizeColumns();

    StudioDocument& document_;
    OutlinerModel* model_;
    QSortFilterProxyModel* filter_;
    QTreeView* tree_;
    QLineEdit* search_;
    QSet<QString> collapsed_;
    bool syncing_ = false;
};

}  // namespace imomushi
