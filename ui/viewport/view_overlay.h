// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QColor>
#include <QRectF>
#include <QPolygonF>
#include <QString>
#include <optional>

class QPainter;

namespace imomushi {

class StudioDocument;
class TakeDeck;

/// What is painted flat over the 3-D view, beside the axis ball.
struct ViewOverlay {
    QSize size;                 ///< of the view, logical pixels
    bool dark = true;           ///< theme
    QColor highlight;           ///< of the palette
    std::optional<QRectF> box;  ///< a selection box that is being dragged
    QString banner;             ///< what the tool says; empty: nothing
    const TakeDeck* deck = nullptr;  ///< null: no takes
    QString tag;                ///< beside the pointer; empty: none
    QPointF pointer;            ///< logical pixels
    QPolygonF lasso = {};       ///< a loop that is being drawn; empty: none

    /// The box, the tag, what the tool says, the take that is shown or recorded, and the seconds until a recording starts.
    void paint(QPainter& painter, StudioDocument& document) const;

private:
    void paintArea(QPainter& painter) const;
    /// A line of text at the upper edge; red, with a dot before it, while recording.
    void paintPill(QPainter& painter, const QString& text, bool recording) const;
    void paintTag(QPainter& painter) const;
    void paintTake(QPainter& painter, StudioDocument& document) const;
    void paintCountdown(QPainter& painter) const;
};

}  // namespace imomushi
