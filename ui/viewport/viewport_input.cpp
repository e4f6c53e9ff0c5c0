// SPDX-License-Identifier: GPL-3.0-or-later
// The events of the viewport: to the camera, to the tool, or to the menu.
#include <QApplication>
#include <QContextMenuEvent>
#include <QElapsedTimer>
#include <QKeyEvent>
#include <QKeySequenceEdit>
#include <QLineEdit>
#include <QMenu>
#include <QMouseEvent>
#include <QNativeGestureEvent>
#include <QTabletEvent>
#include <QTouchEvent>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/models/selection_commands.h"
#include "ui/picking/picking.h"
#include "ui/tools/select_tool.h"
#include "ui/tools/typed_number.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

/// Keypad 4, 6, 8, 2 turn the view by 15 degrees.
constexpr double kKeyTurn = std::numbers::pi / 12.0;

/// Both of the studio's keys.
bool isRedo(const QKeyEvent& key) { return key.matches(QKeySequence::Redo) || (key.key() == Qt::Key_Y && key.modifiers() == Qt::ControlModifier); }

}  // namespace

PointerEvent ViewportWidget::pointer(QPointF position, Qt::MouseButton button, Qt::MouseButtons buttons, Qt::KeyboardModifiers modifiers) const {
    PointerEvent e;
    e.x = position.x();
    e.y = position.y();
    e.button = button;
    e.buttons = buttons;
    e.modifiers = modifiers;
    e.bonesVisible = sceneOptions().bones;
    if (behind_ && near(behind_->at, position)) e.behind = behind_->count;
    if (pressure_) e.pressure = *pressure_;
    CameraController camera = camera_;
    camera.setViewport(width(), height());
    camera.aim(e);
    // Tools think in pixels of the design.
    const double scale = Appearance::instance().scale();
    e.x /= scale;
    e.y /= scale;
    e.pixelAngle *= scale;
    e.pixelSize *= scale;
    return e;
}

bool ViewportWidget::near(QPointF a, QPointF b) const {
    const QPointF d = a - b;
    return std::hypot(d.x(), d.y()) < kDragPixels * Appearance::instance().scale();
}

void ViewportWidget::takeBehind() {
    const int passed = behind_ && near(behind_->at, at_) ? behind_->count : 0;
    behind_ = Behind{at_, (passed + 1) % overlapping_};
    move_.reset();
    withTool([&](Tool& tool) { tool.move(pointer(at_, Qt::NoButton, Qt::NoButton, {})); });
}

void ViewportWidget::keepMove(const PointerEvent& e) {
    if (move_ && (move_->modifiers != e.modifiers || move_->buttons != e.buttons)) giveMove();
    if (!move_ && !touch_.waits()) movedAt_ = inputTime();
    move_ = e;
    moveCame();
}

void ViewportWidget::moveCame() {
    // Once in a step.
    const qint64 often = 1000 / document_.document().settings.rate, passed = sinceMove_.isValid() ? sinceMove_.elapsed() : often;
    if (passed >= often)
        giveMove();
    else if (!nextMove_.isActive())
        nextMove_.start(int(often - passed));
}

void ViewportWidget::giveMove() {
    nextMove_.stop();
    giveFingers();
    const auto e = std::exchange(move_, std::nullopt);
    if (!e) return;
    sinceMove_.start();
    withTool([&](Tool& tool) {
        tool.move(*e);
        const auto& hovered = document_.hovered();
        latency_.moved(movedAt_, inputTime());
        if (!tool.busy()) overlapping_ = hovered && hovered->kind == SelectionItem::Kind::Endpoint ? int(endpointsUnder(document_.session(), *e).size()) : 0;
    });
}

// While something is unfinished, its keys belong to the tool and not to the menu.
bool ViewportWidget::belongsToTool(const QKeyEvent& key) const {
    const bool plain = !(key.modifiers() & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier));
    // Shift may be what makes a sign of a key; of a letter it makes another shortcut.
    const bool other = (key.modifiers() & Qt::ShiftModifier) && key.key() >= Qt::Key_A && key.key() <= Qt::Key_Z;
    return (tools_.busy() && (plain || key.matches(QKeySequence::Undo))) || (plain && !other && tools_.tool().wants(key.key())) ||
           (tools_.tool().hasSteps() && (key.matches(QKeySequence::Undo) || isRedo(key))) || (key.key() == Qt::Key_Escape && tools_.tool().pending());
}

