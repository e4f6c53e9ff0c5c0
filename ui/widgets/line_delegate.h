// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStyledItemDelegate>

namespace imomushi {

/// Draws rows of outliner, history and issues: a line icon, the text, and a muted note behind or below it.
class LineDelegate : public QStyledItemDelegate {
    Q_OBJECT
public:
    struct Roles {
        int icon = -1;      ///< QString, name of a line icon
        int note = -1;      ///< QString
        int severity = -1;  ///< int of Severity: colours the icon
        bool noteBelow = false;
    };
    explicit LineDelegate(Roles roles, QObject* parent = nullptr) : QStyledItemDelegate(parent), roles_(roles) {}

    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override;
    [[nodiscard]] QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const override;
    void updateEditorGeometry(QWidget* editor, const QStyleOptionViewItem& option, const QModelIndex& index) const override;

private:
    Roles roles_;
};

}  // namespace imomushi
