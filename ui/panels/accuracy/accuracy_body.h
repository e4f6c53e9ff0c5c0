// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Two pictures of the character side by side, turned by the mouse together: as it is shown, with its error in colours, and the full solution.
class AccuracyBody : public QWidget {
    Q_OBJECT
public:
    struct Part {
        Points shown, full;         ///< #V x 3, m
        Triangles triangles;        ///< those that are seen
        std::vector<float> error;   ///< % of the diagonal per vertex, negative: not seen
    };
    explicit AccuracyBody(QWidget* parent = nullptr);
    void setParts(std::vector<Part> parts);
    void setTitles(const QString& shown, const QString& full, const QString& unit);
    [[nodiscard]] double largest() const { return largest_; }
    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;

private:
    void draw(class QPainter& painter, const QRectF& where, bool error) const;

    std::vector<Part> parts_;
    QString shownTitle_, fullTitle_, unit_;
    double largest_ = 0.0;                   // %
    double turn_ = 0.6, tilt_ = 0.35;        // radians
    QPointF last_;
};

}  // namespace imomushi
