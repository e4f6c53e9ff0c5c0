// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/models/failures.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// One undo step of several commands. Takes the commands back unless commit() was called: no path leaves a gesture open.
class Gesture {
public:
    explicit Gesture(StudioDocument& document) : document_(&document) { document.session().beginGesture(); }
    ~Gesture() {
        if (!document_) return;
        attempt([this] { Q_EMIT document_->changing(); });
        document_->session().cancelGesture();
        attempt([this] { Q_EMIT document_->historyChanged(); });
    }
    Gesture(const Gesture&) = delete;
    Gesture& operator=(const Gesture&) = delete;

    /// `named`: the step is called so, instead of after its last command.
    void commit(const Session::Step& named = {}) {
        document_->session().endGesture(named);
        StudioDocument* document = document_;
        document_ = nullptr;
        Q_EMIT document->historyChanged();
    }

private:
    StudioDocument* document_;
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
