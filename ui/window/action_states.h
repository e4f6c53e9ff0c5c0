// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>

namespace imomushi {

class ActionSet;
class InputDeck;
class PrecomputeJob;
class StepFlow;
class ClipboardFlow;
class StudioDocument;
class TakeDeck;

/// Which actions can be used now, which are checked, and what undo and redo would do. Follows the document, the takes, the live inputs and the precompute.
class ActionStates : public QObject {
    Q_OBJECT
public:
    ActionStates(ActionSet& actions, StudioDocument& document, TakeDeck& deck, InputDeck& inputs, PrecomputeJob& precompute, StepFlow& steps, ClipboardFlow& clipboard, QObject* parent);
    void update();

signals:
    void updated();

private:
    void updateSoon();  ///< several changes of one event are shown once
    void namePoses();
    void updateSteps();
    void updateTakes();

    ActionSet& actions_;
    StudioDocument& document_;
    TakeDeck& deck_;
    InputDeck& inputs_;
    PrecomputeJob& precompute_;
    StepFlow& steps_;
    ClipboardFlow& clipboard_;
    bool scheduled_ = false;
};

}  // namespace imomushi
