// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/number_field.h"

#include <QAction>
#include <QKeyEvent>
#include <QLineEdit>
#include <QLocale>
#include <QMouseEvent>
#include <algorithm>
#include <cmath>
#include <utility>

#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {
constexpr double kDragThreshold = 3.0;  // logical pixels: below this a press is a click
}

NumberField::NumberField(Spec spec, QWidget* parent) : QAbstractSpinBox(parent), spec_(std::move(spec)) {
    setButtonSymbols(NoButtons);
    lineEdit()->installEventFilter(this);
    lineEdit()->setCursor(Qt::SizeHorCursor);
    setFocusPolicy(Qt::TabFocus);  // a press may begin a drag; only a click takes the focus, see mouseReleaseEvent()
    reset_ = lineEdit()->addAction(themedIcon(QStringLiteral("reset"), Appearance::Role::Muted), QLineEdit::TrailingPosition);
    reset_->setToolTip(tr("Back to the default"));
    reset_->setVisible(false);
    connect(reset_, &QAction::triggered, this, [this] {
        if (spec_.standard) once(*spec_.standard);
    });
    setToolTip(tr("Drag sideways, or click and type"));
}

void NumberField::setValue(std::optional<double> value) {
    value_ = value;
    reset_->setVisible(spec_.standard && (!value_ || std::abs(*value_ - *spec_.standard) > 1e-9 * (1.0 + std::abs(*spec_.standard))));
    if (!typing_) showText();
}

void NumberField::showText() {
    if (!value_) {
        lineEdit()->clear();
        lineEdit()->setPlaceholderText(tr("different"));
        return;
    }
    const double grain = std::pow(10.0, -spec_.decimals);
    QString text = QLocale().toString(std::round(*value_ * spec_.factor / grain) * grain + 0.0, 'f', spec_.decimals);  // a zero has no sign
    // 0.4500 reads worse than 0.45
    if (text.contains(QLocale().decimalPoint())) {
        while (text.endsWith(u'0')) text.chop(1);
        if (text.endsWith(QLocale().decimalPoint())) text.chop(QLocale().decimalPoint().size());
    }
    if (!spec_.unit.isEmpty()) text += (spec_.unit == u"°" ? QString() : QStringLiteral("\u2009")) + spec_.unit;
    lineEdit()->setText(text);
    lineEdit()->setCursorPosition(0);
}

// As wide as a line of text: a spin box is as wide as its largest number.
QSize NumberField::sizeHint() const { return {lineEdit()->sizeHint().width(), QAbstractSpinBox::sizeHint().height()}; }
QSize NumberField::minimumSizeHint() const { return {lineEdit()->minimumSizeHint().width(), QAbstractSpinBox::minimumSizeHint().height()}; }

std::optional<double> NumberField::numberIn(QString text, const QString& unit) {
    text.remove(unit.isEmpty() ? QStringLiteral(" ") : unit);
    text.remove(QChar(0x2009));
    text = text.trimmed();
    bool ok = false;
    double number = QLocale().toDouble(text, &ok);
    if (!ok) number = QLocale::c().toDouble(text.replace(u',', u'.'), &ok);
    return ok && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::optional<double> NumberField::parse() const {
    const auto number = numberIn(text(), spec_.unit);
    return number ? std::optional(*number / spec_.factor) : std::nullopt;
}

void NumberField::set(double value) {
    value = std::clamp(value, spec_.low, spec_.high);
    if (value_ && value == *value_) return;
    setValue(value);
    Q_EMIT valueEdited(value);
}

void NumberField::once(double value) {
    Q_EMIT editStarted();
    set(value);
    Q_EMIT editEnded(true);
}

void NumberField::commitText() {
    if (!typing_) return;
    typing_ = false;
    if (const auto number = parse(); number && lineEdit()->isModified()) once(*number);
    showText();
    lineEdit()->setModified(false);
}

// The line takes the mouse while its text is edited; before that a press may begin a drag.
bool NumberField::eventFilter(QObject* watched, QEvent* event) {
    if (watched == lineEdit() && (pressed_ || !hasFocus()) && !isReadOnly()) {
        auto* mouse = static_cast<QMouseEvent*>(event);
        switch (event->type()) {
            case QEvent::MouseButtonPress: mousePressEvent(mouse); return true;
            case QEvent::MouseMove: mouseMoveEvent(mouse); return true;
            case QEvent::MouseButtonRelease: mouseReleaseEvent(mouse); return true;
            case QEvent::MouseButtonDblClick: mouseDoubleClickEvent(mouse); return true;
            default: break;
        }
    }
    return QAbstractSpinBox::eventFilter(watched, event);
}

void NumberField::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || hasFocus() || isReadOnly()) return event->ignore();
    pressed_ = true;
    dragging_ = false;
    pressX_ = event->globalPosition().x();
    dragValue_ = value_.value_or(spec_.standard.value_or(std::clamp(0.0, spec_.low, spec_.high)));
}

