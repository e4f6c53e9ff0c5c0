// SPDX-License-Identifier: GPL-3.0-or-later
// Fingers on the viewport: to the tool, several at once, to the camera, or as the mouse.
#include <QCoreApplication>
#include <QGuiApplication>
#include <QMouseEvent>
#include <QPointingDevice>
#include <QStyleHints>
#include <QTouchEvent>
#include <array>
#include <cmath>

#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

/// A finger that moves less than this taps, pixels of the design.
constexpr double kTapPixels = 8.0;
/// A second tap is this near the first one.
constexpr double kAgainPixels = 16.0;
/// Two fingers that land within this time land together.
constexpr int kTogetherMs = 100;

bool within(QPointF a, QPointF b, double pixels) { return std::hypot(a.x() - b.x(), a.y() - b.y()) < pixels * Appearance::instance().scale(); }

/// A tap there is the second one of a double click.
bool tapsAgain(const ViewTouch& touch, QPointF at) {
    return touch.sinceTap.isValid() && touch.sinceTap.elapsed() < QGuiApplication::styleHints()->mouseDoubleClickInterval() && within(at, touch.tappedAt, kAgainPixels);
}

}  // namespace

using Role = ViewTouch::Role;

PointerEvent ViewportWidget::pointer(const ViewTouch::Finger& finger, Qt::MouseButton button) const { return pointer(finger.at, button, Qt::LeftButton, touch_.keys); }

bool ViewportWidget::touch(QTouchEvent& e) {
    // Fingers on a touch pad lead the pointer of the display.
    if (!e.device() || e.device()->type() != QInputDevice::DeviceType::TouchScreen) return false;
    e.accept();
    if (e.type() == QEvent::TouchCancel) {
        cancelTouch();
        return true;
    }
    touch_.keys = e.modifiers();
    for (const QEventPoint& point : e.points()) {
        ViewTouch::Finger* finger = touch_.find(point.id());
        if (!finger || point.state() == QEventPoint::Pressed || finger->at == point.position()) continue;
        finger->at = point.position();
        if (!finger->moved && !within(finger->at, finger->from, kTapPixels)) {
            finger->moved = true;
            if (!touch_.pinched) finger->led = finger->at;
        }
        if (!finger->moved) continue;
        if (finger->role == Role::Holds) {
            if (!move_ && !touch_.waits()) movedAt_ = inputTime();
            finger->waits = true;
        } else if (finger->role == Role::Pointer) {
            if (!touch_.pressed) pressAsMouse();
            sendAsMouse(QEvent::MouseMove, point.position());
        }
    }
    leadCamera();
    if (touch_.waits()) moveCame();
    for (const QEventPoint& point : e.points())
        if (point.state() == QEventPoint::Pressed) landFinger(point.id(), point.position());
    for (const QEventPoint& point : e.points()) {
        if (point.state() != QEventPoint::Released) continue;
        if (const ViewTouch::Finger* finger = touch_.find(point.id())) liftFinger(*finger);
    }
    return true;
}

void ViewportWidget::landFinger(int id, QPointF at) {
    giveMove();
    if (!hasFocus()) setFocus(Qt::MouseFocusReason);
    // One whose end was never told is not there any more.
    std::erase_if(touch_.fingers, [&](const ViewTouch::Finger& f) { return f.id == id; });
    ViewTouch::Finger finger{id, Role::None, at, at, at};
    const bool alone = touch_.fingers.empty();
    const bool again = alone && tapsAgain(touch_, at);
    bool atOnce = false;
    if (touch_.first(Role::Pointer)) {
        if (!touch_.pressed) {
            touch_.press.stop();
            touch_.turn(Role::Pointer, Role::Camera);
            finger.role = Role::Camera;
        }
    } else if (alone && !tools_.busy() && (again || navigator_.takes(at, Qt::LeftButton, touch_.keys))) {
        finger.role = Role::Pointer;
        atOnce = true;
    } else if (touch_.count(Role::Camera) < 2 && !navigator_.active() && (!tools_.busy() || tools_.tool().modal() || touch_.first(Role::Holds))) {
        Tool::Landing landing = Tool::Landing::FoundNothing;
        withTool([&](Tool& tool) { landing = tool.fingerLanded(id, pointer(finger, Qt::LeftButton)); });
        if (landing == Tool::Landing::Holds) {
            finger.role = Role::Holds;
            touch_.turn(Role::Camera, Role::None);
        } else if (landing == Tool::Landing::IsPointer && alone) {
            finger.role = Role::Pointer;
            atOnce = tools_.tool().modal();
        } else if (!touch_.first(Role::Holds)) {
            finger.role = Role::Camera;
        }
    }
    touch_.fingers.push_back(finger);
    if (finger.role == Role::Camera && touch_.count(Role::Camera) == 2) {
        touch_.pinched = true;
        for (ViewTouch::Finger& f : touch_.fingers) f.led = f.at;
    }
    if (finger.role != Role::Pointer) return;
    if (atOnce)
        pressAsMouse();
    else
        touch_.press.start(kTogetherMs);
}

