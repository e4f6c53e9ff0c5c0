// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "core/accuracy/plot.h"

namespace imomushi {

/// Error against what it costs, on logarithmic axes: the front as steps, the present setting in a square, the chosen one in a ring. Hover tells, a click or the arrow keys
/// choose.
class AccuracyPlot : public QWidget {
    Q_OBJECT
public:
    struct Point {
        double cost = 0.0, error = 0.0;  ///< not positive: unknown, not drawn
        QString tip;
        bool front = false, present = false;
    };
    explicit AccuracyPlot(QWidget* parent = nullptr);
    void setTitles(const QString& title, const QString& cost, const QString& error);
    void setPoints(std::vector<Point> points);
    void setChosen(int point);
    void setFloor(double error);  ///< below it errors cannot be told apart: shaded; 0: none
    void setBudget(double cost);  ///< a line, 0: none
    [[nodiscard]] QPointF place(int point) const;  ///< on the widget, of a drawn point
    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

signals:
    void clicked(int point);
    void hovered(int point);  ///< -1: none

protected:
    void paintEvent(QPaintEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void leaveEvent(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

private:
    [[nodiscard]] QRectF area() const;
    [[nodiscard]] int near(const QPointF& at) const;
    [[nodiscard]] bool drawn(int point) const;
    void hover(int point);

    QString title_, costTitle_, errorTitle_;
    std::vector<Point> points_;
    LogAxis x_, y_;
    double budget_ = 0.0, floor_ = 0.0;
    int chosen_ = -1, hovered_ = -1;
};

}  // namespace imomushi