bool ViewportWidget::event(QEvent* e) {
    switch (e->type()) {
        case QEvent::ShortcutOverride:
            if (belongsToTool(*static_cast<QKeyEvent*>(e))) {
                e->accept();
                return true;
            }
            break;
        case QEvent::KeyPress:
            // Before it takes the focus elsewhere.
            if (auto* key = static_cast<QKeyEvent*>(e); tools_.busy() && (key->key() == Qt::Key_Tab || key->key() == Qt::Key_Backtab)) {
                keyPressEvent(key);
                return true;
            }
            if (const auto* key = static_cast<QKeyEvent*>(e); key->key() == Qt::Key_Tab && key->modifiers() == Qt::NoModifier && overlapping_ > 1 && !tools_.busy()) {
                takeBehind();
                return true;
            }
            break;
        case QEvent::TouchBegin:
        case QEvent::TouchUpdate:
        case QEvent::TouchEnd:
        case QEvent::TouchCancel:
            if (touch(*static_cast<QTouchEvent*>(e))) return true;
            break;
        case QEvent::NativeGesture: {
            const auto* gesture = static_cast<QNativeGestureEvent*>(e);
            if (gesture->gestureType() == Qt::ZoomNativeGesture) {
                navigator_.pinch(gesture->value(), gesture->position());
                redraw();
                return true;
            }
            break;
        }
        case QEvent::WindowDeactivate:
            if (tools_.busy()) tools_.cancel();
            break;
        case QEvent::LanguageChange:
            setAccessibleName(tr("3D view"));
            updateHint();
            redraw();
            break;
        case QEvent::PaletteChange: redraw(); break;
        default: break;
    }
    return QWidget::event(e);
}

// ---- pointer -----------------------------------------------------------------------------------------------------------

// A pen acts as the mouse: Qt makes mouse events of what is not accepted here. They do not tell how hard it presses, and none comes where it presses harder and stays where it is.
void ViewportWidget::tabletEvent(QTabletEvent* e) {
    e->ignore();
    if (e->type() == QEvent::TabletRelease)
        pressure_.reset();
    else if (e->type() == QEvent::TabletPress || e->buttons() != Qt::NoButton)
        pressure_ = std::clamp(e->pressure(), 0.0, 1.0);
    if (e->type() == QEvent::TabletMove && pressure_ && tools_.busy() && !tools_.tool().modal()) keepMove(pointer(e->position(), Qt::NoButton, e->buttons(), e->modifiers()));
}

void ViewportWidget::mousePressEvent(QMouseEvent* e) {
    giveMove();
    at_ = pressedAt_ = e->position();
    again_ = false;
    const bool right = e->button() == Qt::RightButton;
    if (tools_.busy()) {
        if (right) {
            tools_.cancel();
            swallowMenu_ = true;
        } else if (tools_.tool().modal() && e->button() == Qt::LeftButton) {
            withTool([&](Tool& tool) { tool.press(pointer(e->position(), e->button(), e->buttons(), e->modifiers())); });
        }
        return;
    }
    if (navigator_.active()) return;
    if (navigator_.press(e->position(), e->button(), e->modifiers())) {
        if (!navigator_.onBall()) swallowMenu_ = right;
        return;
    }
    if (right && tools_.tool().pending()) {
        tools_.cancel();
        swallowMenu_ = true;
        return;
    }
    const PointerEvent pressed = pointer(e->position(), e->button(), e->buttons(), e->modifiers());
    if (e->button() == Qt::LeftButton && e->modifiers() == Qt::NoModifier && (tools_.kind() == ToolKind::Select || tools_.kind() == ToolKind::Pose)) {
        const auto end = pickEndpoint(document_.session(), pressed);
        again_ = end && document_.selection() == std::vector{SelectionItem{SelectionItem::Kind::Endpoint, end->bone, {}, end->atEnd}};
    }
    withTool([&](Tool& tool) { tool.press(pressed); });
}

void ViewportWidget::mouseMoveEvent(QMouseEvent* e) {
    const QPointF p = at_ = e->position();
    if (behind_ && !near(behind_->at, p)) behind_.reset();
    if (navigator_.active()) {
        navigator_.drag(p);
        return redraw();
    }
    if (tools_.busy() && !tools_.tool().modal() && !(e->buttons() & Qt::LeftButton)) {
        // The release went elsewhere: what was reached so far stands.
        giveMove();
        tools_.tool().release(pointer(p, Qt::LeftButton, e->buttons(), e->modifiers()));
    }
    if (navigator_.hover(p, !tools_.busy())) redraw();
    if (navigator_.overBall()) {
        move_.reset();
        document_.setHovered(std::nullopt);
        return;
    }
    keepMove(pointer(p, Qt::NoButton, e->buttons(), e->modifiers()));
}

