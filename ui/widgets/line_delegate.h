// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStyledItemDelegate>
#include <functional>

#include "ui/widgets/appearance.h"

namespace imomushi {

/// Draws the rows of a list or tree: a line icon, the text, and a muted note behind or below it.
class LineDelegate : public QStyledItemDelegate {
    Q_OBJECT
public:
    struct Roles {
        int icon = -1;  ///< QString, name of a line icon
        int note = -1;  ///< QString
        bool noteBelow = false;
        int room = -1;  ///< int, pixels kept free behind a note below, for a button; lines are then cut to the width of the list
    };
    struct IconStyle {
        Appearance::Role color = Appearance::Role::Muted;
        double opacity = 1.0;
    };
    using IconStyles = std::function<IconStyle(const QModelIndex&)>;
    /// `styles`: of the icon of each row; empty: muted ones.
    explicit LineDelegate(Roles roles, IconStyles styles = {}, QObject* parent = nullptr) : QStyledItemDelegate(parent), roles_(roles), styles_(std::move(styles)) {}

    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override;
    [[nodiscard]] QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const override;
    void updateEditorGeometry(QWidget* editor, const QStyleOptionViewItem& option, const QModelIndex& index) const override;

private:
    [[nodiscard]] int roomOf(const QModelIndex& index) const;
    Roles roles_;
    IconStyles styles_;
};

}  // namespace imomushi
