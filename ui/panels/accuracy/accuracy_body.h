// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/mesh/mesh.h"
#include "ui/viewport/turntable_view.h"

namespace imomushi {

/// Two pictures of the character side by side, turned by the mouse together: as it is shown, with its error in colours, and the full solution.
class AccuracyBody : public TurntableView {
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
    void drawPictures() override;
    void paint(QPainter& painter) override;

private:
    void makeBodies();
    [[nodiscard]] QRect pictureArea() const;  ///< of the left picture

    std::vector<Part> parts_;
    std::vector<std::vector<float>> positions_;  ///< per body of scene_: parts as shown, then parts of the full solution
    QImage shown_, full_;
    QString shownTitle_, fullTitle_, unit_;
    double largest_ = 0.0;  // %
};

}  // namespace imomushi