void NumberField::mouseMoveEvent(QMouseEvent* event) {
    if (!pressed_) return event->ignore();
    const double x = event->globalPosition().x();
    if (!dragging_) {
        if (std::abs(x - pressX_) < kDragThreshold) return;
        dragging_ = true;
        Q_EMIT editStarted();
        grabKeyboard();  // Esc takes the drag back
    }
    const double gain = event->modifiers() & Qt::ShiftModifier ? 0.1 : event->modifiers() & Qt::ControlModifier ? 10.0 : 1.0;
    dragValue_ += (x - pressX_) * spec_.step * gain / spec_.factor;
    pressX_ = x;
    // Whole steps, so that dragged numbers stay readable.
    const double grain = spec_.step * std::min(gain, 1.0) / spec_.factor;
    set(std::round(dragValue_ / grain) * grain);
}

void NumberField::mouseReleaseEvent(QMouseEvent* event) {
    if (!pressed_) return event->ignore();
    pressed_ = false;
    if (dragging_) return endDrag(true);
    setFocus(Qt::MouseFocusReason);
}

void NumberField::endDrag(bool keep) {
    pressed_ = false;
    if (!std::exchange(dragging_, false)) return;
    releaseKeyboard();
    Q_EMIT editEnded(keep);
}

// The button is let go elsewhere: what was reached stands.
void NumberField::hideEvent(QHideEvent* event) {
    endDrag(true);
    QAbstractSpinBox::hideEvent(event);
}

bool NumberField::event(QEvent* event) {
    // While a number is dragged keys belong to it, not to the window: they would end the drag in the middle.
    if (event->type() == QEvent::ShortcutOverride && dragging_) {
        event->accept();
        return true;
    }
    if (event->type() == QEvent::WindowDeactivate) endDrag(true);
    return QAbstractSpinBox::event(event);
}

void NumberField::mouseDoubleClickEvent(QMouseEvent* event) {
    if (hasFocus()) selectAll();
    else mousePressEvent(event);
}

void NumberField::keyPressEvent(QKeyEvent* event) {
    if (dragging_) {
        if (event->key() == Qt::Key_Escape) endDrag(false);
        return;
    }
    switch (event->key()) {
        case Qt::Key_Return:
        case Qt::Key_Enter:
            commitText();
            clearFocus();  // what is typed next is meant for the view
            return;
        case Qt::Key_Escape:
            typing_ = false;
            showText();
            clearFocus();
            return;
        case Qt::Key_Up:
        case Qt::Key_Down:
            step((event->key() == Qt::Key_Up ? 1.0 : -1.0) * (event->modifiers() & Qt::ShiftModifier ? 0.1 : event->modifiers() & Qt::ControlModifier ? 10.0 : 1.0));
            return;
        default: QAbstractSpinBox::keyPressEvent(event);
    }
}

void NumberField::stepBy(int steps) { step(steps); }

void NumberField::step(double by) {
    const double from = (typing_ ? parse() : value_).value_or(value_.value_or(0.0));
    const bool typing = std::exchange(typing_, false);
    once(from + by * spec_.step / spec_.factor);
    typing_ = typing;
    if (typing) selectAll();
}

void NumberField::setShownValue(const QVariant& value) {
    bool ok = false;
    if (const double number = value.toDouble(&ok); ok && std::isfinite(number) && !isReadOnly()) once(number / spec_.factor);
}

// A wheel scrolls the panel around; it changes no number in passing.
void NumberField::wheelEvent(QWheelEvent* event) { event->ignore(); }

void NumberField::focusInEvent(QFocusEvent* event) {
    QAbstractSpinBox::focusInEvent(event);
    typing_ = !isReadOnly();
    lineEdit()->setModified(false);
    lineEdit()->setCursor(Qt::IBeamCursor);
    QMetaObject::invokeMethod(this, &QAbstractSpinBox::selectAll, Qt::QueuedConnection);
}

void NumberField::focusOutEvent(QFocusEvent* event) {
    QAbstractSpinBox::focusOutEvent(event);
    commitText();
    lineEdit()->setCursor(Qt::SizeHorCursor);
    lineEdit()->deselect();
}

void NumberField::changeEvent(QEvent* event) {
    QAbstractSpinBox::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) {
        reset_->setToolTip(tr("Back to the default"));
        setToolTip(tr("Drag sideways, or click and type"));
        if (!typing_) showText();
    }
}

}  // namespace imomushi
