// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractSlider>
#include <vector>

namespace imomushi {

/// The frames of a take along a ruler of seconds. Its value is the frame; the pointer and the arrow keys move it. Two marks below it, which the pointer moves,
/// say what part is played and kept.
class TimeBar : public QAbstractSlider {
    Q_OBJECT
public:
    explicit TimeBar(QWidget* parent = nullptr);
    /// Times of the frames (s), ascending from 0; empty: there is nothing to show.
    void setTimes(std::vector<double> times);
    /// Where the playhead is, s, between frames too.
    void setTime(double time);
    /// What part of it is played, s.
    void setSpan(double from, double to);
    /// A take that grows: the whole bar is what was recorded so far, s; negative: none.
    void setRecorded(double seconds);
    /// Where a time is, pixels from the left.
    [[nodiscard]] double xOf(double time) const;

    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override { return sizeHint(); }

Q_SIGNALS:
    /// The artist asks for this frame.
    void wanted(int frame);
    /// The artist asks for this part, s.
    void spanWanted(double from, double to);

protected:
    bool event(QEvent* e) override;
    void paintEvent(QPaintEvent* e) override;
    void mousePressEvent(QMouseEvent* e) override;
    void mouseMoveEvent(QMouseEvent* e) override;
    void mouseReleaseEvent(QMouseEvent* e) override;
    void leaveEvent(QEvent* e) override;
    void keyPressEvent(QKeyEvent* e) override;
    void wheelEvent(QWheelEvent* e) override;

private:
    [[nodiscard]] double end() const;
    [[nodiscard]] double timeAt(double x) const;
    enum class Part { None, Bar, From, To };
    [[nodiscard]] Part partAt(QPointF at) const;
    [[nodiscard]] QRectF bar() const;
    void drag(double x);
    void seek(double time);
    void ask(int frame);
    void paintMarks(QPainter& p);

    std::vector<double> times_;
    double time_ = 0.0, from_ = 0.0, to_ = 0.0, recorded_ = -1.0;
    Part held_ = Part::None, hovered_ = Part::None;
};

}  // namespace imomushi