void ViewportWidget::liftFinger(ViewTouch::Finger finger) {
    giveMove();
    const bool tapped = !finger.moved && !touch_.pinched;
    if (finger.role == Role::Pointer || (finger.role == Role::Camera && tapped)) {
        if (!touch_.pressed) pressAsMouse();
        touch_.pressed = false;
        sendAsMouse(QEvent::MouseButtonRelease, finger.at);
    }
    std::erase_if(touch_.fingers, [&](const ViewTouch::Finger& f) { return f.id == finger.id; });
    if (finger.role == Role::Holds) withTool([&](Tool& tool) { tool.fingerLifted(finger.id, pointer(finger, Qt::LeftButton)); });
    if (tapped && finger.role != Role::None) {
        touch_.sinceTap.start();
        touch_.tappedAt = finger.at;
    }
    if (!touch_.fingers.empty()) return;
    touch_.pinched = false;
    // There is nothing over anything.
    if (tools_.busy()) return;
    navigator_.hover({}, false);
    withTool([](Tool& tool) { tool.leave(); });
    document_.setHovered(std::nullopt);
}

void ViewportWidget::leadCamera() {
    std::array<QPointF, 2> from, to;
    std::size_t count = 0;
    for (ViewTouch::Finger& finger : touch_.fingers) {
        if (finger.role != Role::Camera || count == 2) continue;
        from[count] = finger.led;
        to[count++] = finger.at;
        if (finger.moved || touch_.pinched) finger.led = finger.at;
    }
    if (count == 2)
        navigator_.lead(from, to);
    else if (count == 1 && !touch_.pinched && touch_.first(Role::Camera)->moved)
        navigator_.lead(from[0], to[0]);
    else
        return;
    redraw();
}

void ViewportWidget::giveFingers() {
    if (!touch_.waits()) return;
    sinceMove_.start();
    withTool([&](Tool& tool) {
        for (std::size_t i = 0; i < touch_.fingers.size(); ++i)
            if (ViewTouch::Finger& finger = touch_.fingers[i]; std::exchange(finger.waits, false)) tool.fingerMoved(finger.id, pointer(finger, Qt::NoButton));
        latency_.moved(movedAt_, inputTime());
    });
}

void ViewportWidget::cancelTouch() {
    touch_.press.stop();
    if ((touch_.first(Role::Holds) || touch_.pressed) && tools_.busy()) tools_.cancel();
    if (touch_.pressed) navigator_.cancel();
    touch_.fingers.clear();
    touch_.pressed = touch_.pinched = false;
}

// ---- as the mouse ------------------------------------------------------------------------------------------------------

void ViewportWidget::pressAsMouse() {
    touch_.press.stop();
    const ViewTouch::Finger* finger = touch_.first(Role::Pointer);
    if (!finger) finger = touch_.first(Role::Camera);
    if (!finger || touch_.pressed) return;
    const QPointF at = finger->from;
    const bool again = tapsAgain(touch_, at);
    touch_.sinceTap.invalidate();
    sendAsMouse(QEvent::MouseMove, at);
    touch_.pressed = true;
    sendAsMouse(again ? QEvent::MouseButtonDblClick : QEvent::MouseButtonPress, at);
}

void ViewportWidget::sendAsMouse(QEvent::Type type, QPointF at) {
    const bool button = type != QEvent::MouseMove;
    QMouseEvent e(type, at, mapToGlobal(at), button ? Qt::LeftButton : Qt::NoButton, touch_.pressed ? Qt::LeftButton : Qt::NoButton, touch_.keys);
    QCoreApplication::sendEvent(this, &e);
}

}  // namespace imomushi
