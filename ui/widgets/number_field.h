// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractSpinBox>
#include <QVariant>
#include <optional>

namespace imomushi {

/// A number that is typed (click) or dragged (press and move sideways; Shift fine, Ctrl coarse, Esc takes back).
class NumberField : public QAbstractSpinBox {
    Q_OBJECT
    // What screen readers say and set (QAccessible asks for properties of these names), in the unit that is shown.
    Q_PROPERTY(QVariant value READ shownValue WRITE setShownValue)
    Q_PROPERTY(double minimum READ shownLow)
    Q_PROPERTY(double maximum READ shownHigh)
    Q_PROPERTY(double singleStep READ shownStep)
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
    /// What somebody typed, as the language of the program or English writes numbers, with the unit or without it. None: it is no finite number.
    [[nodiscard]] static std::optional<double> numberIn(QString text, const QString& unit);

    /// nullopt: several things with different values.
    void setValue(std::optional<double> value);
    [[nodiscard]] std::optional<double> value() const { return value_; }
    void stepBy(int steps) override;
    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

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
    void wheelEvent(QWheelEvent* event) override;
    void hideEvent(QHideEvent* event) override;
    bool event(QEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;
    [[nodiscard]] StepEnabled stepEnabled() const override { return isReadOnly() ? StepNone : StepUpEnabled | StepDownEnabled; }

private:
    void showText();
    void commitText();
    void endDrag(bool keep);
    void set(double value);
    void once(double value);
    void step(double by);
    [[nodiscard]] std::optional<double> parse() const;
    [[nodiscard]] QVariant shownValue() const { return value_ ? QVariant(*value_ * spec_.factor) : QVariant(); }
    void setShownValue(const QVariant& value);
    [[nodiscard]] double shownLow() const { return spec_.low * spec_.factor; }
    [[nodiscard]] double shownHigh() const { return spec_.high * spec_.factor; }
    [[nodiscard]] double shownStep() const { return spec_.step; }

    Spec spec_;
    std::optional<double> value_;
    QAction* reset_;
    bool pressed_ = false, dragging_ = false, typing_ = false;
    double pressX_ = 0.0, dragValue_ = 0.0;
};

}  // namespace imomushi