void ViewportWidget::mouseReleaseEvent(QMouseEvent* e) {
    giveMove();
    if (navigator_.active()) {
        if (const auto axis = navigator_.release(e->position(), e->button())) setViewAxis(*axis);
        return redraw();
    }
    withTool([&](Tool& tool) { tool.release(pointer(e->position(), e->button(), e->buttons(), e->modifiers())); });
    // A second click takes what is behind.
    if (!std::exchange(again_, false) || tools_.busy() || !near(e->position(), pressedAt_)) return;
    overlapping_ = int(endpointsUnder(document_.session(), pointer(e->position(), Qt::NoButton, Qt::NoButton, {})).size());
    if (overlapping_ < 2) return;
    takeBehind();
    if (const auto end = pickEndpoint(document_.session(), pointer(at_, Qt::NoButton, Qt::NoButton, {}))) document_.select({{SelectionItem::Kind::Endpoint, end->bone, {}, end->atEnd}});
}

void ViewportWidget::mouseDoubleClickEvent(QMouseEvent* e) {
    giveMove();
    if (tools_.busy() || e->button() != Qt::LeftButton || navigator_.takes(e->position(), e->button(), e->modifiers())) return mousePressEvent(e);
    withTool([&](Tool& tool) { tool.doubleClick(pointer(e->position(), e->button(), e->buttons(), e->modifiers())); });
}

void ViewportWidget::wheelEvent(QWheelEvent* e) {
    giveMove();
    const double notches = notchesOf(*e);
    e->accept();
    if (notches != 0.0 && tools_.tool().wheel(notches, pointer(e->position(), Qt::NoButton, e->buttons(), e->modifiers())))
        updateHint();
    else
        navigator_.wheel(*e);
    redraw();
}

void ViewportWidget::contextMenuEvent(QContextMenuEvent* e) {
    if (bare_ || swallowMenu_ || tools_.busy()) {
        swallowMenu_ = false;
        return;
    }
    const Session& session = document_.session();
    if (e->reason() == QContextMenuEvent::Mouse) {
        const auto item = pickItem(session, pointer(e->pos(), Qt::RightButton, Qt::RightButton, e->modifiers()));
        if (!item)
            document_.select({});
        else if (!document_.isSelected(*item))
            document_.select({*item});
    }
    QMenu menu(this);
    const auto selection = document_.selection();
    for (const SelectionItem& item : selection) {
        const bool handle = handleOf(document_.document(), item) != nullptr;
        if ((item.kind != SelectionItem::Kind::Endpoint && !handle) || selection.size() > 1) continue;
        const PoseGrip grip = handle ? PoseGrip{{}, {item.part, item.face}} : PoseGrip{holdingEndpoint(session, {item.part, item.atEnd}), {}};
        const std::string path = pathOf(document_.document(), grip);
        const bool held = isHeld(document_.document(), grip), pinned = isPinned(document_.document(), grip);
        menu.addAction(pinned ? tr("Unpin") : tr("Pin"), this,
                       [=, this] { document_.execute(commands::setPinned(path, !pinned)); });
        if (held) menu.addAction(tr("Let go"), this, [=, this] { document_.execute(commands::release(path)); });
    }
    menu.addAction(tr("Frame selection"), this, [this] { frameSelection(); })->setEnabled(!selection.empty());
    menu.addAction(tr("Frame all"), this, [this] { frameAll(); });
    menu.addSeparator();
    menu.addAction(tr("Duplicate"), this, [this] { duplicateSelected(document_); })->setEnabled(canDuplicate(document_));
    menu.addAction(tr("Mirror left and right"), this, [this] { mirrorSelected(document_, 'x'); })->setEnabled(canMirror(document_));
    menu.addAction(tr("Remove"), this, [this] { removeSelection(document_); })->setEnabled(!selection.empty());
    menu.exec(e->globalPos());
}

// Keys work where the hand is: whoever moves the pointer here means the view, unless words are being typed.
void ViewportWidget::enterEvent(QEnterEvent* e) {
    QWidget::enterEvent(e);
    const QWidget* typing = QApplication::focusWidget();
    const bool words = qobject_cast<const QLineEdit*>(typing) || qobject_cast<const QKeySequenceEdit*>(typing);
    if (!words && isActiveWindow() && QApplication::mouseButtons() == Qt::NoButton && !QApplication::activePopupWidget()) setFocus(Qt::OtherFocusReason);
}

