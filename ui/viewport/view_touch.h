// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QPointF>
#include <QTimer>
#include <algorithm>
#include <vector>

namespace imomushi {

/// The fingers that are on the view, and what each does until it is lifted. Positions are logical pixels of the view.
struct ViewTouch {
    enum class Role {
        None,
        Holds,    ///< the tool has it
        Camera,   ///< one orbits, two pan and zoom
        Pointer,  ///< it does what the mouse would
    };
    struct Finger {
        int id = 0;
        Role role = Role::None;
        QPointF from, at;    ///< where it landed, and where it is
        QPointF led;         ///< up to where the camera has followed
        bool moved = false;  ///< further than a tap does
        bool waits = false;  ///< the tool has not heard yet where it is
    };
    std::vector<Finger> fingers;
    Qt::KeyboardModifiers keys;
    bool pressed = false;  ///< the finger that is the pointer has its button down
    bool pinched = false;  ///< two led the camera: the one that is left turns nothing
    QTimer press;          ///< until then a second finger may land and make both lead the camera
    QElapsedTimer sinceTap;
    QPointF tappedAt;

    [[nodiscard]] Finger* find(int id) {
        const auto found = std::find_if(fingers.begin(), fingers.end(), [&](const Finger& f) { return f.id == id; });
        return found == fingers.end() ? nullptr : &*found;
    }
    [[nodiscard]] Finger* first(Role role) {
        const auto found = std::find_if(fingers.begin(), fingers.end(), [&](const Finger& f) { return f.role == role; });
        return found == fingers.end() ? nullptr : &*found;
    }
    [[nodiscard]] int count(Role role) const {
        return int(std::count_if(fingers.begin(), fingers.end(), [&](const Finger& f) { return f.role == role; }));
    }
    [[nodiscard]] bool waits() const {
        return std::any_of(fingers.begin(), fingers.end(), [](const Finger& f) { return f.waits; });
    }
    /// All that are `from`.
    void turn(Role from, Role to) {
        for (Finger& f : fingers)
            if (f.role == from) f.role = to;
    }
    /// What the tool has not heard yet does not concern it any more.
    void forget() {
        for (Finger& f : fingers) f.waits = false;
    }
};

}  // namespace imomushi
