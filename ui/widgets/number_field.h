// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QLineEdit>
#include <optional>

namespace imomushi {

/// A number that is typed (click) or dragged (press and move sideways; Shift fine, Ctrl coarse, Esc takes back).
class NumberField : public QLineEdit {
    Q_OBJECT
public:
    struct Spec {
        QString unit;            ///< shown behind the number, may be empty
        double low = -1e9, high = 1e9;
        double step = 0.01;      ///< change per pixel dragged, and per arrow key
        int decimals = 3;
        double factor = 1.0;     ///< shown = value * factor (180 / pi for angles)
        std::optional<double> standard;  ///< what the reset button sets
    };
    explicit NumberField(Spec spec, QWidget* parent = nullptr);

    /// nullopt: several things with different values.
    void setValue(std::optional<double> value);
    [[nodiscard]] std::optional<double> value() const { return value_; }

signals:
    void editStarted();
    void valueEdited(double value);      ///< between start and end
    void editEnded(bool keep);           ///< false: take back what was edited

protected:
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void focusInEvent(QFocusEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void changeEvent(QEvent* event) override;
    void hideEvent(QHideEvent* event) override;
    bool event(QEvent* event) override;

private:
    void showText();
    void commitText();
    void endDrag(bool keep);
    void set(double value);
    void once(double value);
    [[nodiscard]] std::optional<double> parse() const;

    Spec spec_;
    std::optional<double> value_;
    QAction* reset_;
    bool pressed_ = false, dragging_ = false, typing_ = false;
    double pressX_ = 0.0, dragValue_ = 0.0;
};

}  // namespace imomushi
