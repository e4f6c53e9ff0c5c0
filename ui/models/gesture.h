// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "ui/models/failures.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// One undo step of several commands. The destructor of the outermost gesture undoes all commands since its constructor unless
/// commit() was called. A nested gesture belongs to the outer one: its destructor undoes nothing.
class Gesture {
public:
    explicit Gesture(StudioDocument& document) : document_(&document), outer_(document.gestures_++ == 0) {
        if (outer_) document.session_.beginGesture();
    }
    ~Gesture() {
        if (!document_) return;
        --document_->gestures_;
        if (!outer_) return;
        attempt([this] { Q_EMIT document_->changing(); });
        document_->session_.cancelGesture();
        attempt([this] { Q_EMIT document_->changeDone(); });
    }
    Gesture(const Gesture&) = delete;
    Gesture& operator=(const Gesture&) = delete;

    /// `named`: the step is called so, instead of after its last command.
    void commit(const Session::Step& named = {}) {
        StudioDocument* document = std::exchange(document_, nullptr);
        --document->gestures_;
        if (outer_) document->session_.endGesture(named);
    }

    /// See Session::endGestureInLast().
    void commitInLast(const Session::Step& named) {
        StudioDocument* document = std::exchange(document_, nullptr);
        --document->gestures_;
        if (outer_) document->session_.endGestureInLast(named);
    }

private:
    StudioDocument* document_;
    bool outer_;
};

/// Several commands as one undo step. False: one failed, and none remains.
inline bool executeTogether(StudioDocument& document, const std::vector<Json>& commands) {
    Gesture gesture(document);
    for (const Json& command : commands)
        if (!document.execute(command)) return false;
    gesture.commit();
    return true;
}

}  // namespace imomushi