void ViewportWidget::leaveEvent(QEvent* e) {
    if (!tools_.busy()) {
        move_.reset();
        overlapping_ = 0;
        tools_.tool().leave();
        document_.setHovered(std::nullopt);
        updateHint();
        redraw();
    }
    navigator_.hover({}, false);
    QWidget::leaveEvent(e);
}

// ---- keys --------------------------------------------------------------------------------------------------------------

bool ViewportWidget::navigationKey(QKeyEvent* e) {
    const bool opposite = (e->modifiers() & Qt::ControlModifier) != 0;
    const bool keypad = (e->modifiers() & Qt::KeypadModifier) != 0;
    switch (e->key()) {
        case Qt::Key_1: setViewAxis(opposite ? ViewAxis::Back : ViewAxis::Front); return true;
        case Qt::Key_3: setViewAxis(opposite ? ViewAxis::Left : ViewAxis::Right); return true;
        case Qt::Key_7: setViewAxis(opposite ? ViewAxis::Bottom : ViewAxis::Top); return true;
        case Qt::Key_5: setOrthographic(!camera_.orthographic()); return true;
        case Qt::Key_F:
        case Qt::Key_Period: frameSelection(); return true;
        case Qt::Key_Home: frameAll(); return true;
        default: break;
    }
    if (!keypad) return false;
    switch (e->key()) {
        case Qt::Key_4: camera_.turn(-kKeyTurn, 0.0); break;
        case Qt::Key_6: camera_.turn(kKeyTurn, 0.0); break;
        case Qt::Key_8: camera_.turn(0.0, kKeyTurn); break;
        case Qt::Key_2: camera_.turn(0.0, -kKeyTurn); break;
        default: return false;
    }
    redraw();
    return true;
}

void ViewportWidget::keyPressEvent(QKeyEvent* e) {
    giveMove();
    if ((e->key() == Qt::Key_Escape && tools_.tool().pending()) || (tools_.busy() && e->matches(QKeySequence::Undo))) {
        tools_.cancel();
        return;
    }
    if (tools_.tool().hasSteps() && e->matches(QKeySequence::Undo)) {
        tools_.undo();
        return;
    }
    if (tools_.tool().hasSteps() && isRedo(*e)) {
        tools_.redo();
        return;
    }
    const bool arrow = e->key() == Qt::Key_Up || e->key() == Qt::Key_Down || e->key() == Qt::Key_Left || e->key() == Qt::Key_Right;
    if (!e->isAutoRepeat() || arrow || (tools_.busy() && e->key() == Qt::Key_Backspace)) {
        QElapsedTimer since;
        since.start();
        if (tools_.tool().key(e->key(), e->modifiers(), typedBy(*e))) {
            meter_.addWork(elapsedMs(since));
            redraw();
            updateHint();
            tools_.leaveIfOver();
            return;
        }
    }
    if (!tools_.busy() && navigationKey(e)) return;
    QWidget::keyPressEvent(e);
}

void ViewportWidget::keyReleaseEvent(QKeyEvent* e) {
    giveMove();
    if (!e->isAutoRepeat()) tools_.tool().keyReleased(e->key());
    QWidget::keyReleaseEvent(e);
}

// ---- focus and visibility ------------------------------------------------------------------------------------------------

void ViewportWidget::focusOutEvent(QFocusEvent* e) {
    // What a button holds goes on where another window or a popup takes the focus: nobody lets go of a puppet because a message comes up. Where the release goes there, the next move tells.
    const bool elsewhere = e->reason() == Qt::ActiveWindowFocusReason || e->reason() == Qt::PopupFocusReason;
    if (tools_.busy() && (!elsewhere || tools_.tool().modal())) tools_.cancel();
    QWidget::focusOutEvent(e);
}

void ViewportWidget::showEvent(QShowEvent* e) {
    QWidget::showEvent(e);
    animate();  // what was to move while nobody looked
}

void ViewportWidget::hideEvent(QHideEvent* e) {
    if (tools_.busy()) tools_.cancel();
    cancelTouch();
    pressure_.reset();
    move_.reset();
    clock_.stop();
    navigator_.cancel();
    QWidget::hideEvent(e);
}

}  // namespace imomushi
